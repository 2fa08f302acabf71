#include "alidade/batch/evaluate.h"

#include <cmath>
#include <string>

#include "alidade/base/error.h"
#include "alidade/model/joint_draw.h"

namespace alidade {
namespace {

void RequireSameJoints(const Arm& arm, const Arm& reference) {
  bool same = arm.num_joints() == reference.num_joints();
  for (int j = 0; same && j < arm.num_joints(); ++j) {
    same = arm.joints[j].type == reference.joints[j].type;
  }
  if (same) return;
  throw InputError({}, "the arms \"" + arm.name + "\" and \"" + reference.name +
                           "\" differ in the number or the types of their "
                           "joints and cannot be compared");
}

void RequireLimitedTravel(const Arm& arm) {
  for (int j = 0; j < arm.num_joints(); ++j) {
    const Joint& joint = arm.joints[j];
    if (joint.type == JointType::kRevolute) continue;
    if (std::isfinite(joint.lower) && std::isfinite(joint.upper)) continue;
    throw InputError({}, "prismatic joint " + std::to_string(j + 1) +
                             " of the arm \"" + arm.name +
                             "\" has no limits: its workspace is not bounded. "
                             "Add limits to the arm file");
  }
}

}  // namespace

EvaluatedSet EvaluateSet(const MeasurementModel& model, const Dataset& data,
                         const Eigen::VectorXd& before,
                         const Eigen::VectorXd& after) {
  EvaluatedSet set;
  set.name = data.name;
  for (const Joint& joint : model.nominal().joints) {
    const bool revolute = joint.type == JointType::kRevolute;
    set.joint_dimensions.push_back(revolute ? Dimension::kAngle
                                            : Dimension::kLength);
  }
  set.joint_values = data.joint_values;
  set.positions = data.positions;
  set.residual_before = model.Errors(before, data);
  set.residual_after = model.Errors(after, data);
  set.before = SummarizeErrors(set.ErrorBefore());
  set.after = SummarizeErrors(set.ErrorAfter());
  return set;
}

Accuracy EvaluateAccuracy(const MeasurementModel& model, const Dataset& data,
                          const Eigen::VectorXd& values) {
  return SummarizeErrors(
      model.Errors(values, data).colwise().norm().transpose());
}

Accuracy CompareArms(const Arm& arm, const Arm& reference, int count,
                     std::uint64_t seed) {
  RequireSameJoints(arm, reference);
  RequireLimitedTravel(arm);
  const Eigen::MatrixXd joint_values = DrawJointValues(arm, count, seed);
  const MeasurementModel model(arm);
  const MeasurementModel reference_model(reference);
  const Eigen::Matrix3Xd difference =
      model.Predict(model.NominalValues(), joint_values) -
      reference_model.Predict(reference_model.NominalValues(), joint_values);
  return SummarizeErrors(difference.colwise().norm().transpose());
}

}  // namespace alidade
