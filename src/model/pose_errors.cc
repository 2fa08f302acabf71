#include <algorithm>
#include <cmath>

#include "alidade/arm.h"
#include "alidade/error_terms.h"

namespace alidade {
namespace {

// The chain without its errors, in the base frame.
class RigidWalk {
 public:
  RigidWalk(const Arm& arm, const double* joint_values)
      : axes_(arm.joints.size()), points_(3, arm.num_joints()) {
    const ErrorTerms& errors = arm.errors;
    origins_.resize(3, arm.num_joints());
    Eigen::Matrix3d frame = Eigen::Matrix3d::Identity();
    Eigen::Vector3d origin = Eigen::Vector3d::Zero();
    for (int j = 0; j < arm.num_joints(); ++j) {
      const Joint& joint = arm.joints[j];
      Eigen::Matrix<double, 5, 1> g;
      if (errors.load_geometry.size() > 0) {
        g = errors.load_geometry.col(j);
      } else {
        g << joint.beta, joint.alpha, joint.d, joint.theta, joint.r;
      }
      (joint.type == JointType::kRevolute ? g[3] : g[4]) += joint_values[j];
      Turn(g[0], 2, 0, &frame);
      Turn(g[1], 1, 2, &frame);
      origin += g[2] * frame.col(0);
      points_.col(j) = origin;
      Turn(g[3], 0, 1, &frame);
      origin += g[4] * frame.col(2);
      axes_[j] = frame;
      origins_.col(j) = origin;
    }
    target_ = origin + frame * (MeanTarget(arm) + errors.payload.centre);
  }

  static Eigen::Vector3d MeanTarget(const Arm& arm) {
    if (arm.errors.load_geometry.size() > 0) return arm.errors.load_target;
    return MeanTargetOf(arm);
  }

  // With a mass added to the payload.
  Eigen::Matrix3Xd Moments(const ErrorTerms& errors, double more) const {
    const auto n = static_cast<Eigen::Index>(axes_.size());
    Eigen::Matrix3Xd moments(3, n);
    // Of all loads from joint j on: their mass, and the sum of mass times
    // place.
    double mass = errors.payload.mass + more;
    Eigen::Vector3d sum = mass * target_;
    for (Eigen::Index j = n - 1; j >= 0; --j) {
      const Load load = errors.links.empty() ? Load() : errors.links[j];
      mass += load.mass;
      sum += load.mass * (origins_.col(j) + axes_[j] * load.centre);
      const Eigen::Vector3d lever = sum - mass * points_.col(j);
      moments.col(j) =
          axes_[j].transpose() * lever.cross(kStandardGravity * errors.gravity);
    }
    return moments;
  }

 private:
  static void Turn(double angle, int first, int second,
                   Eigen::Matrix3d* frame) {
    if (angle == 0.0) return;
    const double cosine = std::cos(angle);
    const double sine = std::sin(angle);
    const Eigen::Vector3d a = frame->col(first);
    frame->col(first) = cosine * a + sine * frame->col(second);
    frame->col(second) = cosine * frame->col(second) - sine * a;
  }

  std::vector<Eigen::Matrix3d> axes_;
  Eigen::Matrix3Xd points_;
  Eigen::Matrix3Xd origins_;
  Eigen::Vector3d target_;
};

bool NeedsMoments(const ErrorTerms& errors) {
  return std::any_of(
      errors.joints.begin(), errors.joints.end(), [](const JointErrors& joint) {
        return joint.backlash != 0.0 || (joint.compliance.array() != 0.0).any();
      });
}

double SumOfHarmonics(const JointErrors& joint, double q) {
  double sum = 0.0;
  for (const Harmonic& harmonic : joint.harmonics) {
    sum += harmonic.cosine * std::cos(harmonic.cycles * q) +
           harmonic.sine * std::sin(harmonic.cycles * q);
  }
  return sum;
}

}  // namespace

Eigen::Vector3d MeanTargetOf(const Arm& arm) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Target& target : arm.targets) {
    sum += target.last_from_target.translation();
  }
  return sum / static_cast<double>(arm.num_targets());
}

Eigen::Matrix3Xd LoadMoments(const Arm& arm, const double* joint_values,
                             const double* covariates) {
  double more = 0.0;
  for (std::size_t k = 0;
       covariates != nullptr && k < arm.errors.covariates.size(); ++k) {
    const CovariateEffect& effect = arm.errors.covariates[k];
    more += (covariates[k] - effect.reference) * effect.payload;
  }
  return RigidWalk(arm, joint_values).Moments(arm.errors, more);
}

PoseErrors ErrorsAt(const Arm& arm, const double* joint_values,
                    const double* covariates) {
  const ErrorTerms& errors = arm.errors;
  const int n = arm.num_joints();
  PoseErrors at;
  at.shifts.setZero(n);
  at.tilts.setZero(2, n);
  if (errors.coupling.size() > 0) {
    at.shifts =
        errors.coupling * Eigen::Map<const Eigen::VectorXd>(joint_values, n);
  }
  for (std::size_t k = 0; covariates != nullptr && k < errors.covariates.size();
       ++k) {
    const CovariateEffect& effect = errors.covariates[k];
    const double value = covariates[k] - effect.reference;
    at.base += value * effect.base;
    at.target += value * effect.target;
    if (effect.joints.size() > 0) at.shifts += value * effect.joints;
  }
  if (errors.joints.empty()) return at;
  for (int j = 0; j < n; ++j) {
    const JointErrors& joint = errors.joints[j];
    at.shifts[j] += joint.function.At(joint_values[j]) +
                    SumOfHarmonics(joint, joint_values[j]);
  }
  if (!NeedsMoments(errors)) return at;
  const Eigen::Matrix3Xd moments = LoadMoments(arm, joint_values, covariates);
  for (int j = 0; j < n; ++j) {
    const JointErrors& joint = errors.joints[j];
    const Eigen::Vector3d turn = joint.compliance.cwiseProduct(moments.col(j));
    at.tilts.col(j) = turn.head<2>();
    if (arm.joints[j].type == JointType::kPrismatic) continue;
    at.shifts[j] += turn.z() + joint.backlash * SmoothSign(moments(2, j));
  }
  return at;
}

}  // namespace alidade
