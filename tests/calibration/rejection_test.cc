// Results that no arm is to be used with.

#include <gtest/gtest.h>

#include <string>

#include "src/common/random.h"
#include "src/job/run_job.h"
#include "src/model/joint_draw.h"
#include "tests/calibration/kinds_util.h"

namespace alidade::internal::rejection_test {
namespace {

// Positions that no arm measures: an estimated sigma explains any residual, but
// half a metre is no accuracy.
TEST(RejectionTest, PositionsOfNoArmAreRejectedWithSigmaEstimated) {
  JobConfig job;
  job.arm = NominalArm();
  job.data.training =
      Bench(RealArm(), DrawJointValues(RealArm(), 60, 5)).Positions(0).data();
  Random random(8);
  Eigen::MatrixXd points(3, 60);
  for (double& coordinate : points.reshaped()) {
    coordinate = random.Uniform(-0.5, 0.5);
  }
  job.data.training.positions() = points;
  job.options.identifiability.candidates = {true, true, true};
  job.options.estimate_sigma = true;
  const CalibrationResult result = RunJob(job, "test");
  EXPECT_TRUE(result.IsRejected());
  EXPECT_NE(result.message.find("the data do not fit this arm"),
            std::string::npos)
      << result.FullReport();
}

// Links that are a fifth longer fit nowhere, and wide priors let the fit find
// them. Joints that are not where their values say stay: half of the errors are
// then above 13 mm and above 3 mm, and half a percent of the reach is 9 mm.
TEST(RejectionTest, WhatFitsNowhereIsAnotherArmUnlessTheFitFindsIt) {
  for (const double wave : {0.02, 0.004}) {
    JobConfig job;
    job.arm = NominalArm();
    for (Joint& joint : job.arm.joints) joint.d *= 1.2;
    Arm other = RealArm();
    other.errors.joints.resize(other.joints.size());
    for (JointErrors& joint : other.errors.joints) {
      joint.harmonics = {{2.0, wave, 0.0}};
    }
    job.data.training =
        Bench(other, DrawJointValues(other, 60, 5)).Positions(0).data();
    job.options.identifiability.candidates = {true, true, true};
    job.options.identifiability.priors.d = 0.2;
    job.options.estimate_sigma = true;
    const CalibrationResult result = RunJob(job, "test");
    ASSERT_EQ(result.plausibility.size(), 1U) << wave;
    EXPECT_EQ(result.IsRejected(), wave > 0.01) << result.FullReport();
  }
}

// One wrong position in 42: the solver wanders until it is stopped, and what it
// ends with is further off elsewhere.
TEST(RejectionTest, AStoppedSolverIsAFailure) {
  const Arm real = RealArm();
  const Eigen::MatrixXd q = DrawJointValues(real, 60, 5);
  JobConfig job = JobOf(Bench(real, q).Positions(0).data());
  EXPECT_EQ(RunJob(job, "test").status, CalibrationStatus::kDone);
  testing::Edit(&job.data.training.positions())->col(3).setZero();
  const CalibrationResult outcome = RunJob(job, "test");
  EXPECT_EQ(outcome.runs[0].summary.status, SolverStatus::kIterationLimit);
  EXPECT_EQ(outcome.status, CalibrationStatus::kFailed);
  EXPECT_NE(outcome.message.find("before it converged"), std::string::npos)
      << outcome.message;
}

}  // namespace
}  // namespace alidade::internal::rejection_test
