#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "src/common/format.h"
#include "src/common/text.h"
#include "src/report/comparison_page.h"
#include "src/report/markup.h"
#include "src/report/page.h"
#include "src/report/run_distributions.h"
#include "src/report/svg_chart.h"
#include "src/report/table.h"
#include "src/solve/solver_names.h"

namespace alidade::internal {
namespace {

// Of figures.
constexpr std::size_t kMostArms = 60;
// Of tables: of more results their distributions say more than a row of each.
constexpr std::size_t kMostArmRows = 100;
constexpr std::size_t kMostRunRows = 20;
constexpr std::size_t kMostMatrixRows = 40;
constexpr std::size_t kMostMatrixColumns = 48;
constexpr double kMatrixWidth = 840.0;
constexpr std::size_t kMostChanges = 500;
constexpr std::size_t kMostReasons = 8;
constexpr std::size_t kMostLegends = 3;
// Scores of the strongest colour.
constexpr double kStrongScore = 6.0;

std::string Quantity(double value, Dimension dimension) {
  return WithSign(InUnit(value, dimension, 3)) +
         (dimension == Dimension::kLength ? " mm" : " deg");
}

TableCell ScoreCell(double score) {
  if (!std::isfinite(score)) return "–";
  return {WithSign(std::abs(score) < 100.0 ? FixedNumber(score, 1)
                                           : FormatSignificant(score, 3)),
          score};
}

TableCell BadgeCell(FindingLevel level, const std::string& words) {
  TableCell cell(words);
  cell.markup = HtmlBadge(level, words);
  return cell;
}

// Links are paths, whatever characters are in them.
TableCell LabelCell(const ComparedItems& all, std::size_t i) {
  TableCell cell(all.values[i].label);
  const std::string& link = all.items[i].link;
  if (link.empty()) return cell;
  constexpr char kHex[] = "0123456789ABCDEF";
  std::string path = "./";
  for (const char c : link) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) != 0 ||
        std::string("/-_.~").find(c) != std::string::npos) {
      path += c;
    } else {
      path += {'%', kHex[byte >> 4U], kHex[byte & 15U]};
    }
  }
  cell.markup = Element("a", {{"href", path}}, EscapeXml(cell.text));
  return cell;
}

std::string DescribeError(const std::string& label, const std::string& when,
                          const Accuracy& accuracy) {
  return label + "\n" + when + ": mean " + FormatLength(accuracy.mean, 3) +
         ", largest " + FormatLength(accuracy.max, 3);
}

// The error after calibration, from its mean to the largest.
RowMark MeanToLargest(const ComparedResult& result, std::size_t series) {
  const double mean = result.after.mean / kMillimetre;
  return {mean, mean, result.after.max / kMillimetre, series,
          DescribeError(result.label, "after", result.after)};
}

std::string Outliers(const ComparedItems& all, const FleetSummary& fleet) {
  std::vector<std::string> items;
  for (const FleetArm& arm : fleet.arms) {
    if (!arm.is_outlier || items.size() == kMostReasons) continue;
    std::vector<std::string> reasons;
    for (const Finding& finding : arm.findings) {
      if (finding.level == FindingLevel::kAttention) {
        reasons.push_back(finding.sentence);
      }
    }
    items.push_back(
        Element("strong", {}, EscapeXml(all.values[arm.result].label)) +
        Words(": " + Join(reasons, "; ") + "."));
  }
  return items.size() > 1 ? HtmlList(items, "outlying-arms", "plain") : "";
}

std::string RowLabel(const ComparedItems& all, const FleetArm& arm) {
  return (arm.is_outlier ? "▲ " : "") + all.values[arm.result].label;
}

