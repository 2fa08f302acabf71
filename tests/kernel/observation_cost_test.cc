#include "src/kernel/observation_cost.h"

#include <ceres/cost_function.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <numeric>
#include <tuple>
#include <vector>

#include "src/common/random.h"
#include "src/kernel/measurement_model.h"
#include "tests/support/edit.h"
#include "tests/support/matrix_kinematics.h"
#include "tests/support/random_arms.h"
#include "tests/support/random_datasets.h"

namespace alidade::internal::observation_cost_test {
namespace {

using RowMajorBlock = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor>;

struct Evaluation {
  Eigen::Vector3d residuals;
  Eigen::Matrix3Xd jacobian;  ///< columns of the layout, joint blocks first
};

// The blocks of the layout that a cost with or without frames has.
std::vector<ParameterBlock> Blocks(const ParameterLayout& layout,
                                   bool with_frames) {
  std::vector<ParameterBlock> blocks = layout.blocks();
  if (!with_frames) blocks.resize(5);
  return blocks;
}

Evaluation Evaluate(const ceres::CostFunction& cost,
                    const Eigen::VectorXd& values,
                    const std::vector<ParameterBlock>& blocks) {
  std::vector<const double*> parameters;
  std::vector<RowMajorBlock> jacobians;
  int num_columns = 0;
  for (const ParameterBlock& block : blocks) {
    parameters.push_back(values.data() + block.first_column);
    jacobians.emplace_back(3, block.size);
    num_columns += block.size;
  }
  std::vector<double*> jacobian_pointers;
  for (RowMajorBlock& jacobian : jacobians) {
    jacobian_pointers.push_back(jacobian.data());
  }
  Evaluation evaluation;
  EXPECT_TRUE(cost.Evaluate(parameters.data(), evaluation.residuals.data(),
                            jacobian_pointers.data()));
  evaluation.jacobian.resize(3, num_columns);
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    evaluation.jacobian.middleCols(blocks[b].first_column, blocks[b].size) =
        jacobians[b];
  }
  return evaluation;
}

// One pose of a random arm, measured some millimetres off.
struct Problem {
  Problem(int num_joints, double rotation_length, bool frames,
          std::uint64_t seed)
      : random(seed, num_joints),
        with_frames(frames),
        arm(testing::RandomArm(num_joints, &random)),
        model(arm),
        layout(num_joints),
        values(testing::ValuesWithRotations(arm, frames ? rotation_length : 0.0,
                                            &random)),
        data(testing::RandomDataset(arm, values, 1, &random)) {
    testing::Edit(&data.positions())->col(0) +=
        testing::RandomVector(0.01, &random);
  }

  ObservationCost MakeCost() const {
    return MakeObservationCost(model, data, data.blocks[0], 0, with_frames);
  }
  Evaluation EvaluateCost() const {
    return Evaluate(*MakeCost().function, values, Blocks(layout, with_frames));
  }

