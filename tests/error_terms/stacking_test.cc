#include "src/error_terms/stacking.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "src/common/random.h"

namespace alidade::internal {
namespace {

// Residuals of rungs that miss the truth by noise of their own sizes and by
// some that all have.
std::vector<FoldErrors> DrawFolds(const Eigen::VectorXd& sizes, double common,
                                  Random* random) {
  std::vector<FoldErrors> folds;
  int pose = 0;
  for (int f = 0; f < 13; ++f) {
    FoldErrors fold;
    fold.is_region = f < 8;
    for (int k = 0; k < 40; ++k) {
      Eigen::MatrixXd residual(3, sizes.size());
      for (int row = 0; row < 3; ++row) {
        const double shared = common * random->Normal();
        for (Eigen::Index rung = 0; rung < sizes.size(); ++rung) {
          residual(row, rung) = shared + sizes[rung] * random->Normal();
        }
      }
      fold.residuals.push_back(residual);
      fold.poses.push_back(pose++);
    }
    folds.push_back(fold);
  }
  return folds;
}

// The sum that the weights make least, as stacking.h has it.
double SumWith(const std::vector<FoldErrors>& folds,
               const Eigen::VectorXd& weights) {
  double sum = 0.0;
  for (const FoldErrors& fold : folds) {
    std::vector<double> smallest;
    for (const Eigen::MatrixXd& residual : fold.residuals) {
      double least = std::numeric_limits<double>::infinity();
      for (const auto& column : residual.colwise()) {
        least = std::min(least, column.norm());
      }
      smallest.push_back(least);
    }
    std::vector<double> sorted = smallest;
    std::sort(sorted.begin(), sorted.end());
    const double median = sorted[sorted.size() / 2];
    for (std::size_t k = 0; k < smallest.size(); ++k) {
      sum += std::min(1.0, median / smallest[k]) *
             (fold.residuals[k] * weights).squaredNorm();
    }
  }
  return sum;
}

TEST(StackTest, WeightsAreThoseOfTheGrid) {
  Random random(150);
  const std::vector<Eigen::Vector3d> sizes = {
      {1.0, 0.8, 1.2}, {3.0, 0.5, 0.6}, {0.4, 2.0, 2.5}, {1.0, 1.0, 1.0}};
  for (const Eigen::Vector3d& size : sizes) {
    const std::vector<FoldErrors> folds = DrawFolds(size, 0.5, &random);
    const StackingResult result = Stack(folds);
    EXPECT_NEAR(result.weights.sum(), 1.0, 1e-14);
    EXPECT_GE(result.weights.minCoeff(), 0.0);
    constexpr int kSteps = 100;
    double least = std::numeric_limits<double>::infinity();
    Eigen::Vector3d best;
    for (int a = 0; a <= kSteps; ++a) {
      for (int b = 0; a + b <= kSteps; ++b) {
        const Eigen::Vector3d weights =
            Eigen::Vector3d(a, b, kSteps - a - b) / kSteps;
        const double sum = SumWith(folds, weights);
        if (sum >= least) continue;
        least = sum;
        best = weights;
      }
    }
    EXPECT_LE(SumWith(folds, result.weights), least * (1.0 + 1e-12));
    EXPECT_LT((result.weights - best).cwiseAbs().maxCoeff(),
              0.5 / kSteps + 0.01);
  }
}

TEST(StackTest, OneOutlierDoesNotDecide) {
  Random random(151);
  std::vector<FoldErrors> folds =
      DrawFolds(Eigen::Vector2d(1.0, 0.3), 0.0, &random);
  const double weight = Stack(folds).weights[1];
  // An observation that is off in all rungs, if less so in the first.
  folds[2].residuals[5] << 900, 1000, 900, 1000, 900, 1000;
  EXPECT_NEAR(Stack(folds).weights[1], weight, 0.3);
  EXPECT_GT(Stack(folds).share, 0.9);
}

TEST(StackTest, NoGainIsNotTaken) {
  Random random(152);
  // The second rung is the first one and more noise, or the same.
  EXPECT_EQ(Stack(DrawFolds(Eigen::Vector2d(0.0, 2.0), 0.5, &random)).share,
            0.0);
  std::vector<FoldErrors> same =
      DrawFolds(Eigen::Vector2d(0.5, 2.0), 0.0, &random);
  for (FoldErrors& fold : same) {
    for (Eigen::MatrixXd& residual : fold.residuals) {
      residual.col(1) = residual.col(0);
    }
  }
  const StackingResult result = Stack(same);
  EXPECT_EQ(result.share, 0.0);
  EXPECT_EQ(result.t_random, 0.0);
}

TEST(StackTest, ShareIsOfTheSmallerEvidence) {
  Random random(153);
  for (const double size : {0.95, 0.8, 0.4}) {
    const StackingResult result =
        Stack(DrawFolds(Eigen::Vector2d(1.0, size), 0.3, &random));
    const double t = std::min(result.t_regions, result.t_random);
    const double expected = t > 2.0 ? 1.0 - 8.0 / (t * t * t) : 0.0;
    EXPECT_DOUBLE_EQ(result.share, expected);
  }
  // A gain in random folds alone, lost where regions are left out.
  std::vector<FoldErrors> folds =
      DrawFolds(Eigen::Vector2d(1.0, 0.4), 0.0, &random);
  for (FoldErrors& fold : folds) {
    for (Eigen::MatrixXd& residual : fold.residuals) {
      residual.col(1) = (fold.is_region ? 1.2 : 0.3) * residual.col(0);
    }
  }
  const StackingResult result = Stack(folds);
  EXPECT_GT(result.weights[1], 0.5);
  EXPECT_GT(result.t_random, 10.0);
  EXPECT_LT(result.t_regions, 0.0);
  EXPECT_EQ(result.share, 0.0);
}

// Two folds of two poses and one row each, by hand.
TEST(StackTest, EvidenceIsAsWorkedOutByHand) {
  const auto row = [](double geometry, double other) {
    return Eigen::MatrixXd(Eigen::RowVector2d(geometry, other));
  };
  std::vector<FoldErrors> folds(4);
  for (int f = 0; f < 4; ++f) folds[f].is_region = f < 2;
  // The other rung is right, so it has all the weight of every fold.
  const double errors[4][2] = {{1.0, 3.0}, {2.0, 2.0}, {1.0, 2.0}, {3.0, 2.0}};
  int pose = 0;
  for (int f = 0; f < 4; ++f) {
    for (const double error : errors[f]) {
      folds[f].residuals.push_back(row(error, 0.5));
      folds[f].poses.push_back(pose++);
    }
  }
  const StackingResult result = Stack(folds);
  EXPECT_NEAR(result.weights[1], 1.0, 1e-9);
  // Mean errors of regions are 2 and 2, so are their ratios: no spread.
  EXPECT_GT(result.t_regions, 1e9);
  // Gains 0.5, 1.5, 2.5, 1.5, below four times their median: mean 1.5,
  // variance 2/3.
  EXPECT_NEAR(result.t_random, 1.5 / std::sqrt(2.0 / 3.0 / 4.0), 1e-8);
}

}  // namespace
}  // namespace alidade::internal
