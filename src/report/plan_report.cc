#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "src/common/format.h"
#include "src/common/text.h"
#include "src/report/plan_tables.h"
#include "src/report/report.h"
#include "src/report/rows.h"
#include "src/report/svg_chart.h"
#include "src/report/table.h"

namespace alidade::internal {
namespace {

int NumPoses(const PlanResult& result) {
  return static_cast<int>(result.joint_values.cols());
}

std::string Measured(const PlanResult& result) {
  std::string text = "a " + result.measured + " of " +
                     FormatLength(result.sigma, 3) + " standard deviation";
  if (result.rotation_sigma > 0.0) {
    text +=
        " (" + FormatSignificant(result.rotation_sigma / kDegree, 3) + " deg)";
  }
  return text;
}

// Of the information of the best plan. The bound is far below what a plan
// really has where there are fewer poses than the parameters need and priors
// determine the rest: it then says nothing.
constexpr double kWorthTelling = 0.5;

TableCell Length(double metres) {
  return QuantityCell(metres, Dimension::kLength, 3);
}

}  // namespace

std::string PlanOpening(const PlanResult& result) {
  std::string text =
      Count(NumPoses(result), "pose") + " (" +
      std::to_string(result.num_distinct) + " different) of " +
      Count(result.num_candidates, "candidate") + " to find " +
      Count(static_cast<std::int64_t>(result.parameters.size()), "parameter") +
      " of " + result.arm + ", criterion " + result.criterion + ", " +
      Count(result.equations, "measurement") +
      " at a pose: " + Measured(result) + ".";
  if (result.measured_before > 0) {
    text += " " + Count(result.measured_before, "pose") + " measured before " +
            (result.measured_before == 1 ? "is" : "are") +
            " taken into account.";
  }
  if (result.has_priors) {
    text += " Priors are taken into account.";
  }
  if (!result.terms.empty()) {
    text +=
        " " +
        Count(static_cast<std::int64_t>(result.terms.size()), "error term") +
        " beyond rigid geometry, held by priors, " +
        (result.terms.size() == 1 ? "is" : "are") +
        " to be found with them, and count in what is predicted; `errors: "
        "none` plans for the geometry alone.";
  }
  return text;
}

Table PlanEvaluationTable(const PlanResult& result) {
  Table table("plan-evaluations", "Beside other poses, as many of them",
              {"predicted std of a position [mm]", ">candidates, worst",
               ">rms|over the candidates", ">region, worst",
               ">rms|over the region", ">O1", ">condition"});
  for (const PlanEvaluation& evaluation : result.evaluations) {
    const ObservabilityIndices& indices = evaluation.observability;
    table.AddRow({evaluation.name, Length(evaluation.candidates.worst),
                  Length(evaluation.candidates.rms),
                  Length(evaluation.region.worst),
                  Length(evaluation.region.rms), NumberCell(indices.o1, 3),
                  NumberCell(indices.condition, 3)});
  }
  return table;
}

std::string PlanQuality(const PlanResult& result) {
  std::string text;
  if (result.bound > 0.0) {
    const double worst = result.evaluations.front().candidates.worst;
    text += "No plan of " + Count(NumPoses(result), "pose") +
            " has a worst standard deviation over the candidates below sigma "
            "sqrt(p / N) = " +
            FormatLength(result.bound) + ": this one is " +
            FormatSignificant(100.0 * (worst / result.bound - 1.0), 2) +
            " % above. ";
  }
  if (result.d_efficiency >= kWorthTelling) {
    text += "It has at least " +
            FormatSignificant(100.0 * result.d_efficiency, 3) +
            " % of the information (D) that any plan of as many of these "
            "candidates could have. ";
  }
  text +=
      "Travel " +
      (result.travel_in_seconds
           ? FormatDuration(result.travel) + " instead of " +
                 FormatDuration(result.travel_before)
           : FormatSignificant(result.travel / kDegree, 4) + " instead of " +
                 FormatSignificant(result.travel_before / kDegree, 4) +
                 " deg (the largest joint's of each move)") +
      ".";
  return text;
}

std::string LinkCautionText(const PlanResult& result) {
  const LinkCaution& links = result.links;
  if (!(links.radius > 0.0)) return "";
  const std::string model =
      "capsules of " + FormatLength(links.radius, 3) +
      " radius about the segments between the origins of its joints, "
      "neighbours left out";
  constexpr char kWorth[] =
      "This is a caution by a rough model of the arm, not a check: ";
  if (links.overlaps.empty()) {
    return "No two links of the arm come close to each other at a planned "
           "pose (" +
           model + "). " + kWorth + "drive the plan slowly at first.";
  }
  // Pairs in the order in which they are met.
  std::vector<std::pair<std::string, std::vector<std::string>>> pairs;
  std::set<int> poses;
  for (const LinkOverlap& overlap : links.overlaps) {
    poses.insert(overlap.pose);
    const std::string name = overlap.first + " and " + overlap.second;
    auto pair = std::find_if(pairs.begin(), pairs.end(), [&](const auto& each) {
      return each.first == name;
    });
    if (pair == pairs.end()) pair = pairs.insert(pair, {name, {}});
    pair->second.push_back(std::to_string(overlap.pose));
  }
  constexpr std::size_t kMostNamed = 12;
  std::vector<std::string> parts;
  for (auto& [name, numbers] : pairs) {
    const std::size_t more =
        numbers.size() - std::min(numbers.size(), kMostNamed);
    numbers.resize(numbers.size() - more);
    parts.push_back(name + " (pose" + (numbers.size() == 1 ? " " : "s ") +
                    Join(numbers, ", ") +
                    (more > 0 ? " and " + std::to_string(more) + " more" : "") +
                    ")");
  }
  return "The arm may be in its own way at " +
         Count(static_cast<std::int64_t>(poses.size()), "pose") + " (" + model +
         "): " + Join(parts, "; ") + ". " + kWorth +
         "look at these poses before the arm drives to them; link_radius in "
         "the "
         "plan states another radius.";
}

Table PlanCurveTable(const PlanResult& result) {
  const bool has_bound = result.curve.front().bound > 0.0;
  std::vector<Table::Column> columns = {
      ">poses", ">planned, worst", ">rms|of planned poses", ">random, worst",
      ">rms|of random poses"};
  if (has_bound) columns.emplace_back(">bound");
  Table table("plan-curve", "By the number of poses, over the region [mm]",
              columns);
  for (const PlanCurvePoint& point : result.curve) {
    std::vector<TableCell> row = {
        CountCell(point.num_poses), Length(point.planned.worst),
        Length(point.planned.rms), Length(point.random.worst),
        Length(point.random.rms)};
    if (has_bound) row.emplace_back(Length(point.bound));
    table.AddRow(row);
  }
  return table;
}

Table PlannedParameterTable(const PlanResult& result) {
  Table table("plan-parameters", "Predicted standard deviations",
              {"parameter", "unit", ">prior", ">planned std", ">random std",
               "identified combination"});
  for (const PlannedParameter& parameter : result.parameters) {
    const Dimension dimension = parameter.dimension;
    table.AddRow({parameter.name, UnitForPeople(dimension),
                  std::isfinite(parameter.prior_std)
                      ? QuantityCell(parameter.prior_std, dimension, 3)
                      : TableCell("-"),
                  QuantityCell(parameter.planned_std, dimension, 3),
                  QuantityCell(parameter.random_std, dimension, 3),
                  parameter.identified_combination});
  }
  return table;
}

// Compliances in mrad/(N m), all others in mrad.
Table PlannedTermTable(const PlanResult& result) {
  constexpr double kMilliradian = 1e-3;
  Table table("plan-terms", "Error terms",
              {"error term", "unit", ">prior", ">planned std",
               ">poses that halve the prior"});
  for (const PlannedErrorTerm& term : result.terms) {
    table.AddRow({term.name, "m" + term.unit,
                  NumberCell(term.prior_std / kMilliradian, 3),
                  NumberCell(term.planned_std / kMilliradian, 3),
                  term.poses_needed > 0 ? CountCell(term.poses_needed)
                                        : TableCell("no number")});
  }
  return table;
}

Table JointCoverageTable(const PlanResult& result) {
  Table table("joint-coverage", "How much of its range each joint uses",
              {"joint", "unit", ">limits", ">used", ">share [%]"});
  for (Eigen::Index j = 0; j < result.joint_values.rows(); ++j) {
    const Joint& joint = result.planned_arm.joints[static_cast<std::size_t>(j)];
    const Dimension dimension =
        result.joint_dimensions[static_cast<std::size_t>(j)];
    const double least = result.joint_values.row(j).minCoeff();
    const double largest = result.joint_values.row(j).maxCoeff();
    const auto range = [dimension](double from, double to) {
      return InUnit(from, dimension, 4) + " to " + InUnit(to, dimension, 4);
    };
    const bool is_limited = HasLimits(joint);
    const double share = (largest - least) / (joint.upper - joint.lower);
    table.AddRow({std::to_string(j + 1), UnitForPeople(dimension),
                  is_limited ? range(joint.lower, joint.upper) : "none",
                  range(least, largest),
                  is_limited ? NumberCell(100.0 * share, 3) : TableCell("-")});
  }
  return table;
}

Table PlannedPoseTable(const PlanResult& result) {
  std::vector<Table::Column> columns = {">pose"};
  const Eigen::Index n = result.joint_values.rows();
  for (Eigen::Index j = 0; j < n; ++j) {
    columns.emplace_back(">q" + std::to_string(j + 1) + " " +
                         UnitForPeople(result.joint_dimensions[j]));
  }
  columns.emplace_back(">std mm");
  Table table("plan-poses", "Poses, in the order to be measured", columns);
  for (Eigen::Index k = 0; k < result.joint_values.cols(); ++k) {
    std::vector<TableCell> row = {CountCell(k + 1)};
    for (Eigen::Index j = 0; j < n; ++j) {
      const double value = result.joint_values(j, k);
      const Dimension dimension = result.joint_dimensions[j];
      row.emplace_back(FormatParameter(value, dimension, 4),
                       value / UnitOf(dimension));
    }
    row.push_back(Length(result.pose_std[k]));
    table.AddRow(row);
  }
  return table;
}

LineChart PlanCurveChart(const PlanResult& result) {
  LineChart chart{"Predicted accuracy by the number of poses",
                  Count(NumPoses(result), "planned pose") + ": worst " +
                      FormatLength(result.evaluations.front().region.worst, 3) +
                      " over the region, random ones " +
                      FormatLength(result.evaluations[2].region.worst, 3),
                  LogarithmicAxis("poses"),
                  LogarithmicAxis("predicted std [mm]")};
  const auto add = [&](const std::string& label, const char* look,
                       const auto& of) {
    ChartSeries& series = chart.series.emplace_back();
    series.label = label;
    series.colour = look;
    for (const PlanCurvePoint& point : result.curve) {
      series.x.push_back(point.num_poses);
      series.y.push_back(of(point) / kMillimetre);
    }
    series.tip = [label, x = series.x, y = series.y](std::size_t i) {
      return label + "\n" + Count(static_cast<std::int64_t>(x[i]), "pose") +
             ": " + FormatSignificant(y[i], 3) + " mm";
    };
    return &series;
  };
  using Point = PlanCurvePoint;
  add("random, worst", "s2 solid", [](const Point& p) {
    return p.random.worst;
  })->marker = MarkerStyle::kSquare;
  add("random, rms", "s2 dashed", [](const Point& p) {
    return p.random.rms;
  })->marker = MarkerStyle::kSquare;
  add("planned, worst", "s1", [](const Point& p) {
    return p.planned.worst;
  })->marker = MarkerStyle::kDot;
  add("planned, rms", "s1 dashed", [](const Point& p) {
    return p.planned.rms;
  })->marker = MarkerStyle::kDot;
  if (result.curve.front().bound > 0.0) {
    add("bound of the worst, sigma sqrt(p / N)", "s0",
        [](const Point& p) { return p.bound; });
  }
  ValueRange range;
  for (const ChartSeries& series : chart.series) {
    for (const double y : series.y) {
      if (IsDrawable(chart.y, y)) range.Include(y);
    }
  }
  if (result.wanted > 0.0) {
    chart.references.push_back({result.wanted / kMillimetre, "wanted"});
    range.Include(result.wanted / kMillimetre);
  }
  // Whole decades would leave most of the chart empty.
  constexpr double kRoom = 1.3;
  if (!range.empty()) {
    chart.y.lower = range.min / kRoom;
    chart.y.upper = range.max * kRoom;
    chart.x.lower = result.curve.front().num_poses / kRoom;
    chart.x.upper = result.curve.back().num_poses * kRoom;
  }
  return chart;
}

namespace {

std::string CurveCsv(const PlanResult& result) {
  std::string csv =
      "poses,planned_worst_mm,planned_rms_mm,random_worst_mm,random_rms_mm,"
      "bound_mm\n";
  for (const PlanCurvePoint& point : result.curve) {
    const auto shown = [](double value) {
      return std::isfinite(value) && value > 0.0
                 ? value / kMillimetre
                 : std::numeric_limits<double>::quiet_NaN();
    };
    AppendCsvCells(&csv, point.num_poses, shown(point.planned.worst),
                   shown(point.planned.rms), shown(point.random.worst),
                   shown(point.random.rms));
    EndCsvRow(&csv, shown(point.bound));
  }
  return csv;
}

}  // namespace

std::string FormatPlanSummary(const PlanResult& result) {
  std::string text = Paragraph(PlanOpening(result)) + "\n" +
                     PlanEvaluationTable(result).ToText() + "\n" +
                     Paragraph(PlanQuality(result));
  if (result.wanted > 0.0) {
    text += "\n" + Paragraph(
                       "So many poses bring the worst over the region to "
                       "the wanted " +
                       FormatLength(result.wanted) + ".");
  }
  if (!result.curve.empty()) {
    text += "\nBy the number of poses, over the region [mm]\n" +
            PlanCurveTable(result).ToText();
  }
  const std::string caution = LinkCautionText(result);
  return caution.empty() ? text : text + "\n" + Paragraph(caution);
}

std::string FormatPlan(const PlanResult& result) {
  std::string text =
      Heading(result.title, '=') + "\n" + FormatPlanSummary(result) + "\n" +
      Heading("Parameters, predicted standard deviations") + "\n" +
      PlannedParameterTable(result).ToText() + "\n" +
      (result.terms.empty() ? ""
                            : Heading("Error terms") + "\n" +
                                  PlannedTermTable(result).ToText() + "\n") +
      Heading("How much of its range each joint uses") + "\n" +
      JointCoverageTable(result).ToText() + "\n" +
      Heading("Poses, in the order to be measured") + "\n" +
      PlannedPoseTable(result).ToText() + "\n";
  for (const std::string& warning : result.warnings) {
    text += Paragraph("Warning: " + warning);
  }
  text += Paragraph("alidade " + result.version + ", seed " +
                    std::to_string(result.seed) + ", " + result.command);
  for (const InputFile& input : result.inputs) {
    text += "  " + input.path + " sha256 " + input.sha256 + "\n";
  }
  return text;
}

std::vector<ReportFile> MakePlanFiles(const PlanResult& result) {
  if (result.curve.empty()) return {};
  return {{"accuracy.svg", RenderSvg(PlanCurveChart(result))},
          {"curve.csv", CurveCsv(result)}};
}

}  // namespace alidade::internal
