#ifndef ALIDADE_SRC_IDENTIFIABILITY_ANALYSIS_H_
#define ALIDADE_SRC_IDENTIFIABILITY_ANALYSIS_H_

#include <Eigen/Core>
#include <vector>

#include "alidade/identifiability.h"
#include "src/kernel/measurement_model.h"

namespace alidade::internal {

/// What no pose could determine: the candidates' null space over generic poses.
struct GenericAnalysis {
  /// Columns that can be distinguished at the nominal geometry, in the order of
  /// preference.
  std::vector<int> kept;
  /// Columns that only second-order effects separate from the kept ones.
  std::vector<int> weak;
  RankReport generic_rank;     ///< at the nominal geometry
  RankReport structural_rank;  ///< at perturbed geometries
  /// Of every candidate that is not kept, by its exact relation at the nominal
  /// geometry.
  std::vector<Relation> relations;
};

/// Analyses `candidates`, which are kept in preference in the order given,
/// over generic poses measured in the way of `data` (generic_data.h), four and
/// more for every column. Two ranks are taken of the scaled Jacobian,
///
///   - at the nominal geometry: what first-order effects distinguish;
///   - at three seeded perturbations of the geometry, the largest counts: the
///     structural rank, beyond which nothing can be determined by any pose and
///     any arm nearby.
///
/// The parameters that the second has above the first are `weak`. They are
/// taken from angles first, since beta and alpha are what axes that are nearly
/// parallel or nearly meet need. Set and relations depend on the seed only
/// where a rank has no clear gap. Each relation is verified by moving the
/// parameters along it. O(poses columns^2).
GenericAnalysis AnalyzeGeneric(const MeasurementModel& model,
                               const std::vector<int>& candidates,
                               const Dataset& data,
                               const IdentifiabilityOptions& options);

/// The whole identifiability pass for these poses: by the published rules
/// (rules.h), or by ranks, which distinguishes four levels,
///
///   structural     no pose could determine it: fixed, with the relation that
///   says
///                  what it depends on;
///   at_geometry    at the nominal geometry only second-order effects do;
///   not_excited    these poses do not determine it, though others could: the
///   advice
///                  names joint motions that help;
///   not_practical  it is below the noise level: the predicted standard
///   deviation is
///                  above what is known a priori;
///
/// and does with the last three what the policy says. Where the user's `free`
/// cannot be respected, or more stays free than the rank, exceeds_rank is set
/// and `refusal` says why.
/// @pre options.IsValid(), names exist, data has a pose and the model's joints.
IdentifiabilityResult AnalyzeIdentifiability(
    const MeasurementModel& model, const Dataset& data,
    const IdentifiabilityOptions& options);

/// Prior standard deviations that the solvers are to use with a result: one
/// entry per column, empty where the policy uses none.
Eigen::VectorXd PriorsOf(const IdentifiabilityResult& result);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_IDENTIFIABILITY_ANALYSIS_H_
