#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <string>
#include <tuple>
#include <vector>

#include "src/common/random.h"
#include "src/solve/solve.h"
#include "tests/solve/solvers_test_util.h"
#include "tests/support/random_arms.h"
#include "tests/support/random_datasets.h"
#include "tests/support/reference_solution.h"
#include "tests/support/study.h"

namespace alidade::internal {
namespace {

using testing::Calibration;
using testing::Difference;
using testing::SolverCase;

class RandomArmSolverTest
    : public ::testing::TestWithParam<std::tuple<SolverCase, int>> {
 protected:
  const SolverCase& solver() const { return std::get<0>(GetParam()); }
  int num_joints() const { return std::get<1>(GetParam()); }
};

std::string NameOfRandomArm(
    const ::testing::TestParamInfo<RandomArmSolverTest::ParamType>& info) {
  return std::get<0>(info.param).name + std::to_string(std::get<1>(info.param));
}

TEST_P(RandomArmSolverTest, ReachesTheExactMinimumAndStopsAtTheFloor) {
  for (int draw = 0; draw < 4; ++draw) {
    SCOPED_TRACE(draw);
    const Calibration calibration =
        testing::RandomCalibration(num_joints(), draw, 5e-3);
    const Eigen::VectorXd nominal = calibration.model.NominalValues();
    Eigen::VectorXd values = nominal;
    const SolverSummary summary = calibration.Solve(solver(), &values);
    EXPECT_EQ(summary.status, SolverStatus::kPrecisionLimit) << summary.message;
    EXPECT_TRUE(
        testing::HoldsTheOthers(nominal, values, calibration.free_columns));
    const testing::ReferenceSolution reference = calibration.Reference();
    ASSERT_TRUE(reference.converged);
    const Difference difference = testing::DifferenceOf(
        calibration.model.layout(), values, reference.values);
    EXPECT_LT(difference.length, 1e-8 * kMillimetre);
    EXPECT_LT(difference.angle, 1e-8);
    // Exact data: the minimum is the truth, up to the rounding of positions.
    EXPECT_LT((values - calibration.true_values).cwiseAbs().maxCoeff(), 1e-11);
  }
}

// Uneven sigmas and a minimum that is not zero: the solution is that of the
// whitened residuals.
TEST_P(RandomArmSolverTest, FindsTheMinimumOfNoisyData) {
  Calibration calibration = testing::RandomCalibration(num_joints(), 7, 5e-3);
  Random random(31, num_joints());
  testing::AddNoise(&random, &calibration.data);
  Eigen::VectorXd values = calibration.model.NominalValues();
  const SolverSummary summary = calibration.Solve(solver(), &values);
  EXPECT_TRUE(summary.IsSolutionUsable()) << summary.message;
  const testing::ReferenceSolution reference = calibration.Reference();
  ASSERT_TRUE(reference.converged);
  for (std::size_t k = 0; k < calibration.free_columns.size(); ++k) {
    const int column = calibration.free_columns[k];
    const auto off =
        static_cast<double>(values[column] - reference.values[column]);
    const auto stddev = static_cast<double>(reference.stddevs[k]);
    // Where a step predicts 1e-15 of a cost of some 160, the rest of the way is
    // below the root of that, 4e-7 standard deviations.
    EXPECT_LT(std::abs(off), 1e-6 * stddev)
        << calibration.model.layout().parameter(column).name;
  }
  const auto cost = static_cast<double>(reference.cost);
  EXPECT_NEAR(summary.final_cost, cost, 1e-10 * cost);
}

// Eight joints are past the cost functions of a fixed size.
INSTANTIATE_TEST_SUITE_P(
    SolversAndJoints, RandomArmSolverTest,
    ::testing::Combine(::testing::Values(testing::kCeres,
                                         testing::kPseudoInverse),
                       ::testing::Range(3, 9)),
    NameOfRandomArm);

class SolverTest : public ::testing::TestWithParam<SolverCase> {};

// Chi-square has 3 N - p degrees of freedom f, mean f and variance 2 f.
TEST_P(SolverTest, CostOfNoiseIsChiSquare) {
  constexpr int kTrials = 30;
  constexpr int kPoses = 100;
  constexpr double kDegreesOfFreedom = 3.0 * kPoses - 18.0;
  double sum = 0.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Calibration calibration =
        testing::NoisyFlangeCalibration(trial, kPoses);
    Eigen::VectorXd values = calibration.model.NominalValues();
    const SolverSummary summary = calibration.Solve(GetParam(), &values);
    EXPECT_TRUE(summary.IsSolutionUsable()) << summary.message;
    // Five standard deviations of one trial.
    EXPECT_NEAR(summary.final_cost, kDegreesOfFreedom,
                5.0 * std::sqrt(2.0 * kDegreesOfFreedom));
    sum += summary.final_cost;
  }
  // Four of the mean: about 1 % of f.
  EXPECT_NEAR(sum / kTrials, kDegreesOfFreedom,
              4.0 * std::sqrt(2.0 * kDegreesOfFreedom / kTrials));
}

// Each parameter is within five of its standard deviations of the truth, and,
// over all of them and all trials, their root mean square is one.
TEST_P(SolverTest, ErrorsOfNoisyDataAreThoseOfTheCovariance) {
  constexpr int kTrials = 10;
  double sum = 0.0;
  int count = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Calibration calibration =
        testing::NoisyFlangeCalibration(100 + trial, 100);
    Eigen::VectorXd values = calibration.model.NominalValues();
    calibration.Solve(GetParam(), &values);
    const testing::ReferenceSolution reference = calibration.Reference();
    for (std::size_t k = 0; k < calibration.free_columns.size(); ++k) {
      const int column = calibration.free_columns[k];
      const double deviations =
          (values[column] - calibration.true_values[column]) /
          static_cast<double>(reference.stddevs[k]);
      EXPECT_LT(std::abs(deviations), 5.0);
      sum += deviations * deviations;
      ++count;
    }
  }
  // Correlated, so that the 180 values are worth fewer: at least ten trials'
  // mean of one, whose standard deviation is below sqrt(2 / 10) = 0.45.
  EXPECT_NEAR(sum / count, 1.0, 0.9);
}

