#include "alidade/rotation.h"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "alidade/units.h"
#include "src/common/random.h"
#include "tests/support/matrix_kinematics.h"
#include "tests/support/measurement_oracle.h"
#include "tests/support/random_arms.h"

namespace alidade::internal {
namespace {

using Jet = ceres::Jet<double, 3>;

// Angles (rad) from nothing to more than a turn; 1e-6 and 1e-2 are where the
// series of Exp and of its Jacobian end.
const std::vector<double>& Angles() {
  static const std::vector<double> angles = {
      0.0,     1e-300, 1e-100,     1e-12,      1e-8, 9.9e-7,
      1.01e-6, 1e-4,   9.9e-3,     1.01e-2,    0.1,  1.0,
      2.0,     3.0,    kPi - 1e-6, kPi - 1e-9, kPi,  5.0};
  return angles;
}

Eigen::Matrix3d Skew(const Eigen::Vector3d& w) {
  Eigen::Matrix3d skew;
  skew << 0.0, -w.z(), w.y(), w.z(), 0.0, -w.x(), -w.y(), w.x(), 0.0;
  return skew;
}

Eigen::Matrix3d Exact(const Eigen::Vector3d& w) {
  return testing::MatrixFromVector(w.cast<long double>()).cast<double>();
}

// dExp / dw_k by central differences of the exact rotation in long double,
// extrapolated once: truncation about h^4 / 480 = 2e-15, rounding below 1e-16.
Eigen::Matrix3d ExactDerivative(const Eigen::Vector3d& w, int k) {
  const auto difference = [&](long double step) -> testing::Matrix3l {
    testing::Vector3l above = w.cast<long double>();
    testing::Vector3l below = above;
    above[k] += step;
    below[k] -= step;
    return (testing::MatrixFromVector(above) -
            testing::MatrixFromVector(below)) /
           (above[k] - below[k]);
  };
  const long double h = 1e-3L;
  const testing::Matrix3l derivative =
      (4.0L * difference(h / 2) - difference(h)) / 3.0L;
  return derivative.cast<double>();
}

TEST(RotationFromVectorTest, AgreesWithTheQuaternion) {
  Random random(301);
  for (const double angle : Angles()) {
    const Eigen::Vector3d w = angle * testing::RandomDirection(&random);
    const Eigen::Matrix3d rotation = RotationFromVector<double>(w);
    // A few units of eps in entries of order one.
    EXPECT_LT((rotation - Exact(w)).cwiseAbs().maxCoeff(), 1e-15) << angle;
    EXPECT_LT((rotation * rotation.transpose() - Eigen::Matrix3d::Identity())
                  .cwiseAbs()
                  .maxCoeff(),
              2e-15)
        << angle;
    EXPECT_NEAR(rotation.determinant(), 1.0, 2e-15) << angle;
  }
}

TEST(RotationFromVectorTest, KeepsSmallAnglesToFullPrecision) {
  Random random(302);
  for (const double angle : {1e-300, 1e-100, 1e-12, 1e-8, 9.9e-7, 1.01e-6}) {
    const Eigen::Vector3d w = angle * testing::RandomDirection(&random);
    const Eigen::Matrix3d rotation = RotationFromVector<double>(w);
    const Eigen::Vector3d twice_the_odd_part(rotation(2, 1) - rotation(1, 2),
                                             rotation(0, 2) - rotation(2, 0),
                                             rotation(1, 0) - rotation(0, 1));
    // sin(angle) along the axis; the first correction is angle^2 / 6 < 2e-13.
    EXPECT_LT((0.5 * twice_the_odd_part - w).norm(), 2e-13 * angle) << angle;
  }
}

TEST(RotationFromVectorTest, LongDoubleAgreesWithTheQuaternion) {
  Random random(303);
  for (const double angle : Angles()) {
    const testing::Vector3l w =
        (angle * testing::RandomDirection(&random)).cast<long double>();
    const testing::Matrix3l error =
        RotationFromVector<long double>(w) - testing::MatrixFromVector(w);
    // A few units of 1.1e-19; angle^4 / 120 of the series is below 1e-26.
    EXPECT_LT(error.cwiseAbs().maxCoeff(), 5e-19L) << angle;
  }
}

TEST(RotationFromVectorTest, TurnsByTheRightHandRule) {
  const Eigen::Matrix3d rotation =
      RotationFromVector<double>({0.0, 0.0, 0.5 * kPi});
  EXPECT_LT((rotation.col(0) - Eigen::Vector3d::UnitY()).norm(), 3e-16);
  EXPECT_LT((rotation.col(1) + Eigen::Vector3d::UnitX()).norm(), 3e-16);
}

TEST(RotationFromVectorTest, DerivativeAtZeroIsTheGenerator) {
  const Eigen::Matrix<Jet, 3, 1> zero(Jet(0.0, 0), Jet(0.0, 1), Jet(0.0, 2));
  const Eigen::Matrix<Jet, 3, 3> rotation = RotationFromVector<Jet>(zero);
  for (int k = 0; k < 3; ++k) {
    const Eigen::Matrix3d generator = Skew(Eigen::Vector3d::Unit(k));
    for (int row = 0; row < 3; ++row) {
      for (int col = 0; col < 3; ++col) {
        EXPECT_EQ(rotation(row, col).a, row == col ? 1.0 : 0.0);
        EXPECT_EQ(rotation(row, col).v[k], generator(row, col));
      }
    }
  }
}

TEST(RotationFromVectorTest, DerivativeByJetsAgreesWithDifferences) {
  Random random(304);
  for (const double angle : Angles()) {
    const Eigen::Vector3d w = angle * testing::RandomDirection(&random);
    const Eigen::Matrix<Jet, 3, 1> variable(Jet(w.x(), 0), Jet(w.y(), 1),
                                            Jet(w.z(), 2));
    const Eigen::Matrix<Jet, 3, 3> rotation = RotationFromVector<Jet>(variable);
    for (int k = 0; k < 3; ++k) {
      const Eigen::Matrix3d expected = ExactDerivative(w, k);
      for (int i = 0; i < 9; ++i) {
        // Just beyond the series, a = sin / angle is differentiated as a
        // quotient of numbers near 1e-6: eps / 1e-6 * |w| is left.
        EXPECT_NEAR(rotation(i).v[k], expected(i), 2e-14)
            << "angle " << angle << ", entry " << i << ", axis " << k;
      }
    }
  }
}

TEST(LeftJacobianOfRotationTest, IsTheIdentityAtZero) {
  EXPECT_EQ(LeftJacobianOfRotation(Eigen::Vector3d::Zero()),
            Eigen::Matrix3d::Identity());
}

TEST(LeftJacobianOfRotationTest, AgreesWithDifferencesOfTheQuaternion) {
  Random random(308);
  for (const double angle : Angles()) {
    const Eigen::Vector3d w = angle * testing::RandomDirection(&random);
    const Eigen::Matrix3d jacobian = LeftJacobianOfRotation(w);
    for (int k = 0; k < 3; ++k) {
      // dExp / dw_k = [J e_k]x Exp; the differences are good to 2e-15.
      const Eigen::Matrix3d turn = ExactDerivative(w, k) * Exact(w).transpose();
      EXPECT_LT((turn - Skew(jacobian.col(k))).cwiseAbs().maxCoeff(), 1e-14)
          << "angle " << angle << ", axis " << k;
    }
  }
}

TEST(LeftJacobianOfRotationTest, LeavesTheAxisAlone) {
  Random random(309);
  for (const double angle : Angles()) {
    const Eigen::Vector3d axis = testing::RandomDirection(&random);
    // Growing along itself, a rotation vector turns about itself.
    EXPECT_LT((LeftJacobianOfRotation(angle * axis) * axis - axis).norm(),
              2e-15)
        << angle;
  }
}

TEST(VectorFromRotationTest, OfTheIdentityIsZero) {
  EXPECT_TRUE(VectorFromRotation(Eigen::Matrix3d::Identity()).isZero(0.0));
}

TEST(VectorFromRotationTest, InvertsExpBelowAHalfTurn) {
  Random random(305);
  for (const double angle : Angles()) {
    if (angle >= kPi) continue;
    const Eigen::Vector3d w = angle * testing::RandomDirection(&random);
    // A few units of eps: relative for small angles, whose digits all stand
    // in the odd part of the matrix; absolute for large ones.
    EXPECT_LT((VectorFromRotation(Exact(w)) - w).norm(), 5e-15 * angle + 1e-308)
        << angle;
  }
}

TEST(VectorFromRotationTest, AtAHalfTurnEitherSignIsTheSameRotation) {
  Random random(306);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d axis = testing::RandomDirection(&random);
    const Eigen::Matrix3d half_turn =
        2.0 * axis * axis.transpose() - Eigen::Matrix3d::Identity();
    const Eigen::Vector3d w = VectorFromRotation(half_turn);
    EXPECT_NEAR(w.norm(), kPi, 4e-15);
    EXPECT_LT(w.cross(axis).norm(), 1e-14);
  }
}

TEST(VectorFromRotationTest, IsNeverLongerThanAHalfTurnAndExpInvertsIt) {
  Random random(307);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Matrix3d rotation =
        testing::RandomFrame(0.0, &random).linear();
    const Eigen::Vector3d w = VectorFromRotation(rotation);
    EXPECT_LE(w.norm(), kPi * (1.0 + 4e-16));
    EXPECT_LT((Exact(w) - rotation).cwiseAbs().maxCoeff(), 5e-15);
  }
}

