#include "src/compensation/chain_evaluator.h"

#include <algorithm>
#include <cmath>

namespace alidade::internal {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;

void Turn(double sine, double cosine, int first, int second, Matrix3d* frame) {
  const Vector3d a = frame->col(first);
  const Vector3d b = frame->col(second);
  frame->col(first) = cosine * a + sine * b;
  frame->col(second) = cosine * b - sine * a;
}

// By 2 atan(tilt / 2), as the model has it.
void Tilt(double tilt, int first, int second, Matrix3d* frame) {
  if (tilt == 0.0) return;
  const double quarter = 0.25 * tilt * tilt;
  const double scale = 1.0 / (1.0 + quarter);
  Turn(tilt * scale, (1.0 - quarter) * scale, first, second, frame);
}

// Of the straight line that the joint value lies on.
double SlopeOf(const JointFunction& function, double joint_value) {
  if (function.empty()) return 0.0;
  const auto count = static_cast<double>(function.values.size());
  double knot = std::floor((joint_value - function.first) / function.spacing);
  if (function.is_periodic) knot -= count * std::floor(knot / count);
  const double last = count - 1.0;
  if (!(knot >= -1.0 && knot <= last)) return 0.0;
  const auto k = static_cast<Index>(knot);
  const double below = k < 0 ? 0.0 : function.values[k];
  const double beyond = function.is_periodic ? function.values[0] : 0.0;
  const double above = knot == last ? beyond : function.values[k + 1];
  return (above - below) / function.spacing;
}

}  // namespace

ChainEvaluator::Link ChainEvaluator::LinkOf(const Joint& joint) {
  Link link;
  link.rotation = (Eigen::AngleAxisd(joint.beta, Vector3d::UnitY()) *
                   Eigen::AngleAxisd(joint.alpha, Vector3d::UnitX()))
                      .toRotationMatrix();
  link.offset = joint.d * link.rotation.col(0);
  link.theta = joint.theta;
  link.r = joint.r;
  link.is_revolute = joint.type == JointType::kRevolute;
  return link;
}

ChainEvaluator::ChainEvaluator(const Arm& arm, int target)
    : errors_(arm.errors),
      base_(arm.instrument_from_base),
      tool_(arm.last_from_target(target)) {
  const int n = arm.num_joints();
  for (int j = 0; j < n; ++j) {
    links_.push_back(LinkOf(arm.joints[j]));
    Joint load = arm.joints[j];
    if (errors_.load_geometry.size() > 0) {
      const auto geometry = errors_.load_geometry.col(j);
      load.beta = geometry[0];
      load.alpha = geometry[1];
      load.d = geometry[2];
      load.theta = geometry[3];
      load.r = geometry[4];
    }
    load_links_.push_back(LinkOf(load));
  }
  load_point_ = errors_.payload.centre + (errors_.load_geometry.size() > 0
                                              ? errors_.load_target
                                              : MeanTargetOf(arm));
  if (errors_.links.empty()) errors_.links.resize(n);
  needs_moments_ = std::any_of(
      errors_.joints.begin(), errors_.joints.end(), [](const auto& joint) {
        return joint.backlash != 0.0 || (joint.compliance.array() != 0.0).any();
      });
  has_coupling_ = errors_.coupling.size() > 0;
  if (has_coupling_) {
    motion_ = errors_.coupling;
    motion_.diagonal().array() += 1.0;
  }
  shifts_.setZero(n);
  slopes_.setZero(n);
  tilts_.setZero(2, n);
  axes_.resize(3, n);
  points_.resize(3, n);
  moments_.resize(3, n);
  load_frames_.resize(n);
  load_points_.resize(3, n);
  load_origins_.resize(3, n);
  uncoupled_.resize(6, n);
}

