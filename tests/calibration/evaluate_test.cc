#include "src/calibration/evaluate.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

#include "alidade/rotation.h"
#include "alidade/units.h"
#include "src/common/constants.h"
#include "src/common/random.h"
#include "tests/support/edit.h"
#include "tests/support/random_measurements.h"

namespace alidade::internal::evaluate_test {
namespace {

using testing::MeasuredArm;
using testing::Weighting;

// Exact measurements carry the rounding of positions some metres away (m).
constexpr double kRounding = 1e-14;

// Exact measurements of every kind, as many as there are poses but of contacts
// with points.
class EvaluateTest : public ::testing::Test {
 protected:
  EvaluateTest()
      : random_(95),
        measured_(testing::RandomMeasurements(3, Weighting::kSigmas, &random_)),
        model_(measured_.arm, measured_.references, 1),
        data_(measured_.data) {}

  ObservationBlock& Block(MeasurementKind kind) {
    return *std::find_if(
        data_.blocks.begin(), data_.blocks.end(),
        [kind](const ObservationBlock& block) { return block.kind == kind; });
  }

  Accuracy Evaluate() const {
    return EvaluateAccuracy(model_, data_, measured_.values);
  }
  Accuracy EvaluateTurns() const {
    return EvaluateRotations(model_, data_, measured_.values);
  }

  static constexpr int kPoses = testing::kMeasuredPoses;
  // Positions, poses, distances, planes and differences, and contacts.
  static constexpr int kCounted = 5 * kPoses + testing::kContactPoints;