std::string FleetFigure(const ComparedItems& all, const FleetSummary& fleet) {
  RowChart chart{"Position error of each arm, by score", "",
                 LogarithmicAxis("mean position error [mm]")};
  chart.looks = {Markers("before", MarkerStyle::kSquare, "s2"),
                 Markers("after", MarkerStyle::kDot, "s1")};
  const std::size_t most =
      fleet.arms.size() > kMostArmRows ? kMostRunRows : kMostArms;
  for (const FleetArm& arm : fleet.arms) {
    if (chart.rows.size() == most) break;
    const ComparedResult& result = all.values[arm.result];
    RowMark before;
    before.at = result.before.mean / kMillimetre;
    before.tip = DescribeError(result.label, "before", result.before);
    chart.rows.push_back({RowLabel(all, arm),
                          {before, MeanToLargest(result, 1)},
                          arm.is_outlier});
  }
  std::string note =
      "▲ marks outliers. The line from the mean after calibration reaches to "
      "its largest error.";
  if (fleet.arms.size() > most) {
    note += " The first " + std::to_string(most) + " of " +
            std::to_string(fleet.arms.size()) + " are drawn.";
  }
  return HtmlFigure("fleet-accuracy", chart, note);
}

// Deviations from nominal of the parameters that most results estimate, and
// the median of what each predicts.
std::vector<RunParameter> ParametersOf(
    const std::vector<ComparedResult>& results) {
  std::vector<RunParameter> parameters;
  std::map<std::string, std::size_t> places;
  std::vector<std::vector<double>> stds;
  for (std::size_t i = 0; i < results.size(); ++i) {
    for (const ComparedParameter& one : results[i].parameters) {
      if (!one.is_free) continue;
      const auto [place, is_new] = places.emplace(one.name, parameters.size());
      if (is_new) {
        parameters.push_back(
            {one.name, one.dimension, 0.0,
             std::vector<double>(results.size(),
                                 std::numeric_limits<double>::quiet_NaN())});
        stds.emplace_back();
      }
      parameters[place->second].values[i] = one.deviation;
      if (std::isfinite(one.std)) stds[place->second].push_back(one.std);
    }
  }
  std::vector<RunParameter> kept;
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    std::vector<double>& of = stds[k];
    if (2 * of.size() < results.size() || of.empty()) continue;
    const auto middle = of.begin() + static_cast<std::ptrdiff_t>(of.size() / 2);
    std::nth_element(of.begin(), middle, of.end());
    parameters[k].predicted_std = *middle;
    kept.push_back(std::move(parameters[k]));
  }
  return kept;
}

std::string Distributions(const ComparedItems& all, const std::string& each) {
  ManyRuns runs;
  runs.each = each;
  runs.error = "mean position error";
  for (const ComparedResult& result : all.values) {
    runs.before.push_back(result.before.mean);
    runs.after.push_back(result.after.mean);
  }
  runs.parameters = ParametersOf(all.values);
  return DistributionFigures(runs);
}

std::string LimitWords(const ComparisonItem& item) {
  if (item.num_limits == 0) return "none set";
  return item.num_missed > 0 ? "missed" : "met";
}

// The parameter in which an arm differs most.
std::string MostDifferent(const FleetSummary& fleet, const FleetArm& arm) {
  if (!arm.most_different) return "–";
  const FleetParameter& parameter = fleet.parameters[*arm.most_different];
  return parameter.name + " " +
         Typeset(Quantity(parameter.deviations.values[arm.result],
                          parameter.dimension) +
                 " (z\u00a0=\u00a0" +
                 FormatSignificant(parameter.deviations.scores[arm.result], 2) +
                 ")");
}

