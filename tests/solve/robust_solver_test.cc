#include <gtest/gtest.h>

#include <cmath>

#include "solvers_test_util.h"
#include "src/identifiability/rank.h"
#include "tests/support/edit.h"

namespace alidade::internal::robust_solver_test {
namespace {

using testing::Calibration;
using testing::NoisyFlangeCalibration;

constexpr int kPoses = 100;
constexpr int kOutliers = 10;

// The noisy flange arm with every tenth measurement wrong by 5 mm.
Calibration WithOutliers() {
  Calibration calibration = NoisyFlangeCalibration(3, kPoses);
  for (int k = 0; k < kOutliers; ++k) {
    testing::Edit(&calibration.data.positions()).at(k % 3, 10 * k) += 5e-3;
  }
  return calibration;
}

// Root mean square error at the poses against the clean measurements (m).
double RmsAgainst(const Calibration& calibration, const Dataset& clean,
                  const Eigen::VectorXd& values) {
  const SharedVector errors = calibration.model.Errors(values, clean);
  return std::sqrt(LengthErrors(errors, clean).map().array().square().mean());
}

struct Outcome {
  SolverSummary summary;
  Eigen::VectorXd values;
};

Outcome Solve(const Calibration& calibration, LossKind loss) {
  Outcome outcome;
  outcome.values = calibration.model.NominalValues();
  outcome.summary = SolveRobust(calibration.Problem(), loss, SolverOptions(),
                                &outcome.values);
  return outcome;
}

TEST(SolveRobustTest, WithoutALossIsSolveLevenbergMarquardtToTheBit) {
  const Calibration calibration = NoisyFlangeCalibration(3, kPoses);
  const Outcome robust = Solve(calibration, LossKind::kNone);
  Eigen::VectorXd values = calibration.model.NominalValues();
  SolveLevenbergMarquardt(calibration.Problem(), SolverOptions(), &values);
  EXPECT_EQ(robust.values, values);
}

// 0.02 mm of noise in each coordinate and 18 parameters from 300 equations
// leave 0.035 mm against the measurements. Least squares is carried away by
// 10 % of outliers of 5 mm; the losses are not.
TEST(SolveRobustTest, OutliersCarryLeastSquaresAwayAndNoRobustLoss) {
  const Dataset clean = NoisyFlangeCalibration(3, kPoses).data;
  const Calibration calibration = WithOutliers();
  const Outcome plain = Solve(calibration, LossKind::kNone);
  EXPECT_GT(RmsAgainst(calibration, clean, plain.values), 2e-4);
  for (const LossKind loss :
       {LossKind::kHuber, LossKind::kCauchy, LossKind::kTukey}) {
    SCOPED_TRACE(static_cast<int>(loss));
    const Outcome robust = Solve(calibration, loss);
    ASSERT_TRUE(robust.summary.IsSolutionUsable()) << robust.summary.message;
    EXPECT_NEAR(RmsAgainst(calibration, clean, robust.values), 3.4e-5, 0.5e-5);
  }
}

// At the minimum of sum rho(s) the gradient 2 sum rho'(s) J^T r vanishes; an
// independent check by central differences of the cost.
TEST(SolveRobustTest, EndsAtAMinimumOfTheRobustCost) {
  const Calibration calibration = WithOutliers();
  const Outcome robust = Solve(calibration, LossKind::kTukey);
  const RobustLoss loss{LossKind::kTukey, TuningConstant(LossKind::kTukey, 3)};
  const auto cost = [&](const Eigen::VectorXd& values) {
    double sum = 0.0;
    for (const double s :
         SquaredNorms(calibration.model.Errors(values, calibration.data),
                      calibration.data)
             .map()
             .eval()) {
      double rho[3];
      loss.Evaluate(s, rho);
      sum += rho[0];
    }
    return sum;
  };
  const double at_minimum = cost(robust.values);
  EXPECT_NEAR(robust.summary.final_cost, at_minimum, 1e-9 * at_minimum);
  for (const int column : calibration.free_columns) {
    for (const double step : {-1e-5, 1e-5}) {
      Eigen::VectorXd moved = robust.values;
      moved[column] += step;
      EXPECT_GT(cost(moved), at_minimum);
    }
  }
}

TEST(SolveRobustTest, CountsTheIterationsOfAllStages) {
  const Outcome robust = Solve(WithOutliers(), LossKind::kTukey);
  const auto& iterations = robust.summary.iterations;
  for (std::size_t i = 0; i < iterations.size(); ++i) {
    EXPECT_EQ(iterations[i].iteration, static_cast<int>(i));
    if (i > 0) {
      EXPECT_GE(iterations[i].time_s, iterations[i - 1].time_s);
    }
  }
  // One entry is for the start, none for where a further stage begins: the
  // number of the last one is the number of steps that people are told.
  EXPECT_EQ(static_cast<int>(iterations.size()),
            robust.summary.accepted_steps + robust.summary.rejected_steps + 1);
}

TEST(SolveRobustTest, GivingUpNearlyAllObservationsIsAFailure) {
  Calibration calibration = NoisyFlangeCalibration(3, kPoses);
  // A thousandth of the noise that is there: all residuals are outliers.
  *testing::Edit(&calibration.data.sigmas()) *= 1e-3;
  const Outcome robust = Solve(calibration, LossKind::kTukey);
  EXPECT_EQ(robust.summary.status, SolverStatus::kFailed);
  EXPECT_NE(robust.summary.message.find("gives up nearly all"),
            std::string::npos)
      << robust.summary.message;
  EXPECT_EQ(robust.values, calibration.model.NominalValues());
}

// Nine of sixty poses are right: their 27 equations would do for 18 parameters,
// but are less than a fifth of all.
TEST(SolveRobustTest, ASolutionOfLessThanAFifthOfTheDataIsAFailure) {
  Calibration calibration = NoisyFlangeCalibration(3, 60);
  for (int i = 9; i < 60; ++i) {
    testing::Edit(&calibration.data.positions()).at(i % 3, i) += 0.1 + 0.01 * i;
  }
  Eigen::VectorXd values = calibration.model.NominalValues();
  const SolverSummary summary =
      SolveRobust(calibration.Problem(), LossKind::kTukey, SolverOptions(),
                  &values, calibration.true_values);
  EXPECT_EQ(summary.status, SolverStatus::kFailed);
  EXPECT_NE(summary.message.find("gives up nearly all"), std::string::npos)
      << summary.message;
  EXPECT_EQ(values, calibration.model.NominalValues());
}

TEST(SolvePseudoInverseTest, RefusesARobustLoss) {
  const Calibration calibration = NoisyFlangeCalibration(3, kPoses);
  CalibrationProblem problem = calibration.Problem();
  problem.losses = TunedLosses(LossKind::kHuber);
  Eigen::VectorXd values = calibration.model.NominalValues();
  const SolverSummary summary =
      SolvePseudoInverse(problem, SolverOptions(), &values);
  EXPECT_EQ(summary.status, SolverStatus::kUnusable);
  EXPECT_EQ(values, calibration.model.NominalValues());
}

}  // namespace
}  // namespace alidade::internal::robust_solver_test
