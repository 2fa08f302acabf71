#include "src/planning/efficiency.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "src/common/random.h"
#include "tests/planning/planning_test_util.h"

namespace alidade::internal {
namespace {

using testing::RandomProblem;

double LogDeterminantOf(const DesignProblem& problem,
                        const std::vector<int>& chosen) {
  return std::log((problem.known + InformationOf(problem.candidates, chosen))
                      .determinant());
}

// The largest log det M of `count` candidates, by trying all plans.
double BestByEnumeration(const DesignProblem& problem, int count) {
  const int last = problem.candidates.size() - 1;
  double best = -std::numeric_limits<double>::infinity();
  std::vector<int> plan(count, 0);
  for (;;) {
    best = std::max(best, LogDeterminantOf(problem, plan));
    int place = count - 1;
    while (place >= 0 && plan[place] == last) --place;
    if (place < 0) return best;
    std::fill(plan.begin() + place, plan.end(), plan[place] + 1);
  }
}

// It is a bound of all plans, good and bad ones: never above what trying all
// finds, with and without something known.
TEST(DeterminantEfficiencyTest, IsNeverAboveTheTrueOne) {
  Random random(5);
  for (int trial = 0; trial < 24; ++trial) {
    const DesignProblem problem =
        RandomProblem(3, 1 + trial % 3, 9, trial % 4 < 2 ? 0.0 : 0.7, &random);
    const double best = BestByEnumeration(problem, 5);
    std::vector<int> chosen(5);
    for (int& k : chosen) k = static_cast<int>(random.Uniform() * 9.0);
    const double own = LogDeterminantOf(problem, chosen);
    if (!(own > -5.0)) continue;  // singular, or nearly so
    const double efficiency = DeterminantEfficiency(problem, chosen, 1);
    EXPECT_LE(efficiency, std::exp((own - best) / 3.0) + 1e-12) << trial;
    EXPECT_GT(efficiency, 0.0);
  }
}

// Three directions at right angles, each as often as the others, are the best
// weights there are, and so is a plan that has each as often.
TEST(DeterminantEfficiencyTest, IsOneWhereThePlanHasTheBestWeights) {
  DesignProblem problem;
  problem.candidates.rows_each = 1;
  problem.candidates.transposed.setZero(3, 5);
  problem.candidates.transposed.leftCols<3>() =
      2.0 * Eigen::Matrix3d::Identity();
  problem.candidates.transposed.col(3) << 1.0, 1.0, 0.5;
  problem.candidates.transposed.col(4) << 0.0, 1.0, -1.0;
  problem.known = Eigen::Matrix3d::Zero();
  problem.joint_values = Eigen::MatrixXd::Zero(2, 5);
  EXPECT_NEAR(DeterminantEfficiency(problem, {0, 0, 1, 1, 2, 2}, 1), 1.0,
              1e-12);
  // 3 of the first, 2, 1: det is 6 of 8.
  EXPECT_NEAR(DeterminantEfficiency(problem, {0, 0, 0, 1, 1, 2}, 1),
              std::cbrt(6.0 / 8.0), 1e-9);
}

TEST(DeterminantEfficiencyTest, ThreadsChangeNothing) {
  Random random(6);
  const DesignProblem problem = RandomProblem(5, 3, 900, 0.1, &random);
  const std::vector<int> chosen = {3, 50, 51, 400, 700, 899};
  EXPECT_EQ(DeterminantEfficiency(problem, chosen, 1),
            DeterminantEfficiency(problem, chosen, 3));
}

}  // namespace
}  // namespace alidade::internal
