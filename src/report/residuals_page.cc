#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "src/common/format.h"
#include "src/common/text.h"
#include "src/report/figures.h"
#include "src/report/report.h"
#include "src/report/result_page.h"
#include "src/report/result_tables.h"
#include "src/report/uncertainty_report.h"

namespace alidade::internal {
namespace {

constexpr std::size_t kMostOutliers = 200;
constexpr Eigen::Index kFewestResiduals = 8;
// Slices of the workspace along each axis, and squares across one.
constexpr int kSlices = 5;
constexpr int kSquares = 22;
constexpr Eigen::Index kMostPoints = 4000;

Histogram OfOwnSpread(const EvaluatedSet& set) {
  std::vector<double> values;
  const auto& residuals = set.residual_after.map();
  for (const double value : residuals.reshaped()) {
    if (std::isfinite(value) && value != 0.0) values.push_back(value);
  }
  const auto size = static_cast<Eigen::Index>(values.size());
  const Eigen::Map<const Eigen::VectorXd> all(values.data(), size);
  if (size < kFewestResiduals) return {};
  return CountStandardised(
      all / std::sqrt(all.squaredNorm() / static_cast<double>(size)));
}

bool IsEmpty(const Histogram& histogram) {
  return std::all_of(histogram.counts.begin(), histogram.counts.end(),
                     [](std::int64_t count) { return count == 0; });
}

// Standardised residuals where they were computed, else the coordinates of the
// residuals over their own root mean square.
std::string ResidualHistogram(const CalibrationResult& result) {
  const char* const title = "Are the residuals like noise?";
  if (result.uncertainty) {
    const Histogram& computed = result.uncertainty->residuals.histogram;
    if (!IsEmpty(computed)) {
      return HtmlFigure("histogram", HistogramFigure(title, computed),
                        "residuals over their standard deviations");
    }
  }
  const Histogram own = OfOwnSpread(result.train);
  if (IsEmpty(own)) return "";
  return HtmlFigure(
      "histogram", HistogramFigure(title, own),
      "coordinates of training poses over their root mean square");
}

std::string JointFigures(const EvaluatedSet& set, const std::string& poses) {
  if (set.joint_values.cols() == 0) return "";
  std::vector<PageChoice> choices;
  for (Eigen::Index j = 0; j < set.joint_values.rows(); ++j) {
    const std::string number = std::to_string(j + 1);
    choices.push_back(
        {number,
         HtmlFigure("by-joint-" + number, JointFigure(set, j),
                    poses + "; a pattern that is left after calibration is "
                            "what the model does not have: compliance, "
                            "gears, backlash")});
  }
  return HtmlChoices("by-joint", "Error by the value of joint", choices);
}

// A fifth of the workspace across an axis: means of squares.
struct Slice {
  int axis = 2;
  double lower = 0.0;  // mm
  double upper = 0.0;
  double side = 1.0;
};

MapChart SliceChart(const PredictedMap& map, const Slice& slice) {
  const std::array<int, 2> across = {slice.axis == 0 ? 1 : 0,
                                     slice.axis == 2 ? 1 : 2};
  struct Square {
    double sum = 0.0;
    std::int64_t n = 0;
  };
  std::map<std::pair<double, double>, Square> squares;
  for (Eigen::Index i = 0; i < map.position_std.size(); ++i) {
    const Eigen::Vector3d at = map.positions.col(i) / kMillimetre;
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
                 axis(slice.axis) + " from " +
                     FormatSignificant(slice.lower, 3) + " to " +
                     FormatSignificant(slice.upper, 3) + " mm",
                 {axis(across[0]) + " [mm]"},
                 {axis(across[1]) + " [mm]"},
                 {"standard deviation [mm]"}};
  chart.cell_size = slice.side;
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
std::string MapFigures(const PredictedMap& map) {
  if (map.position_std.size() == 0) return "";
  std::vector<PageChoice> choices = {
      {"side view", HtmlFigure("side-view", PredictedMapFigure(map))}};
  for (const int axis : {2, 1, 0}) {
    const Eigen::VectorXd low =
        map.positions.rowwise().minCoeff() / kMillimetre;
    const Eigen::VectorXd high =
        map.positions.rowwise().maxCoeff() / kMillimetre;
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
                                    SliceChart(map, slice))});
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

bool HasErrors(const EvaluatedSet& set) {
  return set.residual_after.cols() > 0;
}

}  // namespace

PageSection ResidualsSection(const CalibrationResult& result) {
  constexpr auto kBefore = CalibrationState::kBefore;
  constexpr auto kAfter = CalibrationState::kAfter;
  const bool is_validated = result.validation && HasErrors(*result.validation);
  std::string html = HtmlParagraph(FindingSentences(
      result, {"sigma", "chi_square", "normality", "whiteness"}));
  html += HtmlPair({ResidualHistogram(result),
                    is_validated
                        ? JointFigures(*result.validation, "validation poses")
                        : JointFigures(result.train, "training poses")});
  if (HasErrors(result.train)) {
    html += HtmlPair(
        {HtmlFigure("by-pose-before",
                    ErrorFigure(result.train, kBefore, "training pose")),
         HtmlFigure("by-pose",
                    ErrorFigure(result.train, kAfter, "training pose"))});
  }
  if (is_validated) {
    html +=
        HtmlPair({HtmlFigure("validation-before",
                             ValidationFigure(*result.validation, kBefore)),
                  HtmlFigure("validation-after",
                             ValidationFigure(*result.validation, kAfter))});
  }
  html += HtmlParagraph(
              FindingSentences(result, {"validation_outliers", "outliers"})) +
          OutlierTable(result).ToHtml(kMostOutliers);
  if (result.uncertainty) {
    html += HtmlParagraph(DescribeLackOfFit(*result.uncertainty)) +
            StructureTable(result.uncertainty->lack_of_fit).ToHtml() +
            InfluenceTable(result.uncertainty->residuals).ToHtml();
  }
  return {"residuals", "Residuals", html};
}

PageSection PredictionSection(const CalibrationResult& result) {
  PageSection section = {"workspace", "Predicted accuracy", ""};
  if (!result.uncertainty) return section;
  const UncertaintyResult& uncertainty = *result.uncertainty;
  std::vector<std::string> figures;
  if (uncertainty.workspace) {
    const PredictedMap& map = *uncertainty.workspace;
    section.html = HtmlParagraph(DescribeMap(map));
    figures = {MapFigures(map), TruthFigure(map)};
  }
  if (uncertainty.validation && !IsEmpty(uncertainty.validation->histogram)) {
    figures.push_back(HtmlFigure(
        "z-scores",
        HistogramFigure(
            "Validation errors over their predicted standard deviations",
            uncertainty.validation->histogram)));
  }
  section.html += HtmlParagraph(FindingSentences(result, {"prediction"})) +
                  HtmlPair(figures);
  return section;
}

}  // namespace alidade::internal
