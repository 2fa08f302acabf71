#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "src/calibration/improvement.h"
#include "src/common/format.h"
#include "src/common/text.h"
#include "src/report/figures.h"
#include "src/report/report.h"
#include "src/report/result_page.h"
#include "src/report/uncertainty_report.h"

namespace alidade::internal {
namespace {

// Slices of the workspace along each axis, and squares across one.
constexpr int kSlices = 5;
constexpr int kSquares = 22;
constexpr Eigen::Index kMostPoints = 4000;

// A fifth of the workspace across an axis: means of squares.
struct Slice {
  int axis = 2;
  double lower = 0.0;  // mm
  double upper = 0.0;
  double side = 1.0;
};

MapChart SliceChart(const PredictedMap& map, const ArmOutline& arm,
                    const Slice& slice) {
  const std::array<int, 2> across = {slice.axis == 0 ? 1 : 0,
                                     slice.axis == 2 ? 1 : 2};
  struct Square {
    double sum = 0.0;
    std::int64_t n = 0;
  };
  const Eigen::Matrix3Xd places = arm.InBase(map.positions) / kMillimetre;
  std::map<std::pair<double, double>, Square> squares;
  for (Eigen::Index i = 0; i < map.position_std.size(); ++i) {
    const Eigen::Vector3d at = places.col(i);
    const double depth = at[slice.axis];
    if (!std::isfinite(map.position_std[i]) || !(depth >= slice.lower) ||
        !(depth <= slice.upper)) {
      continue;
    }
    const auto middle = [&](int axis) {
      return (std::floor(at[axis] / slice.side) + 0.5) * slice.side;
    };
    Square& square = squares[{middle(across[0]), middle(across[1])}];
    square.sum += map.position_std[i] / kMillimetre;
    ++square.n;
  }
  const auto axis = [](int k) { return std::string(1, "xyz"[k]); };
  MapChart chart{"Predicted standard deviation of the position",
                 "slice at " + axis(slice.axis) + " from " +
                     FormatSignificant(slice.lower, 3) + " to " +
                     FormatSignificant(slice.upper, 3) + " mm",
                 {axis(across[0]) + " [mm]"},
                 {axis(across[1]) + " [mm]"},
                 {"standard deviation [mm]"}};
  chart.cell_size = slice.side;
  for (Eigen::Index k = 0; k < arm.corners.cols(); ++k) {
    chart.outline.emplace_back(arm.corners(across[0], k) / kMillimetre,
                               arm.corners(across[1], k) / kMillimetre);
  }
  std::vector<std::int64_t> counts;
  for (const auto& [place, square] : squares) {
    chart.px.push_back(place.first);
    chart.py.push_back(place.second);
    chart.value.push_back(square.sum / static_cast<double>(square.n));
    counts.push_back(square.n);
  }
  chart.tip = [values = chart.value, counts](std::size_t i) {
    return FormatSignificant(values[i], 3) + " mm, " +
           Count(counts[i], "configuration");
  };
  return chart;
}

// The whole seen from the side, and slices across each axis.
std::string MapFigures(const PredictedMap& map, const ArmOutline& arm) {
  if (map.position_std.size() == 0) return "";
  const std::string note =
      arm.corners.cols() > 1 ? "in the frame of the robot's base, which is at "
                               "the origin; grey: the arm at one of the poses"
                             : "";
  std::vector<PageChoice> choices = {
      {"side view",
       HtmlFigure("side-view", PredictedMapFigure(map, arm), note)}};
  const Eigen::Matrix3Xd places = arm.InBase(map.positions) / kMillimetre;
  for (const int axis : {2, 1, 0}) {
    const Eigen::VectorXd low = places.rowwise().minCoeff();
    const Eigen::VectorXd high = places.rowwise().maxCoeff();
    Eigen::VectorXd spans = high - low;
    const double thick = spans[axis] / kSlices;
    spans[axis] = 0.0;
    if (!(spans.maxCoeff() > 0.0)) continue;
    Slice slice;
    slice.axis = axis;
    slice.side = StepAbove(spans.maxCoeff() / kSquares);
    for (int k = 0; k < kSlices; ++k) {
      slice.lower = low[axis] + k * thick;
      slice.upper = slice.lower + thick;
      const std::string name = std::string(1, "xyz"[axis]);
      choices.push_back({name + " " + FixedNumber(slice.lower + thick / 2.0, 0),
                         HtmlFigure("slice-" + name + std::to_string(k + 1),
                                    SliceChart(map, arm, slice), note)});
    }
  }
  return HtmlChoices("predicted-map", "Slice at [mm]", choices);
}

// Predicted against true error where the true arm is known.
std::string TruthFigure(const PredictedMap& map) {
  if (!(map.true_error.size() > 0 && map.true_error.maxCoeff() > 0.0)) {
    return "";
  }
  LineChart chart{"Predicted and true error", "",
                  LogarithmicAxis("predicted standard deviation [mm]"),
                  LogarithmicAxis("true error [mm]")};
  ChartSeries points = Markers("a configuration", MarkerStyle::kDot);
  ValueRange range;
  const Eigen::Index size = map.true_error.size();
  const Eigen::Index step = (size + kMostPoints - 1) / kMostPoints;
  for (Eigen::Index i = 0; i < size; i += step) {
    points.x.push_back(map.position_std[i] / kMillimetre);
    points.y.push_back(map.true_error[i] / kMillimetre);
    for (const double value : {points.x.back(), points.y.back()}) {
      if (IsDrawable(chart.y, value)) range.Include(value);
    }
  }
  ChartSeries equal;
  equal.label = "equal";
  equal.x = {range.min, range.max};
  equal.y = equal.x;
  chart.series = {points, equal};
  return HtmlFigure(
      "predicted-and-true", chart,
      "The arm is simulated, so that its true error is known everywhere.");
}

}  // namespace

PageSection PredictionSection(const CalibrationResult& result) {
  PageSection section = {"workspace", "Workspace", ""};
  if (!result.uncertainty) return section;
  const UncertaintyResult& uncertainty = *result.uncertainty;
  std::vector<std::string> figures;
  if (uncertainty.workspace) {
    const PredictedMap& map = *uncertainty.workspace;
    section.html = HtmlParagraph(FindingSentences(result, {"worst_place"})) +
                   HtmlParagraph(DescribeMap(map));
    figures = {MapFigures(map, OutlineOf(result)), TruthFigure(map)};
  }
  if (uncertainty.validation &&
      !HasNothing(uncertainty.validation->histogram)) {
    figures.push_back(HtmlFigure(
        "z-scores",
        HistogramFigure(
            "Validation errors over their predicted standard deviations",
            uncertainty.validation->histogram)));
  }
  section.html += HtmlParagraph(FindingSentences(result, {"prediction"})) +
                  HtmlPair(figures) + RegionTable(result).ToHtml();
  return section;
}

}  // namespace alidade::internal
