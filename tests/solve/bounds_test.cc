// Minima within bounds, against all sets of bounds that may be active: without
// those of a set, its parameters fixed at them, the problem has no bounds, and
// the best solution of all sets that is within the bounds is the minimum.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "src/common/constants.h"
#include "src/solve/bounded_solver.h"
#include "tests/solve/solvers_test_util.h"

namespace alidade::internal {
namespace {

using testing::Calibration;

struct Bound {
  int column;
  double value;
};

// Bounds at `part` of the way from the start to the solution without any.
std::vector<Bound> BoundsBefore(const Calibration& calibration, double part,
                                const std::vector<const char*>& names) {
  Eigen::VectorXd solution = calibration.model.NominalValues();
  const Eigen::VectorXd start = solution;
  calibration.Solve(testing::kCeres, &solution);
  std::vector<Bound> bounds;
  for (const char* name : names) {
    const int column = *calibration.model.layout().Find(name);
    bounds.push_back(
        {column, start[column] + part * (solution[column] - start[column])});
  }
  return bounds;
}

CalibrationProblem WithBounds(const Calibration& calibration,
                              const std::vector<Bound>& bounds) {
  CalibrationProblem problem = calibration.Problem();
  const Eigen::VectorXd start = calibration.model.NominalValues();
  problem.lower = Eigen::VectorXd::Constant(start.size(), -kInfinity);
  problem.upper = Eigen::VectorXd::Constant(start.size(), kInfinity);
  for (const Bound& bound : bounds) {
    (bound.value > start[bound.column] ? problem.upper
                                       : problem.lower)[bound.column] =
        bound.value;
  }
  return problem;
}

double LeastCostOfAllSets(const Calibration& calibration,
                          const std::vector<Bound>& bounds) {
  const CalibrationProblem bounded = WithBounds(calibration, bounds);
  double least = kInfinity;
  for (unsigned set = 0; set < 1U << bounds.size(); ++set) {
    CalibrationProblem problem = calibration.Problem();
    Eigen::VectorXd values = calibration.model.NominalValues();
    for (std::size_t k = 0; k < bounds.size(); ++k) {
      if ((set >> k & 1U) == 0) continue;
      values[bounds[k].column] = bounds[k].value;
      auto& free = problem.free_columns;
      free.erase(std::find(free.begin(), free.end(), bounds[k].column));
    }
    const SolverSummary summary =
        SolveLevenbergMarquardt(problem, SolverOptions(), &values);
    EXPECT_TRUE(summary.IsSolutionUsable()) << summary.message;
    const bool is_within = (values.array() >= bounded.lower.array()).all() &&
                           (values.array() <= bounded.upper.array()).all();
    if (is_within) least = std::min(least, summary.final_cost);
  }
  return least;
}

class BoundsTest : public ::testing::TestWithParam<double> {};

TEST_P(BoundsTest, FindsTheMinimumOfAllActiveSets) {
  const Calibration calibration = testing::NoisyFlangeCalibration(3, 60);
  const std::vector<Bound> bounds =
      BoundsBefore(calibration, GetParam(), {"d2", "d3", "alpha3", "theta3"});
  const double least = LeastCostOfAllSets(calibration, bounds);
  for (const Evaluation evaluation :
       {Evaluation::kAutodiff, Evaluation::kReduced}) {
    SolverOptions options;
    options.evaluation = evaluation;
    Eigen::VectorXd values = calibration.model.NominalValues();
    const CalibrationProblem problem = WithBounds(calibration, bounds);
    const SolverSummary summary =
        SolveLevenbergMarquardt(problem, options, &values);
    ASSERT_TRUE(summary.IsSolutionUsable()) << summary.message;
    EXPECT_EQ(summary.status, SolverStatus::kConverged) << summary.message;
    // Both stop some 1e-15 of the cost before their minimum.
    EXPECT_NEAR(summary.final_cost / least, 1.0, 1e-9);
    EXPECT_TRUE((values.array() >= problem.lower.array()).all());
    EXPECT_TRUE((values.array() <= problem.upper.array()).all());
    EXPECT_EQ(summary.num_free, static_cast<int>(problem.free_columns.size()));
  }
}

// Which bounds hold does not depend on how large the sigmas are.
TEST_P(BoundsTest, EndsAtTheSameValuesWhateverTheCost) {
  const Calibration calibration = testing::NoisyFlangeCalibration(3, 60);
  const std::vector<Bound> bounds =
      BoundsBefore(calibration, GetParam(), {"d2", "d3", "alpha3", "theta3"});
  Eigen::VectorXd expected = calibration.model.NominalValues();
  SolveLevenbergMarquardt(WithBounds(calibration, bounds), SolverOptions(),
                          &expected);
  for (const double scale : {1e6, 1e-3}) {
    Calibration scaled = calibration;
    *testing::Edit(&scaled.data.sigmas()) *= scale;
    Eigen::VectorXd values = calibration.model.NominalValues();
    SolveLevenbergMarquardt(WithBounds(scaled, bounds), SolverOptions(),
                            &values);
    EXPECT_LT((values - expected).cwiseAbs().maxCoeff(), 1e-9) << scale;
  }
}

INSTANTIATE_TEST_SUITE_P(Parts, BoundsTest, ::testing::Values(0.1, 0.5, 0.9));

// The records of one solve after the other: each begins with number 0.
std::vector<std::vector<Eigen::VectorXd>> Rounds(
    const CalibrationProblem& problem, Eigen::VectorXd values) {
  std::vector<std::vector<Eigen::VectorXd>> rounds;
  SolverOptions options;
  options.on_iteration = [&](const IterationRecord& record) {
    if (record.iteration == 0) rounds.emplace_back();
    rounds.back().push_back(record.values);
  };
  EXPECT_TRUE(
      SolveLevenbergMarquardt(problem, options, &values).IsSolutionUsable());
  return rounds;
}

// Where the straight way from the start of a round to its solution leaves the
// bounds first; its end where it does not.
Eigen::VectorXd FirstBoundMet(const CalibrationProblem& problem,
                              const std::vector<Eigen::VectorXd>& round) {
  const Eigen::VectorXd way = round.back() - round.front();
  double part = 1.0;
  for (Eigen::Index k = 0; k < way.size(); ++k) {
    const double bound = way[k] > 0.0 ? problem.upper[k] : problem.lower[k];
    if (way[k] != 0.0)
      part = std::min(part, (bound - round.front()[k]) / way[k]);
  }
  return round.front() + part * way;
}

TEST(BoundedRoundsTest, BeginWhereTheWayBeforeMetItsFirstBound) {
  const Calibration calibration = testing::NoisyFlangeCalibration(3, 60);
  std::vector<Bound> bounds = BoundsBefore(calibration, 0.9, {"d2"});
  bounds.push_back(BoundsBefore(calibration, 0.3, {"theta3"}).front());
  bounds.push_back(BoundsBefore(calibration, 0.6, {"alpha3"}).front());
  const CalibrationProblem problem = WithBounds(calibration, bounds);
  // The first record is of the check of the start.
  const std::vector<std::vector<Eigen::VectorXd>> rounds =
      Rounds(problem, calibration.model.NominalValues());
  ASSERT_GE(rounds.size(), 4U);
  for (std::size_t k = 2; k < rounds.size(); ++k) {
    const Eigen::VectorXd expected = FirstBoundMet(problem, rounds[k - 1]);
    // Ways of some millimetres and milliradians.
    EXPECT_LT((rounds[k].front() - expected).cwiseAbs().maxCoeff(), 1e-12)
        << "round " << k;
  }
}

TEST(BoundedRoundsTest, HaveAnIterationEachWhereTheyAreUsedUp) {
  const Calibration calibration = testing::NoisyFlangeCalibration(3, 60);
  const std::vector<Bound> bounds =
      BoundsBefore(calibration, 0.5, {"d2", "d3", "alpha3", "theta3"});
  SolverOptions options;
  options.max_iterations = 1;
  Eigen::VectorXd values = calibration.model.NominalValues();
  const SolverSummary summary = SolveLevenbergMarquardt(
      WithBounds(calibration, bounds), options, &values);
  EXPECT_TRUE(summary.IsSolutionUsable()) << summary.message;
  EXPECT_LT(summary.final_cost, summary.initial_cost);
}

// A solver that always goes beyond the lower bound of d3: four rounds a
// parameter, and four more.
TEST(BoundedRoundsTest, EndWhereABoundIsMetAndLeftAgainAndAgain) {
  Calibration calibration = testing::NoisyFlangeCalibration(3, 60);
  const int d2 = *calibration.model.layout().Find("d2");
  const int d3 = *calibration.model.layout().Find("d3");
  calibration.free_columns = {d2, d3};
  Eigen::VectorXd minimum = calibration.model.NominalValues();
  calibration.start_rank = {};
  calibration.Solve(testing::kCeres, &minimum);
  CalibrationProblem problem = WithBounds(calibration, {});
  problem.lower[d3] = minimum[d3] - 1e-3;
  int solves = 0;
  const UnboundedSolver down = [&](const CalibrationProblem&,
                                   const SolverOptions&,
                                   Eigen::VectorXd* values) {
    ++solves;
    (*values)[d3] = minimum[d3] - 2e-3;
    SolverSummary summary;
    summary.status = SolverStatus::kConverged;
    summary.initial_cost = 1e9;
    return summary;
  };
  Eigen::VectorXd values = minimum;
  const SolverSummary summary =
      SolveWithinBounds(problem, SolverOptions(), down, &values);
  EXPECT_EQ(solves, 4 * 2 + 4);
  EXPECT_EQ(summary.status, SolverStatus::kIterationLimit);
  EXPECT_NE(summary.message.find("again and again"), std::string::npos);
}

TEST(BoundsStatusTest, StartBeyondAnyBoundIsUnusable) {
  const Calibration calibration = testing::NoisyFlangeCalibration(3, 60);
  const Eigen::VectorXd start = calibration.model.NominalValues();
  for (const int column : {0, 12}) {
    for (const bool is_lower : {true, false}) {
      CalibrationProblem problem = WithBounds(calibration, {});
      (is_lower ? problem.lower : problem.upper)[column] =
          start[column] + (is_lower ? 0.1 : -0.1);
      Eigen::VectorXd values = start;
      const SolverSummary summary =
          SolveLevenbergMarquardt(problem, SolverOptions(), &values);
      EXPECT_EQ(summary.status, SolverStatus::kUnusable);
      EXPECT_NE(summary.message.find(
                    calibration.model.layout().parameter(column).name +
                    " is not within its bounds"),
                std::string::npos)
          << summary.message;
      EXPECT_EQ(values, start);
    }
  }
}

// Nothing is left to solve for where the only parameter is at its bound.
TEST(SingleBoundTest, TheCostIsThatAtTheBound) {
  Calibration calibration = testing::NoisyFlangeCalibration(3, 60);
  calibration.free_columns = {*calibration.model.layout().Find("d3")};
  calibration.start_rank = {};
  const std::vector<Bound> bounds = BoundsBefore(calibration, 0.5, {"d3"});
  Eigen::VectorXd values = calibration.model.NominalValues();
  const SolverSummary summary = SolveLevenbergMarquardt(
      WithBounds(calibration, bounds), SolverOptions(), &values);
  ASSERT_TRUE(summary.IsSolutionUsable()) << summary.message;
  EXPECT_EQ(values[bounds[0].column], bounds[0].value);
  // 1 / sigma^2 times the squared errors there.
  const double errors =
      calibration.model.Errors(values, calibration.data).map().squaredNorm();
  EXPECT_NEAR(summary.final_cost / (errors / (2e-5 * 2e-5)), 1.0, 1e-9);
}

TEST(BoundsBeyondTest, BoundsBeyondTheSolutionChangeNothing) {
  const Calibration calibration = testing::NoisyFlangeCalibration(3, 60);
  const std::vector<Bound> bounds =
      BoundsBefore(calibration, 1.5, {"d2", "d3", "alpha3", "theta3"});
  Eigen::VectorXd free = calibration.model.NominalValues();
  const SolverSummary without = calibration.Solve(testing::kCeres, &free);
  Eigen::VectorXd values = calibration.model.NominalValues();
  const SolverSummary within = SolveLevenbergMarquardt(
      WithBounds(calibration, bounds), SolverOptions(), &values);
  EXPECT_NEAR(within.final_cost / without.final_cost, 1.0, 1e-9);
}

}  // namespace
}  // namespace alidade::internal
