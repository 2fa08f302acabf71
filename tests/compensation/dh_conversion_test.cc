#include "src/compensation/dh_conversion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "src/common/random.h"
#include "tests/support/matrix_kinematics.h"
#include "tests/support/random_arms.h"

namespace alidade::internal {
namespace {

using testing::Matrix4l;
using testing::RandomDirection;
using testing::RandomFrame;
using testing::RotationX;
using testing::RotationZ;
using testing::Translation;
using testing::Vector3l;

// Arms of a few m in double: some tens of roundings of 2e-16 each.
constexpr double kTolerance = 1e-12;

void ExpectSameFrame(const Matrix4l& expected, const Arm& arm,
                     const Eigen::VectorXd& q) {
  const Matrix4l frame = testing::MatrixTargetFrame(arm, q.data());
  EXPECT_LT(static_cast<double>((frame - expected).cwiseAbs().maxCoeff()),
            kTolerance);
}

Eigen::VectorXd RandomValues(int size, Random* random) {
  Eigen::VectorXd q(size);
  for (double& value : q) value = random->Uniform(-kPi, kPi);
  return q;
}

std::vector<DhRow> RandomRows(Random* random) {
  std::vector<DhRow> rows(7);
  for (DhRow& row : rows) {
    const bool slides = random->Uniform() < 0.3;
    row.type = slides ? JointType::kPrismatic : JointType::kRevolute;
    row.theta = random->Uniform(-kPi, kPi);
    row.d = random->Uniform(-0.5, 0.5);
    row.a = random->Uniform(-0.5, 0.5);
    row.alpha = random->Uniform(-kPi, kPi);
  }
  return rows;
}

// Rot(z, theta) Trans(z, d) with q where it belongs.
Matrix4l Screw(const DhRow& row, long double q) {
  const bool turns = row.type == JointType::kRevolute;
  return RotationZ(row.theta + (turns ? q : 0.0L)) *
         Translation({0, 0, row.d + (turns ? 0.0L : q)});
}

TEST(DhConversionTest, StandardRowsKeepTheTargetsFrame) {
  Random random(1);
  for (int trial = 0; trial < 100; ++trial) {
    const std::vector<DhRow> rows = RandomRows(&random);
    const Eigen::VectorXd q = RandomValues(7, &random);
    Matrix4l expected = Matrix4l::Identity();
    for (int i = 0; i < 7; ++i) {
      expected = expected * Screw(rows[i], q[i]) *
                 Translation({rows[i].a, 0, 0}) * RotationX(rows[i].alpha);
    }
    ExpectSameFrame(expected, ArmFromStandardDh(rows), q);
  }
}

TEST(DhConversionTest, CraigRowsKeepTheTargetsFrame) {
  Random random(2);
  for (int trial = 0; trial < 100; ++trial) {
    const std::vector<DhRow> rows = RandomRows(&random);
    const Eigen::VectorXd q = RandomValues(7, &random);
    Matrix4l expected = Matrix4l::Identity();
    for (int i = 0; i < 7; ++i) {
      expected = expected * RotationX(rows[i].alpha) *
                 Translation({rows[i].a, 0, 0}) * Screw(rows[i], q[i]);
    }
    ExpectSameFrame(expected, ArmFromCraigDh(rows), q);
  }
}

// Products of 4 x 4 matrices in long double, joint after joint.
Matrix4l ChainFrame(const std::vector<ChainJoint>& chain,
                    const Eigen::VectorXd& q) {
  Matrix4l frame = Matrix4l::Identity();
  int j = 0;
  for (const ChainJoint& joint : chain) {
    frame = frame * joint.parent_from_joint.matrix().cast<long double>();
    if (joint.type == ChainJoint::Type::kFixed) continue;
    const Vector3l axis = joint.axis.cast<long double>().normalized();
    const Vector3l motion = axis * static_cast<long double>(q[j++]);
    Matrix4l moved = Matrix4l::Identity();
    if (joint.type == ChainJoint::Type::kRevolute) {
      moved.topLeftCorner<3, 3>() = testing::MatrixFromVector(motion);
    } else {
      moved = Translation(motion);
    }
    frame = frame * moved;
  }
  return frame;
}

// How an axis lies to the one before it.
struct AxisCase {
  const char* name;
  double tilt;        // rad
  double distance;    // of a point of it from the former axis, m
  bool random_point;  // false: on the normal through the former origin
};

class ChainTest : public ::testing::TestWithParam<AxisCase> {};

void PrintTo(const AxisCase& axis_case, std::ostream* out) {
  *out << axis_case.name;
}

ChainJoint DrawJoint(const AxisCase& axis_case, Random* random) {
  ChainJoint joint;
  const double chance = random->Uniform();
  if (chance < 0.2) joint.type = ChainJoint::Type::kPrismatic;
  joint.axis = Eigen::Vector3d::UnitZ() * random->Uniform(0.5, 2.0);
  if (random->Uniform() < 0.5) joint.axis = -joint.axis;
  const double azimuth = random->Uniform(-kPi, kPi);
  const Eigen::Vector3d about(std::cos(azimuth), std::sin(azimuth), 0.0);
  joint.parent_from_joint.linear() =
      (Eigen::AngleAxisd(random->Uniform(-kPi, kPi), Eigen::Vector3d::UnitZ()) *
       Eigen::AngleAxisd(axis_case.tilt, about))
          .toRotationMatrix();
  Eigen::Vector3d point = about * axis_case.distance;
  if (axis_case.random_point) point = testing::RandomVector(0.5, random);
  joint.parent_from_joint.translation() = point;
  return joint;
}

TEST_P(ChainTest, KeepsTheTipsFrameAndBoundsTheParameters) {
  Random random(3);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<ChainJoint> chain(1);
    chain[0].parent_from_joint = RandomFrame(0.5, &random);
    chain[0].axis = RandomDirection(&random);
    for (int j = 1; j < 6; ++j) {
      chain.push_back(DrawJoint(GetParam(), &random));
      ChainJoint fixed;
      fixed.type = ChainJoint::Type::kFixed;
      if (j % 3 == 0) fixed.parent_from_joint = RandomFrame(0.3, &random);
      chain.push_back(fixed);
    }
    const Arm arm = ArmFromChain(chain);
    ASSERT_EQ(arm.num_joints(), 6);
    for (int pose = 0; pose < 5; ++pose) {
      const Eigen::VectorXd q = RandomValues(6, &random);
      ExpectSameFrame(ChainFrame(chain, q), arm, q);
    }
    // Six links of at most 1.4 m, and 1 / sin(5 deg) = 11.5 of them.
    for (const Joint& joint : arm.joints) {
      EXPECT_LT(std::abs(joint.d), 1e2);
      EXPECT_LT(std::abs(joint.r), 1e3);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Axes, ChainTest,
    ::testing::Values(AxisCase{"Skew", 1.0, 0.0, true},
                      AxisCase{"Square", kPi / 2, 0.3, false},
                      AxisCase{"Intersecting", 0.7, 0.0, false},
                      AxisCase{"Parallel", 0.0, 0.0, true},
                      AxisCase{"ParallelOnNormal", 0.0, 0.3, false},
                      AxisCase{"Coincident", 0.0, 0.0, false},
                      AxisCase{"Antiparallel", kPi, 0.0, true},
                      AxisCase{"AntiparallelCoincident", kPi, 0.0, false},
                      AxisCase{"Tilt1e1", 1e-1, 0.0, true},
                      AxisCase{"Tilt5deg", kNearlyParallel, 0.0, true},
                      AxisCase{"Tilt1e3", 1e-3, 0.0, true},
                      AxisCase{"Tilt1e6", 1e-6, 0.0, true},
                      AxisCase{"Tilt1e9", 1e-9, 0.0, true},
                      AxisCase{"Tilt1e12", 1e-12, 0.0, true},
                      AxisCase{"Tilt1e3Intersecting", 1e-3, 0.0, false},
                      AxisCase{"Tilt1e3NearlyIntersecting", 1e-3, 1e-12, false},
                      AxisCase{"Anti1e3", kPi - 1e-3, 0.0, true},
                      AxisCase{"Anti1e9", kPi - 1e-9, 0.0, true}),
    [](const ::testing::TestParamInfo<AxisCase>& param) {
      return std::string(param.param.name);
    });

TEST(ArmFromChainTest, ParallelAxesGetAPlainLink) {
  std::vector<ChainJoint> chain(3);
  for (ChainJoint& joint : chain) {
    joint.axis = Eigen::Vector3d::UnitZ();
    joint.parent_from_joint.translation() << 0.25, 0.0, 0.1;
  }
  const Arm arm = ArmFromChain(chain);
  for (const Joint& joint : arm.joints) {
    EXPECT_EQ(joint.beta, 0.0);
    EXPECT_EQ(joint.alpha, 0.0);
    EXPECT_EQ(joint.d, 0.25);
    EXPECT_EQ(joint.theta, 0.0);
  }
  EXPECT_TRUE(arm.instrument_from_base.matrix().isIdentity(0.0));
}

TEST(ArmFromChainTest, KeepsLimits) {
  std::vector<ChainJoint> chain(1);
  chain[0].lower = -1.0;
  chain[0].upper = 2.0;
  const Arm arm = ArmFromChain(chain);
  EXPECT_EQ(arm.joints[0].lower, -1.0);
  EXPECT_EQ(arm.joints[0].upper, 2.0);
}

// The table of a controller, calibrated in the factory: axes 2 to 4 are within
// 0.004 rad of parallel, and their common normals hundreds of metres away.
TEST(DhConversionTest, FarNormalsBecomeBetas) {
  std::vector<DhRow> rows(6);
  const double theta[] = {0.0, -1.7403766, 2.3274941, -0.5872360, 0.0, 0.0};
  const double d[] = {0.0889, 574.1, -507.3, -66.691, 0.09497, 0.08256};
  const double a[] = {0.00028, 0.0716631, -0.326565, 0.0, 0.0, 0.0};
  const double alpha[] = {1.5703, -0.00073, 0.00326, 1.5704, -1.571, 0.0};
  for (int j = 0; j < 6; ++j) {
    rows[j].theta = theta[j];
    rows[j].d = d[j];
    rows[j].a = a[j];
    rows[j].alpha = alpha[j];
  }
  const Arm table = ArmFromStandardDh(rows);
  ASSERT_TRUE(HasFarNormals(table));
  const Arm converted = WithoutFarNormals(table);
  EXPECT_FALSE(HasFarNormals(converted));
  EXPECT_LT(ArmReach(converted), 3.0);
  Random random(3);
  for (int k = 0; k < 20; ++k) {
    const Eigen::VectorXd q = RandomValues(6, &random);
    const Matrix4l difference = testing::MatrixTargetFrame(table, q.data()) -
                                testing::MatrixTargetFrame(converted, q.data());
    // Lengths of 574 m in double: some tens of roundings of 6e-14 m.
    EXPECT_LT(static_cast<double>(difference.cwiseAbs().maxCoeff()), 5e-12);
  }
}

TEST(DhConversionTest, OrdinaryTablesHaveNoFarNormals) {
  Random random(4);
  for (int k = 0; k < 20; ++k) {
    EXPECT_FALSE(HasFarNormals(ArmFromStandardDh(RandomRows(&random))));
  }
}

}  // namespace
}  // namespace alidade::internal
