#include "src/identifiability/analysis.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "src/identifiability/data_analysis.h"
#include "src/identifiability/elimination.h"
#include "src/identifiability/factor.h"
#include "src/identifiability/observability.h"
#include "src/identifiability/rank.h"
#include "src/identifiability/rules.h"

namespace alidade::internal {
namespace {

const char* NameOf(WeakPolicy policy) {
  switch (policy) {
    case WeakPolicy::kFreeze:
      return "freeze";
    case WeakPolicy::kPrior:
      return "prior";
    case WeakPolicy::kKeep:
    case WeakPolicy::kAutomatic:
      break;
  }
  return "keep";
}

WeakPolicy PolicyUsed(const IdentifiabilityOptions& options) {
  if (options.policy != WeakPolicy::kAutomatic) return options.policy;
  return options.method == IdentifiabilityMethod::kRules ? WeakPolicy::kKeep
                                                         : WeakPolicy::kPrior;
}

bool Contains(const std::vector<int>& columns, int column) {
  return std::find(columns.begin(), columns.end(), column) != columns.end();
}

class RankMethod {
 public:
  RankMethod(const MeasurementModel& model, const Dataset& data,
             const IdentifiabilityOptions& options)
      : model_(model),
        layout_(model.layout()),
        data_(data),
        options_(options),
        policy_(PolicyUsed(options)),
        forced_(ColumnsOf(options.free)) {
    result_.method = "rank";
    result_.decisions.resize(layout_.size());
    for (int c = 0; c < layout_.size(); ++c) {
      result_.decisions[c].name = layout_.parameter(c).name;
    }
  }

  IdentifiabilityResult Run() {
    const std::vector<int> candidates = ListCandidates();
    result_.num_candidates = static_cast<int>(candidates.size());
    const GenericAnalysis generic =
        AnalyzeGeneric(model_, candidates, data_, options_);
    result_.generic_rank = generic.generic_rank;
    result_.structural_rank = generic.structural_rank;
    result_.relations = generic.relations;
    FreezeStructural(generic);
    const DataAnalysis data =
        AnalyzeData(model_, data_, generic.kept, generic.weak, options_);
    for (const Relation& relation : data.relations) {
      result_.relations.push_back(relation);
    }
    result_.advice = data.advice;
    DecideWeak(generic, data);
    DecideImpractical(generic, data);
    CheckForced(generic);
    NameCombinations();
    WarnAboutLevels(generic, data);
    return std::move(result_);
  }

 private:
  std::vector<int> ColumnsOf(const std::vector<std::string>& names) const {
    std::vector<int> columns;
    for (const std::string& name : names) {
      columns.push_back(*layout_.Find(name));
    }
    return columns;
  }

  ParameterDecision& decision(int column) { return result_.decisions[column]; }

  bool IsCandidate(const Parameter& parameter) const {
    if (IsKnownReference(parameter)) return false;
    switch (parameter.kind) {
      case ParameterKind::kBaseTranslation:
      case ParameterKind::kBaseRotation:
        return options_.candidates.base;
      case ParameterKind::kToolTranslation:
      case ParameterKind::kToolRotation:
        return options_.candidates.tool;
      case ParameterKind::kPoint:
      case ParameterKind::kPlaneTilt:
      case ParameterKind::kPlaneOffset:
        return true;
      default:
        return options_.candidates.joints;
    }
  }

  bool IsKnownReference(const Parameter& parameter) const {
    const References& references = model_.references();
    switch (parameter.kind) {
      case ParameterKind::kPoint:
        return references.points[parameter.object].is_known;
      case ParameterKind::kPlaneTilt:
      case ParameterKind::kPlaneOffset:
        return references.planes[parameter.object].is_known;
      default:
        return false;
    }
  }

  // In the order of preference: what the user wants free, what the user
  // prefers, then the canonical order.
  std::vector<int> ListCandidates() {
    const std::vector<int> fixed = ColumnsOf(options_.fix);
    std::vector<int> all;
    for (int c = 0; c < layout_.size(); ++c) {
      if (!IsCandidate(layout_.parameter(c)) && !Contains(forced_, c)) {
        decision(c).state = ParameterState::kGiven;
        decision(c).reason = "given, not to be identified";
      } else if (Contains(fixed, c)) {
        Freeze(c, "fixed_by_user", "fixed by the user");
      } else {
        all.push_back(c);
      }
    }
    std::vector<int> order = forced_;
    for (const int c : ColumnsOf(options_.prefer)) order.push_back(c);
    for (const int c : InCanonicalOrder(layout_, all)) order.push_back(c);
    std::vector<int> unique;
    for (const int c : order) {
      if (Contains(all, c) && !Contains(unique, c)) unique.push_back(c);
    }
    return unique;
  }

