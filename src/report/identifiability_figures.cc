#include <algorithm>
#include <array>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "alidade/units.h"
#include "src/common/format.h"
#include "src/report/figures.h"
#include "src/report/parameter_names.h"
#include "src/report/report.h"
#include "src/report/svg_chart.h"

namespace alidade::internal {
namespace {

// Zero cannot stand on a logarithmic axis: it is drawn at the rounding error.
constexpr double kFloor = 1e-17;

// Those that count, or those that do not.
ChartSeries SpectrumOf(const RankReport& report, const std::string& label,
                       MarkerStyle marker, bool is_counted) {
  ChartSeries series;
  series.label = label;
  series.marker = marker;
  series.line = is_counted;
  const Eigen::VectorXd& values = report.singular_values;
  for (Eigen::Index i = is_counted ? 0 : report.rank;
       i < (is_counted ? report.rank : values.size()); ++i) {
    series.x.push_back(static_cast<double>(i + 1));
    series.y.push_back(std::max(kFloor, values[i]));
  }
  series.tip = [x = series.x, y = series.y, n = values.size()](std::size_t i) {
    return std::to_string(static_cast<int>(x[i])) + " of " + std::to_string(n) +
           ": " + FormatSignificant(y[i], 3);
  };
  return series;
}

std::string DescribeLevel(const std::string& level) {
  if (level == "no_effect") return "no effect at all";
  if (level == "at_geometry") return "at this geometry";
  if (level == "not_excited") return "over these poses";
  return "at all poses";
}

std::string ColourOf(const std::string& level) {
  if (level == "at_geometry") return "s5";
  if (level == "not_excited") return "s4";
  return "s1";
}

// Four digits, without zeros behind them: relations are often whole.
std::string Compact(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.4g", value);
  return text.data();
}

std::string FormatCoefficient(const std::string& parameter,
                              const std::pair<std::string, double>& term) {
  const bool from_angle = IsAngleName(parameter);
  if (from_angle == IsAngleName(term.first)) return Compact(term.second);
  if (from_angle) return Compact(term.second / kMillimetre) + " mm";
  return Compact(term.second * kMillimetre) + " /mm";
}

// The relations as a matrix: a row for each parameter that is left out, a
// column for each parameter that it depends on.
MatrixChart RelationChart(const std::vector<Relation>& relations) {
  // Light tints that dark text reads on; the words beside them say the same.
  constexpr double kTint = 0.25;
  MatrixChart chart;
  chart.title = "Parameters that are linearly dependent on others";
  chart.subtitle = "a row equals the sum of its columns, times the numbers";
  for (const Relation& relation : relations) {
    for (const auto& [name, coefficient] : relation.terms) {
      if (std::find(chart.columns.begin(), chart.columns.end(), name) ==
          chart.columns.end()) {
        chart.columns.push_back(name);
      }
    }
  }
  for (const Relation& relation : relations) {
    MatrixRow row;
    row.label = relation.parameter;
    row.is_emphasised = true;
    row.note = DescribeLevel(relation.level);
    row.cells.resize(chart.columns.size());
    for (const auto& term : relation.terms) {
      const auto column =
          std::find(chart.columns.begin(), chart.columns.end(), term.first);
      MatrixCell& cell = row.cells[column - chart.columns.begin()];
      cell.text = FormatCoefficient(relation.parameter, term);
      cell.colour = ColourOf(relation.level);
      cell.opacity = kTint;
    }
    chart.rows.push_back(std::move(row));
  }
  return chart;
}

}  // namespace

Figure SingularValuesFigure(const IdentifiabilityResult& result) {
  LineChart chart;
  chart.title = "Singular values of the scaled Jacobian";
  chart.subtitle = std::to_string(result.num_free) +
                   " free parameters; what lies at the rounding error cannot "
                   "be distinguished";
  chart.x.label = "number";
  chart.x.integer_ticks = true;
  chart.y.label = "singular value / largest";
  chart.y.logarithmic = true;
  struct Spectrum {
    const RankReport& report;
    std::string what;
    MarkerStyle marker;
  };
  std::vector<Spectrum> spectra;
  if (result.generic_rank.rank > 0) {
    spectra.push_back({result.structural_rank,
                       "generic poses, perturbed geometry", MarkerStyle::kDot});
    spectra.push_back({result.generic_rank, "generic poses, nominal geometry",
                       MarkerStyle::kSquare});
  }
  spectra.push_back(
      {result.nominal_rank, "free ones, these poses", MarkerStyle::kTriangle});
  for (const auto& [report, what, marker] : spectra) {
    chart.series.push_back(SpectrumOf(
        report, what + ": rank " + std::to_string(report.rank), marker, true));
  }
  // The same markers in black.
  std::string label = "unidentifiable";
  for (const auto& [report, what, marker] : spectra) {
    if (report.rank >= report.singular_values.size()) continue;
    chart.series.push_back(
        SpectrumOf(report, std::exchange(label, ""), marker, false));
    chart.series.back().colour = "s7";
  }
  return chart;
}

std::vector<ReportFile> MakeIdentifiabilityFigures(
    const IdentifiabilityResult& result) {
  std::vector<ReportFile> files = {
      {"singular_values.svg",
       SingularValuesFigure(result).render(FigureMedium::kFile)}};
  if (!result.relations.empty()) {
    files.emplace_back("relations.svg",
                       RenderSvg(RelationChart(result.relations)));
  }
  return files;
}

}  // namespace alidade::internal