// Angles (rad) of rotation vectors that Log returns: 2e-7 is where its series
// ends, 120 degrees where it takes another component of the quaternion.
std::vector<double> LogAngles() {
  const double third = 2.0 * kPi / 3.0;
  std::vector<double> angles = {1.9e-7, 2.1e-7, third - 1e-9, third,
                                third + 1e-9};
  for (const double angle : Angles()) {
    if (angle <= kPi) angles.push_back(angle);
  }
  return angles;
}

Eigen::Matrix<Jet, 3, 1> Variable(const Eigen::Vector3d& w) {
  return {Jet(w.x(), 0), Jet(w.y(), 1), Jet(w.z(), 2)};
}

Eigen::Matrix3d DerivativeOf(const Eigen::Matrix<Jet, 3, 1>& vector) {
  Eigen::Matrix3d derivative;
  for (int row = 0; row < 3; ++row) {
    derivative.row(row) = vector[row].v.transpose();
  }
  return derivative;
}

TEST(VectorFromRotationTest, LongDoubleInvertsExpToItsOwnPrecision) {
  Random random(310);
  for (const double angle : LogAngles()) {
    if (angle == kPi) continue;
    const testing::Vector3l w =
        (angle * testing::RandomDirection(&random)).cast<long double>();
    const testing::Vector3l again =
        VectorFromRotation<long double>(testing::MatrixFromVector(w));
    // A few units of 1.1e-19, relative even for the smallest angles.
    EXPECT_LT((again - w).norm(), 2e-18L * w.norm() + 1e-320L) << angle;
  }
}

