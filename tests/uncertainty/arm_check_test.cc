#include "src/uncertainty/arm_check.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "src/common/constants.h"
#include "src/common/distributions.h"
#include "src/common/random.h"
#include "src/model/joint_draw.h"
#include "tests/support/rv2aj_arms.h"

namespace alidade::internal {
namespace {

constexpr double kSigma = 1e-4;  // m
constexpr int kPoses = 8;
constexpr int kTrials = 200;

TEST(NoncentralFisherTest, OneDegreeOfFreedomIsAShiftedNormal) {
  for (const double x : {0.5, 4.0, 9.0}) {
    for (const double shift : {0.0, 0.3, 3.0, 40.0}) {
      const double exact =
          NormalCdf(shift - std::sqrt(x)) + NormalCdf(-shift - std::sqrt(x));
      EXPECT_NEAR(NoncentralFisherSurvival(x, 1.0, kInfinity, shift * shift),
                  exact, 1e-10);
    }
  }
}

TEST(NoncentralFisherTest, OfFewDegreesOfFreedomAsDraws) {
  Random random(31);
  constexpr int kDraws = 20000;
  int above = 0;
  for (int i = 0; i < kDraws; ++i) {
    double upper = 0.0;
    double lower = 0.0;
    for (int k = 0; k < 4; ++k) {
      upper += std::pow(random.Normal() + (k < 2 ? 1.5 : 0.0), 2.0);
    }
    for (int k = 0; k < 6; ++k) lower += std::pow(random.Normal(), 2.0);
    above += (upper / 4.0) / (lower / 6.0) > 2.5;
  }
  EXPECT_NEAR(NoncentralFisherSurvival(2.5, 4.0, 6.0, 4.5),
              static_cast<double>(above) / kDraws, 0.015);
}

// Checks of an arm whose calibration has left a few parameters unknown.
class ArmCheckTest : public ::testing::Test {
 protected:
  void SetUp() override {
    for (const char* name : {"theta1", "theta2", "theta3", "d3", "r1"}) {
      covariance_.columns.push_back(model_.layout().Find(name).value());
    }
    Eigen::VectorXd deviations(5);
    deviations << 3e-4, 2e-4, 4e-4, 2e-4, 1e-4;  // rad, m
    covariance_.root = deviations.asDiagonal();
    covariance_.null_space.resize(5, 0);
    options_.significance = 0.2;
  }

  // The real arm, drawn from what the calibration has left unknown.
  Eigen::VectorXd DrawArm() {
    Eigen::VectorXd values = model_.NominalValues();
    for (int k = 0; k < 5; ++k) {
      values[covariance_.columns[k]] +=
          covariance_.root(k, k) * random_.Normal();
    }
    return values;
  }

  Dataset Measure(const Eigen::VectorXd& values) {
    Eigen::Matrix3Xd points = model_.Predict(values, joint_values_);
    for (double& entry : points.reshaped()) entry += kSigma * random_.Normal();
    return MakePositions(joint_values_, points,
                         Eigen::Matrix3Xd::Constant(3, kPoses, kSigma));
  }

  ArmCheckResult Check(const Dataset& data) {
    return CheckArm(model_, model_, covariance_, data, options_);
  }

  // How many of kTrials checks fail where `change` is made to the real arm.
  template <typename Change>
  int Failures(const Change& change) {
    int failures = 0;
    for (int i = 0; i < kTrials; ++i) {
      Eigen::VectorXd values = DrawArm();
      change(&values);
      failures += Check(Measure(values)).passes ? 0 : 1;
    }
    return failures;
  }

