#include "alidade/solver.h"

#include <cmath>
#include <sstream>

namespace alidade {
namespace {

// Comparisons are written so that NaN fails them.
template <typename Value>
bool Require(bool holds, const char* field, Value value, const char* constraint,
             std::string* error) {
  if (holds) return true;
  std::ostringstream out;
  out << field << " = " << value << ", must be " << constraint;
  *error = out.str();
  return false;
}

bool IsFiniteNonNegative(double value) {
  return std::isfinite(value) && value >= 0.0;
}

}  // namespace

bool SolverOptions::IsValid(std::string* error) const {
  const char* non_negative = "a finite number of 0 or more";
  return Require(max_iterations >= 1, "max_iterations", max_iterations,
                 "1 or more", error) &&
         Require(IsFiniteNonNegative(function_tolerance), "function_tolerance",
                 function_tolerance, non_negative, error) &&
         Require(IsFiniteNonNegative(rounding_floor_factor),
                 "rounding_floor_factor", rounding_floor_factor, non_negative,
                 error) &&
         Require(IsFiniteNonNegative(wanted_precision), "wanted_precision",
                 wanted_precision, non_negative, error) &&
         Require(IsFiniteNonNegative(initial_trust_region_radius),
                 "initial_trust_region_radius", initial_trust_region_radius,
                 "above 0, or 0 for automatic", error) &&
         Require(
             pseudo_inverse_tolerance >= 0.0 && pseudo_inverse_tolerance < 1.0,
             "pseudo_inverse_tolerance", pseudo_inverse_tolerance,
             "between 0 (automatic) and 1", error) &&
         Require(num_threads >= 1, "num_threads", num_threads, "1 or more",
                 error);
}

}  // namespace alidade

namespace alidade {

const char* ToString(SolverStatus status) {
  switch (status) {
    case SolverStatus::kNotRun:
      return "not run";
    case SolverStatus::kConverged:
      return "converged";
    case SolverStatus::kRoundingFloor:
      return "stopped at the numerical precision limit";
    case SolverStatus::kIterationLimit:
      return "stopped by the number of iterations";
    case SolverStatus::kFailed:
      return "failed";
    case SolverStatus::kUnusable:
      return "unusable";
  }
  return "unknown";
}

bool SolverSummary::IsSolutionUsable() const {
  switch (status) {
    case SolverStatus::kConverged:
    case SolverStatus::kRoundingFloor:
      return true;
    case SolverStatus::kIterationLimit:
      return std::isfinite(final_cost) && final_cost <= initial_cost;
    case SolverStatus::kNotRun:
    case SolverStatus::kFailed:
    case SolverStatus::kUnusable:
      return false;
  }
  return false;
}

std::string SolverSummary::BriefReport() const {
  std::ostringstream out;
  out << solver << ": " << ToString(status) << " after " << accepted_steps
      << " iterations, chi-square " << initial_cost << " -> " << final_cost;
  return out.str();
}

std::string SolverSummary::FullReport() const {
  std::ostringstream out;
  const auto given = [](double value) {
    std::ostringstream text;
    if (value == 0.0) return std::string("automatic");
    text << value;
    return text.str();
  };
  out << "Solver                    " << solver << "\n"
      << "Status                    " << ToString(status) << "\n"
      << "Message                   " << message << "\n"
      << (evaluation.empty() ? ""
                             : "Evaluation                " + evaluation + "\n")
      << "Poses, residuals          " << num_poses << ", " << num_residuals
      << "\n"
      << "Parameters, free          " << num_parameters << ", " << num_free
      << "\n"
      << "Chi-square                " << initial_cost << " -> " << final_cost
      << "\n"
      << "Steps accepted, rejected  " << accepted_steps << ", "
      << rejected_steps << "\n"
      << "Threads given, used       " << threads_given << ", " << threads_used
      << "\n";
  if (trust_region_used > 0.0) {
    out << "Trust region given, used  " << given(trust_region_given) << ", "
        << trust_region_used << "\n";
  }
  if (pseudo_inverse_tolerance_used > 0.0) {
    out << "Pseudo-inverse tolerance  " << given(pseudo_inverse_tolerance_given)
        << ", " << pseudo_inverse_tolerance_used << " (given, used)\n";
  }
  out << "Rounding floor            " << rounding_floor << " m\n"
      << "Time to set up, solve     " << setup_time_s << " s, " << solve_time_s
      << " s\n";
  return out.str();
}

}  // namespace alidade
