#ifndef ALIDADE_SRC_SOLVE_SOLVER_NAMES_H_
#define ALIDADE_SRC_SOLVE_SOLVER_NAMES_H_

#include <string>

namespace alidade::internal {

/// A solver as people call it: "ceres" is "Levenberg-Marquardt"; a name
/// that is not known here stays.
inline std::string SolverTitle(const std::string& solver) {
  if (solver == "ceres") return "Levenberg-Marquardt";
  if (solver == "pseudo_inverse") return "iterated pseudo-inverse";
  return solver;
}

/// The same in short, for lines that name several.
inline std::string ShortSolverTitle(const std::string& solver) {
  if (solver == "ceres") return "Levenberg-Marquardt";
  if (solver == "pseudo_inverse") return "pseudo-inverse";
  return solver;
}

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SOLVE_SOLVER_NAMES_H_
