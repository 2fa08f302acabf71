#include "src/report/monte_carlo_page.h"

#include <cmath>
#include <string>
#include <vector>

#include "alidade/version.h"
#include "src/common/format.h"
#include "src/common/text.h"
#include "src/report/markup.h"
#include "src/report/page.h"
#include "src/report/run_distributions.h"

namespace alidade::internal {
namespace {

// Values are differences from the truth where all trials have the same one.
ManyRuns RunsOf(const MonteCarloResult& result) {
  ManyRuns runs;
  runs.each = "trial";
  runs.error = "rms error over the workspace";
  runs.predicted = result.workspace_predicted;
  for (const SimulatedParameter& parameter : result.parameters) {
    runs.parameters.push_back(
        {parameter.name, parameter.dimension, parameter.predicted_std, {}});
  }
  for (const SimulatedTrial& trial : result.trials) {
    if (!trial.usable) continue;
    runs.after.push_back(trial.workspace_rms);
    for (std::size_t k = 0; k < runs.parameters.size(); ++k) {
      runs.parameters[k].values.push_back(
          trial.estimates[static_cast<Eigen::Index>(k)]);
    }
  }
  // Where each trial has a truth of its own, estimates scatter with it.
  for (std::size_t k = 0; k < runs.parameters.size(); ++k) {
    if (!std::isfinite(result.parameters[k].truth)) {
      runs.parameters.clear();
      break;
    }
  }
  return runs;
}

std::string Rate(const std::string& title, const Coverage& coverage,
                 double wanted) {
  return HtmlFact(title, FixedPercent(coverage.rate(), 1),
                  "wanted " + FixedPercent(wanted, 1) + "; " +
                      FixedPercent(coverage.lower, 1) + " to " +
                      FixedPercent(coverage.upper, 1) +
                      " by the number of trials");
}

std::string Summary(const MonteCarloResult& result, const ManyRuns& runs) {
  return Element(
      "section", {{"id", "summary"}, {"aria-label", "Summary"}},
      HtmlVerdict(FindingLevel::kNote,
                  Count(static_cast<std::int64_t>(runs.after.size()),
                        "simulated calibration"),
                  "Calibration takes the arm from " +
                      FormatLength(result.workspace_before, 3) + " to " +
                      FormatLength(result.workspace.mean, 3) +
                      " over its workspace in the mean over trials, and to " +
                      FormatLength(result.workspace.p95, 3) +
                      " or less in 95 % of them; predicted were " +
                      FormatLength(result.workspace_predicted, 3) + ".") +
          Element("div", {{"class", "numbers"}, {"id", "headline"}},
                  Rate("coordinates within their intervals", result.axes,
                       result.confidence) +
                      Rate("positions within their ellipsoids",
                           result.ellipsoids, result.confidence) +
                      HtmlFact("spread over the least possible",
                               FormatSignificant(result.inefficiency, 4),
                               "1: as good as sigmas and priors allow")) +
          HtmlParagraph(MonteCarloOpening(result)) +
          HtmlParagraph(MonteCarloCoverage(result)));
}

}  // namespace

std::string RenderMonteCarloPage(const MonteCarloResult& result) {
  const ManyRuns runs = RunsOf(result);
  const std::vector<PageSection> sections = {
      {"distributions", "Errors and parameters over all trials",
       runs.after.empty() ? "" : DistributionFigures(runs)},
      {"parameters", "Bias, spread and coverage of each parameter",
       result.parameters.empty()
           ? ""
           : HtmlFigure("coverage", CoverageOfParameters(result)) +
                 SimulatedParameterTable(result).ToHtml()}};
  const std::string title =
      result.title.empty() ? "Simulated calibrations" : result.title;
  std::string content =
      Element("header", {}, Element("h1", {}, EscapeXml(title))) +
      Summary(result, runs) + HtmlContents(sections);
  for (const PageSection& section : sections) content += HtmlSection(section);
  content +=
      HtmlNote("Every trial is a row of trials.csv.") + HtmlFooter(Version());
  return FillPage(title + " – Alidade", content, {});
}

}  // namespace alidade::internal
