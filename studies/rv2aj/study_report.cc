#include "studies/rv2aj/study_report.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>
#include <map>
#include <sstream>
#include <utility>

#include "studies/rv2aj/format.h"

namespace alidade::rv2aj {
namespace {

constexpr int kAssumedDecimals = 6;
constexpr int kAngleDecimals = 8;   // of rad
constexpr int kLengthDecimals = 6;  // of mm
// Errors below this many percent are the rounding of units.
constexpr double kExactPercent = 1e-9;
// An absorption below this (m or rad) changes no digit that is printed.
constexpr double kSmallestAbsorption = 1e-10;
// Share of a change that an explanation may leave open.
constexpr double kExplained = 0.01;
// Points whose errors agree to this share have "the same" error.
constexpr double kSame = 1e-3;
// A table's error is that of its rounding when it is this many times the
// error at full precision.
constexpr double kMuchLarger = 100.0;

ReportTable RowTable(const StudyResult& study) {
  ReportTable table{"study-rows",
                    "",
                    {"quantity", "published", "obtained"},
                    {},
                    {34, 30, 30}};
  for (const StudyRow& row : study.rows) {
    table.rows.push_back({row.quantity, row.published, row.obtained});
  }
  return table;
}

ReportTable NominalTable(const StudyResult& study) {
  ReportTable table{"study-nominal",
                    "Table 1: nominal parameters",
                    {">joint", ">beta [deg]", ">alpha [deg]", ">d [mm]",
                     ">theta [deg]", ">r [mm]"},
                    {},
                    {}};
  // "beta12" is parameter "beta" of joint 12.
  std::map<int, std::map<std::string, std::string>> joints;
  for (const StudyParameter& parameter : study.parameters) {
    const std::size_t digits = parameter.name.find_first_of("0123456789");
    const double unit =
        parameter.dimension == Dimension::kLength ? kMillimetre : kDegree;
    joints[std::stoi(parameter.name.substr(digits))][parameter.name.substr(
        0, digits)] = Fixed(parameter.nominal / unit, 4);
  }
  for (auto& [joint, values] : joints) {
    table.rows.push_back({std::to_string(joint), values["beta"],
                          values["alpha"], values["d"], values["theta"],
                          values["r"]});
  }
  return table;
}

// A deviation in the study's units: rad and mm.
std::string Deviation(double value, Dimension dimension, int decimals) {
  return Fixed(dimension == Dimension::kLength ? value / kMillimetre : value,
               decimals);
}

// With our digits and its unit.
std::string OurDeviation(double value, Dimension dimension) {
  return dimension == Dimension::kLength
             ? Deviation(value, dimension, kLengthDecimals) + " mm"
             : Deviation(value, dimension, kAngleDecimals) + " rad";
}

// The study's error of a parameter, |deviation - assumed| / |assumed| in %.
std::string ErrorPercent(double deviation, double assumed) {
  if (assumed == 0.0) return "-";
  const double percent = 100.0 * std::abs((deviation - assumed) / assumed);
  return percent < kExactPercent ? "0" : Significant(percent, 3);
}

std::vector<std::string> DeviationRow(const StudyResult& study,
                                      const StudyParameter& parameter) {
  const bool length = parameter.dimension == Dimension::kLength;
  const int printed = length ? study.length_decimals : study.angle_decimals;
  const int decimals = length ? kLengthDecimals : kAngleDecimals;
  return {parameter.name,
          length ? "mm" : "rad",
          Deviation(parameter.assumed, parameter.dimension, kAssumedDecimals),
          Deviation(parameter.published, parameter.dimension, printed),
          Deviation(parameter.obtained, parameter.dimension, decimals),
          ErrorPercent(parameter.published, parameter.assumed),
          ErrorPercent(parameter.obtained, parameter.assumed),
          parameter.identified ? "yes" : "no"};
}

ReportTable DeviationTable(const StudyResult& study) {
  ReportTable table{
      "study-deviations",
      "Table 2: deviations from nominal, of the arm as it is assumed "
      "to be and as identified",
      {"name", "unit", ">assumed", ">published", ">obtained",
       ">publ. error [%]", ">our error [%]", "identified"},
      {},
      {}};
  for (const StudyParameter& parameter : study.parameters) {
    if (parameter.identified || parameter.assumed != 0.0) {
      table.rows.push_back(DeviationRow(study, parameter));
    }
  }
  return table;
}

std::string Quantity(double value, Dimension dimension) {
  const bool length = dimension == Dimension::kLength;
  return Significant(length ? value / kMillimetre : value, 4) +
         (length ? " mm" : " rad");
}

// The unit of a coefficient that turns `from` into `to`, with SI inside.
std::string Coefficient(double value, Dimension from, Dimension to) {
  if (from == to) return Significant(value, 4);
  return to == Dimension::kLength
             ? Significant(value / kMillimetre, 4) + " mm/rad"
             : Significant(value * kMillimetre, 4) + " rad/mm";
}

std::string AbsorptionTerm(const Absorption& absorption) {
  return "the fixed " + absorption.fixed + " (" +
         Quantity(absorption.fixed_deviation, absorption.fixed_dimension) +
         " off its nominal value) with coefficient " +
         Coefficient(absorption.coefficient, absorption.fixed_dimension,
                     absorption.dimension) +
         ", that is " + Quantity(absorption.amount, absorption.dimension);
}

// What to first order the absorptions explain of a parameter's change.
std::string Balance(double change, double sum, Dimension dimension) {
  const double left = std::abs(change - sum);
  if (left > std::max(kExplained * std::abs(change), kSmallestAbsorption)) {
    return " Together that is " + Quantity(sum, dimension) +
           " to first order, of " + Quantity(change, dimension) + ".";
  }
  if (std::abs(change) < kSmallestAbsorption) return " Together they cancel.";
  return " That explains the difference.";
}

// All that one free parameter takes up.
std::string ExplainParameter(const StudyResult& study,
                             const StudyParameter& parameter) {
  std::vector<std::string> terms;
  double sum = 0.0;
  for (const Absorption& absorption : study.absorptions) {
    if (absorption.taken_up_by != parameter.name) continue;
    terms.push_back(AbsorptionTerm(absorption));
    sum += absorption.amount;
  }
  if (terms.empty()) return "";
  const Dimension dimension = parameter.dimension;
  const double change = parameter.obtained - parameter.assumed;
  const bool as_assumed = std::abs(change) < kSmallestAbsorption;
  return parameter.name + " comes out as " +
         OurDeviation(parameter.obtained, dimension) +
         (as_assumed ? ", as assumed, although it takes up "
                     : ", not " + OurDeviation(parameter.assumed, dimension) +
                           ": it takes up ") +
         Join(terms, ", and ") + "." + Balance(change, sum, dimension);
}

std::string Decimals(int count) { return Count(count, "decimal"); }

std::string ExplainPrintedTable(const StudyResult& study) {
  const Accuracy& printed = study.as_printed;
  std::string text =
      "With the identified values rounded as the study prints "
      "them (angles to " +
      Decimals(study.angle_decimals) + " of a radian, lengths to " +
      Decimals(study.length_decimals) + " of a mm) the error over " +
      Count(printed.n, "validation pose") + " is " +
      Millimetres(printed.mean, 5) + " (" + Significant(printed.mean, 2) +
      " m)" + " in the mean, at most " + Millimetres(printed.max, 5);
  if (printed.max - printed.min <= kSame * printed.max) {
    text += ", the same at every one of them";
  }
  text += ". With " + Decimals(study.length_decimals + 3) + " of a mm it is " +
          Millimetres(study.three_more_decimals.mean, 3) +
          " in the mean. At full precision it is at most " +
          Millimetres(study.full_precision.max, 3);
  return text +
         (printed.max > kMuchLarger * study.full_precision.max
              ? ": the error of the table is that of its rounding, and no "
                "limit of the calibration."
              : ".");
}

std::string ExplainTime(const StudyResult& study) {
  const double ratio = study.published_s / study.timed_s;
  return Count(study.timed_iterations, "iteration") +
         " of the iterated pseudo-inverse take " + Duration(study.timed_s) +
         " here, and took " + Duration(study.published_s) +
         " as published on the machine of that time: a ratio of " +
         (ratio >= 1000.0 ? Fixed(ratio, 0) : Significant(ratio, 3)) + ".";
}

// A figure of the study: which of ours it is, and what it shows.
struct StudyFigure {
  const char* id;
  const char* title;
  std::vector<std::string> quantities;
};

void AddFigures(const StudyResult& study,
                const std::vector<ReportFigure>& figures,
                ReportSection* section) {
  const StudyFigure kFigures[] = {
      {"error_before", "error before, training poses", {"before_range"}},
      {"error_after", "error after, training poses", {"after_max"}},
      {"convergence",
       "largest error by iteration",
       {"error_at_iteration_4", "error_at_iteration_100"}},
      {"validation_before", "error before, validation poses", {}},
      {"validation_after",
       "error after, validation poses",
       {"validation_after", "as_printed"}}};
  int number = 0;
  for (const auto& [id, title, quantities] : kFigures) {
    const std::string count = std::to_string(++number);
    std::vector<std::string> notes;
    for (const StudyRow& row : study.rows) {
      if (std::count(quantities.begin(), quantities.end(), row.key) == 0) {
        continue;
      }
      notes.push_back("Published, " + row.quantity + ": " + row.published +
                      ". Here: " + row.obtained + ".");
    }
    for (const ReportFigure& figure : figures) {
      if (figure.id != id) continue;
      notes.insert(notes.begin(), figure.note);
      section->content.emplace_back(
          ReportFigure{"study-" + count, "Figure " + count + ": " + title,
                       figure.svg, Join(notes, " ")});
    }
  }
}

const char* SiUnit(Dimension dimension) {
  return dimension == Dimension::kLength ? "\"m\"" : "\"rad\"";
}

void PutAccuracy(const char* key, const Accuracy& accuracy,
                 std::ostringstream* json) {
  *json << ",\n"
        << std::quoted(key) << ": {\"mean\": " << accuracy.mean
        << ", \"rms\": " << accuracy.rms << ", \"stddev\": " << accuracy.stddev
        << ", \"median\": " << accuracy.median << ", \"p95\": " << accuracy.p95
        << ", \"min\": " << accuracy.min << ", \"max\": " << accuracy.max
        << ", \"n\": " << accuracy.n << "}";
}

}  // namespace

ReportSection MakeStudySection(const StudyResult& study,
                               const std::vector<ReportFigure>& figures) {
  ReportSection section{"study",
                        "Published study",
                        {"Published: " + study.source, RowTable(study),
                         NominalTable(study), DeviationTable(study)}};
  for (const StudyParameter& parameter : study.parameters) {
    const std::string text = ExplainParameter(study, parameter);
    if (!text.empty()) section.content.emplace_back(text);
  }
  section.content.emplace_back(ExplainPrintedTable(study));
  section.content.emplace_back(ExplainTime(study));
  AddFigures(study, figures, &section);
  return section;
}

std::string FormatStudyJson(const StudyResult& study) {
  using std::quoted;
  std::ostringstream json;
  json << std::setprecision(std::numeric_limits<double>::max_digits10)
       << std::boolalpha << "{\"source\": " << quoted(study.source)
       << ",\n\"rows\": [";
  const char* comma = "";
  for (const StudyRow& row : study.rows) {
    json << std::exchange(comma, ",")
         << "\n  {\"quantity\": " << quoted(row.quantity)
         << ", \"published\": " << quoted(row.published)
         << ", \"obtained\": " << quoted(row.obtained) << "}";
  }
  json << "],\n\"parameters\": [";
  comma = "";
  for (const StudyParameter& one : study.parameters) {
    json << std::exchange(comma, ",") << "\n  {\"name\": " << quoted(one.name)
         << ", \"unit\": " << SiUnit(one.dimension)
         << ", \"identified\": " << one.identified
         << ", \"nominal\": " << one.nominal << ", \"assumed\": " << one.assumed
         << ", \"published\": " << one.published
         << ", \"obtained\": " << one.obtained << "}";
  }
  json << "],\n\"absorptions\": [";
  comma = "";
  for (const Absorption& one : study.absorptions) {
    json << std::exchange(comma, ",") << "\n  {\"fixed\": " << quoted(one.fixed)
         << ", \"fixed_deviation\": " << one.fixed_deviation
         << ", \"taken_up_by\": " << quoted(one.taken_up_by)
         << ", \"unit\": " << SiUnit(one.dimension)
         << ", \"coefficient\": " << one.coefficient
         << ", \"amount\": " << one.amount << "}";
  }
  json << "],\n\"angle_decimals\": " << study.angle_decimals
       << ", \"length_decimals\": " << study.length_decimals
       << ",\n\"timed_iterations\": " << study.timed_iterations
       << ", \"timed_s\": " << study.timed_s
       << ", \"published_s\": " << study.published_s;
  PutAccuracy("as_printed", study.as_printed, &json);
  PutAccuracy("three_more_decimals", study.three_more_decimals, &json);
  json << "}\n";
  return json.str();
}

}  // namespace alidade::rv2aj
