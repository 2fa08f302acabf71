// The reduced evaluation against the reference, one autodiff residual per
// observation that Ceres solves: cost, gradient and Gauss-Newton matrix are the
// same, so that both take the same steps but for rounding.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <string>
#include <tuple>
#include <vector>

#include "alidade/robust_loss.h"
#include "src/common/constants.h"
#include "src/common/random.h"
#include "src/identifiability/analysis.h"
#include "src/kernel/reduction.h"
#include "src/solve/solve.h"
#include "tests/solve/solvers_test_util.h"
#include "tests/support/edit.h"
#include "tests/support/measurement_oracle.h"
#include "tests/support/noisy_positions.h"
#include "tests/support/random_measurements.h"
#include "tests/support/rv2aj_arms.h"

namespace alidade::internal {
namespace {

using testing::Calibration;
using testing::MeasuredArm;
using testing::Weighting;

constexpr LossKind kAllLosses[] = {LossKind::kNone, LossKind::kHuber,
                                   LossKind::kCauchy, LossKind::kTukey};

template <typename Entry>
void RepeatList(int times, std::vector<Entry>* list) {
  const std::vector<Entry> once = *list;
  for (int k = 1; k < times; ++k) {
    list->insert(list->end(), once.begin(), once.end());
  }
}

// Noise of an observation as its sigmas or its whitener say, of `size` standard
// deviations. Whiteners with a short direction are cut off at a thousandth.
Eigen::VectorXd NoiseOf(const ObservationBlock& block, Eigen::Index i,
                        double size, Random* random) {
  Eigen::VectorXd normal(block.rows_each());
  for (double& value : normal) value = size * random->Normal();
  const Eigen::MatrixXd whitener =
      testing::OracleWhitener(block, i).cast<double>();
  Eigen::JacobiSVD<Eigen::MatrixXd> svd(
      whitener, Eigen::ComputeThinU | Eigen::ComputeThinV);
  svd.setThreshold(1e-3);
  return svd.solve(normal);
}

// Every observation `times` times with noise of its own, one in 25 with noise
// of 30 standard deviations.
void RepeatWithNoise(int times, ObservationBlock* block, Random* random) {
  RepeatList(times, &block->poses);
  RepeatList(times, &block->targets);
  RepeatList(times, &block->references);
  RepeatList(times, &block->seconds);
  RepeatList(times, &block->whiteners);
  block->measured = block->measured.map().replicate(1, times).eval();
  block->sigmas = block->sigmas.map().replicate(1, times).eval();
  for (Eigen::Index i = 0; i < block->size(); ++i) {
    const double size = i % 25 == 7 ? 30.0 : 1.0;
    testing::Edit(&block->measured)->col(i) += NoiseOf(*block, i, size, random);
  }
}

// A random arm of two targets, and every kind of measurement of it. The nominal
// arm and references are the true ones, but for the noise of the measurements.
struct MixedCase {
  MixedCase(const MeasuredArm& measured, int num_threads)
      : model(measured.layout.WithValues(measured.arm, measured.values),
              MeasurementModel(measured.arm, measured.references, 1)
                  .ReferencesAt(measured.values),
              num_threads),
        data(measured.data),
        start(model.NominalValues()) {}

  CalibrationProblem Problem(const std::vector<int>& columns) const {
    return {model, data, columns};
  }

