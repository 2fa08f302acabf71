#include "src/calibration/calibration_task.h"

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>

#include "alidade/error.h"
#include "alidade/parameter_layout.h"
#include "src/calibration/data_check.h"
#include "src/calibration/data_split.h"

namespace alidade::internal {

namespace {

void RequireNames(const ParameterLayout& layout, const char* option,
                  const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    if (layout.Find(name)) continue;
    throw InputError({}, std::string(option) + ": the arm has no parameter \"" +
                             name + "\", expected one of " +
                             layout.parameter(0).name + " ... " +
                             layout.parameter(layout.size() - 1).name +
                             " (docs/conventions.md)");
  }
}

// Each has three parameters; matrices of all are dense.
void RequireFewReferences(const References& references) {
  constexpr std::int64_t kMost = 1000;
  const auto is_unknown = [](const auto& reference) {
    return !reference.is_known;
  };
  const std::int64_t count =
      std::count_if(references.points.begin(), references.points.end(),
                    is_unknown) +
      std::count_if(references.planes.begin(), references.planes.end(),
                    is_unknown);
  if (count <= kMost) return;
  throw InputError({}, "references: " + std::to_string(count) +
                           " points and planes are to be found, at most " +
                           std::to_string(kMost) +
                           " can be in one job: state those that are known "
                           "(`known: true`), or leave data out");
}

void RequireJoint(const Arm& arm, const char* option, int joint) {
  if (joint >= 0 && joint < arm.num_joints()) return;
  throw InputError({}, std::string(option) + " names joint " +
                           std::to_string(joint) + ", expected one from 0 to " +
                           std::to_string(arm.num_joints() - 1));
}

void RequireJoints(const ErrorTermOptions& errors, const Arm& arm) {
  for (const auto& [joint, other] : errors.coupling) {
    RequireJoint(arm, "errors.coupling", joint);
    RequireJoint(arm, "errors.coupling", other);
  }
  for (const CovariateUse& use : errors.uses) {
    for (const int joint : use.joints) RequireJoint(arm, "errors.uses", joint);
  }
}

void RequireValid(const CalibrationTask& task) {
  std::string error;
  if (!task.options.IsValid(&error)) throw InputError({}, error);
  if (task.arm.joints.empty() || task.arm.targets.empty()) {
    throw InputError(
        {}, "the arm \"" + task.arm.name + "\" has no joint or no target");
  }
  RequireJoints(task.options.errors, task.arm);
  const References& references = task.data.references;
  RequireFewReferences(references);
  const ParameterLayout layout(
      LayoutShape{task.arm.num_joints(), task.arm.num_targets(),
                  references.num_points(), references.num_planes()});
  for (const ParameterBounds& bound : task.options.bounds) {
    RequireNames(layout, "bounds", {bound.parameter});
  }
  const IdentifiabilityOptions& identifiability = task.options.identifiability;
  RequireNames(layout, "identifiability.fix", identifiability.fix);
  RequireNames(layout, "identifiability.free", identifiability.free);
  RequireNames(layout, "identifiability.prefer", identifiability.prefer);
  RequireConsistent(task.data.training, task.arm, references);
  if (task.data.validation) {
    RequireConsistent(*task.data.validation, task.arm, references);
  }
}

}  // namespace

void CheckAndHoldOut(CalibrationTask* task) {
  RequireValid(*task);
  CalibrationData& data = task->data;
  if (task->options.holdout && !data.validation) {
    const HoldOutOptions& options = *task->options.holdout;
    HoldOut split = SplitData(data.training, options, task->communicator);
    data.training = std::move(split.train);
    data.validation = std::move(split.validation);
  }
  if (data.validation) RequireFinite(*data.validation);
}

}  // namespace alidade::internal
