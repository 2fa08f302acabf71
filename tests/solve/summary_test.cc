#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "src/common/random.h"
#include "src/solve/progress.h"
#include "src/solve/solve.h"
#include "tests/solve/solvers_test_util.h"
#include "tests/support/edit.h"
#include "tests/support/reference_solution.h"
#include "tests/support/study.h"

namespace alidade::internal {
namespace {

using testing::Calibration;
using testing::SolverCase;

// Statistics of position errors by hand, in long double.
struct Errors {
  double cost = 0.0;
  double max = 0.0;
  double rms = 0.0;
};

Errors ErrorsByHand(const Calibration& calibration,
                    const Eigen::VectorXd& values) {
  const Dataset& data = calibration.data;
  long double cost = 0.0L;
  long double squares = 0.0L;
  for (Eigen::Index i = 0; i < data.num_poses(); ++i) {
    const testing::Vector3l predicted = testing::MatrixPosition(
        calibration.model.nominal(), values.cast<long double>(),
        data.joint_values.col(i).data());
    for (int axis = 0; axis < 3; ++axis) {
      const long double error = predicted[axis] - data.positions()(axis, i);
      const long double sigma = data.sigmas()(axis, i);
      cost += (error / sigma) * (error / sigma);
      squares += error * error;
    }
  }
  Errors errors;
  errors.cost = static_cast<double>(cost);
  errors.rms = static_cast<double>(
      std::sqrt(squares / static_cast<long double>(data.num_poses())));
  errors.max = testing::LargestError(calibration.model.nominal(), values, data);
  return errors;
}

void ExpectRecord(const IterationRecord& record, const Errors& expected) {
  // Positions are rounded to 1e-16 m, errors are 1e-5 m and more.
  EXPECT_NEAR(record.cost, expected.cost, 1e-9 * expected.cost);
  EXPECT_NEAR(record.max_error, expected.max, 1e-9 * expected.max);
  EXPECT_NEAR(record.rms_error, expected.rms, 1e-9 * expected.rms);
}

class SolverSummaryTest : public ::testing::TestWithParam<SolverCase> {
 protected:
  SolverSummaryTest() {
    // Uneven sigmas tell the cost from the errors, and poses from axes.
    for (Eigen::Index i = 0; i < calibration_.data.num_poses(); ++i) {
      testing::Edit(&calibration_.data.sigmas())->col(i) *=
          1.0 + 0.05 * static_cast<double>(i);
      testing::Edit(&calibration_.data.sigmas()).at(1, i) *= 2.0;
    }
  }

  SolverSummary Solve(const SolverOptions& options = {}) {
    values_ = calibration_.model.NominalValues();
    return calibration_.Solve(GetParam(), &values_, options);
  }