  Random random;
  bool with_frames;
  Arm arm;
  MeasurementModel model;
  ParameterLayout layout;
  Eigen::VectorXd values;
  Dataset data;
};

class ObservationCostTest
    : public ::testing::TestWithParam<std::tuple<int, bool>> {
 protected:
  int num_joints() const { return std::get<0>(GetParam()); }
  bool with_frames() const { return std::get<1>(GetParam()); }
};

TEST_P(ObservationCostTest, HasTheBlocksOfTheLayout) {
  const Problem problem(num_joints(), 0.1, with_frames(), 601);
  const ObservationCost cost = problem.MakeCost();
  std::vector<int> expected;
  std::vector<int> indices;
  for (const ParameterBlock& block : Blocks(problem.layout, with_frames())) {
    indices.push_back(static_cast<int>(indices.size()));
    expected.push_back(block.size);
  }
  EXPECT_EQ(cost.blocks, indices);
  EXPECT_EQ(cost.function->num_residuals(), 3);
  EXPECT_EQ(cost.function->parameter_block_sizes(), expected);
}

TEST_P(ObservationCostTest, JacobianAgreesWithDifferences) {
  for (const double length : testing::RotationLengths()) {
    const Problem problem(num_joints(), length, with_frames(), 602);
    const Evaluation evaluation = problem.EvaluateCost();
    const testing::Matrix3Xl exact =
        testing::MatrixJacobian(problem.arm, problem.values.cast<long double>(),
                                problem.data.joint_values.data());
    const Eigen::Matrix3Xd error =
        problem.data.sigmas().col(0).asDiagonal() * evaluation.jacobian -
        exact.leftCols(evaluation.jacobian.cols()).cast<double>();
    // Some forty roundings of eps, in units of the reach (angles) or of one
    // (lengths); the differences (long double, extrapolated) are good to
    // 1e-14.
    EXPECT_LT(error.cwiseAbs().maxCoeff(), 5e-14 * (1.0 + Reach(problem.arm)))
        << "rotation of " << length;
  }
}

TEST_P(ObservationCostTest, AgreesWithTheGeometricJacobian) {
  for (const double length : testing::RotationLengths()) {
    const Problem problem(num_joints(), length, with_frames(), 603);
    const Evaluation evaluation = problem.EvaluateCost();
    std::vector<int> columns(evaluation.jacobian.cols());
    std::iota(columns.begin(), columns.end(), 0);
    Linearization geometric;
    MeasurementModel(problem.arm)
        .Linearize(problem.values, problem.data, columns, &geometric);
    // Both are whitened: errors of rounding grow by 1 / sigma.
    const double largest_weight = 1.0 / problem.data.sigmas().map().minCoeff();
    const double scale = largest_weight * (1.0 + Reach(problem.arm));
    const Eigen::MatrixXd difference = evaluation.jacobian - geometric.jacobian;
    EXPECT_LT(difference.cwiseAbs().maxCoeff(), 5e-14 * scale)
        << "rotation of " << length;
    EXPECT_LT((evaluation.residuals - geometric.residuals).norm(),
              2e-14 * scale)
        << "rotation of " << length;
  }
}

TEST_P(ObservationCostTest, ResidualVanishesAtTheTruth) {
  Problem problem(num_joints(), 0.4, with_frames(), 604);
  testing::Edit(&problem.data.positions())->col(0) =
      testing::MatrixPosition(problem.arm, problem.values.cast<long double>(),
                              problem.data.joint_values.data())
          .cast<double>();
  const Eigen::Vector3d error = problem.EvaluateCost().residuals.cwiseProduct(
      problem.data.sigmas().col(0));
  // Rounding of the forward kinematics.
  EXPECT_LT(error.norm(), 1e-14 * Reach(problem.arm));
}

TEST_P(ObservationCostTest, ResidualIsPredictedMinusMeasuredOverSigma) {
  const Problem problem(num_joints(), 0.4, with_frames(), 605);
  const Eigen::Vector3d predicted =
      testing::MatrixPosition(problem.arm, problem.values.cast<long double>(),
                              problem.data.joint_values.data())
          .cast<double>();
  const Eigen::Vector3d error = problem.EvaluateCost().residuals.cwiseProduct(
      problem.data.sigmas().col(0));
  EXPECT_LT((error - (predicted - problem.data.positions().col(0))).norm(),
            1e-14 * (1.0 + Reach(problem.arm)));
}

TEST_P(ObservationCostTest, SigmaOfOneAxisScalesItsRowOnly) {
  Problem problem(num_joints(), 0.4, with_frames(), 606);
  Evaluation expected = problem.EvaluateCost();
  const int axis = 2;
  // A power of two, so that the scaled numbers agree to the bit.
  testing::Edit(&problem.data.sigmas()).at(axis, 0) *= 8.0;
  expected.residuals[axis] /= 8.0;
  expected.jacobian.row(axis) /= 8.0;
  const Evaluation scaled = problem.EvaluateCost();
  EXPECT_EQ(scaled.residuals, expected.residuals);
  EXPECT_EQ(scaled.jacobian, expected.jacobian);
}

TEST_P(ObservationCostTest, WithoutJacobiansTheResidualIsTheSame) {
  const Problem problem(num_joints(), 0.4, with_frames(), 607);
  const ObservationCost cost = problem.MakeCost();
  std::vector<const double*> parameters;
  for (const ParameterBlock& block : Blocks(problem.layout, with_frames())) {
    parameters.push_back(problem.values.data() + block.first_column);
  }
  Eigen::Vector3d residuals;
  ASSERT_TRUE(
      cost.function->Evaluate(parameters.data(), residuals.data(), nullptr));
  // The compiler may contract or reorder the two instantiations differently.
  const Eigen::Vector3d error = (residuals - problem.EvaluateCost().residuals)
                                    .cwiseProduct(problem.data.sigmas().col(0));
  EXPECT_LT(error.norm(), 1e-14 * (1.0 + Reach(problem.arm)));
}

// Static sizes up to seven joints, dynamic ones beyond and with frames.
INSTANTIATE_TEST_SUITE_P(JointsAndFrames, ObservationCostTest,
                         ::testing::Combine(::testing::Range(1, 10),
                                            ::testing::Bool()));

TEST(ObservationCostFixedTest, WithoutFramesTheArmsOwnBaseAndToolAreUsed) {
  const Problem without(5, 0.0, false, 608);
  const Problem with(5, 0.0, true, 608);
  // The rotation values are zero, so both describe the same arm.
  ASSERT_EQ(without.values, with.values);
  const Evaluation expected = with.EvaluateCost();
  const Evaluation actual = without.EvaluateCost();
  const double scale =
      (1.0 + Reach(with.arm)) / with.data.sigmas().map().minCoeff();
  EXPECT_LT((actual.residuals - expected.residuals).norm(), 1e-14 * scale);
  EXPECT_LT(
      (actual.jacobian - expected.jacobian.leftCols(actual.jacobian.cols()))
          .cwiseAbs()
          .maxCoeff(),
      2e-14 * scale);
}

}  // namespace
}  // namespace alidade::internal::observation_cost_test