  Random random_;
  const MeasuredArm measured_;
  const MeasurementModel model_;
  Dataset data_;
};

TEST_F(EvaluateTest, CountsEveryKindButPointDistances) {
  EXPECT_EQ(Evaluate().n, kCounted);
  EXPECT_LE(Evaluate().max, kRounding);
  testing::Edit(&Block(MeasurementKind::kPointDistance).measured)->array() +=
      0.5;
  EXPECT_EQ(Evaluate().n, kCounted);
  EXPECT_LE(Evaluate().max, kRounding);
}

TEST_F(EvaluateTest, LengthsAreThoseOfErrorsOfPosition) {
  ObservationBlock& positions = Block(MeasurementKind::kPosition);
  testing::Edit(&positions.measured)->colwise() +=
      Eigen::Vector3d(3e-3, -4e-3, 0.0);
  testing::Edit(&Block(MeasurementKind::kDistance).measured).at(0, 2) += 2e-3;
  Accuracy accuracy = Evaluate();
  EXPECT_EQ(accuracy.n, kCounted);
  EXPECT_NEAR(accuracy.max, 5e-3, kRounding);
  EXPECT_NEAR(accuracy.mean, (kPoses * 5e-3 + 2e-3) / kCounted, kRounding);
  EXPECT_NEAR(accuracy.rms, std::sqrt((kPoses * 25e-6 + 4e-6) / kCounted),
              kRounding);
  // Of what was measured: here y alone.
  testing::Edit(&positions.sigmas)->row(0).setConstant(kInfinity);
  testing::Edit(&positions.sigmas)->row(2).setConstant(kInfinity);
  accuracy = Evaluate();
  EXPECT_EQ(accuracy.n, kCounted);
  EXPECT_NEAR(accuracy.max, 4e-3, kRounding);
}

TEST_F(EvaluateTest, ObservationsOfOrientationAloneDoNotCount) {
  ObservationBlock& poses = Block(MeasurementKind::kPose);
  testing::Edit(&poses.sigmas)->col(1).head<3>().setConstant(kInfinity);
  testing::Edit(&poses.sigmas)->col(4).head<3>().setConstant(kInfinity);
  EXPECT_EQ(Evaluate().n, kCounted - 2);
  EXPECT_EQ(EvaluateTurns().n, kPoses);
  // Nor does what was not measured at all.
  testing::Edit(&Block(MeasurementKind::kPosition).sigmas)
      ->col(0)
      .setConstant(kInfinity);
  EXPECT_EQ(Evaluate().n, kCounted - 3);
  data_.blocks = {poses};
  testing::Edit(&data_.blocks[0].sigmas)->topRows<3>().setConstant(kInfinity);
  EXPECT_EQ(Evaluate().n, 0);
  EXPECT_EQ(EvaluateTurns().n, kPoses);
}

TEST_F(EvaluateTest, CountedLengthsAreInTheOrderOfObservations) {
  data_.blocks = {Block(MeasurementKind::kPointDistance),
                  Block(MeasurementKind::kPose),
                  Block(MeasurementKind::kPlane)};
  testing::Edit(&data_.blocks[1].sigmas)
      ->col(1)
      .head<3>()
      .setConstant(kInfinity);
  testing::Edit(&data_.blocks[1].measured).at(2, 0) += 7e-3;
  const std::vector<std::vector<double>> lengths =
      CountedLengths(model_.Errors(measured_.values, data_), data_);
  ASSERT_EQ(lengths.size(), 3U);
  EXPECT_TRUE(lengths[0].empty());
  ASSERT_EQ(lengths[1].size(), std::size_t{kPoses - 1});
  ASSERT_EQ(lengths[2].size(), std::size_t{kPoses});
  EXPECT_NEAR(lengths[1][0], 7e-3, kRounding);
  // Norms are not below zero.
  EXPECT_LE(*std::max_element(lengths[1].begin() + 1, lengths[1].end()),
            kRounding);
  EXPECT_LE(*std::max_element(lengths[2].begin(), lengths[2].end()), kRounding);
}

TEST_F(EvaluateTest, RotationsAreAnglesBetweenOrientations) {
  constexpr double kTurn = 0.01;
  for (Eigen::Index i = 0; i < kPoses; ++i) {
    auto all = testing::Edit(&Block(MeasurementKind::kPose).measured);
    auto measured = all->col(i).tail<3>();
    const Eigen::Vector3d turn = kTurn * testing::RandomDirection(&random_);
    measured = VectorFromRotation<double>(
        RotationFromVector<double>(turn) *
        RotationFromVector<double>(Eigen::Vector3d(measured)));
  }
  const Accuracy accuracy = EvaluateTurns();
  EXPECT_EQ(accuracy.n, kPoses);
  // Products of rotations: some eps.
  EXPECT_NEAR(accuracy.min, kTurn, 1e-14);
  EXPECT_NEAR(accuracy.max, kTurn, 1e-14);
  EXPECT_LE(Evaluate().max, kRounding);
  data_.blocks = {Block(MeasurementKind::kPosition)};
  EXPECT_EQ(EvaluateTurns().n, 0);
}

TEST_F(EvaluateTest, SetsLabelEveryObservation) {
  data_.files = {"a.csv", "b.csv"};
  for (int i = 0; i < kPoses; ++i) data_.sources.push_back({i % 2, 10 + i});
  data_.blocks = {Block(MeasurementKind::kDistance),
                  Block(MeasurementKind::kPosition),
                  Block(MeasurementKind::kPointDistance)};
  testing::Edit(&data_.blocks[1].measured)->col(2).array() += 1e-3;
  const EvaluatedSet set =
      EvaluateSet(model_, measured_.values, model_, measured_.values, data_);
  ASSERT_EQ(set.labels.size(), 3U * kPoses);
  EXPECT_EQ(set.labels[1].kind, "distance");
  EXPECT_EQ(set.labels[1].pose, 1);
  EXPECT_EQ(set.labels[1].target, "target2");
  EXPECT_EQ(set.labels[1].where, "b.csv:11");
  EXPECT_EQ(set.labels[kPoses + 2].kind, "position");
  EXPECT_EQ(set.labels[kPoses + 2].target, "");
  EXPECT_EQ(set.labels[kPoses + 2].where, "a.csv:12");
  EXPECT_EQ(set.labels[2 * kPoses].kind, "point distance");
  EXPECT_EQ(set.labels[2 * kPoses].pose, -1);
  EXPECT_EQ(set.labels[2 * kPoses].where, "");
  ASSERT_EQ(set.positions.cols(), 3 * kPoses);
  EXPECT_FALSE(set.positions.map().leftCols(kPoses).array().isFinite().any());
  EXPECT_EQ(set.positions.map().middleCols(kPoses, kPoses),
            data_.blocks[1].measured);
  EXPECT_FALSE(set.positions.map().rightCols(kPoses).array().isFinite().any());
  EXPECT_LE(
      (set.residual_after.col(kPoses + 2).array() + 1e-3).abs().maxCoeff(),
      kRounding);
  EXPECT_EQ(set.rotation_residual_after.cols(), 0);
}

// Poses of joint values 0, 1, 2 ..., as `configurations` says, and no block.
Dataset PosesOf(const std::vector<int>& configurations) {
  Dataset data;
  data.joint_values =
      Eigen::MatrixXd(2, static_cast<Eigen::Index>(configurations.size()));
  for (std::size_t i = 0; i < configurations.size(); ++i) {
    testing::Edit(&data.joint_values)->col(static_cast<Eigen::Index>(i))
        << configurations[i],
        0.5;
  }
  return data;
}

ObservationBlock BlockOf(MeasurementKind kind, Eigen::Index count) {
  ObservationBlock block;
  block.kind = kind;
  block.measured = Eigen::MatrixXd::Zero(RowsOf(kind), count);
  block.sigmas = Eigen::MatrixXd::Constant(RowsOf(kind), count, 1e-4);
  return block;
}

constexpr double kStep = 0x1p-12;  // exact in sums (m)

// Configuration 0 three times, 1 twice, 2 and 3 once.
Dataset RepeatedPositions() {
  Dataset data = PosesOf({0, 1, 0, 2, 1, 3, 0});
  ObservationBlock block = BlockOf(MeasurementKind::kPosition, 7);
  testing::Edit(&block.measured)->row(2).setConstant(0.5);
  testing::Edit(&block.measured).at(0, 0) = kStep;
  testing::Edit(&block.measured).at(0, 6) = -kStep;
  testing::Edit(&block.measured).at(1, 1) = 3.0 * kStep;
  testing::Edit(&block.measured).at(1, 4) = 1.0 * kStep;
  testing::Edit(&block.measured).at(2, 3) = 0.25;
  data.blocks = {block};
  return data;
}

TEST(MeasureRepeatsTest, PoolsTheSpreadOfPositions) {
  const RepeatSpread spread = MeasureRepeats(RepeatedPositions());
  // Squares about the means: 2 of configuration 0 and 2 of configuration 1.
  EXPECT_EQ(spread.length_degrees_of_freedom, 3 * 2 + 3 * 1);
  EXPECT_NEAR(spread.length / kStep, std::sqrt(4.0 / 9.0), 1e-14);
  EXPECT_EQ(spread.rotation_degrees_of_freedom, 0);
  EXPECT_EQ(spread.rotation, 0.0);
}

// What the tracker was moved by is no spread; a temperature is no station.
TEST(MeasureRepeatsTest, StationsAreKeptApart) {
  Dataset data = RepeatedPositions();
  data.covariate_names = {"moved", "temperature"};
  Eigen::MatrixXd covariates(2, 7);
  covariates << 0, 0, 0, 0, 1, 0, 1,  //
      20, 21, 22, 23, 24, 25, 26;
  data.covariates = covariates;
  EXPECT_EQ(MeasureRepeats(data).length_degrees_of_freedom, 9);
  CovariateUse moved;
  moved.name = "moved";
  moved.is_station = true;
  CovariateUse temperature;
  temperature.name = "temperature";
  const RepeatSpread spread =
      MeasureRepeats(data, SingleProcess(), {moved, temperature});
  // Left: configuration 0 twice, a step and 0.
  EXPECT_EQ(spread.length_degrees_of_freedom, 3);
  EXPECT_NEAR(spread.length / kStep, std::sqrt(0.5 / 3.0), 1e-14);
}

TEST(MeasureRepeatsTest, OfNothingRepeatedIsZero) {
  Dataset data = PosesOf({0, 1, 2});
  data.blocks = {BlockOf(MeasurementKind::kPosition, 3)};
  const RepeatSpread spread = MeasureRepeats(data);
  EXPECT_EQ(spread.length_degrees_of_freedom, 0);
  EXPECT_EQ(spread.length, 0.0);
  EXPECT_EQ(MeasureRepeats(Dataset()).length_degrees_of_freedom, 0);
}

// Neither other targets and kinds, nor what was measured in part.
TEST(MeasureRepeatsTest, ComparesLikeWithLike) {
  Dataset data = RepeatedPositions();
  ObservationBlock& block = data.blocks[0];
  block.targets = {0, 0, 0, 0, 1, 0, 0};
  RepeatSpread spread = MeasureRepeats(data);
  EXPECT_EQ(spread.length_degrees_of_freedom, 6);
  EXPECT_NEAR(spread.length / kStep, std::sqrt(2.0 / 6.0), 1e-14);
  testing::Edit(&block.sigmas).at(2, 6) = kInfinity;
  spread = MeasureRepeats(data);
  // Left: a step and 0.
  EXPECT_EQ(spread.length_degrees_of_freedom, 3);
  EXPECT_NEAR(spread.length / kStep, std::sqrt(0.5 / 3.0), 1e-14);
  // Another block, of the same configurations: lengths and differences.
  ObservationBlock distances = BlockOf(MeasurementKind::kDistance, 7);
  distances.references.assign(7, 0);
  testing::Edit(&distances.measured)->setRandom();
  ObservationBlock differences = BlockOf(MeasurementKind::kDifference, 7);
  differences.seconds = {1, 2, 3, 4, 5, 6, 0};
  testing::Edit(&differences.measured)->setRandom();
  data.blocks.push_back(distances);
  data.blocks.push_back(differences);
  const RepeatSpread same = MeasureRepeats(data);
  EXPECT_EQ(same.length_degrees_of_freedom, spread.length_degrees_of_freedom);
  EXPECT_EQ(same.length, spread.length);
}

// Turned by nearly half a turn, where rotation vectors of neighbours are far
// apart.
TEST(MeasureRepeatsTest, SpreadOfOrientationsHasNoWrap) {
  constexpr double kTurn = 1e-3;
  const Eigen::Vector3d axis = Eigen::Vector3d(1.0, 2.0, -2.0) / 3.0;
  const Eigen::Matrix3d half =
      RotationFromVector<double>((kPi - 0.5 * kTurn) * axis);
  Dataset data = PosesOf({5, 5, 6, 6, 6});
  ObservationBlock block = BlockOf(MeasurementKind::kPose, 5);
  const double turns[] = {0.0, 1.0, 0.0, -1.0, 1.0};
  for (int i = 0; i < 5; ++i) {
    testing::Edit(&block.measured)->col(i).tail<3>() =
        VectorFromRotation<double>(
            RotationFromVector<double>(kTurn * turns[i] * axis) * half);
  }
  // On either side of half a turn.
  ASSERT_GT((block.measured.col(0) - block.measured.col(1)).norm(), 6.0);
  data.blocks = {block};
  const RepeatSpread spread = MeasureRepeats(data);
  EXPECT_EQ(spread.length_degrees_of_freedom, 9);
  EXPECT_EQ(spread.length, 0.0);
  EXPECT_EQ(spread.rotation_degrees_of_freedom, 9);
  // Squares 1/2 of the first and 2 of the second; turns about one axis add.
  // Rounding: some eps of a turn of order one.
  EXPECT_NEAR(spread.rotation / kTurn, std::sqrt(2.5 / 9.0), 1e-11);
}

}  // namespace
}  // namespace alidade::internal::evaluate_test