  void Freeze(int column, const std::string& rule, const std::string& reason) {
    decision(column).state = ParameterState::kFixed;
    decision(column).rule = rule;
    decision(column).reason = reason;
  }

  void FreezeStructural(const GenericAnalysis& generic) {
    for (const Relation& relation : generic.relations) {
      if (relation.level == "at_geometry") continue;
      const bool no_effect = relation.terms.empty();
      Freeze(*layout_.Find(relation.parameter), relation.level,
             no_effect ? MoveName() + " moves with it"
                       : relation.text + " at all poses");
    }
  }

  std::string MoveName() const {
    const bool positions_only =
        data_.blocks.size() == 1 && data_.Has(MeasurementKind::kPosition);
    return positions_only ? "no measured position" : "nothing that is measured";
  }

  // Weak at the geometry or not excited: the policy decides.
  void DecideWeak(const GenericAnalysis& generic, const DataAnalysis& data) {
    for (const Relation& relation : generic.relations) {
      if (relation.level != "at_geometry") continue;
      MarkWeak(relation, relation.text + " at this geometry");
    }
    for (const Relation& relation : data.relations) {
      MarkWeak(relation, relation.text + " over these poses");
    }
  }

  void MarkWeak(const Relation& relation, const std::string& reason) {
    const int column = *layout_.Find(relation.parameter);
    result_.weak.push_back(relation.parameter);
    if (policy_ == WeakPolicy::kFreeze && !Contains(forced_, column)) {
      Freeze(column, relation.level, reason);
    } else {
      decision(column).rule = relation.level;
      decision(column).reason = reason;
    }
  }

  std::vector<int> Free() const { return FreeColumns(result_); }

  // What is below the noise level, the worst first: fixing one helps the
  // others.
  void DecideImpractical(const GenericAnalysis& generic,
                         const DataAnalysis& data) {
    std::vector<int> kept;
    for (const int c : generic.kept) {
      if (decision(c).rule.empty()) kept.push_back(c);
    }
    while (!kept.empty()) {
      const Eigen::VectorXd deviations = data.Deviations(kept);
      int worst = -1;
      double worst_ratio = 1.0;
      for (std::size_t k = 0; k < kept.size(); ++k) {
        const double known =
            options_.priors.Of(layout_.parameter(kept[k]).kind);
        const double ratio = deviations[static_cast<Eigen::Index>(k)] / known;
        if (ratio > worst_ratio) {
          worst = static_cast<int>(k);
          worst_ratio = ratio;
        }
      }
      if (worst < 0) return;
      MarkImpractical(kept[worst], deviations[worst]);
      kept.erase(kept.begin() + worst);
    }
  }

  void MarkImpractical(int column, double deviation) {
    const Parameter& parameter = layout_.parameter(column);
    const double known = options_.priors.Of(parameter.kind);
    const std::string reason =
        "the noise leaves " + FormatDeviation(deviation, parameter.dimension) +
        ", known a priori to " + FormatDeviation(known, parameter.dimension);
    result_.weak.push_back(parameter.name);
    if (policy_ == WeakPolicy::kFreeze && !Contains(forced_, column)) {
      Freeze(column, "not_practical", reason);
    } else {
      decision(column).rule = "not_practical";
      decision(column).reason = reason;
    }
  }

  void CheckForced(const GenericAnalysis& generic) {
    for (const Relation& relation : generic.relations) {
      const int column = *layout_.Find(relation.parameter);
      if (!Contains(forced_, column) || relation.level == "at_geometry") {
        continue;
      }
      result_.exceeds_rank = true;
      result_.refusal =
          relation.parameter +
          " is to be free, but cannot be identified: " + relation.text +
          " at all poses. Take it out of `free`, or one "
          "of those it is linearly dependent on";
    }
  }

  void NameCombinations() {
    for (const Relation& relation : result_.relations) {
      const int column = *layout_.Find(relation.parameter);
      if (decision(column).state != ParameterState::kFixed) continue;
      for (const auto& [name, coefficient] : relation.terms) {
        const int kept = *layout_.Find(name);
        std::string& identified_combination =
            decision(kept).identified_combination;
        if (identified_combination.empty()) identified_combination = name;
        identified_combination = AppendTerm(
            identified_combination,
            FormatTerm(layout_, {coefficient, column, kept, column}));
      }
    }
  }

