#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "src/common/format.h"
#include "src/common/text.h"
#include "src/report/quantities.h"
#include "src/report/report.h"
#include "src/report/svg_chart.h"
#include "src/report/table.h"

namespace alidade::internal {
namespace {

std::string Percent(double rate) { return FixedNumber(100.0 * rate, 1); }

// "95.1 (94.6 to 95.5)".
std::string Rate(const Coverage& coverage) {
  return Percent(coverage.rate()) + " (" + Percent(coverage.lower) + " to " +
         Percent(coverage.upper) + ")";
}

std::string TruthInWords(const MonteCarloResult& result) {
  if (result.truth == "given") return "the arm that the job gives as true";
  if (result.truth == "identified") {
    return "the arm that the job identifies (a parametric bootstrap)";
  }
  return "an arm of its own for every trial, its joints drawn from the priors";
}

std::string Introduction(const MonteCarloResult& result) {
  const auto done = static_cast<std::int64_t>(result.trials.size());
  std::string text =
      Count(done, "simulated calibration") + ", seed " +
      std::to_string(result.seed) + ". The truth is " + TruthInWords(result) +
      (result.sigma_estimated
           ? "; sigma is estimated in every trial, by one factor of "
             "all of them."
           : "; sigma is as stated.");
  if (result.stopped_early) {
    text += " Stopped before " + std::to_string(result.trials_wanted) +
            " trials: the mean error is known well enough.";
  }
  if (result.failed > 0) {
    text += " " + Count(result.failed, "trial") +
            " found no usable solution and are left out.";
  }
  return Paragraph(text);
}

Table ParameterTable(const MonteCarloResult& result) {
  Table table({"name", "unit", ">bias", ">+-", ">spread", ">predicted std",
               ">least std", ">holds truth %", "interval"});
  for (const SimulatedParameter& one : result.parameters) {
    table.AddRow({one.name, UnitForPeople(one.dimension),
                  InUnit(one.bias, one.dimension, 3),
                  InUnit(one.bias_error, one.dimension, 3),
                  InUnit(one.spread, one.dimension, 3),
                  InUnit(one.predicted_std, one.dimension, 3),
                  InUnit(one.bound, one.dimension, 3), Rate(one.coverage),
                  one.is_profile ? "profile" : "linear"});
  }
  return table;
}

std::string Workspace(const MonteCarloResult& result) {
  const std::string confidence = Percent(result.confidence) + " %";
  return Paragraph(
             "Over " + Count(result.workspace_poses, "configuration") +
             " drawn within the joint limits the error (root mean square) "
             "goes from " +
             FormatLength(result.workspace_before, 3) + " to " +
             FormatLength(result.workspace.mean, 3) + " in the mean trial, " +
             FormatLength(result.workspace.p95, 3) +
             " in 95 % of the trials; predicted: " +
             FormatLength(result.workspace_predicted, 3) + ".") +
         Paragraph("True coordinates lie within their " + confidence +
                   " intervals in " + Rate(result.axes) +
                   " % of cases, true positions within their " + confidence +
                   " ellipsoids in " + Rate(result.ellipsoids) +
                   " %. In brackets: what the number of trials leaves open.");
}

LineChart WorkspaceChart(const MonteCarloResult& result) {
  std::vector<double> sorted;
  for (const SimulatedTrial& trial : result.trials) {
    if (trial.usable) sorted.push_back(trial.workspace_rms / kMillimetre);
  }
  std::sort(sorted.begin(), sorted.end());
  LineChart chart;
  chart.title = "True error over the workspace after calibration";
  chart.subtitle = Count(static_cast<std::int64_t>(sorted.size()), "trial") +
                   ", mean " + FormatLength(result.workspace.mean, 3);
  chart.x.label = "share of the trials [%]";
  chart.x.upper = 100.0;
  chart.y.label = "root mean square error [mm]";
  ChartSeries series;
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    series.x.push_back(100.0 * (static_cast<double>(i) + 0.5) /
                       static_cast<double>(sorted.size()));
    series.y.push_back(sorted[i]);
  }
  chart.series.push_back(std::move(series));
  chart.references.push_back(
      {result.workspace_predicted / kMillimetre, "predicted"});
  return chart;
}

LineChart CoverageChart(const MonteCarloResult& result) {
  LineChart chart;
  chart.title = "How often the intervals hold the truth";
  chart.subtitle =
      "dots: parameters in the order of montecarlo.csv; lines: "
      "what the number of trials leaves open";
  chart.x.label = "parameter";
  chart.x.integer_ticks = true;
  chart.y.label = "trials that hold it [%]";
  ChartSeries rates;
  rates.line = false;
  rates.marker = MarkerStyle::kDot;
  ChartSeries lower;
  ChartSeries upper;
  lower.label = "95 % interval of the rate";
  double number = 0.0;
  for (const SimulatedParameter& one : result.parameters) {
    number += 1.0;
    for (ChartSeries* series : {&rates, &lower, &upper}) {
      series->x.push_back(number);
    }
    rates.y.push_back(100.0 * one.coverage.rate());
    lower.y.push_back(100.0 * one.coverage.lower);
    upper.y.push_back(100.0 * one.coverage.upper);
  }
  chart.series = {rates, lower, upper};
  chart.references.push_back({100.0 * result.confidence,
                              "wanted " + Percent(result.confidence) + " %"});
  return chart;
}

std::string ParameterCsv(const MonteCarloResult& result) {
  std::string csv =
      "parameter,unit,truth,bias,bias_error,spread,told_std,least_std,"
      "coverage,coverage_lower,coverage_upper,interval\n";
  for (const SimulatedParameter& one : result.parameters) {
    csv += one.name;
    csv += one.dimension == Dimension::kLength ? ",m" : ",rad";
    for (const double value :
         {one.truth, one.bias, one.bias_error, one.spread, one.predicted_std,
          one.bound, one.coverage.rate(), one.coverage.lower,
          one.coverage.upper}) {
      csv += ",";
      if (!std::isnan(value)) csv += ShortestNumber(value);
    }
    csv += one.is_profile ? ",profile\n" : ",linear\n";
  }
  return csv;
}

std::string TrialCsv(const MonteCarloResult& result) {
  std::string csv = "trial,usable,reduced_chi_square,workspace_rms_mm";
  for (const SimulatedParameter& one : result.parameters) {
    csv +=
        "," + one.name + (one.dimension == Dimension::kLength ? "_mm" : "_deg");
  }
  csv += "\n";
  std::size_t number = 0;
  for (const SimulatedTrial& trial : result.trials) {
    csv += std::to_string(++number) + (trial.usable ? ",true" : ",false");
    if (trial.usable) {
      csv += "," + ShortestNumber(trial.reduced_chi_square) + "," +
             ShortestNumber(trial.workspace_rms / kMillimetre);
    } else {
      csv += ",,";
    }
    for (std::size_t k = 0; k < result.parameters.size(); ++k) {
      csv += ",";
      if (!trial.usable) continue;
      const bool is_length =
          result.parameters[k].dimension == Dimension::kLength;
      csv += ShortestNumber(trial.estimates[static_cast<Eigen::Index>(k)] /
                            (is_length ? kMillimetre : kDegree));
    }
    csv += "\n";
  }
  return csv;
}

}  // namespace

std::string FormatMonteCarlo(const MonteCarloResult& result) {
  std::string text = Introduction(result);
  if (result.parameters.empty()) return text;
  text += "\n" + ParameterTable(result).ToText() + "\n";
  text += Paragraph(
      "The spread is " + FormatSignificant(result.inefficiency, 4) +
      " times the least one that sigmas and priors allow (root mean square "
      "over the parameters).");
  return text + Workspace(result);
}

std::vector<ReportFile> MakeMonteCarloFiles(const MonteCarloResult& result) {
  return {{"montecarlo.csv", ParameterCsv(result)},
          {"trials.csv", TrialCsv(result)},
          {"coverage.svg", RenderSvg(CoverageChart(result))},
          {"workspace_error.svg", RenderSvg(WorkspaceChart(result))},
          {"montecarlo.txt", FormatMonteCarlo(result)}};
}

}  // namespace alidade::internal
