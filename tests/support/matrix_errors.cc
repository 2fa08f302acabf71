#include "tests/support/matrix_errors.h"

namespace alidade::internal::testing {

long double MatrixFunction(const JointFunction& function, long double q) {
  long double sum = 0.0L;
  for (Eigen::Index k = 0; k < function.values.size(); ++k) {
    const long double knot =
        function.first + static_cast<long double>(k) * function.spacing;
    long double off = q - knot;
    if (function.is_periodic) {
      off = std::remainder(off, static_cast<long double>(function.spacing) *
                                    function.values.size());
    }
    const long double away = std::abs(off) / function.spacing;
    if (away < 1.0L) sum += (1.0L - away) * function.values[k];
  }
  return sum;
}

RigidFrames RigidFramesOf(const Arm& arm, const double* q) {
  RigidFrames frames;
  Matrix4l base = Matrix4l::Identity();
  for (int j = 0; j < arm.num_joints(); ++j) {
    const Joint& joint = arm.joints[j];
    Eigen::Matrix<double, 5, 1> g;
    g << joint.beta, joint.alpha, joint.d, joint.theta, joint.r;
    if (arm.errors.load_geometry.size() > 0)
      g = arm.errors.load_geometry.col(j);
    const bool revolute = joint.type == JointType::kRevolute;
    base = base * RotationY(g[0]) * RotationX(g[1]) *
           Translation({g[2], 0.0L, 0.0L}) *
           RotationZ(static_cast<long double>(g[3]) + (revolute ? q[j] : 0.0));
    frames.on_axis.push_back(base);
    base =
        base *
        Translation({0.0L, 0.0L,
                     static_cast<long double>(g[4]) + (revolute ? 0.0 : q[j])});
    frames.after.push_back(base);
  }
  return frames;
}

Vector3l MatrixMoment(const Arm& arm, const RigidFrames& frames, int j,
                      long double more) {
  const ErrorTerms& errors = arm.errors;
  const int n = arm.num_joints();
  const Vector3l about = frames.on_axis[j].topRightCorner<3, 1>();
  Vector3l moment = Vector3l::Zero();
  const auto add = [&](const Matrix4l& frame, const Vector3l& in_frame,
                       long double mass) {
    const Vector3l place = (frame * in_frame.homogeneous()).head<3>();
    const Vector3l weight =
        mass * 9.80665L * errors.gravity.cast<long double>();
    moment += (place - about).cross(weight);
  };
  for (int k = j; k < n; ++k) {
    if (errors.links.empty()) {
      add(frames.after[k], Vector3l::Zero(), 1.0);
    } else {
      add(frames.after[k], errors.links[k].centre.cast<long double>(),
          errors.links[k].mass);
    }
  }
  Vector3l target = errors.load_target.cast<long double>();
  if (errors.load_geometry.size() == 0) {
    target.setZero();
    for (const Target& one : arm.targets) {
      target += one.last_from_target.translation().cast<long double>() /
                static_cast<long double>(arm.num_targets());
    }
  }
  add(frames.after[n - 1], target + errors.payload.centre.cast<long double>(),
      errors.payload.mass + more);
  return frames.after[j].topLeftCorner<3, 3>().transpose() * moment;
}

std::vector<MatrixJointError> MatrixErrors(const Arm& arm, const double* q,
                                           const double* covariates) {
  const ErrorTerms& errors = arm.errors;
  const int n = arm.num_joints();
  std::vector<MatrixJointError> all(n);
  if (errors.empty()) return all;
  const RigidFrames frames = RigidFramesOf(arm, q);
  long double more = 0.0L;
  for (std::size_t k = 0; covariates != nullptr && k < errors.covariates.size();
       ++k) {
    const CovariateEffect& effect = errors.covariates[k];
    more += (static_cast<long double>(covariates[k]) - effect.reference) *
            effect.payload;
  }
  for (int j = 0; j < n; ++j) {
    for (int k = 0; k < n && errors.coupling.size() > 0; ++k) {
      all[j].shift += static_cast<long double>(errors.coupling(j, k)) * q[k];
    }
    for (std::size_t k = 0; k < errors.covariates.size(); ++k) {
      const CovariateEffect& effect = errors.covariates[k];
      if (covariates == nullptr || effect.joints.size() == 0) continue;
      all[j].shift +=
          (static_cast<long double>(covariates[k]) - effect.reference) *
          effect.joints[j];
    }
    if (errors.joints.empty()) continue;
    const JointErrors& joint = errors.joints[j];
    all[j].shift += MatrixFunction(joint.function, q[j]);
    for (const Harmonic& harmonic : joint.harmonics) {
      const long double angle =
          static_cast<long double>(harmonic.cycles) * q[j];
      all[j].shift +=
          harmonic.cosine * std::cos(angle) + harmonic.sine * std::sin(angle);
    }
    const Vector3l moment = MatrixMoment(arm, frames, j, more);
    all[j].tilt_x = joint.compliance.x() * moment.x();
    all[j].tilt_y = joint.compliance.y() * moment.y();
    if (arm.joints[j].type == JointType::kPrismatic) continue;
    all[j].shift += joint.compliance.z() * moment.z() +
                    joint.backlash * moment.z() /
                        std::sqrt(moment.z() * moment.z() + 0.25L);
  }
  return all;
}

Matrix4l MotionBy(const Arm& arm, const double* covariates, bool of_base) {
  Eigen::Matrix<long double, 6, 1> u = Eigen::Matrix<long double, 6, 1>::Zero();
  for (std::size_t k = 0; k < arm.errors.covariates.size(); ++k) {
    const CovariateEffect& effect = arm.errors.covariates[k];
    if (covariates == nullptr) continue;
    u += (static_cast<long double>(covariates[k]) - effect.reference) *
         (of_base ? effect.base : effect.target).cast<long double>();
  }
  const auto angle = [&](int k) { return 2.0L * std::atan(0.5L * u[k]); };
  return Translation(u.head<3>()) * RotationX(angle(3)) * RotationY(angle(4)) *
         RotationZ(angle(5));
}

Matrix4l TiltMatrix(const MatrixJointError& error) {
  return RotationX(2.0L * std::atan(0.5L * error.tilt_x)) *
         RotationY(2.0L * std::atan(0.5L * error.tilt_y));
}

}  // namespace alidade::internal::testing
