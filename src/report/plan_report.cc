#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "src/common/format.h"
#include "src/common/text.h"
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

std::string Opening(const PlanResult& result) {
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
  return text;
}

std::string EvaluationTable(const PlanResult& result) {
  Table table({"predicted std of a position [mm]", ">candidates, worst", ">rms",
               ">region, worst", ">rms", ">O1", ">condition"});
  for (const PlanEvaluation& evaluation : result.evaluations) {
    const ObservabilityIndices& indices = evaluation.observability;
    table.AddRow({evaluation.name, Millimetres(evaluation.candidates.worst),
                  Millimetres(evaluation.candidates.rms),
                  Millimetres(evaluation.region.worst),
                  Millimetres(evaluation.region.rms),
                  FormatSignificant(indices.o1, 3),
                  FormatSignificant(indices.condition, 3)});
  }
  return table.ToText();
}

// Of the information of the best plan. The bound is far below what a plan
// really has where there are fewer poses than the parameters need and priors
// determine the rest: it then says nothing.
constexpr double kWorthTelling = 0.5;

std::string Verdict(const PlanResult& result) {
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
  return Paragraph(text);
}

std::string CurveTable(const PlanResult& result) {
  const bool has_bound = result.curve.front().bound > 0.0;
  std::vector<Table::Column> columns = {">poses", ">planned, worst", ">rms",
                                        ">random, worst", ">rms"};
  if (has_bound) columns.emplace_back(">bound");
  Table table(columns);
  for (const PlanCurvePoint& point : result.curve) {
    std::vector<TableCell> row = {
        std::to_string(point.num_poses), Millimetres(point.planned.worst),
        Millimetres(point.planned.rms), Millimetres(point.random.worst),
        Millimetres(point.random.rms)};
    if (has_bound) row.emplace_back(Millimetres(point.bound));
    table.AddRow(row);
  }
  return table.ToText();
}

std::string ParameterTable(const PlanResult& result) {
  Table table({"parameter", "unit", ">prior", ">planned std", ">random std",
               "identified combination"});
  for (const PlannedParameter& parameter : result.parameters) {
    const double unit =
        parameter.dimension == Dimension::kAngle ? kDegree : kMillimetre;
    table.AddRow({parameter.name, UnitForPeople(parameter.dimension),
                  std::isfinite(parameter.prior_std)
                      ? FormatSignificant(parameter.prior_std / unit, 3)
                      : "-",
                  FormatSignificant(parameter.planned_std / unit, 3),
                  FormatSignificant(parameter.random_std / unit, 3),
                  parameter.identified_combination});
  }
  return table.ToText();
}

// Compliances in mrad/(N m), all others in mrad.
std::string TermTable(const PlanResult& result) {
  constexpr double kMilliradian = 1e-3;
  Table table({"error term", "unit", ">prior", ">planned std",
               ">poses that halve the prior"});
  for (const PlannedErrorTerm& term : result.terms) {
    table.AddRow({term.name, "m" + term.unit,
                  FormatSignificant(term.prior_std / kMilliradian, 3),
                  FormatSignificant(term.planned_std / kMilliradian, 3),
                  term.poses_needed > 0 ? std::to_string(term.poses_needed)
                                        : "no number"});
  }
  return table.ToText();
}

std::string PoseTable(const PlanResult& result) {
  std::vector<Table::Column> columns = {">pose"};
  const Eigen::Index n = result.joint_values.rows();
  for (Eigen::Index j = 0; j < n; ++j) {
    columns.emplace_back(">q" + std::to_string(j + 1) + " " +
                         UnitForPeople(result.joint_dimensions[j]));
  }
  columns.emplace_back(">std mm");
  Table table(columns);
  for (Eigen::Index k = 0; k < result.joint_values.cols(); ++k) {
    std::vector<TableCell> row = {std::to_string(k + 1)};
    for (Eigen::Index j = 0; j < n; ++j) {
      row.emplace_back(FormatParameter(result.joint_values(j, k),
                                       result.joint_dimensions[j], 4));
    }
    row.emplace_back(Millimetres(result.pose_std[k]));
    table.AddRow(row);
  }
  return table.ToText();
}

std::string CurveChart(const PlanResult& result) {
  LineChart chart{"Predicted accuracy by the number of poses",
                  Count(NumPoses(result), "planned pose") + ": worst " +
                      FormatLength(result.evaluations.front().region.worst, 3) +
                      " over the region, random ones " +
                      FormatLength(result.evaluations[2].region.worst, 3),
                  LogarithmicAxis("poses"),
                  LogarithmicAxis("standard deviation of a position [mm]")};
  const auto add = [&](const char* label, MarkerStyle marker, const auto& of) {
    ChartSeries& series = chart.series.emplace_back();
    series.label = label;
    series.marker = marker;
    for (const PlanCurvePoint& point : result.curve) {
      series.x.push_back(point.num_poses);
      series.y.push_back(of(point) / kMillimetre);
    }
  };
  constexpr MarkerStyle kDot = MarkerStyle::kDot;
  using Point = PlanCurvePoint;
  add("random, worst", kDot, [](const Point& p) { return p.random.worst; });
  add("random, rms", kDot, [](const Point& p) { return p.random.rms; });
  add("planned, worst", kDot, [](const Point& p) { return p.planned.worst; });
  add("planned, rms", kDot, [](const Point& p) { return p.planned.rms; });
  if (result.curve.front().bound > 0.0) {
    add("bound of the worst, sigma sqrt(p / N)", MarkerStyle::kNone,
        [](const Point& p) { return p.bound; });
  }
  if (result.wanted > 0.0) {
    chart.references.push_back({result.wanted / kMillimetre, "wanted"});
  }
  return RenderSvg(chart);
}

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
  std::string text = Paragraph(Opening(result)) + "\n" +
                     EvaluationTable(result) + "\n" + Verdict(result);
  if (result.wanted > 0.0) {
    text += "\n" + Paragraph(
                       "So many poses bring the worst over the region to "
                       "the wanted " +
                       FormatLength(result.wanted) + ".");
  }
  if (!result.curve.empty()) {
    text +=
        "\nBy the number of poses, over the region [mm]\n" + CurveTable(result);
  }
  return text;
}

std::string FormatPlan(const PlanResult& result) {
  std::string text =
      Heading(result.title, '=') + "\n" + FormatPlanSummary(result) + "\n" +
      Heading("Parameters, predicted standard deviations") + "\n" +
      ParameterTable(result) + "\n" +
      (result.terms.empty()
           ? ""
           : Heading("Error terms") + "\n" + TermTable(result) + "\n") +
      Heading("Poses, in the order to be measured") + "\n" + PoseTable(result) +
      "\n";
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
  return {{"accuracy.svg", CurveChart(result)},
          {"curve.csv", CurveCsv(result)}};
}

}  // namespace alidade::internal
