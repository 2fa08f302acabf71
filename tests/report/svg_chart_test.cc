#include "src/report/svg_chart.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "alidade/units.h"
#include "src/common/constants.h"
#include "tests/report/well_formed.h"

namespace alidade::internal {
namespace {

// Of the bar beside a map.
constexpr int kBarColours = 63;

bool Contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

int CountOf(const std::string& text, const std::string& part) {
  int count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos;
       at = text.find(part, at + part.size())) {
    ++count;
  }
  return count;
}

LineChart ChartOf(std::vector<double> x, std::vector<double> y) {
  LineChart chart;
  chart.title = "title";
  chart.subtitle = "subtitle";
  chart.x.label = "pose";
  chart.y.label = "error [mm]";
  ChartSeries series;
  series.label = "curve";
  series.x = std::move(x);
  series.y = std::move(y);
  series.marker = MarkerStyle::kDot;
  chart.series.push_back(series);
  return chart;
}

MapChart MapOf(int azimuths, int radii, double value) {
  MapChart chart;
  chart.title = "map";
  chart.x.label = "x [mm]";
  chart.y.label = "y [mm]";
  chart.colour.label = "error [mm]";
  for (int i = 0; i < azimuths; ++i) {
    for (int j = 0; j < radii; ++j) {
      const double azimuth = (-140.0 + 280.0 * i / (azimuths - 1)) * kDegree;
      const double radius = 210.0 + 190.0 * j / (radii - 1);
      chart.px.push_back(radius * std::cos(azimuth));
      chart.py.push_back(radius * std::sin(azimuth));
      chart.value.push_back(value);
    }
  }
  return chart;
}

// Values that differ from point to point, so that no two cells merge.
MapChart RoughMap() {
  MapChart chart = MapOf(60, 60, 0.0);
  for (std::size_t i = 0; i < chart.value.size(); ++i) {
    chart.value[i] = std::fmod(static_cast<double>(i) * 0.6180339887, 1.0);
  }
  return chart;
}

TEST(WellFormedTest, TheCheckItselfFindsFaults) {
  EXPECT_EQ(WhatIsMalformed("<a x=\"1\">t &amp; u<b/></a>"), "");
  for (const char* bad :
       {"", "<a>", "<a></b>", "<a><b></a></b>", "<a/><a/>", "<a x=1/>",
        "<a x=\"&\"/>", "<a>&nbsp;</a>", "<a>1 > 0</a>"}) {
    EXPECT_NE(WhatIsMalformed(bad), "") << bad;
  }
}

TEST(SvgLineChartTest, IsWellFormedAndAccessible) {
  const std::string svg = RenderSvg(ChartOf({1, 2, 3}, {4, 5, 6}));
  EXPECT_EQ(WhatIsMalformed(svg), "");
  EXPECT_TRUE(Contains(svg, "role=\"img\""));
  EXPECT_TRUE(Contains(svg, "<title>title</title>"));
  EXPECT_TRUE(Contains(svg, "<desc>subtitle. "));
  EXPECT_TRUE(Contains(svg, "curve: 3 points from 4.000 to 6.000."));
  EXPECT_TRUE(Contains(svg, "class=\"paper\""));
  EXPECT_TRUE(Contains(svg, ">error [mm]</text>"));
  EXPECT_TRUE(Contains(svg, ">pose</text>"));
}

TEST(SvgLineChartTest, EscapesEveryText) {
  LineChart chart = ChartOf({1, 2}, {1, 2});
  chart.title = "<script>alert(\"1\")</script> & 'so'";
  chart.subtitle = "a < b";
  chart.x.label = "<x>";
  chart.y.label = "<y> [mm]";
  chart.series[0].label = "<series>";
  chart.references.push_back({1.5, "</text><script>"});
  const std::string svg = RenderSvg(chart);
  EXPECT_EQ(WhatIsMalformed(svg), "");
  EXPECT_FALSE(Contains(svg, "<script"));
  EXPECT_TRUE(
      Contains(svg,
               "&lt;script&gt;alert(&quot;1&quot;)&lt;/script&gt; &amp; "
               "&#39;so&#39;"));
}

TEST(SvgLineChartTest, MendsTextThatIsNoUtf8) {
  LineChart chart = ChartOf({1, 2}, {1, 2});
  chart.title = std::string("bad \xFF\xC3 byte \x01 \xED\xA0\x80 ") + '\0';
  const std::string svg = RenderSvg(chart);
  EXPECT_EQ(WhatIsMalformed(svg), "");
  EXPECT_TRUE(Contains(svg, "bad \uFFFD\uFFFD byte"));
  EXPECT_EQ(svg.find('\xFF'), std::string::npos);
  EXPECT_EQ(svg.find('\0'), std::string::npos);
}

TEST(SvgLineChartTest, SetsPowersOfTenWithSuperscripts) {
  LineChart chart = ChartOf({1, 2}, {1e-13, 1.0});
  chart.y.logarithmic = true;
  chart.subtitle = "down to 10^-13 mm, and 2^3";
  const std::string svg = RenderSvg(chart);
  EXPECT_EQ(WhatIsMalformed(svg), "");
  // The subtitle's power, and at least every other decade's.
  EXPECT_GE(CountOf(svg, ">10⁻"), 5);
  EXPECT_TRUE(Contains(svg, "down to 10⁻¹³ mm"));
  EXPECT_TRUE(Contains(svg, "2^3"));
}

TEST(SvgLineChartTest, LogarithmicAxisLeavesOutWhatIsNotPositive) {
  LineChart chart = ChartOf({1, 2, 3, 4}, {1.0, 0.0, -5.0, 100.0});
  chart.y.logarithmic = true;
  const std::string svg = RenderSvg(chart);
  EXPECT_EQ(WhatIsMalformed(svg), "");
  EXPECT_TRUE(Contains(svg, "2 points from 1.000 to 100.0"));
  EXPECT_FALSE(Contains(svg, "nan"));
  EXPECT_FALSE(Contains(svg, "inf"));
}

TEST(SvgLineChartTest, LeavesOutWhatIsNotFiniteAndBreaksTheLine) {
  const std::string svg =
      RenderSvg(ChartOf({1, 2, 3, 4, 5}, {1, 2, kNan, 4, kInfinity}));
  EXPECT_TRUE(Contains(svg, "3 points from 1.000 to 4.000"));
  const std::size_t line = svg.find("class=\"line s1\" d=\"M");
  const std::size_t second = svg.rfind("h0\"");
  EXPECT_NE(line, std::string::npos);
  EXPECT_NE(second, std::string::npos) << "a lone point is a dot of its own";
}

TEST(SvgLineChartTest, LeavesOutWhatIsOutsideAGivenRange) {
  LineChart chart = ChartOf({1, 2, 3}, {1, 20, 3});
  chart.y.lower = 0.0;
  chart.y.upper = 10.0;
  EXPECT_TRUE(Contains(RenderSvg(chart), "2 points from 1.000 to 3.000"));
}

TEST(SvgLineChartTest, FitsARangeThatCannotBeDrawn) {
  LineChart chart = ChartOf({1, 2}, {1, 100});
  const std::string fitted = RenderSvg(chart);
  chart.y.lower = -kInfinity;
  EXPECT_EQ(RenderSvg(chart), fitted);
  chart.y.lower = 0.0;
  chart.y.upper = 10.0;
  chart.y.logarithmic = true;
  EXPECT_TRUE(Contains(RenderSvg(chart), "2 points from 1.000 to 100.0"));
}

TEST(SvgLineChartTest, SaysNoData) {
  EXPECT_TRUE(Contains(RenderSvg(LineChart()), ">no data</text>"));
  const std::string svg = RenderSvg(ChartOf({1, 2}, {kNan, -kInfinity}));
  EXPECT_EQ(WhatIsMalformed(svg), "");
  EXPECT_TRUE(Contains(svg, ">no data</text>"));
  LineChart logarithmic = ChartOf({1, 2}, {0.0, -1.0});
  logarithmic.y.logarithmic = true;
  EXPECT_TRUE(Contains(RenderSvg(logarithmic), ">no data</text>"));
}

TEST(SvgLineChartTest, WritesThePowerOfTenIntoTheUnit) {
  const std::string svg = RenderSvg(ChartOf({1, 2, 3}, {1e-13, 2e-13, 0.0}));
  EXPECT_TRUE(Contains(svg, "error [10⁻"));
  EXPECT_TRUE(Contains(svg, ">0.5</text>"));
  EXPECT_TRUE(Contains(svg, ">2.0</text>"));
}

TEST(SvgLineChartTest, IntegerAxisHasWholeTicks) {
  LineChart chart = ChartOf({0, 1, 2}, {10, 20, 30});
  chart.x.integer_ticks = true;
  const std::string svg = RenderSvg(chart);
  EXPECT_FALSE(Contains(svg, ">0.5</text>"));
  EXPECT_TRUE(Contains(svg, ">1</text>"));
}

TEST(SvgLineChartTest, TicksAreStepsOfOneTwoFive) {
  const std::string svg = RenderSvg(ChartOf({1, 2}, {2.0, 5.2}));
  for (const char* tick : {"0", "1", "2", "3", "4", "5", "6"}) {
    EXPECT_TRUE(Contains(svg, ">" + std::string(tick) + "</text>")) << tick;
  }
}

// Each of these ranges once was, or could be, a division by zero, a loop
// without end or an overflow.
TEST(SvgLineChartTest, SurvivesEveryRange) {
  const double largest = std::numeric_limits<double>::max();
  const std::vector<std::vector<double>> cases = {
      {0.0},
      {300.0},
      {-4.0, -4.0},
      {4e-4, 4e-4, 4e-4},
      {1e-8, 1e7},
      {-1e-15, 1e15},
      {5e-324, 1e-310},
      {largest, -largest},
      {1e300, -1e300},
      {1.0, std::nextafter(1.0, 2.0)},
      {1e15, 1e15 + 1.0}};
  for (const bool logarithmic : {false, true}) {
    for (const auto& y : cases) {
      LineChart chart = ChartOf(y, y);
      chart.y.logarithmic = logarithmic;
      for (const MarkerStyle marker : {MarkerStyle::kDot, MarkerStyle::kStem}) {
        chart.series[0].marker = marker;
        const std::string svg = RenderSvg(chart);
        EXPECT_EQ(WhatIsMalformed(svg), "");
        EXPECT_FALSE(Contains(svg, "\"nan")) << svg;
        EXPECT_FALSE(Contains(svg, "inf\"")) << svg;
        EXPECT_LT(svg.size(), 40000U);
      }
    }
  }
}

TEST(SvgLineChartTest, MillionPointsStaySmallAndKeepTheExtremes) {
  std::vector<double> x;
  std::vector<double> y;
  for (int i = 0; i < 1000000; ++i) {
    x.push_back(i);
    y.push_back(std::sin(1e-5 * i));
  }
  y[500001] = 7.0;
  LineChart chart = ChartOf(x, y);
  chart.series[0].marker = MarkerStyle::kNone;
  chart.y.lower = -2.0;
  chart.y.upper = 7.0;
  const std::string with_peak = RenderSvg(chart);
  EXPECT_LT(with_peak.size(), 100000U);
  chart.series[0].y[500001] = 0.0;
  EXPECT_NE(RenderSvg(chart), with_peak);
  chart.series[0].line = false;
  chart.series[0].marker = MarkerStyle::kSquare;
  EXPECT_LT(RenderSvg(chart).size(), 1000000U);
  chart.series[0].marker = MarkerStyle::kStem;
  EXPECT_LT(RenderSvg(chart).size(), 100000U);
}

TEST(SvgLineChartTest, ReferenceLinesWidenTheRangeAndAreLabelled) {
  LineChart chart = ChartOf({1, 2}, {1e-6, 1.0});
  chart.y.logarithmic = true;
  chart.references.push_back({1.6e-13, "rounding"});
  chart.references.push_back({-1.0, "has no place"});
  const std::string svg = RenderSvg(chart);
  EXPECT_TRUE(Contains(svg, ">rounding</text>"));
  EXPECT_FALSE(Contains(svg, ">has no place</text>"));
  EXPECT_TRUE(Contains(svg, ">10⁻¹²</text>"));
}

TEST(SvgLineChartTest, LegendListsLabelledSeriesOnly) {
  LineChart chart = ChartOf({1, 2}, {1, 2});
  chart.series.push_back(chart.series[0]);
  chart.series[1].label.clear();
  const std::string svg = RenderSvg(chart);
  EXPECT_EQ(CountOf(svg, ">curve</text>"), 1);
}

TEST(SvgLineChartTest, SameInputGivesSameBytes) {
  const LineChart chart = ChartOf({1, 2, 3}, {0.1, 0.2, 0.3});
  EXPECT_EQ(RenderSvg(chart), RenderSvg(chart));
}

TEST(SvgLineChartTest, FilesHaveTheirStyleAndPagesHaveNone) {
  const LineChart chart = ChartOf({1, 2, 3}, {4, 5, 6});
  const std::string file = RenderSvg(chart);
  EXPECT_TRUE(Contains(file, ".chart .s1 { color: #0072b2; }"));
  EXPECT_FALSE(Contains(file, "var("));
  const std::string figure = RenderSvg(chart, FigureMedium::kPage);
  EXPECT_EQ(WhatIsMalformed(figure), "");
  EXPECT_FALSE(Contains(figure, "<style>"));
  EXPECT_FALSE(Contains(figure, "#"));  // colours are the theme's
  EXPECT_FALSE(Contains(figure, ">title</text>"));
  EXPECT_TRUE(Contains(figure, "aria-label=\"title. subtitle. Chart"));
}

TEST(SvgLineChartTest, TipsTellEveryPointOrTheLargestOfMany) {
  LineChart chart = ChartOf({1, 2, 3}, {4, kNan, 6});
  chart.series[0].tip = [](std::size_t i) {
    return "<" + std::to_string(i) + ">\nsecond";
  };
  const std::string svg = RenderSvg(chart);
  EXPECT_EQ(WhatIsMalformed(svg), "");
  EXPECT_EQ(CountOf(svg, "</title></circle>"), 2);
  EXPECT_TRUE(Contains(svg, "<title>&lt;2&gt;\nsecond</title></circle>"));
  for (int i = 4; i < 20000; ++i) {
    chart.series[0].x.push_back(i);
    chart.series[0].y.push_back(i == 7777 ? 9.0 : 5.0 + 1e-6 * (i % 7));
  }
  const std::string many = RenderSvg(chart);
  EXPECT_LT(CountOf(many, "</title></circle>"), 800);
  EXPECT_TRUE(Contains(many, "<title>&lt;7776&gt;"));
}

TEST(SvgLineChartTest, BarsStandOnZero) {
  LineChart chart = ChartOf({0, 1, 2}, {3, 5, 4});
  chart.series[0].marker = MarkerStyle::kBar;
  const std::string svg = RenderSvg(chart);
  EXPECT_EQ(WhatIsMalformed(svg), "");
  EXPECT_TRUE(Contains(svg, "class=\"bar s1\""));
  EXPECT_TRUE(Contains(svg, ">0</text>"));
}

RowChart RowsOf(std::vector<RowMark> marks) {
  RowChart chart;
  chart.title = "rows";
  chart.x.label = "change [mm]";
  ChartSeries look;
  look.marker = MarkerStyle::kDot;
  look.line = false;
  chart.looks = {look};
  for (RowMark& mark : marks) {
    chart.rows.push_back({"row <" + std::to_string(chart.rows.size()) + ">",
                          {std::move(mark)},
                          false});
  }
  return chart;
}

TEST(SvgRowChartTest, HasARowForEachAndItsReference) {
  RowMark first;
  first.at = 0.25;
  first.lower = 0.1;
  first.upper = 0.4;
  first.tip = "d1: +0.25 mm";
  RowMark second;
  second.at = -0.5;
  RowChart chart = RowsOf({first, second});
  chart.references = {0.0, 7.0};
  chart.rows[1].is_emphasised = true;
  for (const FigureMedium medium : {FigureMedium::kFile, FigureMedium::kPage}) {
    const std::string svg = RenderSvg(chart, medium);
    EXPECT_EQ(WhatIsMalformed(svg), "");
    EXPECT_TRUE(Contains(svg, ">row &lt;0&gt;</text>"));
    EXPECT_TRUE(Contains(svg, "class=\"strong end\""));
    EXPECT_EQ(CountOf(svg, "class=\"mark full s1\""), 2);
    EXPECT_EQ(CountOf(svg, "class=\"stem s1\""), 1);
    EXPECT_EQ(CountOf(svg, "class=\"reference\""), 1);  // 7 is outside
    EXPECT_TRUE(Contains(svg, "<title>d1: +0.25 mm</title>"));
  }
}

TEST(SvgRowChartTest, BarsBeyondTheRangeEndInArrows) {
  RowMark mark;
  mark.at = 0.0;
  mark.lower = -kInfinity;
  mark.upper = kInfinity;
  RowChart chart = RowsOf({mark});
  chart.range.Include(-1.0);
  chart.range.Include(1.0);
  const std::string svg = RenderSvg(chart);
  EXPECT_EQ(WhatIsMalformed(svg), "");
  EXPECT_EQ(CountOf(svg, "class=\"mark full s1\""), 2);  // arrows, marker
  EXPECT_FALSE(Contains(svg, "inf"));
}

TEST(SvgRowChartTest, ShortensLongNamesAndSurvivesNothing) {
  RowChart chart = RowsOf({RowMark()});
  chart.rows[0].label = std::string(200, 'w') + "ä";
  const std::string svg = RenderSvg(chart);
  EXPECT_EQ(WhatIsMalformed(svg), "");
  EXPECT_TRUE(Contains(svg, "w…</text>"));
  EXPECT_EQ(WhatIsMalformed(RenderSvg(RowsOf({}))), "");
  RowMark none;
  none.at = kNan;
  RowChart logarithmic = RowsOf({none});
  logarithmic.x.logarithmic = true;
  EXPECT_EQ(WhatIsMalformed(RenderSvg(logarithmic)), "");
}

TEST(SvgMatrixChartTest, DrawsCellsWithTheirTexts) {
  MatrixChart chart;
  chart.title = "matrix";
  chart.columns = {"d1", "r2"};
  chart.rows = {{"<row>", {{"-72 mm", "s1", 0.25, "tip"}, {}}, "note", true}};
  for (const double width : {88.0, 20.0}) {
    chart.cell_width = width;
    const std::string svg = RenderSvg(chart);
    EXPECT_EQ(WhatIsMalformed(svg), "");
    EXPECT_EQ(CountOf(svg, "class=\"cell s1\""), 1);
    EXPECT_TRUE(Contains(svg, "fill-opacity=\"0.25\""));
    EXPECT_TRUE(Contains(svg, ">\u221272 mm</text>"));
    EXPECT_TRUE(Contains(svg, ">&lt;row&gt;</text>"));
    EXPECT_TRUE(Contains(svg, ">note</text>"));
    EXPECT_EQ(Contains(svg, "rotate(-60"), width < 60.0);
  }
}

TEST(SvgMapChartTest, CellsOfAGivenSizeAreSquares) {
  MapChart chart;
  chart.cell_size = 10.0;
  chart.px = {5.0, 15.0, 45.0};
  chart.py = {5.0, 5.0, 35.0};
  chart.value = {1.0, 1.0, 1.0};
  chart.tip = [](std::size_t i) { return "cell " + std::to_string(i); };
  const std::string svg = RenderSvg(chart);
  EXPECT_EQ(WhatIsMalformed(svg), "");
  EXPECT_EQ(CountOf(svg, "<path"), 1 + kBarColours);
  EXPECT_TRUE(Contains(svg, "<title>cell 2</title>"));
}

TEST(SvgMapChartTest, IsWellFormedAndSmall) {
  const std::string svg = RenderSvg(RoughMap());
  EXPECT_EQ(WhatIsMalformed(svg), "");
  EXPECT_LT(svg.size(), 300000U);
  EXPECT_TRUE(Contains(svg, "3600 points"));
  EXPECT_TRUE(Contains(svg, ">error [mm]</text>"));
  EXPECT_EQ(RenderSvg(RoughMap()), svg);
}

TEST(SvgMapChartTest, ConstantFieldHasOneColourAndASensibleBar) {
  MapChart chart = MapOf(60, 60, 4e-4);
  // Equal but for rounding.
  chart.value[7] *= 1.0 + 1e-12;
  const std::string svg = RenderSvg(chart);
  EXPECT_EQ(WhatIsMalformed(svg), "");
  EXPECT_EQ(CountOf(svg, "<path"), 1 + kBarColours);
  EXPECT_TRUE(Contains(svg, ">4.0</text>"));
  EXPECT_TRUE(Contains(svg, "error [10⁻"));
}

TEST(SvgMapChartTest, ZeroFieldHasABar) {
  const std::string svg = RenderSvg(MapOf(5, 5, 0.0));
  EXPECT_EQ(WhatIsMalformed(svg), "");
  EXPECT_FALSE(Contains(svg, "nan"));
}

TEST(SvgMapChartTest, DrawsOnePoint) {
  MapChart chart;
  chart.px = {1.0};
  chart.py = {2.0};
  chart.value = {3.0};
  const std::string svg = RenderSvg(chart);
  EXPECT_EQ(WhatIsMalformed(svg), "");
  EXPECT_EQ(CountOf(svg, "<path"), 1 + kBarColours);
}

TEST(SvgMapChartTest, SaysNoData) {
  MapChart chart = MapOf(3, 3, kNan);
  EXPECT_TRUE(Contains(RenderSvg(chart), ">no data</text>"));
  EXPECT_TRUE(Contains(RenderSvg(MapChart()), ">no data</text>"));
}

TEST(SvgMapChartTest, LogarithmicColoursSpanDecades) {
  MapChart chart = MapOf(20, 20, 1.0);
  for (std::size_t i = 0; i < chart.value.size(); ++i) {
    chart.value[i] = std::pow(10.0, -15.0 + 0.0375 * static_cast<double>(i));
  }
  chart.value[0] = 0.0;
  chart.colour.logarithmic = true;
  const std::string svg = RenderSvg(chart);
  EXPECT_EQ(WhatIsMalformed(svg), "");
  EXPECT_TRUE(Contains(svg, "399 points"));
  EXPECT_TRUE(Contains(svg, ">10⁻⁹</text>"));
}

}  // namespace
}  // namespace alidade::internal
