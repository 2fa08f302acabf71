#include "alidade/batched_kinematics.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <limits>

#include "src/common/random.h"
#include "tests/support/matrix_kinematics.h"
#include "tests/support/random_arms.h"
#include "tests/support/random_errors.h"

namespace alidade::internal {
namespace {

using testing::Matrix4l;
using testing::MatrixValues;
using testing::Vector3l;
using testing::VectorXl;
using Transform =
    Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>;

// Arms of three to eight joints with three targets, and joint values.
class BatchedKinematicsTest : public ::testing::Test {
 protected:
  static Arm MakeArm(int joints, bool with_errors) {
    Random random(static_cast<std::uint64_t>(joints));
    testing::RandomArmOptions options;
    options.num_targets = 3;
    Arm arm = testing::RandomArm(joints, &random, options);
    if (with_errors) arm.errors = testing::RandomErrors(arm, &random);
    return arm;
  }

  static Eigen::MatrixXd Draw(const Arm& arm, int count) {
    Random random(99);
    Eigen::MatrixXd joints(arm.num_joints(), count);
    for (int i = 0; i < count; ++i) {
      for (int j = 0; j < arm.num_joints(); ++j) {
        joints(j, i) = random.Uniform(arm.joints[j].lower, arm.joints[j].upper);
      }
    }
    return joints;
  }
};

// Products of 4 x 4 matrices in extended precision; some hundred roundings of
// lengths of a few metres, and more of the moments behind elastic joints.
TEST_F(BatchedKinematicsTest, PosesAreProductsOfMatrices) {
  for (const bool with_errors : {false, true}) {
    for (int joints = 3; joints <= 8; ++joints) {
      const Arm arm = MakeArm(joints, with_errors);
      const Eigen::MatrixXd values = Draw(arm, 7);
      const double tolerance = with_errors ? 2e-13 : 2e-14;
      for (int target = 0; target < 3; ++target) {
        const Eigen::MatrixXd poses = BatchedTransforms(arm, values, target);
        const Eigen::Matrix3Xd points = BatchedPositions(arm, values, target);
        ASSERT_EQ(poses.rows(), 16);
        for (int i = 0; i < 7; ++i) {
          const Eigen::Matrix4d expected =
              testing::MatrixTargetFrame(arm, MatrixValues(arm),
                                         values.col(i).data(), target)
                  .cast<double>();
          const Transform pose(poses.col(i).data());
          EXPECT_LT((pose - expected).cwiseAbs().maxCoeff(), tolerance)
              << joints << " joints, errors " << with_errors;
          EXPECT_EQ(pose.row(3), Eigen::RowVector4d(0, 0, 0, 1));
          EXPECT_LT((points.col(i) - expected.topRightCorner<3, 1>())
                        .cwiseAbs()
                        .maxCoeff(),
                    tolerance);
        }
      }
    }
  }
}

// What leads from one pose to a near one, per unit of a step: central
// differences in extended precision, of second order in it.
Eigen::Matrix<double, 6, 1> Difference(const Matrix4l& below,
                                       const Matrix4l& above,
                                       long double step) {
  const testing::Matrix3l turn =
      above.topLeftCorner<3, 3>() * below.topLeftCorner<3, 3>().transpose();
  Eigen::Matrix<long double, 6, 1> twist;
  twist << (above - below).topRightCorner<3, 1>(),
      0.5L * (turn(2, 1) - turn(1, 2)), 0.5L * (turn(0, 2) - turn(2, 0)),
      0.5L * (turn(1, 0) - turn(0, 1));
  return (twist / (2 * step)).cast<double>();
}

constexpr double kStep = 0x1p-20;  // 1e-6, exact when added to joint values
constexpr double kDifference = 1e-9;

TEST_F(BatchedKinematicsTest, JointJacobiansAreDifferencesOfPoses) {
  for (int joints = 3; joints <= 8; ++joints) {
    const Arm arm = MakeArm(joints, false);
    const Eigen::MatrixXd values = Draw(arm, 3);
    for (int target = 0; target < 3; ++target) {
      const Eigen::MatrixXd jacobians =
          BatchedJointJacobians(arm, values, target);
      ASSERT_EQ(jacobians.rows(), 6 * joints);
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < joints; ++j) {
          const auto pose = [&](double step) {
            Eigen::VectorXd q = values.col(i);
            q[j] += step;
            return testing::MatrixTargetFrame(arm, MatrixValues(arm), q.data(),
                                              target);
          };
          const Eigen::Matrix<double, 6, 1> expected =
              Difference(pose(-kStep), pose(kStep), kStep);
          EXPECT_LT((jacobians.block<6, 1>(6 * j, i) - expected)
                        .cwiseAbs()
                        .maxCoeff(),
                    kDifference)
              << joints << " joints, joint " << j << ", target " << target;
        }
      }
    }
  }
}