TEST(VectorFromRotationTest, JetsHaveTheValueOfDouble) {
  Random random(311);
  for (const double angle : LogAngles()) {
    const Eigen::Matrix3d rotation =
        Exact(angle * testing::RandomDirection(&random));
    const Eigen::Matrix<Jet, 3, 1> jets =
        VectorFromRotation<Jet>(rotation.cast<Jet>());
    const Eigen::Vector3d w = VectorFromRotation(rotation);
    for (int row = 0; row < 3; ++row) {
      EXPECT_NEAR(jets[row].a, w[row], 2e-15 * w.norm()) << angle;
    }
  }
}

TEST(VectorFromRotationTest, JetsOfExpAndLogAreThoseOfTheVector) {
  Random random(312);
  for (const double angle : LogAngles()) {
    // At half a turn Log may return the other vector.
    if (angle == kPi) continue;
    const Eigen::Vector3d w = angle * testing::RandomDirection(&random);
    const Eigen::Matrix<Jet, 3, 1> again =
        VectorFromRotation<Jet>(RotationFromVector<Jet>(Variable(w)));
    // As in Exp, quotients of numbers near 1e-7 lose some digits.
    EXPECT_LT((DerivativeOf(again) - Eigen::Matrix3d::Identity())
                  .cwiseAbs()
                  .maxCoeff(),
              2e-14)
        << angle;
  }
}