Table FleetTable(const ComparedItems& all, const FleetSummary& fleet) {
  const bool has_limits = std::any_of(
      all.items.begin(), all.items.end(),
      [](const ComparisonItem& item) { return item.num_limits > 0; });
  const bool has_warnings = std::any_of(
      all.items.begin(), all.items.end(),
      [](const ComparisonItem& item) { return item.num_warnings > 0; });
  const bool is_validated = std::all_of(
      all.values.begin(), all.values.end(),
      [](const ComparedResult& result) { return result.is_validated; });
  const std::size_t shown = std::min(fleet.arms.size(), kMostArmRows);
  Table table(
      "fleet",
      (shown < fleet.arms.size()
           ? std::to_string(shown) + " of " +
                 std::to_string(fleet.arms.size()) + " arms, "
           : std::string("Every arm, ")) +
          (is_validated ? "at validation poses, " : "") +
          "the largest score first",
      {"arm", "verdict|among the others", ">before [mm]|mean position error",
       ">after [mm]|mean position error", ">largest [mm]|after calibration",
       ">n", ">z before|modified z-score of the error before calibration",
       ">z after", ">z geometry", "differs most in|deviation from nominal",
       "limits", ">warnings"});
  for (std::size_t k = 0; k < shown; ++k) {
    const FleetArm& arm = fleet.arms[k];
    const std::size_t i = arm.result;
    const ComparedResult& result = all.values[i];
    const ComparisonItem& item = all.items[i];
    const FindingLevel limits = item.num_limits == 0  ? FindingLevel::kNote
                                : item.num_missed > 0 ? FindingLevel::kFailed
                                                      : FindingLevel::kPassed;
    table.AddRow(
        {LabelCell(all, i),
         BadgeCell(
             arm.is_outlier ? FindingLevel::kAttention : FindingLevel::kNote,
             arm.is_outlier ? "outlier" : "typical"),
         QuantityCell(result.before.mean, Dimension::kLength, 3),
         QuantityCell(result.after.mean, Dimension::kLength, 3),
         QuantityCell(result.after.max, Dimension::kLength, 3),
         CountCell(result.after.n), ScoreCell(fleet.before.scores[i]),
         ScoreCell(fleet.after.scores[i]), ScoreCell(fleet.geometry.scores[i]),
         MostDifferent(fleet, arm),
         has_limits ? BadgeCell(limits, LimitWords(item)) : TableCell(""),
         has_warnings ? CountCell(item.num_warnings) : TableCell("")},
        arm.is_outlier ? "outlier" : "");
  }
  return table;
}

MatrixCell ScoreOf(const FleetParameter& parameter, const FleetArm& arm,
                   const std::string& label, bool has_room) {
  const double score = parameter.deviations.scores[arm.result];
  if (!std::isfinite(score)) return {};
  MatrixCell cell;
  cell.colour = score > 0.0 ? "s2" : "s1";
  cell.opacity = 0.08 + 0.85 * std::min(1.0, std::abs(score) / kStrongScore);
  if (std::abs(score) > FleetSummary::kThreshold && has_room) {
    cell.text = FixedNumber(score, 0);
  }
  cell.tip =
      label + ", " + parameter.name + ":\n" +
      Quantity(parameter.deviations.values[arm.result], parameter.dimension) +
      " against nominal, z = " + FixedNumber(score, 1);
  return cell;
}

// Scores of all parameters as colours; numbers where they are beyond the
// threshold.
std::string ScoreFigure(const ComparedItems& all, const FleetSummary& fleet) {
  const std::size_t columns =
      std::min(fleet.parameters.size(), kMostMatrixColumns);
  const std::size_t rows = std::min(fleet.arms.size(), kMostMatrixRows);
  if (columns == 0 || rows < 3) return "";
  MatrixChart chart{"Where each arm differs from the median arm"};
  chart.cell_height = 20.0;
  chart.cell_width =
      std::clamp(kMatrixWidth / static_cast<double>(columns), 16.0, 40.0);
  for (std::size_t k = 0; k < columns; ++k) {
    chart.columns.push_back(fleet.parameters[k].name);
  }
  for (std::size_t i = 0; i < rows; ++i) {
    const FleetArm& arm = fleet.arms[i];
    MatrixRow row{RowLabel(all, arm), {}, "", arm.is_outlier};
    for (std::size_t k = 0; k < columns; ++k) {
      row.cells.push_back(ScoreOf(fleet.parameters[k], arm,
                                  all.values[arm.result].label,
                                  chart.cell_width > 20.0));
    }
    chart.rows.push_back(std::move(row));
  }
  return Element(
      "div", {{"class", "wide"}},
      HtmlFigure(
          "fleet-scores", chart,
          "A column is a parameter, its colour how far it is from the median "
          "of all arms, in robust standard deviations: orange larger, blue "
          "smaller, pale typical. Numbers stand where it is more than " +
              ShortestNumber(FleetSummary::kThreshold) +
              ". Grey: not estimated of that arm."));
}

