#include "src/error_terms/term_normal.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <vector>

#include "tests/error_terms/term_test_util.h"

namespace alidade::internal {
namespace {

using testing::MeasuredArm;

constexpr double kNone = std::numeric_limits<double>::infinity();

// Geometry, terms and residual of some observations as one dense matrix, rows
// times the roots of their weights.
struct DenseRows {
  Eigen::MatrixXd geometry;
  Eigen::MatrixXd terms;
  Eigen::VectorXd residuals;

  Eigen::MatrixXd All() const {
    Eigen::MatrixXd all(geometry.rows(), geometry.cols() + terms.cols() + 1);
    all << geometry, terms, residuals;
    return all;
  }
};

DenseRows DenseOf(const WeightedRows& data, const TermColumns& columns,
                  const std::vector<int>& observations) {
  Eigen::VectorXd roots = Eigen::VectorXd::Zero(data.rows.residuals.size());
  for (const int k : observations) {
    const TermRows::Observation& one = data.rows.observations[k];
    roots.segment(one.first_row, one.height)
        .setConstant(std::sqrt(data.weights[k]));
  }
  return {roots.asDiagonal() * Eigen::MatrixXd(data.rows.geometry),
          roots.asDiagonal() * testing::DenseTerms(data.rows, columns),
          roots.cwiseProduct(data.rows.residuals)};
}

// Correlations of the coefficients: functions by Matern's formula.
Eigen::MatrixXd PriorCovariance(const TermColumns& columns, double length,
                                const LogPrecisions& precisions) {
  Eigen::MatrixXd covariance =
      Eigen::MatrixXd::Zero(columns.size(), columns.size());
  for (int k = 0; k < columns.num_dense(); ++k) {
    covariance(k, k) =
        std::pow(10.0, -precisions[static_cast<int>(columns.dense()[k].group)]);
  }
  const double variance =
      std::pow(10.0, -precisions[static_cast<int>(TermGroup::kFunction)]);
  for (const FunctionKnots& knots : columns.functions()) {
    for (int a = 0; a < knots.count; ++a) {
      for (int b = 0; b < knots.count; ++b) {
        const double u =
            std::abs(a - b) * knots.spacing * std::sqrt(3.0) / length;
        covariance(columns.num_dense() + knots.offset + a,
                   columns.num_dense() + knots.offset + b) =
            variance * (1.0 + u) * std::exp(-u);
      }
      const int k = columns.num_dense() + knots.offset + a;
      covariance(k, k) += 1e-9 * variance;
    }
  }
  return covariance;
}

// Generalised least squares over the rows' own covariance I + Z K Z^T: another
// way to the same estimate, and to its restricted likelihood (Harville 1977).
struct Kriging {
  Eigen::VectorXd geometry;
  Eigen::VectorXd terms;
  double cost = 0.0;
  double criterion = 0.0;  // -2 log L but for a constant

  Kriging(const DenseRows& rows, const Eigen::MatrixXd& prior,
          double equations) {
    const Eigen::Index m = rows.residuals.size();
    const Eigen::MatrixXd covariance =
        Eigen::MatrixXd::Identity(m, m) +
        rows.terms * prior * rows.terms.transpose();
    const Eigen::LLT<Eigen::MatrixXd> factor(covariance);
    const Eigen::MatrixXd whitened = factor.matrixL().solve(rows.geometry);
    const Eigen::VectorXd measured = factor.matrixL().solve(-rows.residuals);
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(whitened);
    geometry = qr.solve(measured);
    const Eigen::VectorXd left = -rows.residuals - rows.geometry * geometry;
    terms = prior * rows.terms.transpose() * factor.solve(left);
    cost = (measured - whitened * geometry).squaredNorm();
    const double freedom =
        equations - static_cast<double>(rows.geometry.cols());
    criterion = freedom * std::log(cost / freedom) +
                2.0 * factor.matrixLLT().diagonal().array().log().sum() +
                2.0 * qr.matrixR().diagonal().cwiseAbs().array().log().sum();
  }
};

// All kinds of measurements a few times over, at other joint values.
class TermNormalTest : public ::testing::Test {
 protected:
  TermNormalTest() : measured_(testing::MeasuredForTerms(&random_)) {
    const MeasurementModel model(measured_.arm, measured_.references, 1);
    Eigen::VectorXd values = measured_.values;
    for (double& value : values) value += random_.Uniform(-1e-4, 1e-4);
    // Of the joints: frames and references are of full rank without others.
    rows_ = MakeTermRows(model, values, measured_.data, {1, 4, 9, 13, 20, 22});
    for (std::size_t k = 0; k < rows_.observations.size(); ++k) {
      weights_.conservativeResize(weights_.size() + 1);
      weights_[weights_.size() - 1] =
          k % 7 == 3 ? 0.0 : random_.Uniform(0.2, 1.0);
    }
  }

