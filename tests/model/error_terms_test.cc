#include "alidade/error_terms.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <limits>

#include "alidade/forward_kinematics.h"
#include "alidade/units.h"
#include "src/common/random.h"
#include "src/model/chain_axes.h"
#include "tests/support/matrix_kinematics.h"
#include "tests/support/random_arms.h"
#include "tests/support/random_errors.h"

namespace alidade::internal {
namespace {

constexpr int kArmsPerSize = 10;
constexpr int kPosesPerArm = 5;

// As without error terms; moments are sums of up to thirteen loads, which the
// compliances turn into angles.
constexpr double kTolerance = 3e-14;

class FlexibleArmTest : public ::testing::TestWithParam<int> {
 protected:
  // The first arms have no moments of a geometry of their own, and no loads
  // but those of one kilogram.
  Arm MakeArm(int number) {
    testing::RandomArmOptions options;
    options.num_targets = 2;
    Arm arm = testing::RandomArm(GetParam(), &random_, options);
    arm.errors = testing::RandomErrors(arm, &random_);
    if (number < 3) arm.errors.load_geometry.resize(0, 0);
    if (number % 3 == 0) arm.errors.links.clear();
    if (number % 4 == 1) arm.errors.coupling.resize(0, 0);
    if (number % 5 == 4) arm.errors.joints.clear();
    return arm;
  }