TEST(VectorFromRotationTest, DerivativeOfATurnOnTheLeftIsTheInverseJacobian) {
  Random random(313);
  for (const double angle : LogAngles()) {
    const Eigen::Matrix3d rotation =
        Exact(angle * testing::RandomDirection(&random));
    const Eigen::Matrix<Jet, 3, 3> turned =
        RotationFromVector<Jet>(Variable(Eigen::Vector3d::Zero())) *
        rotation.cast<Jet>();
    const Eigen::Matrix3d derivative =
        DerivativeOf(VectorFromRotation<Jet>(turned));
    ASSERT_TRUE(derivative.allFinite()) << angle;
    const Eigen::Matrix3d expected =
        InverseLeftJacobianOfRotation(VectorFromRotation(rotation));
    EXPECT_LT((derivative - expected).cwiseAbs().maxCoeff(), 2e-14) << angle;
  }
}

TEST(InverseLeftJacobianTest, IsTheIdentityAtZero) {
  EXPECT_EQ(InverseLeftJacobianOfRotation(Eigen::Vector3d::Zero()),
            Eigen::Matrix3d::Identity());
}

TEST(InverseLeftJacobianTest, InvertsTheLeftJacobian) {
  Random random(314);
  for (const double angle : Angles()) {
    const Eigen::Vector3d w = angle * testing::RandomDirection(&random);
    const Eigen::Matrix3d product =
        InverseLeftJacobianOfRotation(w) * LeftJacobianOfRotation(w);
    // The inverse grows beyond half a turn, to 4 at 5 rad.
    EXPECT_LT((product - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(),
              5e-15)
        << angle;
  }
}

// Log(Exp(e) R) - Log(R) = J^-1 e + O(e^2): central differences over e = h and
// h / 2 in long double, extrapolated once, are good to h^4, 1e-15 at half a
// turn, and to 1e-19 / h.
TEST(InverseLeftJacobianTest, IsTheFirstOrderOfLogAfterATurnOnTheLeft) {
  Random random(315);
  for (const double angle : LogAngles()) {
    const Eigen::Vector3d w = angle * testing::RandomDirection(&random);
    const testing::Vector3l exact_w = w.cast<long double>();
    const testing::Matrix3l rotation = testing::MatrixFromVector(exact_w);
    const Eigen::Matrix3d inverse = InverseLeftJacobianOfRotation(w);
    for (int k = 0; k < 3; ++k) {
      const auto difference = [&](long double step) -> testing::Vector3l {
        const testing::Vector3l turn = step * testing::Vector3l::Unit(k);
        return (testing::LogOfMatrix(testing::MatrixFromVector(turn) * rotation,
                                     exact_w) -
                testing::LogOfMatrix(
                    testing::MatrixFromVector(-turn) * rotation, exact_w)) /
               (2.0L * step);
      };
      const long double h = 1e-4L;
      const testing::Vector3l derivative =
          (4.0L * difference(h / 2) - difference(h)) / 3.0L;
      EXPECT_LT((inverse.col(k) - derivative.cast<double>()).norm(), 1e-14)
          << "angle " << angle << ", axis " << k;
    }
  }
}

}  // namespace
}  // namespace alidade::internal
