#include "src/report/run_distributions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

#include "src/common/constants.h"
#include "src/common/random.h"

namespace alidade::internal::run_distributions_test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

constexpr int kRuns = 500;

// Errors about 0.3 mm; d1 and r2 move against each other, theta3 alone.
ManyRuns MakeRuns() {
  ManyRuns runs;
  runs.error = "mean position error";
  runs.predicted = 3e-4;
  runs.parameters = {{"d1", Dimension::kLength, 1e-5, {}},
                     {"theta3", Dimension::kAngle, 1e-4, {}},
                     {"r2", Dimension::kLength, 2e-5, {}},
                     {"d4", Dimension::kLength, 1e-5, {}}};
  Random random(7, 0);
  for (int i = 0; i < kRuns; ++i) {
    runs.before.push_back(5e-3);
    runs.after.push_back(3e-4 * std::exp(0.2 * random.Normal()));
    const double common = random.Normal();
    runs.parameters[0].values.push_back(1e-5 * common);
    runs.parameters[1].values.push_back(1e-4 * random.Normal());
    runs.parameters[2].values.push_back(
        -2e-5 *
        (0.95 * common + std::sqrt(1.0 - 0.95 * 0.95) * random.Normal()));
    runs.parameters[3].values.push_back(0.16);  // does not move
  }
  return runs;
}

const ChartSeries& SeriesOf(const LineChart& chart, const std::string& label) {
  for (const ChartSeries& series : chart.series) {
    if (series.label == label) return series;
  }
  throw std::runtime_error("no series " + label);
}

TEST(RunDistributionsTest, HistogramCountsEveryRunOnce) {
  ManyRuns runs = MakeRuns();
  const LineChart chart = ErrorHistogram(runs);
  const ChartSeries& bars = chart.series.front();
  EXPECT_EQ(std::accumulate(bars.y.begin(), bars.y.end(), 0.0), kRuns);
  EXPECT_GE(bars.y.size(), 8U);
  EXPECT_LE(bars.y.size(), 61U);
  for (std::size_t k = 0; k < bars.x.size(); ++k) {
    const double lower = bars.x[k] - 0.5 * bars.bar_width;
    const double upper = bars.x[k] + 0.5 * bars.bar_width;
    const auto inside =
        std::count_if(runs.after.begin(), runs.after.end(), [&](double error) {
          return error * 1e3 >= lower && error * 1e3 < upper;
        });
    // One at a bin's very edge may be on either side.
    EXPECT_NEAR(bars.y[k], static_cast<double>(inside), 1.0) << k;
  }
  runs.after.assign(kRuns, 2e-4);
  runs.after[3] = kNan;
  EXPECT_EQ(ErrorHistogram(runs).series.front().y,
            (std::vector<double>{kRuns - 1.0}));
}

TEST(RunDistributionsTest, DistributionIsTheShareBelow) {
  const ManyRuns runs = MakeRuns();
  const LineChart chart = ErrorDistribution(runs);
  const ChartSeries& after = SeriesOf(chart, "after");
  ASSERT_THAT(after.x, SizeIs(kRuns));
  for (const std::size_t i : {0, 100, 250, 499}) {
    const auto below =
        std::count_if(runs.after.begin(), runs.after.end(), [&](double error) {
          return error * 1e3 <= after.x[i] * (1.0 + 1e-12);
        });
    EXPECT_DOUBLE_EQ(after.y[i], 100.0 * static_cast<double>(below) / kRuns);
  }
  EXPECT_EQ(SeriesOf(chart, "predicted").x, (std::vector<double>{0.3, 0.3}));
  // 5 mm before are too far off to be drawn, but said.
  EXPECT_EQ(chart.series.size(), 2U);
  EXPECT_EQ(chart.subtitle.rfind("before calibration 5.00 mm", 0), 0U);
  ManyRuns near = runs;
  near.before.assign(kRuns, 6e-4);
  EXPECT_EQ(SeriesOf(ErrorDistribution(near), "before").y.back(), 100.0);
}

TEST(RunDistributionsTest, PairsThatGoTogetherAreFound) {
  ManyRuns runs = MakeRuns();
  const std::vector<ParameterPair> pairs = MostCorrelated(runs.parameters, 3);
  ASSERT_THAT(pairs, SizeIs(1));  // theta3 has no other one that scatters
  EXPECT_EQ(pairs[0].first, 0U);
  EXPECT_EQ(pairs[0].second, 2U);
  // Three standard errors of the correlation, (1 - rho^2) / sqrt(n).
  EXPECT_NEAR(pairs[0].correlation, -0.95, 0.013);
  const LineChart chart = PairChart(runs, pairs[0]);
  EXPECT_EQ(chart.title, "d1 and r2");
  EXPECT_THAT(chart.series.front().x, SizeIs(kRuns));
  // Runs that lack one of the two are left out.
  runs.parameters[0].values[0] = kNan;
  EXPECT_NEAR(MostCorrelated(runs.parameters, 1)[0].correlation,
              pairs[0].correlation, 0.01);
}

TEST(RunDistributionsTest, SpreadStandsAgainstPrediction) {
  const LineChart chart = SpreadChart(MakeRuns(), Dimension::kLength);
  const ChartSeries& points = SeriesOf(chart, "parameters");
  ASSERT_THAT(points.x, SizeIs(2));  // without the one that does not move
  EXPECT_NEAR(points.x[0], 0.01, 1e-12);
  // 5 standard errors of a standard deviation, 1 / sqrt(2 n) each.
  EXPECT_NEAR(points.y[0] / points.x[0], 1.0, 0.16);
  EXPECT_NEAR(points.y[1] / points.x[1], 1.0, 0.16);
}

TEST(RunDistributionsTest, PartsWithoutDataAreLeftOut) {
  ManyRuns runs = MakeRuns();
  runs.parameters.clear();
  const std::string html = DistributionFigures(runs);
  EXPECT_THAT(html, HasSubstr("id=\"error-histogram\""));
  EXPECT_THAT(html, Not(HasSubstr("id=\"spread-")));
  EXPECT_THAT(html, Not(HasSubstr("id=\"pair-")));
  EXPECT_THAT(MostCorrelated({}, 3), IsEmpty());
  EXPECT_EQ(MedianAndRange({}, "run"), "nothing was evaluated");
  EXPECT_EQ(MedianAndRange({1e-3, kNan}, "run"),
            "1.00 mm in the median run, 1.00 mm to 1.00 mm in 90 % of 1");
}

}  // namespace
}  // namespace alidade::internal::run_distributions_test
