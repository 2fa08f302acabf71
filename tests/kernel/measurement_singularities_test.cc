#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "alidade/dataset.h"
#include "alidade/units.h"
#include "src/common/random.h"
#include "src/kernel/measurement_model.h"
#include "src/kernel/observation_cost.h"
#include "tests/support/cost_evaluation.h"
#include "tests/support/edit.h"
#include "tests/support/measurement_oracle.h"
#include "tests/support/random_measurements.h"

// Where residuals have no derivative, or formulas lose their digits: lengths
// near zero, orientation errors near none and near half a turn, normals near
// the poles of TangentBasis.
namespace alidade::internal::measurement_singularities_test {
namespace {

using testing::MeasuredArm;
using testing::Vector3l;

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

// The residual and Jacobian of the only observation, by the geometric way and
// by autodiff.
struct Rows {
  Linearization geometric;
  testing::CostEvaluation autodiff;
};

Rows Evaluate(const MeasuredArm& measured) {
  const MeasurementModel model(measured.arm, measured.references, 1);
  std::vector<int> columns(model.layout().size());
  std::iota(columns.begin(), columns.end(), 0);
  Rows rows;
  model.Linearize(measured.values, measured.data, columns, &rows.geometric);
  rows.autodiff = testing::EvaluateCost(
      MakeObservationCost(model, measured.data, measured.data.blocks[0], 0,
                          true),
      model.layout(), measured.values);
  return rows;
}

// A random arm with a single observation of the kind, unit sigmas.
MeasuredArm OneObservation(int num_joints, MeasurementKind kind,
                           Random* random) {
  MeasuredArm measured = testing::RandomMeasurements(
      num_joints, testing::Weighting::kSigmas, random);
  measured.data.blocks = {testing::MakeBlock(kind, 1)};
  return measured;
}

// One joint in a straight chain along x and z: its positions have no rounding
// errors, its orientation is the tool's.
MeasuredArm ExactArm(MeasurementKind kind) {
  MeasuredArm measured{
      {}, {}, ParameterLayout(LayoutShape{1, 1, 2, 0}), {}, {}};
  measured.arm.joints.resize(1);
  measured.arm.joints[0].d = 0.5;
  measured.arm.joints[0].r = 0.25;
  measured.references.points = {{"a", {0.5, 0.0, 0.25}},
                                {"b", {0.5, 0.0, 0.25}}};
  measured.data.joint_values = Eigen::MatrixXd::Zero(1, 1);
  ObservationBlock block;
  block.kind = kind;
  block.references = {0};
  block.seconds = {1};
  block.measured = Eigen::MatrixXd::Zero(RowsOf(kind), 1);
  block.sigmas = Eigen::MatrixXd::Ones(RowsOf(kind), 1);
  measured.data.blocks = {block};
  measured.values =
      MeasurementModel(measured.arm, measured.references, 1).NominalValues();
  return measured;
}

TEST(ZeroLengthTest, HasNoDerivative) {
  for (const MeasurementKind kind :
       {MeasurementKind::kDistance, MeasurementKind::kPointDistance}) {
    MeasuredArm measured = ExactArm(kind);
    testing::Edit(&measured.data.blocks[0].measured).at(0, 0) = 0.125;
    const Rows rows = Evaluate(measured);
    EXPECT_EQ(rows.geometric.residuals[0], -0.125);
    EXPECT_EQ(rows.autodiff.residuals[0], -0.125);
    EXPECT_TRUE(rows.geometric.jacobian.isZero(0.0));
    EXPECT_TRUE(rows.autodiff.jacobian.isZero(0.0));
  }
}

TEST(ZeroLengthTest, IsFiniteWhereRoundingMakesADirectionOfIt) {
  Random random(41);
  for (int n = 1; n <= 7; ++n) {
    MeasuredArm measured =
        OneObservation(n, MeasurementKind::kDistance, &random);
    const MeasurementModel model(measured.arm, measured.references, 1);
    const int point = model.layout().Column(
        ParameterKind::kPoint, 0, measured.data.blocks[0].references[0]);
    measured.values.segment<3>(point) =
        model.Predict(measured.values, measured.data.joint_values).col(0);
    const Rows rows = Evaluate(measured);
    // The positions that derivatives go with are some roundings off: they have
    // no direction or any.
    const double sigma = measured.data.blocks[0].sigmas(0, 0);
    EXPECT_LE(std::abs(rows.geometric.residuals[0]) * sigma,
              1e-14 * Reach(measured.arm));
    for (const Eigen::MatrixXd& jacobian :
         {rows.geometric.jacobian, rows.autodiff.jacobian}) {
      ASSERT_TRUE(jacobian.allFinite());
      EXPECT_LE(jacobian.middleCols<3>(point).norm(), 1.0 + 1e-15);
    }
  }
}

TEST(ShortLengthTest, DistanceGrowsInADirectionOfLengthOne) {
  Random random(42);
  for (int n = 1; n <= 7; ++n) {
    MeasuredArm measured =
        OneObservation(n, MeasurementKind::kDistance, &random);
    const int point = measured.layout.Column(
        ParameterKind::kPoint, 0, measured.data.blocks[0].references[0]);
    const Vector3l position = testing::OraclePosition(
        measured, measured.values.cast<long double>(), 0, 0);
    measured.values.segment<3>(point) =
        position.cast<double>() + 1e-12 * testing::RandomDirection(&random);
    const testing::VectorXl values = measured.values.cast<long double>();
    const Vector3l difference = position - values.segment<3>(point);
    testing::Matrix3Xl moves =
        testing::Matrix3Xl::Zero(3, measured.layout.size());
    moves = testing::MatrixJacobian(measured.arm, values,
                                    measured.data.joint_values.data());
    moves.middleCols<3>(point) = -testing::Matrix3l::Identity();
    const Eigen::RowVectorXd expected =
        (difference.normalized().transpose() * moves).cast<double>();
    const Rows rows = Evaluate(measured);
    // Positions are rounded to some units of eps, directions to so much of
    // 1e-12.
    const double rounding = 10.0 * kEpsilon * (1.0 + Reach(measured.arm));
    EXPECT_NEAR(rows.geometric.residuals[0],
                static_cast<double>(difference.norm()), rounding);
    const double tolerance =
        3.0 * rounding / 1e-12 * (1.0 + Reach(measured.arm));
    ASSERT_LT(tolerance, 0.5);
    EXPECT_LT((rows.geometric.jacobian - expected).cwiseAbs().maxCoeff(),
              tolerance);
    EXPECT_LT((rows.autodiff.jacobian - expected).cwiseAbs().maxCoeff(),
              tolerance);
    EXPECT_NEAR(rows.geometric.jacobian.middleCols<3>(point).norm(), 1.0,
                1e-15);
    EXPECT_NEAR(rows.autodiff.jacobian.middleCols<3>(point).norm(), 1.0, 1e-15);
  }
}

TEST(ShortLengthTest, PointDistanceHasTheExactDirection) {
  Random random(43);
  for (const double length : {1e-12, 1e-9, 1e-3}) {
    MeasuredArm measured = ExactArm(MeasurementKind::kPointDistance);
    const int first = measured.layout.Column(ParameterKind::kPoint, 0, 0);
    const int second = measured.layout.Column(ParameterKind::kPoint, 0, 1);
    measured.values.segment<3>(first) +=
        length * testing::RandomDirection(&random);
    // Subtracting nearby numbers is exact.
    const Eigen::Vector3d difference =
        measured.values.segment<3>(first) - measured.values.segment<3>(second);
    const Rows rows = Evaluate(measured);
    EXPECT_NEAR(rows.geometric.residuals[0], difference.norm(), 1e-15 * length);
    for (const Eigen::MatrixXd& jacobian :
         {rows.geometric.jacobian, rows.autodiff.jacobian}) {
      const Eigen::Vector3d u = difference.normalized();
      EXPECT_LT((jacobian.middleCols<3>(first).transpose() - u).norm(), 1e-15);
      EXPECT_LT((jacobian.middleCols<3>(second).transpose() + u).norm(), 1e-15);
      EXPECT_TRUE(jacobian.leftCols(first).isZero(0.0));
    }
  }
}

// Orientation errors (rad) of all sizes: none; about 2e-7 and 1e-2, where
// series begin; about 120 degrees, where Log goes another way; about half a
// turn, beyond which the vector points the other way.
std::vector<double> OrientationErrors() {
  const double third = 2.0 * kPi / 3.0;
  return {0.0,          1e-12,      1e-9,       1.9e-7,       2.1e-7,
          9.9e-3,       1.01e-2,    1.0,        third - 1e-9, third,
          third + 1e-9, kPi - 1e-6, kPi - 1e-9, kPi - 1e-12,  kPi,
          kPi + 1e-12,  kPi + 1e-9};
}

// Measures an orientation that is `error` off on the left: R R_m^T =
// Exp(error).
void SetOrientationError(const Vector3l& error, MeasuredArm* measured) {
  const testing::Matrix3l r =
      testing::OracleFrame(*measured, measured->values.cast<long double>(), 0,
                           0)
          .topLeftCorner<3, 3>();
  const testing::Matrix3l off = testing::MatrixFromVector(-error) * r;
  testing::Edit(&measured->data.blocks[0].measured)->col(0).tail<3>() =
      testing::LogOfMatrix(off).cast<double>();
}

class OrientationErrorTest : public ::testing::TestWithParam<double> {};

TEST_P(OrientationErrorTest, LogAndItsDerivativeAreRight) {
  Random random(44);
  for (int n = 1; n <= 7; ++n) {
    MeasuredArm measured = OneObservation(n, MeasurementKind::kPose, &random);
    const Vector3l axis =
        testing::RandomDirection(&random).cast<long double>().normalized();
    SetOrientationError(GetParam() * axis, &measured);
    const Rows rows = Evaluate(measured);
    const testing::VectorXl values = measured.values.cast<long double>();
    const ObservationBlock& block = measured.data.blocks[0];
    const double reach = 1.0 + Reach(measured.arm);
    ASSERT_TRUE(rows.geometric.jacobian.allFinite());
    // Of two vectors of half a turn, the one that the residual has.
    const auto check = [&](const Eigen::VectorXd& residual,
                           const Eigen::MatrixXd& jacobian,
                           const Vector3l& near) {
      const testing::VectorXl exact =
          testing::OracleResidual(measured, values, block, 0, near);
      EXPECT_LT((residual - exact.cast<double>()).norm(),
                50.0 * kEpsilon * reach);
      EXPECT_LE(residual.tail<3>().norm(), kPi * (1.0 + 2.0 * kEpsilon));
      const testing::MatrixXl expected =
          testing::OracleJacobian(measured, values, block, 0, near);
      return (jacobian - expected.cast<double>()).cwiseAbs().maxCoeff();
    };
    const Vector3l near =
        rows.geometric.residuals.tail<3>().cast<long double>();
    const Vector3l autodiff_near =
        rows.autodiff.residuals.tail<3>().cast<long double>();
    const double tolerance = 5e-14 * reach;
    EXPECT_LT(
        check(rows.autodiff.residuals, rows.autodiff.jacobian, autodiff_near),
        tolerance);
    double error =
        check(rows.geometric.residuals, rows.geometric.jacobian, near);
    // Within rounding of half a turn, the Jacobian's own orientation may be on
    // the other side than the residual's.
    if (std::abs(GetParam() - kPi) < 1e-14) {
      Eigen::VectorXd other = rows.geometric.residuals;
      other.tail<3>() *= -1.0;
      error = std::min(error, check(other, rows.geometric.jacobian, -near));
    }
    EXPECT_LT(error, tolerance) << n << " joints";
  }
}

INSTANTIATE_TEST_SUITE_P(Angles, OrientationErrorTest,
                         ::testing::ValuesIn(OrientationErrors()));

TEST(OrientationTest, NoErrorAndHalfATurnAreExactWhereTheMatrixIs) {
  MeasuredArm measured = ExactArm(MeasurementKind::kPose);
  testing::Edit(&measured.data.blocks[0].measured)->col(0) << 0.5, 0.0, 0.25,
      0.0, 0.0, 0.0;
  EXPECT_TRUE(Evaluate(measured).geometric.residuals.isZero(0.0));
  for (int axis = 0; axis < 3; ++axis) {
    Eigen::Vector3d diagonal(-1.0, -1.0, -1.0);
    diagonal[axis] = 1.0;
    measured.arm.last_from_target().linear() = diagonal.asDiagonal();
    const Rows rows = Evaluate(measured);
    const Eigen::Vector3d w = rows.geometric.residuals.tail<3>();
    EXPECT_EQ(w.cwiseAbs(), kPi * Eigen::Vector3d::Unit(axis));
    EXPECT_EQ(rows.autodiff.residuals, rows.geometric.residuals);
    EXPECT_TRUE(rows.autodiff.jacobian.allFinite());
    EXPECT_LT((rows.autodiff.jacobian - rows.geometric.jacobian)
                  .cwiseAbs()
                  .maxCoeff(),
              5e-15);
  }
}

TEST(PlanePoleTest, NormalsNearThePolesAreLikeAllOthers) {
  Random random(45);
  for (const double sign : {1.0, -1.0}) {
    for (const double off : {0.0, 1e-300, 1e-16, 1e-9, 1e-4}) {
      for (const double tilt : {0.0, 1e-9, 0.3}) {
        MeasuredArm measured =
            OneObservation(4, MeasurementKind::kPlane, &random);
        measured.references.planes[0].normal =
            Eigen::Vector3d(off, -off, sign).normalized();
        const int u = measured.layout.Column(ParameterKind::kPlaneTilt, 0);
        measured.values[u] = tilt;
        measured.values[u + 1] = -2.0 * tilt;
        const testing::VectorXl values = measured.values.cast<long double>();
        const ObservationBlock& block = measured.data.blocks[0];
        const Rows rows = Evaluate(measured);
        const double scale = 1.0 + Reach(measured.arm);
        const double exact = static_cast<double>(
            testing::OracleResidual(measured, values, block, 0)[0]);
        EXPECT_NEAR(rows.geometric.residuals[0], exact, 1e-14 * scale);
        EXPECT_NEAR(rows.autodiff.residuals[0], exact, 1e-14 * scale);
        const Eigen::MatrixXd expected =
            testing::OracleJacobian(measured, values, block, 0).cast<double>();
        EXPECT_LT((rows.geometric.jacobian - expected).cwiseAbs().maxCoeff(),
                  5e-14 * scale);
        EXPECT_LT((rows.autodiff.jacobian - expected).cwiseAbs().maxCoeff(),
                  5e-14 * scale);
      }
    }
  }
}

}  // namespace
}  // namespace alidade::internal::measurement_singularities_test
