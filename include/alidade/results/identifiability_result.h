#ifndef ALIDADE_RESULTS_IDENTIFIABILITY_RESULT_H_
#define ALIDADE_RESULTS_IDENTIFIABILITY_RESULT_H_

#include <Eigen/Core>
#include <string>
#include <vector>

namespace alidade {

enum class ParameterState {
  kFree,    ///< identified
  kFrozen,  ///< held at its nominal value by the analysis or by the user
  kGiven,   ///< not among the parameters to identify (a known base or tool)
};

/// "free", "frozen", "given".
const char* ToString(ParameterState state);

/// What the analysis decided about one parameter, and why.
struct ParameterDecision {
  std::string name;
  ParameterState state = ParameterState::kFree;
  /// Short key of what decided: "beta_rule", "zero_column", "parallel_r",
  /// "dependent", "fixed_by_user", or empty for a free parameter.
  std::string rule;
  /// A sentence for people.
  std::string reason;
  /// What a free parameter stands for once others are frozen
  /// ("r2 + r3 + r4"), or empty.
  std::string stands_for;
};

/// Singular values of a Jacobian with scaled columns, and the rank read from
/// them.
struct RankReport {
  Eigen::VectorXd singular_values;  ///< descending, relative to the first
  int rank = 0;
  /// Ratio of the last singular value kept to the first one dropped; infinite
  /// when none is dropped or it is exactly zero.
  double gap = 0.0;

  /// The smallest singular value that counts; 1 where nothing is known.
  double SmallestCounted() const;
  /// The middle (geometric) of the gap between the singular values that count
  /// and those that do not; where all count, of that between the smallest one
  /// and the rounding error. A tolerance there reads the same rank.
  double MiddleOfGap() const;
};

struct IdentifiabilityResult {
  std::string method;  ///< "rules"
  /// One entry per column of the parameter layout.
  std::vector<ParameterDecision> decisions;
  /// Of the kept parameters, at the nominal geometry and these poses.
  RankReport nominal_rank;
  /// Of the kept parameters, at seeded perturbations of the geometry and these
  /// poses: what a solver can tell apart by second-order effects.
  RankReport perturbed_rank;
  int num_free = 0;
  /// More parameters are kept than any solver could tell apart; `refusal`
  /// names them. Solving needs a choice by the user.
  bool exceeds_rank = false;
  std::string refusal;
  std::vector<std::string> warnings;
  /// Kept parameters that depend on others at the nominal geometry only.
  std::vector<std::string> weak;
};

}  // namespace alidade

#endif  // ALIDADE_RESULTS_IDENTIFIABILITY_RESULT_H_
