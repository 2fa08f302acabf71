#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <numeric>
#include <string>
#include <vector>

#include "alidade/forward_kinematics.h"
#include "src/common/constants.h"
#include "src/common/random.h"
#include "src/solve/solve.h"
#include "tests/solve/solvers_test_util.h"
#include "tests/support/edit.h"
#include "tests/support/random_arms.h"
#include "tests/support/study.h"

namespace alidade::internal {
namespace {

using testing::Calibration;
using testing::SolverCase;

class SolverStatusTest : public ::testing::TestWithParam<SolverCase> {
 protected:
  // The problem cannot be solved, the message holds `reason`, and the values
  // keep their bits.
  static void ExpectUnusable(const Calibration& calibration,
                             const Eigen::VectorXd& start,
                             const std::string& reason,
                             const SolverOptions& options = {}) {
    Eigen::VectorXd values = start;
    const SolverSummary summary =
        calibration.Solve(GetParam(), &values, options);
    EXPECT_EQ(summary.status, SolverStatus::kUnusable);
    EXPECT_FALSE(summary.IsSolutionUsable());
    EXPECT_NE(summary.message.find(reason), std::string::npos)
        << summary.message;
    EXPECT_TRUE(testing::SameBits(values, start));
    EXPECT_EQ(summary.accepted_steps + summary.rejected_steps, 0);
  }

  static void ExpectUnusable(const Calibration& calibration,
                             const std::string& reason,
                             const SolverOptions& options = {}) {
    ExpectUnusable(calibration, calibration.model.NominalValues(), reason,
                   options);
  }