void ChainEvaluator::ComputeMoments(const double* joint_values) {
  Matrix3d frame = Matrix3d::Identity();
  Vector3d origin = Vector3d::Zero();
  const int n = num_joints();
  for (int j = 0; j < n; ++j) {
    const Link& link = load_links_[j];
    const double q = joint_values[j];
    origin += frame * link.offset;
    load_points_.col(j) = origin;
    frame = (frame * link.rotation).eval();
    const double angle = link.theta + (link.is_revolute ? q : 0.0);
    Turn(std::sin(angle), std::cos(angle), 0, 1, &frame);
    origin += (link.r + (link.is_revolute ? 0.0 : q)) * frame.col(2);
    load_frames_[j] = frame;
    load_origins_.col(j) = origin;
  }
  // Of all loads from joint j on: their mass, and the sum of mass times place.
  double mass = errors_.payload.mass;
  Vector3d sum = mass * (origin + frame * load_point_);
  const Vector3d gravity = kStandardGravity * errors_.gravity;
  for (int j = n - 1; j >= 0; --j) {
    const Load& load = errors_.links[j];
    mass += load.mass;
    sum += load.mass * (load_origins_.col(j) + load_frames_[j] * load.centre);
    const Vector3d lever = sum - mass * load_points_.col(j);
    moments_.col(j) = load_frames_[j].transpose() * lever.cross(gravity);
  }
}

void ChainEvaluator::ComputeErrors(const double* joint_values) {
  const int n = num_joints();
  const Eigen::Map<const Eigen::VectorXd> q(joint_values, n);
  if (has_coupling_) {
    shifts_.noalias() = errors_.coupling * q;
  } else {
    shifts_.setZero();
  }
  if (errors_.joints.empty()) return;
  if (needs_moments_) ComputeMoments(joint_values);
  for (int j = 0; j < n; ++j) {
    const JointErrors& joint = errors_.joints[j];
    double shift = joint.function.At(q[j]);
    double slope = SlopeOf(joint.function, q[j]);
    for (const Harmonic& harmonic : joint.harmonics) {
      const double cosine = std::cos(harmonic.cycles * q[j]);
      const double sine = std::sin(harmonic.cycles * q[j]);
      shift += harmonic.cosine * cosine + harmonic.sine * sine;
      slope +=
          harmonic.cycles * (harmonic.sine * cosine - harmonic.cosine * sine);
    }
    if (needs_moments_) {
      const Vector3d turn = joint.compliance.cwiseProduct(moments_.col(j));
      tilts_.col(j) = turn.head<2>();
      if (links_[j].is_revolute) {
        shift += turn.z();
        if (joint.backlash != 0.0) {
          shift += joint.backlash * SmoothSign(moments_(2, j));
        }
      }
    }
    shifts_[j] += shift;
    slopes_[j] = slope;
  }
}

void ChainEvaluator::Evaluate(const double* joint_values, ChainState* state) {
  const bool has_errors = !errors_.empty();
  if (has_errors) ComputeErrors(joint_values);
  Matrix3d frame = base_.linear();
  Vector3d origin = base_.translation();
  for (int j = 0; j < num_joints(); ++j) {
    const Link& link = links_[j];
    const double q = joint_values[j] + shifts_[j];
    origin += frame * link.offset;
    frame = (frame * link.rotation).eval();
    axes_.col(j) = frame.col(2);
    points_.col(j) = origin;
    const double angle = link.theta + (link.is_revolute ? q : 0.0);
    Turn(std::sin(angle), std::cos(angle), 0, 1, &frame);
    if (has_errors) {
      Tilt(tilts_(0, j), 1, 2, &frame);
      Tilt(tilts_(1, j), 2, 0, &frame);
    }
    if (!link.is_revolute) axes_.col(j) = frame.col(2);
    origin += (link.r + (link.is_revolute ? 0.0 : q)) * frame.col(2);
  }
  state->position = origin + frame * tool_.translation();
  state->rotation = frame * tool_.linear();
  FillJacobian(state);
}

void ChainEvaluator::FillJacobian(ChainState* state) {
  auto& jacobian = has_coupling_ ? uncoupled_ : state->jacobian;
  for (int j = 0; j < num_joints(); ++j) {
    const Vector3d axis = axes_.col(j);
    if (links_[j].is_revolute) {
      jacobian.col(j).head<3>() = axis.cross(state->position - points_.col(j));
      jacobian.col(j).tail<3>() = axis;
    } else {
      jacobian.col(j).head<3>() = axis;
      jacobian.col(j).tail<3>().setZero();
    }
  }
  if (has_coupling_) {
    state->jacobian.noalias() = uncoupled_ * motion_;
    for (int j = 0; j < num_joints(); ++j) {
      state->jacobian.col(j) += slopes_[j] * uncoupled_.col(j);
    }
  } else if (!errors_.joints.empty()) {
    for (int j = 0; j < num_joints(); ++j) {
      jacobian.col(j) *= 1.0 + slopes_[j];
    }
  }
}

}  // namespace alidade::internal
