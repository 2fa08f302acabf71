// The reference case: 56 poses for the 18 parameters of the RV-2AJ at its
// flange, measured with 0.02 mm.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <vector>

#include "src/model/joint_draw.h"
#include "src/planning/efficiency.h"
#include "src/planning/exchange.h"
#include "tests/planning/planning_test_util.h"

namespace alidade::internal::rv2aj_plan_test {
namespace {

using testing::FlangeProblem;
using testing::FlangeRows;
using testing::Rv2ajFlange;

constexpr int kNumPoses = 56;

// The best weights of candidates, a continuous plan (Titterington 1976,
// "Algorithms for computing D-optimal designs"): each weight is multiplied by
// d_k / p, d_k = trace J_k M^-1 J_k^T, and candidates whose weight is gone are
// left out. Then max d_k / p says how far from the optimum it still is.
struct ContinuousPlan {
  Eigen::MatrixXd information;  ///< of one pose
  double excess = 0.0;          ///< max d_k / p over all candidates
};

ContinuousPlan FindContinuousPlan(const PoseRows& rows) {
  const int p = rows.num_parameters();
  Eigen::VectorXd weights =
      Eigen::VectorXd::Constant(rows.size(), 1.0 / rows.size());
  ContinuousPlan plan;
  const auto variance = [&](const Eigen::MatrixXd& inverse, int k) {
    const Eigen::MatrixXd j = rows.Pose(k);
    return (j.transpose() * inverse * j).trace();
  };
  const auto information = [&] {
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(p, p);
    for (int k = 0; k < rows.size(); ++k) {
      if (weights[k] == 0.0) continue;
      sum += weights[k] * rows.Pose(k) * rows.Pose(k).transpose();
    }
    return sum;
  };
  for (int iteration = 0; iteration < 400; ++iteration) {
    const Eigen::MatrixXd inverse =
        information().llt().solve(Eigen::MatrixXd::Identity(p, p));
    for (int k = 0; k < rows.size(); ++k) {
      if (weights[k] > 0.0) weights[k] *= variance(inverse, k) / p;
    }
    weights = (weights.array() < 1e-7).select(0.0, weights);
    weights /= weights.sum();
  }
  plan.information = information();
  const Eigen::MatrixXd inverse =
      plan.information.llt().solve(Eigen::MatrixXd::Identity(p, p));
  for (int k = 0; k < rows.size(); ++k) {
    plan.excess = std::max(plan.excess, variance(inverse, k) / p);
  }
  return plan;
}

double LogDeterminant(const Eigen::MatrixXd& matrix) {
  return 2.0 *
         Eigen::MatrixXd(matrix.llt().matrixL()).diagonal().array().log().sum();
}

// Largest predicted standard deviation of a position, from the inverse.
double Worst(const PoseRows& rows, const Eigen::MatrixXd& information) {
  const Eigen::MatrixXd inverse = information.fullPivLu().inverse();
  double worst = 0.0;
  for (int k = 0; k < rows.size(); ++k) {
    const Eigen::MatrixXd j = rows.Pose(k);
    worst = std::max(worst, (j.transpose() * inverse * j).trace());
  }
  return testing::kFlangeSigma * std::sqrt(worst);
}

class Rv2ajPlanTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    problem_ = new DesignProblem(FlangeProblem(2500, 1));
    DesignOptions options;
    options.num_poses = kNumPoses;
    options.starts = 2;
    result_ = new DesignResult(ChoosePoses(*problem_, options));
  }

  static void TearDownTestSuite() {
    delete problem_;
    delete result_;
  }

  static double Bound() {
    return testing::kFlangeSigma *
           std::sqrt(
               static_cast<double>(problem_->candidates.num_parameters()) /
               kNumPoses);
  }

  static const DesignProblem* problem_;
  static const DesignResult* result_;
};

const DesignProblem* Rv2ajPlanTest::problem_ = nullptr;
const DesignResult* Rv2ajPlanTest::result_ = nullptr;

// Kiefer and Wolfowitz: no plan is below sigma sqrt(p / N).
TEST_F(Rv2ajPlanTest, WorstPredictionIsNearTheBound) {
  ASSERT_EQ(result_->status, DesignStatus::kConverged);
  const double worst = Worst(problem_->candidates, result_->information);
  EXPECT_GE(worst, Bound());
  EXPECT_LE(worst, 1.04 * Bound());
  // Over the joint limits, their faces included: other poses than those that
  // were chosen from.
  const PoseRows others = FlangeProblem(20000, 77).candidates;
  EXPECT_LE(Worst(others, result_->information), 1.07 * Bound());
}

TEST_F(Rv2ajPlanTest, RandomPosesAreWorse) {
  const PoseRows random =
      FlangeRows(DrawJointValues(Rv2ajFlange(), kNumPoses, 3));
  std::vector<int> all(kNumPoses);
  for (int k = 0; k < kNumPoses; ++k) all[k] = k;
  EXPECT_GT(Worst(problem_->candidates, InformationOf(random, all)),
            1.5 * Bound());
}

TEST_F(Rv2ajPlanTest, ExchangeIsBetterThanGreedy) {
  EXPECT_GT(result_->value, result_->greedy_value + 1e-3);
  EXPECT_GT(result_->exchanges, 0);
}

TEST_F(Rv2ajPlanTest, EfficiencyAgainstTheContinuousOptimum) {
  const ContinuousPlan continuous = FindContinuousPlan(problem_->candidates);
  // No weights have more than `excess` times its information: it is the
  // optimum to 0.3 % itself.
  EXPECT_LT(continuous.excess, 1.003);
  const double efficiency =
      std::exp((LogDeterminant(result_->information / kNumPoses) -
                LogDeterminant(continuous.information)) /
               problem_->candidates.num_parameters());
  EXPECT_GT(efficiency / continuous.excess, 0.99);
  EXPECT_LT(efficiency, continuous.excess);
  // What the program finds is a bound, near this and nearer than the slope at
  // the plan itself.
  const double found = DeterminantEfficiency(*problem_, result_->chosen, 1);
  EXPECT_LE(found, efficiency + 1e-9);
  EXPECT_GE(found, 0.98 * efficiency);
  const double worst = Worst(problem_->candidates, result_->information);
  EXPECT_GT(found, std::exp(1.0 - std::pow(worst / Bound(), 2.0)));
}

}  // namespace
}  // namespace alidade::internal::rv2aj_plan_test
