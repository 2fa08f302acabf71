#include <algorithm>
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

void AddMethod(const NoiseStudyMethod& method, Table* table) {
  std::vector<TableCell> row = {method.name};
  row.push_back(
      Millimetres(NoiseStudyMethod::Percentile(method.data_rms, 0.5)));
  for (const double fraction : {0.05, 0.5, 0.95}) {
    row.push_back(Millimetres(
        NoiseStudyMethod::Percentile(method.workspace_rms, fraction)));
  }
  row.push_back(std::to_string(method.failed));
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

ChartSeries SortedSeries(const NoiseStudyMethod& method) {
  Eigen::VectorXd sorted = method.workspace_rms;
  std::sort(sorted.data(), sorted.data() + sorted.size());
  ChartSeries series;
  series.label = method.name;
  for (Eigen::Index i = 0; i < sorted.size(); ++i) {
    series.x.push_back(100.0 * (static_cast<double>(i) + 0.5) /
                       static_cast<double>(sorted.size()));
    series.y.push_back(sorted[i] / kMillimetre);
  }
  return series;
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
  LineChart chart;
  chart.title = "Error over the workspace after calibration with noise";
  chart.subtitle = std::to_string(study.trials) + " trials, noise of " +
                   FormatLength(study.sigma, 2) + " on each coordinate";
  chart.x.label = "share of the trials [%]";
  chart.x.upper = 100.0;
  chart.y.label = "root mean square error [mm]";
  chart.y.logarithmic = true;
  chart.references.push_back(
      {study.workspace_rms_before / kMillimetre, "not calibrated"});
  std::string csv = "method,trial,data_rms_mm,workspace_rms_mm\n";
  for (const NoiseStudyMethod& method : study.methods) {
    chart.series.push_back(SortedSeries(method));
    for (Eigen::Index i = 0; i < method.data_rms.size(); ++i) {
      csv += "\"" + method.name + "\"," + std::to_string(i + 1) + "," +
             ShortestNumber(method.data_rms[i] / kMillimetre) + "," +
             ShortestNumber(method.workspace_rms[i] / kMillimetre) + "\n";
    }
  }
  return {{"noise_study.svg", RenderSvg(chart)}, {"noise_study.csv", csv}};
}

}  // namespace alidade::internal
