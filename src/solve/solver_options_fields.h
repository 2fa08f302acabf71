#ifndef ALIDADE_SRC_SOLVE_SOLVER_OPTIONS_FIELDS_H_
#define ALIDADE_SRC_SOLVE_SOLVER_OPTIONS_FIELDS_H_

#include "alidade/solver_options.h"
#include "src/common/option_fields.h"

namespace alidade::internal {

template <>
inline constexpr std::array kWords<Evaluation> = {
    std::pair{Evaluation::kAutomatic, "auto"},
    std::pair{Evaluation::kAutodiff, "autodiff"},
    std::pair{Evaluation::kCompressed, "compressed"},
};

/// All but threads, which the program is told.
template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, SolverOptions>& options) {
  v.Field(Key("max_iterations").AtLeast(1), options.max_iterations,
          "most iterations, accepted and rejected together");
  v.Field(Key("function_tolerance").AtLeast(0), options.function_tolerance,
          "converged when the predicted relative decrease of the cost is "
          "below; 0 = never");
  v.Field(Key("rounding_floor_factor").AtLeast(0),
          options.rounding_floor_factor,
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
          "`compressed`, the reduced problem: as many rows as free parameters, "
          "which have the cost and derivatives of all observations; `auto`, "
          "the faster one, `compressed` at every size");
}

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SOLVE_SOLVER_OPTIONS_FIELDS_H_
