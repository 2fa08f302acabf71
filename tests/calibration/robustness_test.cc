// Calibrations that start from an arm that is hard: calibrated before, a
// joint's zero degrees off, sigmas that are far from right.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "src/calibration/evaluate.h"
#include "src/job/run_job.h"
#include "src/model/joint_draw.h"
#include "tests/calibration/kinds_util.h"

namespace alidade::internal::robustness_test {
namespace {

constexpr int kPoses = 60;

// What Calibrate finds of `real`, measured with noise, starting from `nominal`.
CalibrationResult CalibrateFrom(const Arm& nominal, const Arm& real,
                                bool estimate_sigma, double stated = kSigma) {
  JobConfig job;
  job.arm = nominal;
  job.data.training =
      Bench(real, DrawJointValues(real, kPoses, 5)).Positions(0).data();
  job.data.training.sigmas() =
      Eigen::MatrixXd::Constant(3, kPoses, stated).eval();
  job.options.identifiability.candidates = {true, true, true};
  job.options.estimate_sigma = estimate_sigma;
  return RunJob(job, "test");
}

// RMS distance to the real arm over the workspace.
double TrueError(const Arm& found, const Arm& real) {
  return CompareArms(found, real, 500, 9).rms;
}

// 27 parameters of 180 equations of 0.05 mm each: the expected RMS error is
// sigma sqrt(27 / 60), 0.034 mm; twice as much is beyond what chance allows.
constexpr double kGood = 7e-5;

// The axes of joints 2 to 4 of a calibrated UR10 are some mrad from parallel:
// next year's calibration starts there.
TEST(RecalibrationTest, ACalibratedArmIsAsGoodANominal) {
  const Arm real = RealArm();
  const CalibrationResult first = CalibrateFrom(NominalArm(), real, false);
  ASSERT_EQ(first.status, CalibrationStatus::kDone) << first.message;
  EXPECT_LT(TrueError(first.arm, real), kGood);
  for (const double size : {1e-6, 1e-5, 1e-4, 1e-3, 1e-2}) {
    Arm nominal = first.arm;
    Arm next = real;
    for (int j = 1; j < 4; ++j) {
      const double sign = j % 2 == 0 ? 1.0 : -1.0;
      nominal.joints[j].alpha += sign * size;
      next.joints[j].alpha += sign * size + 1e-3;
    }
    const CalibrationResult second = CalibrateFrom(nominal, next, false);
    ASSERT_EQ(second.status, CalibrationStatus::kDone)
        << size << ": " << second.message;
    EXPECT_LT(TrueError(second.arm, next), kGood) << size;
    EXPECT_LE(second.runs[0].summary.iterations.back().iteration, 20);
    for (const ParameterResult& parameter : second.parameters) {
      if (parameter.dimension != Dimension::kLength) continue;
      const bool is_frame =
          parameter.kind == "base" || parameter.kind == "tool";
      EXPECT_LT(std::abs(parameter.deviation()), is_frame ? 0.05 : 5e-3)
          << size << " " << parameter.name;
    }
  }
}

class ZeroOffTest : public ::testing::TestWithParam<int> {};

// With sigma estimated, priors of 5 mrad would hold the arm at its nominal
// zeros as well: the posterior has two maxima.
TEST_P(ZeroOffTest, IsFoundWithSigmaEstimated) {
  for (const double degrees : {5.0, -10.0, 20.0}) {
    Arm real = RealArm();
    real.joints[GetParam()].theta += degrees * kDegree;
    const CalibrationResult result = CalibrateFrom(NominalArm(), real, true);
    ASSERT_EQ(result.status, CalibrationStatus::kDone) << result.message;
    EXPECT_LT(TrueError(result.arm, real), kGood) << degrees;
    // Of 153 degrees of freedom: 6 % is one standard deviation.
    EXPECT_NEAR(result.estimated_sigma / kSigma, 1.0, 0.25) << degrees;
  }
}

INSTANTIATE_TEST_SUITE_P(Joints, ZeroOffTest, ::testing::Values(1, 2, 3, 4));

TEST(SigmaTest, FarTooLargeIsWarnedOf) {
  const Arm real = RealArm();
  for (const double factor : {30.0, 1e3, 1e6}) {
    const CalibrationResult result =
        CalibrateFrom(NominalArm(), real, false, factor * kSigma);
    EXPECT_TRUE(std::any_of(result.warnings.begin(), result.warnings.end(),
                            [](const std::string& warning) {
                              return warning.find(
                                         "times as large as the "
                                         "residuals") != std::string::npos;
                            }))
        << factor;
  }
}

}  // namespace
}  // namespace alidade::internal::robustness_test