  Calibration calibration_ = testing::NoisyFlangeCalibration(1, 40);
};

TEST_P(SolverStatusTest, NoFreeParameterIsUnusable) {
  calibration_.free_columns.clear();
  ExpectUnusable(calibration_, "no parameter is free");
}

TEST_P(SolverStatusTest, FewerEquationsThanParametersAreUnusable) {
  const Calibration few = testing::NoisyFlangeCalibration(1, 5);
  ExpectUnusable(few, "5 poses give 15 equations for 18 parameters");
  ExpectUnusable(testing::NoisyFlangeCalibration(1, 0),
                 "0 poses give 0 equations for 18 parameters");
}

TEST_P(SolverStatusTest, AsManyEquationsAsParametersAreSolved) {
  Calibration calibration = testing::NoisyFlangeCalibration(1, 6);
  Eigen::VectorXd values = calibration.true_values;
  const SolverSummary summary = calibration.Solve(GetParam(), &values);
  EXPECT_NE(summary.status, SolverStatus::kUnusable) << summary.message;
  EXPECT_GE(summary.accepted_steps, 1);
}

TEST_P(SolverStatusTest, ValuesThatAreNotFiniteInTheDataAreUnusable) {
  for (const double bad : {kNan, kInfinity}) {
    SCOPED_TRACE(bad);
    Calibration positions = calibration_;
    testing::Edit(&positions.data.positions()).at(1, 17) = bad;
    ExpectUnusable(positions, "not finite");
    Calibration joint_values = calibration_;
    testing::Edit(&joint_values.data.joint_values).at(2, 39) = bad;
    ExpectUnusable(joint_values, "not finite");
  }
}

TEST_P(SolverStatusTest, StartThatIsNotFiniteIsUnusable) {
  Eigen::VectorXd start = calibration_.model.NominalValues();
  start[calibration_.free_columns[3]] = kNan;
  ExpectUnusable(calibration_, start, "not finite");
}

TEST_P(SolverStatusTest, SigmaThatIsNotPositiveIsUnusable) {
  for (const double bad : {0.0, -1e-5}) {
    Calibration calibration = calibration_;
    testing::Edit(&calibration.data.sigmas()).at(2, 11) = bad;
    ExpectUnusable(calibration, "a sigma is not positive");
  }
  Calibration calibration = calibration_;
  testing::Edit(&calibration.data.sigmas()).at(2, 11) = kNan;
  ExpectUnusable(calibration, "");
}

TEST_P(SolverStatusTest, JointCountOfTheDataMustBeThatOfTheArm) {
  Calibration calibration = calibration_;
  calibration.data.joint_values = Eigen::MatrixXd::Zero(4, 40);
  ExpectUnusable(calibration, "the data set has 4 joints, the arm 5");
}

TEST_P(SolverStatusTest, SizeOfTheStartMustBeThatOfTheModel) {
  ExpectUnusable(calibration_, Eigen::VectorXd::Zero(36),
                 "the starting point has 36 values, the model 37");
}

TEST_P(SolverStatusTest, InvalidOptionsAreNamed) {
  for (const auto& [name, field] :
       {std::make_pair("function_tolerance",
                       &SolverOptions::function_tolerance),
        std::make_pair("precision_limit_factor",
                       &SolverOptions::precision_limit_factor),
        std::make_pair("wanted_precision", &SolverOptions::wanted_precision),
        std::make_pair("initial_trust_region_radius",
                       &SolverOptions::initial_trust_region_radius),
        std::make_pair("pseudo_inverse_tolerance",
                       &SolverOptions::pseudo_inverse_tolerance)}) {
    SolverOptions options;
    options.*field = kNan;
    ExpectUnusable(calibration_, std::string("invalid option: ") + name,
                   options);
  }
  SolverOptions options;
  options.max_iterations = 0;
  ExpectUnusable(calibration_, "invalid option: max_iterations = 0", options);
  options = SolverOptions();
  options.num_threads = 0;
  ExpectUnusable(calibration_, "invalid option: num_threads = 0", options);
}

TEST_P(SolverStatusTest, IterationLimitIsSaidAndKeepsTheProgress) {
  SolverOptions options;
  options.max_iterations = 1;
  const Eigen::VectorXd nominal = calibration_.model.NominalValues();
  Eigen::VectorXd values = nominal;
  const SolverSummary summary =
      calibration_.Solve(GetParam(), &values, options);
  EXPECT_EQ(summary.status, SolverStatus::kIterationLimit);
  EXPECT_NE(summary.message.find("max_iterations = 1"), std::string::npos)
      << summary.message;
  EXPECT_EQ(summary.iterations.size(), 2U);
  EXPECT_TRUE(summary.IsSolutionUsable());
  EXPECT_LT(summary.final_cost, 1e-2 * summary.initial_cost);
  EXPECT_NEAR(summary.iterations[1].step_norm, (values - nominal).norm(),
              1e-12);
}

TEST_P(SolverStatusTest, WantedPrecisionStopsEarly) {
  const Calibration calibration = testing::FlangeCalibration(4);
  Eigen::VectorXd values = calibration.model.NominalValues();
  const SolverSummary whole = calibration.Solve(GetParam(), &values);
  SolverOptions options;
  options.wanted_precision = 1e-6;
  values = calibration.model.NominalValues();
  const SolverSummary summary = calibration.Solve(GetParam(), &values, options);
  EXPECT_EQ(summary.status, SolverStatus::kConverged);
  EXPECT_EQ(summary.message, "the wanted precision is reached");
  EXPECT_LT(summary.iterations.size(), whole.iterations.size());
  const std::size_t last = summary.iterations.size() - 1;
  EXPECT_LE(summary.iterations[last].max_error, 1e-6);
  EXPECT_GT(summary.iterations[last - 1].max_error, 1e-6);
  // Stopped there, not at the floor.
  EXPECT_GT(testing::LargestError(calibration.model.nominal(), values,
                                  calibration.data),
            1e-14);
}

TEST_P(SolverStatusTest, FunctionToleranceConverges) {
  SolverOptions options;
  options.function_tolerance = 1e-4;
  Eigen::VectorXd values = calibration_.model.NominalValues();
  const SolverSummary summary =
      calibration_.Solve(GetParam(), &values, options);
  EXPECT_EQ(summary.status, SolverStatus::kConverged);
  EXPECT_NE(summary.message.find("function_tolerance"), std::string::npos)
      << summary.message;
  Eigen::VectorXd exact = calibration_.model.NominalValues();
  const double least = calibration_.Solve(GetParam(), &exact).final_cost;
  // Gauss-Newton squares what is left: 1e-4 is a generous bound.
  EXPECT_NEAR(summary.final_cost, least, 1e-4 * least);
}

// The step that is below all rounding converges, accepted or not: trying it
// again with smaller and smaller trust regions would change nothing.
TEST_P(SolverStatusTest, NoiseConvergesWithoutStepsThatChangeNothing) {
  for (int seed = 0; seed < 20; ++seed) {
    const Calibration calibration = testing::NoisyFlangeCalibration(seed, 60);
    Eigen::VectorXd values = calibration.model.NominalValues();
    const SolverSummary summary = calibration.Solve(GetParam(), &values);
    EXPECT_EQ(summary.status, SolverStatus::kConverged) << summary.message;
    EXPECT_LE(summary.rejected_steps, 2) << "seed " << seed;
    EXPECT_LE(summary.iterations.size(), 8U) << "seed " << seed;
  }
}

TEST_P(SolverStatusTest, ZeroResidualAtTheStartIsSolved) {
  calibration_.data.positions() = calibration_.model.Predict(
      calibration_.model.NominalValues(), calibration_.data.joint_values);
  Eigen::VectorXd values = calibration_.model.NominalValues();
  const SolverSummary summary = calibration_.Solve(GetParam(), &values);
  EXPECT_TRUE(summary.IsSolutionUsable()) << summary.message;
  // Which nobody asked for.
  EXPECT_NE(summary.message, "the wanted precision is reached");
  // Rounding of 1e-16 m against sigmas of 1e-5 m, in 56 poses.
  EXPECT_LE(summary.initial_cost, 1e-18);
  EXPECT_LE(summary.final_cost, 1e-18);
  EXPECT_LE((values - calibration_.model.NominalValues()).cwiseAbs().maxCoeff(),
            1e-14);
}

// Starts that are off by a radian and a metre and more in every parameter.
TEST_P(SolverStatusTest, HopelessStartLeavesNothingThatIsNotFinite) {
  for (const double size : {1.0, 3.0, 1e3, 1e8}) {
    for (int draw = 0; draw < 4; ++draw) {
      Random random(5, draw);
      Eigen::VectorXd start = calibration_.model.NominalValues();
      for (const int column : calibration_.free_columns) {
        start[column] += random.Uniform(-size, size);
      }
      Eigen::VectorXd values = start;
      const SolverSummary summary = calibration_.Solve(GetParam(), &values);
      EXPECT_TRUE(values.allFinite());
      if (summary.IsSolutionUsable()) {
        EXPECT_LE(summary.final_cost, summary.initial_cost);
      } else {
        EXPECT_TRUE(testing::SameBits(values, start));
      }
    }
  }
}

// Of exact poses whose orientations weigh far more than their positions.
TEST_P(SolverStatusTest, OrientationsHaveAPrecisionLimitToo) {
  const testing::Calibration positions = testing::FlangeCalibration(4);
  const ParameterLayout& layout = positions.model.layout();
  const Arm real =
      layout.WithValues(positions.model.nominal(), positions.true_values);
  const Eigen::Index count = positions.data.num_poses();
  Eigen::MatrixXd measured(6, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Isometry3d pose =
        TargetPose(real, positions.data.joint_values.col(i));
    const Eigen::AngleAxisd turn(pose.linear());
    measured.col(i) << pose.translation(), turn.angle() * turn.axis();
  }
  Calibration calibration = positions;
  ObservationBlock& block = calibration.data.blocks.front();
  block.kind = MeasurementKind::kPose;
  block.measured = measured;
  Eigen::MatrixXd sigmas(6, count);
  sigmas.topRows(3).setConstant(1e-3);
  sigmas.bottomRows(3).setConstant(1e-5);
  block.sigmas = sigmas;
  calibration.CountStartRank();
  Eigen::VectorXd values = calibration.model.NominalValues();
  const SolverSummary summary = calibration.Solve(GetParam(), &values);
  EXPECT_EQ(summary.status, SolverStatus::kPrecisionLimit) << summary.message;
}

// With a tolerance that any step meets, a first step that is rejected, as
// undamped ones along unidentifiable directions are, ends the solve far from a
// minimum.
TEST(CeresStatusTest, EndWithoutAStepIsNoSolutionUnlessItBeganAtOne) {
  Calibration calibration = testing::NoisyFlangeCalibration(1, 40);
  Eigen::VectorXd minimum = calibration.model.NominalValues();
  calibration.Solve(testing::kCeres, &minimum);
  SolverOptions options;
  options.function_tolerance = 1.0;
  options.initial_trust_region_radius = 1e16;
  for (const Evaluation evaluation :
       {Evaluation::kAutodiff, Evaluation::kReduced}) {
    options.evaluation = evaluation;
    Eigen::VectorXd again = minimum;
    EXPECT_TRUE(
        calibration.Solve(testing::kCeres, &again, options).IsSolutionUsable());
  }
  calibration.free_columns.resize(25);
  std::iota(calibration.free_columns.begin(), calibration.free_columns.end(),
            0);
  for (const Evaluation evaluation :
       {Evaluation::kAutodiff, Evaluation::kReduced}) {
    options.evaluation = evaluation;
    int without_step = 0;
    for (int draw = 0; draw < 40; ++draw) {
      Random random(5, draw);
      Eigen::VectorXd start = minimum;
      for (const int column : calibration.free_columns) {
        start[column] += random.Uniform(-0.3, 0.3);
      }
      const SolverSummary summary =
          calibration.Solve(testing::kCeres, &start, options);
      if (summary.accepted_steps > 0) continue;
      ++without_step;
      EXPECT_EQ(summary.status, SolverStatus::kFailed);
      EXPECT_NE(summary.message.find("it is no minimum"), std::string::npos)
          << summary.message;
    }
    EXPECT_GE(without_step, 1);
  }
}

// The same where every free parameter is identifiable, so that no column of the
// Jacobian is rounding.
TEST(CeresStatusTest, EndWithoutAStepIsNoSolutionOfAFullRankEither) {
  const Calibration calibration = testing::NoisyFlangeCalibration(1, 40);
  SolverOptions options;
  options.function_tolerance = 1.0;
  options.initial_trust_region_radius = 1e16;
  // Whatever a cost of the same residuals is.
  for (const double scale : {1.0, 1e6}) {
    Calibration scaled = calibration;
    *testing::Edit(&scaled.data.sigmas()) *= scale;
    int without_step = 0;
    for (int draw = 0; draw < 40; ++draw) {
      Random random(5, draw);
      Eigen::VectorXd start = scaled.model.NominalValues();
      for (const int column : scaled.free_columns) {
        start[column] += random.Uniform(-1.5, 1.5);
      }
      const SolverSummary summary =
          scaled.Solve(testing::kCeres, &start, options);
      if (summary.accepted_steps > 0) continue;
      ++without_step;
      EXPECT_EQ(summary.status, SolverStatus::kFailed) << summary.message;
    }
    EXPECT_GE(without_step, 1) << scale;
  }
}

TEST(CeresStatusTest, EndWithoutAStepIsASolutionAtAMinimumOfAnyCost) {
  for (int seed = 0; seed < 10; ++seed) {
    Calibration calibration = testing::NoisyFlangeCalibration(seed, 40);
    *testing::Edit(&calibration.data.sigmas()) *= 1e-5;
    Eigen::VectorXd values = calibration.model.NominalValues();
    EXPECT_TRUE(calibration.Solve(testing::kCeres, &values).IsSolutionUsable());
    const SolverSummary again = calibration.Solve(testing::kCeres, &values);
    EXPECT_TRUE(again.IsSolutionUsable()) << again.message;
  }
}

// Even where nothing is left to gain: the limits are off.
TEST(PseudoInverseStatusTest, WithoutLimitsAllIterationsAreMade) {
  Calibration calibration = testing::NoisyFlangeCalibration(1, 40);
  calibration.data.positions() = calibration.model.Predict(
      calibration.model.NominalValues(), calibration.data.joint_values);
  SolverOptions options;
  options.precision_limit_factor = 0.0;
  options.function_tolerance = 0.0;
  options.max_iterations = 4;
  Eigen::VectorXd values = calibration.model.NominalValues();
  const SolverSummary summary =
      calibration.Solve(testing::kPseudoInverse, &values, options);
  EXPECT_EQ(summary.status, SolverStatus::kIterationLimit) << summary.message;
  EXPECT_EQ(summary.iterations.size(), 5U);
}

TEST(PseudoInverseStatusTest, LimitWithAGrownCostIsNotUsable) {
  const Calibration calibration = testing::NoisyFlangeCalibration(1, 40);
  int grown = 0;
  for (int draw = 0; draw < 10; ++draw) {
    Random random(5, draw);
    Eigen::VectorXd start = calibration.model.NominalValues();
    for (const int column : calibration.free_columns) {
      start[column] += random.Uniform(-1.0, 1.0);
    }
    Eigen::VectorXd values = start;
    const SolverSummary summary =
        calibration.Solve(testing::kPseudoInverse, &values);
    if (summary.final_cost <= summary.initial_cost) continue;
    ++grown;
    EXPECT_EQ(summary.status, SolverStatus::kIterationLimit);
    EXPECT_FALSE(summary.IsSolutionUsable());
    EXPECT_TRUE(testing::SameBits(values, start));
  }
  EXPECT_GE(grown, 1);
}

// Sigmas so small that chi-square overflows once the steps have thrown the arm
// some kilometres off. Levenberg-Marquardt takes such steps back.
TEST(PseudoInverseStatusTest, DivergenceToInfinityFails) {
  Calibration calibration = testing::NoisyFlangeCalibration(1, 40);
  testing::Edit(&calibration.data.sigmas())->setConstant(1e-150);
  int diverged = 0;
  for (int draw = 0; draw < 10; ++draw) {
    Random random(5, draw);
    Eigen::VectorXd start = calibration.model.NominalValues();
    for (const int column : calibration.free_columns) {
      start[column] += random.Uniform(-2.0, 2.0);
    }
    Eigen::VectorXd values = start;
    const SolverSummary summary =
        calibration.Solve(testing::kPseudoInverse, &values);
    EXPECT_TRUE(values.allFinite());
    if (summary.status == SolverStatus::kFailed) {
      ++diverged;
      EXPECT_NE(summary.message.find("diverged"), std::string::npos)
          << summary.message;
      EXPECT_TRUE(testing::SameBits(values, start));
    }
    const SolverSummary damped = calibration.Solve(testing::kCeres, &start);
    EXPECT_NE(damped.status, SolverStatus::kFailed) << damped.message;
    EXPECT_TRUE(start.allFinite());
    EXPECT_LT(damped.final_cost, damped.initial_cost) << damped.FullReport();
  }
  EXPECT_GE(diverged, 5);
}

// A target point does not move when its frame turns about it.
TEST(PseudoInverseStatusTest, NoEffectOfAnyFreeParameterFails) {
  Calibration calibration = testing::NoisyFlangeCalibration(1, 40);
  calibration.free_columns =
      testing::ColumnsOf(calibration.model.layout(), {"tool_rx"});
  const Eigen::VectorXd nominal = calibration.model.NominalValues();
  Eigen::VectorXd values = nominal;
  const SolverSummary summary =
      calibration.Solve(testing::kPseudoInverse, &values);
  EXPECT_EQ(summary.status, SolverStatus::kFailed);
  EXPECT_EQ(summary.message, "no measurement depends on a free parameter");
  EXPECT_TRUE(testing::SameBits(values, nominal));
}

INSTANTIATE_TEST_SUITE_P(Solvers, SolverStatusTest,
                         ::testing::Values(testing::kCeres,
                                           testing::kPseudoInverse),
                         testing::NameOfSolver);

}  // namespace
}  // namespace alidade::internal