  Random random_ = Random(120, GetParam());
};

TEST_P(FlexibleArmTest, FramesAreThoseOfTheMatrixProducts) {
  for (int number = 0; number < kArmsPerSize; ++number) {
    const Arm arm = MakeArm(number);
    const Eigen::MatrixXd poses =
        testing::RandomJointValues(arm, kPosesPerArm, &random_);
    const testing::VectorXl values = testing::MatrixValues(arm);
    for (const auto& q : poses.colwise()) {
      for (const int target : {0, 1}) {
        const Eigen::Matrix4d expected =
            testing::MatrixTargetFrame(arm, values, q.data(), target)
                .cast<double>();
        const Eigen::Matrix4d error =
            TargetPose(arm, q, target).matrix() - expected;
        EXPECT_LT(error.cwiseAbs().maxCoeff(), kTolerance * (1.0 + Reach(arm)));
      }
    }
  }
}

TEST_P(FlexibleArmTest, MomentsAreSumsOverAllLoads) {
  for (int number = 0; number < kArmsPerSize; ++number) {
    const Arm arm = MakeArm(number);
    const Eigen::MatrixXd pose = testing::RandomJointValues(arm, 1, &random_);
    const Eigen::Matrix3Xd moments = LoadMoments(arm, pose.data());
    const testing::RigidFrames frames =
        testing::RigidFramesOf(arm, pose.data());
    for (int j = 0; j < arm.num_joints(); ++j) {
      const Eigen::Vector3d expected =
          testing::MatrixMoment(arm, frames, j).cast<double>();
      // Thirteen loads of up to 3 kg, some reaches away.
      EXPECT_LT((moments.col(j) - expected).norm(), 1e-12 * (1.0 + Reach(arm)))
          << "joint " << j + 1;
    }
  }
}

TEST_P(FlexibleArmTest, ChainAxesAreOfTheBentArm) {
  const Arm arm = MakeArm(8);
  const Eigen::MatrixXd pose = testing::RandomJointValues(arm, 1, &random_);
  ChainAxes axes;
  ComputeChainAxes(arm, pose.data(), &axes);
  const Eigen::Matrix4d error =
      axes.instrument_from_target.matrix() -
      testing::MatrixTargetFrame(arm, pose.data()).cast<double>();
  EXPECT_LT(error.cwiseAbs().maxCoeff(), kTolerance * (1.0 + Reach(arm)));
  const testing::Matrix3Xl jacobian =
      testing::MatrixJacobian(arm, testing::MatrixValues(arm), pose.data());
  const ParameterLayout layout(arm);
  for (int j = 0; j < arm.num_joints(); ++j) {
    const Eigen::Vector3d lever =
        axes.instrument_from_target.translation() - axes.origin_on_axis.col(j);
    const int theta = layout.Column(ParameterKind::kTheta, j);
    const Eigen::Vector3d turn = axes.joint_axis.col(j).cross(lever);
    EXPECT_LT((turn - jacobian.col(theta).cast<double>()).norm(),
              5e-14 * (1.0 + Reach(arm)));
  }
}

INSTANTIATE_TEST_SUITE_P(Joints, FlexibleArmTest, ::testing::Range(1, 9));

// A joint about y at the origin and a bar of 2 m along x, whose joint frame has
// z along y: alpha = -90 deg takes z to y.
Arm Bar() {
  Arm arm;
  arm.joints.resize(1);
  arm.joints[0].alpha = -kPi / 2.0;
  arm.last_from_target().translation() = Eigen::Vector3d(2.0, 0.0, 0.0);
  arm.errors.joints.resize(1);
  return arm;
}

TEST(ErrorTermsTest, BarSagsAsWorkedOutByHand) {
  // 1 kg at 2 m: 19.6133 N m about +y, which turns x towards -z. The 1 kg at
  // the joint's own frame has no lever.
  Arm arm = Bar();
  arm.errors.joints[0].compliance.z() = 1e-4;
  const double q = 0.0;
  EXPECT_NEAR(LoadMoments(arm, &q)(2, 0), 19.6133, 1e-12);
  const Eigen::Isometry3d pose = TargetPose(arm, Eigen::VectorXd::Zero(1));
  EXPECT_NEAR(pose.translation().z(), -2.0 * std::sin(1.96133e-3), 1e-12);
  // Upside down it hangs the other way, and a payload of 2 kg doubles it.
  arm.errors.gravity = Eigen::Vector3d::UnitZ();
  arm.errors.payload.mass = 2.0;
  EXPECT_NEAR(TargetPose(arm, Eigen::VectorXd::Zero(1)).translation().z(),
              2.0 * std::sin(3.92266e-3), 1e-12);
}

TEST(ErrorTermsTest, FunctionIsLinearBetweenKnotsAndZeroOneSpacingBeyond) {
  JointFunction function;
  function.first = -1.0;
  function.spacing = 0.5;
  function.values = Eigen::Vector3d(2.0, 4.0, -1.0);
  function.deviations = Eigen::Vector3d(1.0, 0.5, 3.0);
  EXPECT_DOUBLE_EQ(function.last(), 0.0);
  EXPECT_DOUBLE_EQ(function.At(-1.0), 2.0);
  EXPECT_DOUBLE_EQ(function.At(-0.75), 3.0);
  EXPECT_DOUBLE_EQ(function.At(0.0), -1.0);
  EXPECT_DOUBLE_EQ(function.At(0.25), -0.5);
  EXPECT_DOUBLE_EQ(function.At(-1.25), 1.0);
  EXPECT_DOUBLE_EQ(function.DeviationAt(-0.25), 1.75);
  for (const double q : {0.5, 0.7, -1.5, -3.0, 1e300, -1e300}) {
    EXPECT_EQ(function.At(q), 0.0) << q;
  }
  EXPECT_EQ(JointFunction().At(0.3), 0.0);
  EXPECT_EQ(JointFunction().DeviationAt(0.3), 0.0);
}

TEST(ErrorTermsTest, FunctionOfOneKnotIsARoof) {
  JointFunction function;
  function.spacing = 0.5;
  function.values = Eigen::VectorXd::Constant(1, 1.0);
  function.deviations = Eigen::VectorXd::Constant(1, 4.0);
  EXPECT_DOUBLE_EQ(function.At(0.0), 1.0);
  EXPECT_DOUBLE_EQ(function.At(0.125), 0.75);
  EXPECT_DOUBLE_EQ(function.At(-0.25), 0.5);
  EXPECT_DOUBLE_EQ(function.DeviationAt(0.125), 3.0);
}

TEST(ErrorTermsTest, PeriodicFunctionIsOfTheValueModuloATurn) {
  JointFunction function;
  function.first = 0.25;
  function.spacing = 0.5 * kPi;
  function.values = Eigen::Vector4d(1.0, 3.0, -1.0, 5.0);
  function.is_periodic = true;
  for (const double turn : {-4.0 * kPi, 0.0, 2.0 * kPi}) {
    EXPECT_NEAR(function.At(turn + 0.25), 1.0, 1e-14);
    EXPECT_NEAR(function.At(turn + 0.25 + 0.75 * kPi), 1.0, 1e-14);
    // Between the last knot and the first.
    EXPECT_NEAR(function.At(turn + 0.25 - 0.125 * kPi), 2.0, 1e-14);
    EXPECT_NEAR(function.At(turn + 0.25 + 1.75 * kPi), 3.0, 1e-14);
  }
  EXPECT_NEAR(function.At(std::nextafter(0.25, 0.0)), 1.0, 1e-14);
}

TEST(ErrorTermsTest, CovariateChangesThePayloadAndMovesTheTarget) {
  Arm arm = Bar();
  arm.errors.joints[0].compliance.z() = 1e-4;
  CovariateEffect effect;
  effect.reference = 1.0;
  effect.payload = 0.5;
  effect.target << 0.0, 0.01, 0.02, 0.0, 0.0, 0.1;
  arm.errors.covariates = {effect};
  const double q = 0.0;
  const double covariate = 5.0;
  // 1 kg and 2 kg more.
  EXPECT_NEAR(LoadMoments(arm, &q, &covariate)(2, 0), 3.0 * 19.6133, 1e-12);
  EXPECT_NEAR(LoadMoments(arm, &q)(2, 0), 19.6133, 1e-12);
  const PoseErrors errors = ErrorsAt(arm, &q, &covariate);
  EXPECT_NEAR(errors.shifts[0], 3.0 * 1.96133e-3, 1e-15);
  EXPECT_NEAR(errors.target[1], 0.04, 1e-15);
  EXPECT_NEAR(errors.target[5], 0.4, 1e-15);
}

TEST(ErrorTermsTest, BacklashHasTheSignOfTheMoment) {
  EXPECT_NEAR(SmoothSign(100.0), 1.0, 2e-5);
  EXPECT_NEAR(SmoothSign(-100.0), -1.0, 2e-5);
  EXPECT_EQ(SmoothSign(0.0), 0.0);
  EXPECT_DOUBLE_EQ(SmoothSign(kBacklashMoment), std::sqrt(0.5));
  Arm arm = Bar();
  arm.errors.joints[0].backlash = 1e-3;
  const double q = 0.0;
  EXPECT_NEAR(ErrorsAt(arm, &q).shifts[0], 1e-3 * SmoothSign(19.6133), 1e-15);
}

TEST(ErrorTermsTest, PrismaticJointSlidesAlongItsTiltedAxis) {
  Arm arm;
  arm.joints.resize(1);
  arm.joints[0].type = JointType::kPrismatic;
  arm.joints[0].r = 1.0;
  arm.errors.joints.resize(1);
  arm.errors.joints[0].compliance = Eigen::Vector3d(0.01, 0.0, 5.0);
  arm.errors.joints[0].harmonics = {{1.0, 0.25, 0.0}};
  arm.errors.payload.centre.y() = 1.0;
  // 2 kg about a point on the axis, that at the target 1 m along y beside it:
  // the moment about x is that of 1 kg at 1 m.
  const double q = 0.0;
  const PoseErrors errors = ErrorsAt(arm, &q);
  EXPECT_NEAR(errors.tilts(0, 0), -0.01 * kStandardGravity, 1e-15);
  EXPECT_DOUBLE_EQ(errors.shifts[0], 0.25);
  const Eigen::Vector3d tip =
      TargetPose(arm, Eigen::VectorXd::Zero(1)).translation();
  const double angle = 2.0 * std::atan(0.5 * errors.tilts(0, 0));
  EXPECT_NEAR(tip.y(), -1.25 * std::sin(angle), 1e-14);
  EXPECT_NEAR(tip.z(), 1.25 * std::cos(angle), 1e-14);
}

TEST(ErrorTermsTest, NoTermsChangeNothing) {
  Random random(121);
  Arm arm = testing::RandomArm(6, &random);
  const Eigen::VectorXd q = testing::RandomJointValues(arm, 1, &random);
  const Eigen::Matrix4d rigid = TargetPose(arm, q).matrix();
  arm.errors.links.resize(6);
  arm.errors.payload.mass = 7.0;
  EXPECT_TRUE(arm.errors.empty());
  EXPECT_EQ(TargetPose(arm, q).matrix(), rigid);
  arm.errors.joints.resize(6);
  EXPECT_EQ(TargetPose(arm, q).matrix(), rigid);
}

}  // namespace
}  // namespace alidade::internal
