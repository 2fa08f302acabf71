#include "src/report/budget_report.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "src/common/fields.h"
#include "src/common/format.h"
#include "src/common/text.h"
#include "src/report/markup.h"
#include "src/report/rows.h"
#include "src/report/table.h"
#include "src/uncertainty/uncertainty_fields.h"

namespace alidade::internal {
namespace {

constexpr std::size_t kMostRows = 30;
constexpr std::size_t kMostParameters = 8;

const UncertaintyBudget* BudgetOf(const CalibrationResult& result) {
  return result.uncertainty && result.uncertainty->budget
             ? &*result.uncertainty->budget
             : nullptr;
}

TableCell FreedomCell(double freedom) {
  return std::isfinite(freedom) ? NumberCell(freedom, 3) : TableCell("∞");
}

TableCell LengthCell(double length) {
  return QuantityCell(length, Dimension::kLength, 3);
}

Table ContributionTable(const UncertaintyBudget& budget) {
  Table table(
      "budget-contributions",
      "Contributions to a coordinate of the target's position",
      {"contribution", "type|A: by statistics of observations; B: as stated",
       ">std [mm]|standard uncertainty", ">dof|degrees of freedom",
       ">sensitivity",
       ">part [%]|of the variance of a position measured once more",
       Table::Column("~from").Wrapped(34)});
  for (const BudgetContribution& one : budget.contributions) {
    const double ratio = one.std / budget.measured.std;
    TableCell source(WordOf(one.source));
    // The longest word would be broken.
    source.markup =
        Element("span", {{"style", "white-space: nowrap"}}, source.text);
    table.AddRow(
        {source, WordOf(one.type), LengthCell(one.std),
         FreedomCell(one.degrees_of_freedom),
         one.source == BudgetSource::kParameters ? "each its own" : "1",
         FixedCell(100.0 * ratio * ratio, 1), one.basis});
  }
  return table;
}

Table CombinedTable(const UncertaintyBudget& budget) {
  Table table("budget-combined", "Combined and expanded uncertainty",
              {"of", ">std [mm]|combined standard uncertainty of a coordinate",
               ">dof|effective degrees of freedom", ">factor|coverage factor",
               ">expanded [mm]|expanded uncertainty of a coordinate",
               ">radius [mm]|about the predicted position"});
  const auto add = [&table](const char* of, const CombinedUncertainty& one) {
    table.AddRow({of, LengthCell(one.std), FreedomCell(one.degrees_of_freedom),
                  NumberCell(one.coverage_factor, 3), LengthCell(one.expanded),
                  LengthCell(one.expanded_distance)});
  };
  add("the arm's position", budget.position);
  add("a position measured once more", budget.measured);
  return table;
}

Table SensitivityTable(const UncertaintyBudget& budget) {
  const std::string sensitivity =
      ">sensitivity [mm per unit]|root mean square over the region of what a "
      "coordinate moves by";
  Table table("budget-parameters", "Of which the parameters, each by itself",
              {"parameter", "unit", ">std|standard uncertainty", sensitivity,
               ">contribution [mm]"});
  for (const ParameterContribution& one : budget.parameters) {
    const double unit = UnitOf(one.dimension);
    table.AddRow({one.name, UnitForPeople(one.dimension),
                  QuantityCell(one.std, one.dimension, 3),
                  NumberCell(one.sensitivity * unit / kMillimetre, 3),
                  LengthCell(one.contribution())});
  }
  return table;
}

std::string DescribeRegion(const UncertaintyBudget& budget) {
  if (budget.region.empty()) return "all that the joint limits allow";
  std::vector<std::string> boxes;
  for (const WorkspaceBox& box : budget.region) {
    std::vector<std::string> sides;
    for (int axis = 0; axis < 3; ++axis) {
      sides.push_back(std::string(1, "xyz"[axis]) + " from " +
                      Millimetres(box.lower[axis]) + " to " +
                      Millimetres(box.upper[axis]));
    }
    boxes.push_back(Join(sides, ", ") + " mm");
  }
  return Join(boxes, "; or ") + ", in the base's frame";
}

// Of an arm whose residuals are no more than the instrument's noise.
std::string UnknownRepeatability(const UncertaintyBudget& budget) {
  bool is_unknown = false;
  bool has_model = false;
  for (const BudgetContribution& one : budget.contributions) {
    if (one.source == BudgetSource::kRepeatability) {
      is_unknown = one.basis.rfind("unknown", 0) == 0;
    } else if (one.source != BudgetSource::kParameters &&
               one.source != BudgetSource::kMeasurement) {
      has_model = has_model || one.std > 0.0;
    }
  }
  return is_unknown && !has_model
             ? " The arm's own repeatability is not in it: neither repeated "
               "configurations nor residuals show any."
             : "";
}

std::string DescribeBudget(const UncertaintyBudget& budget) {
  return "Task region: " + DescribeRegion(budget) + " (" +
         Count(budget.configurations, "configuration") +
         "). There the arm reaches a position, as the calibrated model "
         "predicts "
         "it, with an expanded uncertainty of " +
         FormatLength(budget.position.expanded, 3) +
         " in each coordinate (coverage factor " +
         FormatSignificant(budget.position.coverage_factor, 3) + ", " +
         FormatPercent(budget.confidence, 3) + ", JCGM 100:2008); " +
         FormatPercent(budget.confidence, 3) + " of positions are within " +
         FormatLength(budget.position.expanded_distance, 3) +
         ". Largest combined standard uncertainty of a coordinate: " +
         FormatLength(budget.worst_std, 3) + "." + UnknownRepeatability(budget);
}

constexpr char kCorrelated[] =
    "The estimates of parameters are correlated: their contributions do not "
    "add up in squares to the first line, which contains the correlations. "
    "budget.csv lists all of them.";

Table PerformanceTable(const CalibrationResult& result) {
  Table table("iso9283", "Pose accuracy and repeatability (ISO 9283) [mm]",
              {"poses", ">configurations", ">n at least|measurements of each",
               ">AP before|mean pose accuracy by the nominal arm", ">max",
               ">AP after|by the calibrated one", ">max",
               ">RP|mean pose repeatability", ">max"});
  for (const PosePerformanceSummary& set : result.pose_performance) {
    table.AddRow({set.poses, CountCell(set.configurations),
                  CountCell(set.fewest), LengthCell(set.before.mean),
                  LengthCell(set.before.max), LengthCell(set.accuracy.mean),
                  LengthCell(set.accuracy.max),
                  LengthCell(set.repeatability.mean),
                  LengthCell(set.repeatability.max)});
  }
  return table;
}

TableCell AnglesCell(const Eigen::Vector3d& angles) {
  if (!angles.allFinite()) return "";
  std::vector<std::string> texts;
  for (const double angle : angles) {
    texts.push_back(FormatSignificant(angle / kDegree, 2));
  }
  return Join(texts, ", ");
}

bool HasRotations(const PosePerformanceSummary& set) {
  return std::any_of(set.each.begin(), set.each.end(),
                     [](const PosePerformance& one) {
                       return one.rotation_accuracy.allFinite();
                     });
}

Table EachTable(const PosePerformanceSummary& set) {
  const bool has_rotations = HasRotations(set);
  std::vector<Table::Column> columns = {
      ">pose|the first of those measured there",
      "target",
      ">n",
      ">AP before",
      ">AP after",
      ">mean distance|from the barycentre",
      ">its std",
      ">RP"};
  if (has_rotations) {
    columns.emplace_back("AP a, b, c [deg]");
    columns.emplace_back("RP a, b, c [deg]");
  }
  Table table("iso9283-" + set.poses,
              "Each repeated configuration, " + set.poses + " poses [mm]",
              std::move(columns));
  for (const PosePerformance& one : set.each) {
    std::vector<TableCell> row = {CountCell(one.pose + 1),
                                  one.target,
                                  CountCell(one.n),
                                  LengthCell(one.before),
                                  LengthCell(one.accuracy),
                                  LengthCell(one.mean_distance),
                                  LengthCell(one.distance_std),
                                  LengthCell(one.repeatability())};
    if (has_rotations) {
      row.push_back(AnglesCell(one.rotation_accuracy));
      row.push_back(AnglesCell(one.rotation_repeatability));
    }
    table.AddRow(std::move(row));
  }
  return table;
}

std::string DescribePerformance(const CalibrationResult& result) {
  constexpr std::int64_t kCycles = 30;
  constexpr std::int64_t kPoses = 5;
  std::string text =
      "By ISO 9283:1998 at the configurations that were measured more than "
      "once: pose accuracy AP, the distance from the commanded position to the "
      "barycentre of the attained ones, and pose repeatability RP, their mean "
      "distance from it and three standard deviations of these distances. "
      "Commanded is what the model predicts, before and after calibration.";
  const bool is_short = std::any_of(
      result.pose_performance.begin(), result.pose_performance.end(),
      [](const PosePerformanceSummary& set) {
        return set.fewest < kCycles || set.configurations < kPoses;
      });
  if (is_short) {
    text +=
        " The standard asks for 30 measurements of each of 5 poses: RP of "
        "fewer is uncertain.";
  }
  return text;
}

// A row of budget.csv: what is not a length has `unit`s.
struct BudgetRow {
  std::string quantity;
  std::string type;
  std::string unit;
  double std = 0.0;
  double freedom = 0.0;
  double sensitivity = 1.0;
  double contribution = 0.0;  // (m)
  std::string basis;
};

void AppendRow(const BudgetRow& row, std::string* csv) {
  AppendTextCell(row.quantity, csv);
  *csv += ',';
  AppendCsvCells(csv, row.type, row.unit, row.std, row.freedom, row.sensitivity,
                 row.contribution / kMillimetre);
  AppendTextCell(row.basis, csv);
  *csv += '\n';
}

void AppendLength(const std::string& quantity, double length, double freedom,
                  const std::string& basis, std::string* csv) {
  AppendRow(
      {quantity, "", "mm", length / kMillimetre, freedom, 1.0, length, basis},
      csv);
}

void AppendCombined(const std::string& of, const CombinedUncertainty& one,
                    double confidence, std::string* csv) {
  const double freedom = one.degrees_of_freedom;
  const std::string rate = FormatPercent(confidence, 3);
  AppendLength("combined: " + of, one.std, freedom, "", csv);
  AppendLength("expanded: " + of, one.expanded, freedom,
               "coverage factor " + FormatSignificant(one.coverage_factor, 4) +
                   "; " + rate + " of coordinates",
               csv);
  AppendLength("radius: " + of, one.expanded_distance, freedom,
               rate + " of positions", csv);
}

std::string BudgetCsv(const UncertaintyBudget& budget) {
  std::string csv =
      "quantity,type,unit,standard_uncertainty,degrees_of_freedom,sensitivity,"
      "contribution_mm,basis\n";
  for (const BudgetContribution& one : budget.contributions) {
    AppendRow(
        {WordOf(one.source), WordOf(one.type), "mm", one.std / kMillimetre,
         one.degrees_of_freedom, 1.0, one.std, one.basis},
        &csv);
  }
  for (const ParameterContribution& one : budget.parameters) {
    const double unit = UnitOf(one.dimension);
    AppendRow({one.name, "A", UnitForPeople(one.dimension), one.std / unit,
               budget.contributions.front().degrees_of_freedom,
               one.sensitivity * unit / kMillimetre, one.contribution(),
               "part of parameters without correlations"},
              &csv);
  }
  AppendCombined("the arm's position", budget.position, budget.confidence,
                 &csv);
  AppendCombined("a position measured once more", budget.measured,
                 budget.confidence, &csv);
  return csv;
}

std::string PerformanceCsv(const CalibrationResult& result) {
  std::string csv =
      "poses,pose,target,n,AP_before_mm,AP_mm,mean_distance_mm,"
      "distance_std_mm,RP_mm,AP_a_deg,AP_b_deg,AP_c_deg,RP_a_deg,RP_b_deg,"
      "RP_c_deg\n";
  for (const PosePerformanceSummary& set : result.pose_performance) {
    for (const PosePerformance& one : set.each) {
      AppendCsvCells(&csv, set.poses, one.pose + 1);
      AppendTextCell(one.target, &csv);
      csv += ',' + std::to_string(one.n);
      for (const double length : {one.before, one.accuracy, one.mean_distance,
                                  one.distance_std, one.repeatability()}) {
        csv += ',' + ShortestNumber(length / kMillimetre);
      }
      for (const auto* angles :
           {&one.rotation_accuracy, &one.rotation_repeatability}) {
        for (const double angle : *angles) {
          csv += ',';
          if (std::isfinite(angle)) csv += ShortestNumber(angle / kDegree);
        }
      }
      csv += '\n';
    }
  }
  return csv;
}

}  // namespace

std::string BudgetText(const CalibrationResult& result) {
  std::string text;
  if (const UncertaintyBudget* const budget = BudgetOf(result)) {
    text += Paragraph(DescribeBudget(*budget)) + "\n" +
            ContributionTable(*budget).ToText() + "\n" +
            CombinedTable(*budget).ToText();
  }
  if (!result.pose_performance.empty()) {
    if (!text.empty()) text += "\n";
    text += Paragraph(DescribePerformance(result)) + "\n" +
            PerformanceTable(result).ToText();
  }
  return text;
}

PageSection BudgetSection(const CalibrationResult& result) {
  std::string html;
  if (const UncertaintyBudget* const budget = BudgetOf(result)) {
    html += HtmlParagraph(DescribeBudget(*budget)) +
            ContributionTable(*budget).ToHtml() +
            CombinedTable(*budget).ToHtml() +
            SensitivityTable(*budget).ToHtml(kMostParameters) +
            HtmlNote(kCorrelated);
  }
  if (!result.pose_performance.empty()) {
    html += HtmlParagraph(DescribePerformance(result)) +
            PerformanceTable(result).ToHtml();
    for (const PosePerformanceSummary& set : result.pose_performance) {
      html += EachTable(set).ToHtml(kMostRows);
    }
  }
  return {"budget", "Uncertainty budget and ISO 9283", html};
}

std::vector<ReportFile> MakeBudgetFiles(const CalibrationResult& result) {
  std::vector<ReportFile> files;
  if (const UncertaintyBudget* const budget = BudgetOf(result)) {
    files.emplace_back("budget.csv", BudgetCsv(*budget));
  }
  if (!result.pose_performance.empty()) {
    files.emplace_back("iso9283.csv", PerformanceCsv(result));
  }
  return files;
}

}  // namespace alidade::internal