  Calibration calibration_ = testing::NoisyFlangeCalibration(6, 40);
  Eigen::VectorXd values_;
};

TEST_P(SolverSummaryTest, CountsTheProblem) {
  const SolverSummary summary = Solve();
  EXPECT_EQ(summary.solver,
            GetParam().name == "Ceres" ? "ceres" : "pseudo_inverse");
  EXPECT_EQ(summary.num_poses, 40);
  EXPECT_EQ(summary.num_residuals, 120);
  EXPECT_EQ(summary.num_parameters, 37);
  EXPECT_EQ(summary.num_free, 18);
}

TEST_P(SolverSummaryTest, FirstAndLastRecordsAreThoseComputedByHand) {
  const SolverSummary summary = Solve();
  const Errors before =
      ErrorsByHand(calibration_, calibration_.model.NominalValues());
  const Errors after = ErrorsByHand(calibration_, values_);
  ExpectRecord(summary.iterations.front(), before);
  EXPECT_NEAR(summary.initial_cost, before.cost, 1e-9 * before.cost);
  ExpectRecord(summary.iterations.back(), after);
  EXPECT_NEAR(summary.final_cost, after.cost, 1e-9 * after.cost);
  EXPECT_LT(after.cost, 1e-3 * before.cost);
}

TEST_P(SolverSummaryTest, RecordsAreNumberedTimedAndCounted) {
  const SolverSummary summary = Solve();
  int accepted = 0;
  double time_s = 0.0;
  for (std::size_t k = 0; k < summary.iterations.size(); ++k) {
    const IterationRecord& record = summary.iterations[k];
    EXPECT_EQ(record.iteration, static_cast<int>(k));
    EXPECT_GE(record.time_s, time_s);
    EXPECT_EQ(record.step_norm == 0.0, k == 0);
    if (k > 0 && record.accepted) ++accepted;
    time_s = record.time_s;
  }
  EXPECT_EQ(summary.accepted_steps, accepted);
  EXPECT_EQ(summary.accepted_steps + summary.rejected_steps + 1,
            static_cast<int>(summary.iterations.size()));
  EXPECT_GE(summary.setup_time_s, 0.0);
  EXPECT_GT(summary.solve_time_s, 0.0);
  EXPECT_GE(summary.setup_time_s + summary.solve_time_s, time_s);
}

TEST_P(SolverSummaryTest, SaysWhichPrecisionLimitWasUsed) {
  // The lengths of the arm, 300 + 250 + 160 + 72 mm, times epsilon.
  EXPECT_NEAR(Solve().precision_limit,
              0.782 * std::numeric_limits<double>::epsilon(), 1e-22);
}

TEST_P(SolverSummaryTest, SaysThreadsGivenAndUsed) {
  Calibration calibration = testing::NoisyFlangeCalibration(6, 40, 2);
  SolverOptions options;
  options.num_threads = 2;
  Eigen::VectorXd values = calibration.model.NominalValues();
  const SolverSummary summary = calibration.Solve(GetParam(), &values, options);
  EXPECT_EQ(summary.threads_given, 2);
  EXPECT_EQ(summary.threads_used, 2);
}

INSTANTIATE_TEST_SUITE_P(Solvers, SolverSummaryTest,
                         ::testing::Values(testing::kCeres,
                                           testing::kPseudoInverse),
                         testing::NameOfSolver);

// Far from the solution some steps are rejected: the cost stays there, and
// falls with every accepted one.
TEST(CeresSummaryTest, CostFallsWithAcceptedStepsOnly) {
  const Calibration calibration = testing::NoisyFlangeCalibration(2, 40);
  int rejected = 0;
  for (int draw = 0; draw < 5; ++draw) {
    Random random(9, draw);
    Eigen::VectorXd values = calibration.model.NominalValues();
    for (const int column : calibration.free_columns) {
      values[column] += random.Uniform(-0.6, 0.6);
    }
    const SolverSummary summary = calibration.Solve(testing::kCeres, &values);
    for (std::size_t k = 1; k < summary.iterations.size(); ++k) {
      const IterationRecord& record = summary.iterations[k];
      const double before = summary.iterations[k - 1].cost;
      if (record.accepted) {
        EXPECT_LE(record.cost, before) << k;
      } else {
        EXPECT_EQ(record.cost, before) << k;
      }
    }
    rejected += summary.rejected_steps;
  }
  EXPECT_GE(rejected, 5);
}

TEST(CeresSummaryTest, TrustRegionIsGivenAndUsed) {
  const Calibration calibration = testing::WristCalibration(2);
  Eigen::VectorXd values = calibration.model.NominalValues();
  SolverSummary summary = calibration.Solve(testing::kCeres, &values);
  EXPECT_EQ(summary.trust_region_given, 0.0);
  const double counted = calibration.start_rank.SmallestCounted();
  const double automatic = 900.0 / (counted * counted);
  EXPECT_NEAR(summary.trust_region_used, automatic, 1e-9 * automatic);
  EXPECT_EQ(summary.first_step_rank, -1);
  SolverOptions options;
  options.initial_trust_region_radius = 3e5;
  values = calibration.model.NominalValues();
  summary = calibration.Solve(testing::kCeres, &values, options);
  EXPECT_EQ(summary.trust_region_given, 3e5);
  EXPECT_EQ(summary.trust_region_used, 3e5);
  options.initial_trust_region_radius = 0.5;
  values = calibration.model.NominalValues();
  summary = calibration.Solve(testing::kCeres, &values, options);
  EXPECT_EQ(summary.trust_region_used, 0.5);
  EXPECT_NE(summary.FullReport().find("Trust region given, used  0.5, 0.5\n"),
            std::string::npos)
      << summary.FullReport();
}

TEST_P(SolverSummaryTest, TimesAreNoLongerThanTheSolve) {
  const auto begun = std::chrono::steady_clock::now();
  const SolverSummary summary = Solve();
  const std::chrono::duration<double> all =
      std::chrono::steady_clock::now() - begun;
  EXPECT_GE(summary.setup_time_s, 0.0);
  EXPECT_GT(summary.solve_time_s, 0.0);
  EXPECT_LE(summary.setup_time_s + summary.solve_time_s, all.count());
}

TEST(PrependIterationsTest, StepsAndTimesAddUp) {
  SolverSummary earlier;
  SolverSummary later;
  for (int k = 0; k < 3; ++k) {
    IterationRecord record;
    record.iteration = k;
    record.cost = 100.0 - k;
    record.time_s = 1.0 + k;
    earlier.iterations.push_back(record);
    record.cost = 50.0 - k;
    later.iterations.push_back(record);
  }
  earlier.accepted_steps = 5;
  earlier.rejected_steps = 3;
  earlier.setup_time_s = 0.25;
  earlier.solve_time_s = 3.0;
  later.accepted_steps = 2;
  later.rejected_steps = 7;
  later.setup_time_s = 0.5;
  later.solve_time_s = 4.0;
  PrependIterations(earlier, &later);
  EXPECT_EQ(later.accepted_steps, 7);
  EXPECT_EQ(later.rejected_steps, 10);
  EXPECT_EQ(later.setup_time_s, 0.75);
  EXPECT_EQ(later.solve_time_s, 7.0);
  ASSERT_EQ(later.iterations.size(), 5U);
  const std::vector<double> costs = {100.0, 99.0, 98.0, 49.0, 48.0};
  const std::vector<double> times = {1.0, 2.0, 3.0, 5.0, 6.0};
  for (std::size_t k = 0; k < 5; ++k) {
    EXPECT_EQ(later.iterations[k].iteration, static_cast<int>(k));
    EXPECT_EQ(later.iterations[k].cost, costs[k]);
    EXPECT_EQ(later.iterations[k].time_s, times[k]);
  }
}

TEST(PseudoInverseSummaryTest, ToleranceIsGivenAndUsed) {
  const Calibration calibration = testing::WristCalibration(2);
  Eigen::VectorXd values = calibration.model.NominalValues();
  SolverSummary summary = calibration.Solve(testing::kPseudoInverse, &values);
  EXPECT_EQ(summary.pseudo_inverse_tolerance_given, 0.0);
  EXPECT_EQ(summary.pseudo_inverse_tolerance_used, 1e-12);
  EXPECT_EQ(summary.first_step_rank, 15);
  SolverOptions options;
  options.pseudo_inverse_tolerance = 1e-9;
  values = calibration.model.NominalValues();
  summary = calibration.Solve(testing::kPseudoInverse, &values, options);
  EXPECT_EQ(summary.pseudo_inverse_tolerance_given, 1e-9);
  EXPECT_EQ(summary.pseudo_inverse_tolerance_used, 1e-9);
  // The plane, met to 1e-7, counts above this tolerance.
  EXPECT_EQ(summary.first_step_rank, 16);
}

// The study's own way: a fixed number of iterations, whatever the error.
TEST(PseudoInverseSummaryTest, RunsAFixedNumberOfIterations) {
  const Calibration calibration = testing::WristCalibration(2);
  SolverOptions options;
  options.max_iterations = 100;
  options.precision_limit_factor = 0.0;
  options.function_tolerance = 0.0;
  Eigen::VectorXd values = calibration.model.NominalValues();
  const SolverSummary summary =
      calibration.Solve(testing::kPseudoInverse, &values, options);
  EXPECT_EQ(summary.status, SolverStatus::kIterationLimit);
  EXPECT_TRUE(summary.IsSolutionUsable());
  EXPECT_EQ(summary.accepted_steps, 100);
  ASSERT_EQ(summary.iterations.size(), 101U);
  for (std::size_t k = 5; k <= 100; ++k) {
    // Rounding, for good.
    EXPECT_LT(summary.iterations[k].max_error, 5e-16) << k;
  }
}

}  // namespace
}  // namespace alidade::internal
