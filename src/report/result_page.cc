#include "src/report/result_page.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "src/calibration/improvement.h"
#include "src/common/format.h"
#include "src/common/text.h"
#include "src/report/answers.h"
#include "src/report/arm_view.h"
#include "src/report/budget_report.h"
#include "src/report/figures.h"
#include "src/report/markup.h"
#include "src/report/report.h"
#include "src/report/result_tables.h"
#include "src/report/table.h"
#include "src/solve/solver_names.h"

namespace alidade::internal {
namespace {

constexpr std::size_t kMostRejectedRows = 1000;
// All are in the files.
constexpr std::size_t kMostOutliers = 20;

Table RelationTable(const std::vector<Relation>& relations) {
  static const std::vector<std::pair<std::string, std::string>> kLevels = {
      {"no_effect", "no effect"},
      {"structural", "at all poses"},
      {"at_geometry", "at the nominal geometry"},
      {"not_excited", "at these poses"}};
  Table table("relations", "Linearly dependent parameters, left out",
              {"parameter", "~relation", "dependent", "checked"});
  for (const Relation& relation : relations) {
    const auto level = std::find_if(
        kLevels.begin(), kLevels.end(),
        [&](const auto& each) { return each.first == relation.level; });
    table.AddRow({relation.parameter, relation.text,
                  level == kLevels.end() ? relation.level : level->second,
                  relation.verified ? "yes" : "no"});
  }
  return table;
}

PageSection AccuracyPage(const CalibrationResult& result) {
  return {"accuracy-section", "Accuracy",
          AccuracyTable(result, Dimension::kLength).ToHtml() +
              KindTable(result).ToHtml() +
              AccuracyTable(result, Dimension::kAngle).ToHtml() +
              HtmlParagraph(FindingSentences(result, {"cross_validation"})) +
              HtmlParagraph(RepeatSentence(result))};
}

PageSection OutliersPage(const CalibrationResult& result) {
  const std::size_t count =
      result.outliers.size() + result.validation_outliers.size();
  if (count == 0) return {"outliers-section", "Outliers", ""};
  std::string html = HtmlParagraph(OutlierNote(result)) +
                     HtmlParagraph(FindingSentences(
                         result, {"validation_outliers", "outliers"}));
  if (count > kMostOutliers) {
    html +=
        HtmlNote("The table has the first " + std::to_string(kMostOutliers) +
                 "; report.txt, residuals.csv and validation.csv have "
                 "more.");
  }
  return {"outliers-section", "Outliers",
          html + OutlierTable(result).ToHtml(kMostOutliers)};
}

PageSection IdentifiabilitySection(const CalibrationResult& result) {
  const IdentifiabilityResult& found = result.identifiability;
  std::string html = HtmlParagraph(
      Count(found.num_free, "parameter") +
      (found.num_free == 1 ? " was" : " were") + " estimated, chosen " +
      (found.method == "rules" ? "by the three rules of the published study."
                               : "by ranks."));
  html += HtmlParagraph(FindingSentences(result, {"rank"}));
  html += HtmlPair(
      {found.nominal_rank.singular_values.size() == 0
           ? ""
           : HtmlFigure("singular-values", SingularValuesFigure(found),
                        "each is a direction in which the parameters can move, "
                        "and how much these poses see of it"),
       RankTable(found).ToHtml() +
           (found.scaled.o1 > 0.0 ? ObservabilityTable(found).ToHtml() : "")});
  html += HtmlFold(Count(static_cast<std::int64_t>(found.relations.size()),
                         "linearly dependent parameter") +
                       " left out",
                   RelationTable(found.relations).ToHtml(), false);
  if (!found.advice.empty()) {
    std::vector<std::string> advice;
    for (const std::string& text : found.advice) {
      advice.push_back(Sentences(AsSentence(text)));
    }
    html += Element("h3", {}, "Motions that would help") + HtmlList(advice, "");
  }
  return {"identifiability", "Identifiability", html};
}

PageSection StagesSection(const CalibrationResult& result) {
  const bool has_rungs =
      result.error_terms && !result.error_terms->rungs.empty();
  if (has_rungs) {
    return {"stages", "Accuracy by stage",
            HtmlNote(StagesNote(result)) + ErrorStagesPart(result) +
                StagesTable(result, Dimension::kLength).ToHtml() +
                StagesTable(result, Dimension::kAngle).ToHtml()};
  }
  if (result.stages.empty()) return {"stages", "Accuracy by stage", ""};
  RowChart chart{std::string("Error by what was calibrated, ") +
                     (result.validation ? "validation" : "training") + " poses",
                 "",
                 {std::string(LengthErrorName(result)) + " [mm]"}};
  chart.looks = {Markers("mean", MarkerStyle::kDot),
                 Markers("largest", MarkerStyle::kSquare)};
  for (const StageResult& stage : result.stages) {
    const Accuracy& accuracy =
        result.validation ? stage.validation : stage.train;
    ChartRow& row = chart.rows.emplace_back();
    row.label = stage.name;
    for (std::size_t k = 0; k < chart.looks.size(); ++k) {
      const double error = k == 0 ? accuracy.mean : accuracy.max;
      RowMark& mark = row.marks.emplace_back();
      mark.series = k;
      mark.at = error / kMillimetre;
      mark.tip = stage.name + ": " + chart.looks[k].label + " " +
                 FormatLength(error, 3);
    }
  }
  return {"stages", "Accuracy by stage",
          HtmlNote(StagesNote(result)) + HtmlFigure("stages-figure", chart) +
              StagesTable(result, Dimension::kLength).ToHtml() +
              StagesTable(result, Dimension::kAngle).ToHtml()};
}

PageSection SolverSection(const CalibrationResult& result) {
  if (result.runs.empty()) return {"solver", "Convergence", ""};
  const SolverSummary& summary = result.runs.front().summary;
  std::string html = HtmlParagraph(AsSentence(
      SolverTitle(summary.solver) + " " + ToString(summary.status) + " after " +
      Count(summary.accepted_steps + summary.rejected_steps, "iteration") +
      (summary.message.empty() ? "" : ": " + summary.message)));
  html += HtmlPair({HtmlFigure("convergence", ConvergenceFigure(result.runs)),
                    SolverTable(result.runs).ToHtml()});
  for (std::size_t i = 1; i < result.runs.size(); ++i) {
    html +=
        HtmlParagraph(AsSentence(DifferenceSentence(result, result.runs[i])));
  }
  return {"solver",
          result.runs.size() > 1 ? "Solver against solver" : "Convergence",
          html};
}

PageSection ProvenanceSection(const CalibrationResult& result) {
  double solving = 0.0;
  for (const SolverRun& run : result.runs) {
    solving += run.summary.setup_time_s + run.summary.solve_time_s;
  }
  std::vector<std::pair<std::string, std::string>> facts = {
      {"arm", EscapeXml(result.arm_name)},
      {"command", Element("code", {}, EscapeXml(result.command))},
      {"Alidade", EscapeXml(result.version)},
      {"seed", std::to_string(result.seed)},
      {"time", FormatDuration(result.total_time_s) +
                   " in all, of which analysis " +
                   FormatDuration(result.identify_time_s) + " and solving " +
                   FormatDuration(solving)}};
  if (!result.runs.empty()) {
    const SolverSummary& summary = result.runs.front().summary;
    facts.emplace_back("observations",
                       Count(summary.num_poses, "pose") + ", " +
                           Count(summary.num_residuals, "equation") + ", " +
                           Count(summary.num_free, "parameter") +
                           " solved for");
  }
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
          Element("dl", {{"class", "facts"}}, list) + inputs.ToHtml() +
              RejectedRowTable(result).ToHtml(kMostRejectedRows)};
}

}  // namespace

std::string RenderResultPage(const CalibrationResult& result,
                             const std::string& result_json,
                             const std::vector<PageSection>& further,
                             ArmShapes shapes) {
  const ArmView view = ViewOf(result, std::move(shapes));
  std::vector<PageSection> sections = further;
  for (PageSection& section : std::vector<PageSection>{
           AccuracyPage(result),
           OutliersPage(result),
           PredictionSection(result),
           ResidualsSection(result),
           StagesSection(result),
           ErrorTermsSectionOf(result),
           ParametersSection(result),
           IdentifiabilitySection(result),
           BudgetSection(result),
           SolverSection(result),
           ProvenanceSection(result),
       }) {
    sections.push_back(std::move(section));
  }
  std::string content = Element("header", {},
                                Element("h1", {}, EscapeXml(result.title)) +
                                    Element("div", {{"class", "small"}},
                                            result.arm_name == result.title
                                                ? ""
                                                : EscapeXml(result.arm_name))) +
                        FirstScreen(result, view) + HtmlContents(sections);
  return CompletePage(result.title, std::move(content), sections,
                      result.version, view.empty() ? "" : ArmViewJson(view),
                      result_json);
}

}  // namespace alidade::internal