  std::vector<int> All() const {
    std::vector<int> all(rows_.observations.size());
    std::iota(all.begin(), all.end(), 0);
    return all;
  }
  WeightedRows data() const { return {rows_, weights_}; }

  Random random_ = Random(140);
  MeasuredArm measured_;
  TermRows rows_;
  Eigen::VectorXd weights_;
};

TEST_F(TermNormalTest, GramIsThatOfTheDenseRows) {
  for (const double length : {0.0, 0.4, 1.5}) {
    const TermColumns columns(measured_.arm, testing::AllTerms(length),
                              measured_.data.joint_values.map(),
                              testing::Deviations());
    for (const std::vector<int>& some :
         {All(), std::vector<int>{0, 5, 17, 30}, std::vector<int>{}}) {
      const Eigen::MatrixXd dense = DenseOf(data(), columns, some).All();
      const Eigen::MatrixXd expected = dense.transpose() * dense;
      const Eigen::MatrixXd gram = TermGram(data(), columns, some);
      ASSERT_EQ(gram.rows(), expected.rows());
      // Some hundred products, in units of the columns' norms.
      const Eigen::VectorXd norms =
          expected.diagonal().cwiseSqrt().array() + 1e-30;
      const Eigen::MatrixXd scaled = norms.cwiseInverse().asDiagonal() *
                                     (gram - expected) *
                                     norms.cwiseInverse().asDiagonal();
      EXPECT_LT(scaled.cwiseAbs().maxCoeff(), 1e-13);
      EXPECT_EQ(gram, gram.transpose());
    }
  }
}

TEST_F(TermNormalTest, RidgeIsGeneralisedLeastSquares) {
  const double length = 0.8;
  const TermColumns columns(measured_.arm, testing::AllTerms(length),
                            measured_.data.joint_values.map(),
                            testing::Deviations());
  const Eigen::VectorXd none = Eigen::VectorXd::Constant(6, kNone);
  const TermRidge ridge(columns, Eigen::VectorXd::Zero(6), none);
  const Eigen::MatrixXd gram = TermGram(data(), columns, All());
  const double unit = std::log10(gram.diagonal().head(6).mean());
  const LogPrecisions precisions = {unit - 1.0, unit, unit - 2.0, unit + 1.0,
                                    unit - 1.5, unit, unit - 0.5};
  const DenseRows dense = DenseOf(data(), columns, All());
  const Kriging expected(dense, PriorCovariance(columns, length, precisions),
                         100.0);
  const TermSolution solution = ridge.Solve(gram, precisions);
  // Both lose some digits to the condition of their matrices, and the ridge has
  // a precision of 1e-6 of what nothing determines.
  EXPECT_LT((solution.geometry - expected.geometry).norm(),
            1e-6 * expected.geometry.norm());
  EXPECT_LT((solution.terms - expected.terms).norm(),
            1e-7 * expected.terms.norm());
  EXPECT_NEAR(solution.cost, expected.cost, 1e-8 * expected.cost);
}

TEST_F(TermNormalTest, PriorsOfTheGeometryHoldItsDeviations) {
  TermSet set;
  set.elasticity = true;
  const TermColumns columns(measured_.arm, set,
                            measured_.data.joint_values.map(),
                            testing::Deviations());
  const Eigen::MatrixXd gram = TermGram(data(), columns, All());
  Eigen::VectorXd deviations(6);
  for (double& value : deviations) value = random_.Uniform(-1.0, 1.0);
  Eigen::VectorXd priors = Eigen::VectorXd::Constant(6, kNone);
  priors[2] = 1e-9;
  priors[3] = 1e-3;
  const TermRidge ridge(columns, deviations, priors);
  const LogPrecisions precisions = {3.0, 3.0};
  const TermSolution solution = ridge.Solve(gram, precisions);
  EXPECT_NEAR(solution.geometry[2], -deviations[2], 1e-8);
  // The same by rows of their own.
  const DenseRows dense = DenseOf(data(), columns, All());
  const Eigen::Index m = dense.residuals.size();
  const Eigen::Index size = 6 + columns.size();
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(m + size, size);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(m + size);
  matrix.topRows(m) << dense.geometry, dense.terms;
  right.head(m) = -dense.residuals;
  for (const int k : {2, 3}) {
    matrix(m + k, k) = 1.0 / priors[k];
    right[m + k] = -deviations[k] / priors[k];
  }
  for (int k = 0; k < columns.size(); ++k) {
    matrix(m + 6 + k, 6 + k) = std::sqrt(1e3);
  }
  const Eigen::VectorXd x = matrix.colPivHouseholderQr().solve(right);
  EXPECT_LT((solution.geometry - x.head(6)).norm(), 1e-6 * x.head(6).norm());
  EXPECT_LT((solution.terms - x.tail(columns.size())).norm(),
            1e-6 * x.tail(columns.size()).norm());
}

TEST_F(TermNormalTest, CovarianceIsTheInverseOfThePenalisedMatrix) {
  TermSet set;
  set.elasticity = true;
  set.scale = true;
  const TermColumns columns(measured_.arm, set,
                            measured_.data.joint_values.map(),
                            testing::Deviations());
  const Eigen::MatrixXd gram = TermGram(data(), columns, All());
  const TermRidge ridge(columns, Eigen::VectorXd::Zero(6),
                        Eigen::VectorXd::Constant(6, 10.0));
  const LogPrecisions precisions = {2.0, 1.0, 0.0, 0.0, 1.5};
  Eigen::MatrixXd penalised =
      gram.topLeftCorner(6 + columns.size(), 6 + columns.size());
  penalised.diagonal().head(6).array() += 1e-2;
  for (int k = 0; k < columns.size(); ++k) {
    const auto group = static_cast<int>(columns.dense()[k].group);
    penalised(6 + k, 6 + k) += std::pow(10.0, precisions[group]);
  }
  const Eigen::MatrixXd covariance = ridge.Covariance(gram, precisions);
  const Eigen::MatrixXd product = covariance * penalised;
  EXPECT_LT(
      (product - Eigen::MatrixXd::Identity(product.rows(), product.cols()))
          .cwiseAbs()
          .maxCoeff(),
      1e-5);
}

TEST_F(TermNormalTest, HopelessMatrixHasInfiniteCost) {
  TermSet set;
  set.elasticity = true;
  const TermColumns columns(measured_.arm, set,
                            measured_.data.joint_values.map(),
                            testing::Deviations());
  const Eigen::Index size = 6 + columns.size() + 1;
  const TermRidge ridge(columns, Eigen::VectorXd::Zero(6),
                        Eigen::VectorXd::Constant(6, kNone));
  const TermSolution solution =
      ridge.Solve(-1e9 * Eigen::MatrixXd::Identity(size, size), {});
  EXPECT_TRUE(std::isinf(solution.cost));
  EXPECT_TRUE(solution.geometry.isZero(0.0));
  EXPECT_TRUE(solution.terms.isZero(0.0));
}

// Positions of an arm of three joints at many poses, whose residuals are drawn
// from the prior of the terms and noise.
class ScaleTest : public ::testing::TestWithParam<int> {
 protected:
  static constexpr double kLength = 0.5;
  static constexpr int kPoses = 150;

