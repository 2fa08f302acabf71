#ifndef ALIDADE_SRC_IDENTIFIABILITY_IDENTIFIABILITY_FIELDS_H_
#define ALIDADE_SRC_IDENTIFIABILITY_IDENTIFIABILITY_FIELDS_H_

#include <limits>

#include "alidade/identifiability.h"
#include "src/common/option_fields.h"

namespace alidade::internal {

template <>
inline constexpr std::array kWords<IdentifiabilityMethod> = {
    std::pair{IdentifiabilityMethod::kRules, "rules"},
    std::pair{IdentifiabilityMethod::kRank, "rank"},
};

/// What is chosen where nothing is said has no word.
template <>
inline constexpr std::array kWords<WeakPolicy> = {
    std::pair{WeakPolicy::kFreeze, "freeze"},
    std::pair{WeakPolicy::kPrior, "prior"},
    std::pair{WeakPolicy::kKeep, "keep"},
};

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, PriorTolerances>& priors) {
  v.Field(AngleKey("beta").Above(0), priors.beta, "of joints");
  v.Field(AngleKey("alpha").Above(0), priors.alpha, "of joints");
  v.Field(LengthKey("d").Above(0), priors.d, "of joints");
  v.Field(AngleKey("theta").Above(0), priors.theta, "of joints");
  v.Field(LengthKey("r").Above(0), priors.r, "of joints");
  v.Field(LengthKey("frame_length").Above(0), priors.frame_length,
          "of base and targets, and of references that are not known: points "
          "and offsets of planes. By default 50 mm once they are fitted at the "
          "nominal geometry");
  v.Field(AngleKey("frame_angle").Above(0), priors.frame_angle,
          "likewise (50 mrad), and of tilts of planes");
}

/// All but the names of parameters, which depend on the arm and on what was
/// measured.
template <typename Visitor>
void VisitFields(Visitor& v,
                 Subject<Visitor, IdentifiabilityOptions>& options) {
  v.Field(Key("method"), options.method,
          "`rank`: by ranks over generic poses and these; `rules`, as the "
          "published study: beta is fixed where alpha is not 0, columns of "
          "zero are fixed, of the r of parallel axes the first is kept. "
          "`rules` refuses references that are not known");
  v.Field(
      Key("policy").Default("`prior` (`rank`), `keep` (`rules`)"),
      options.policy,
      "what is done with parameters that these poses determine badly: `prior` "
      "frees them with a Gaussian prior, `freeze` (only `rank`) holds "
      "them, `keep` frees them");
  v.Section(Key("priors"),
            "what is known a priori: standard deviations about the nominal "
            "values",
            options.priors);
  v.Field(Key("proceed_beyond_rank"), options.proceed_beyond_rank,
          "solve although more parameters are kept than can be distinguished");
  v.Field(AngleKey("angle_tolerance").Above(0).Below(0.1),
          options.angle_tolerance, "below it, an angle counts as zero");
  v.Field(Key("relative_tolerance").Above(0).Below(1),
          options.relative_tolerance,
          "below it times the largest one, a column or a singular value counts "
          "as zero");
  v.Field(Key("perturbation").Above(0).Below(0.5), options.perturbation,
          "size of the perturbed geometries: rad for angles, times the reach "
          "for lengths");
  v.Field(Key("seed"), options.seed, "of the generic poses");
}

template <>
inline constexpr std::array kWords<ParameterState> = {
    std::pair{ParameterState::kFree, "free"},
    std::pair{ParameterState::kFixed, "fixed"},
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

#endif  // ALIDADE_SRC_IDENTIFIABILITY_IDENTIFIABILITY_FIELDS_H_
