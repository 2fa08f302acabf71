#include "src/kernel/measurement_model.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <limits>
#include <numeric>
#include <tuple>
#include <vector>

#include "alidade/forward_kinematics.h"
#include "src/common/random.h"
#include "tests/support/edit.h"
#include "tests/support/matrix_kinematics.h"
#include "tests/support/random_arms.h"
#include "tests/support/random_datasets.h"
#include "tests/support/random_errors.h"
#include "tests/support/rv2aj_arms.h"

namespace alidade::internal {
namespace {

std::vector<int> AllColumns(const ParameterLayout& layout) {
  std::vector<int> columns(layout.size());
  std::iota(columns.begin(), columns.end(), 0);
  return columns;
}

Linearization LinearizeAll(const MeasurementModel& model,
                           const Eigen::VectorXd& values, const Dataset& data) {
  Linearization linearization;
  model.Linearize(values, data, AllColumns(model.layout()), &linearization);
  return linearization;
}

// An arm, values with rotated frames, and measurements some millimetres off.
struct Problem {
  Arm arm;
  Eigen::VectorXd values;
  Dataset data;
};

Problem RandomProblem(int num_joints, int num_poses, Random* random) {
  Problem problem;
  problem.arm = testing::RandomArm(num_joints, random);
  problem.values = testing::ValuesWithRotations(problem.arm, 0.3, random);
  problem.data =
      testing::RandomDataset(problem.arm, problem.values, num_poses, random);
  for (Eigen::Index i = 0; i < problem.data.num_poses(); ++i) {
    testing::Edit(&problem.data.positions())->col(i) +=
        testing::RandomVector(0.01, random);
  }
  return problem;
}

class JacobianTest : public ::testing::TestWithParam<std::tuple<int, double>> {
};

TEST_P(JacobianTest, AgreesWithDifferencesOfTheMatrixProducts) {
  const auto [num_joints, rotation_length] = GetParam();
  Random random(501, num_joints);
  const Arm arm = testing::RandomArm(num_joints, &random);
  const Eigen::VectorXd values =
      testing::ValuesWithRotations(arm, rotation_length, &random);
  const Dataset data = testing::RandomDataset(arm, values, 3, &random);
  const Linearization linearization =
      LinearizeAll(MeasurementModel(arm), values, data);
  ASSERT_EQ(linearization.jacobian.rows(), data.num_rows());
  ASSERT_EQ(linearization.jacobian.cols(), values.size());
  for (Eigen::Index i = 0; i < data.num_poses(); ++i) {
    const testing::Matrix3Xl exact = testing::MatrixJacobian(
        arm, values.cast<long double>(), data.joint_values.col(i).data());
    const Eigen::Matrix3Xd unwhitened =
        data.sigmas().col(i).asDiagonal() *
        linearization.jacobian.middleRows<3>(3 * i);
    const Eigen::Matrix3Xd error = unwhitened - exact.cast<double>();
    // Some forty roundings of eps, in units of the reach (angles) or of one
    // (lengths); the differences themselves are good to 1e-14.
    EXPECT_LT(error.cwiseAbs().maxCoeff(), 5e-14 * (1.0 + Reach(arm)));
  }
}

INSTANTIATE_TEST_SUITE_P(
    JointsAndRotations, JacobianTest,
    ::testing::Combine(::testing::Range(1, 10),
                       ::testing::ValuesIn(testing::RotationLengths())));

TEST(MeasurementModelTest, NominalValuesAreThoseOfTheArm) {
  Random random(502);
  const Arm arm = testing::RandomArm(3, &random);
  const MeasurementModel model(arm, 2);
  EXPECT_EQ(model.num_threads(), 2);
  EXPECT_EQ(model.layout().num_joints(), 3);
  EXPECT_EQ(model.NominalValues(), ParameterLayout(3).Values(arm));
}

TEST(MeasurementModelTest, NominalValuesOfReferencesAreTheirs) {
  Random random(502);
  References references;
  references.points.resize(2);
  references.points[1].position << 1.0, 2.0, 3.0;
  references.planes.resize(2);
  references.planes[0].offset = 4.0;
  references.planes[1].offset = 5.0;
  const MeasurementModel model(testing::RandomArm(3, &random), references, 1);
  Eigen::VectorXd expected(12);
  expected << 0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 0.0, 0.0, 4.0, 0.0, 0.0, 5.0;
  EXPECT_EQ(model.NominalValues().tail<12>(), expected);
}

// Of more poses than a vector or a tile holds.
TEST(MeasurementModelTest, PredictsFlexibleArmsAsTheTemplateDoes) {
  Random random(513);
  for (const int num_joints : {2, 6}) {
    Arm arm = testing::RandomArm(num_joints, &random);
    arm.errors = testing::RandomErrors(arm, &random);
    const Eigen::MatrixXd poses = testing::RandomJointValues(arm, 100, &random);
    const MeasurementModel model(arm);
    const Eigen::Matrix3Xd error = model.Predict(model.NominalValues(), poses) -
                                   TargetPositions(arm, poses);
    // As error_terms_test.cc allows for the template.
    EXPECT_LT(error.cwiseAbs().maxCoeff(), 3e-14 * (1.0 + Reach(arm)));
  }
}

TEST(MeasurementModelTest, PredictsThePositionsOfTheMatrixProducts) {
  Random random(503);
  const Problem problem = RandomProblem(6, 20, &random);
  const Eigen::Matrix3Xd predicted =
      MeasurementModel(problem.arm)
          .Predict(problem.values, problem.data.joint_values);
  for (Eigen::Index i = 0; i < problem.data.num_poses(); ++i) {
    const Eigen::Vector3d expected =
        testing::MatrixPosition(problem.arm, problem.values.cast<long double>(),
                                problem.data.joint_values.col(i).data())
            .cast<double>();
    EXPECT_LT((predicted.col(i) - expected).norm(), 1e-14 * Reach(problem.arm));
  }
}

TEST(MeasurementModelTest, ErrorsArePredictedMinusMeasured) {
  Random random(504);
  const Arm arm = testing::RandomArm(5, &random);
  const MeasurementModel model(arm);
  Dataset data = testing::RandomDataset(arm, model.NominalValues(), 8, &random);
  const Eigen::Vector3d offset(0.25, -0.5, 1.0);
  testing::Edit(&data.positions())->colwise() -= offset;
  const SharedVector errors = model.Errors(model.NominalValues(), data);
  ASSERT_EQ(errors.size(), 3 * data.num_poses());
  for (Eigen::Index i = 0; i < data.num_poses(); ++i) {
    EXPECT_LT((errors.map().segment<3>(3 * i) - offset).norm(),
              1e-14 * (1.0 + Reach(arm)));
  }
}

TEST(MeasurementModelTest, ResidualsVanishAtTheTruth) {
  for (int num_joints = 1; num_joints <= 9; ++num_joints) {
    Random random(505, num_joints);
    const Arm arm = testing::RandomArm(num_joints, &random);
    const Eigen::VectorXd values =
        testing::ValuesWithRotations(arm, 0.7, &random);
    const Dataset data = testing::RandomDataset(arm, values, 10, &random);
    const Linearization linearization =
        LinearizeAll(MeasurementModel(arm), values, data);
    const Eigen::Map<const Eigen::Matrix3Xd> residuals(
        linearization.residuals.data(), 3, data.num_poses());
    // Rounding of the forward kinematics, whitened.
    EXPECT_LT(residuals.cwiseProduct(data.sigmas().map()).cwiseAbs().maxCoeff(),
              1e-14 * Reach(arm));
  }
}

TEST(MeasurementModelTest, ResidualsAreErrorsInUnitsOfTheirSigmas) {
  Random random(506);
  const Problem problem = RandomProblem(4, 6, &random);
  const MeasurementModel model(problem.arm);
  const Linearization linearization =
      LinearizeAll(model, problem.values, problem.data);
  const SharedVector errors = model.Errors(problem.values, problem.data);
  for (Eigen::Index i = 0; i < problem.data.num_poses(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      // The kernel and the template round a length of some metres each.
      const double sigma = problem.data.sigmas()(axis, i);
      EXPECT_NEAR(linearization.residuals[3 * i + axis] * sigma,
                  errors[3 * i + axis], 1e-14 * Reach(problem.arm));
    }
  }
}

TEST(MeasurementModelTest, SigmaOfOneCoordinateScalesItsRowOnly) {
  Random random(507);
  Problem problem = RandomProblem(4, 5, &random);
  const MeasurementModel model(problem.arm);
  Linearization expected = LinearizeAll(model, problem.values, problem.data);
  const int axis = 1;
  const Eigen::Index pose = 3;
  // A power of two, so that the scaled numbers agree to the bit.
  testing::Edit(&problem.data.sigmas()).at(axis, pose) *= 4.0;
  expected.residuals[3 * pose + axis] /= 4.0;
  expected.jacobian.row(3 * pose + axis) /= 4.0;
  const Linearization scaled =
      LinearizeAll(model, problem.values, problem.data);
  EXPECT_EQ(scaled.residuals, expected.residuals);
  EXPECT_EQ(scaled.jacobian, expected.jacobian);
}

TEST(MeasurementModelTest, ColumnsComeInTheOrderAskedFor) {
  Random random(508);
  const Problem problem = RandomProblem(3, 4, &random);
  const MeasurementModel model(problem.arm);
  const Linearization all = LinearizeAll(model, problem.values, problem.data);
  const std::vector<int> columns = {
      *model.layout().Find("tool_z"), *model.layout().Find("beta2"),
      *model.layout().Find("base_ry"), *model.layout().Find("theta1")};
  Linearization some;
  model.Linearize(problem.values, problem.data, columns, &some);
  ASSERT_EQ(some.jacobian.cols(), static_cast<Eigen::Index>(columns.size()));
  for (std::size_t c = 0; c < columns.size(); ++c) {
    EXPECT_EQ(some.jacobian.col(static_cast<Eigen::Index>(c)),
              all.jacobian.col(columns[c]));
  }
  EXPECT_EQ(some.residuals, all.residuals);
}

TEST(MeasurementModelTest, WithoutColumnsOnlyResidualsAreFilled) {
  Random random(509);
  const Problem problem = RandomProblem(3, 4, &random);
  const MeasurementModel model(problem.arm);
  Linearization none;
  model.Linearize(problem.values, problem.data, {}, &none);
  EXPECT_EQ(none.jacobian.rows(), 12);
  EXPECT_EQ(none.jacobian.cols(), 0);
  EXPECT_EQ(none.residuals,
            LinearizeAll(model, problem.values, problem.data).residuals);
}

TEST(MeasurementModelTest, AnEmptyDataSetGivesEmptyResults) {
  Random random(510);
  const Problem problem = RandomProblem(3, 0, &random);
  const MeasurementModel model(problem.arm, 4);
  const Linearization linearization =
      LinearizeAll(model, problem.values, problem.data);
  EXPECT_EQ(linearization.residuals.size(), 0);
  EXPECT_EQ(linearization.jacobian.rows(), 0);
  EXPECT_EQ(model.Errors(problem.values, problem.data).size(), 0);
}

TEST(MeasurementModelTest, ThreadsDoNotChangeABit) {
  Random random(511);
  const Problem problem = RandomProblem(6, 1000, &random);
  const MeasurementModel one(problem.arm, 1);
  const Linearization expected =
      LinearizeAll(one, problem.values, problem.data);
  const SharedVector expected_errors = one.Errors(problem.values, problem.data);
  // Several times, as threads may happen to run one after the other.
  for (const int num_threads : {1, 2, 8, 2, 8, 2, 8, 2, 8}) {
    const MeasurementModel model(problem.arm, num_threads);
    const Linearization actual =
        LinearizeAll(model, problem.values, problem.data);
    EXPECT_EQ(actual.residuals, expected.residuals) << num_threads;
    EXPECT_EQ(actual.jacobian, expected.jacobian) << num_threads;
    EXPECT_EQ(model.Errors(problem.values, problem.data), expected_errors)
        << num_threads;
  }
}

TEST(MeasurementModelTest, RoundingErrorIsTheUnitInTheLastPlaceOfTheReach) {
  // 2^-52 of 782 mm.
  EXPECT_DOUBLE_EQ(MeasurementModel(testing::Rv2ajFlange()).RoundingError(),
                   0.782 * std::numeric_limits<double>::epsilon());
}

TEST(MeasurementModelTest, RoundingErrorIsTheScaleOfTheActualOne) {
  Random random(512);
  const Arm arm = testing::WithRv2ajDeviations(testing::Rv2ajFlange());
  const MeasurementModel model(arm);
  const Eigen::MatrixXd poses = testing::RandomJointValues(arm, 2000, &random);
  const Eigen::Matrix3Xd predicted =
      model.Predict(model.NominalValues(), poses);
  double largest = 0.0;
  for (Eigen::Index i = 0; i < poses.cols(); ++i) {
    const testing::Vector3l error =
        predicted.col(i).cast<long double>() -
        testing::MatrixPosition(arm, poses.col(i).data());
    largest =
        std::max(largest, static_cast<double>(error.cwiseAbs().maxCoeff()));
  }
  // Two-sided: neither far below what happens nor far above it. Four is what
  // the solvers allow above it by default.
  EXPECT_LE(largest, 4.0 * model.RoundingError());
  EXPECT_GE(largest, 0.25 * model.RoundingError());
}

TEST(ChiSquareTest, SumsSquaresInUnitsOfSigma) {
  Eigen::Matrix3Xd sigmas(3, 2);
  sigmas << 1.0, 2.0, 0.5, 4.0, 0.25, 8.0;
  const Dataset data = MakePositions(Eigen::MatrixXd::Zero(1, 2),
                                     Eigen::Matrix3Xd::Zero(3, 2), sigmas);
  Eigen::VectorXd errors(6);
  errors << 3.0, -1.0, 0.5, 2.0, 8.0, -24.0;
  // 3^2 + 1^2 + 2^2 + 2^2 + 2^2 + 3^2
  EXPECT_DOUBLE_EQ(ChiSquare(errors, data), 31.0);
}

TEST(ChiSquareTest, IsTheSquaredNormOfTheResiduals) {
  Random random(513);
  const Problem problem = RandomProblem(4, 30, &random);
  const MeasurementModel model(problem.arm);
  const double expected =
      LinearizeAll(model, problem.values, problem.data).residuals.squaredNorm();
  // Ninety terms, each from errors that the kernel and the template round.
  EXPECT_NEAR(
      ChiSquare(model.Errors(problem.values, problem.data), problem.data),
      expected, 1e-12 * expected);
}

}  // namespace
}  // namespace alidade::internal
