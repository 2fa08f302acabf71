#ifndef ALIDADE_SRC_PLANNING_PLAN_PROBLEM_H_
#define ALIDADE_SRC_PLANNING_PLAN_PROBLEM_H_

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "alidade/identifiability.h"
#include "src/kernel/measurement_model.h"
#include "src/planning/exchange.h"
#include "src/planning/plan_task.h"
#include "src/planning/planned_terms.h"

namespace alidade::internal {

/// A plan file as a problem of choice: candidates, parameters, what is known.
struct PlanProblem {
  IdentifiabilityResult identifiability;
  std::vector<int> columns;    ///< free parameters, of the layout
  Eigen::VectorXd scales;      ///< ColumnScale of each; of terms their priors
  Eigen::VectorXd prior_stds;  ///< of each; infinite = none
  /// After the parameters in all rows.
  std::optional<PlannedTerms> terms;
  DesignProblem design;
  std::int64_t num_looked_at = 0;
  /// Position rows (m) of the first target: of the candidates; of poses over
  /// the region, for tables, and of fewer, for curves.
  PoseRows candidate_positions;
  PoseRows region;
  PoseRows coarse_region;
  /// What is chosen from where poses are drawn at random: uniform draws, or the
  /// given candidates. Whitened.
  PoseRows random;

  bool HasKnown() const { return !design.known.isZero(0.0); }
};

/// Frames and sigmas of what was measured already, as a calibration finds them.
CalibrationTask PrepareMeasured(CalibrationTask task);

/// @throws InputError where no candidate satisfies the constraints. Where the
/// pass refuses (exceeds_rank), only `identifiability` is set.
PlanProblem MakePlanProblem(const PlanTask& config,
                            const MeasurementModel& model);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_PLANNING_PLAN_PROBLEM_H_
