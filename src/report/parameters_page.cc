#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "src/common/constants.h"
#include "src/common/format.h"
#include "src/common/text.h"
#include "src/report/result_page.h"
#include "src/report/result_tables.h"
#include "src/report/table.h"
#include "src/report/uncertainty_report.h"

namespace alidade::internal {
namespace {

// Of the normal distribution.
constexpr double kHalfWidth95 = 1.96;

// How well a parameter is known (rad or m); no interval: NaN.
struct Knowledge {
  double std = std::numeric_limits<double>::quiet_NaN();
  ConfidenceInterval interval;
};

// Nothing where nobody computed it.
std::optional<Knowledge> KnowledgeOf(const CalibrationResult& result,
                                     const ParameterResult& parameter) {
  // A result.json has no infinity.
  const auto or_infinite = [](double std) {
    return std::isfinite(std) ? std : kInfinity;
  };
  if (result.uncertainty) {
    for (const ParameterUncertainty& one : result.uncertainty->parameters) {
      if (one.name == parameter.name) {
        return Knowledge{or_infinite(one.std), one.interval};
      }
    }
  }
  if (parameter.decision.state != ParameterState::kFree) return std::nullopt;
  if (std::isfinite(parameter.std)) return Knowledge{parameter.std, {}};
  const bool is_predicted =
      std::any_of(result.parameters.begin(), result.parameters.end(),
                  [](const ParameterResult& other) {
                    return std::isfinite(other.decision.predicted_std);
                  });
  if (!is_predicted) return std::nullopt;
  return Knowledge{or_infinite(parameter.decision.predicted_std), {}};
}

FindingLevel LevelOf(ParameterAssessment assessment) {
  switch (assessment) {
    case ParameterAssessment::kEstimated:
      return FindingLevel::kPassed;
    case ParameterAssessment::kPriorDominated:
    case ParameterAssessment::kWeak:
      return FindingLevel::kAttention;
    case ParameterAssessment::kFixed:
    case ParameterAssessment::kKnown:
      break;
  }
  return FindingLevel::kNote;
}

std::string Remarks(const ParameterResult& parameter,
                    const std::optional<Knowledge>& known) {
  std::vector<std::string> remarks;
  if (parameter.assessment == ParameterAssessment::kWeak) {
    remarks.emplace_back(
        "linearly dependent on others at the nominal geometry but for effects "
        "of second order, which are below the noise level");
  }
  if (known && known->interval.is_profile) {
    remarks.emplace_back("interval by profile likelihood");
  }
  if (!parameter.decision.reason.empty()) {
    remarks.push_back(parameter.decision.reason);
  }
  return Join(remarks, "; ");
}

bool IsEstimated(const ParameterResult& parameter) {
  return parameter.decision.state == ParameterState::kFree;
}

TableCell StateCell(const ParameterResult& parameter) {
  TableCell state(AssessmentForPeople(parameter.assessment));
  state.markup = HtmlBadge(LevelOf(parameter.assessment), state.text);
  return state;
}

TableCell ShownValue(double value, Dimension dimension) {
  return FixedCell(value / UnitOf(dimension),
                   dimension == Dimension::kAngle ? 5 : 4);
}

TableCell ShownValue(const std::optional<double>& value, Dimension dimension) {
  return value ? ShownValue(*value, dimension) : TableCell("");
}

void AddEstimated(const CalibrationResult& result,
                  const ParameterResult& parameter, Table* table) {
  const Dimension dimension = parameter.dimension;
  TableCell deviation = ShownValue(parameter.deviation(), dimension);
  deviation.text = WithSign(deviation.text);
  TableCell std_cell("");
  TableCell in_std("");
  TableCell interval("");
  const std::optional<Knowledge> known = KnowledgeOf(result, parameter);
  if (known) {
    std_cell = QuantityCell(known->std, dimension, 2);
    if (std::isinf(known->std)) std_cell.text = "∞";
    if (known->std > 0.0 && std::isfinite(known->std)) {
      in_std = NumberCell(parameter.deviation() / known->std, 2);
      in_std.text = WithSign(in_std.text);
    }
    const ConfidenceInterval& range = known->interval;
    if (std::isfinite(range.lower) && std::isfinite(range.upper)) {
      interval = ShownValue(range.lower, dimension);
      interval.text += " … " + ShownValue(range.upper, dimension).text;
    }
  }
  table->AddRow({parameter.name, StateCell(parameter), deviation, std_cell,
                 UnitForPeople(dimension), in_std, interval,
                 ShownValue(parameter.nominal, dimension),
                 ShownValue(parameter.value, dimension),
                 ShownValue(parameter.truth, dimension),
                 ShownValue(parameter.published, dimension),
                 parameter.decision.identified_combination,
                 Remarks(parameter, known)});
}

bool IsOfJoint(const ParameterResult& parameter) {
  for (const char* block : {"base", "point", "plane", "tool"}) {
    if (parameter.kind.rfind(block, 0) == 0) return false;
  }
  return true;
}

// "joint 2" of "theta2", "base", "tool2 (smr2)".
std::string GroupOf(const CalibrationResult& result,
                    const ParameterResult& parameter) {
  if (IsOfJoint(parameter)) {
    const std::size_t digits = parameter.name.find_first_of("0123456789");
    if (digits != std::string::npos) {
      return "joint " + parameter.name.substr(digits);
    }
  }
  for (const auto& [block, name] : result.aliases) {
    if (block == parameter.kind) return block + " (" + name + ")";
  }
  return parameter.kind;
}

// Parameters by joint, then frames and references, in the order of the layout.
std::vector<std::pair<std::string, std::vector<const ParameterResult*>>>
ParameterGroups(const CalibrationResult& result, bool is_estimated) {
  std::vector<std::pair<std::string, std::vector<const ParameterResult*>>>
      groups;
  for (const bool of_joint : {true, false}) {
    for (const ParameterResult& parameter : result.parameters) {
      if (IsEstimated(parameter) != is_estimated ||
          IsOfJoint(parameter) != of_joint) {
        continue;
      }
      const std::string title = GroupOf(result, parameter);
      auto group = std::find_if(
          groups.begin(), groups.end(),
          [&title](const auto& each) { return each.first == title; });
      if (group == groups.end()) {
        group = groups.insert(groups.end(), {title, {}});
      }
      group->second.push_back(&parameter);
    }
  }
  std::stable_sort(groups.begin(), groups.end(),
                   [](const auto& a, const auto& b) {
                     const auto number = [](const std::string& title) {
                       return title.rfind("joint ", 0) == 0
                                  ? std::stoi(title.substr(6))
                                  : std::numeric_limits<int>::max();
                     };
                     return number(a.first) < number(b.first);
                   });
  return groups;
}

Table EstimatedTable(const CalibrationResult& result) {
  const std::string confidence =
      result.uncertainty
          ? ShortestNumber(std::round(1e4 * result.uncertainty->confidence) /
                           100.0) +
                "\u00a0% interval"
          : "interval";
  const std::string combination =
      "~identified combination|what of it is determined, with parameters that "
      "are left out";
  Table table(
      "parameters-table", "Estimated parameters",
      {"name", "state", ">deviation|identified less nominal",
       ">std|standard deviation of what was identified", "unit",
       ">deviation / std|in units of its standard deviation", ">" + confidence,
       ">nominal", ">identified", ">true|known, because the arm is simulated",
       ">published|" + result.published_source, combination, "~remarks"});
  for (const auto& [title, parameters] : ParameterGroups(result, true)) {
    table.BeginGroup(title);
    for (const ParameterResult* parameter : parameters) {
      AddEstimated(result, *parameter, &table);
    }
  }
  return table;
}

// Those that are not estimated, and why.
Table HeldTable(const CalibrationResult& result) {
  Table table("held-parameters", "Parameters at their nominal values",
              {"name", "state", ">nominal", "unit",
               ">true|known, because the arm is simulated",
               ">published|" + result.published_source, "~why"});
  for (const auto& [title, parameters] : ParameterGroups(result, false)) {
    table.BeginGroup(title);
    for (const ParameterResult* parameter : parameters) {
      const Dimension dimension = parameter->dimension;
      table.AddRow({parameter->name, StateCell(*parameter),
                    ShownValue(parameter->nominal, dimension),
                    UnitForPeople(dimension),
                    ShownValue(parameter->truth, dimension),
                    ShownValue(parameter->published, dimension),
                    parameter->decision.reason});
    }
  }
  return table;
}

// Marks of the true value, where it is known, and of the found one.
ChartRow ChangeRow(const CalibrationResult& result,
                   const ParameterResult& parameter) {
  const auto shift = [&](double value) {
    return (value - parameter.nominal) / UnitOf(parameter.dimension);
  };
  const std::string unit =
      std::string(" ") + UnitForPeople(parameter.dimension);
  ChartRow row;
  row.label = parameter.name;
  if (parameter.truth) {
    RowMark truth;
    truth.at = shift(*parameter.truth);
    truth.series = 1;
    row.marks.push_back(truth);
  }
  RowMark found;
  found.at = shift(parameter.value);
  found.tip =
      parameter.name + ": " + WithSign(FormatSignificant(found.at, 3)) + unit;
  const std::optional<Knowledge> known = KnowledgeOf(result, parameter);
  if (known && std::isinf(known->std)) {
    found.lower = -kInfinity;
    found.upper = kInfinity;
    found.tip += "\nnot determined by these poses";
  } else if (known) {
    const ConfidenceInterval& range = known->interval;
    const double reach = kHalfWidth95 * known->std;
    found.lower = shift(std::isfinite(range.lower) ? range.lower
                                                   : parameter.value - reach);
    found.upper = shift(std::isfinite(range.upper) ? range.upper
                                                   : parameter.value + reach);
    found.tip +=
        "\n± " + InUnit(known->std, parameter.dimension, 2) + unit + " (1 std)";
  }
  row.marks.push_back(found);
  return row;
}

// A weakly identifiable parameter's bar would leave no room for others: the
// range ends at four times the reach of all changes and usual bars.
ValueRange UsefulRange(const std::vector<ChartRow>& rows) {
  std::vector<double> reaches;
  double largest = 0.0;
  for (const ChartRow& row : rows) {
    for (const RowMark& mark : row.marks) {
      const double half = (mark.upper - mark.lower) / 2.0;
      largest = std::max(largest, std::abs(mark.at));
      reaches.push_back(
          std::max(std::abs(mark.at), std::isnan(half) ? 0.0 : half));
    }
  }
  const auto middle =
      reaches.begin() + static_cast<std::ptrdiff_t>(reaches.size() / 2);
  std::nth_element(reaches.begin(), middle, reaches.end());
  const double most = 4.0 * std::max(largest, *middle);
  ValueRange range;
  for (const ChartRow& row : rows) {
    for (const RowMark& mark : row.marks) {
      for (const double value : {mark.at, mark.lower, mark.upper}) {
        if (std::abs(value) <= most) range.Include(value);
      }
    }
  }
  return range;
}

// Changes with their uncertainty, lengths and angles apart.
std::string ChangeFigure(const CalibrationResult& result, Dimension dimension) {
  const bool is_length = dimension == Dimension::kLength;
  RowChart chart;
  bool has_truth = false;
  for (const ParameterResult& parameter : result.parameters) {
    if (parameter.decision.state != ParameterState::kFree ||
        parameter.dimension != dimension || !IsOfJoint(parameter)) {
      continue;
    }
    chart.rows.push_back(ChangeRow(result, parameter));
    has_truth |= parameter.truth.has_value();
  }
  if (chart.rows.empty()) return "";
  chart.title = std::string(is_length ? "Lengths" : "Angles") +
                ": deviation from nominal";
  chart.x.label = std::string("deviation [") + UnitForPeople(dimension) + "]";
  chart.range = UsefulRange(chart.rows);
  chart.references = {0.0};
  chart.looks = {Markers(has_truth ? "identified" : "", MarkerStyle::kDot)};
  if (has_truth) {
    chart.looks.push_back(Markers("true", MarkerStyle::kSquare, "s7"));
  }
  bool is_cut = false;
  for (const ChartRow& row : chart.rows) {
    for (const RowMark& mark : row.marks) {
      is_cut |= mark.lower < chart.range.min || mark.upper > chart.range.max;
    }
  }
  return HtmlFigure(
      is_length ? "changes-lengths" : "changes-angles", chart,
      is_cut ? "Bars that end in an arrow reach beyond the figure." : "");
}

std::string CountAssessments(const CalibrationResult& result) {
  std::vector<std::string> parts;
  for (const ParameterAssessment assessment :
       {ParameterAssessment::kEstimated, ParameterAssessment::kPriorDominated,
        ParameterAssessment::kWeak, ParameterAssessment::kFixed,
        ParameterAssessment::kKnown}) {
    const auto count =
        std::count_if(result.parameters.begin(), result.parameters.end(),
                      [assessment](const ParameterResult& parameter) {
                        return parameter.assessment == assessment;
                      });
    if (count == 0) continue;
    parts.push_back(std::to_string(count) + " " +
                    AssessmentForPeople(assessment));
  }
  return "Of " +
         Count(static_cast<std::int64_t>(result.parameters.size()),
               "parameter") +
         ": " + Join(parts, ", ") + ".";
}

}  // namespace

PageSection ParametersSection(const CalibrationResult& result) {
  const bool is_known =
      std::any_of(result.parameters.begin(), result.parameters.end(),
                  [&](const ParameterResult& parameter) {
                    return KnowledgeOf(result, parameter).has_value();
                  });
  std::string html = HtmlParagraph(CountAssessments(result));
  if (!is_known) {
    html +=
        HtmlNote("No standard deviations were computed for these parameters.");
  } else if (!result.uncertainty) {
    html += HtmlNote(
        "Standard deviations are those predicted from the poses and the stated "
        "or estimated accuracy of the instrument; bars are 95 % intervals by "
        "them.");
  }
  html += HtmlPair({ChangeFigure(result, Dimension::kLength),
                    ChangeFigure(result, Dimension::kAngle)});
  html += EstimatedTable(result).ToHtml();
  const Table held = HeldTable(result);
  html +=
      HtmlFold(Count(static_cast<std::int64_t>(held.num_rows()), "parameter") +
                   (held.num_rows() == 1 ? " is" : " are") +
                   " not estimated: unidentifiable, or known",
               held.ToHtml());
  if (result.uncertainty) {
    html += HtmlFold("Strongly correlated parameters",
                     CorrelationTable(*result.uncertainty).ToHtml(), false);
  }
  return {"parameters", "Parameters", html};
}

}  // namespace alidade::internal
