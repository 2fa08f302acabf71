#include "src/uncertainty/residual_structure.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "src/common/distributions.h"
#include "src/uncertainty/looks.h"
#include "src/uncertainty/residual_gram.h"
#include "src/uncertainty/structure_columns.h"
#include "tests/support/noisy_positions.h"
#include "tests/uncertainty/fitted_arm.h"

namespace alidade::internal::residual_structure_test {
namespace {

using testing::Fitted;
using testing::kSigma;
using testing::MomentByHeights;
using testing::Rigid;

// Of an arm that stands, and of one that hangs on a wall.
class GravityMomentsTest : public ::testing::TestWithParam<Eigen::Vector3d> {};

INSTANTIATE_TEST_SUITE_P(Directions, GravityMomentsTest,
                         ::testing::Values(Eigen::Vector3d(0.0, 0.0, -1.0),
                                           Eigen::Vector3d(0.6, -0.8, 0.0)));

TEST_P(GravityMomentsTest, AreSlopesOfHeights) {
  Arm arm = testing::Rv2ajFlange();
  arm.errors.gravity = GetParam();
  arm.last_from_target().translation() << 0.03, -0.02, 0.05;
  const MeasurementModel model(arm);
  const Dataset data = testing::NoisyPositions(arm, 20, kSigma, 3);
  const StructureColumns columns(model, model.NominalValues(), data, 60, true);
  Linearization rows;
  model.Linearize(model.NominalValues(), data, columns.directions(), &rows);
  int checked = 0;
  for (const StructureFamily& family : columns.families()) {
    if (family.kind != StructureKind::kGravityMoment || family.joint == 0) {
      continue;
    }
    const int theta =
        model.layout().Column(ParameterKind::kTheta, family.joint - 1);
    const auto place = std::find(columns.directions().begin(),
                                 columns.directions().end(), theta) -
                       columns.directions().begin();
    for (int i = 0; i < 20; ++i) {
      Eigen::MatrixXd filled(3, columns.size());
      const Eigen::MatrixXd mine = rows.jacobian.middleRows(3 * i, 3);
      columns.Fill(i, 0, mine, filled);
      const double moment =
          MomentByHeights(arm, data.joint_values.col(i), family.joint - 1);
      const Eigen::Vector3d expected = -moment * mine.col(place);
      EXPECT_LT((filled.col(family.columns.front()) - expected).norm(),
                1e-6 * mine.col(place).norm())
          << "joint " << family.joint;
      ++checked;
    }
  }
  EXPECT_EQ(checked, 100);
}

// Against least squares of the dense rows by a singular value decomposition, at
// the solution and beside it, from where the parameters have a way to go.
TEST(StructureFitTest, GainsAreThoseOfLeastSquares) {
  const Fitted fitted(40, 1, 5, Rigid);
  for (const double beside : {0.0, 1e-6}) {
    const Eigen::VectorXd values = fitted.problem().values.array() + beside;
    const FittedProblem at = fitted.problem();
    const FittedProblem problem{at.model,  at.data,   at.free_columns,
                                at.priors, at.losses, values};
    const Looks looks = TakeLooks(problem);
    const StructureColumns columns(fitted.model(), values, looks.data,
                                   looks.residuals.size(), true);
    const ResidualGram gram =
        SumLooks(problem, looks, columns, CovarianceOf(problem).root);
    const StructureFit fit(problem, gram);
    Linearization directions;
    fitted.model().Linearize(values, fitted.data(), columns.directions(),
                             &directions);
    Eigen::MatrixXd dense(120, columns.size());
    for (int i = 0; i < 40; ++i) {
      columns.Fill(i, 0, directions.jacobian.middleRows(3 * i, 3),
                   dense.middleRows(3 * i, 3));
    }
    Linearization rows;
    fitted.model().Linearize(values, fitted.data(), problem.free_columns,
                             &rows);
    const auto squares = [&](const std::vector<int>& with) {
      Eigen::MatrixXd all(
          120, rows.jacobian.cols() + static_cast<Eigen::Index>(with.size()));
      all << rows.jacobian, dense(Eigen::all, with);
      const double nothing = 1e-8 * all.colwise().norm().maxCoeff();
      for (auto column : all.colwise()) {
        column /= std::max(nothing, column.norm());
      }
      const Eigen::JacobiSVD<Eigen::MatrixXd> svd =
          Eigen::JacobiSVD<Eigen::MatrixXd>(
              all, Eigen::ComputeThinU | Eigen::ComputeThinV)
              .setThreshold(1e-3);
      return (rows.residuals - all * svd.solve(rows.residuals)).squaredNorm();
    };
    EXPECT_NEAR(fit.AllSquares(), squares({}), 1e-6 * squares({}));
    EXPECT_NEAR(fit.AllFreedom(), 120.0 - 18.0, 1e-6);
    for (const StructureFamily& family : columns.families()) {
      const double expected = squares({}) - squares(family.columns);
      EXPECT_NEAR(fit.GainOf(family.columns).squares, expected, 1e-3)
          << NameOf(StructureTest{family.kind, family.joint, family.covariate});
    }
  }
}

// Densely, of two looks at each of twenty configurations: means, and what each
// sum says of them.
TEST(ResidualGramTest, SumsAreThoseOfTheRows) {
  const Fitted fitted(20, 2, 5, Rigid);
  const FittedProblem problem = fitted.problem();
  const Looks looks = TakeLooks(problem);
  const StructureColumns columns(fitted.model(), problem.values, looks.data,
                                 looks.residuals.size(), false);
  const Eigen::MatrixXd root = CovarianceOf(problem).root;
  const ResidualGram gram = SumLooks(problem, looks, columns, root);
  EXPECT_DOUBLE_EQ(gram.rows[kLengths], 60.0);
  EXPECT_DOUBLE_EQ(gram.inverse_counts[kLengths], 30.0);
  EXPECT_NEAR(gram.precision[kLengths] * kSigma * kSigma, 60.0, 1e-9);
  EXPECT_EQ(gram.rows[kRotations], 0.0);
  const Linearization all = fitted.Rows();
  const Eigen::MatrixXd information = all.jacobian.transpose() * all.jacobian;
  EXPECT_LT((gram.information - information).norm(),
            1e-12 * information.norm());
  Eigen::MatrixXd common = Eigen::MatrixXd::Zero(18, 18);
  Eigen::MatrixXd products = Eigen::MatrixXd::Zero(18, 18);
  ASSERT_EQ(gram.scores.cols(), 20);
  for (int i = 0; i < 20; ++i) {
    const Eigen::MatrixXd free = all.jacobian.middleRows(6 * i, 3);
    products += free.transpose() * free;
    common += 4.0 / (kSigma * kSigma) * free.transpose() * free;
    const Eigen::Vector3d mean = 0.5 * (all.residuals.segment<3>(6 * i) +
                                        all.residuals.segment<3>(6 * i + 3));
    const Eigen::Matrix3d rest =
        Eigen::Matrix3d::Identity() -
        2.0 * free * root * root.transpose() * free.transpose();
    const Eigen::Matrix3d freed =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(rest)
            .operatorInverseSqrt();
    const Eigen::VectorXd score = 2.0 * free.transpose() * (freed * mean);
    EXPECT_LT((gram.scores.col(i) - score).norm(), 1e-9 * score.norm());
  }
  EXPECT_LT((gram.common[kLengths] - common).norm(), 1e-12 * common.norm());
  EXPECT_LT((gram.products[kLengths].topLeftCorner(18, 18) - products).norm(),
            1e-12 * products.norm());
}

// The sums over positions and differences together are those of each kind,
// added.
TEST(ResidualGramTest, SumsOfSeveralKindsAreThoseOfEach) {
  const Fitted fitted(20, 1, 5, Rigid);
  const FittedProblem at = fitted.problem();
  Dataset both = fitted.data();
  ObservationBlock differences;
  differences.kind = MeasurementKind::kDifference;
  for (int i = 0; i < 12; ++i) {
    differences.poses.push_back(i);
    differences.seconds.push_back(i + 5);
  }
  differences.measured = Eigen::MatrixXd::Constant(3, 12, 0.1);
  differences.sigmas = Eigen::MatrixXd::Constant(3, 12, 0.01);
  both.blocks.push_back(differences);
  Dataset second = both;
  second.blocks.erase(second.blocks.begin());
  const Eigen::MatrixXd root = CovarianceOf(at).root;
  const auto sum = [&](const Dataset& data) {
    const FittedProblem problem{at.model,  data,      at.free_columns,
                                at.priors, at.losses, at.values};
    const Looks looks = TakeLooks(problem);
    // Of the same poses, whatever was observed at them.
    const StructureColumns columns(at.model, at.values, looks.data, 60, true);
    return SumLooks(problem, looks, columns, root);
  };
  const ResidualGram together = sum(both);
  const ResidualGram one = sum(fitted.data());
  const ResidualGram other = sum(second);
  // The order of additions differs.
  const auto expect_sum = [](const Eigen::MatrixXd& actual,
                             const Eigen::MatrixXd& expected) {
    EXPECT_LT((actual - expected).norm(), 1e-12 * expected.norm());
  };
  const Eigen::MatrixXd products =
      one.products[kLengths] + other.products[kLengths];
  expect_sum(together.products[kLengths], products);
  expect_sum(together.products[kLengths].rightCols<1>(),
             products.rightCols<1>());
  expect_sum(together.information, one.information + other.information);
  expect_sum(together.common[kLengths],
             one.common[kLengths] + other.common[kLengths]);
  EXPECT_DOUBLE_EQ(together.rows[kLengths], 60.0 + 36.0);
  EXPECT_DOUBLE_EQ(together.inverse_counts[kLengths], 60.0 + 36.0);
  EXPECT_NEAR(together.precision[kLengths],
              one.precision[kLengths] + other.precision[kLengths],
              1e-12 * together.precision[kLengths]);
}

// F of each family by its gain, and Holm's correction: the smallest of k
// p-values times k, the next times k - 1, and none below the one before.
TEST(FindStructureTest, StatisticsAreFAndPValuesHolms) {
  const Fitted fitted(60, 1, 5, Rigid);
  const FittedProblem problem = fitted.problem();
  const Looks looks = TakeLooks(problem);
  const StructureColumns columns(fitted.model(), problem.values, looks.data,
                                 looks.residuals.size(), true);
  const ResidualGram gram =
      SumLooks(problem, looks, columns, CovarianceOf(problem).root);
  StructureFit fit(problem, gram);
  const double all = fit.AllSquares();
  const std::vector<StructureTest> tests =
      FindStructure(columns.families(), &fit);
  // But those of columns that are zero.
  ASSERT_GE(tests.size(), 20U);
  double least = 0.0;
  for (std::size_t k = 0; k < tests.size(); ++k) {
    SCOPED_TRACE(NameOf(tests[k]));
    EXPECT_FALSE(tests[k].is_found);
    // The same kind may be of several families: one has this statistic.
    double nearest = 1e9;
    StructureFit::Gain best;
    const auto f_of = [&](const StructureFit::Gain& gain) {
      return gain.squares / gain.rank /
             ((all - gain.squares) / (162.0 - gain.rank));
    };
    for (const StructureFamily& family : columns.families()) {
      if (family.kind != tests[k].kind || family.joint != tests[k].joint) {
        continue;
      }
      const StructureFit::Gain gain = fit.GainOf(family.columns);
      const double off = std::abs(f_of(gain) - tests[k].statistic);
      if (!(off < nearest)) continue;
      nearest = off;
      best = gain;
    }
    EXPECT_EQ(tests[k].degrees_of_freedom, best.rank);
    EXPECT_NEAR(tests[k].explained, best.squares / all, 1e-12);
    const double p = FisherSurvival(f_of(best), best.rank, 162.0 - best.rank);
    const auto rest = static_cast<double>(tests.size() - k);
    least = std::max(least, std::min(1.0, rest * p));
    EXPECT_LT(nearest, 1e-9);
    EXPECT_NEAR(tests[k].p_value, least, 1e-9);
  }
}

}  // namespace
}  // namespace alidade::internal::residual_structure_test
