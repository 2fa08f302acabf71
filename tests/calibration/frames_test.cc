#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "alidade/rotation.h"
#include "src/common/random.h"
#include "src/job/run_job.h"
#include "src/kernel/holdout.h"
#include "src/kernel/measurement_model.h"
#include "src/model/joint_draw.h"
#include "tests/support/classic_arms.h"
#include "tests/support/edit.h"

namespace alidade::internal::frames_test {
namespace {

constexpr double kSigma = 5e-5;

// A UR10 whose geometry is off by manufacturing tolerances, far from the
// instrument and turned by half a turn about a skew axis, with a target that
// nobody told of. The job knows the nominal arm alone.
JobConfig FarArmJob(int num_poses, double sigma) {
  JobConfig job;
  job.arm = testing::Ur10();
  job.arm.last_from_target() = Eigen::Isometry3d::Identity();
  const ParameterLayout layout(job.arm.num_joints());
  Random random(11);
  Arm real = job.arm;
  for (Joint& joint : real.joints) {
    joint.alpha += random.Uniform(-2e-3, 2e-3);
    joint.theta += random.Uniform(-2e-3, 2e-3);
    joint.d += random.Uniform(-5e-4, 5e-4);
    joint.r += random.Uniform(-5e-4, 5e-4);
  }
  real.instrument_from_base.linear() =
      RotationFromVector<double>(3.1 * Eigen::Vector3d(1, 2, -2) / 3.0);
  real.instrument_from_base.translation() << 4.0, -3.0, 1.0;
  real.last_from_target().translation() << 0.06, -0.08, 0.1;
  const MeasurementModel model(real);
  job.data.training.name = "simulated";
  job.data.training.joint_values = DrawJointValues(real, num_poses, 5);
  job.data.training.positions() =
      model.Predict(model.NominalValues(), job.data.training.joint_values);
  job.data.training.sigmas() = Eigen::MatrixXd::Constant(3, num_poses, kSigma);
  for (Eigen::Index i = 0; i < num_poses; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      testing::Edit(&job.data.training.positions()).at(axis, i) +=
          sigma * random.Normal();
    }
  }
  job.options.identifiability.candidates = {true, true, true};
  HoldOut split = HoldOutFraction(job.data.training, 0.3, 1);
  job.data.training = split.train;
  job.data.validation = split.validation;
  return job;
}

TEST(FramesTest, AreFoundMetresAndHalfATurnAway) {
  const CalibrationResult outcome = RunJob(FarArmJob(100, kSigma), "test");
  ASSERT_EQ(outcome.status, CalibrationStatus::kDone) << outcome.message;
  const CalibrationResult& result = outcome;
  EXPECT_FALSE(result.before_note.empty());
  // 4R + 2P + 3 = 27 for six revolute joints and a point.
  EXPECT_EQ(result.identifiability.num_free, 27);
  ASSERT_EQ(result.stages.size(), 3u);
  EXPECT_EQ(result.stages[0].num_free, 9);
  // Before, millimetres of geometry are left; after, noise: its norm in three
  // coordinates is 0.087 mm, and fitting 27 parameters to 210 equations adds
  // some 7 % on validation poses.
  EXPECT_GT(result.stages[0].validation.rms, 5e-4);
  EXPECT_LT(result.stages[0].validation.rms, 5e-3);
  EXPECT_LT(result.stages[1].validation.rms, result.stages[0].validation.rms);
  EXPECT_NEAR(result.validation->after.rms, 9.3e-5, 1.5e-5);
  EXPECT_EQ(result.validation->after.rms, result.stages[2].validation.rms);
  EXPECT_NEAR(result.reduced_chi_square, 1.0, 0.3);
  EXPECT_TRUE(result.outliers.empty());
}

// One joint alone moves, so that base and tool may slide along its axis and
// turn about it unseen. Stated where they are, they stay: the arm is as right
// at other poses as it was, but for what the noise of 40 poses moves.
TEST(FramesTest, StayWhereTheyAreStatedAlongWhatThePosesDoNotDetermine) {
  constexpr int kNumPoses = 40;
  JobConfig job;
  job.arm = testing::Ur10();
  const MeasurementModel model(job.arm);
  Eigen::MatrixXd joint_values(6, kNumPoses);
  for (int k = 0; k < kNumPoses; ++k) {
    joint_values.col(k) << -2.0 + 0.1 * k, -0.7, 0.9, 0.5, 0.6, 0.3;
  }
  Dataset& data = job.data.training;
  data.joint_values = joint_values;
  data.positions() = model.Predict(model.NominalValues(), data.joint_values);
  data.sigmas() = Eigen::MatrixXd::Constant(3, kNumPoses, kSigma);
  Random random(3);
  for (int k = 0; k < kNumPoses; ++k) {
    for (int axis = 0; axis < 3; ++axis) {
      testing::Edit(&data.positions()).at(axis, k) += kSigma * random.Normal();
    }
  }
  job.options.identifiability.candidates = {true, true, true};
  const Arm nominal = job.arm;
  const CalibrationResult result = RunJob(std::move(job), "test");
  ASSERT_TRUE(result.IsUsable()) << result.message;
  const Eigen::MatrixXd elsewhere = DrawJointValues(nominal, 100, 9);
  const MeasurementModel calibrated(result.arm);
  const Eigen::MatrixXd moved =
      calibrated.Predict(calibrated.NominalValues(), elsewhere) -
      model.Predict(model.NominalValues(), elsewhere);
  EXPECT_LT(moved.colwise().norm().mean(), 5e-4);
}

TEST(FramesTest, SigmaIsEstimatedFromTheResiduals) {
  JobConfig job = FarArmJob(200, 3e-5);
  job.options.estimate_sigma = true;
  const CalibrationResult outcome = RunJob(job, "test");
  ASSERT_EQ(outcome.status, CalibrationStatus::kDone) << outcome.message;
  // 420 equations less 27: the estimate's own standard deviation is 3.6 %.
  EXPECT_NEAR(outcome.estimated_sigma, 3e-5, 0.4e-5);
  EXPECT_NEAR(outcome.reduced_chi_square, 1.0, 0.05);
}

TEST(FramesTest, OutliersAreListedWithTheirWeight) {
  JobConfig job = FarArmJob(100, kSigma);
  job.options.loss = LossKind::kTukey;
  testing::Edit(&job.data.training.positions()).at(1, 7) += 4e-3;
  testing::Edit(&job.data.training.positions()).at(2, 30) -= 2e-3;
  const CalibrationResult outcome = RunJob(job, "test");
  ASSERT_EQ(outcome.status, CalibrationStatus::kDone) << outcome.message;
  const std::vector<Outlier>& outliers = outcome.outliers;
  // One of the clean observations may be beyond the limit by chance.
  ASSERT_GE(outliers.size(), 2u);
  EXPECT_LE(outliers.size(), 3u);
  EXPECT_EQ(outliers[0].observation, 7);
  EXPECT_EQ(outliers[1].observation, 30);
  EXPECT_NEAR(outliers[0].error, 4e-3, 0.3e-3);
  EXPECT_EQ(outliers[0].weight, 0.0);
  // 70 observations of 27 parameters leave the loss less than its asymptotic
  // efficiency; least squares is at 1.9e-4.
  EXPECT_NEAR(outcome.validation->after.rms, 1.05e-4, 2.5e-5);
}

TEST(FramesTest, ExactDataHaveNoSigmaToEstimate) {
  JobConfig job = FarArmJob(60, 0.0);
  job.options.estimate_sigma = true;
  job.options.identifiability.policy = WeakPolicy::kKeep;
  const CalibrationResult outcome = RunJob(job, "test");
  EXPECT_NE(outcome.status, CalibrationStatus::kDone);
  EXPECT_FALSE(outcome.message.empty());
}

TEST(FramesTest, AreFoundUnderEveryLossThoughResidualsAreManySigmas) {
  // At the nominal geometry residuals are some 40 sigmas: a loss that takes
  // sigma at its word would give all of them up.
  for (const LossKind loss :
       {LossKind::kHuber, LossKind::kCauchy, LossKind::kTukey}) {
    JobConfig job = FarArmJob(100, kSigma);
    job.options.loss = loss;
    const CalibrationResult outcome = RunJob(job, "test");
    ASSERT_EQ(outcome.status, CalibrationStatus::kDone) << outcome.message;
    const CalibrationResult& result = outcome;
    EXPECT_FALSE(result.before_note.empty());
    EXPECT_EQ(result.identifiability.num_free, 27);
    ASSERT_EQ(result.stages.size(), 3u);
    EXPECT_GT(result.stages[0].validation.rms, 5e-4);
    EXPECT_LT(result.stages[0].validation.rms, 5e-3);
    EXPECT_LT(result.stages[1].validation.rms, result.stages[0].validation.rms);
    // Of 9.3e-5 without a loss; losses cost some of the efficiency.
    EXPECT_NEAR(result.validation->after.rms, 1.0e-4, 2.5e-5);
  }
}

TEST(FramesTest, WhatTheModelLeavesIsAddedToStatedSigmas) {
  // Two fifths of the rows are said to be ten times as good as the others, and
  // all have the same noise besides, larger than both.
  constexpr double kNoise = 1e-4;
  JobConfig job = FarArmJob(300, kNoise);
  job.options.estimate_sigma = true;
  for (Eigen::Index i = 0; i < job.data.training.num_poses(); ++i) {
    testing::Edit(&job.data.training.sigmas())
        ->col(i)
        .setConstant(i % 5 < 2 ? 2e-6 : 2e-5);
  }
  const CalibrationResult outcome = RunJob(job, "test");
  ASSERT_EQ(outcome.status, CalibrationStatus::kDone) << outcome.message;
  // The median row: sqrt(2e-5^2 + v), where v is the noise's variance less
  // about that of the stated sigmas. Were sigmas scaled, the small ones would
  // rule and the median be 6e-4. The estimate's own deviation is 3 %.
  EXPECT_NEAR(outcome.estimated_sigma, kNoise, 0.1 * kNoise);
  EXPECT_NEAR(outcome.reduced_chi_square, 1.0, 0.05);
}

bool IsWarnedOf(const CalibrationResult& result, const std::string& words) {
  return std::any_of(result.warnings.begin(), result.warnings.end(),
                     [&](const std::string& warning) {
                       return warning.find(words) != std::string::npos;
                     });
}

TEST(FramesTest, TooFewPosesForASigmaLeaveParametersNearNominal) {
  JobConfig job = FarArmJob(100, kSigma);
  // 27 equations for 27 parameters.
  std::vector<Eigen::Index> few(9);
  std::iota(few.begin(), few.end(), Eigen::Index{0});
  job.data.training = SelectPoses(job.data.training, few);
  job.options.estimate_sigma = true;
  const CalibrationResult outcome = RunJob(job, "test");
  ASSERT_EQ(outcome.status, CalibrationStatus::kDone) << outcome.message;
  const CalibrationResult& result = outcome;
  EXPECT_TRUE(IsWarnedOf(result, "too few measurements to determine sigma"));
  // What the nominal geometry leaves: a millimetre or so, not the noise.
  EXPECT_GT(result.estimated_sigma, 2e-4);
  EXPECT_LT(result.estimated_sigma, 3e-3);
  EXPECT_LT(result.validation->after.rms, result.validation->before.rms);
}

TEST(FramesTest, LimitsOfHeldOutPosesHoldForFolds) {
  JobConfig job = FarArmJob(100, kSigma);
  job.data.validation.reset();
  job.options.folds = FoldsOptions{5, 1};
  job.options.acceptance.validation_max = 1e-3;
  EXPECT_EQ(RunJob(job, "test").status, CalibrationStatus::kDone);
  job.options.acceptance.validation_max = 1e-5;
  const CalibrationResult outcome = RunJob(job, "test");
  EXPECT_EQ(outcome.status, CalibrationStatus::kMissedLimits);
  EXPECT_NE(outcome.message.find("validation_max"), std::string::npos);
  ASSERT_EQ(outcome.acceptance.size(), 1u);
  EXPECT_EQ(outcome.acceptance[0].obtained,
            outcome.cross_validation->position.max);
}

}  // namespace
}  // namespace alidade::internal::frames_test
