#include "src/report/run_distributions.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "src/common/format.h"
#include "src/common/text.h"
#include "src/report/page.h"
#include "src/report/table.h"

namespace alidade::internal {
namespace {

constexpr std::size_t kPairs = 4;

std::int64_t Size(const std::vector<double>& values) {
  return static_cast<std::int64_t>(values.size());
}

// The finite ones, the smallest first.
std::vector<double> Sorted(std::vector<double> values) {
  values.erase(
      std::remove_if(values.begin(), values.end(),
                     [](double value) { return !std::isfinite(value); }),
      values.end());
  std::sort(values.begin(), values.end());
  return values;
}

// @pre sorted, not empty.
double Quantile(const std::vector<double>& sorted, double share) {
  const double place = share * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  const double part = place - static_cast<double>(below);
  return sorted[below] + part * (sorted[above] - sorted[below]);
}

struct Moments {
  double mean = 0.0;
  double std = 0.0;
};

// What rounding leaves of equal values is no scatter.
Moments MomentsOf(const std::vector<double>& values) {
  constexpr double kRounding = 1e-12;
  Moments moments;
  const auto n = static_cast<double>(values.size());
  for (const double value : values) moments.mean += value / n;
  double sum = 0.0;
  for (const double value : values) {
    sum += (value - moments.mean) * (value - moments.mean);
  }
  moments.std = values.size() > 1 ? std::sqrt(sum / (n - 1.0)) : 0.0;
  if (moments.std <= kRounding * std::abs(moments.mean)) moments.std = 0.0;
  return moments;
}

// Of the runs that have both; 0 where one of the two does not scatter.
double Correlation(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> x;
  std::vector<double> y;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    if (!std::isfinite(a[i]) || !std::isfinite(b[i])) continue;
    x.push_back(a[i]);
    y.push_back(b[i]);
  }
  const Moments of_x = MomentsOf(x);
  const Moments of_y = MomentsOf(y);
  if (!(of_x.std > 0.0) || !(of_y.std > 0.0)) return 0.0;
  double sum = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    sum += (x[i] - of_x.mean) * (y[i] - of_y.mean);
  }
  return sum / (of_x.std * of_y.std * static_cast<double>(x.size() - 1));
}

// As wide as Freedman and Diaconis (1981) have it, between 8 and 60 of them.
double BinWidth(const std::vector<double>& sorted) {
  const double range = sorted.back() - sorted.front();
  if (!(range > 0.0)) return std::max(1e-3 * std::abs(sorted.front()), 1e-12);
  const double quartiles = Quantile(sorted, 0.75) - Quantile(sorted, 0.25);
  const double wanted =
      2.0 * quartiles / std::cbrt(static_cast<double>(sorted.size()));
  return std::clamp(wanted, range / 60.0, range / 8.0);
}

std::string ErrorLabel(const ManyRuns& runs) { return runs.error + " [mm]"; }

std::vector<double> InMillimetres(std::vector<double> metres) {
  for (double& value : metres) value /= kMillimetre;
  return Sorted(std::move(metres));
}

// A line upwards at `x`.
ChartSeries Upright(const std::string& label, double x, double top,
                    const std::string& look) {
  ChartSeries line;
  line.label = label;
  line.x = {x, x};
  line.y = {0.0, top};
  line.colour = look;
  return line;
}

ChartSeries ShareUpTo(const std::string& label,
                      const std::vector<double>& sorted,
                      const std::string& look) {
  ChartSeries series;
  series.label = label;
  series.colour = look;
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    series.x.push_back(sorted[i]);
    series.y.push_back(100.0 * static_cast<double>(i + 1) /
                       static_cast<double>(sorted.size()));
  }
  series.tip = [label, x = series.x, y = series.y](std::size_t i) {
    return label + ": " + FormatSignificant(x[i], 3) + " mm or less\nin " +
           FixedNumber(y[i], 1) + " %";
  };
  return series;
}

double Spread(const RunParameter& parameter) {
  return MomentsOf(Sorted(parameter.values)).std;
}

}  // namespace