TEST_F(BatchedKinematicsTest, ParameterJacobiansAreDifferencesOfArms) {
  for (const int joints : {3, 6}) {
    const Arm arm = MakeArm(joints, false);
    const ParameterLayout layout(arm);
    const Eigen::MatrixXd values = Draw(arm, 2);
    for (int target = 0; target < 3; ++target) {
      const Eigen::MatrixXd jacobians =
          BatchedParameterJacobians(arm, values, target);
      ASSERT_EQ(jacobians.rows(), 6 * layout.size());
      for (int i = 0; i < 2; ++i) {
        for (int c = 0; c < layout.size(); ++c) {
          const auto pose = [&](long double step) {
            VectorXl parameters = MatrixValues(arm);
            parameters[c] += step;
            return testing::MatrixTargetFrame(arm, parameters,
                                              values.col(i).data(), target);
          };
          const Eigen::Matrix<double, 6, 1> expected =
              Difference(pose(-kStep), pose(kStep), kStep);
          EXPECT_LT((jacobians.block<6, 1>(6 * c, i) - expected)
                        .cwiseAbs()
                        .maxCoeff(),
                    kDifference)
              << "parameter " << c << ", target " << target;
        }
      }
    }
  }
}

TEST_F(BatchedKinematicsTest, ThreadsAndLayoutsDoNotChangeBits) {
  for (const bool with_errors : {false, true}) {
    const Arm arm = MakeArm(6, with_errors);
    const Eigen::MatrixXd values = Draw(arm, 1111);
    // Rows 1 to 6 of a larger matrix.
    Eigen::MatrixXd wide = Eigen::MatrixXd::Constant(9, 1111, 7.0);
    wide.middleRows(1, 6) = values;
    for (const int threads : {1, 2, 5}) {
      EXPECT_EQ(BatchedPositions(arm, wide.middleRows(1, 6), 1, threads),
                BatchedPositions(arm, values, 1));
      EXPECT_EQ(BatchedTransforms(arm, wide.middleRows(1, 6), 1, threads),
                BatchedTransforms(arm, values, 1));
      EXPECT_EQ(BatchedJointJacobians(arm, wide.middleRows(1, 6), 1, threads),
                BatchedJointJacobians(arm, values, 1));
      EXPECT_EQ(
          BatchedParameterJacobians(arm, wide.middleRows(1, 6), 1, threads),
          BatchedParameterJacobians(arm, values, 1));
    }
  }
}

TEST_F(BatchedKinematicsTest, NoConfigurationsAndThoseThatAreNotFinite) {
  const Arm arm = MakeArm(6, false);
  const Eigen::MatrixXd none(6, 0);
  EXPECT_EQ(BatchedPositions(arm, none).cols(), 0);
  EXPECT_EQ(BatchedTransforms(arm, none, 2, 4).cols(), 0);
  EXPECT_EQ(BatchedJointJacobians(arm, none).cols(), 0);
  EXPECT_EQ(BatchedParameterJacobians(arm, none).cols(), 0);
  // Of one configuration nothing passes to the next.
  Eigen::MatrixXd values = Draw(arm, 3);
  const Eigen::MatrixXd whole = BatchedTransforms(arm, values);
  values(2, 1) = std::numeric_limits<double>::quiet_NaN();
  const Eigen::MatrixXd poses = BatchedTransforms(arm, values);
  EXPECT_EQ(poses.col(0), whole.col(0));
  EXPECT_EQ(poses.col(2), whole.col(2));
  EXPECT_FALSE(poses.col(1).allFinite());
}

}  // namespace
}  // namespace alidade::internal
