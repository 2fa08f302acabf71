#include "src/report/identifiability_report.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "src/common/format.h"
#include "src/common/text.h"
#include "src/common/text_table.h"
#include "src/report/parameter_names.h"
#include "src/report/report.h"

namespace alidade::internal {
namespace {

using Align = TextTable::Align;

constexpr int kNamesWidth = 20;
constexpr int kReasonWidth = 38;
constexpr int kCombinationWidth = 16;

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
  TextTable table({{"parameter"},
                   {"state"},
                   {"why"},
                   {"identified combination"},
                   {"predicted std", Align::kRight}});
  for (const DecisionGroup& group : GroupDecisions(result.decisions)) {
    AddWrappedRow({Join(group.names, " "), ToString(group.decision.state),
                   group.decision.reason, group.decision.identified_combination,
                   FormatDeviation(group.decision)},
                  {kNamesWidth, 0, kReasonWidth, kCombinationWidth, 0}, &table);
  }
  return table.ToString();
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

}  // namespace alidade::internal
