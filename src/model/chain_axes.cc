#include "src/model/chain_axes.h"

#include <cmath>

#include "alidade/forward_kinematics.h"

namespace alidade::internal {
namespace {

// Turns the frame's axes `first` and `second` in their plane, from first
// towards second.
void TurnAxes(double angle, int first, int second, Eigen::Matrix3d* frame) {
  const double cosine = std::cos(angle);
  const double sine = std::sin(angle);
  const Eigen::Vector3d a = frame->col(first);
  const Eigen::Vector3d b = frame->col(second);
  frame->col(first) = cosine * a + sine * b;
  frame->col(second) = cosine * b - sine * a;
}

void Resize(int num_joints, ChainAxes* axes) {
  axes->beta_axis.resize(3, num_joints);
  axes->alpha_axis.resize(3, num_joints);
  axes->joint_axis.resize(3, num_joints);
  axes->origin_before.resize(3, num_joints);
  axes->origin_on_axis.resize(3, num_joints);
}

}  // namespace

void ComputeChainAxes(const Arm& arm, const double* joint_values,
                      ChainAxes* axes) {
  constexpr int kX = 0;
  constexpr int kY = 1;
  constexpr int kZ = 2;
  Resize(arm.num_joints(), axes);
  const ErrorsOfPose errors(arm, joint_values);
  Eigen::Matrix3d frame = arm.instrument_from_base.linear();
  Eigen::Vector3d origin = arm.instrument_from_base.translation();
  for (int j = 0; j < arm.num_joints(); ++j) {
    const Joint& joint = arm.joints[j];
    const bool revolute = joint.type == JointType::kRevolute;
    axes->origin_before.col(j) = origin;
    axes->beta_axis.col(j) = frame.col(kY);
    TurnAxes(joint.beta, kZ, kX, &frame);
    axes->alpha_axis.col(j) = frame.col(kX);
    TurnAxes(joint.alpha, kY, kZ, &frame);
    origin += joint.d * frame.col(kX);
    axes->origin_on_axis.col(j) = origin;
    axes->joint_axis.col(j) = frame.col(kZ);
    const double q = joint_values[j] +
                     (errors.get() != nullptr ? errors.get()->shifts[j] : 0.0);
    TurnAxes(joint.theta + (revolute ? q : 0.0), kX, kY, &frame);
    if (errors.get() != nullptr) {
      const auto tilt = errors.get()->tilts.col(j);
      TurnAxes(2.0 * std::atan(0.5 * tilt[0]), kY, kZ, &frame);
      TurnAxes(2.0 * std::atan(0.5 * tilt[1]), kZ, kX, &frame);
    }
    origin += (joint.r + (revolute ? 0.0 : q)) * frame.col(kZ);
  }
  axes->instrument_from_last.linear() = frame;
  axes->instrument_from_last.translation() = origin;
  axes->instrument_from_target =
      axes->instrument_from_last * arm.last_from_target();
}

}  // namespace alidade::internal
