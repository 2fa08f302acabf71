// Bands about lines, bars in rows, charts side by side.

#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "src/common/constants.h"
#include "src/report/svg_chart.h"
#include "tests/report/report_test_util.h"
#include "tests/report/well_formed.h"

namespace alidade::internal::svg_bars_test {
namespace {

using testing::Contains;

int CountOf(const std::string& text, const std::string& part) {
  int count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos;
       at = text.find(part, at + part.size())) {
    ++count;
  }
  return count;
}

LineChart ChartOf(const std::string& title) {
  LineChart chart{title, "", {"pose"}, {"error [mm]"}};
  ChartSeries series;
  series.label = "curve";
  series.x = {0.0, 1.0, 2.0, 3.0};
  series.y = {0.5, 0.5, 0.5, 0.5};
  chart.series = {std::move(series)};
  return chart;
}

TEST(SvgBandTest, EndsAtThePlotAndAtGaps) {
  LineChart chart = ChartOf("band");
  chart.y.lower = 0.0;
  chart.y.upper = 1.0;
  chart.series[0].lower = {0.4, -9.0, kNan, 0.4};
  chart.series[0].upper = {0.6, 9.0, kNan, 0.6};
  const std::string svg = RenderSvg(chart);
  EXPECT_EQ(WhatIsMalformed(svg), "");
  EXPECT_EQ(CountOf(svg, "<rect class=\"band s1\""), 1);  // the legend's
  const std::size_t at = svg.find("<path class=\"band s1\"");
  ASSERT_NE(at, std::string::npos);
  const std::string path = svg.substr(at, svg.find("/>", at) - at);
  // Two points above, two below; the single point after the gap has no area.
  EXPECT_EQ(CountOf(path, "L"), 3);
  EXPECT_FALSE(Contains(path, "-"));  // not above the figure
}

TEST(SvgBandTest, WidensAFittedRange) {
  LineChart chart = ChartOf("band");
  chart.series[0].lower.assign(4, -40.0);
  chart.series[0].upper.assign(4, 40.0);
  EXPECT_TRUE(Contains(RenderSvg(chart), ">\u221240</text>"));
}

RowChart BarsOf(const std::vector<double>& values) {
  RowChart chart;
  chart.title = "bars";
  chart.x.label = "error [mm]";
  chart.rows = {{"a row", {}, false}};
  for (const double value : values) {
    chart.looks.push_back(Markers("", MarkerStyle::kBar));
    RowMark mark;
    mark.at = value;
    mark.series = chart.looks.size() - 1;
    chart.rows[0].marks.push_back(mark);
  }
  return chart;
}

TEST(SvgRowBarTest, BarsOfARowStandOneBelowTheOther) {
  const std::string svg = RenderSvg(BarsOf({1.0, 0.5}));
  EXPECT_EQ(WhatIsMalformed(svg), "");
  // Left, top and right of a bar.
  const auto edges = [&](const std::string& look) {
    std::array<double, 3> numbers{};
    const std::size_t at = svg.find("<path class=\"" + look + "\" d=\"M");
    EXPECT_NE(at, std::string::npos) << look;
    std::sscanf(svg.c_str() + svg.find("d=\"M", at) + 4, "%lf %lfH%lf",
                &numbers[0], &numbers[1], &numbers[2]);
    return numbers;
  };
  const auto first = edges("bar s1");
  const auto second = edges("bar hollow s2");
  EXPECT_EQ(first[0], second[0]);  // zero
  EXPECT_GT(second[1], first[1] + 5.0);
  EXPECT_NEAR(first[2] - first[0], 2.0 * (second[2] - second[0]), 0.3);
}

TEST(SvgPanelChartTest, HasEveryChartUnderItsTitle) {
  PanelChart chart{"panels", "of three", {}};
  for (const char* title : {"one", "two <2>", "three"}) {
    chart.panels.push_back(ChartOf(title));
  }
  const std::string svg = RenderSvg(chart);
  EXPECT_EQ(WhatIsMalformed(svg), "");
  EXPECT_EQ(CountOf(svg, "<svg"), 4);
  EXPECT_EQ(CountOf(svg, "<style>"), 1);
  EXPECT_TRUE(Contains(svg, ">two &lt;2&gt;</text>"));
}

}  // namespace
}  // namespace alidade::internal::svg_bars_test
