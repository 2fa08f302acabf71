// An arm with errors that its parameters do not describe, all the way through a
// calibration.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "alidade/calibration.h"
#include "src/common/random.h"
#include "src/model/joint_draw.h"
#include "tests/support/matrix_kinematics.h"
#include "tests/support/rv2aj_arms.h"

namespace alidade::internal::model_lack_test {
namespace {

constexpr double kSigma = 2e-5;  // m

struct Measured {
  Dataset data;
  Eigen::Matrix3Xd truth;
};

// Joint 2 is off by `size` times the second harmonic of its value (rad).
Measured Measure(double size, std::uint64_t seed) {
  const Arm real = testing::WithRv2ajDeviations(testing::Rv2ajFlange());
  const Eigen::MatrixXd joints = DrawJointValues(real, 60, seed);
  Measured measured{{}, Eigen::Matrix3Xd(3, joints.cols())};
  Eigen::Matrix3Xd noisy(3, joints.cols());
  Random random(seed, 5);
  for (Eigen::Index i = 0; i < joints.cols(); ++i) {
    Eigen::VectorXd moved = joints.col(i);
    moved[1] += size * std::sin(2.0 * moved[1] + 0.4);
    measured.truth.col(i) =
        testing::MatrixPosition(real, moved.data()).cast<double>();
    for (int axis = 0; axis < 3; ++axis) {
      noisy(axis, i) = measured.truth(axis, i) + kSigma * random.Normal();
    }
  }
  measured.data = MakePositions(joints, noisy, kSigma);
  return measured;
}

class ModelLackTest : public ::testing::TestWithParam<bool> {
 protected:
  CalibrationResult Run(double size) {
    validation_ = Measure(size, 2);
    CalibrationOptions options;
    options.estimate_sigma = GetParam();
    options.sigmas_are_stated = true;
    CalibrationData data(Measure(size, 1).data);
    data.validation = validation_.data;
    return Calibrate(testing::Rv2ajFlange(), data, options);
  }
  double TrueRms(const CalibrationResult& result) const {
    double sum = 0.0;
    for (int i = 0; i < 60; ++i) {
      const Eigen::VectorXd joints = validation_.data.joint_values.col(i);
      sum +=
          (testing::MatrixPosition(result.arm, joints.data()).cast<double>() -
           validation_.truth.col(i))
              .squaredNorm();
    }
    return std::sqrt(sum / 60.0);
  }

  Measured validation_;
};

TEST_P(ModelLackTest, PredictionsContainWhatTheModelLacks) {
  const CalibrationResult result = Run(4e-4);
  ASSERT_TRUE(result.IsUsable());
  const UncertaintyResult& uncertainty = *result.uncertainty;
  const PredictionParts& parts = uncertainty.validation->parts;
  const double predicted = std::hypot(parts.from_parameters, parts.from_model);
  const double truth = TrueRms(result);
  EXPECT_GT(truth, 2.0 * std::sqrt(3.0) * kSigma);
  EXPECT_GT(predicted, 0.8 * truth);
  EXPECT_LT(predicted, 1.25 * truth);
  EXPECT_NEAR(parts.from_measurement, std::sqrt(3.0) * kSigma, 0.1 * kSigma);
  EXPECT_GT(uncertainty.workspace->summary.median, 0.8 * truth);
  EXPECT_EQ(uncertainty.validation->verdict, "agree");
  // None is an outlier of predictions that contain it.
  EXPECT_EQ(result.validation_outliers.size(), 0u);
  EXPECT_EQ(uncertainty.validation->axes.n, 180);
  const auto warns_of = [&](const std::string& words) {
    return std::any_of(result.warnings.begin(), result.warnings.end(),
                       [&](const std::string& warning) {
                         return warning.find(words) != std::string::npos;
                       });
  };
  EXPECT_TRUE(warns_of("depend on the value of joint 2"));
  EXPECT_TRUE(warns_of("times the stated sigma"));
}

TEST_P(ModelLackTest, NothingIsSaidWhereNothingLacks) {
  const CalibrationResult result = Run(0.0);
  EXPECT_TRUE(result.warnings.empty()) << result.warnings.front();
  EXPECT_EQ(result.uncertainty->lack_of_fit.excess_variance, 0.0);
  EXPECT_EQ(result.uncertainty->prediction_covariance.size(), 0);
}

INSTANTIATE_TEST_SUITE_P(Sigmas, ModelLackTest, ::testing::Bool());

}  // namespace
}  // namespace alidade::internal::model_lack_test