std::vector<ParameterPair> MostCorrelated(
    const std::vector<RunParameter>& parameters, std::size_t most) {
  std::vector<ParameterPair> pairs;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    for (std::size_t k = i + 1; k < parameters.size(); ++k) {
      const double correlation =
          Correlation(parameters[i].values, parameters[k].values);
      if (correlation != 0.0) pairs.push_back({i, k, correlation});
    }
  }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const ParameterPair& a, const ParameterPair& b) {
                     return std::abs(a.correlation) > std::abs(b.correlation);
                   });
  std::vector<ParameterPair> chosen;
  std::vector<bool> is_taken(parameters.size(), false);
  for (const ParameterPair& pair : pairs) {
    if (chosen.size() == most) break;
    if (is_taken[pair.first] || is_taken[pair.second]) continue;
    is_taken[pair.first] = is_taken[pair.second] = true;
    chosen.push_back(pair);
  }
  return chosen;
}

LineChart ErrorHistogram(const ManyRuns& runs) {
  const std::vector<double> errors = InMillimetres(runs.after);
  LineChart chart;
  chart.title = "Error after calibration, histogram";
  chart.x.label = ErrorLabel(runs);
  chart.y = CountAxis("number of " + runs.each + "s");
  if (errors.empty()) return chart;
  const double width = BinWidth(errors);
  ChartSeries bars = Markers("", MarkerStyle::kBar, "s1");
  bars.bar_width = width;
  const double first = std::floor(errors.front() / width) * width;
  for (const double error : errors) {
    const auto bin = static_cast<std::size_t>((error - first) / width);
    while (bars.x.size() <= bin) {
      bars.x.push_back(first +
                       width * (static_cast<double>(bars.x.size()) + 0.5));
      bars.y.push_back(0.0);
    }
    bars.y[bin] += 1.0;
  }
  bars.tip = [each = runs.each, x = bars.x, y = bars.y, width](std::size_t k) {
    return FormatSignificant(x[k] - 0.5 * width, 4) + " to " +
           FormatSignificant(x[k] + 0.5 * width, 4) + " mm:\n" +
           Count(static_cast<std::int64_t>(y[k]), each);
  };
  const double top = *std::max_element(bars.y.begin(), bars.y.end());
  chart.series = {bars,
                  Upright("median", Quantile(errors, 0.5), top, "s7 solid")};
  if (std::isfinite(runs.predicted)) {
    chart.series.push_back(
        Upright("predicted", runs.predicted / kMillimetre, top, "s2 dashed"));
  }
  chart.subtitle = MedianAndRange(runs.after, runs.each);
  // Whole bars, and the lines.
  ValueRange shown;
  for (const ChartSeries& series : chart.series) {
    for (const double x : series.x) shown.Include(x);
  }
  chart.x.lower = shown.min - 0.5 * width;
  chart.x.upper = shown.max + 0.5 * width;
  return chart;
}

LineChart ErrorDistribution(const ManyRuns& runs) {
  // Where errors before are far from those after, one of the two has no room.
  constexpr double kFar = 5.0;
  LineChart chart;
  chart.title = "Share of " + runs.each + "s up to an error";
  chart.y = {"share of the " + runs.each + "s [%]", false, 0.0, 100.0};
  chart.references = {{50.0, ""}, {95.0, "95 %"}};
  chart.x.label = ErrorLabel(runs);
  const std::vector<double> after = InMillimetres(runs.after);
  const std::vector<double> before = InMillimetres(runs.before);
  if (after.empty()) return chart;
  chart.x.logarithmic = after.back() > kFar * after.front();
  if (!before.empty()) {
    if (before.front() < kFar * after.back()) {
      chart.series.push_back(ShareUpTo("before", before, "s2 dashed"));
    } else {
      chart.subtitle =
          "before calibration " + MedianAndRange(runs.before, runs.each);
    }
  }
  chart.series.push_back(ShareUpTo("after", after, "s1"));
  if (std::isfinite(runs.predicted)) {
    chart.series.push_back(
        Upright("predicted", runs.predicted / kMillimetre, 100.0, "s0"));
  }
  return chart;
}