Table ChangeTable(const ComparedItems& all, const DriftSummary& drift) {
  const std::size_t shown = std::min(drift.changes.size(), kMostChanges);
  std::string caption =
      "Changes from each result to the next, the most significant first";
  if (shown < drift.changes.size()) {
    caption += ", " + std::to_string(shown) + " of " +
               std::to_string(drift.changes.size());
  }
  Table table("changes", std::move(caption),
              {"parameter", "from", "to", ">before", ">after", ">change",
               ">std|of the change", "unit", ">change / std", "verdict"});
  for (std::size_t k = 0; k < shown; ++k) {
    const ParameterChange& change = drift.changes[k];
    const double unit = UnitOf(change.dimension);
    TableCell difference = FixedCell(change.difference() / unit, 4);
    difference.text = WithSign(difference.text);
    table.AddRow(
        {change.name, all.values[change.from].label,
         all.values[change.from + 1].label, FixedCell(change.before / unit, 4),
         FixedCell(change.after / unit, 4), difference,
         NumberCell(change.std / unit, 2), UnitForPeople(change.dimension),
         ScoreCell(change.score()),
         BadgeCell(change.is_significant ? FindingLevel::kAttention
                                         : FindingLevel::kNote,
                   change.is_significant ? "significant" : "not significant")},
        change.is_significant ? "outlier" : "");
  }
  return table;
}

// One colour for each change from a result to the next; beyond three, one for
// all.
std::string ChangeFigure(const ComparedItems& all, const DriftSummary& drift) {
  constexpr MarkerStyle kMarkers[] = {MarkerStyle::kDot, MarkerStyle::kSquare,
                                      MarkerStyle::kTriangle};
  RowChart chart{"Change of each parameter in units of its standard deviation",
                 "",
                 {"change / standard deviation"}};
  chart.references = {-DriftSummary::kThreshold, 0.0, DriftSummary::kThreshold};
  for (std::size_t i = 0; i < kMostLegends; ++i) {
    std::string label;
    if (i + 1 < all.values.size() && all.values.size() <= kMostLegends + 1) {
      label = all.values[i].label + " to " + all.values[i + 1].label;
    }
    chart.looks.push_back(Markers(label, kMarkers[i]));
  }
  for (std::size_t k = 0; k < std::min(drift.changes.size(), kMostChanges);
       ++k) {
    const ParameterChange& change = drift.changes[k];
    if (!std::isfinite(change.score())) continue;
    auto row = std::find_if(
        chart.rows.begin(), chart.rows.end(),
        [&](const ChartRow& each) { return each.label == change.name; });
    if (row == chart.rows.end()) {
      if (chart.rows.size() == kMostArms) continue;
      row = chart.rows.insert(row, {change.name, {}, false});
    }
    RowMark mark;
    mark.at = change.score();
    mark.series = change.from % kMostLegends;
    mark.tip = change.name + ", " + all.values[change.from].label + " to " +
               all.values[change.from + 1].label + ":\n" +
               Quantity(change.difference(), change.dimension) + ", " +
               FixedNumber(change.score(), 1) + " std";
    row->marks.push_back(mark);
    row->is_emphasised |= change.is_significant;
  }
  if (chart.rows.empty()) return "";
  return HtmlFigure("changes-figure", chart,
                    "Beyond the dashed lines at " +
                        ShortestNumber(DriftSummary::kThreshold) +
                        " a change is significant.");
}

std::string AccuracyOverTime(const ComparedItems& all) {
  LineChart chart{"Mean position error", "", CountAxis("result, in order"),
                  LogarithmicAxis("mean error [mm]")};
  ChartSeries before = Markers("before", MarkerStyle::kSquare, "s2");
  ChartSeries after = Markers("after", MarkerStyle::kDot, "s1");
  const auto add = [&all](ChartSeries* series, Accuracy ComparedResult::*of) {
    series->line = true;
    for (std::size_t i = 0; i < all.values.size(); ++i) {
      series->x.push_back(static_cast<double>(i + 1));
      series->y.push_back((all.values[i].*of).mean / kMillimetre);
    }
    series->tip = [&all, label = series->label, of](std::size_t i) {
      return DescribeError(all.values[i].label, label, all.values[i].*of);
    };
  };
  add(&before, &ComparedResult::before);
  add(&after, &ComparedResult::after);
  chart.series = {before, after};
  return HtmlFigure("accuracy-over-time", chart);
}

