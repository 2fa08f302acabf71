#ifndef ALIDADE_IDENTIFIABILITY_H_
#define ALIDADE_IDENTIFIABILITY_H_

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "alidade/parameter_layout.h"

namespace alidade {

enum class IdentifiabilityMethod {
  kRules,  ///< the published study's three rules
  kRank,   ///< ranks over generic and given poses
};

/// What is done with directions that the measurements determine badly.
enum class WeakPolicy {
  kAutomatic,  ///< keep for the rules, as published; prior for the ranks
  kFreeze,     ///< hold them at their nominal values
  kPrior,      ///< free with a Gaussian prior: a maximum a posteriori estimate
  kKeep,       ///< free, without any
};

/// Which parameters are to be identified, where nothing else says so.
struct CandidateGroups {
  bool joints = true;
  bool base = false;
  bool tool = false;
};

/// What is known of an arm before anything is measured: the standard deviations
/// of its parameters about their nominal values, by kind (rad, m). The defaults
/// are those of industrial arms of up to some metres: 5 mrad and 1 mm. Base and
/// tool are known no better than where they were put by hand: 1 m and 1 rad.
struct PriorTolerances {
  double beta = 5e-3;
  double alpha = 5e-3;
  double d = 1e-3;
  double theta = 5e-3;
  double r = 1e-3;
  double frame_length = 1.0;
  double frame_angle = 1.0;

  double Of(ParameterKind kind) const;
  /// One entry per column of the layout.
  Eigen::VectorXd Deviations(const ParameterLayout& layout) const;
  /// False with a message that names the field, its value and the constraint.
  bool IsValid(std::string* error) const;
};

/// How the identifiability pass decides. See docs/identifiability.md.
struct IdentifiabilityOptions {
  IdentifiabilityMethod method = IdentifiabilityMethod::kRank;
  WeakPolicy policy = WeakPolicy::kAutomatic;
  CandidateGroups candidates;
  /// Kept in preference to parameters they depend on, first to last.
  std::vector<std::string> prefer;
  /// Must be free; refused with the reason where they cannot be. Rank method.
  std::vector<std::string> free;
  PriorTolerances priors;
  /// Parameters the user holds at their nominal values, by name.
  std::vector<std::string> fix;
  /// Go on although more parameters are kept than can be distinguished. The
  /// solver then finds one of infinitely many equal solutions.
  bool proceed_beyond_rank = false;
  /// An angle counts as zero, and two axes as parallel, below this (rad). The
  /// default is far above the rounding of 90 degrees in radians and far below
  /// any angle an arm is designed with.
  double angle_tolerance = 1e-6;
  /// A column counts as zero when its norm is below this times the largest one
  /// (angles scaled by the reach of the arm), and a singular value when it is
  /// below this times the largest. The default is above what joint values of
  /// four decimals of a degree add to a rank, and below every effect that noise
  /// of a real measurement could leave visible. Range (0, 1).
  double relative_tolerance = 1e-6;
  /// Size of the perturbations for the perturbed rank: rad for angles, times
  /// the reach for lengths. Manufacturing errors are of this size or smaller.
  double perturbation = 1e-2;
  std::uint64_t seed = 1;

  /// False with a message that names the field, its value and the constraint.
  bool IsValid(std::string* error) const;
};

enum class ParameterState {
  kFree,   ///< identified
  kFixed,  ///< held at its nominal value by the analysis or by the user
  kGiven,  ///< not among the parameters to identify (a known base or tool)
};

/// "free", "fixed", "given".
const char* ToString(ParameterState state);

/// What the analysis decided about one parameter, and why.
struct ParameterDecision {
  std::string name;
  ParameterState state = ParameterState::kFree;
  /// Short key of what decided, empty for a plainly free parameter:
  /// "beta_rule", "zero_column", "parallel_r" (the study's rules),
  /// "no_effect", "structural", "at_geometry", "not_excited", "not_practical"
  /// (the levels of the rank method; a free one may carry the last three),
  /// "fixed_by_user".
  std::string rule;
  /// A sentence for people.
  std::string reason;
  /// What a free parameter identifies once others are fixed
  /// ("r2 + r3 + r4"), or empty.
  std::string identified_combination;
  /// Known a priori, of its whole combination; NaN where no prior
  /// applies.
  double prior_std = std::numeric_limits<double>::quiet_NaN();
  /// Predicted from these poses and their sigmas, priors included where the
  /// policy uses them; infinite where nothing determines it, NaN where fixed.
  double predicted_std = std::numeric_limits<double>::quiet_NaN();
};

/// A parameter that can be left out, and the combination of others that acts
/// as it does: moving `parameter` by 1 moves every measured point as moving
/// each term's parameter by its coefficient does (SI units).
struct Relation {
  std::string parameter;
  std::string
      level;  ///< "no_effect", "structural", "at_geometry", "not_excited"
  std::vector<std::pair<std::string, double>> terms;
  std::string text;  ///< "alpha5 is linearly dependent on -72 mm * r2"
  /// The parameters were moved along it and the points stayed, but for
  /// second-order terms.
  bool verified = false;
};

/// Observability indices of N poses, from the singular values s_1 >= ... >= s_m
/// of the Jacobian: O1 = (s_1 ... s_m)^(1/m) / sqrt(N) (Borm and Menq 1989),
/// O2 = s_m / s_1 (Driels and Pathre 1990), O3 = s_m (Nahvi, Hollerbach and
/// Hayward 1994), O4 = s_m^2 / s_1 (Nahvi and Hollerbach 1996),
/// O5 = 1 / (1 / s_1 + ... + 1 / s_m) (Sun and Hollerbach 2008).
struct ObservabilityIndices {
  double o1 = 0.0;
  double o2 = 0.0;
  double o3 = 0.0;
  double o4 = 0.0;
  double o5 = 0.0;
  double condition = 0.0;
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
  std::string method;  ///< "rules" or "rank"
  std::string policy;  ///< "freeze", "prior" or "keep", as used
  /// One entry per column of the parameter layout.
  std::vector<ParameterDecision> decisions;
  /// Of the kept parameters, at the nominal geometry and these poses.
  RankReport nominal_rank;
  /// Of the kept parameters, at seeded perturbations of the geometry and these
  /// poses: what a solver can distinguish by second-order effects.
  RankReport perturbed_rank;
  int num_free = 0;
  /// More parameters are kept than any solver could distinguish; `refusal`
  /// names them. Solving needs a choice by the user.
  bool exceeds_rank = false;
  std::string refusal;
  std::vector<std::string> warnings;
  /// Kept parameters that depend on others at the nominal geometry only.
  std::vector<std::string> weak;

  /// Rank method only: over generic poses, at the nominal geometry and at
  /// perturbed ones (the structural rank), of all candidates.
  int num_candidates = 0;
  RankReport generic_rank;
  RankReport structural_rank;
  std::vector<Relation> relations;
  /// Joint motions that would distinguish what these poses do not.
  std::vector<std::string> advice;

  /// Of the free parameters over these poses, columns as they are (m and m/rad)
  /// and scaled by the reach.
  ObservabilityIndices unscaled;
  ObservabilityIndices scaled;
};

}  // namespace alidade

#endif  // ALIDADE_IDENTIFIABILITY_H_
