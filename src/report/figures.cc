#include <algorithm>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "src/common/format.h"
#include "src/common/text.h"
#include "src/report/report.h"
#include "src/report/svg_chart.h"
#include "src/solve/solver_names.h"

namespace alidade::internal {
namespace {

// Markers of more iterations than this would run into each other.
constexpr std::size_t kMostMarkedIterations = 40;
// Poses lie in one plane when their height varies by less than this share of
// their extent.
constexpr double kFlat = 0.05;
// Of more poses than so many only the worst of neighbours are drawn: the others
// would lie behind them.
constexpr Eigen::Index kMostDrawn = 100000;

// Keeps a number and its unit on one line.
constexpr const char* kNoBreak = "\u00a0";

// "2.13 × 10^-13", which the chart sets with a superscript.
std::string NumberInWords(double value) {
  std::string text = FormatSignificant(value, 3);
  const std::size_t e = text.find('e');
  if (e == std::string::npos) return text;
  return text.substr(0, e) + kNoBreak + "×" + kNoBreak + "10^" +
         std::to_string(std::stoi(text.substr(e + 1)));
}

std::string LengthInWords(double metres) {
  return NumberInWords(metres / kMillimetre) + kNoBreak + "mm";
}

// "1.94 to 5.21 mm, mean 3.29 mm"; one number where all print the same.
std::string Headline(const Accuracy& accuracy) {
  if (accuracy.n == 0) return "nothing was evaluated";
  const std::string largest = LengthInWords(accuracy.max);
  if (LengthInWords(accuracy.min) == largest) return largest + " at every pose";
  return NumberInWords(accuracy.min / kMillimetre) + " to " + largest +
         ", mean " + LengthInWords(accuracy.mean);
}

std::vector<double> InMillimetres(
    const Eigen::Ref<const Eigen::VectorXd, 0, Eigen::InnerStride<>>& metres) {
  std::vector<double> values;
  values.reserve(static_cast<std::size_t>(metres.size()));
  for (const double value : metres) values.push_back(value / kMillimetre);
  return values;
}

ChartSeries ErrorByPose(const SharedVector& errors) {
  ChartSeries series;
  series.marker = MarkerStyle::kStem;
  const Eigen::Index n = errors.size();
  const Eigen::Index step = std::max<Eigen::Index>(1, n / kMostDrawn);
  for (Eigen::Index first = 0; first < n; first += step) {
    Eigen::Index worst = 0;
    errors.map().segment(first, std::min(step, n - first)).maxCoeff(&worst);
    series.x.push_back(static_cast<double>(first + worst + 1));
    series.y.push_back(errors[first + worst] / kMillimetre);
  }
  return series;
}

LineChart PoseChart(const std::string& title, const Accuracy& accuracy,
                    const SharedVector& errors, const std::string& poses) {
  LineChart chart;
  chart.title = title;
  chart.subtitle = Headline(accuracy) + " (" + Count(accuracy.n, poses) + ")";
  chart.x.label = poses;
  chart.x.integer_ticks = true;
  chart.y.label = "position error [mm]";
  chart.series.push_back(ErrorByPose(errors));
  return chart;
}

bool LiesInHorizontalPlane(const EvaluatedSet& set) {
  if (set.positions.cols() < 3 || set.positions.cols() > kMostDrawn ||
      !set.positions.map().allFinite()) {
    return false;
  }
  const Eigen::Vector3d extent = set.positions.map().rowwise().maxCoeff() -
                                 set.positions.map().rowwise().minCoeff();
  return extent.z() < kFlat * extent.head<2>().maxCoeff();
}

MapChart PlaneChart(const std::string& title, const Accuracy& accuracy,
                    const EvaluatedSet& set, const SharedVector& errors) {
  MapChart chart;
  chart.title = title;
  const double height = set.positions.row(2).mean() / kMillimetre;
  chart.subtitle = Headline(accuracy) + " (" + Count(accuracy.n, "pose") +
                   " at z" + kNoBreak + "=" + kNoBreak +
                   FormatSignificant(height, 3) + kNoBreak + "mm)";
  chart.x.label = "x [mm]";
  chart.y.label = "y [mm]";
  chart.colour.label = "position error [mm]";
  chart.px = InMillimetres(set.positions.row(0).transpose());
  chart.py = InMillimetres(set.positions.row(1).transpose());
  chart.value = InMillimetres(errors.map());
  return chart;
}

std::string ValidationFigure(const std::string& when, const Accuracy& accuracy,
                             const EvaluatedSet& set,
                             const SharedVector& errors) {
  const std::string title = "Position error " + when + ", validation poses";
  if (LiesInHorizontalPlane(set)) {
    return RenderSvg(PlaneChart(title, accuracy, set, errors));
  }
  return RenderSvg(PoseChart(title, accuracy, errors, "validation pose"));
}

ChartSeries ConvergenceCurve(const SolverSummary& summary, MarkerStyle marker) {
  ChartSeries series;
  series.label = SolverTitle(summary.solver);
  for (const IterationRecord& record : summary.iterations) {
    series.x.push_back(record.iteration);
    series.y.push_back(record.max_error / kMillimetre);
  }
  if (series.x.size() <= kMostMarkedIterations) series.marker = marker;
  return series;
}

std::string ConvergenceHeadline(const std::vector<SolverRun>& runs) {
  std::vector<std::string> parts;
  for (const SolverRun& run : runs) {
    const auto& iterations = run.summary.iterations;
    if (iterations.empty()) continue;
    parts.push_back(ShortSolverTitle(run.summary.solver) + ": " +
                    LengthInWords(iterations.back().max_error) + " after " +
                    Count(iterations.back().iteration, "iteration"));
  }
  return Join(parts, "; ");
}

std::string ConvergenceFigure(const std::vector<SolverRun>& runs) {
  constexpr MarkerStyle kMarkers[] = {MarkerStyle::kDot, MarkerStyle::kSquare,
                                      MarkerStyle::kTriangle};
  LineChart chart;
  chart.title = "Largest position error by iteration, training poses";
  chart.subtitle = ConvergenceHeadline(runs);
  chart.x.label = "iteration";
  chart.x.integer_ticks = true;
  chart.y.label = "largest position error [mm]";
  chart.y.logarithmic = true;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    chart.series.push_back(
        ConvergenceCurve(runs[i].summary, kMarkers[i % std::size(kMarkers)]));
  }
  if (!runs.empty() && runs.front().summary.rounding_floor > 0.0) {
    const double floor = runs.front().summary.rounding_floor;
    chart.references.push_back(
        {floor / kMillimetre, "rounding floor, " + LengthInWords(floor)});
  }
  return RenderSvg(chart);
}

}  // namespace

std::vector<ReportFile> MakeFigures(const CalibrationResult& result) {
  const EvaluatedSet& train = result.train;
  std::vector<ReportFile> files;
  files.emplace_back(
      "error_before.svg",
      RenderSvg(PoseChart("Position error before calibration, training poses",
                          train.before, train.ErrorBefore(), "training pose")));
  files.emplace_back(
      "error_after.svg",
      RenderSvg(PoseChart("Position error after calibration, training poses",
                          train.after, train.ErrorAfter(), "training pose")));
  files.emplace_back("convergence.svg", ConvergenceFigure(result.runs));
  if (result.heldout) {
    const EvaluatedSet& heldout = *result.heldout;
    files.emplace_back("validation_before.svg",
                       ValidationFigure("before calibration", heldout.before,
                                        heldout, heldout.ErrorBefore()));
    files.emplace_back("validation_after.svg",
                       ValidationFigure("after calibration", heldout.after,
                                        heldout, heldout.ErrorAfter()));
  }
  return files;
}

}  // namespace alidade::internal