// Every solver of these results.
Table MethodTable(const ComparedItems& all, const std::string& caption,
                  const std::vector<std::size_t>& places) {
  Table table("methods", caption,
              {"result", "solver", "outcome", ">free", ">iterations",
               ">chi-square", ">training mean [mm]", ">validation mean [mm]",
               ">validation largest [mm]", ">solving"});
  for (const std::size_t i : places) {
    const ComparisonItem& item = all.items[i];
    const ComparedResult& result = all.values[i];
    for (const ComparedRun& run : item.runs) {
      // Others were not evaluated at validation poses.
      const bool is_validated =
          result.is_validated && &run == &item.runs.front();
      const auto validated = [&](double error) {
        return is_validated ? QuantityCell(error, Dimension::kLength, 3)
                            : TableCell("");
      };
      table.AddRow({LabelCell(all, i),
                    SolverTitle(run.solver),
                    ToString(run.status),
                    CountCell(item.num_free),
                    CountCell(run.iterations),
                    NumberCell(run.cost, 4),
                    QuantityCell(run.train_mean, Dimension::kLength, 3),
                    validated(result.after.mean),
                    validated(result.after.max),
                    {FormatDuration(run.time_s), run.time_s}});
    }
  }
  return table;
}

}  // namespace

std::string FleetView(const ComparedItems& all, const FleetSummary& fleet) {
  const std::string threshold = ShortestNumber(FleetSummary::kThreshold);
  std::string html = Outliers(all, fleet);
  if (fleet.arms.size() > kMostArmRows) html += Distributions(all, "arm");
  html += FleetFigure(all, fleet);
  if (fleet.is_small) {
    html += HtmlNote(
        Count(static_cast<std::int64_t>(fleet.arms.size()), "arm") +
        ": too few for statistics. Scores show only which is farthest from the "
        "others, and a difference of less than a third of the median error "
        "never makes an outlier.");
  }
  return html + FleetTable(all, fleet).ToHtml() +
         HtmlNote(
             "z is the distance from the median arm in robust standard "
             "deviations. An arm with one of its three above " +
             threshold + " is an outlier.") +
         ScoreFigure(all, fleet);
}

std::string TimeView(const ComparedItems& all, const DriftSummary& drift) {
  return HtmlPair({ChangeFigure(all, drift), AccuracyOverTime(all)}) +
         HtmlNote(
             "Only parameters of the joints that are estimated in both results "
             "are compared; base and tool move with the instrument and the "
             "target.") +
         ChangeTable(all, drift).ToHtml();
}

std::string MethodsView(const ComparedItems& all,
                        const MethodSummary& methods) {
  if (methods.are_runs()) {
    std::vector<std::size_t> largest(methods.ranking.rbegin(),
                                     methods.ranking.rend());
    largest.resize(std::min(largest.size(), kMostRunRows));
    return Distributions(all, "run") +
           MethodTable(all, "The runs with the largest errors", largest)
               .ToHtml();
  }
  std::vector<std::size_t> places(all.items.size());
  std::iota(places.begin(), places.end(), std::size_t{0});
  RowChart chart{"Error after calibration by each method, mean to largest", "",
                 LogarithmicAxis("position error [mm]")};
  chart.looks = {Markers("", MarkerStyle::kDot, "s1")};
  for (const std::size_t place : methods.ranking) {
    if (chart.rows.size() == kMostArms) break;
    const ComparedResult& result = all.values[place];
    chart.rows.push_back({result.label, {MeanToLargest(result, 0)}, false});
  }
  return HtmlFigure("methods-figure", chart) +
         MethodTable(all, "Every method, side by side", places).ToHtml();
}

}  // namespace alidade::internal
