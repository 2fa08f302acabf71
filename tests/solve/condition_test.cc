// Solves whose columns are nearly dependent, and when products may take the
// place of transformations.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "alidade/units.h"
#include "src/common/random.h"
#include "src/kernel/reduction.h"
#include "src/model/joint_draw.h"
#include "src/solve/solve.h"
#include "tests/support/edit.h"
#include "tests/support/rv2aj_arms.h"

namespace alidade::internal {
namespace {

constexpr double kSigma = 0.02 * kMillimetre;

struct Measured {
  MeasurementModel model;
  Dataset data;
  std::vector<int> columns;

  CalibrationProblem Problem() const { return {model, data, columns}; }
};

// The RV-2AJ at its flange, the axis of joint 1 skewed against the base by
// `skew` (rad): r1 and base_z act alike but for that, and both are linear, so
// that the condition is all that is hard. Noise of 0.02 mm about an arm that is
// off by what Normal(0, 1e-4) says.
Measured MakeMeasured(double skew, int poses, int threads = 1) {
  Arm arm = testing::Rv2ajFlange();
  arm.joints[0].alpha = skew;
  Measured measured{MeasurementModel(arm, threads), {}, {}};
  const ParameterLayout& layout = measured.model.layout();
  for (const char* name : {"alpha2", "d2", "d3", "d4", "d5", "theta1", "theta2",
                           "theta3", "r1", "r2", "r5", "base_z"}) {
    measured.columns.push_back(*layout.Find(name));
  }
  std::sort(measured.columns.begin(), measured.columns.end());
  Random random(81);
  Eigen::VectorXd truth = measured.model.NominalValues();
  for (const int column : measured.columns) {
    truth[column] += 1e-4 * random.Normal();
  }
  measured.data.joint_values = DrawJointValues(arm, poses, 82);
  measured.data.positions() =
      measured.model.Predict(truth, measured.data.joint_values);
  measured.data.sigmas() = Eigen::Matrix3Xd::Constant(3, poses, kSigma);
  Eigen::MatrixXd noisy = measured.data.positions().map();
  for (double& value : noisy.reshaped()) value += kSigma * random.Normal();
  measured.data.positions() = std::move(noisy);
  return measured;
}

// The condition of the Jacobian with columns of norm 1.
double Condition(const Measured& measured) {
  Eigen::MatrixXd factor =
      JacobianFactor(measured.model, measured.model.NominalValues(),
                     measured.data, measured.columns);
  factor.colwise().normalize();
  const Eigen::VectorXd singular =
      Eigen::JacobiSVD<Eigen::MatrixXd>(factor).singularValues();
  return singular[0] / singular[singular.size() - 1];
}

// The values after one undamped Gauss-Newton step, and the standard deviations
// of the free ones.
void Finish(const Measured& measured, Eigen::VectorXd* values,
            Eigen::VectorXd* sigmas) {
  Linearization rows;
  measured.model.Linearize(*values, measured.data, measured.columns, &rows);
  const Eigen::VectorXd scale = rows.jacobian.colwise().norm();
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(
      rows.jacobian * scale.cwiseInverse().asDiagonal());
  const Eigen::VectorXd step = qr.solve(rows.residuals);
  const auto p = static_cast<Eigen::Index>(measured.columns.size());
  const Eigen::MatrixXd inverse =
      qr.matrixQR().topRows(p).triangularView<Eigen::Upper>().solve(
          Eigen::MatrixXd::Identity(p, p));
  *sigmas = inverse.rowwise().norm().cwiseQuotient(scale);
  for (Eigen::Index k = 0; k < p; ++k) {
    (*values)[measured.columns[k]] -= step[k] / scale[k];
  }
}

class ConditionTest : public ::testing::TestWithParam<double> {};

// To the larger of 1e-6 and 10 sqrt(2 eps cost) standard deviations: what the
// cost, which rounds by eps of itself, tells of where its minimum is.
TEST_P(ConditionTest, BothEvaluationsHaveTheSameSolution) {
  for (const int poses : {60, 1500}) {
    const Measured measured = MakeMeasured(GetParam(), poses);
    SolverOptions options;
    options.initial_trust_region_radius = 1e20;
    Eigen::VectorXd solutions[2];
    Eigen::VectorXd sigmas;
    double cost = 0.0;
    for (const bool reduced : {false, true}) {
      options.evaluation =
          reduced ? Evaluation::kReduced : Evaluation::kAutodiff;
      Eigen::VectorXd& values = solutions[reduced ? 1 : 0];
      values = measured.model.NominalValues();
      const SolverSummary summary =
          SolveLevenbergMarquardt(measured.Problem(), options, &values);
      ASSERT_TRUE(summary.IsSolutionUsable()) << summary.FullReport();
      cost = summary.final_cost;
      Finish(measured, &values, &sigmas);
    }
    constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
    const double allowed =
        std::max(1e-6, 10.0 * std::sqrt(2.0 * kEpsilon * cost));
    for (std::size_t k = 0; k < measured.columns.size(); ++k) {
      const int column = measured.columns[k];
      EXPECT_LE(std::abs(solutions[0][column] - solutions[1][column]),
                allowed * sigmas[static_cast<Eigen::Index>(k)])
          << measured.model.layout().parameter(column).name << ", " << poses;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Skews, ConditionTest,
                         ::testing::Values(0.3, 1e-4, 1e-8));

TEST(ConditionOfTheTestTest, GoesUpTo1e8) {
  EXPECT_LT(Condition(MakeMeasured(0.3, 1500)), 1e4);
  EXPECT_GT(Condition(MakeMeasured(1e-8, 1500)), 1e8);
}

// The rule: products from the first evaluation on, where the condition is below
// 1e4, whether a sample is looked at before (1000 poses and more) or not.
TEST(GramRuleTest, ProductsAreForWellConditionedColumnsAlone) {
  struct Case {
    double skew;
    int poses;
    bool uses_products;
  };
  for (const Case& one :
       {Case{0.3, 1500, true}, Case{0.3, 900, true}, Case{1e-4, 1500, false},
        Case{1e-4, 900, false}, Case{0.0, 1500, false}}) {
    const Measured measured = MakeMeasured(one.skew, one.poses);
    const Eigen::VectorXd values = measured.model.NominalValues();
    Reducer reducer(measured.model, measured.data, measured.columns);
    ReducedLeastSquares problem;
    for (int evaluation = 0; evaluation < 2; ++evaluation) {
      reducer.Reduce(values, &problem);
      EXPECT_EQ(reducer.used_gram(), one.uses_products)
          << one.skew << ", " << one.poses;
      EXPECT_TRUE(problem.factor.allFinite());
    }
  }
}

TEST(GramRuleTest, ProductsGiveTheSameProblem) {
  const Measured measured = MakeMeasured(0.3, 1500, 2);
  const Eigen::VectorXd values = measured.model.NominalValues();
  ReducedLeastSquares problems[2];
  for (const bool gram : {false, true}) {
    ReducerOptions options;
    options.factorization =
        gram ? Factorization::kGram : Factorization::kOrthogonal;
    Reducer reducer(measured.model, measured.data, measured.columns, {},
                    options);
    reducer.Reduce(values, &problems[gram ? 1 : 0]);
    EXPECT_EQ(reducer.used_gram(), gram);
  }
  EXPECT_EQ(problems[0].cost, problems[1].cost);
  const auto gradient = [](const ReducedLeastSquares& problem) {
    return Eigen::VectorXd(problem.factor.transpose() * problem.projected);
  };
  const Eigen::VectorXd expected = gradient(problems[0]);
  const Eigen::VectorXd actual = gradient(problems[1]);
  const double norm = std::sqrt(problems[0].cost);
  for (Eigen::Index k = 0; k < expected.size(); ++k) {
    EXPECT_NEAR(actual[k], expected[k],
                1e-12 * norm * problems[0].factor.col(k).norm());
  }
  // Steps differ by eps times the condition, 1e3 squared, at most.
  const auto step = [](const ReducedLeastSquares& problem) {
    return Eigen::VectorXd(
        problem.factor.triangularView<Eigen::Upper>().solve(problem.projected));
  };
  const Eigen::VectorXd difference = step(problems[1]) - step(problems[0]);
  EXPECT_LE((problems[0].factor * difference).norm(), 1e-9 * norm);
}

TEST(GramRuleTest, BitsDoNotDependOnThreadsOrCache) {
  ReducedLeastSquares expected;
  for (const int threads : {1, 2, 8}) {
    const Measured measured = MakeMeasured(0.3, 9000, threads);
    const Eigen::VectorXd values = measured.model.NominalValues();
    ReducerOptions options;
    if (threads == 2) options.cache_bytes = 200000;
    Reducer reducer(measured.model, measured.data, measured.columns, {},
                    options);
    ReducedLeastSquares problem;
    reducer.Reduce(values, &problem);
    reducer.Reduce(values, &problem);
    EXPECT_TRUE(reducer.used_gram());
    if (threads == 1) expected = problem;
    EXPECT_EQ(problem.factor, expected.factor) << threads;
    EXPECT_EQ(problem.projected, expected.projected) << threads;
    EXPECT_EQ(problem.cost, expected.cost) << threads;
  }
}

// What products cannot factor is left to transformations.
TEST(GramRuleTest, DependentColumnsFallBack) {
  const Measured measured = MakeMeasured(0.0, 1500);
  ReducerOptions options;
  options.factorization = Factorization::kAutomatic;
  Reducer reducer(measured.model, measured.data, measured.columns, {}, options);
  // Well conditioned first, with a skew.
  Eigen::VectorXd skewed = measured.model.NominalValues();
  skewed[*measured.model.layout().Find("alpha1")] = 0.3;
  ReducedLeastSquares problem;
  reducer.Reduce(skewed, &problem);
  EXPECT_TRUE(reducer.used_gram());
  reducer.Reduce(measured.model.NominalValues(), &problem);
  EXPECT_FALSE(reducer.used_gram());
  const Eigen::MatrixXd factor =
      JacobianFactor(measured.model, measured.model.NominalValues(),
                     measured.data, measured.columns);
  EXPECT_LE(
      (problem.factor.cwiseAbs() - factor.cwiseAbs()).cwiseAbs().maxCoeff(),
      1e-12 * factor.norm());
}

}  // namespace
}  // namespace alidade::internal
