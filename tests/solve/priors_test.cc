#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "src/identifiability/analysis.h"
#include "src/identifiability/rules.h"
#include "src/solve/solve.h"
#include "tests/solve/solvers_test_util.h"
#include "tests/support/study.h"

namespace alidade::internal {
namespace {

using Solver = SolverSummary (*)(const CalibrationProblem&,
                                 const SolverOptions&, Eigen::VectorXd*);

class PriorsTest : public ::testing::TestWithParam<Solver> {};

TEST_P(PriorsTest, GradientOfChiSquareAndPriorVanishesAtTheSolution) {
  const Arm arm = testing::Rv2ajWrist();
  const MeasurementModel model(arm);
  const Dataset data = testing::MeasureStudyPoses(arm, {5, 2e-5});
  const IdentifiabilityResult pass = AnalyzeIdentifiability(model, data, {});
  const CalibrationProblem problem{model, data, FreeColumns(pass),
                                   pass.nominal_rank, PriorsOf(pass)};
  Eigen::VectorXd values = model.NominalValues();
  const SolverSummary summary = GetParam()(problem, SolverOptions(), &values);
  ASSERT_TRUE(summary.IsSolutionUsable()) << summary.message;
  // An independent evaluation of cost and gradient: central differences of
  // chi-square by Errors(), and the priors by hand.
  const auto cost = [&](const Eigen::VectorXd& v) {
    double sum = ChiSquare(model.Errors(v, data), data);
    for (const int c : problem.free_columns) {
      sum += std::pow((v[c] - model.NominalValues()[c]) / problem.priors[c], 2);
    }
    return sum;
  };
  EXPECT_NEAR(summary.final_cost / cost(values), 1.0, 1e-12);
  const Eigen::VectorXd deviations = [&] {
    Eigen::VectorXd d(model.layout().size());
    for (int c = 0; c < d.size(); ++c) d[c] = pass.decisions[c].predicted_std;
    return d;
  }();
  for (const int c : problem.free_columns) {
    // A step of a hundredth of a standard deviation changes the cost by 1e-4
    // at a minimum, to either side alike.
    const double step = 0.01 * deviations[c];
    Eigen::VectorXd above = values;
    Eigen::VectorXd below = values;
    above[c] += step;
    below[c] -= step;
    const double slope = (cost(above) - cost(below)) / 2.0;
    EXPECT_NEAR(slope, 0.0, 1e-3 * 0.01) << model.layout().parameter(c).name;
  }
}

TEST_P(PriorsTest, TightPriorHoldsAParameterAndAWideOneDoesNothing) {
  const Arm arm = testing::Rv2ajFlange();
  const MeasurementModel model(arm);
  const Dataset data = testing::MeasureStudyPoses(arm, {5, 2e-5});
  const std::vector<int> free = testing::ColumnsOf(
      model.layout(), {"d2", "d3", "theta2", "theta3", "r1"});
  const int d3 = free[1];
  CalibrationProblem problem{model, data, {}, {}, {}};
  problem.free_columns = free;
  std::sort(problem.free_columns.begin(), problem.free_columns.end());
  Eigen::VectorXd without = model.NominalValues();
  ASSERT_TRUE(GetParam()(problem, {}, &without).IsSolutionUsable());
  problem.priors = Eigen::VectorXd::Constant(
      model.layout().size(), std::numeric_limits<double>::quiet_NaN());
  problem.priors[d3] = 1e-12;
  Eigen::VectorXd held = model.NominalValues();
  ASSERT_TRUE(GetParam()(problem, {}, &held).IsSolutionUsable());
  EXPECT_NEAR(held[d3], model.NominalValues()[d3], 1e-9);
  problem.priors[d3] = 1e3;
  Eigen::VectorXd wide = model.NominalValues();
  ASSERT_TRUE(GetParam()(problem, {}, &wide).IsSolutionUsable());
  // Residuals of the fixed parameters leave a cost of 1e6. Of that the last
  // step, 3e-10 long, gains less than rounding: it is accepted or not.
  EXPECT_NEAR((wide - without).cwiseAbs().maxCoeff(), 0.0, 1e-9);
}

// 15 equations and 18 priors for 18 parameters.
TEST_P(PriorsTest, FewPosesAreEnoughWithAPriorOnEveryParameter) {
  const testing::Calibration calibration =
      testing::NoisyFlangeCalibration(1, 5);
  CalibrationProblem problem = calibration.Problem();
  problem.priors =
      Eigen::VectorXd::Constant(calibration.model.layout().size(), 1e-3);
  Eigen::VectorXd values = calibration.model.NominalValues();
  const SolverSummary summary = GetParam()(problem, {}, &values);
  EXPECT_TRUE(summary.IsSolutionUsable()) << summary.message;
}

INSTANTIATE_TEST_SUITE_P(Both, PriorsTest,
                         ::testing::Values(&SolveLevenbergMarquardt,
                                           &SolvePseudoInverse));

// In the plane of the study the start has a direction less; priors on all
// parameters give it back to the first step.
TEST(PseudoInversePriorsTest, WithAPriorOnEveryParameterNoDirectionIsLeftOut) {
  const testing::Calibration calibration = testing::WristCalibration(5);
  CalibrationProblem problem = calibration.Problem();
  const auto free = static_cast<int>(problem.free_columns.size());
  ASSERT_LT(problem.start_rank.rank, free);
  problem.priors =
      Eigen::VectorXd::Constant(calibration.model.layout().size(), 1e-3);
  Eigen::VectorXd values = calibration.model.NominalValues();
  EXPECT_EQ(SolvePseudoInverse(problem, {}, &values).first_step_rank, free);
  // One without a prior, and the rank of the start counts.
  problem.priors[problem.free_columns.back()] = std::nan("");
  values = calibration.model.NominalValues();
  EXPECT_EQ(SolvePseudoInverse(problem, {}, &values).first_step_rank,
            problem.start_rank.rank);
}

// Whatever the singular values of the first step are.
TEST(PseudoInversePriorsTest, WithoutPriorsTheRankOfTheStartCounts) {
  testing::Calibration calibration = testing::NoisyFlangeCalibration(1, 40);
  calibration.start_rank.rank = 1;
  Eigen::VectorXd values = calibration.model.NominalValues();
  EXPECT_EQ(
      SolvePseudoInverse(calibration.Problem(), {}, &values).first_step_rank,
      1);
}

}  // namespace
}  // namespace alidade::internal
