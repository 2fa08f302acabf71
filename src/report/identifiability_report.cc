#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "alidade/units.h"
#include "src/common/format.h"
#include "src/common/text.h"
#include "src/report/figures.h"
#include "src/report/report.h"
#include "src/report/result_tables.h"
#include "src/report/svg_chart.h"

namespace alidade::internal {

namespace {

// The kind of a parameter is in its name: "beta1" and "base_rx" are angles,
// "d2" and "tool_x" are lengths.
bool IsAngleName(const std::string& name) {
  return name.rfind("beta", 0) == 0 || name.rfind("alpha", 0) == 0 ||
         name.rfind("theta", 0) == 0 || name.find("_r") != std::string::npos;
}

// Decisions that read the same are one row.
struct DecisionGroup {
  std::vector<std::string> names;
  ParameterDecision decision;
};

// Parameters with a predicted deviation of their own are a row each.
bool ReadTheSame(const ParameterDecision& a, const ParameterDecision& b) {
  return a.state == b.state && a.reason == b.reason &&
         a.identified_combination == b.identified_combination &&
         std::isnan(a.predicted_std) && std::isnan(b.predicted_std);
}

std::string FormatDeviation(const ParameterDecision& decision) {
  if (std::isnan(decision.predicted_std)) return "";
  if (std::isinf(decision.predicted_std)) return "unidentifiable";
  const bool angle = IsAngleName(decision.name);
  return FormatSignificant(
             decision.predicted_std / (angle ? kMilliradian : kMillimetre), 2) +
         (angle ? " mrad" : " mm");
}

std::vector<DecisionGroup> GroupDecisions(
    const std::vector<ParameterDecision>& decisions) {
  std::vector<DecisionGroup> groups;
  for (const ParameterState state :
       {ParameterState::kFree, ParameterState::kFixed,
        ParameterState::kGiven}) {
    for (const ParameterDecision& decision : decisions) {
      if (decision.state != state) continue;
      const auto group = std::find_if(
          groups.begin(), groups.end(), [&decision](const DecisionGroup& g) {
            return ReadTheSame(g.decision, decision);
          });
      if (group == groups.end()) {
        groups.push_back({{decision.name}, decision});
      } else {
        group->names.push_back(decision.name);
      }
    }
  }
  return groups;
}

std::int64_t CountState(const IdentifiabilityResult& result,
                        ParameterState state) {
  return std::count_if(result.decisions.begin(), result.decisions.end(),
                       [state](const ParameterDecision& decision) {
                         return decision.state == state;
                       });
}

std::string DecisionTable(const IdentifiabilityResult& result) {
  using Column = Table::Column;
  Table table({Column("parameter").Wrapped(20), "state",
               Column("why").Wrapped(38),
               Column("identified combination").Wrapped(16), ">predicted std"});
  for (const DecisionGroup& group : GroupDecisions(result.decisions)) {
    table.AddRow({Join(group.names, " "), StateForPeople(group.decision.state),
                  group.decision.reason, group.decision.identified_combination,
                  FormatDeviation(group.decision)});
  }
  return table.ToText();
}

std::string FormatGap(const RankReport& report) {
  if (report.rank == report.singular_values.size()) return "full rank";
  if (std::isinf(report.gap)) return "exact";
  return FormatSignificant(report.gap, 2);
}

std::string Remarks(const IdentifiabilityResult& result) {
  std::string text;
  if (!result.weak.empty()) {
    text += Paragraph("Weakly identifiable at these poses: " +
                      Join(result.weak, " "));
  }
  for (const std::string& warning : result.warnings) {
    text += Paragraph("Warning: " + warning);
  }
  for (const std::string& advice : result.advice) {
    text += Paragraph("Advice: " + advice);
  }
  return text;
}

}  // namespace

Table RankTable(const IdentifiabilityResult& result) {
  Table table("ranks", "Numerical rank",
              {"rank of what, where, at which geometry", ">rank",
               ">gap|smallest singular value that counts over the "
               "largest that does not"});
  const auto add = [&table](const char* geometry, const RankReport& report) {
    table.AddRow({geometry,
                  {std::to_string(report.rank) + " of " +
                       std::to_string(report.singular_values.size()),
                   static_cast<double>(report.rank)},
                  {FormatGap(report), report.gap}});
  };
  if (result.structural_rank.rank > 0) {
    add("all candidates, generic poses, perturbed", result.structural_rank);
    add("all candidates, generic poses, nominal", result.generic_rank);
  }
  add("free ones, these poses, perturbed", result.perturbed_rank);
  add("free ones, these poses, nominal", result.nominal_rank);
  return table;
}

Table ObservabilityTable(const IdentifiabilityResult& result) {
  Table table(
      "observability", "Observability indices",
      {"observability", ">O1", ">O2", ">O3", ">O4", ">O5", ">condition"});
  if (result.num_free == 0 || result.scaled.condition == 0.0) return table;
  const auto add = [&table](const char* name,
                            const ObservabilityIndices& indices) {
    std::vector<TableCell> row = {name};
    for (const double value : {indices.o1, indices.o2, indices.o3, indices.o4,
                               indices.o5, indices.condition}) {
      row.push_back(NumberCell(value, 3));
    }
    table.AddRow(std::move(row));
  };
  add("columns as they are (m, m/rad)", result.unscaled);
  add("angles scaled by the reach", result.scaled);
  return table;
}

std::string FormatIdentifiability(const IdentifiabilityResult& result) {
  const std::int64_t free = CountState(result, ParameterState::kFree);
  const std::int64_t fixed = CountState(result, ParameterState::kFixed);
  std::string text = Paragraph(
      std::to_string(free) + " of " + Count(free + fixed, "parameter") +
      " are to be identified, " + std::to_string(fixed) +
      (fixed == 1 ? " is" : " are") + " held at the nominal value.");
  if (result.exceeds_rank) {
    text += Paragraph("More parameters are kept than can be distinguished: " +
                      result.refusal);
  }
  text += "\n" + DecisionTable(result) + "\n";
  text += Paragraph(
      "Numerical rank (gap: the smallest singular value that counts "
      "over the largest that does not; perturbed: small changes of the "
      "geometry, at which second-order effects count too):");
  text += RankTable(result).ToText();
  const Table indices = ObservabilityTable(result);
  if (!indices.empty()) text += "\n" + indices.ToText();
  const std::string remarks = Remarks(result);
  if (!remarks.empty()) text += "\n" + remarks;
  return text;
}

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
  MatrixChart chart{"Parameters that are linearly dependent on others",
                    "a row equals the sum of its columns, times the numbers"};
  for (const Relation& relation : relations) {
    for (const auto& [name, coefficient] : relation.terms) {
      if (std::find(chart.columns.begin(), chart.columns.end(), name) ==
          chart.columns.end()) {
        chart.columns.push_back(name);
      }
    }
  }
  for (const Relation& relation : relations) {
    MatrixRow row{relation.parameter,
                  std::vector<MatrixCell>(chart.columns.size()),
                  DescribeLevel(relation.level), true};
    for (const auto& term : relation.terms) {
      const auto column =
          std::find(chart.columns.begin(), chart.columns.end(), term.first);
      row.cells[column - chart.columns.begin()] = {
          FormatCoefficient(relation.parameter, term), ColourOf(relation.level),
          kTint};
    }
    chart.rows.push_back(std::move(row));
  }
  return chart;
}

}  // namespace

Figure SingularValuesFigure(const IdentifiabilityResult& result) {
  LineChart chart{"Singular values of the scaled Jacobian",
                  std::to_string(result.num_free) +
                      " free parameters; what lies at the rounding error "
                      "cannot be distinguished",
                  CountAxis("number"),
                  LogarithmicAxis("singular value / largest")};
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
