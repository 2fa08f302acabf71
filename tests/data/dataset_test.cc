#include "alidade/dataset.h"

#include <gtest/gtest.h>

#include <Eigen/Core>

#include "src/common/constants.h"
#include "src/kernel/measurement_model.h"
#include "tests/support/edit.h"

namespace alidade::internal {
namespace {

// Three poses: the first and the last measured as poses, the last without its
// orientation; of the one between, a distance and a position without z.
Dataset MixedData() {
  Dataset data;
  data.joint_values = Eigen::MatrixXd::Zero(1, 3);
  ObservationBlock poses;
  poses.kind = MeasurementKind::kPose;
  poses.poses = {0, 2};
  poses.measured = Eigen::MatrixXd::Zero(6, 2);
  poses.sigmas = Eigen::MatrixXd::Constant(6, 2, 0.5);
  testing::Edit(&poses.sigmas)->col(1).tail<3>().setConstant(kInfinity);
  ObservationBlock distances;
  distances.kind = MeasurementKind::kDistance;
  distances.poses = {1};
  distances.references = {0};
  distances.measured = Eigen::MatrixXd::Zero(1, 1);
  distances.sigmas = Eigen::MatrixXd::Constant(1, 1, 2.0);
  ObservationBlock positions;
  positions.poses = {1};
  positions.measured = Eigen::MatrixXd::Zero(3, 1);
  positions.sigmas = Eigen::MatrixXd(3, 1);
  *testing::Edit(&positions.sigmas) << 1.0, 1.0, kInfinity;
  positions.whiteners.resize(1);
  positions.whiteners[0].setZero(3, 3);
  positions.whiteners[0].topLeftCorner<2, 2>() << 1.0, 2.0, 0.0, 3.0;
  data.blocks = {poses, distances, positions};
  return data;
}

// As a model returns them: zero where nothing was measured.
Eigen::VectorXd Errors() {
  Eigen::VectorXd errors(16);
  errors << 1.0, 2.0, 2.0, 0.3, 0.0, -0.4, 0.0, 3.0, -4.0, 0.0, 0.0, 0.0,  //
      -6.0,                                                                //
      0.6, 0.8, 0.0;
  return errors;
}

TEST(DatasetTest, CountsObservationsRowsAndEquations) {
  const Dataset data = MixedData();
  EXPECT_EQ(data.num_poses(), 3);
  EXPECT_EQ(data.num_observations(), 4);
  EXPECT_EQ(data.num_rows(), 16);
  EXPECT_EQ(data.num_equations(), 6 + 3 + 1 + 2);
  EXPECT_TRUE(data.Has(MeasurementKind::kDistance));
  EXPECT_FALSE(data.Has(MeasurementKind::kPlane));
  EXPECT_EQ(Dimensions(data), Eigen::Vector4i(6, 3, 1, 2));
  EXPECT_EQ(Dataset().num_observations(), 0);
  EXPECT_EQ(Dataset().num_rows(), 0);
}

TEST(DatasetTest, ABlockWithoutObservationsIsNoKindThatItHas) {
  Dataset data = MixedData();
  data.blocks[1].measured = Eigen::MatrixXd(1, 0);
  data.blocks[1].sigmas = Eigen::MatrixXd(1, 0);
  EXPECT_FALSE(data.Has(MeasurementKind::kDistance));
}

TEST(DatasetTest, PositionsAreOneBlock) {
  const Eigen::MatrixXd joint_values = Eigen::MatrixXd::Constant(2, 4, 0.5);
  const Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Constant(3, 4, 7.0);
  const Eigen::Matrix3Xd sigmas = Eigen::Matrix3Xd::Constant(3, 4, 0.1);
  const Dataset data = MakePositions(joint_values, points, sigmas);
  ASSERT_EQ(data.blocks.size(), 1u);
  EXPECT_EQ(data.blocks[0].kind, MeasurementKind::kPosition);
  EXPECT_EQ(data.joint_values, joint_values);
  EXPECT_EQ(data.positions(), points);
  EXPECT_EQ(data.sigmas(), sigmas);
  EXPECT_EQ(data.blocks[0].pose(3), 3);
  EXPECT_EQ(data.blocks[0].target(3), 0);
  EXPECT_EQ(data.num_equations(), 12);
}

TEST(DatasetDeathTest, OtherKindsAreNotReadAsPositions) {
  Dataset data = MixedData();
  EXPECT_DEATH(data.positions(), "positions alone");
  data.blocks.resize(1);
  EXPECT_DEATH(data.sigmas(), "positions alone");
}

TEST(ErrorsTest, LengthsAndRotationsAreApart) {
  const Dataset data = MixedData();
  const SharedVector lengths = LengthErrors(Errors(), data);
  ASSERT_EQ(lengths.size(), 4);
  EXPECT_DOUBLE_EQ(lengths[0], 3.0);
  EXPECT_DOUBLE_EQ(lengths[1], 5.0);
  EXPECT_DOUBLE_EQ(lengths[2], 6.0);
  EXPECT_DOUBLE_EQ(lengths[3], 1.0);
  // One orientation was measured.
  const SharedVector rotations = RotationErrors(Errors(), data);
  ASSERT_EQ(rotations.size(), 1);
  EXPECT_DOUBLE_EQ(rotations[0], 0.5);
}

TEST(ErrorsTest, SquaredNormsAreWhitened) {
  const Dataset data = MixedData();
  const SharedVector squared = SquaredNorms(Errors(), data);
  ASSERT_EQ(squared.size(), 4);
  EXPECT_DOUBLE_EQ(squared[0], 4.0 * (9.0 + 0.25));
  EXPECT_DOUBLE_EQ(squared[1], 4.0 * 25.0);
  EXPECT_DOUBLE_EQ(squared[2], 9.0);
  // (0.6 + 1.6)^2 + 2.4^2.
  EXPECT_DOUBLE_EQ(squared[3], 4.84 + 5.76);
  EXPECT_DOUBLE_EQ(ChiSquare(Errors(), data), 37.0 + 100.0 + 9.0 + 10.6);
}

TEST(WhitenTest, TakesTheObservationsFromTheFirstOn) {
  ObservationBlock block;
  block.measured = Eigen::MatrixXd::Zero(3, 4);
  block.sigmas = Eigen::MatrixXd(3, 4);
  *testing::Edit(&block.sigmas) << 9.0, 1.0, 2.0, 9.0,  //
      9.0, 4.0, 8.0, 9.0,                               //
      9.0, kInfinity, 16.0, 9.0;
  Eigen::MatrixXd rows = Eigen::MatrixXd::Constant(6, 2, 16.0);
  Whiten(block, 1, 2, rows);
  Eigen::VectorXd expected(6);
  expected << 16.0, 4.0, 0.0, 8.0, 2.0, 1.0;
  EXPECT_EQ(rows.col(0), expected);
  EXPECT_EQ(rows.col(1), expected);
}

}  // namespace
}  // namespace alidade::internal