  ScaleTest() {
    testing::RandomArmOptions options;
    options.prismatic_fraction = 0.0;
    arm_ = testing::RandomArm(3, &random_, options);
    data_ = MakePositions(testing::RandomJointValues(arm_, kPoses, &random_),
                          Eigen::Matrix3Xd::Zero(3, kPoses), 1e-4);
    TermSet set;
    set.elasticity = true;
    set.function_length = kLength;
    columns_.emplace(arm_, set, data_.joint_values.map(), Eigen::VectorXd());
    const MeasurementModel model(arm_, 1);
    rows_ = MakeTermRows(model, model.NominalValues(), data_,
                         testing::AllColumnsOf(model.layout()));
    rows_.geometry.conservativeResize(rows_.geometry.rows(), 12);
  }

  // Residuals for prior precisions.
  void Draw(const LogPrecisions& truth, double noise) {
    const Eigen::MatrixXd prior = PriorCovariance(*columns_, kLength, truth);
    const Eigen::MatrixXd root = prior.llt().matrixL();
    Eigen::VectorXd draws(columns_->size());
    for (double& draw : draws) draw = noise * random_.Normal();
    rows_.residuals = -testing::DenseTerms(rows_, *columns_) * (root * draws);
    for (double& residual : rows_.residuals) {
      residual += noise * random_.Normal();
    }
  }

