#ifndef ALIDADE_SRC_SOLVE_SOLVER_FIELDS_H_
#define ALIDADE_SRC_SOLVE_SOLVER_FIELDS_H_

#include "alidade/solver.h"
#include "src/common/option_fields.h"

namespace alidade::internal {

template <>
inline constexpr std::array kWords<Evaluation> = {
    std::pair{Evaluation::kAutomatic, "auto"},
    std::pair{Evaluation::kAutodiff, "autodiff"},
    std::pair{Evaluation::kReduced, "reduced"},
    std::pair{Evaluation::kReduced, "compressed"},
};

/// All but threads, which are the program's flag.
template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, SolverOptions>& options) {
  v.Field(Key("max_iterations").AtLeast(1), options.max_iterations,
          "most iterations, accepted and rejected together");
  v.Field(Key("function_tolerance").AtLeast(0), options.function_tolerance,
          "converged when the predicted relative decrease of the cost is "
          "below; 0 = never");
  v.Field(Key("precision_limit_factor")
              .Formerly("rounding_floor_factor")
              .AtLeast(0),
          options.precision_limit_factor,
          "stop where steps are below so many rounding errors of the model; 0 "
          "= never");
  v.Field(LengthKey("wanted_precision").AtLeast(0), options.wanted_precision,
          "converged when the largest error is below; 0 = not asked for");
  v.Field(Key("initial_trust_region_radius").AtLeast(0),
          options.initial_trust_region_radius,
          "`ceres`; 0 = chosen by the identifiability pass");
  v.Field(Key("pseudo_inverse_tolerance").AtLeast(0).Below(1),
          options.pseudo_inverse_tolerance,
          "`pseudo_inverse`: singular values below it times the largest count "
          "as zero; 0 = chosen by the identifiability pass");
  v.Field(Key("evaluation"), options.evaluation,
          "`ceres`: `autodiff`, one autodiff residual per observation; "
          "`reduced`, the reduced problem: as many rows as free parameters, "
          "which have the cost and derivatives of all observations; `auto`, "
          "the faster one, `reduced` at every size; `compressed` is the former "
          "name of "
          "`reduced`");
}

template <>
inline constexpr std::array kWords<SolverStatus> = {
    std::pair{SolverStatus::kNotRun, "not_run"},
    std::pair{SolverStatus::kConverged, "converged"},
    std::pair{SolverStatus::kPrecisionLimit, "precision_limit"},
    std::pair{SolverStatus::kIterationLimit, "iteration_limit"},
    std::pair{SolverStatus::kFailed, "failed"},
    std::pair{SolverStatus::kUnusable, "unusable"},
};

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, IterationRecord>& record) {
  v.Field("iteration", record.iteration);
  v.Field("cost", record.cost);
  v.Field("max_error", record.max_error);
  v.Field("rms_error", record.rms_error);
  v.Field("step_norm", record.step_norm);
  v.Field("accepted", record.accepted);
  v.Field("time_s", record.time_s);
}

/// All but the table of iterations, which stands where a run is described.
template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, SolverSummary>& summary) {
  v.Field("name", summary.solver);
  v.Later("evaluation", summary.evaluation);
  v.Field("status", summary.status);
  v.Field("message", summary.message);
  v.Computed("iterations", summary.iterations.empty()
                               ? 0
                               : summary.iterations.back().iteration);
  v.Field("accepted_steps", summary.accepted_steps);
  v.Field("rejected_steps", summary.rejected_steps);
  v.Field("initial_cost", summary.initial_cost);
  v.Field("final_cost", summary.final_cost);
  v.Field("num_poses", summary.num_poses);
  v.Field("num_residuals", summary.num_residuals);
  v.Later("num_rejected", summary.num_rejected);
  v.Field("num_parameters", summary.num_parameters);
  v.Field("num_free", summary.num_free);
  v.Field("threads_given", summary.threads_given);
  v.Field("threads_used", summary.threads_used);
  v.Field("trust_region_given", summary.trust_region_given);
  v.Field("trust_region_used", summary.trust_region_used);
  v.Field("pseudo_inverse_tolerance_given",
          summary.pseudo_inverse_tolerance_given);
  v.Field("pseudo_inverse_tolerance_used",
          summary.pseudo_inverse_tolerance_used);
  v.Field("first_step_rank", summary.first_step_rank);
  v.Field("precision_limit", summary.precision_limit);
  v.Computed("time_s", summary.setup_time_s + summary.solve_time_s);
  v.Field("setup_time_s", summary.setup_time_s);
  v.Field("solve_time_s", summary.solve_time_s);
}

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SOLVE_SOLVER_FIELDS_H_
