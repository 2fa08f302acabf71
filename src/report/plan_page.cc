#include "src/report/plan_page.h"

#include <cmath>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "src/common/format.h"
#include "src/common/text.h"
#include "src/report/arm_view.h"
#include "src/report/coverage_chart.h"
#include "src/report/markup.h"
#include "src/report/page.h"
#include "src/report/plan_tables.h"
#include "src/report/table.h"

namespace alidade::internal {
namespace {

constexpr std::size_t kMostPlannedRows = 1000;

std::string Determined(double metres) {
  return std::isfinite(metres) ? FormatLength(metres, 3) : "not determined";
}

// What random poses and the plan promise.
std::string Number(const std::string& title, double random, double planned) {
  std::string html =
      Element("div", {{"class", "small"}}, Words(title)) +
      Element("div", {{"class", "big"}},
              Element("span", {{"class", "now"}}, Words(Determined(planned)))) +
      Element("div", {{"class", "small"}},
              Words("random poses: " + Determined(random)));
  return Element("div", {}, html);
}

std::string Numbers(const PlanResult& result) {
  const PredictedAccuracy& planned = result.evaluations.front().region;
  const PredictedAccuracy& random = result.evaluations[2].region;
  std::size_t combined = 0;
  for (const PlannedParameter& parameter : result.parameters) {
    combined += parameter.identified_combination.empty() ? 0 : 1;
  }
  return Element(
      "div", {{"class", "numbers"}, {"id", "headline"}},
      Number("typical (rms) over the region", random.rms, planned.rms) +
          Number("worst over the region", random.worst, planned.worst) +
          HtmlFact("parameters determined",
                   std::to_string(result.parameters.size()),
                   combined == 0
                       ? "each by itself"
                       : std::to_string(combined) + " identify a combination"));
}

std::string Promise(const PlanResult& result) {
  const PredictedAccuracy& planned = result.evaluations.front().region;
  const PredictedAccuracy& random = result.evaluations[2].region;
  std::string text = Count(result.joint_values.cols(), "pose") +
                     " promise positions known to " + Determined(planned.rms) +
                     ", at worst " + Determined(planned.worst) +
                     " (standard deviations after the calibration)";
  if (std::isfinite(random.worst) && planned.worst < random.worst) {
    text += ". As many random poses: at worst " + Determined(random.worst) +
            ", " + FormatSignificant(random.worst / planned.worst, 2) +
            " times as much";
  } else if (!std::isfinite(random.worst)) {
    text += ". As many random poses do not determine all parameters";
  }
  return text + ".";
}

std::string Summary(const PlanResult& result, const ArmView& view) {
  std::set<int> doubtful;
  for (const LinkOverlap& overlap : result.links.overlaps) {
    doubtful.insert(overlap.pose);
  }
  std::vector<std::string> cautions;
  if (!doubtful.empty()) cautions.push_back(Words(LinkCautionText(result)));
  for (const std::string& warning : result.warnings) {
    cautions.push_back(Words(AsSentence(warning)));
  }
  const std::string title =
      doubtful.empty()
          ? std::string(cautions.empty() ? "Planned" : "Planned, with warnings")
          : "Planned; look at " +
                Count(static_cast<std::int64_t>(doubtful.size()), "pose") +
                " first";
  std::string left = Numbers(result) + HtmlParagraph(PlanOpening(result)) +
                     HtmlParagraph(PlanQuality(result));
  if (result.wanted > 0.0) {
    left += HtmlParagraph(
        "So many poses bring the worst over the region to the wanted " +
        FormatLength(result.wanted) + ".");
  }
  std::string html =
      HtmlVerdict(
          cautions.empty() ? FindingLevel::kPassed : FindingLevel::kAttention,
          title, Promise(result)) +
      HtmlPair({left, ArmViewFigure(view, "The arm at the planned poses")});
  if (!cautions.empty()) {
    html += Element(
        "div", {{"class", "warnings"}, {"id", "warnings"}},
        Element("strong", {}, "Before you drive it") + HtmlList(cautions, ""));
  }
  return Element("section", {{"id", "summary"}, {"aria-label", "Summary"}},
                 html);
}

PageSection AccuracySection(const PlanResult& result) {
  std::string html = PlanEvaluationTable(result).ToHtml();
  if (!result.curve.empty()) {
    html += HtmlPair({HtmlFigure("curve", PlanCurveChart(result),
                                 "Blue: planned, orange: random; full lines: "
                                 "the worst over the region, dashed ones: rms"),
                      PlanCurveTable(result).ToHtml()});
  }
  return {"accuracy", "Accuracy by the number of poses", html};
}

Figure CoverageFigure(const PlanResult& result) {
  CoverageChart chart{"How the range of each joint is used", ""};
  for (Eigen::Index j = 0; j < result.joint_values.rows(); ++j) {
    const Joint& joint = result.planned_arm.joints[static_cast<std::size_t>(j)];
    const Dimension dimension =
        result.joint_dimensions[static_cast<std::size_t>(j)];
    CoverageRow& row = chart.rows.emplace_back();
    row.label = "joint " + std::to_string(j + 1);
    row.unit = UnitForPeople(dimension);
    row.has_limits = HasLimits(joint);
    const Eigen::VectorXd values =
        result.joint_values.row(j).transpose() / UnitOf(dimension);
    row.values.assign(values.begin(), values.end());
    row.lower =
        row.has_limits ? joint.lower / UnitOf(dimension) : values.minCoeff();
    row.upper =
        row.has_limits ? joint.upper / UnitOf(dimension) : values.maxCoeff();
  }
  return chart;
}

// Pairs of links with their worst pose first.
Table OverlapTable(const PlanResult& result) {
  Table table("link-overlaps", "Links that may be in each other's way",
              {">pose", "link", "and", ">capsules overlap by [mm]"});
  for (const LinkOverlap& overlap : result.links.overlaps) {
    table.AddRow({CountCell(overlap.pose), overlap.first, overlap.second,
                  QuantityCell(overlap.overlap, Dimension::kLength, 3)});
  }
  return table;
}

PageSection PosesSection(const PlanResult& result) {
  return {"poses", "Poses",
          HtmlPair({HtmlFigure("coverage", CoverageFigure(result),
                               "24 equal parts of each joint's range; marks at "
                               "its ends are joint limits"),
                    JointCoverageTable(result).ToHtml()}) +
              HtmlParagraph(LinkCautionText(result), "caution") +
              OverlapTable(result).ToHtml(kMostPlannedRows) +
              PlannedPoseTable(result).ToHtml(kMostPlannedRows)};
}

// Of the parameters of one kind; nothing where there are none.
std::string DeviationFigure(const PlanResult& result, Dimension dimension) {
  const std::string unit = UnitForPeople(dimension);
  const bool is_angle = dimension == Dimension::kAngle;
  RowChart chart{
      is_angle ? "Angles" : "Lengths", "",
      LogarithmicAxis("predicted standard deviation [" + unit + "]")};
  chart.looks = {Markers("planned", MarkerStyle::kDot, "s1"),
                 Markers("random poses", MarkerStyle::kSquare, "s2"),
                 Markers("before (prior)", MarkerStyle::kTriangle, "s0")};
  bool has_prior = false;
  for (const PlannedParameter& parameter : result.parameters) {
    if (parameter.dimension != dimension) continue;
    ChartRow& row = chart.rows.emplace_back();
    row.label = parameter.name;
    const double values[] = {parameter.planned_std, parameter.random_std,
                             parameter.prior_std};
    for (std::size_t k = 0; k < chart.looks.size(); ++k) {
      if (!std::isfinite(values[k])) continue;
      has_prior |= k == 2;
      RowMark& mark = row.marks.emplace_back();
      mark.series = k;
      mark.at = values[k] / UnitOf(dimension);
      mark.tip = parameter.name + ", " + chart.looks[k].label + ": " +
                 FormatSignificant(mark.at, 3) + " " + unit;
    }
  }
  if (chart.rows.empty()) return "";
  if (!has_prior) chart.looks.pop_back();
  return HtmlFigure(is_angle ? "angle-deviations" : "length-deviations", chart);
}

PageSection PlannedParametersSection(const PlanResult& result) {
  return {"parameters", "What the poses determine",
          HtmlPair({DeviationFigure(result, Dimension::kAngle),
                    DeviationFigure(result, Dimension::kLength)}) +
              PlannedParameterTable(result).ToHtml() +
              PlannedTermTable(result).ToHtml()};
}

PageSection PlanProvenance(const PlanResult& result) {
  const std::vector<std::pair<std::string, std::string>> facts = {
      {"arm", EscapeXml(result.arm)},
      {"command", Element("code", {}, EscapeXml(result.command))},
      {"Alidade", EscapeXml(result.version)},
      {"seed", std::to_string(result.seed)},
      {"candidates", std::to_string(result.num_candidates) + " of " +
                         std::to_string(result.num_looked_at)},
      {"time", FormatDuration(result.total_time_s)}};
  std::string list;
  for (const auto& [name, value] : facts) {
    list += Element("dt", {}, name) + Element("dd", {}, value);
  }
  Table inputs("inputs", "Files read", {"path", "SHA-256"});
  for (const InputFile& input : result.inputs) {
    TableCell hash(input.sha256);
    hash.markup = Element("code", {}, EscapeXml(input.sha256));
    inputs.AddRow({input.path, hash});
  }
  return {"provenance", "Provenance",
          Element("dl", {{"class", "facts"}}, list) + inputs.ToHtml()};
}

}  // namespace

std::string RenderPlanPage(const PlanResult& result,
                           const std::string& plan_json, ArmShapes shapes) {
  const ArmView view = ViewOf(result, std::move(shapes));
  const std::vector<PageSection> sections = {
      AccuracySection(result), PosesSection(result),
      PlannedParametersSection(result), PlanProvenance(result)};
  std::string content =
      Element("header", {},
              Element("h1", {}, EscapeXml(result.title)) +
                  Element("div", {{"class", "small"}}, EscapeXml(result.arm))) +
      Summary(result, view) + HtmlContents(sections);
  return CompletePage(result.title, std::move(content), sections,
                      result.version, view.empty() ? "" : ArmViewJson(view),
                      plan_json);
}

}  // namespace alidade::internal
