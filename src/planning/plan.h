#ifndef ALIDADE_SRC_PLANNING_PLAN_H_
#define ALIDADE_SRC_PLANNING_PLAN_H_

#include <string>
#include <vector>

#include "alidade/dataset.h"
#include "alidade/plan_result.h"
#include "src/planning/plan_config.h"

namespace alidade::internal {

enum class PlanStatus {
  kDone,
  /// The identifiability pass wants a choice by the user, or the wanted
  /// accuracy needs more poses than allowed.
  kRefused,
  kFailed,  ///< no plan of as many poses tells all parameters apart
};

struct PlanOutcome {
  PlanStatus status = PlanStatus::kFailed;
  std::string message;  ///< empty when done
  PlanResult result;
  /// The poses in order as a data set in which nothing is measured yet.
  Dataset sheet;
  Arm arm;                 ///< as planned with
  int joint_decimals = 0;  ///< that state the sheet's joint values exactly
};

/// Draws or reads the candidates, finds what can be identified from them and
/// the poses measured before, chooses (design/exchange.h), orders, and
/// evaluates the plan over the candidates and over the region (by default all
/// that the joint limits allow, limit faces included) beside the greedy plan
/// and random poses. Writes nothing. Results do not depend on `num_threads`.
/// @throws InputError where no candidate satisfies the constraints, or an
/// input cannot be read again for its hash.
PlanOutcome RunPlan(const PlanConfig& config, const std::string& command,
                    int num_threads);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_PLANNING_PLAN_H_