// The base a few millimetres and milliradians off, the tool too.
TEST_P(SolverTest, RecoversBaseAndTool) {
  for (int draw = 0; draw < 5; ++draw) {
    SCOPED_TRACE(draw);
    Random random(71, draw);
    Calibration calibration(testing::RandomArm(4, &random));
    const ParameterLayout& layout = calibration.model.layout();
    calibration.free_columns = testing::ColumnsOf(
        layout, {"base_x", "base_y", "base_z", "base_rx", "base_ry", "base_rz",
                 "tool_x", "tool_y", "tool_z"});
    for (const int column : calibration.free_columns) {
      calibration.true_values[column] += random.Uniform(-5e-3, 5e-3);
    }
    const Arm& arm = calibration.model.nominal();
    calibration.data =
        testing::RandomDataset(arm, calibration.true_values, 40, &random);
    ASSERT_GT(testing::RelativeSingularValues(
                  testing::ScaledDifferences(arm, testing::MatrixValues(arm),
                                             calibration.data,
                                             calibration.free_columns))
                  .minCoeff(),
              1e-3L);
    const Eigen::VectorXd nominal = calibration.model.NominalValues();
    Eigen::VectorXd values = nominal;
    const SolverSummary summary = calibration.Solve(GetParam(), &values);
    EXPECT_EQ(summary.status, SolverStatus::kPrecisionLimit) << summary.message;
    EXPECT_TRUE(
        testing::HoldsTheOthers(nominal, values, calibration.free_columns));
    const Difference difference = testing::DifferenceOf(
        layout, values, calibration.true_values.cast<long double>());
    EXPECT_LT(difference.length, 1e-8 * kMillimetre);
    EXPECT_LT(difference.angle, 1e-8);
  }
}

