#include <algorithm>
#include <array>
#include <cstdio>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "alidade/units.h"
#include "src/report/chart_frame.h"
#include "src/report/parameter_names.h"
#include "src/report/report.h"
#include "src/report/svg_chart.h"
#include "src/report/svg_writer.h"

namespace alidade::internal {
namespace {

// Zero cannot stand on a logarithmic axis: it is drawn at the rounding error.
constexpr double kFloor = 1e-17;

ChartSeries SpectrumOf(const RankReport& report, const std::string& label,
                       MarkerStyle marker) {
  ChartSeries series;
  series.label = label + ": rank " + std::to_string(report.rank);
  series.marker = marker;
  for (Eigen::Index i = 0; i < report.singular_values.size(); ++i) {
    series.x.push_back(static_cast<double>(i + 1));
    series.y.push_back(std::max(kFloor, report.singular_values[i]));
  }
  return series;
}

std::string SingularValuesChart(const IdentifiabilityResult& result) {
  LineChart chart;
  chart.title = "Singular values of the scaled Jacobian";
  chart.subtitle = std::to_string(result.num_free) +
                   " free parameters; what lies at the rounding error cannot "
                   "be told apart";
  chart.x.label = "number";
  chart.x.integer_ticks = true;
  chart.y.label = "singular value / largest";
  chart.y.logarithmic = true;
  if (result.generic_rank.rank > 0) {
    chart.series.push_back(SpectrumOf(result.structural_rank,
                                      "generic poses, perturbed geometry",
                                      MarkerStyle::kDot));
    chart.series.push_back(SpectrumOf(result.generic_rank,
                                      "generic poses, nominal geometry",
                                      MarkerStyle::kSquare));
  }
  chart.series.push_back(SpectrumOf(
      result.nominal_rank, "free ones, these poses", MarkerStyle::kTriangle));
  return RenderSvg(chart);
}

// The relations as a matrix: a row for each parameter that is left out, a
// column for each that stands for one.
class RelationMatrix {
 public:
  explicit RelationMatrix(const IdentifiabilityResult& result)
      : relations_(result.relations) {
    for (const Relation& relation : relations_) {
      for (const auto& [name, coefficient] : relation.terms) {
        if (std::find(columns_.begin(), columns_.end(), name) ==
            columns_.end()) {
          columns_.push_back(name);
        }
      }
    }
  }

  std::string Render() const {
    const double width =
        std::max(kChartWidth, kLeft + kCellWidth * NumColumns() + kRight);
    const double height = kTop +
                          kCellHeight * static_cast<double>(relations_.size()) +
                          2.0 * kChartMargin;
    const std::string title = "Parameters that act as combinations of others";
    SvgWriter svg({width, height}, title,
                  "Each row is a parameter and acts as the sum of the columns, "
                  "each times its coefficient.");
    const double below = DrawHeader(
        &svg, title, "a row acts as the sum of its columns, times the numbers");
    DrawColumnNames(below, &svg);
    for (std::size_t row = 0; row < relations_.size(); ++row) {
      DrawRow(relations_[row], kTop + kCellHeight * static_cast<double>(row),
              &svg);
    }
    return svg.Finish();
  }

 private:
  static constexpr double kLeft = 100.0;
  static constexpr double kTop = 124.0;
  static constexpr double kRight = 150.0;
  static constexpr double kCellWidth = 88.0;
  static constexpr double kCellHeight = 30.0;

  double NumColumns() const { return static_cast<double>(columns_.size()); }

  SvgPoint Centre(std::size_t column, double top) const {
    return {kLeft + kCellWidth * (static_cast<double>(column) + 0.5),
            top + 0.68 * kCellHeight};
  }

  void DrawColumnNames(double below, SvgWriter* svg) const {
    SvgText style;
    style.anchor = SvgText::Anchor::kMiddle;
    style.bold = true;
    for (std::size_t column = 0; column < columns_.size(); ++column) {
      SvgPoint place = Centre(column, kTop - kCellHeight);
      place.y = std::max(place.y, below);
      svg->Text(place, columns_[column], style);
    }
  }

  void DrawRow(const Relation& relation, double top, SvgWriter* svg) const {
    SvgText name;
    name.anchor = SvgText::Anchor::kEnd;
    name.bold = true;
    svg->Text({kLeft - 12.0, top + 0.68 * kCellHeight}, relation.parameter,
              name);
    for (std::size_t column = 0; column < columns_.size(); ++column) {
      DrawCell(relation, column, top, svg);
    }
    SvgText level;
    level.colour = kTextColour;
    svg->Text(
        {kLeft + kCellWidth * NumColumns() + 12.0, top + 0.68 * kCellHeight},
        DescribeLevel(relation.level), level);
  }

  void DrawCell(const Relation& relation, std::size_t column, double top,
                SvgWriter* svg) const {
    const double left = kLeft + kCellWidth * static_cast<double>(column);
    const auto term = std::find_if(
        relation.terms.begin(), relation.terms.end(),
        [&](const auto& t) { return t.first == columns_[column]; });
    const bool filled = term != relation.terms.end();
    svg->Box({left + 1.0, top + 1.0, kCellWidth - 2.0, kCellHeight - 2.0},
             filled ? ColourOf(relation.level) : kMinorGridColour);
    if (!filled) return;
    SvgText style;
    style.anchor = SvgText::Anchor::kMiddle;
    svg->Text(Centre(column, top), FormatCoefficient(relation.parameter, *term),
              style);
  }

  // Light tints that dark text reads on; the words beside them say the same.
  static std::string_view ColourOf(const std::string& level) {
    if (level == "at_geometry") return "#fbdcb5";
    if (level == "not_excited") return "#f6cfe2";
    return "#c7e0f2";
  }

  static std::string DescribeLevel(const std::string& level) {
    if (level == "no_effect") return "no effect at all";
    if (level == "at_geometry") return "at this geometry";
    if (level == "not_excited") return "over these poses";
    return "whatever the pose";
  }

  static std::string FormatCoefficient(
      const std::string& parameter,
      const std::pair<std::string, double>& term) {
    const bool from_angle = IsAngleName(parameter);
    const bool to_angle = IsAngleName(term.first);
    if (from_angle == to_angle) return Compact(term.second);
    if (from_angle) return Compact(term.second / kMillimetre) + " mm";
    return Compact(term.second * kMillimetre) + " /mm";
  }

  // Four digits, without zeros behind them: relations are often whole.
  static std::string Compact(double value) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.4g", value);
    return text.data();
  }

  const std::vector<Relation>& relations_;
  std::vector<std::string> columns_;
};

}  // namespace

std::vector<ReportFile> MakeIdentifiabilityFigures(
    const IdentifiabilityResult& result) {
  std::vector<ReportFile> files = {
      {"singular_values.svg", SingularValuesChart(result)}};
  if (!result.relations.empty()) {
    files.emplace_back("relations.svg", RelationMatrix(result).Render());
  }
  return files;
}

}  // namespace alidade::internal
