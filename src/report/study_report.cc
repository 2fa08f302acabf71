#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "src/common/format.h"
#include "src/common/text.h"
#include "src/common/text_table.h"
#include "src/report/report.h"

namespace alidade::internal {
namespace {

using Align = TextTable::Align;

constexpr int kQuantityWidth = 34;
constexpr int kValueWidth = 30;
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

std::string RowTable(const StudyResult& study) {
  TextTable table({{"quantity"}, {"published"}, {"obtained"}});
  for (const StudyRow& row : study.rows) {
    AddWrappedRow({row.quantity, row.published, row.obtained},
                  {kQuantityWidth, kValueWidth, kValueWidth}, &table);
  }
  return table.empty() ? "" : "\n" + table.ToString();
}

// "beta12" is parameter "beta" of joint 12; no joint (0) for "base_x".
std::pair<std::string, int> SplitName(const std::string& name) {
  const std::size_t digits = name.find_last_not_of("0123456789") + 1;
  if (digits == name.size() || name.size() - digits > 3) return {name, 0};
  return {name.substr(0, digits), std::stoi(name.substr(digits))};
}

std::string NominalTable(const StudyResult& study) {
  constexpr const char* kKinds[] = {"beta", "alpha", "d", "theta", "r"};
  std::map<int, std::map<std::string, std::string>> joints;
  for (const StudyParameter& parameter : study.parameters) {
    const auto [kind, joint] = SplitName(parameter.name);
    if (joint == 0) continue;
    joints[joint][kind] =
        FormatParameter(parameter.nominal, parameter.dimension, 4);
  }
  if (joints.empty()) return "";
  TextTable table({{"joint", Align::kRight},
                   {"beta [deg]", Align::kRight},
                   {"alpha [deg]", Align::kRight},
                   {"d [mm]", Align::kRight},
                   {"theta [deg]", Align::kRight},
                   {"r [mm]", Align::kRight}});
  for (auto& [joint, values] : joints) {
    std::vector<std::string> row = {std::to_string(joint)};
    for (const char* kind : kKinds) row.push_back(values[kind]);
    table.AddRow(std::move(row));
  }
  return "\nTable 1: nominal parameters\n\n" + table.ToString();
}

// A deviation in the study's units: rad and mm.
std::string Deviation(double value, Dimension dimension, int decimals) {
  return FixedNumber(
      dimension == Dimension::kLength ? value / kMillimetre : value, decimals);
}

// With our digits and its unit.
std::string OurDeviation(double value, Dimension dimension) {
  return dimension == Dimension::kLength
             ? Deviation(value, dimension, kLengthDecimals) + " mm"
             : Deviation(value, dimension, kAngleDecimals) + " rad";
}

std::string Percent(double percent) {
  if (std::isnan(percent)) return "-";
  return percent < kExactPercent ? "0" : FormatSignificant(percent, 3);
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
          Percent(parameter.ErrorPercent(parameter.published)),
          Percent(parameter.ErrorPercent(parameter.obtained)),
          parameter.identified ? "yes" : "no"};
}

std::string DeviationTable(const StudyResult& study) {
  TextTable table({{"name"},
                   {"unit"},
                   {"assumed", Align::kRight},
                   {"published", Align::kRight},
                   {"obtained", Align::kRight},
                   {"publ. error [%]", Align::kRight},
                   {"our error [%]", Align::kRight},
                   {"identified"}});
  for (const StudyParameter& parameter : study.parameters) {
    if (parameter.identified || parameter.assumed != 0.0) {
      table.AddRow(DeviationRow(study, parameter));
    }
  }
  if (table.empty()) return "";
  return "\nTable 2: deviations from nominal, of the arm as it is assumed to "
         "be and as identified\n\n" +
         table.ToString();
}

const StudyParameter* Find(const StudyResult& study, const std::string& name) {
  const auto found =
      std::find_if(study.parameters.begin(), study.parameters.end(),
                   [&name](const StudyParameter& parameter) {
                     return parameter.name == name;
                   });
  return found == study.parameters.end() ? nullptr : &*found;
}

std::string Quantity(double value, Dimension dimension) {
  const bool length = dimension == Dimension::kLength;
  return FormatSignificant(length ? value / kMillimetre : value, 4) +
         (length ? " mm" : " rad");
}

// The unit of a coefficient that turns `from` into `to`, with SI inside.
std::string Coefficient(double value, Dimension from, Dimension to) {
  if (from == to) return FormatSignificant(value, 4);
  return to == Dimension::kLength
             ? FormatSignificant(value / kMillimetre, 4) + " mm/rad"
             : FormatSignificant(value * kMillimetre, 4) + " rad/mm";
}

std::string AbsorptionTerm(const StudyResult& study,
                           const Absorption& absorption) {
  const StudyParameter* frozen = Find(study, absorption.frozen);
  const Dimension from =
      frozen == nullptr ? absorption.dimension : frozen->dimension;
  return "the frozen " + absorption.frozen + " (" +
         Quantity(absorption.frozen_deviation, from) +
         " off its nominal value) with coefficient " +
         Coefficient(absorption.coefficient, from, absorption.dimension) +
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
    if (absorption.taken_up_by != parameter.name ||
        std::abs(absorption.amount) < kSmallestAbsorption) {
      continue;
    }
    terms.push_back(AbsorptionTerm(study, absorption));
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

std::string ExplainAbsorptions(const StudyResult& study) {
  std::string text;
  for (const StudyParameter& parameter : study.parameters) {
    const std::string sentence = ExplainParameter(study, parameter);
    if (!sentence.empty()) text += "\n" + Paragraph(sentence);
  }
  return text;
}

std::string Decimals(int count) { return Count(count, "decimal"); }

std::string ExplainPrintedTable(const CalibrationResult& result) {
  const StudyResult& study = *result.study;
  const Accuracy& printed = study.as_printed;
  if (printed.n == 0) return "";
  std::string text =
      "With the identified values rounded as the study prints "
      "them (angles to " +
      Decimals(study.angle_decimals) + " of a radian, lengths to " +
      Decimals(study.length_decimals) + " of a mm) the error over " +
      Count(printed.n, "validation pose") + " is " +
      FormatLength(printed.mean, 5) + " (" +
      FormatSignificant(printed.mean, 2) + " m)" + " in the mean, at most " +
      FormatLength(printed.max, 5);
  if (printed.max - printed.min <= kSame * printed.max) {
    text += ", the same at every one of them";
  }
  text += ".";
  if (study.three_more_decimals.n > 0) {
    text += " With " + Decimals(study.length_decimals + 3) + " of a mm it is " +
            FormatLength(study.three_more_decimals.mean, 3) + " in the mean.";
  }
  if (!result.heldout || result.heldout->after.n == 0) {
    return "\n" + Paragraph(text);
  }
  const double full = result.heldout->after.max;
  text += " At full precision it is at most " + FormatLength(full, 3);
  text +=
      printed.max > kMuchLarger * full
          ? ": the error of the table is that of its rounding, and no limit "
            "of the calibration."
          : ".";
  return "\n" + Paragraph(text);
}

std::string ExplainTime(const StudyResult& study) {
  if (study.timed_iterations <= 0 || !(study.timed_s > 0.0) ||
      !(study.published_s > 0.0)) {
    return "";
  }
  const double ratio = study.published_s / study.timed_s;
  return "\n" +
         Paragraph(Count(study.timed_iterations, "iteration") +
                   " of the iterated pseudo-inverse take " +
                   FormatDuration(study.timed_s) + " here, and took " +
                   FormatDuration(study.published_s) +
                   " as published on the machine of that time: a ratio of " +
                   (ratio >= 1000.0 ? FixedNumber(ratio, 0)
                                    : FormatSignificant(ratio, 3)) +
                   ".");
}

}  // namespace

std::string FormatStudyTable(const CalibrationResult& result) {
  if (!result.study) return "";
  const StudyResult& study = *result.study;
  return Paragraph("Published: " + study.source) + RowTable(study) +
         NominalTable(study) + DeviationTable(study) +
         ExplainAbsorptions(study) + ExplainPrintedTable(result) +
         ExplainTime(study);
}

}  // namespace alidade::internal