// Frames beside joints, and some of a frame's six held.
TEST_P(SolverTest, RecoversPartsOfFramesBesideJoints) {
  Random random(72);
  Calibration calibration(testing::RandomArm(3, &random));
  const ParameterLayout& layout = calibration.model.layout();
  calibration.free_columns =
      testing::ColumnsOf(layout, {"alpha2", "d3", "base_y", "base_rz"});
  for (const int column : calibration.free_columns) {
    calibration.true_values[column] += random.Uniform(-5e-3, 5e-3);
  }
  calibration.data = testing::RandomDataset(
      calibration.model.nominal(), calibration.true_values, 40, &random);
  const Eigen::VectorXd nominal = calibration.model.NominalValues();
  Eigen::VectorXd values = nominal;
  const SolverSummary summary = calibration.Solve(GetParam(), &values);
  EXPECT_EQ(summary.status, SolverStatus::kPrecisionLimit) << summary.message;
  EXPECT_TRUE(
      testing::HoldsTheOthers(nominal, values, calibration.free_columns));
  EXPECT_LT((values - calibration.true_values).cwiseAbs().maxCoeff(), 1e-11);
}

TEST_P(SolverTest, GivesTheSameBitsTwiceAndWithAnyNumberOfThreads) {
  // More poses than a thread takes at once.
  constexpr int kPoses = 700;
  Eigen::VectorXd expected;
  std::vector<IterationRecord> iterations;
  for (const int num_threads : {1, 1, 2, 8}) {
    SCOPED_TRACE(num_threads);
    const Calibration calibration =
        testing::NoisyFlangeCalibration(3, kPoses, num_threads);
    SolverOptions options;
    options.num_threads = num_threads;
    Eigen::VectorXd values = calibration.model.NominalValues();
    const SolverSummary summary =
        calibration.Solve(GetParam(), &values, options);
    ASSERT_TRUE(summary.IsSolutionUsable());
    if (expected.size() == 0) {
      expected = values;
      iterations = summary.iterations;
    }
    EXPECT_TRUE(testing::SameBits(values, expected));
    ASSERT_EQ(summary.iterations.size(), iterations.size());
    for (std::size_t k = 0; k < iterations.size(); ++k) {
      EXPECT_EQ(summary.iterations[k].cost, iterations[k].cost);
      EXPECT_EQ(summary.iterations[k].max_error, iterations[k].max_error);
      EXPECT_EQ(summary.iterations[k].step_norm, iterations[k].step_norm);
      EXPECT_EQ(summary.iterations[k].accepted, iterations[k].accepted);
    }
  }
}

// Without a rank, all parameters count.
TEST_P(SolverTest, TakesAnEmptyRankAsFull) {
  Calibration calibration = testing::RandomCalibration(4, 0, 5e-3);
  calibration.start_rank = RankReport();
  Eigen::VectorXd values = calibration.model.NominalValues();
  const SolverSummary summary = calibration.Solve(GetParam(), &values);
  EXPECT_EQ(summary.status, SolverStatus::kPrecisionLimit) << summary.message;
  EXPECT_LT((values - calibration.true_values).cwiseAbs().maxCoeff(), 1e-11);
}

INSTANTIATE_TEST_SUITE_P(Solvers, SolverTest,
                         ::testing::Values(testing::kCeres,
                                           testing::kPseudoInverse),
                         testing::NameOfSolver);

TEST(SolversTest, AgreeOnNoisyData) {
  for (int trial = 0; trial < 5; ++trial) {
    const Calibration calibration = testing::NoisyFlangeCalibration(trial, 60);
    Eigen::VectorXd of_ceres = calibration.model.NominalValues();
    Eigen::VectorXd of_baseline = of_ceres;
    const double ceres_cost =
        calibration.Solve(testing::kCeres, &of_ceres).final_cost;
    const double baseline_cost =
        calibration.Solve(testing::kPseudoInverse, &of_baseline).final_cost;
    EXPECT_NEAR(ceres_cost, baseline_cost, 1e-10 * baseline_cost);
    const testing::ReferenceSolution reference = calibration.Reference();
    for (std::size_t k = 0; k < calibration.free_columns.size(); ++k) {
      const int column = calibration.free_columns[k];
      EXPECT_LT(std::abs(of_ceres[column] - of_baseline[column]),
                1e-6 * static_cast<double>(reference.stddevs[k]));
    }
  }
}

}  // namespace
}  // namespace alidade::internal
