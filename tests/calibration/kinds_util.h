#ifndef ALIDADE_TESTS_CALIBRATION_KINDS_UTIL_H_
#define ALIDADE_TESTS_CALIBRATION_KINDS_UTIL_H_

// An arm whose geometry is off by manufacturing tolerances, measured with noise
// in every kind of way, and the jobs that know the nominal arm alone.

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "alidade/forward_kinematics.h"
#include "alidade/inverse_kinematics.h"
#include "alidade/rotation.h"
#include "src/common/random.h"
#include "src/job/run_job.h"
#include "src/kernel/holdout.h"
#include "src/kernel/measurement_model.h"
#include "src/model/joint_draw.h"
#include "tests/support/classic_arms.h"
#include "tests/support/edit.h"

namespace alidade::internal {

constexpr double kSigma = 5e-5;          // m
constexpr double kRotationSigma = 3e-4;  // rad

inline Arm NominalArm() {
  Arm arm = testing::Ur10();
  arm.last_from_target() = Eigen::Isometry3d::Identity();
  return arm;
}

// Off by tolerances, half a turn and metres away, its target turned.
inline Arm RealArm() {
  Arm real = NominalArm();
  Random random(11);
  for (Joint& joint : real.joints) {
    joint.alpha += random.Uniform(-2e-3, 2e-3);
    joint.theta += random.Uniform(-2e-3, 2e-3);
    joint.d += random.Uniform(-5e-4, 5e-4);
    joint.r += random.Uniform(-5e-4, 5e-4);
  }
  real.instrument_from_base.linear() =
      RotationFromVector<double>(3.1 * Eigen::Vector3d(1, 2, -2) / 3.0);
  real.instrument_from_base.translation() << 4.0, -3.0, 1.0;
  real.last_from_target().linear() =
      RotationFromVector<double>(Eigen::Vector3d(0.4, 2.0, -0.9));
  real.last_from_target().translation() << 0.06, -0.08, 0.1;
  return real;
}

// Adds to `data` what `real` shows at its poses, a block of one kind, with
// Gaussian noise.
class Bench {
 public:
  Bench(Arm real, const Eigen::MatrixXd& joint_values)
      : real_(std::move(real)), random_(5) {
    data_.name = "simulated";
    data_.joint_values = joint_values;
  }

  Bench& Positions(int target) {
    ObservationBlock block = Block(MeasurementKind::kPosition);
    block.targets.assign(data_.num_poses(), target);
    for (Eigen::Index i = 0; i < block.size(); ++i) {
      testing::Edit(&block.measured)->col(i) =
          Position(i, target) + Noise(kSigma);
    }
    return Append(std::move(block));
  }

  Bench& Poses() {
    ObservationBlock block = Block(MeasurementKind::kPose);
    testing::Edit(&block.sigmas)->bottomRows<3>().setConstant(kRotationSigma);
    for (Eigen::Index i = 0; i < block.size(); ++i) {
      Eigen::Matrix3d rotation;
      testing::Edit(&block.measured)->col(i).head<3>() =
          Pose(i, 0, &rotation) + Noise(kSigma);
      testing::Edit(&block.measured)->col(i).tail<3>() =
          VectorFromRotation<double>(
              RotationFromVector<double>(Noise(kRotationSigma)) * rotation);
    }
    return Append(std::move(block));
  }

  Bench& Distances(int point, const Eigen::Vector3d& anchor) {
    ObservationBlock block = Block(MeasurementKind::kDistance);
    block.references.assign(data_.num_poses(), point);
    for (Eigen::Index i = 0; i < block.size(); ++i) {
      testing::Edit(&block.measured).at(0, i) =
          (Position(i, 0) - anchor).norm() + kSigma * random_.Normal();
    }
    return Append(std::move(block));
  }

  Bench& Differences() {
    ObservationBlock block = Block(MeasurementKind::kDifference);
    const auto count = static_cast<int>(data_.num_poses());
    for (int i = 0; i < count; ++i) {
      block.seconds.push_back((i + 1) % count);
      testing::Edit(&block.measured)->col(i) =
          Position(i, 0) - Position((i + 1) % count, 0) + Noise(kSigma);
    }
    return Append(std::move(block));
  }

  Bench& Contacts(MeasurementKind kind, const std::vector<int>& references) {
    ObservationBlock block = Block(kind);
    block.references = references;
    return Append(std::move(block));
  }

  Bench& Append(ObservationBlock block) {
    data_.blocks.push_back(std::move(block));
    return *this;
  }

  Dataset& data() { return data_; }

 private:
  ObservationBlock Block(MeasurementKind kind) const {
    ObservationBlock block;
    block.kind = kind;
    for (int i = 0; i < data_.num_poses(); ++i) block.poses.push_back(i);
    block.measured = Eigen::MatrixXd::Zero(RowsOf(kind), data_.num_poses());
    block.sigmas =
        Eigen::MatrixXd::Constant(RowsOf(kind), data_.num_poses(), kSigma);
    return block;
  }

  Eigen::Vector3d Noise(double sigma) {
    const double x = sigma * random_.Normal();
    const double y = sigma * random_.Normal();
    return {x, y, sigma * random_.Normal()};
  }

  Eigen::Vector3d Pose(Eigen::Index i, int target,
                       Eigen::Matrix3d* rotation) const {
    const ParameterLayout layout(real_);
    const Eigen::VectorXd values = layout.Values(real_);
    return TargetPose<double>(real_, ViewOf(layout, values.data(), target),
                              data_.joint_values.col(i).data(), rotation);
  }

  Eigen::Vector3d Position(Eigen::Index i, int target) const {
    Eigen::Matrix3d rotation;
    return Pose(i, target, &rotation);
  }

  Arm real_;
  Random random_;
  Dataset data_;
};

// All of the data are fitted.
inline JobConfig WholeJobOf(const Dataset& data) {
  JobConfig job;
  job.arm = NominalArm();
  job.data.training = data;
  job.options.identifiability.candidates = {true, true, true};
  return job;
}

inline JobConfig JobOf(const Dataset& data) {
  JobConfig job = WholeJobOf(data);
  HoldOut split = HoldOutFraction(job.data.training, 0.3, 1);
  job.data.training = split.train;
  job.data.validation = split.validation;
  return job;
}

}  // namespace alidade::internal

#endif  // ALIDADE_TESTS_CALIBRATION_KINDS_UTIL_H_
