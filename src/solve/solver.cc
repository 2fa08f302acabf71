#include "alidade/solver.h"

#include <cmath>
#include <sstream>

#include "src/solve/solver_fields.h"

namespace alidade {

bool SolverOptions::IsValid(std::string* error) const {
  internal::FieldCheck threads("");
  threads.Field(internal::Key("num_threads").AtLeast(1), num_threads, "");
  *error = threads.error();
  return internal::AreFieldsValid(*this, "", error) && error->empty();
}

const char* ToString(SolverStatus status) {
  switch (status) {
    case SolverStatus::kNotRun:
      return "not run";
    case SolverStatus::kConverged:
      return "converged";
    case SolverStatus::kPrecisionLimit:
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
    case SolverStatus::kPrecisionLimit:
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
  out << "Numerical precision limit            " << precision_limit << " m\n"
      << "Time to set up, solve     " << setup_time_s << " s, " << solve_time_s
      << " s\n";
  return out.str();
}

}  // namespace alidade
