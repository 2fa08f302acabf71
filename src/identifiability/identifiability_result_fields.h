#ifndef ALIDADE_SRC_IDENTIFIABILITY_IDENTIFIABILITY_RESULT_FIELDS_H_
#define ALIDADE_SRC_IDENTIFIABILITY_IDENTIFIABILITY_RESULT_FIELDS_H_

#include <limits>

#include "alidade/identifiability_result.h"
#include "src/common/fields.h"

namespace alidade::internal {

template <>
inline constexpr std::array kWords<ParameterState> = {
    std::pair{ParameterState::kFree, "free"},
    std::pair{ParameterState::kFrozen, "frozen"},
    std::pair{ParameterState::kGiven, "given"},
};

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, RankReport>& report) {
  v.Field("rank", report.rank);
  v.Field("gap", report.gap, std::numeric_limits<double>::infinity());
  v.Field("singular_values", report.singular_values);
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, Relation>& relation) {
  v.Field("parameter", relation.parameter);
  v.Field("level", relation.level);
  v.Pairs("terms", relation.terms, "parameter", "coefficient");
  v.Field("text", relation.text);
  v.Field("verified", relation.verified);
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, ObservabilityIndices>& indices) {
  v.Field("o1", indices.o1);
  v.Field("o2", indices.o2);
  v.Field("o3", indices.o3);
  v.Field("o4", indices.o4);
  v.Field("o5", indices.o5);
  v.Field("condition", indices.condition,
          std::numeric_limits<double>::infinity());
}

/// All but the decisions, which stand beside the parameters that they are of.
template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, IdentifiabilityResult>& result) {
  v.Field("method", result.method);
  v.Field("policy", result.policy);
  v.Field("num_candidates", result.num_candidates);
  v.Field("generic_rank", result.generic_rank);
  v.Field("structural_rank", result.structural_rank);
  v.Field("relations", result.relations);
  v.Field("advice", result.advice);
  v.Group("observability", [&](auto& group) {
    group.Field("unscaled", result.unscaled);
    group.Field("scaled", result.scaled);
  });
  v.Field("num_free", result.num_free);
  v.Field("exceeds_rank", result.exceeds_rank);
  v.Field("refusal", result.refusal);
  v.Field("warnings", result.warnings);
  v.Field("weak", result.weak);
  v.Field("nominal_rank", result.nominal_rank);
  v.Field("perturbed_rank", result.perturbed_rank);
}

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_IDENTIFIABILITY_IDENTIFIABILITY_RESULT_FIELDS_H_