LineChart SpreadChart(const ManyRuns& runs, Dimension dimension) {
  const std::string unit = std::string(" [") + UnitForPeople(dimension) + "]";
  const bool is_angle = dimension == Dimension::kAngle;
  LineChart chart;
  chart.title = std::string("Spread against prediction, ") +
                (is_angle ? "angles" : "lengths");
  chart.subtitle = "each dot is a parameter, its standard deviation over all " +
                   runs.each + "s against the one that was predicted";
  chart.x = LogarithmicAxis("predicted std" + unit);
  chart.y = LogarithmicAxis("std over the " + runs.each + "s" + unit);
  ChartSeries points = Markers("parameters", MarkerStyle::kDot, "s1");
  std::vector<std::string> names;
  ValueRange range;
  for (const RunParameter& parameter : runs.parameters) {
    if (parameter.dimension != dimension) continue;
    const double predicted = parameter.predicted_std / UnitOf(dimension);
    const double spread = Spread(parameter) / UnitOf(dimension);
    if (!(predicted > 0.0) || !(spread > 0.0)) continue;
    points.x.push_back(predicted);
    points.y.push_back(spread);
    range.Include(predicted);
    names.push_back(parameter.name);
  }
  points.tip = [names, x = points.x, y = points.y](std::size_t i) {
    return names[i] + ": " + FormatSignificant(y[i], 3) + "\npredicted " +
           FormatSignificant(x[i], 3);
  };
  ChartSeries equal;
  equal.label = "as predicted";
  equal.colour = "s0";
  if (!range.empty()) {
    equal.x = {0.8 * range.min, 1.25 * range.max};
    equal.y = equal.x;
    chart.series = {equal, points};
  }
  return chart;
}

LineChart PairChart(const ManyRuns& runs, const ParameterPair& pair) {
  const RunParameter& first = runs.parameters[pair.first];
  const RunParameter& second = runs.parameters[pair.second];
  const auto axis = [](const RunParameter& parameter) {
    ChartAxis shown;
    shown.label =
        parameter.name + " [" + UnitForPeople(parameter.dimension) + "]";
    return shown;
  };
  LineChart chart;
  chart.title = first.name + " and " + second.name;
  chart.subtitle = "correlation " + FixedNumber(pair.correlation, 3) +
                   ", from the mean of all " + runs.each + "s";
  chart.x = axis(first);
  chart.y = axis(second);
  ChartSeries points = Markers("", MarkerStyle::kDot, "s6");
  const double mean_x = MomentsOf(Sorted(first.values)).mean;
  const double mean_y = MomentsOf(Sorted(second.values)).mean;
  for (std::size_t i = 0;
       i < std::min(first.values.size(), second.values.size()); ++i) {
    points.x.push_back((first.values[i] - mean_x) / UnitOf(first.dimension));
    points.y.push_back((second.values[i] - mean_y) / UnitOf(second.dimension));
  }
  chart.series = {points};
  return chart;
}

std::string DistributionFigures(const ManyRuns& runs) {
  std::string html =
      HtmlPair({HtmlFigure("error-histogram", ErrorHistogram(runs)),
                HtmlFigure("error-distribution", ErrorDistribution(runs))});
  std::vector<std::string> spreads;
  for (const Dimension dimension : {Dimension::kAngle, Dimension::kLength}) {
    const LineChart chart = SpreadChart(runs, dimension);
    if (chart.series.empty()) continue;
    spreads.push_back(HtmlFigure(
        dimension == Dimension::kAngle ? "spread-angles" : "spread-lengths",
        chart));
  }
  html += HtmlPair(spreads);
  std::vector<std::string> pairs;
  for (const ParameterPair& pair : MostCorrelated(runs.parameters, kPairs)) {
    pairs.push_back(HtmlFigure("pair-" + std::to_string(pairs.size() + 1),
                               PairChart(runs, pair)));
  }
  return html + HtmlPair(pairs);
}

std::string MedianAndRange(std::vector<double> errors,
                           const std::string& each) {
  const std::vector<double> sorted = Sorted(std::move(errors));
  if (sorted.empty()) return "nothing was evaluated";
  return FormatLength(Quantile(sorted, 0.5), 3) + " in the median " + each +
         ", " + FormatLength(Quantile(sorted, 0.05), 3) + " to " +
         FormatLength(Quantile(sorted, 0.95), 3) + " in 90 % of " +
         std::to_string(Size(sorted));
}

}  // namespace alidade::internal
