#include "src/dataio/rotation_convention.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <string>

#include "alidade/rotation.h"

namespace alidade::internal {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Matrix3d Turn(char axis, double angle) {
  return Eigen::AngleAxisd(angle, Vector3d::Unit(axis - 'x'))
      .toRotationMatrix();
}

Matrix3d Read(const std::string& name, const Vector3d& numbers) {
  const auto convention = FindRotationConvention(name);
  EXPECT_TRUE(convention.has_value()) << name;
  return RotationOf(*convention, numbers);
}

void ExpectNear(const Matrix3d& a, const Matrix3d& b, double tolerance,
                const std::string& what) {
  EXPECT_LT((a - b).cwiseAbs().maxCoeff(), tolerance) << what;
}

TEST(RotationConventionTest, HasAllSequencesAndTheRotationVector) {
  const std::vector<std::string>& names = RotationConventionNames();
  EXPECT_EQ(names.size(), 25U);
  for (const char* sequence : {"xyz", "xzy", "yxz", "yzx", "zxy", "zyx", "xyx",
                               "xzx", "yxy", "yzy", "zxz", "zyz"}) {
    for (const char* kind : {"intrinsic_", "extrinsic_"}) {
      const std::string name = std::string(kind) + sequence;
      EXPECT_EQ(std::count(names.begin(), names.end(), name), 1) << name;
    }
  }
  EXPECT_FALSE(FindRotationConvention("intrinsic_xxy").has_value());
  EXPECT_FALSE(FindRotationConvention("xyz").has_value());
}

// Written out by hand: rx stands after x wherever x stands.
TEST(RotationConventionTest, AnglesBelongToTheirAxes) {
  const double a = 0.3;
  const double b = -0.7;
  const double c = 1.9;
  const Vector3d numbers(a, b, c);
  const Matrix3d x = Turn('x', a);
  const Matrix3d y = Turn('y', b);
  const Matrix3d z = Turn('z', c);
  ExpectNear(Read("intrinsic_xyz", numbers), x * y * z, 1e-15, "xyz");
  ExpectNear(Read("intrinsic_xzy", numbers), x * z * y, 1e-15, "xzy");
  ExpectNear(Read("intrinsic_yxz", numbers), y * x * z, 1e-15, "yxz");
  ExpectNear(Read("intrinsic_yzx", numbers), y * z * x, 1e-15, "yzx");
  ExpectNear(Read("intrinsic_zxy", numbers), z * x * y, 1e-15, "zxy");
  ExpectNear(Read("intrinsic_zyx", numbers), z * y * x, 1e-15, "zyx");
  ExpectNear(Read("extrinsic_xyz", numbers), z * y * x, 1e-15, "e xyz");
  ExpectNear(Read("extrinsic_zyx", numbers), x * y * z, 1e-15, "e zyx");
  ExpectNear(Read("extrinsic_yzx", numbers), x * z * y, 1e-15, "e yzx");
}

TEST(RotationConventionTest, ProperEulerAnglesAreInOrder) {
  const double a = 0.3;
  const double b = -0.7;
  const double c = 1.9;
  const Vector3d numbers(a, b, c);
  for (const std::string axes : {"xyx", "xzx", "yxy", "yzy", "zxz", "zyz"}) {
    const Matrix3d intrinsic =
        Turn(axes[0], a) * Turn(axes[1], b) * Turn(axes[2], c);
    const Matrix3d extrinsic =
        Turn(axes[2], c) * Turn(axes[1], b) * Turn(axes[0], a);
    ExpectNear(Read("intrinsic_" + axes, numbers), intrinsic, 1e-15, axes);
    ExpectNear(Read("extrinsic_" + axes, numbers), extrinsic, 1e-15, axes);
  }
}

TEST(RotationConventionTest, ReadsARotationVector) {
  const Matrix3d quarter = Read("rotation_vector", {0.0, 0.0, M_PI / 2.0});
  ExpectNear(quarter, Turn('z', M_PI / 2.0), 1e-15, "vector");
}

TEST(RotationConventionTest, NumbersComeBackNearToWhatTheyWere) {
  const Vector3d numbers(0.4, -0.8, 1.3);
  for (const std::string& name : RotationConventionNames()) {
    const auto convention = FindRotationConvention(name);
    // Other numbers of the same rotation, and half a turn to either side.
    for (const Vector3d& offset :
         {Vector3d(0.0, 0.0, 0.0), Vector3d(2.0 * M_PI, 0.0, -2.0 * M_PI),
          Vector3d(M_PI, 0.0, 0.0), Vector3d(-2.4, 1.9, 0.7)}) {
      const Vector3d near = numbers + offset;
      const Matrix3d rotation = RotationOf(*convention, near);
      const Vector3d found = NumbersOf(*convention, rotation, near);
      EXPECT_LT((found - near).cwiseAbs().maxCoeff(), 1e-14) << name;
      // A small turn moves them a little.
      const Matrix3d moved = RotationOf(*convention, near) * Turn('y', 1e-4);
      const Vector3d other = NumbersOf(*convention, moved, near);
      EXPECT_LT((other - near).norm(), 1e-3) << name;
      ExpectNear(RotationOf(*convention, other), moved, 1e-14, name);
    }
  }
}

TEST(RotationConventionTest, GimbalLockKeepsTheFirstAngle) {
  for (const std::string& name : RotationConventionNames()) {
    const auto convention = FindRotationConvention(name);
    if (convention->is_vector) continue;
    const bool is_proper = convention->axes[0] == convention->axes[2];
    Vector3d numbers(0.7, 0.7, 0.7);
    // The second angle, wherever it stands.
    numbers[is_proper ? 1 : convention->axes[1]] = is_proper ? 0.0 : M_PI / 2.0;
    const Matrix3d rotation = RotationOf(*convention, numbers);
    const Vector3d found = NumbersOf(*convention, rotation, numbers);
    EXPECT_LT((found - numbers).cwiseAbs().maxCoeff(), 1e-7) << name;
    ExpectNear(RotationOf(*convention, found), rotation, 1e-14, name);
  }
}

// Against central differences of Log(R(numbers + e) R(numbers)^T).
TEST(RotationConventionTest, TurningAxesAreTheDerivative) {
  const Vector3d numbers(0.4, -0.8, 1.3);
  constexpr double kStep = 1e-5;
  for (const std::string& name : RotationConventionNames()) {
    const RotationConvention convention = *FindRotationConvention(name);
    const Matrix3d axes = TurningAxes(convention, numbers);
    const Matrix3d rotation = RotationOf(convention, numbers);
    for (int k = 0; k < 3; ++k) {
      const Vector3d step = kStep * Vector3d::Unit(k);
      const Matrix3d after = RotationOf(convention, numbers + step);
      const Matrix3d before = RotationOf(convention, numbers - step);
      const Vector3d turn =
          (VectorFromRotation(Matrix3d(after * rotation.transpose())) -
           VectorFromRotation(Matrix3d(before * rotation.transpose()))) /
          (2.0 * kStep);
      EXPECT_LT((turn - axes.col(k)).norm(), 1e-9) << name << " " << k;
    }
  }
}

}  // namespace
}  // namespace alidade::internal
