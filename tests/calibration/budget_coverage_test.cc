// Whether expanded uncertainties hold: arms are drawn from their priors,
// measured with noise and calibrated, and their errors, by products of
// matrices, compared with the budget of each.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "alidade/calibration.h"
#include "src/common/random.h"
#include "src/model/joint_draw.h"
#include "tests/support/classic_arms.h"
#include "tests/support/matrix_kinematics.h"
#include "tests/support/noisy_positions.h"

namespace alidade::internal::budget_coverage_test {
namespace {

constexpr double kSigma = 5e-5;   // m
constexpr double kAngle = 2e-3;   // priors: rad
constexpr double kLength = 5e-4;  // m
constexpr int kPlaces = 80;

Arm DrawArm(Arm arm, Random* random) {
  for (Joint& joint : arm.joints) {
    joint.beta += kAngle * random->Normal();
    joint.alpha += kAngle * random->Normal();
    joint.theta += kAngle * random->Normal();
    joint.d += kLength * random->Normal();
    joint.r += kLength * random->Normal();
  }
  return arm;
}

CalibrationOptions Options() {
  CalibrationOptions options;
  PriorTolerances& priors = options.identifiability.priors;
  priors.alpha = priors.beta = priors.theta = kAngle;
  priors.d = priors.r = kLength;
  options.uncertainty.map_configurations = 0;
  options.uncertainty.region_configurations = kPlaces;
  return options;
}

// Parts of coordinates and of positions within their bounds, of the arm and of
// what is measured once more.
struct Held {
  double axes = 0.0;
  double positions = 0.0;
  double measured_axes = 0.0;
};

Held Simulate(int trials, bool estimates_sigma) {
  const Arm nominal = testing::Ur10();
  Held held;
  for (int trial = 0; trial < trials; ++trial) {
    Random random(100 + trial);
    const Arm real = DrawArm(nominal, &random);
    CalibrationOptions options = Options();
    options.estimate_sigma = estimates_sigma;
    CalibrationData data;
    data.training = testing::NoisyPositions(real, 60, kSigma, 500 + trial);
    const CalibrationResult result = Calibrate(nominal, data, options);
    EXPECT_TRUE(result.IsUsable()) << result.message;
    if (!result.uncertainty || !result.uncertainty->budget) return {};
    const UncertaintyBudget& budget = *result.uncertainty->budget;
    const Eigen::MatrixXd places = DrawJointValues(real, kPlaces, 9000 + trial);
    for (const auto& q : places.colwise()) {
      const Eigen::VectorXd joints = q;
      Eigen::Vector3d error =
          (testing::MatrixPosition(result.arm, joints.data()) -
           testing::MatrixPosition(real, joints.data()))
              .cast<double>();
      const double count = kPlaces * trials;
      const auto part_within = [&error, count](double bound) {
        return static_cast<double>((error.array().abs() <= bound).count()) /
               (3.0 * count);
      };
      held.axes += part_within(budget.position.expanded);
      if (error.norm() <= budget.position.expanded_distance) {
        held.positions += 1.0 / count;
      }
      for (double& x : error) x += kSigma * random.Normal();
      held.measured_axes += part_within(budget.measured.expanded);
    }
  }
  return held;
}

// The suite's few trials; ALIDADE_TRIALS=600 makes a study of two minutes.
int Trials() {
  const char* const wanted = std::getenv("ALIDADE_TRIALS");
  return wanted == nullptr ? 40 : std::atoi(wanted);
}

// Of one calibration about twenty errors are independent, so that the rate of
// forty is known to 0.8 %; three times that on both sides.
TEST(BudgetCoverageTest, ExpandedUncertaintyHoldsWithASigmaThatIsStated) {
  const int trials = Trials();
  const double tolerance = 0.024 * std::sqrt(40.0 / trials) + 0.003;
  const Held held = Simulate(trials, false);
  RecordProperty("axes", std::to_string(held.axes));
  EXPECT_NEAR(held.axes, 0.95, tolerance);
  EXPECT_NEAR(held.positions, 0.95, tolerance);
  EXPECT_NEAR(held.measured_axes, 0.95, tolerance);
}

// Without a stated sigma or repeats the noise of the residuals counts as the
// arm's: what is measured holds as stated, what the arm does more often.
TEST(BudgetCoverageTest, MeasuredPositionsHoldWithASigmaThatIsEstimated) {
  const int trials = Trials();
  const double tolerance = 0.024 * std::sqrt(40.0 / trials) + 0.003;
  const Held held = Simulate(trials, true);
  EXPECT_NEAR(held.measured_axes, 0.95, tolerance);
  EXPECT_GT(held.axes, 0.95);
}

}  // namespace
}  // namespace alidade::internal::budget_coverage_test
