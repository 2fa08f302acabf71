#include "src/kernel/robust_fit.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <utility>
#include <vector>

#include "src/common/random.h"
#include "src/initialization/frame_models.h"
#include "tests/initialization/frame_start_util.h"

namespace alidade::internal::robust_fit_test {
namespace {

using testing::NormalVector;
using testing::RandomFlangePoses;
using testing::RandomFrame;

// Positions of one target, and a model that counts how often it is linearized.
struct CountedModel : PositionStartModel {
  int* count = nullptr;
  int name = 0;

  void Linearize(FitRows* rows) const {
    ++*count;
    PositionStartModel::Linearize(rows);
  }
};

class Positions {
 public:
  // Of an instrument `distance` away, with normal noise (m).
  Positions(double distance, double noise, Random* random)
      : flanges_(RandomFlangePoses(30, random)),
        measured_(3, 30),
        target_of_observation_(30, 0) {
    truth_ = RandomFrame(1.0, random);
    truth_.translation() *= distance;
    for (Eigen::Index i = 0; i < measured_.cols(); ++i) {
      measured_.col(i) =
          truth_ * (flanges_[i] * target_) + NormalVector(noise, random);
    }
  }

  // Some degrees and millimetres off.
  CountedModel Start(int name = 0) {
    CountedModel model;
    model.base_from_last = &flanges_;
    model.measured = &measured_;
    model.target_of_observation = &target_of_observation_;
    model.instrument_from_base = truth_;
    model.targets = target_ + Eigen::Vector3d(0.01, -0.02, 0.03);
    model.instrument_from_base.rotate(Eigen::AngleAxisd(
        0.1 + 0.01 * name, Eigen::Vector3d(1.0, 2.0, 2.0) / 3.0));
    model.count = &count_;
    model.name = name;
    return model;
  }

  int TakeCount() { return std::exchange(count_, 0); }
  const Eigen::Vector3d& target() const { return target_; }
  Poses& flanges() { return flanges_; }

 private:
  Poses flanges_;
  Eigen::Matrix3Xd measured_;
  std::vector<int> target_of_observation_;
  Eigen::Isometry3d truth_ = Eigen::Isometry3d::Identity();
  Eigen::Vector3d target_{0.05, -0.1, 0.15};
  int count_ = 0;
};

struct Place {
  double distance;
  double noise;
};

class RefineTest : public ::testing::TestWithParam<Place> {};

// A step each for the damping's way from 1e-4 to 0, at most, and twenty for
// Huber's weights, which settle by a factor of four a step. What rounding
// hides, which is more the further the instrument, must not be gone round in to
// the limit of 60.
TEST_P(RefineTest, EndsBeforeTheLimitOfIterations) {
  for (int seed = 0; seed < 10; ++seed) {
    Random random(31, seed);
    Positions positions(GetParam().distance, GetParam().noise, &random);
    CountedModel model = positions.Start();
    Refine(FitWeighting::kHuber, 60, kSmallestStep, &model);
    const int count = positions.TakeCount();
    EXPECT_GE(count, 4) << seed;
    EXPECT_LE(count, 35) << seed;
    // The prior of targets moves them by some 1e-11 m where there is no noise.
    EXPECT_LT((model.targets.col(0) - positions.target()).norm(),
              3.0 * GetParam().noise + 1e-9)
        << seed;
  }
}

INSTANTIATE_TEST_SUITE_P(Places, RefineTest,
                         ::testing::Values(Place{1.0, 0.0}, Place{1.0, 1e-9},
                                           Place{10.0, 1e-9}, Place{10.0, 1e-4},
                                           Place{1e3, 1e-6}, Place{1e5, 1e-4}));

TEST(FitFromStartsTest, OfStartsThatEndAlikeTheFirstIsTaken) {
  Random random(32);
  Positions positions(3.0, 1e-4, &random);
  for (const bool turned : {false, true}) {
    std::vector<CountedModel> starts = {positions.Start(1), positions.Start(2)};
    if (turned) std::swap(starts[0], starts[1]);
    const auto best = FitFromStarts(starts);
    ASSERT_TRUE(best);
    EXPECT_EQ(best->name, starts[0].name);
  }
}

// The sum by which steps are judged is that of the rows which the step solves.
TEST(WeighedSumTest, IsThatOfTheWeighedRows) {
  Random random(33);
  Positions positions(2.0, 1e-3, &random);
  const CountedModel model = positions.Start();
  FitRows rows;
  model.Linearize(&rows);
  Eigen::VectorXd weights(30);
  for (double& weight : weights) weight = random.Uniform(0.0, 1.0);
  const double sum = WeighedSum(rows, weights, 0.01, model.targets);
  WeighRows(weights, 0.01, model.targets, PositionStartModel::kTargetColumn,
            &rows);
  EXPECT_NEAR(sum / rows.residuals.squaredNorm(), 1.0, 1e-13);
  // The prior of 0.5 m is a part of it.
  EXPECT_NEAR(rows.residuals.tail(3).norm(), 0.02 * model.targets.norm(),
              1e-15);
}

}  // namespace
}  // namespace alidade::internal::robust_fit_test