  const MeasurementModel model_{testing::Rv2ajFlange()};
  const Eigen::MatrixXd joint_values_ =
      DrawJointValues(model_.nominal(), kPoses, 5);
  ParameterCovariance covariance_;
  ArmCheckOptions options_;
  Random random_{32};
};

// Three and a half standard deviations of the count.
void ExpectRate(int failures, double rate) {
  const double deviation = std::sqrt(rate * (1.0 - rate) * kTrials);
  EXPECT_NEAR(failures, rate * kTrials, 3.5 * deviation);
}

TEST_F(ArmCheckTest, AnArmAsCalibratedFailsAsOftenAsStated) {
  ExpectRate(Failures([](Eigen::VectorXd*) {}), 0.2);
}

TEST_F(ArmCheckTest, AChangedZeroIsFoundWithTheStatedProbability) {
  const int column = model_.layout().Column(ParameterKind::kTheta, 2);
  const double change = Check(Measure(model_.NominalValues())).found_zero[2];
  ExpectRate(
      Failures([&](Eigen::VectorXd* values) { (*values)[column] += change; }),
      0.9);
}

// Nothing of the arm is unknown: errors are what was measured beside it.
TEST_F(ArmCheckTest, ErrorsAreThoseOfThePositions) {
  covariance_.root.setZero();
  Eigen::Matrix3Xd off(3, kPoses);
  for (double& entry : off.reshaped()) entry = 3.0 * kSigma * random_.Normal();
  const Dataset data =
      MakePositions(joint_values_,
                    model_.Predict(model_.NominalValues(), joint_values_) + off,
                    Eigen::Matrix3Xd::Constant(3, kPoses, kSigma));
  Arm beside = model_.nominal();
  beside.instrument_from_base.translation().y() += 1e-3;
  const ArmCheckResult check =
      CheckArm(model_, MeasurementModel(beside), covariance_, data, options_);
  // Rounding of positions of a metre.
  EXPECT_NEAR(check.rms_error, off.norm() / std::sqrt(kPoses), 1e-14);
  EXPECT_NEAR(check.max_error, off.colwise().norm().maxCoeff(), 1e-14);
  EXPECT_NEAR(check.predicted_rms, std::sqrt(3.0) * kSigma, 1e-14);
  EXPECT_NEAR(check.uncalibrated_rms, 1e-3, 1e-14);
  // The same rounding over sigma, times twice the residuals.
  EXPECT_NEAR(check.statistic, off.squaredNorm() / (kSigma * kSigma), 1e-8);
}

// The target's rotation, which positions do not see, beside the base.
TEST_F(ArmCheckTest, WhatNothingSeesIsRefittedWithoutHarm) {
  const Dataset data = Measure(DrawArm());
  for (int axis = 0; axis < 3; ++axis) {
    options_.refitted.push_back(
        model_.layout().Column(ParameterKind::kBaseTranslation, axis));
  }
  const ArmCheckResult expected = Check(data);
  for (int axis = 0; axis < 3; ++axis) {
    options_.refitted.push_back(
        model_.layout().Column(ParameterKind::kToolRotation, axis));
  }
  const ArmCheckResult check = Check(data);
  EXPECT_EQ(check.degrees_of_freedom, 3.0 * kPoses - 3.0);
  EXPECT_EQ(check.degrees_of_freedom, expected.degrees_of_freedom);
  // The same space by another factorisation: rounding of 24 residuals.
  EXPECT_NEAR(check.statistic, expected.statistic, 1e-9);
}

// For any power, even one just above the significance (0.2): the size that is
// found has the noncentrality at which the test has that power.
TEST_F(ArmCheckTest, SizesThatAreFoundFollowFromThePower) {
  const Dataset data = Measure(model_.NominalValues());
  const ArmCheckResult usual = Check(data);
  ASSERT_EQ(usual.power, 0.9);
  const double dof = usual.degrees_of_freedom;
  const auto power_of = [&](double noncentrality) {
    return NoncentralFisherSurvival(usual.limit / dof, dof, kInfinity,
                                    noncentrality);
  };
  double lower = 0.0;
  double upper = 1e3;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (lower + upper);
    (power_of(middle) < 0.9 ? lower : upper) = middle;
  }
  for (const double power : {0.21, 0.5, 0.99}) {
    options_.power = power;
    const ArmCheckResult check = Check(data);
    const double zero = check.found_zero[1] / usual.found_zero[1];
    // Bisection ends at a millionth of the noncentrality.
    EXPECT_NEAR(power_of(upper * zero * zero), power, 1e-5);
    EXPECT_NEAR(check.found_move / usual.found_move, zero, 1e-9);
  }
  // A known arm and an instrument of sigma = 1 m: a move of 1 m, 1 / sqrt(3) m
  // along each axis, adds 1 to the noncentrality for each position.
  covariance_.root.setZero();
  options_.power = 0.9;
  const Dataset poor =
      MakePositions(joint_values_, data.positions(),
                    Eigen::Matrix3Xd::Constant(3, kPoses, 1.0));
  EXPECT_NEAR(Check(poor).found_move, std::sqrt(upper / kPoses), 1e-5);
}

TEST_F(ArmCheckTest, AMovedBaseIsNoFaultOnceItIsRefitted) {
  std::vector<int> base;
  for (int k = 0; k < 3; ++k) {
    base.push_back(model_.layout().Column(ParameterKind::kBaseTranslation, k));
  }
  const auto move = [&](Eigen::VectorXd* values) {
    for (const int column : base) (*values)[column] += 2e-3;
  };
  EXPECT_EQ(Failures(move), kTrials);
  options_.refitted = base;
  ExpectRate(Failures(move), 0.2);
  // Which costs three degrees of freedom, and what the base can take up.
  const ArmCheckResult check = Check(Measure(model_.NominalValues()));
  EXPECT_EQ(check.degrees_of_freedom, 3.0 * kPoses - 3.0);
  options_.refitted.push_back(
      model_.layout().Column(ParameterKind::kBaseRotation, 2));
  EXPECT_EQ(Check(Measure(model_.NominalValues())).found_zero[0], kInfinity);
}

TEST_F(ArmCheckTest, MovesOfEveryPoseAreFoundWithTheStatedProbability) {
  const double size = Check(Measure(model_.NominalValues())).found_move;
  int failures = 0;
  for (int i = 0; i < kTrials; ++i) {
    Eigen::Matrix3Xd points = model_.Predict(DrawArm(), joint_values_);
    for (double& entry : points.reshaped()) {
      entry += kSigma * random_.Normal();
    }
    for (int k = 0; k < kPoses; ++k) {
      points.col(k) +=
          size *
          Eigen::Vector3d(random_.Normal(), random_.Normal(), random_.Normal())
              .normalized();
    }
    failures +=
        Check(MakePositions(joint_values_, points,
                            Eigen::Matrix3Xd::Constant(3, kPoses, kSigma)))
                .passes
            ? 0
            : 1;
  }
  // Moves in other directions are found more or less easily.
  EXPECT_NEAR(failures, 0.9 * kTrials, 0.07 * kTrials);
}

}  // namespace
}  // namespace alidade::internal
