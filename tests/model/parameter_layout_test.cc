#include "alidade/parameter_layout.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "src/common/random.h"
#include "tests/support/matrix_kinematics.h"
#include "tests/support/random_arms.h"
#include "tests/support/random_datasets.h"

namespace alidade::internal {
namespace {

std::vector<std::string> Names(const ParameterLayout& layout) {
  std::vector<std::string> names;
  for (const Parameter& parameter : layout.parameters()) {
    names.push_back(parameter.name);
  }
  return names;
}

TEST(ParameterLayoutTest, NamesFollowTheBlocks) {
  const std::vector<std::string> expected = {
      "beta1",  "beta2",   "alpha1",  "alpha2",  "d1",     "d2",
      "theta1", "theta2",  "r1",      "r2",      "base_x", "base_y",
      "base_z", "base_rx", "base_ry", "base_rz", "tool_x", "tool_y",
      "tool_z", "tool_rx", "tool_ry", "tool_rz"};
  EXPECT_EQ(Names(ParameterLayout(2)), expected);
}

TEST(ParameterLayoutTest, JointNumbersMayHaveTwoDigits) {
  const ParameterLayout layout(12);
  EXPECT_EQ(layout.parameter(*layout.Find("theta12")).index, 11);
  EXPECT_EQ(layout.parameter(*layout.Find("theta1")).index, 0);
}

TEST(ParameterLayoutTest, BlocksCoverAllColumnsInOrder) {
  for (const int n : {1, 5, 12}) {
    const ParameterLayout layout(n);
    EXPECT_EQ(layout.num_joints(), n);
    EXPECT_EQ(layout.size(), 5 * n + 12);
    std::vector<std::string> names;
    int next_column = 0;
    for (const ParameterBlock& block : layout.blocks()) {
      EXPECT_EQ(block.first_column, next_column) << block.name;
      next_column += block.size;
      names.push_back(block.name);
      EXPECT_EQ(block.size, names.size() <= 5 ? n : 6) << block.name;
    }
    EXPECT_EQ(next_column, layout.size());
    EXPECT_EQ(names, (std::vector<std::string>{"beta", "alpha", "d", "theta",
                                               "r", "base", "tool"}));
  }
}

TEST(ParameterLayoutTest, ColumnAndFindInvertTheParameters) {
  for (const int n : {1, 5, 12}) {
    const ParameterLayout layout(n);
    for (int column = 0; column < layout.size(); ++column) {
      const Parameter& parameter = layout.parameter(column);
      EXPECT_EQ(layout.Column(parameter.kind, parameter.index), column);
      EXPECT_EQ(layout.Find(parameter.name), column);
    }
  }
}

TEST(ParameterLayoutTest, UnknownNamesAreNotFound) {
  const ParameterLayout layout(5);
  for (const char* name :
       {"", "beta", "beta0", "beta6", "beta01", "Beta1", "beta1 ", " beta1",
        "r-1", "base", "base_w", "tool_rw", "base_rx1"}) {
    EXPECT_FALSE(layout.Find(name).has_value()) << "'" << name << "'";
  }
}

TEST(ParameterLayoutTest, LengthsAndAnglesAreToldApart) {
  const ParameterLayout layout(3);
  for (const char* name : {"d1", "r3", "base_x", "base_z", "tool_y"}) {
    EXPECT_EQ(layout.parameter(*layout.Find(name)).dimension,
              Dimension::kLength)
        << name;
  }
  for (const char* name :
       {"beta1", "alpha2", "theta3", "base_rx", "base_rz", "tool_ry"}) {
    EXPECT_EQ(layout.parameter(*layout.Find(name)).dimension, Dimension::kAngle)
        << name;
  }
}

TEST(ParameterLayoutTest, JointKindsAreTheFirstFive) {
  const ParameterLayout layout(2);
  for (int column = 0; column < layout.size(); ++column) {
    EXPECT_EQ(ParameterLayout::IsJointKind(layout.parameter(column).kind),
              column < 5 * layout.num_joints())
        << layout.parameter(column).name;
  }
}

TEST(ParameterLayoutTest, ValuesStandInTheirColumns) {
  Arm arm;
  arm.joints.resize(2);
  arm.joints[1].beta = 1.0;
  arm.joints[1].alpha = 2.0;
  arm.joints[1].d = 3.0;
  arm.joints[1].theta = 4.0;
  arm.joints[1].r = 5.0;
  arm.instrument_from_base.translation() = Eigen::Vector3d(6.0, 7.0, 8.0);
  arm.last_from_target().translation() = Eigen::Vector3d(9.0, 10.0, 11.0);
  Eigen::VectorXd expected(22);
  expected << 0, 1, 0, 2, 0, 3, 0, 4, 0, 5, 6, 7, 8, 0, 0, 0, 9, 10, 11, 0, 0,
      0;
  EXPECT_EQ(ParameterLayout(2).Values(arm), expected);
}

TEST(ParameterLayoutTest, RotationValuesAreZeroAtAnyArm) {
  Random random(201);
  const Arm arm = testing::RandomArm(3, &random);
  const ParameterLayout layout(3);
  const Eigen::VectorXd values = layout.Values(arm);
  for (const ParameterKind kind :
       {ParameterKind::kBaseRotation, ParameterKind::kToolRotation}) {
    EXPECT_TRUE(values.segment<3>(layout.Column(kind, 0)).isZero(0.0));
  }
}

// Everything that parameters do not touch.
void ExpectSameFixedParts(const Arm& actual, const Arm& expected) {
  EXPECT_EQ(actual.name, expected.name);
  ASSERT_EQ(actual.num_joints(), expected.num_joints());
  for (int j = 0; j < expected.num_joints(); ++j) {
    EXPECT_EQ(actual.joints[j].type, expected.joints[j].type);
    EXPECT_EQ(actual.joints[j].lower, expected.joints[j].lower);
    EXPECT_EQ(actual.joints[j].upper, expected.joints[j].upper);
  }
}

TEST(ParameterLayoutTest, RoundTripKeepsEveryBit) {
  for (const int n : {1, 5, 12}) {
    Random random(202, n);
    const Arm arm = testing::RandomArm(n, &random);
    const ParameterLayout layout(n);
    const Eigen::VectorXd values = layout.Values(arm);
    const Arm again = layout.WithValues(arm, values);
    ExpectSameFixedParts(again, arm);
    EXPECT_EQ(layout.Values(again), values);
    EXPECT_EQ(again.instrument_from_base.matrix(),
              arm.instrument_from_base.matrix());
    EXPECT_EQ(again.last_from_target().matrix(),
              arm.last_from_target().matrix());
  }
}

TEST(ParameterLayoutTest, WithValuesReplacesTheGeometryOnly) {
  Random random(203);
  const Arm nominal = testing::RandomArm(4, &random);
  const Arm other = testing::RandomArm(4, &random);
  const ParameterLayout layout(4);
  const Eigen::VectorXd values = layout.Values(other);
  const Arm arm = layout.WithValues(nominal, values);
  ExpectSameFixedParts(arm, nominal);
  EXPECT_EQ(layout.Values(arm), values);
  // Rotation values are zero, so the nominal rotations stay.
  EXPECT_EQ(arm.instrument_from_base.linear(),
            nominal.instrument_from_base.linear());
  EXPECT_EQ(arm.last_from_target().linear(),
            nominal.last_from_target().linear());
}

TEST(ParameterLayoutTest, RotationsActOnTheLeftOfTheNominalOnes) {
  Random random(204);
  for (const double length : testing::RotationLengths()) {
    const Arm nominal = testing::RandomArm(2, &random);
    const ParameterLayout layout(2);
    const Eigen::VectorXd values =
        testing::ValuesWithRotations(nominal, length, &random);
    const Arm arm = layout.WithValues(nominal, values);
    const auto expected = [&](ParameterKind kind,
                              const Eigen::Isometry3d& frame) {
      const testing::Vector3l w =
          values.segment<3>(layout.Column(kind, 0)).cast<long double>();
      const testing::Matrix3l rotation =
          testing::MatrixFromVector(w) * frame.linear().cast<long double>();
      return Eigen::Matrix3d(rotation.cast<double>());
    };
    // Products of two rotation matrices: a few units of eps.
    EXPECT_TRUE(arm.instrument_from_base.linear().isApprox(
        expected(ParameterKind::kBaseRotation, nominal.instrument_from_base),
        2e-15));
    EXPECT_TRUE(arm.last_from_target().linear().isApprox(
        expected(ParameterKind::kToolRotation, nominal.last_from_target()),
        2e-15));
  }
}

// Two joints, three targets, two points and two planes.
constexpr LayoutShape kFullShape = {2, 3, 2, 2};

TEST(FullLayoutTest, NamesFollowTheBlocks) {
  const std::vector<std::string> expected = {
      "beta1",    "beta2",    "alpha1",   "alpha2",   "d1",       "d2",
      "theta1",   "theta2",   "r1",       "r2",       "base_x",   "base_y",
      "base_z",   "base_rx",  "base_ry",  "base_rz",  "tool_x",   "tool_y",
      "tool_z",   "tool_rx",  "tool_ry",  "tool_rz",  "tool2_x",  "tool2_y",
      "tool2_z",  "tool2_rx", "tool2_ry", "tool2_rz", "tool3_x",  "tool3_y",
      "tool3_z",  "tool3_rx", "tool3_ry", "tool3_rz", "point1_x", "point1_y",
      "point1_z", "point2_x", "point2_y", "point2_z", "plane1_u", "plane1_v",
      "plane1_c", "plane2_u", "plane2_v", "plane2_c"};
  EXPECT_EQ(Names(ParameterLayout(kFullShape)), expected);
}

TEST(FullLayoutTest, BlocksCoverAllColumnsInOrder) {
  const ParameterLayout layout(kFullShape);
  std::vector<std::string> names;
  int next_column = 0;
  for (const ParameterBlock& block : layout.blocks()) {
    EXPECT_EQ(block.first_column, next_column) << block.name;
    next_column += block.size;
    names.push_back(block.name);
    const bool is_frame =
        block.name.find("base") == 0 || block.name.find("tool") == 0;
    const bool is_reference =
        block.name.find("point") == 0 || block.name.find("plane") == 0;
    const int size_of_others = is_reference ? 3 : 2;
    EXPECT_EQ(block.size, is_frame ? 6 : size_of_others) << block.name;
  }
  EXPECT_EQ(next_column, layout.size());
  EXPECT_EQ(names,
            (std::vector<std::string>{"beta", "alpha", "d", "theta", "r",
                                      "base", "tool", "tool2", "tool3",
                                      "point1", "point2", "plane1", "plane2"}));
}

TEST(FullLayoutTest, ColumnAndFindInvertTheParameters) {
  for (const LayoutShape& shape :
       {kFullShape, LayoutShape{1, 1, 3, 0}, LayoutShape{6, 2, 0, 4},
        LayoutShape{3, 12, 11, 1}}) {
    const ParameterLayout layout(shape);
    EXPECT_EQ(layout.size(), 5 * shape.num_joints + 6 + 6 * shape.num_targets +
                                 3 * shape.num_points + 3 * shape.num_planes);
    for (int column = 0; column < layout.size(); ++column) {
      const Parameter& parameter = layout.parameter(column);
      EXPECT_EQ(
          layout.Column(parameter.kind, parameter.index, parameter.object),
          column)
          << parameter.name;
      EXPECT_EQ(layout.Find(parameter.name), column) << parameter.name;
    }
  }
}

TEST(FullLayoutTest, UnknownNamesAreNotFound) {
  const ParameterLayout layout(kFullShape);
  for (const char* name :
       {"tool1_x", "tool4_x", "tool2", "point_x", "point0_x", "point3_x",
        "point1_rx", "plane1_x", "plane1_w", "plane3_u", "base2_x"}) {
    EXPECT_FALSE(layout.Find(name).has_value()) << name;
  }
}

TEST(FullLayoutTest, KindsObjectsAndDimensions) {
  const ParameterLayout layout(kFullShape);
  const auto at = [&](const char* name) {
    return layout.parameter(*layout.Find(name));
  };
  EXPECT_EQ(at("tool3_ry").kind, ParameterKind::kToolRotation);
  EXPECT_EQ(at("tool3_ry").object, 2);
  EXPECT_EQ(at("tool3_ry").index, 1);
  EXPECT_EQ(at("tool3_ry").dimension, Dimension::kAngle);
  EXPECT_EQ(at("tool2_z").kind, ParameterKind::kToolTranslation);
  EXPECT_EQ(at("tool2_z").dimension, Dimension::kLength);
  EXPECT_EQ(at("point2_y").kind, ParameterKind::kPoint);
  EXPECT_EQ(at("point2_y").object, 1);
  EXPECT_EQ(at("point2_y").dimension, Dimension::kLength);
  EXPECT_EQ(at("plane2_v").kind, ParameterKind::kPlaneTilt);
  EXPECT_EQ(at("plane2_v").index, 1);
  EXPECT_EQ(at("plane2_v").dimension, Dimension::kAngle);
  EXPECT_EQ(at("plane1_c").kind, ParameterKind::kPlaneOffset);
  EXPECT_EQ(at("plane1_c").index, 0);
  EXPECT_EQ(at("plane1_c").dimension, Dimension::kLength);
  for (const Parameter& parameter : layout.parameters()) {
    EXPECT_EQ(
        ParameterLayout::IsReferenceKind(parameter.kind),
        parameter.name.find("point") == 0 || parameter.name.find("plane") == 0)
        << parameter.name;
  }
}

// References are no part of an arm: their values are zero, and nothing of
// theirs gets into it.
TEST(FullLayoutTest, RoundTripKeepsEveryBitOfEveryTarget) {
  Random random(205);
  testing::RandomArmOptions options;
  options.num_targets = 3;
  const Arm arm = testing::RandomArm(2, &random, options);
  const ParameterLayout layout(kFullShape);
  Eigen::VectorXd values = layout.Values(arm);
  ASSERT_EQ(values.size(), layout.size());
  EXPECT_TRUE(values.tail(12).isZero(0.0));
  values.tail(12).setLinSpaced(1.0, 12.0);
  const Arm again = layout.WithValues(arm, values);
  ExpectSameFixedParts(again, arm);
  values.tail(12).setZero();
  EXPECT_EQ(layout.Values(again), values);
  ASSERT_EQ(again.num_targets(), 3);
  for (int target = 0; target < 3; ++target) {
    EXPECT_EQ(again.targets[target].name, arm.targets[target].name);
    EXPECT_EQ(again.last_from_target(target).matrix(),
              arm.last_from_target(target).matrix());
    EXPECT_EQ(values.segment<3>(
                  layout.Column(ParameterKind::kToolTranslation, 0, target)),
              arm.last_from_target(target).translation());
  }
}

TEST(FullLayoutTest, MovesOneTargetAlone) {
  Random random(206);
  testing::RandomArmOptions options;
  options.num_targets = 3;
  const Arm nominal = testing::RandomArm(2, &random, options);
  const ParameterLayout layout(kFullShape);
  Eigen::VectorXd values = layout.Values(nominal);
  values[*layout.Find("tool2_y")] = 0.75;
  values[*layout.Find("tool2_rz")] = 0.5;
  const Arm arm = layout.WithValues(nominal, values);
  for (const int target : {0, 2}) {
    EXPECT_EQ(arm.last_from_target(target).matrix(),
              nominal.last_from_target(target).matrix());
  }
  EXPECT_EQ(arm.last_from_target(1).translation().y(), 0.75);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  // A product of two rotation matrices: a few units of eps.
  EXPECT_TRUE(arm.last_from_target(1).linear().isApprox(
      turn * nominal.last_from_target(1).linear(), 2e-15));
}

}  // namespace
}  // namespace alidade::internal