  void WarnAboutLevels(const GenericAnalysis& generic,
                       const DataAnalysis& data) {
    if (result_.weak.empty()) return;
    std::string relations;
    for (const std::vector<Relation>* list :
         {&generic.relations, &data.relations}) {
      for (const Relation& relation : *list) {
        if (relation.level != "at_geometry" &&
            relation.level != "not_excited") {
          continue;
        }
        relations += (relations.empty() ? "" : "; ") + relation.text;
      }
    }
    if (relations.empty()) return;
    std::string text =
        "these poses determine only " + std::to_string(data.rank.rank) +
        " of " + std::to_string(result_.structural_rank.rank) +
        " parameters at the nominal geometry (" + relations + ")";
    if (!data.second_order.empty()) text += "; " + data.second_order;
    result_.warnings.push_back(text);
  }

  const MeasurementModel& model_;
  const ParameterLayout& layout_;
  const Dataset& data_;
  const IdentifiabilityOptions& options_;
  const WeakPolicy policy_;
  const std::vector<int> forced_;
  IdentifiabilityResult result_;
};

// What is known a priori of each free parameter: of itself, and of the fixed
// ones in its identified combination, each with what a step of it makes of this
// one.
Eigen::VectorXd CombinationPriors(const MeasurementModel& model,
                                  const IdentifiabilityOptions& options,
                                  const IdentifiabilityResult& result) {
  const ParameterLayout& layout = model.layout();
  Eigen::VectorXd variances =
      options.priors.Deviations(layout).array().square();
  const Eigen::VectorXd own = variances;
  for (const Relation& relation : result.relations) {
    const int fixed = *layout.Find(relation.parameter);
    if (result.decisions[fixed].state != ParameterState::kFixed) continue;
    for (const auto& [name, coefficient] : relation.terms) {
      variances[*layout.Find(name)] += coefficient * coefficient * own[fixed];
    }
  }
  return variances.cwiseSqrt();
}

// What both methods share, once it is decided which parameters are free.
void Finish(const MeasurementModel& model, const Dataset& data,
            const IdentifiabilityOptions& options,
            IdentifiabilityResult* result) {
  const WeakPolicy policy = PolicyUsed(options);
  const std::vector<int> free = FreeColumns(*result);
  result->policy = NameOf(policy);
  result->num_free = static_cast<int>(free.size());
  if (free.empty()) return;
  FreeAnalysis analysis = AnalyzeFree(model, data, free, options);
  analysis.priors = CombinationPriors(model, options, *result)(free);
  result->nominal_rank = analysis.rank;
  result->unscaled = analysis.unscaled;
  result->scaled = analysis.scaled;
  const bool with_priors = policy == WeakPolicy::kPrior;
  const Eigen::VectorXd deviations = analysis.Deviations(with_priors);
  for (std::size_t k = 0; k < free.size(); ++k) {
    ParameterDecision& decision = result->decisions[free[k]];
    decision.predicted_std = deviations[static_cast<Eigen::Index>(k)];
    if (with_priors) {
      decision.prior_std = analysis.priors[static_cast<Eigen::Index>(k)];
    }
  }
  WarnAboutFree(model, data, analysis, result);
  if (policy == WeakPolicy::kKeep && !result->exceeds_rank &&
      analysis.perturbed_rank.rank < result->num_free) {
    result->exceeds_rank = true;
    result->refusal =
        std::to_string(result->num_free) + " parameters are kept, but these " +
        "poses determine only " + std::to_string(analysis.perturbed_rank.rank) +
        ", whatever the geometry: measure more varied poses, or use the "
        "policy prior or freeze";
  }
  if (result->method == "rank") {
    result->perturbed_rank = analysis.perturbed_rank;
  }
}

}  // namespace

IdentifiabilityResult AnalyzeIdentifiability(
    const MeasurementModel& model, const Dataset& data,
    const IdentifiabilityOptions& options) {
  IdentifiabilityResult result = options.method == IdentifiabilityMethod::kRules
                                     ? ApplyRules(model, data, options)
                                     : RankMethod(model, data, options).Run();
  Finish(model, data, options, &result);
  return result;
}

Eigen::VectorXd PriorsOf(const IdentifiabilityResult& result) {
  if (result.policy != "prior") return {};
  Eigen::VectorXd priors(static_cast<Eigen::Index>(result.decisions.size()));
  for (Eigen::Index c = 0; c < priors.size(); ++c) {
    priors[c] = result.decisions[c].prior_std;
  }
  return priors;
}

}  // namespace alidade::internal
