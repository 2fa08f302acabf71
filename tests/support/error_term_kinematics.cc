#include "tests/support/error_term_kinematics.h"

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

namespace alidade::internal::testing {
namespace {

long double FunctionAt(const JointFunction& function, double q) {
  if (function.empty()) return 0.0L;
  long double sum = 0.0L;
  for (Eigen::Index k = 0; k < function.values.size(); ++k) {
    const long double knot =
        function.first + function.spacing * static_cast<double>(k);
    const long double hat = 1.0L - std::abs(q - knot) / function.spacing;
    if (hat > 0.0L) sum += hat * function.values[k];
  }
  return sum;
}

}  // namespace

Matrix4l ErrorTermKinematics::TargetFrame(const Eigen::VectorXd& q) const {
  const int n = arm_.num_joints();
  const Matrix3Xl moments = Moments(q);
  Matrix4l frame = arm_.instrument_from_base.matrix().cast<long double>();
  for (int j = 0; j < n; ++j) {
    JointErrors errors;
    if (!arm_.errors.joints.empty()) errors = arm_.errors.joints[j];
    const bool turns = arm_.joints[j].type == JointType::kRevolute;
    long double e = FunctionAt(errors.function, q[j]);
    for (int k = 0; arm_.errors.coupling.size() > 0 && k < n; ++k) {
      e += static_cast<long double>(arm_.errors.coupling(j, k)) * q[k];
    }
    for (const Harmonic& h : errors.harmonics) {
      const long double phase = static_cast<long double>(h.cycles) * q[j];
      e += h.cosine * std::cos(phase) + h.sine * std::sin(phase);
    }
    if (turns) {
      const long double m = moments(2, j);
      e += errors.compliance.z() * m +
           errors.backlash * m / std::sqrt(m * m + 0.25L);
    }
    const auto tilt = [&](int axis) {
      return 2.0L *
             std::atan(0.5L * errors.compliance[axis] * moments(axis, j));
    };
    const Joint& joint = arm_.joints[j];
    frame = frame * RotationY(joint.beta) * RotationX(joint.alpha) *
            Translation({joint.d, 0.0L, 0.0L}) *
            RotationZ(joint.theta + (turns ? q[j] + e : 0.0L)) *
            RotationX(tilt(0)) * RotationY(tilt(1)) *
            Translation({0.0L, 0.0L, joint.r + (turns ? 0.0L : q[j] + e)});
  }
  return frame * arm_.last_from_target().matrix().cast<long double>();
}

Matrix3Xl ErrorTermKinematics::Moments(const Eigen::VectorXd& q) const {
  const int n = arm_.num_joints();
  std::vector<Matrix4l> before;
  std::vector<Matrix4l> frames;
  Matrix4l frame = Matrix4l::Identity();
  for (int j = 0; j < n; ++j) {
    const Joint& joint = arm_.joints[j];
    const bool turns = joint.type == JointType::kRevolute;
    frame = frame * RotationY(joint.beta) * RotationX(joint.alpha) *
            Translation({joint.d, 0.0L, 0.0L});
    before.push_back(frame);
    frame = frame * RotationZ(joint.theta + (turns ? q[j] : 0.0)) *
            Translation({0.0L, 0.0L, joint.r + (turns ? 0.0 : q[j])});
    frames.push_back(frame);
  }
  const auto place = [](const Matrix4l& in, const Eigen::Vector3d& at) {
    const Vector3l point = at.cast<long double>();
    return Vector3l(in.topLeftCorner<3, 3>() * point +
                    in.topRightCorner<3, 1>());
  };
  const Vector3l gravity = 9.80665L * arm_.errors.gravity.cast<long double>();
  Matrix3Xl moments(3, n);
  for (int j = 0; j < n; ++j) {
    const Vector3l about = before[j].topRightCorner<3, 1>();
    Vector3l moment = Vector3l::Zero();
    for (int k = j; k < n; ++k) {
      const Load load =
          arm_.errors.links.empty() ? Load() : arm_.errors.links[k];
      moment +=
          (place(frames[k], load.centre) - about).cross(load.mass * gravity);
    }
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const Target& target : arm_.targets) {
      mean += target.last_from_target.translation() / arm_.num_targets();
    }
    const Load& payload = arm_.errors.payload;
    moment += (place(frames[n - 1], mean + payload.centre) - about)
                  .cross(payload.mass * gravity);
    moments.col(j) = frames[j].topLeftCorner<3, 3>().transpose() * moment;
  }
  return moments;
}

Arm WithRandomErrors(const Arm& nominal, Random* random) {
  Arm arm = nominal;
  for (Joint& joint : arm.joints) {
    for (double* angle : {&joint.beta, &joint.alpha, &joint.theta}) {
      *angle += random->Uniform(-3e-3, 3e-3);
    }
    for (double* length : {&joint.d, &joint.r}) {
      *length += random->Uniform(-5e-4, 5e-4);
    }
    JointErrors errors;
    const bool turns = joint.type == JointType::kRevolute;
    for (double& value : errors.compliance) {
      value = random->Uniform(0.0, 2e-5);
    }
    errors.function.first = -3.0;
    errors.function.spacing = 0.05;
    errors.function.values.resize(121);
    double value = 0.0;
    for (double& at : errors.function.values) {
      value = 0.9 * value + 5e-5 * random->Normal();
      at = value;
    }
    if (turns) {
      errors.harmonics = {{1.0, random->Uniform(-2e-4, 2e-4), 1e-4},
                          {2.0, 5e-5, random->Uniform(-1e-4, 1e-4)}};
      errors.backlash = 2e-5;
    }
    arm.errors.joints.push_back(errors);
  }
  const int n = arm.num_joints();
  arm.errors.coupling.setZero(n, n);
  for (int j = 0; j < n; ++j) {
    arm.errors.coupling(j, j) = random->Uniform(-2e-4, 2e-4);
    if (j > 0) arm.errors.coupling(j, j - 1) = random->Uniform(-2e-4, 2e-4);
  }
  return arm;
}

}  // namespace alidade::internal::testing
