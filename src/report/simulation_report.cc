#include <algorithm>
#include <string>
#include <vector>

#include "src/common/constants.h"
#include "src/common/fields.h"
#include "src/common/format.h"
#include "src/common/text.h"
#include "src/report/monte_carlo_page.h"
#include "src/report/report.h"
#include "src/report/rows.h"
#include "src/report/svg_chart.h"
#include "src/report/table.h"

namespace alidade::internal {

namespace {

std::string InPercent(double rate) { return FixedNumber(100.0 * rate, 1); }

// "95.1 (94.6 to 95.5)".
std::string Rate(const Coverage& coverage) {
  return InPercent(coverage.rate()) + " (" + InPercent(coverage.lower) +
         " to " + InPercent(coverage.upper) + ")";
}

std::string TruthInWords(const MonteCarloResult& result) {
  if (result.truth == "given") return "the arm that the job gives as true";
  if (result.truth == "identified") {
    return "the arm that the job identifies (a parametric bootstrap)";
  }
  return "an arm of its own for every trial, its joints drawn from the priors";
}

}  // namespace

std::string MonteCarloOpening(const MonteCarloResult& result) {
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
  return text;
}

Table SimulatedParameterTable(const MonteCarloResult& result) {
  Table table("simulated-parameters", "Every parameter over all trials",
              {"name", "unit", ">bias", ">+-|standard error of the bias",
               ">spread|standard deviation over the trials", ">predicted std",
               ">least std|that sigmas and priors allow", ">holds truth %",
               "interval"});
  for (const SimulatedParameter& one : result.parameters) {
    table.AddRow({one.name,
                  UnitForPeople(one.dimension),
                  QuantityCell(one.bias, one.dimension, 3),
                  QuantityCell(one.bias_error, one.dimension, 3),
                  QuantityCell(one.spread, one.dimension, 3),
                  QuantityCell(one.predicted_std, one.dimension, 3),
                  QuantityCell(one.bound, one.dimension, 3),
                  {Rate(one.coverage), 100.0 * one.coverage.rate()},
                  one.is_profile ? "profile" : "linear"});
  }
  return table;
}

std::string MonteCarloCoverage(const MonteCarloResult& result) {
  const std::string confidence = FixedPercent(result.confidence, 1);
  return "True coordinates lie within their " + confidence + " intervals in " +
         Rate(result.axes) + " % of cases, true positions within their " +
         confidence + " ellipsoids in " + Rate(result.ellipsoids) +
         " %. In brackets: what the number of trials leaves open.";
}

namespace {

std::string Workspace(const MonteCarloResult& result) {
  return Paragraph(
             "Over " + Count(result.workspace_poses, "configuration") +
             " drawn within the joint limits the error (root mean square) "
             "goes from " +
             FormatLength(result.workspace_before, 3) + " to " +
             FormatLength(result.workspace.mean, 3) +
             " in the mean over trials, " +
             FormatLength(result.workspace.p95, 3) +
             " in 95 % of the trials; predicted: " +
             FormatLength(result.workspace_predicted, 3) + ".") +
         Paragraph(MonteCarloCoverage(result));
}

ChartAxis TrialAxis() { return {"share of the trials [%]", false, 0.0, 100.0}; }

// Errors (m) of all trials, the smallest first.
ChartSeries SortedErrors(const std::string& label, std::vector<double> errors) {
  std::sort(errors.begin(), errors.end());
  ChartSeries series;
  series.label = label;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    series.x.push_back(100.0 * (static_cast<double>(i) + 0.5) /
                       static_cast<double>(errors.size()));
    series.y.push_back(errors[i] / kMillimetre);
  }
  return series;
}

LineChart WorkspaceChart(const MonteCarloResult& result) {
  std::vector<double> errors;
  for (const SimulatedTrial& trial : result.trials) {
    if (trial.usable) errors.push_back(trial.workspace_rms);
  }
  return {"True error over the workspace after calibration",
          Count(static_cast<std::int64_t>(errors.size()), "trial") + ", mean " +
              FormatLength(result.workspace.mean, 3),
          TrialAxis(),
          {"root mean square error [mm]"},
          {SortedErrors("", errors)},
          {{result.workspace_predicted / kMillimetre, "predicted"}}};
}

}  // namespace

LineChart CoverageOfParameters(const MonteCarloResult& result) {
  ChartSeries rates = Markers("", MarkerStyle::kDot);
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
  return {"How often the intervals hold the truth",
          "dots: parameters in the order of montecarlo.csv; lines: what the "
          "number of trials leaves open",
          CountAxis("parameter"),
          {"trials that hold it [%]"},
          {rates, lower, upper},
          {{100.0 * result.confidence,
            "wanted " + FixedPercent(result.confidence, 1)}}};
}

