#ifndef ALIDADE_SRC_SERIALIZATION_RESULT_KEYS_H_
#define ALIDADE_SRC_SERIALIZATION_RESULT_KEYS_H_

#include <array>
#include <utility>

#include "alidade/calibration_result.h"
#include "alidade/identifiability.h"
#include "alidade/solver.h"
#include "alidade/units.h"

namespace alidade::internal {

/// The words of result.json. They stay as they are once published, whatever
/// the words for people become.
inline constexpr char kResultFormat[] = "alidade-result-1";
inline constexpr char kPlanResultFormat[] = "alidade-plan-result-1";
/// What to say where such a file is none of those expected.
inline constexpr char kPlanResultIsForMachines[] =
    "is what `alidade plan` has written, for machines: plan.txt beside it says "
    "it in words, and poses.csv is the plan";

inline constexpr std::array<std::pair<SolverStatus, const char*>, 6>
    kStatusKeys = {{
        {SolverStatus::kNotRun, "not_run"},
        {SolverStatus::kConverged, "converged"},
        {SolverStatus::kRoundingFloor, "rounding_floor"},
        {SolverStatus::kIterationLimit, "iteration_limit"},
        {SolverStatus::kFailed, "failed"},
        {SolverStatus::kUnusable, "unusable"},
    }};

inline constexpr std::array<std::pair<ParameterState, const char*>, 3>
    kStateKeys = {{
        {ParameterState::kFree, "free"},
        {ParameterState::kFrozen, "frozen"},
        {ParameterState::kGiven, "given"},
    }};

inline constexpr std::array<std::pair<ParameterAssessment, const char*>, 5>
    kAssessmentKeys = {{
        {ParameterAssessment::kKnown, "known"},
        {ParameterAssessment::kFixed, "fixed"},
        {ParameterAssessment::kWeak, "weak"},
        {ParameterAssessment::kPriorDominated, "prior_dominated"},
        {ParameterAssessment::kEstimated, "estimated"},
    }};

inline constexpr std::array<std::pair<FindingLevel, const char*>, 4>
    kLevelKeys = {{
        {FindingLevel::kPassed, "passed"},
        {FindingLevel::kNote, "note"},
        {FindingLevel::kAttention, "attention"},
        {FindingLevel::kFailed, "failed"},
    }};

inline constexpr std::array<std::pair<Dimension, const char*>, 2> kUnitKeys = {{
    {Dimension::kLength, "m"},
    {Dimension::kAngle, "rad"},
}};

/// The word of a value. @pre the table has it.
template <typename Table, typename Value>
const char* KeyOf(const Table& table, Value wanted) {
  for (const auto& [value, key] : table) {
    if (value == wanted) return key;
  }
  return "";
}

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_RESULT_KEYS_H_
