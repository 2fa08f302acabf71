#include "src/identifiability/rules.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "src/identifiability/factor.h"
#include "src/identifiability/perturbation.h"
#include "src/identifiability/rank.h"

namespace alidade::internal {
namespace {

// Perturbed geometries looked at for the rank: the largest rank counts, since a
// draw can only lose rank by chance, never gain it.
constexpr int kPerturbedArms = 3;

class Pass {
 public:
  Pass(const MeasurementModel& model, const Dataset& data,
       const IdentifiabilityOptions& options)
      : model_(model), layout_(model.layout()), data_(data), options_(options) {
    result_.method = "rules";
    for (const Parameter& parameter : layout_.parameters()) {
      ParameterDecision decision;
      decision.name = parameter.name;
      if (!ParameterLayout::IsJointKind(parameter.kind)) {
        decision.state = ParameterState::kGiven;
        decision.reason = "base and tool are given, not identified";
      }
      result_.decisions.push_back(decision);
    }
  }

  IdentifiabilityResult Run() {
    ApplyBetaRule();
    ApplyZeroColumnRule();
    ApplyParallelRule();
    ApplyUserChoice();
    result_.num_free = static_cast<int>(FreeColumns(result_).size());
    CompareWithRanks();
    return std::move(result_);
  }

 private:
  const Joint& joint(int j) const { return model_.nominal().joints[j]; }

  bool IsParallelToPrevious(int j) const {
    return std::abs(std::sin(joint(j).alpha)) <= options_.angle_tolerance &&
           std::abs(std::sin(joint(j).beta)) <= options_.angle_tolerance;
  }

  // The first rule that applies decides; what a later one would add is put
  // after it.
  void Freeze(int column, const std::string& rule, const std::string& reason) {
    ParameterDecision& decision = result_.decisions[column];
    if (decision.state == ParameterState::kGiven) return;
    if (decision.state == ParameterState::kFixed) {
      decision.reason += "; " + reason;
      return;
    }
    decision.state = ParameterState::kFixed;
    decision.rule = rule;
    decision.reason = reason;
  }

  void ApplyBetaRule() {
    for (int j = 0; j < layout_.num_joints(); ++j) {
      if (std::abs(std::sin(joint(j).alpha)) <= options_.angle_tolerance) {
        continue;
      }
      const std::string number = std::to_string(j + 1);
      Freeze(layout_.Column(ParameterKind::kBeta, j), "beta_rule",
             "axis " + number + " is not parallel to axis " +
                 std::to_string(j) + " (sin alpha" + number +
                 " is not 0), where beta is not needed");
    }
  }

  void ApplyZeroColumnRule() {
    std::vector<int> columns;
    for (int c = 0; c < layout_.size(); ++c) {
      if (result_.decisions[c].state != ParameterState::kGiven) {
        columns.push_back(c);
      }
    }
    const Eigen::MatrixXd factor =
        ScaledFactor(model_, model_.NominalValues(), data_, columns);
    const Eigen::VectorXd norms = factor.colwise().norm();
    const double zero = options_.relative_tolerance * norms.maxCoeff();
    for (std::size_t k = 0; k < columns.size(); ++k) {
      if (norms[static_cast<Eigen::Index>(k)] > zero) continue;
      Freeze(columns[k], "zero_column",
             "its column is zero: no measured position moves with it");
    }
  }

  void ApplyParallelRule() {
    for (int j = 1; j < layout_.num_joints(); ++j) {
      if (!IsParallelToPrevious(j)) continue;
      int first = j;
      double sign = 1.0;
      while (first > 0 && IsParallelToPrevious(first)) {
        sign *= std::cos(joint(first).alpha) * std::cos(joint(first).beta);
        --first;
      }
      const int kept = layout_.Column(ParameterKind::kR, first);
      const int column = layout_.Column(ParameterKind::kR, j);
      const std::string& name = layout_.parameter(column).name;
      const std::string& kept_name = layout_.parameter(kept).name;
      Freeze(column, "parallel_r",
             "axis " + std::to_string(j + 1) + " is parallel to axis " +
                 std::to_string(first + 1) + ": " + name +
                 " moves the target as " + kept_name + " does");
      std::string& identified_combination =
          result_.decisions[kept].identified_combination;
      if (identified_combination.empty()) identified_combination = kept_name;
      identified_combination += (sign > 0.0 ? " + " : " - ") + name;
    }
  }