namespace {

std::string ParameterCsv(const MonteCarloResult& result) {
  std::string csv =
      "parameter,unit,truth,bias,bias_error,spread,predicted_std,least_std,"
      "coverage,coverage_lower,coverage_upper,interval\n";
  for (const SimulatedParameter& one : result.parameters) {
    AppendCsvCells(&csv, one.name, WordOf(one.dimension), one.truth, one.bias,
                   one.bias_error, one.spread, one.predicted_std, one.bound,
                   one.coverage.rate(), one.coverage.lower, one.coverage.upper);
    EndCsvRow(&csv, one.is_profile ? "profile" : "linear");
  }
  return csv;
}

std::string TrialCsv(const MonteCarloResult& result) {
  std::string csv = "trial,usable,reduced_chi_square,workspace_rms_mm";
  for (const SimulatedParameter& one : result.parameters) {
    csv += "," + one.name + "_" + UnitForPeople(one.dimension);
  }
  csv += "\n";
  int number = 0;
  for (const SimulatedTrial& trial : result.trials) {
    const auto if_usable = [&](double value) {
      return trial.usable ? value : kNan;
    };
    AppendCsvCells(&csv, ++number, trial.usable,
                   if_usable(trial.reduced_chi_square));
    AppendCsvCell(&csv, if_usable(trial.workspace_rms / kMillimetre));
    Eigen::Index k = 0;
    for (const SimulatedParameter& one : result.parameters) {
      csv += ",";
      if (!trial.usable) continue;
      AppendCsvCell(&csv, trial.estimates[k++] / UnitOf(one.dimension));
    }
    csv += "\n";
  }
  return csv;
}

}  // namespace

std::string FormatMonteCarlo(const MonteCarloResult& result) {
  std::string text = Paragraph(MonteCarloOpening(result));
  if (result.parameters.empty()) return text;
  text += "\n" + SimulatedParameterTable(result).ToText() + "\n";
  text += Paragraph(
      "The spread is " + FormatSignificant(result.inefficiency, 4) +
      " times the least one that sigmas and priors allow (root mean square "
      "over the parameters).");
  return text + Workspace(result);
}

std::vector<ReportFile> MakeMonteCarloFiles(const MonteCarloResult& result) {
  return {{"montecarlo.csv", ParameterCsv(result)},
          {"trials.csv", TrialCsv(result)},
          {"coverage.svg", RenderSvg(CoverageOfParameters(result))},
          {"workspace_error.svg", RenderSvg(WorkspaceChart(result))},
          {"montecarlo.html", RenderMonteCarloPage(result)},
          {"montecarlo.txt", FormatMonteCarlo(result)}};
}

namespace {

void AddMethod(const NoiseStudyMethod& method, Table* table) {
  std::vector<TableCell> row = {method.name};
  row.emplace_back(
      Millimetres(NoiseStudyMethod::Percentile(method.data_rms, 0.5)));
  for (const double fraction : {0.05, 0.5, 0.95}) {
    row.emplace_back(Millimetres(
        NoiseStudyMethod::Percentile(method.workspace_rms, fraction)));
  }
  row.emplace_back(std::to_string(method.failed));
  table->AddRow(row);
}

// Which methods leave the arm worse than it was, said in words.
std::string Verdict(const NoiseStudyResult& study) {
  std::string text;
  for (const NoiseStudyMethod& method : study.methods) {
    const double median =
        NoiseStudyMethod::Percentile(method.workspace_rms, 0.5);
    const bool worse = median > study.workspace_rms_before;
    text += Paragraph(
        method.name + ": the arm is " +
        (worse ? "WORSE than before over the workspace, "
               : "better than before over the workspace, ") +
        Millimetres(median) + " instead of " +
        Millimetres(study.workspace_rms_before) +
        " mm in the median trial, although it fits the poses it was "
        "calibrated on to " +
        Millimetres(NoiseStudyMethod::Percentile(method.data_rms, 0.5)) +
        " mm.");
  }
  return text;
}

}  // namespace

std::string FormatNoiseStudy(const NoiseStudyResult& study) {
  std::string text = Paragraph(
      std::to_string(study.trials) + " calibrations of the same poses with " +
      "fresh noise of " + FormatLength(study.sigma, 2) +
      " on each coordinate (seed " + std::to_string(study.seed) +
      "). Position errors are root mean squares against the true arm, at the "
      "poses of the data set and at " +
      std::to_string(study.workspace_poses) +
      " poses over the whole workspace.");
  Table table({"error against the true arm [mm]", ">at the poses",
               ">workspace p5", ">median", ">p95", ">failed"});
  const std::string before = Millimetres(study.workspace_rms_before);
  table.AddRow({"not calibrated", Millimetres(study.data_rms_before), before,
                before, before, ""});
  for (const NoiseStudyMethod& method : study.methods) {
    AddMethod(method, &table);
  }
  return text + "\n" + table.ToText() + "\n" + Verdict(study);
}

std::vector<ReportFile> MakeNoiseFiles(const NoiseStudyResult& study) {
  LineChart chart{
      "Error over the workspace after calibration with noise",
      std::to_string(study.trials) + " trials, noise of " +
          FormatLength(study.sigma, 2) + " on each coordinate",
      TrialAxis(),
      LogarithmicAxis("root mean square error [mm]"),
      {},
      {{study.workspace_rms_before / kMillimetre, "not calibrated"}}};
  std::string csv = "method,trial,data_rms_mm,workspace_rms_mm\n";
  for (const NoiseStudyMethod& method : study.methods) {
    const Eigen::VectorXd& rms = method.workspace_rms;
    chart.series.push_back(
        SortedErrors(method.name, {rms.data(), rms.data() + rms.size()}));
    for (Eigen::Index i = 0; i < method.data_rms.size(); ++i) {
      csv += "\"" + method.name + "\"," + std::to_string(i + 1) + "," +
             ShortestNumber(method.data_rms[i] / kMillimetre) + "," +
             ShortestNumber(method.workspace_rms[i] / kMillimetre) + "\n";
    }
  }
  return {{"noise_study.svg", RenderSvg(chart)}, {"noise_study.csv", csv}};
}

}  // namespace alidade::internal
