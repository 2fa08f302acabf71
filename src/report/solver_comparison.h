#ifndef ALIDADE_SRC_REPORT_SOLVER_COMPARISON_H_
#define ALIDADE_SRC_REPORT_SOLVER_COMPARISON_H_

#include <string>
#include <vector>

#include "alidade/calibration_result.h"
#include "src/report/table.h"

namespace alidade::internal {

/// Outcome, steps, errors and times, a column for each solver.
Table SolverTable(const std::vector<SolverRun>& runs);

/// Where the values of `other` differ from those of the first run, in words;
/// nothing where either has none.
std::string DifferenceSentence(const CalibrationResult& result,
                               const SolverRun& other);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_REPORT_SOLVER_COMPARISON_H_