  void ApplyUserChoice() {
    for (const std::string& name : options_.fix) {
      Freeze(layout_.Find(name).value(), "fixed_by_user", "fixed by the user");
    }
  }

  // The factor at the perturbed geometry of largest rank, columns in canonical
  // order.
  Eigen::MatrixXd FindPerturbedRank(const std::vector<int>& free) {
    const std::vector<int> order = InCanonicalOrder(layout_, free);
    Eigen::MatrixXd best;
    for (int draw = 0; draw < kPerturbedArms; ++draw) {
      const Eigen::MatrixXd factor = ScaledFactor(
          model_, PerturbedValues(model_, options_, draw), data_, order);
      const RankReport report =
          AnalyzeRank(factor, options_.relative_tolerance);
      if (draw == 0 || report.rank > result_.perturbed_rank.rank) {
        result_.perturbed_rank = report;
        best = factor;
      }
    }
    return best;
  }

  void CompareWithRanks() {
    const std::vector<int> free = FreeColumns(result_);
    if (free.empty()) return;
    result_.nominal_rank =
        AnalyzeRank(ScaledFactor(model_, model_.NominalValues(), data_, free),
                    options_.relative_tolerance);
    const Eigen::MatrixXd perturbed = FindPerturbedRank(free);
    if (result_.perturbed_rank.rank < result_.num_free) {
      ReportExcess(free, perturbed);
    }
    if (result_.nominal_rank.rank < result_.num_free) {
      ReportWeak(FindDependencies(model_, model_.NominalValues(), data_, free,
                                  result_.nominal_rank.MiddleOfGap()));
    }
  }

  // The columns that do not raise the rank of those before them. Their names
  // alone: at a perturbed geometry the coefficients mean nothing to people.
  void ReportExcess(const std::vector<int>& free,
                    const Eigen::MatrixXd& factor) {
    const std::vector<int> order = InCanonicalOrder(layout_, free);
    result_.exceeds_rank = true;
    std::string names;
    std::vector<int> independent;
    for (std::size_t k = 0; k < order.size(); ++k) {
      independent.push_back(static_cast<int>(k));
      const int rank = AnalyzeRank(SelectColumns(factor, independent),
                                   options_.relative_tolerance)
                           .rank;
      if (rank == static_cast<int>(independent.size())) continue;
      independent.pop_back();
      if (!names.empty()) names += ", ";
      names += layout_.parameter(order[k]).name;
    }
    result_.refusal =
        "the rules keep " + std::to_string(result_.num_free) +
        " parameters, but these poses determine only " +
        std::to_string(result_.perturbed_rank.rank) +
        ", whatever the geometry: " + names +
        (independent.size() + 1 == order.size() ? " depends" : " depend") +
        " on the others. Fix as many (identifiability: fix: [" + names +
        "]), measure more varied poses, or set proceed_beyond_rank: true to "
        "solve all the same";
  }

  void ReportWeak(const std::vector<Dependency>& dependencies) {
    std::string relations;
    for (const Dependency& dependency : dependencies) {
      result_.weak.push_back(layout_.parameter(dependency.column).name);
      if (!relations.empty()) relations += "; ";
      relations += DescribeDependency(layout_, dependency);
    }
    result_.warnings.push_back(
        "at the nominal geometry these poses determine only " +
        std::to_string(result_.nominal_rank.rank) + " of " +
        std::to_string(result_.num_free) + " parameters (" + relations +
        "); only second-order effects separate the rest, so measurement noise "
        "would be amplified strongly in them");
  }

  const MeasurementModel& model_;
  const ParameterLayout& layout_;
  const Dataset& data_;
  const IdentifiabilityOptions& options_;
  IdentifiabilityResult result_;
};

}  // namespace

IdentifiabilityResult ApplyRules(const MeasurementModel& model,
                                 const Dataset& data,
                                 const IdentifiabilityOptions& options) {
  return Pass(model, data, options).Run();
}

std::vector<int> FreeColumns(const IdentifiabilityResult& result) {
  std::vector<int> columns;
  for (std::size_t c = 0; c < result.decisions.size(); ++c) {
    if (result.decisions[c].state == ParameterState::kFree) {
      columns.push_back(static_cast<int>(c));
    }
  }
  return columns;
}

}  // namespace alidade::internal
