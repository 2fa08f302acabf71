#include "src/report/result_page.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "src/common/format.h"
#include "src/common/text.h"
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

constexpr std::size_t kMostRows = 1000;
constexpr std::size_t kLargestJson = 500'000;

bool StartsWith(const std::string& text, const std::string& beginning) {
  return text.compare(0, beginning.size(), beginning) == 0;
}

// "0.72 mm → 0.19 mm" and how many times smaller that is.
std::string HeadlinePair(const std::string& title, double before, double after,
                         Dimension dimension) {
  const std::string unit = dimension == Dimension::kLength ? "\u00a0mm" : "°";
  const auto shown = [&](double value, const char* look) {
    return Element("span", {{"class", look}},
                   Words(InUnit(value, dimension, 3) + unit));
  };
  std::string html =
      Element("div", {{"class", "small"}}, title) +
      Element("div", {{"class", "big"}},
              shown(before, "then") + " → " + shown(after, "now"));
  if (before > 0.0 && after > 0.0) {
    const bool is_smaller = after <= before;
    const double ratio = is_smaller ? before / after : after / before;
    html += Element("div", {{"class", "small"}},
                    Words(FormatSignificant(ratio, 2) + " times " +
                          (is_smaller ? "smaller" : "larger")));
  }
  return Element("div", {}, html);
}

// Of validation poses where there are any.
std::string Headline(const CalibrationResult& result) {
  const bool is_validated = result.validation && result.validation->after.n > 0;
  const KeptErrors set =
      (is_validated ? *result.validation : result.train).Judged();
  std::string html;
  if (set.after.n > 0) {
    html += HeadlinePair("mean position error", set.before.mean, set.after.mean,
                         Dimension::kLength) +
            HeadlinePair("largest", set.before.max, set.after.max,
                         Dimension::kLength);
  }
  if (set.rotation_after.n > 0) {
    html += HeadlinePair("mean orientation error", set.rotation_before.mean,
                         set.rotation_after.mean, Dimension::kAngle);
  }
  return Element("div", {{"class", "numbers"}, {"id", "headline"}}, html);
}

std::string Acceptance(const CalibrationResult& result) {
  std::vector<std::string> checks;
  for (const Finding& finding : result.verdict.findings) {
    if (!StartsWith(finding.key, "acceptance.")) continue;
    checks.push_back(
        HtmlBadge(finding.level,
                  finding.level == FindingLevel::kPassed ? "met" : "missed") +
        " " + Words(WithNext(finding)));
  }
  return checks.empty()
             ? HtmlParagraph(FindingSentences(result, {"acceptance"}))
             : HtmlList(checks, "acceptance", "plain");
}

std::string Warnings(const CalibrationResult& result) {
  std::vector<std::string> warnings;
  for (const Finding& finding : result.verdict.findings) {
    if (IsReason(finding) && !StartsWith(finding.key, "acceptance.")) {
      warnings.push_back(Words(WithNext(finding)));
    }
  }
  if (warnings.empty()) return "";
  const std::string title =
      warnings.size() == 1
          ? "Before you rely on it"
          : "Before you rely on it: " + std::to_string(warnings.size()) +
                " warnings";
  return Element("div", {{"class", "warnings"}, {"id", "warnings"}},
                 Element("strong", {}, title) + HtmlList(warnings, ""));
}

std::string Summary(const CalibrationResult& result, bool has_arm) {
  std::string numbers =
      Headline(result) + AccuracyTable(result, Dimension::kLength).ToHtml() +
      AccuracyTable(result, Dimension::kAngle).ToHtml() + Acceptance(result) +
      HtmlParagraph(FindingSentences(result, {"measurement_noise"}));
  if (!result.before_note.empty()) {
    const std::string prefix = "before: ";
    numbers += HtmlNote("Before: " +
                        (StartsWith(result.before_note, prefix)
                             ? result.before_note.substr(prefix.size())
                             : result.before_note) +
                        ".");
  }
  // The script draws into it.
  const std::string arm =
      has_arm ? Element("div", {{"id", "arm"}},
                        "<noscript><p class=\"note\">The view of the arm needs "
                        "scripts, which are switched off here.</p></noscript>")
              : "";
  return Element("section", {{"id", "summary"}, {"aria-label", "Summary"}},
                 HtmlVerdict(result.verdict.level, result.verdict.title,
                             result.verdict.sentence) +
                     HtmlPair({numbers, arm}) + Warnings(result));
}

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
  html += RelationTable(found.relations).ToHtml();
  if (!found.advice.empty()) {
    std::vector<std::string> advice;
    for (const std::string& text : found.advice) advice.push_back(Words(text));
    html += Element("h3", {}, "Motions that would help") + HtmlList(advice, "");
  }
  return {"identifiability", "Identifiability", html};
}

PageSection StagesSection(const CalibrationResult& result) {
  const bool has_rungs =
      result.error_terms && !result.error_terms->rungs.empty();
  if (has_rungs) {
    return {"stages", "Accuracy by stage",
            ErrorStagesPart(result) +
                StagesTable(result, Dimension::kLength).ToHtml() +
                StagesTable(result, Dimension::kAngle).ToHtml()};
  }
  if (result.stages.empty()) return {"stages", "Accuracy by stage", ""};
  RowChart chart{std::string("Error by what was calibrated, ") +
                     (result.validation ? "validation" : "training") + " poses",
                 "",
                 {"position error [mm]"}};
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
          HtmlPair({HtmlFigure("stages-figure", chart),
                    StagesTable(result, Dimension::kLength).ToHtml() +
                        StagesTable(result, Dimension::kAngle).ToHtml()})};
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
              RejectedRowTable(result).ToHtml(kMostRows)};
}

}  // namespace

std::string RenderResultPage(const CalibrationResult& result,
                             const std::string& result_json,
                             const std::vector<PageSection>& further) {
  const std::string arm_view = ArmViewJson(result);
  std::vector<PageSection> sections = further;
  for (PageSection& section : std::vector<PageSection>{
           ParametersSection(result), StagesSection(result),
           ErrorTermsSectionOf(result), IdentifiabilitySection(result),
           ResidualsSection(result), PredictionSection(result),
           BudgetSection(result), SolverSection(result),
           ProvenanceSection(result)}) {
    sections.push_back(std::move(section));
  }
  std::string content = Element("header", {},
                                Element("h1", {}, EscapeXml(result.title)) +
                                    Element("div", {{"class", "small"}},
                                            EscapeXml(result.arm_name))) +
                        Summary(result, !arm_view.empty()) +
                        HtmlContents(sections);
  for (const PageSection& section : sections) content += HtmlSection(section);
  content += HtmlFooter(result.version);
  std::vector<PageData> data;
  if (!arm_view.empty()) data.push_back({"arm-data", arm_view});
  if (result_json.size() <= kLargestJson) {
    data.push_back({"alidade-data", result_json});
  }
  return FillPage(result.title + " – Alidade", content, data);
}

}  // namespace alidade::internal