  MeasurementModel model;
  Dataset data;
  Eigen::VectorXd start;
};

MixedCase MakeMixedCase(int num_joints, Weighting weighting, int repeats,
                        int num_threads = 1) {
  Random random(61 + num_joints, static_cast<int>(weighting));
  MeasuredArm measured =
      testing::RandomMeasurements(num_joints, weighting, &random);
  for (ObservationBlock& block : measured.data.blocks) {
    RepeatWithNoise(repeats, &block, &random);
  }
  MixedCase mixed(measured, num_threads);
  // Within some standard deviations, so that Tukey's loss still pulls.
  for (double& value : mixed.start) value += random.Uniform(-1e-5, 1e-5);
  return mixed;
}

std::vector<int> AllColumns(const ParameterLayout& layout) {
  std::vector<int> columns(layout.size());
  std::iota(columns.begin(), columns.end(), 0);
  return columns;
}

// Columns that the data distinguish well, by pivoting: those that are at least
// a thirtieth of the first away from the span of the ones before.
std::vector<int> ToldColumns(const MixedCase& mixed) {
  const std::vector<int> all = AllColumns(mixed.model.layout());
  Eigen::MatrixXd factor =
      JacobianFactor(mixed.model, mixed.start, mixed.data, all);
  for (int c = 0; c < factor.cols(); ++c) {
    const double norm = factor.col(c).norm();
    if (norm > 0.0) factor.col(c) /= norm;
  }
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(factor);
  std::vector<int> columns;
  for (const int c : all) {
    if (std::abs(qr.matrixQR()(c, c)) < 1.0 / 30.0) continue;
    columns.push_back(qr.colsPermutation().indices()[c]);
  }
  std::sort(columns.begin(), columns.end());
  return columns;
}

struct Outcome {
  SolverSummary summary;
  Eigen::VectorXd values;
};

// Robust losses converge linearly: many iterations.
Outcome SolveBy(Evaluation evaluation, const CalibrationProblem& problem,
                const Eigen::VectorXd& start, int max_iterations = 300) {
  SolverOptions options;
  options.evaluation = evaluation;
  options.max_iterations = max_iterations;
  Outcome outcome{{}, start};
  outcome.summary = SolveLevenbergMarquardt(problem, options, &outcome.values);
  return outcome;
}

// How far two solutions are apart in standard deviations: the norm of the
// change of the whitened residuals. Directions that the data tell badly may
// differ by more.
double DeviationsBetween(const CalibrationProblem& problem, const Outcome& a,
                         const Outcome& b) {
  const Eigen::MatrixXd factor = JacobianFactor(
      problem.model, a.values, problem.data, problem.free_columns);
  Eigen::VectorXd change(factor.cols());
  for (Eigen::Index k = 0; k < change.size(); ++k) {
    const int column = problem.free_columns[k];
    change[k] = a.values[column] - b.values[column];
  }
  return (factor * change).norm();
}

// Accepted steps until all but a part in 1e9 of the cost is reached. Behind
// that, rounding decides which steps of a linearly converging loss are
// accepted.
int StepsToMinimum(const SolverSummary& summary) {
  int steps = 0;
  for (const IterationRecord& record : summary.iterations) {
    if (record.cost <= (1.0 + 1e-9) * summary.final_cost) break;
    steps += record.accepted ? 1 : 0;
  }
  return steps;
}

void ExpectSameWay(const SolverSummary& a, const SolverSummary& b) {
  EXPECT_EQ(a.status, b.status) << a.message << "\n" << b.message;
  EXPECT_LE(std::abs(StepsToMinimum(a) - StepsToMinimum(b)), 1);
  EXPECT_EQ(a.initial_cost, b.initial_cost);
  EXPECT_EQ(a.num_residuals, b.num_residuals);
  ASSERT_GE(a.iterations.size(), 2U);
  ASSERT_GE(b.iterations.size(), 2U);
  // The same step from the same point: its rounding, some 1e-13 of it, through
  // a condition of a thousand at most.
  EXPECT_EQ(a.iterations[1].accepted, b.iterations[1].accepted);
  EXPECT_NEAR(b.iterations[1].cost / a.iterations[1].cost, 1.0, 1e-8);
  EXPECT_NEAR(b.iterations[1].step_norm / a.iterations[1].step_norm, 1.0, 1e-8);
}

// Solves both ways, expects the same, and returns the reduced outcome.
Outcome ExpectSameSolution(const CalibrationProblem& problem,
                           const Eigen::VectorXd& start) {
  const Outcome reference = SolveBy(Evaluation::kAutodiff, problem, start);
  const Outcome reduced = SolveBy(Evaluation::kReduced, problem, start);
  EXPECT_EQ(reference.summary.evaluation, "autodiff");
  EXPECT_EQ(reduced.summary.evaluation, "reduced");
  EXPECT_TRUE(reference.summary.IsSolutionUsable())
      << reference.summary.message;
  ExpectSameWay(reference.summary, reduced.summary);
  // Both stop where a step predicts some 1e-15 of the cost (within bounds,
  // where it changes by less than 1e-13 of it), whose root is 2e-6 (2e-5) of a
  // standard deviation in a cost of some thousands. Steps of a robust loss
  // shrink linearly, by a tenth only where many observations are given up, and
  // leave several times that.
  EXPECT_LT(DeviationsBetween(problem, reference, reduced), 2e-4);
  // Off a minimum by so much, the cost is off by the square, 4e-8 of some
  // thousands; rounding of the residuals, 1e-16 m over sigmas of 1e-5 m, is
  // less.
  const double cost = reference.summary.final_cost;
  EXPECT_NEAR(reduced.summary.final_cost, cost, 1e-10 * cost);
  EXPECT_LT(cost, reference.summary.initial_cost);
  EXPECT_TRUE(
      testing::HoldsTheOthers(start, reduced.values, problem.free_columns));
  return reduced;
}

using MixedParam = std::tuple<LossKind, Weighting>;

class ReducedTest : public ::testing::TestWithParam<MixedParam> {
 protected:
  std::vector<RobustLoss> losses() const {
    return TunedLosses(std::get<0>(GetParam()));
  }
  Weighting weighting() const { return std::get<1>(GetParam()); }
};

std::string NameOfCase(const ::testing::TestParamInfo<MixedParam>& info) {
  const char* const losses[] = {"NoLoss", "Huber", "Cauchy", "Tukey"};
  const char* const weightings[] = {"Sigmas", "Masked", "Full"};
  return std::string(losses[static_cast<int>(std::get<0>(info.param))]) +
         weightings[static_cast<int>(std::get<1>(info.param))];
}

TEST_P(ReducedTest, SolvesForAWellToldSubsetOfMixedKinds) {
  for (const int num_joints : {3, 6}) {
    SCOPED_TRACE(num_joints);
    const MixedCase mixed = MakeMixedCase(num_joints, weighting(), 10);
    const std::vector<int> columns = ToldColumns(mixed);
    // Most of the chain, and references too.
    ASSERT_GE(columns.size(), 20U);
    ASSERT_LT(columns.size(), AllColumns(mixed.model.layout()).size());
    CalibrationProblem problem = mixed.Problem(columns);
    problem.losses = losses();
    const Outcome outcome = ExpectSameSolution(problem, mixed.start);
    EXPECT_EQ(outcome.summary.status, SolverStatus::kConverged)
        << outcome.summary.message;
  }
}

// All parameters, many of which depend on each other; four of five have a
// prior.
TEST_P(ReducedTest, SolvesForAllParametersWithPriors) {
  const MixedCase mixed = MakeMixedCase(4, weighting(), 10);
  const ParameterLayout& layout = mixed.model.layout();
  CalibrationProblem problem = mixed.Problem(AllColumns(layout));
  problem.losses = losses();
  problem.priors = Eigen::VectorXd::Constant(layout.size(), kNan);
  for (const int c : problem.free_columns) {
    problem.priors[c] = c % 5 == 0 ? kInfinity : 1e-3;
  }
  const Outcome outcome = ExpectSameSolution(problem, mixed.start);
  // The priors' share of the cost is in it.
  const double of_data =
      RobustChiSquare(mixed.model.Errors(outcome.values, mixed.data),
                      mixed.data, problem.losses);
  double of_priors = 0.0;
  for (const int c : problem.ColumnsWithPrior()) {
    const double off = outcome.values[c] - mixed.model.NominalValues()[c];
    of_priors += std::pow(off / problem.priors[c], 2);
  }
  EXPECT_GT(of_priors, 0.0);
  // Sums of some thousand terms in another order.
  EXPECT_NEAR(outcome.summary.final_cost, of_data + of_priors,
              1e-12 * (of_data + of_priors));
}

INSTANTIATE_TEST_SUITE_P(
    LossesAndWeightings, ReducedTest,
    ::testing::Combine(::testing::ValuesIn(kAllLosses),
                       ::testing::Values(Weighting::kSigmas, Weighting::kMasked,
                                         Weighting::kFull)),
    NameOfCase);

class ReducedLossTest : public ::testing::TestWithParam<LossKind> {};

// Some bounds between the start and the solution without any: the solution is
// at one of them at least.
TEST_P(ReducedLossTest, SolvesWithinActiveBounds) {
  const MixedCase mixed = MakeMixedCase(3, Weighting::kSigmas, 5);
  const std::vector<int> columns = ToldColumns(mixed);
  CalibrationProblem problem = mixed.Problem(columns);
  problem.losses = TunedLosses(GetParam());
  const Outcome free = SolveBy(Evaluation::kAutodiff, problem, mixed.start);
  const int size = mixed.model.layout().size();
  problem.lower = Eigen::VectorXd::Constant(size, -kInfinity);
  problem.upper = Eigen::VectorXd::Constant(size, kInfinity);
  std::vector<int> bounded;
  for (std::size_t k = 0; k < columns.size(); k += 5) {
    const int c = columns[k];
    const double middle = 0.5 * (mixed.start[c] + free.values[c]);
    (free.values[c] > middle ? problem.upper : problem.lower)[c] = middle;
    bounded.push_back(c);
  }
  const Outcome outcome = ExpectSameSolution(problem, mixed.start);
  EXPECT_TRUE((outcome.values.array() >= problem.lower.array()).all());
  EXPECT_TRUE((outcome.values.array() <= problem.upper.array()).all());
  int active = 0;
  for (const int c : bounded) {
    active += outcome.values[c] == problem.lower[c] ||
                      outcome.values[c] == problem.upper[c]
                  ? 1
                  : 0;
  }
  EXPECT_GE(active, 1);
  EXPECT_GT(outcome.summary.final_cost, free.summary.final_cost);
}

// Joint parameters alone, for which autodiff has no blocks of frames.
TEST_P(ReducedLossTest, SolvesForJointsByPositions) {
  Calibration calibration = testing::NoisyFlangeCalibration(7, 120);
  for (int k = 0; k < 6; ++k) {
    testing::Edit(&calibration.data.positions()).at(k % 3, 20 * k) += 5e-4;
  }
  CalibrationProblem problem = calibration.Problem();
  problem.losses = TunedLosses(GetParam());
  // Near the truth, where Tukey's loss still pulls.
  Eigen::VectorXd start = calibration.model.NominalValues();
  for (const int c : problem.free_columns) {
    start[c] = calibration.true_values[c] + (c % 2 == 0 ? 1e-5 : -1e-5);
  }
  const Outcome outcome = ExpectSameSolution(problem, start);
  EXPECT_EQ(outcome.summary.num_residuals, 360);
}

TEST_P(ReducedLossTest, BitsDoNotDependOnThreads) {
  Outcome expected;
  for (const int num_threads : {1, 2, 8}) {
    SCOPED_TRACE(num_threads);
    // More observations of a block than sixteen parts take in one pass each.
    const MixedCase mixed =
        MakeMixedCase(3, Weighting::kFull, 180, num_threads);
    CalibrationProblem problem = mixed.Problem(ToldColumns(mixed));
    problem.losses = TunedLosses(GetParam());
    // As many iterations as tell bits apart.
    const Outcome outcome =
        SolveBy(Evaluation::kReduced, problem, mixed.start, 5);
    ASSERT_TRUE(outcome.summary.IsSolutionUsable()) << outcome.summary.message;
    EXPECT_EQ(outcome.summary.threads_used, num_threads);
    if (num_threads == 1) expected = outcome;
    EXPECT_TRUE(testing::SameBits(outcome.values, expected.values));
    ASSERT_EQ(outcome.summary.iterations.size(),
              expected.summary.iterations.size());
    for (std::size_t k = 0; k < expected.summary.iterations.size(); ++k) {
      EXPECT_EQ(outcome.summary.iterations[k].cost,
                expected.summary.iterations[k].cost);
      EXPECT_EQ(outcome.summary.iterations[k].step_norm,
                expected.summary.iterations[k].step_norm);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Losses, ReducedLossTest,
                         ::testing::ValuesIn(kAllLosses));

// All parameters and no prior: what the data do not tell is held by the trust
// region alone, so that predictions are compared, not values.
TEST(ReducedRankTest, PredictsTheSameWhereTheRankIsShort) {
  const MixedCase mixed = MakeMixedCase(3, Weighting::kSigmas, 10);
  const CalibrationProblem problem =
      mixed.Problem(AllColumns(mixed.model.layout()));
  ExpectSameSolution(problem, mixed.start);
}

// One axis of 40 positions and all joint parameters free: columns without
// effect at the nominal geometry are rounding, 1e-17 of the others, and grow as
// the geometry leaves it. Both ways end at a chi-square that noise explains: at
// most 40 measurements, and no less than what the parameters cannot take up by
// far.
TEST(ReducedRankTest, SolvesWhereColumnsAreRounding) {
  constexpr double kSigma = 2e-5;
  for (const Arm& nominal : {testing::Rv2ajFlange(), testing::Rv2ajWrist()}) {
    Arm real = testing::WithRv2ajDeviations(nominal);
    Dataset data = testing::NoisyPositions(real, 40, kSigma, 12);
    testing::Edit(&data.sigmas())->topRows(2).setConstant(kInfinity);
    const MeasurementModel model(nominal);
    CalibrationProblem problem{model, data, {}};
    for (int column = 0; column < 25; ++column) {
      problem.free_columns.push_back(column);
    }
    problem.start_rank = AnalyzeIdentifiability(model, data, {}).nominal_rank;
    SolverOptions options;
    options.max_iterations = 200;
    for (const Evaluation evaluation :
         {Evaluation::kAutodiff, Evaluation::kReduced}) {
      options.evaluation = evaluation;
      Eigen::VectorXd values = model.NominalValues();
      const SolverSummary summary =
          SolveLevenbergMarquardt(problem, options, &values);
      EXPECT_TRUE(summary.IsSolutionUsable()) << summary.message;
      EXPECT_GT(summary.initial_cost, 1e4);
      EXPECT_LT(summary.final_cost, 80.0) << summary.message;
      EXPECT_GT(summary.final_cost, 5.0) << summary.message;
    }
  }
}

TEST(ReducedRankTest, ReachesTheFloorOfExactData) {
  for (const int num_joints : {3, 5, 8}) {
    SCOPED_TRACE(num_joints);
    const Calibration calibration =
        testing::RandomCalibration(num_joints, 2, 5e-3);
    for (const Evaluation evaluation :
         {Evaluation::kAutodiff, Evaluation::kReduced}) {
      const Outcome outcome = SolveBy(evaluation, calibration.Problem(),
                                      calibration.model.NominalValues());
      EXPECT_EQ(outcome.summary.status, SolverStatus::kPrecisionLimit)
          << outcome.summary.message;
      // Exact data: the minimum is the truth, up to the rounding of positions.
      const Eigen::VectorXd off = outcome.values - calibration.true_values;
      EXPECT_LT(off.cwiseAbs().maxCoeff(), 1e-11);
    }
  }
}

TEST(AutomaticEvaluationTest, IsReducedWhateverTheNumberOfPoses) {
  for (const int num_poses : {10, 60, 400}) {
    const Calibration calibration =
        testing::NoisyFlangeCalibration(5, num_poses);
    const Outcome outcome =
        SolveBy(Evaluation::kAutomatic, calibration.Problem(),
                calibration.model.NominalValues());
    EXPECT_EQ(outcome.summary.evaluation, "reduced");
    Eigen::VectorXd values = calibration.model.NominalValues();
    EXPECT_EQ(SolvePseudoInverse(calibration.Problem(), {}, &values).evaluation,
              "");
  }
}

TEST(AutomaticEvaluationTest, IsToTheBitWhatItPicks) {
  for (const int num_poses : {60, 201}) {
    const Calibration calibration =
        testing::NoisyFlangeCalibration(6, num_poses);
    const Eigen::VectorXd start = calibration.model.NominalValues();
    const Outcome automatic =
        SolveBy(Evaluation::kAutomatic, calibration.Problem(), start);
    EXPECT_TRUE(testing::SameBits(
        automatic.values,
        SolveBy(Evaluation::kReduced, calibration.Problem(), start).values));
  }
}

TEST(TunedLossesTest, HasTheConstantOfEachDimension) {
  EXPECT_TRUE(TunedLosses(LossKind::kNone).empty());
  for (const LossKind kind :
       {LossKind::kHuber, LossKind::kCauchy, LossKind::kTukey}) {
    const std::vector<RobustLoss> losses = TunedLosses(kind);
    ASSERT_EQ(losses.size(), 6U);
    for (int dimension = 1; dimension <= 6; ++dimension) {
      const RobustLoss& loss = losses[dimension - 1];
      EXPECT_EQ(loss.kind, kind);
      EXPECT_EQ(loss.tuning_constant, TuningConstant(kind, dimension));
    }
  }
  // Well known, to the digits that are printed everywhere.
  EXPECT_NEAR(TunedLosses(LossKind::kHuber)[0].tuning_constant, 1.345, 5e-4);
  EXPECT_NEAR(TunedLosses(LossKind::kCauchy)[0].tuning_constant, 2.385, 5e-4);
  EXPECT_NEAR(TunedLosses(LossKind::kTukey)[0].tuning_constant, 4.685, 5e-4);
}

}  // namespace
}  // namespace alidade::internal