  Random random_ = Random(141, GetParam());
  Arm arm_;
  Dataset data_;
  std::optional<TermColumns> columns_;
  TermRows rows_;
};

TEST_P(ScaleTest, ChosenPrecisionsAreOfLargestLikelihoodAndNearTheTruth) {
  const auto own = static_cast<int>(TermGroup::kOwnAxis);
  const auto other = static_cast<int>(TermGroup::kOtherAxes);
  const auto function = static_cast<int>(TermGroup::kFunction);
  LogPrecisions truth = {};
  truth[own] = GetParam() % 2 == 0 ? 2.0 : 0.0;
  truth[other] = 1.0;
  truth[function] = GetParam() % 3 == 0 ? -1.0 : 1.0;
  constexpr double kNoise = 3.0;
  Draw(truth, kNoise);
  const WeightedRows data{rows_, Eigen::VectorXd::Ones(kPoses)};
  std::vector<int> all(kPoses);
  std::iota(all.begin(), all.end(), 0);
  const Eigen::MatrixXd gram = TermGram(data, *columns_, all);
  const TermRidge ridge(*columns_, Eigen::VectorXd::Zero(12),
                        Eigen::VectorXd::Constant(12, kNone));
  const ChosenScales scales = ridge.Choose(gram, 3.0 * kPoses, {});
  const LogPrecisions& chosen = scales.precisions;
  // Six knots and more a joint tell a variance to a factor of about 2; the
  // grid is half a decade.
  EXPECT_NEAR(chosen[function], truth[function], 0.8);
  EXPECT_NEAR(ridge.Solve(gram, chosen).cost / (3.0 * kPoses - 12.0),
              kNoise * kNoise, 0.25 * kNoise * kNoise);
  // No neighbour is more likely, by the other formula.
  const DenseRows dense = DenseOf(data, *columns_, all);
  const auto criterion = [&](const LogPrecisions& at) {
    return Kriging(dense, PriorCovariance(*columns_, kLength, at), 3.0 * kPoses)
        .criterion;
  };
  const double best = criterion(chosen);
  // The constants of the prior, too: sets of terms are compared by it. Both
  // have determinants of some hundred rows.
  EXPECT_NEAR(scales.criterion, best, 1e-3);
  for (const int group : {own, other, function}) {
    for (const double move : {-0.5, 0.5}) {
      LogPrecisions neighbour = chosen;
      neighbour[group] += move;
      if (neighbour[group] < -5.0 || neighbour[group] > 7.0) continue;
      EXPECT_GT(criterion(neighbour), best - 2e-3)
          << "group " << group << ", " << move;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Draws, ScaleTest, ::testing::Range(0, 4));

}  // namespace
}  // namespace alidade::internal
