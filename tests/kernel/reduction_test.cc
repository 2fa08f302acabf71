#include "src/kernel/reduction.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "alidade/robust_loss.h"
#include "src/common/random.h"
#include "src/kernel/measurement_model.h"
#include "tests/support/edit.h"
#include "tests/support/measurement_oracle.h"
#include "tests/support/random_measurements.h"

namespace alidade::internal {
namespace {

using testing::MatrixXl;
using testing::MeasuredArm;
using testing::VectorXl;

template <typename Entry>
void RepeatList(int times, std::vector<Entry>* list) {
  const std::vector<Entry> once = *list;
  for (int k = 1; k < times; ++k) {
    list->insert(list->end(), once.begin(), once.end());
  }
}

// Every observation `times` times, each with noise of its own.
void Repeat(int times, ObservationBlock* block, Random* random) {
  RepeatList(times, &block->poses);
  RepeatList(times, &block->targets);
  RepeatList(times, &block->references);
  RepeatList(times, &block->seconds);
  RepeatList(times, &block->whiteners);
  block->measured = block->measured.map().replicate(1, times).eval();
  block->sigmas = block->sigmas.map().replicate(1, times).eval();
  Eigen::MatrixXd noisy = block->measured.map();
  for (double& value : noisy.reshaped()) value += 1e-4 * random->Normal();
  block->measured = std::move(noisy);
}

// All kinds, full whiteners and rows not measured among them; whitened
// residuals of 0.1 to 100. With 180 repeats most blocks have several tiles.
MeasuredArm ManyMeasurements(int repeats, int seed) {
  Random random(51, seed);
  MeasuredArm measured =
      testing::RandomMeasurements(3, testing::Weighting::kFull, &random);
  for (ObservationBlock& block : measured.data.blocks) {
    Repeat(repeats, &block, &random);
  }
  for (double& value : measured.values) value += 1e-4 * random.Normal();
  return measured;
}

std::vector<int> AllColumns(const MeasuredArm& measured) {
  std::vector<int> columns(measured.layout.size());
  std::iota(columns.begin(), columns.end(), 0);
  return columns;
}

MeasurementModel ModelOf(const MeasuredArm& measured, int num_threads) {
  return MeasurementModel(measured.arm, measured.references, num_threads);
}

// The losses of 1 to 6 rows, each with its own constant; none for kNone.
std::vector<RobustLoss> LossesOf(LossKind kind) {
  std::vector<RobustLoss> losses;
  if (kind == LossKind::kNone) return losses;
  for (int dimension = 1; dimension <= 6; ++dimension) {
    losses.push_back({kind, TuningConstant(kind, dimension)});
  }
  return losses;
}

// The normal equations in long double, row by row.
struct Normal {
  MatrixXl matrix;    ///< sum rho' J^T J
  VectorXl gradient;  ///< sum rho' J^T r
  long double cost = 0.0L;
  int num_downweighted = 0;
};

Normal ExactNormal(const MeasuredArm& measured, const std::vector<int>& columns,
                   const std::vector<RobustLoss>& losses) {
  Linearization linearization;
  ModelOf(measured, 1)
      .Linearize(measured.values, measured.data, columns, &linearization);
  const auto p = static_cast<Eigen::Index>(columns.size());
  Normal normal{MatrixXl::Zero(p, p), VectorXl::Zero(p)};
  Eigen::Index row = 0;
  for (const ObservationBlock& block : measured.data.blocks) {
    const int height = block.rows_each();
    for (Eigen::Index i = 0; i < block.size(); ++i, row += height) {
      const MatrixXl j =
          linearization.jacobian.middleRows(row, height).cast<long double>();
      const VectorXl r =
          linearization.residuals.segment(row, height).cast<long double>();
      int dimension = 0;
      for (const double sigma : block.sigmas.col(i)) {
        dimension += std::isinf(sigma) ? 0 : 1;
      }
      double rho[3] = {static_cast<double>(r.squaredNorm()), 1.0, 0.0};
      if (!losses.empty() && dimension > 0) {
        losses[dimension - 1].Evaluate(rho[0], rho);
      }
      normal.matrix += rho[1] * j.transpose() * j;
      normal.gradient += rho[1] * j.transpose() * r;
      normal.cost += rho[0];
      normal.num_downweighted += rho[1] < 1.0 ? 1 : 0;
    }
  }
  return normal;
}

// Householder's transformations err by some tens of eps of each column's norm.
void ExpectFactorOf(const MatrixXl& exact, const Eigen::MatrixXd& factor) {
  const Eigen::MatrixXd error =
      (factor.cast<long double>().transpose() * factor.cast<long double>() -
       exact)
          .cast<double>();
  for (Eigen::Index a = 0; a < error.rows(); ++a) {
    for (Eigen::Index b = 0; b < error.cols(); ++b) {
      const double scale =
          static_cast<double>(std::sqrt(exact(a, a) * exact(b, b)));
      EXPECT_LE(std::abs(error(a, b)), 1e-13 * scale) << a << ", " << b;
    }
  }
  for (Eigen::Index c = 0; c < factor.cols(); ++c) {
    EXPECT_TRUE(factor.col(c).tail(factor.rows() - c - 1).isZero(0.0));
  }
}

class ReduceTest : public ::testing::TestWithParam<LossKind> {};

ReducedLeastSquares Reduce(const MeasurementModel& model,
                           const Eigen::VectorXd& values, const Dataset& data,
                           const std::vector<int>& columns,
                           const std::vector<RobustLoss>& losses) {
  ReducerOptions options;
  options.factorization = Factorization::kOrthogonal;
  options.cache_bytes = 0;
  Reducer reducer(model, data, columns, losses, options);
  ReducedLeastSquares problem;
  reducer.Reduce(values, &problem);
  return problem;
}

TEST_P(ReduceTest, KeepsGaussNewtonMatrixGradientAndCost) {
  const std::vector<RobustLoss> losses = LossesOf(GetParam());
  for (const int repeats : {1, 180}) {
    const MeasuredArm measured = ManyMeasurements(repeats, 1);
    const std::vector<int> columns = AllColumns(measured);
    const Normal exact = ExactNormal(measured, columns, losses);
    if (losses.empty()) {
      EXPECT_EQ(exact.num_downweighted, 0);
    } else {
      EXPECT_GT(exact.num_downweighted, 3 * repeats);
    }
    const ReducedLeastSquares problem = Reduce(
        ModelOf(measured, 2), measured.values, measured.data, columns, losses);
    ExpectFactorOf(exact.matrix, problem.factor);
    const Eigen::VectorXd error =
        (problem.factor.cast<long double>().transpose() *
             problem.projected.cast<long double>() -
         exact.gradient)
            .cast<double>();
    const auto cost = static_cast<double>(exact.cost);
    EXPECT_NEAR(problem.cost, cost, 1e-13 * cost);
    // The weighted residuals are at least as large as their projection.
    const double residual =
        std::sqrt(std::max(cost, problem.projected.squaredNorm()));
    for (Eigen::Index c = 0; c < error.size(); ++c) {
      EXPECT_LE(std::abs(error[c]),
                1e-13 * residual * problem.factor.col(c).norm());
    }
  }
}

TEST_P(ReduceTest, BitsDoNotDependOnThreads) {
  const std::vector<RobustLoss> losses = LossesOf(GetParam());
  const MeasuredArm measured = ManyMeasurements(180, 2);
  const std::vector<int> columns = AllColumns(measured);
  const auto reduce = [&](int num_threads) {
    return Reduce(ModelOf(measured, num_threads), measured.values,
                  measured.data, columns, losses);
  };
  const ReducedLeastSquares expected = reduce(1);
  // Twice, as threads may happen to run one after the other.
  for (const int num_threads : {2, 8}) {
    const ReducedLeastSquares actual = reduce(num_threads);
    EXPECT_EQ(actual.factor, expected.factor) << num_threads;
    EXPECT_EQ(actual.projected, expected.projected) << num_threads;
    EXPECT_EQ(actual.cost, expected.cost) << num_threads;
  }
}

INSTANTIATE_TEST_SUITE_P(Losses, ReduceTest,
                         ::testing::Values(LossKind::kNone, LossKind::kHuber,
                                           LossKind::kCauchy,
                                           LossKind::kTukey));

// The cost has the gradient that the problem claims: 2 R^T projected, by
// differences of the cost alone.
TEST(ReduceGradientTest, IsThatOfTheRobustCost) {
  const std::vector<RobustLoss> losses = LossesOf(LossKind::kCauchy);
  const MeasuredArm measured = ManyMeasurements(2, 3);
  const std::vector<int> columns = AllColumns(measured);
  const MeasurementModel model = ModelOf(measured, 1);
  const auto reduce = [&](const Eigen::VectorXd& values) {
    return Reduce(model, values, measured.data, columns, losses);
  };
  const ReducedLeastSquares problem = reduce(measured.values);
  const Eigen::VectorXd gradient =
      2.0 * problem.factor.transpose() * problem.projected;
  for (const int column : columns) {
    const auto difference = [&](double step) {
      Eigen::VectorXd above = measured.values;
      Eigen::VectorXd below = measured.values;
      above[column] += step;
      below[column] -= step;
      return (reduce(above).cost - reduce(below).cost) /
             (above[column] - below[column]);
    };
    const double h = 1e-7;
    const double slope = (4.0 * difference(0.5 * h) - difference(h)) / 3.0;
    const double scale =
        problem.factor.col(column).norm() * std::sqrt(problem.cost);
    // The step moves whitened residuals by a tenth at most: some 1e-8 is left
    // of the truncation, and of the cost's rounding divided by the step.
    EXPECT_NEAR(slope, gradient[column], 2e-7 * scale)
        << model.layout().parameter(column).name;
  }
}

// Against the template's errors: the cost with each loss, and the largest and
// the mean length.
TEST(ReducerTest, SummarizesAllKinds) {
  const MeasuredArm measured = ManyMeasurements(30, 7);
  const MeasurementModel model = ModelOf(measured, 2);
  const SharedVector errors = model.Errors(measured.values, measured.data);
  const SharedVector lengths = LengthErrors(errors, measured.data);
  const double rms = lengths.map().norm() / std::sqrt(double(lengths.size()));
  for (const LossKind kind : {LossKind::kNone, LossKind::kHuber,
                              LossKind::kCauchy, LossKind::kTukey}) {
    const std::vector<RobustLoss> losses = LossesOf(kind);
    Reducer reducer(model, measured.data, AllColumns(measured), losses);
    const ResidualSummary summary = reducer.Summarize(measured.values);
    const double cost = RobustChiSquare(errors, measured.data, losses);
    EXPECT_NEAR(summary.cost, cost, 1e-12 * cost);
    EXPECT_NEAR(summary.max_error, lengths.map().maxCoeff(), 1e-14);
    EXPECT_NEAR(summary.rms_error, rms, 1e-14);
    // The same of an evaluation with derivatives, and kept from it.
    ReducedLeastSquares problem;
    reducer.Reduce(measured.values, &problem);
    EXPECT_NEAR(problem.cost, cost, 1e-12 * cost);
    EXPECT_EQ(reducer.Summarize(measured.values).cost, problem.cost);
    Eigen::VectorXd moved = measured.values;
    moved[0] += 1e-3;
    EXPECT_NE(reducer.Summarize(moved).cost, problem.cost);
  }
}

// Four of five parameters have a prior: a row of its own below the data.
TEST(ReducerTest, TakesPriorsAsObservations) {
  const MeasuredArm measured = ManyMeasurements(2, 9);
  const MeasurementModel model = ModelOf(measured, 1);
  const std::vector<int> columns = AllColumns(measured);
  Normal exact = ExactNormal(measured, columns, {});
  ReducerOptions options;
  options.priors = Eigen::VectorXd::Constant(measured.values.size(), 1e-3);
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const int c = columns[k];
    if (k % 5 == 0) {
      options.priors[c] = k % 2 == 0 ? std::nan("") : HUGE_VAL;
      continue;
    }
    const auto row = static_cast<Eigen::Index>(k);
    const long double weight = 1.0L / static_cast<long double>(1e-3);
    const long double off =
        static_cast<long double>(measured.values[c]) - model.NominalValues()[c];
    exact.matrix(row, row) += weight * weight;
    exact.gradient[row] += weight * weight * off;
    exact.cost += weight * weight * off * off;
  }
  EXPECT_GT(exact.cost, 1.01L * ExactNormal(measured, columns, {}).cost);
  for (const Factorization factorization :
       {Factorization::kOrthogonal, Factorization::kGram}) {
    options.factorization = factorization;
    Reducer reducer(model, measured.data, columns, {}, options);
    ReducedLeastSquares problem;
    reducer.Reduce(measured.values, &problem);
    ExpectFactorOf(exact.matrix, problem.factor);
    const auto cost = static_cast<double>(exact.cost);
    EXPECT_NEAR(problem.cost, cost, 1e-13 * cost);
    EXPECT_EQ(reducer.Summarize(measured.values).cost, problem.cost);
    const Eigen::VectorXd error =
        (problem.factor.cast<long double>().transpose() *
             problem.projected.cast<long double>() -
         exact.gradient)
            .cast<double>();
    for (Eigen::Index c = 0; c < error.size(); ++c) {
      EXPECT_LE(std::abs(error[c]),
                1e-13 * std::sqrt(cost) * problem.factor.col(c).norm());
    }
  }
}

// What was not measured says nothing, whatever the data hold there.
TEST(ReducerTest, PassesOverNanThatWasNotMeasured) {
  MeasuredArm measured = ManyMeasurements(2, 8);
  const MeasurementModel model = ModelOf(measured, 1);
  const std::vector<int> columns = AllColumns(measured);
  const ReducedLeastSquares expected =
      Reduce(model, measured.values, measured.data, columns, {});
  int num_nan = 0;
  for (ObservationBlock& block : measured.data.blocks) {
    for (Eigen::Index i = 0; i < block.size(); ++i) {
      for (int row = 0; row < block.rows_each(); ++row) {
        // A half-measured orientation has no meaning: all of it or nothing.
        if (row >= 3 || !std::isinf(block.sigmas(row, i))) continue;
        testing::Edit(&block.measured).at(row, i) =
            std::numeric_limits<double>::quiet_NaN();
        ++num_nan;
      }
    }
  }
  ASSERT_GE(num_nan, 3);
  const ReducedLeastSquares actual =
      Reduce(model, measured.values, measured.data, columns, {});
  EXPECT_EQ(actual.factor, expected.factor);
  EXPECT_EQ(actual.projected, expected.projected);
  EXPECT_EQ(actual.cost, expected.cost);
}

TEST(JacobianFactorTest, OfNoColumnsIsEmpty) {
  const MeasuredArm measured = ManyMeasurements(1, 9);
  EXPECT_EQ(
      JacobianFactor(ModelOf(measured, 1), measured.values, measured.data, {})
          .size(),
      0);
}

// One less than a tile holds, as many, one more.
TEST(JacobianFactorTest, TilesMayBeFullOrNot) {
  MeasuredArm measured = ManyMeasurements(20, 10);
  for (ObservationBlock& block : measured.data.blocks) {
    if (block.kind != MeasurementKind::kPosition) block = {};
  }
  const ObservationBlock all = measured.data.blocks.front();
  for (const int size : {1, 63, 64, 65, 100}) {
    ObservationBlock& block = measured.data.blocks.front();
    block = all;
    block.poses.resize(size);
    block.targets.assign(size, 0);
    block.measured = all.measured.map().leftCols(size);
    block.sigmas = all.sigmas.map().leftCols(size);
    if (!all.whiteners.empty()) block.whiteners.resize(size);
    const std::vector<int> columns = {0, 3, 7, 9};
    ExpectFactorOf(ExactNormal(measured, columns, {}).matrix,
                   JacobianFactor(ModelOf(measured, 1), measured.values,
                                  measured.data, columns));
  }
}

// Sigmas that are all the same are kept once, those of a last tile that is not
// full besides.
TEST(JacobianFactorTest, OneSigmaMayBeThatOfManyTiles) {
  MeasuredArm measured = ManyMeasurements(60, 11);
  for (ObservationBlock& block : measured.data.blocks) {
    if (block.kind != MeasurementKind::kPosition) block = {};
  }
  const ObservationBlock all = measured.data.blocks.front();
  ASSERT_GE(all.size(), 200);
  for (const int size : {127, 128, 129, 191, 200}) {
    ObservationBlock& block = measured.data.blocks.front();
    block = all;
    block.poses.resize(size);
    block.targets.assign(size, 0);
    block.measured = all.measured.map().leftCols(size);
    block.sigmas = Eigen::MatrixXd::Constant(3, size, 2e-4);
    block.whiteners.clear();
    const std::vector<int> columns = {0, 3, 7, 9};
    Linearization rows;
    ModelOf(measured, 1)
        .Linearize(measured.values, measured.data, columns, &rows);
    // Derivatives of lengths over it, by sigmas of which one differs: each is
    // kept by itself.
    Dataset others = measured.data;
    Eigen::MatrixXd sigmas = Eigen::MatrixXd::Ones(3, size);
    sigmas(0, 0) = 2.0;
    others.blocks.front().sigmas = sigmas;
    Linearization lengths;
    ModelOf(measured, 1).Linearize(measured.values, others, columns, &lengths);
    lengths.jacobian.row(0) *= 2.0;
    lengths.residuals[0] *= 2.0;
    EXPECT_LE((rows.jacobian - lengths.jacobian / 2e-4).cwiseAbs().maxCoeff(),
              1e-14 * rows.jacobian.cwiseAbs().maxCoeff());
    EXPECT_LE((rows.residuals - lengths.residuals / 2e-4).cwiseAbs().maxCoeff(),
              1e-14 * rows.residuals.cwiseAbs().maxCoeff());
    ExpectFactorOf(ExactNormal(measured, columns, {}).matrix,
                   JacobianFactor(ModelOf(measured, 1), measured.values,
                                  measured.data, columns));
  }
}

TEST(JacobianFactorTest, IsAFactorOfAllBlocksTogether) {
  for (const int repeats : {1, 180}) {
    const MeasuredArm measured = ManyMeasurements(repeats, 4);
    const std::vector<int> columns = AllColumns(measured);
    const Eigen::MatrixXd factor = JacobianFactor(
        ModelOf(measured, 2), measured.values, measured.data, columns);
    ExpectFactorOf(ExactNormal(measured, columns, {}).matrix, factor);
    EXPECT_EQ(factor, JacobianFactor(ModelOf(measured, 1), measured.values,
                                     measured.data, columns));
  }
}

TEST(JacobianFactorTest, OfSomeColumnsIsThatOfTheirSelection) {
  const MeasuredArm measured = ManyMeasurements(20, 5);
  const std::vector<int> columns = {
      *measured.layout.Find("point4_y"), *measured.layout.Find("theta2"),
      *measured.layout.Find("plane1_u"), *measured.layout.Find("tool2_rx"),
      *measured.layout.Find("beta1")};
  const Eigen::MatrixXd factor = JacobianFactor(
      ModelOf(measured, 1), measured.values, measured.data, columns);
  ASSERT_EQ(factor.rows(), 5);
  ExpectFactorOf(ExactNormal(measured, columns, {}).matrix, factor);
}

TEST(ReduceEmptyTest, AnEmptyDataSetIsAProblemOfZeros) {
  MeasuredArm measured = ManyMeasurements(1, 6);
  measured.data.blocks = {testing::MakeBlock(MeasurementKind::kPose, 0)};
  const ReducedLeastSquares problem =
      Reduce(ModelOf(measured, 2), measured.values, measured.data, {0, 3},
             LossesOf(LossKind::kHuber));
  EXPECT_EQ(problem.factor, Eigen::MatrixXd::Zero(2, 2));
  EXPECT_EQ(problem.projected, Eigen::VectorXd::Zero(2));
  EXPECT_EQ(problem.cost, 0.0);
}

}  // namespace
}  // namespace alidade::internal
