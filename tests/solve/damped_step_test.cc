#include "src/solve/damped_step.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <cmath>
#include <cstdint>
#include <limits>

#include "alidade/random.h"

namespace alidade::internal {
namespace {

using LongMatrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

struct StepProblem {
  Eigen::MatrixXd factor;
  Eigen::VectorXd projected;
  DampedStep::Diagonal known;
  Eigen::VectorXd damping;
};

// A triangle whose diagonal falls to `smallest`; something is known beforehand
// of every third parameter.
StepProblem MakeProblem(int p, double smallest, std::uint64_t seed) {
  Random random(seed);
  StepProblem problem;
  problem.factor.setZero(p, p);
  problem.projected.resize(p);
  problem.known.weights.setZero(p);
  problem.known.residuals.setZero(p);
  problem.damping.resize(p);
  for (int j = 0; j < p; ++j) {
    for (int i = 0; i < j; ++i) problem.factor(i, j) = random.Normal();
    const double size = std::pow(smallest, p > 1 ? j / (p - 1.0) : 0.0);
    problem.factor(j, j) = j % 2 == 0 ? size : -size;
    problem.projected[j] = random.Normal();
    problem.damping[j] = 1e-3 * smallest * (1.0 + random.Uniform(0.0, 1.0));
    if (j % 3 == 1) {
      problem.known.weights[j] = 0.5 * smallest;
      problem.known.residuals[j] = random.Normal();
    }
  }
  return problem;
}

// [R; P; D] and [z; w; 0].
LongMatrix Stacked(const StepProblem& problem, LongMatrix* right) {
  const Eigen::Index p = problem.factor.cols();
  LongMatrix left = LongMatrix::Zero(3 * p, p);
  left.topRows(p) = problem.factor.cast<long double>();
  right->setZero(3 * p, 1);
  right->topRows(p) = problem.projected.cast<long double>();
  for (Eigen::Index k = 0; k < p; ++k) {
    left(p + k, k) = problem.known.weights[k];
    left(2 * p + k, k) = problem.damping[k];
    (*right)(p + k, 0) = problem.known.residuals[k];
  }
  return left;
}

// How far a step is from the one that orthogonal factors in extended precision
// give, in units of its length.
double RelativeError(const StepProblem& problem, const Eigen::VectorXd& step) {
  LongMatrix right;
  const LongMatrix left = Stacked(problem, &right);
  const LongMatrix exact = left.colPivHouseholderQr().solve(-right);
  return static_cast<double>((step.cast<long double>() - exact).norm() /
                             exact.norm());
}

Eigen::VectorXd Solve(const StepProblem& problem) {
  DampedStep step;
  return step.Solve(problem.factor, problem.projected, problem.known,
                    problem.damping);
}

TEST(DampedStepTest, IsThatOfTheStackedProblem) {
  for (const int p : {1, 2, 3, 17, 30}) {
    // Of random triangles the condition grows with p besides: 1e3 at most here.
    const StepProblem problem = MakeProblem(p, 0.3, p);
    EXPECT_LT(RelativeError(problem, Solve(problem)), 1e-12) << p;
  }
}

// Transformations lose eps times the condition (and its square only times the
// residual that is left, none here but the damping's); a hundred of that allow
// for the steps of the algorithm. Normal equations lose eps times the square,
// which shows that the test can tell.
TEST(DampedStepTest, DoesNotSquareTheCondition) {
  StepProblem problem = MakeProblem(8, 1e-3, 5);
  problem.known.weights.setZero();
  problem.damping.setConstant(1e-14);
  LongMatrix right;
  const LongMatrix left = Stacked(problem, &right);
  const Eigen::MatrixXd rows = left.cast<double>();
  const Eigen::VectorXd singular_values =
      Eigen::JacobiSVD<Eigen::MatrixXd>(rows).singularValues();
  const double condition = singular_values[0] / singular_values[7];
  EXPECT_GT(condition, 1e5);
  const double tolerance =
      100.0 * std::numeric_limits<double>::epsilon() * condition;
  const Eigen::VectorXd by_products =
      (rows.transpose() * rows)
          .ldlt()
          .solve(-rows.transpose() * right.cast<double>());
  EXPECT_GT(RelativeError(problem, by_products), 10.0 * tolerance);
  EXPECT_LT(RelativeError(problem, Solve(problem)), tolerance);
}

TEST(DampedStepTest, MayBeUsedAgainAtOtherSizes) {
  DampedStep step;
  for (const int p : {17, 3, 25}) {
    const StepProblem problem = MakeProblem(p, 0.3, 7);
    EXPECT_EQ(step.Solve(problem.factor, problem.projected, problem.known,
                         problem.damping),
              Solve(problem));
  }
}

// A parameter that nothing depends on stays where it is.
TEST(DampedStepTest, LeavesWhatOnlyTheDampingHolds) {
  StepProblem problem = MakeProblem(5, 0.3, 11);
  problem.factor.col(2).setZero();
  problem.damping[2] = 1e-150;
  const Eigen::VectorXd step = Solve(problem);
  EXPECT_TRUE(step.allFinite());
  EXPECT_EQ(step[2], 0.0);
}

}  // namespace
}  // namespace alidade::internal
