#ifndef ALIDADE_IDENTIFIABILITY_OPTIONS_H_
#define ALIDADE_IDENTIFIABILITY_OPTIONS_H_

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "alidade/parameter_layout.h"

namespace alidade {

enum class IdentifiabilityMethod {
  kRules,  ///< the published study's three rules (rules.h)
  kRank,   ///< ranks over generic and given poses (analysis.h)
};

/// What is done with directions that the measurements tell badly.
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

/// How the identifiability pass decides. See rules.h and analysis.h.
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
  /// Go on although more parameters are kept than can be told apart. The
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

}  // namespace alidade

#endif  // ALIDADE_IDENTIFIABILITY_OPTIONS_H_
