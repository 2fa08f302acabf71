// Priors that hurt, and priors that the data find.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "src/calibration/evaluate.h"
#include "src/common/random.h"
#include "src/job/run_job.h"
#include "src/model/joint_draw.h"
#include "tests/calibration/kinds_util.h"

namespace alidade::internal::priors_test {
namespace {

constexpr int kPoses = 40;

// Lengths and angles off by these standard deviations.
Arm MadeWith(double angle, double length, std::uint64_t seed) {
  Arm arm = NominalArm();
  Random random(seed);
  for (Joint& joint : arm.joints) {
    joint.beta += angle * random.Normal();
    joint.alpha += angle * random.Normal();
    joint.theta += angle * random.Normal();
    joint.d += length * random.Normal();
    joint.r += length * random.Normal();
  }
  return arm;
}

CalibrationResult CalibrateWith(const Arm& real, PriorScale scale,
                                double angle_prior, double length_prior) {
  JobConfig job = WholeJobOf(
      Bench(real, DrawJointValues(real, kPoses, 5)).Positions(0).data());
  PriorTolerances& priors = job.options.identifiability.priors;
  priors.beta = priors.alpha = priors.theta = angle_prior;
  priors.d = priors.r = length_prior;
  job.options.prior_scale = scale;
  job.options.estimate_sigma = true;
  return RunJob(job, "test");
}

bool WarnsOfPriors(const CalibrationResult& result) {
  return std::any_of(result.warnings.begin(), result.warnings.end(),
                     [](const std::string& warning) {
                       return warning.find(" mrad pull") != std::string::npos;
                     });
}

TEST(PriorCheckTest, TooNarrowOnesAreNamed) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Arm real = MadeWith(3e-3, 2e-3, seed);
    EXPECT_TRUE(
        WarnsOfPriors(CalibrateWith(real, PriorScale::kGiven, 5e-5, 2e-5)))
        << seed;
  }
}

TEST(PriorCheckTest, RightOnesAreNot) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const Arm real = MadeWith(1e-3, 3e-4, seed);
    EXPECT_FALSE(
        WarnsOfPriors(CalibrateWith(real, PriorScale::kGiven, 1e-3, 3e-4)))
        << seed;
  }
}

// From priors that are thirty times too narrow or too wide. Some twenty
// parameters of which a third are lengths: their own spread leaves a factor of
// two.
TEST(PriorScaleTest, IsThatOfTheArm) {
  const Arm real = MadeWith(2e-3, 1e-3, 4);
  for (const double factor : {1.0 / 30.0, 1.0, 30.0}) {
    const CalibrationResult result = CalibrateWith(
        real, PriorScale::kEstimated, factor * 2e-3, factor * 1e-3);
    ASSERT_EQ(result.status, CalibrationStatus::kDone) << result.message;
    ASSERT_TRUE(result.prior_scaling);
    EXPECT_NEAR(std::log10(factor * result.prior_scaling->angle), 0.0, 0.4);
    EXPECT_NEAR(std::log10(factor * result.prior_scaling->length), 0.0, 0.4);
    EXPECT_FALSE(WarnsOfPriors(result));
    // Noise of 27 parameters alone leaves 0.05 mm sqrt(27 / 40).
    EXPECT_LT(CompareArms(result.arm, real, 500, 9).rms, 9e-5) << factor;
  }
}

TEST(PriorScaleTest, GivenPriorsStay) {
  const CalibrationResult result =
      CalibrateWith(MadeWith(2e-3, 1e-3, 4), PriorScale::kGiven, 5e-3, 1e-3);
  EXPECT_FALSE(result.prior_scaling);
}

}  // namespace
}  // namespace alidade::internal::priors_test
