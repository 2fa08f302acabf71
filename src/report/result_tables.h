#ifndef ALIDADE_SRC_REPORT_RESULT_TABLES_H_
#define ALIDADE_SRC_REPORT_RESULT_TABLES_H_

#include <string>
#include <vector>

#include "alidade/calibration_result.h"
#include "src/report/table.h"

namespace alidade::internal {

/// Accuracy before and after, by stages and by cross-validation, how the
/// residuals compare with the sigmas, and the acceptance limits.
std::string AccuracySection(const CalibrationResult& result);

/// Empty where there are none.
std::string OutlierSection(const CalibrationResult& result);
std::string RejectedRowSection(const CalibrationResult& result);

/// The tables of these, empty where a result has not what they show. Lengths
/// and, in tables of their own, orientations.
Table AccuracyTable(const CalibrationResult& result, Dimension dimension);
/// After calibration, by kind and target; empty where there is only one.
Table KindTable(const CalibrationResult& result);
Table StagesTable(const CalibrationResult& result, Dimension dimension);
Table OutlierTable(const CalibrationResult& result);
Table RejectedRowTable(const CalibrationResult& result);

/// What accuracy by stage is of where some observations were rejected, a
/// sentence; else empty.
std::string StagesNote(const CalibrationResult& result);

/// Words for people: "estimated", "fixed", "known" and, of the estimated ones,
/// "prior-dominated" and "weakly identifiable".
const char* StateForPeople(ParameterState state);
const char* AssessmentForPeople(ParameterAssessment assessment);

/// What repeated configurations differ by, a sentence; empty without any.
std::string RepeatSentence(const CalibrationResult& result);

/// Ranks of all candidates and of the free parameters.
Table RankTable(const IdentifiabilityResult& result);

/// Empty where nothing is free.
Table ObservabilityTable(const IdentifiabilityResult& result);

/// Outcome, steps, errors and times, a column for each solver.
Table SolverTable(const std::vector<SolverRun>& runs);

/// Where the values of `other` differ from those of the first run, in words;
/// nothing where either has none.
std::string DifferenceSentence(const CalibrationResult& result,
                               const SolverRun& other);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_REPORT_RESULT_TABLES_H_
