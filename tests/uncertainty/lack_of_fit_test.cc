#include "src/uncertainty/lack_of_fit.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "alidade/rotation.h"
#include "src/common/random.h"
#include "src/model/joint_draw.h"
#include "src/uncertainty/looks.h"
#include "tests/support/matrix_kinematics.h"
#include "tests/support/noisy_positions.h"
#include "tests/uncertainty/fitted_arm.h"

namespace alidade::internal::lack_of_fit_test {
namespace {

using testing::Bent;
using testing::Fitted;
using testing::kSigma;
using testing::OffBy;
using testing::RealArm;
using testing::Rigid;

const StatedNoise kGiven = std::array<double, 2>{1.0, 1.0};

TEST(LackOfFitTest, CleanDataLackNothing) {
  const Fitted fitted(60, 1, 5, Rigid);
  const LackAssessment found = fitted.Assess(kGiven);
  EXPECT_EQ(found.lack.source, NoiseSource::kStated);
  EXPECT_GT(found.lack.p_value, 0.05);
  EXPECT_EQ(found.lack.excess_variance, 0.0);
  EXPECT_FALSE(found.differs);
  EXPECT_TRUE(found.warnings.empty());
  EXPECT_NEAR(found.lack.residual, kSigma, 0.15 * kSigma);
  // Two estimates of the same: that of 60 configurations is good to 20 %.
  const Eigen::VectorXd usual = CovarianceOf(fitted.problem()).Deviations();
  EXPECT_NEAR((found.robust_std.array() / usual.array()).mean(), 1.0, 0.15);
}

// Repeats know the noise, whatever is stated, and count as one look.
TEST(LackOfFitTest, RepeatsTellNoiseFromWhatTheModelLacks) {
  constexpr double kOff = 0.05e-3;
  for (const StatedNoise& stated : {kGiven, StatedNoise()}) {
    const Fitted fitted(80, 3, 6, OffBy(kOff, 9));
    const LackAssessment found = fitted.Assess(stated);
    EXPECT_EQ(found.lack.source, NoiseSource::kRepeats);
    EXPECT_EQ(found.lack.looks, 80);
    EXPECT_NEAR(found.lack.noise, kSigma, 0.1 * kSigma);
    EXPECT_NEAR(std::sqrt(found.lack.excess_variance / 3.0), kOff, 0.1 * kOff);
    EXPECT_LT(found.lack.p_value, 1e-12);
    // Welch and Satterthwaite, of means of three measurements.
    const double of_noise = std::pow(found.lack.noise, 2) / 3.0;
    const double beyond =
        std::pow(found.lack.residual, 2) - std::pow(found.lack.noise, 2);
    EXPECT_NEAR(
        found.lack.excess_degrees_of_freedom,
        beyond * beyond /
            (std::pow(beyond + of_noise, 2) / found.lack.degrees_of_freedom +
             of_noise * of_noise / (3.0 * 80 * 2)),
        1e-6);
    ASSERT_FALSE(found.warnings.empty());
    EXPECT_NE(found.warnings[0].find("times the repeatability"),
              std::string::npos);
    EXPECT_NE(found.warnings[0].find("Predictions contain them ("),
              std::string::npos);
  }
}

// The model lacks nothing and measurements scatter five times as much as their
// sigma says: so do estimates.
TEST(LackOfFitTest, RepeatsThatContradictTheSigmaWidenPredictions) {
  const Fitted fitted(60, 3, 5, Rigid, 5.0 * kSigma);
  const LackAssessment found = fitted.Assess(kGiven);
  EXPECT_EQ(found.lack.source, NoiseSource::kRepeats);
  ASSERT_EQ(found.lack.excess_variance, 0.0);
  EXPECT_TRUE(found.differs);
  const double ratio = found.lack.noise / kSigma;
  EXPECT_NEAR(ratio, 5.0, 0.5);
  const Eigen::VectorXd usual = CovarianceOf(fitted.problem()).Deviations();
  EXPECT_LT((found.prediction.Deviations() - ratio * usual)
                .cwiseQuotient(ratio * usual)
                .cwiseAbs()
                .maxCoeff(),
            1e-6);
  EXPECT_FALSE(Fitted(60, 3, 5, Rigid).Assess(kGiven).differs);
}

// By its definition, densely: what noise and the errors of poses do to the
// estimate.
TEST(LackOfFitTest, PredictionsTakeErrorsOfPosesOnce) {
  const Fitted fitted(50, 2, 6, OffBy(0.05e-3, 9));
  const LackAssessment found = fitted.Assess(kGiven);
  ASSERT_TRUE(found.differs);
  const Eigen::MatrixXd jacobian = fitted.Rows().jacobian;
  const Eigen::MatrixXd estimator =
      (jacobian.transpose() * jacobian).inverse() * jacobian.transpose();
  const double noise = found.lack.noise / kSigma;
  const double excess = std::sqrt(found.lack.excess_variance / 3.0) / kSigma;
  Eigen::MatrixXd errors = noise * noise * Eigen::MatrixXd::Identity(300, 300);
  for (int i = 0; i < 100; ++i) {
    for (int k = 0; k < 100; ++k) {
      if (i / 2 != k / 2) continue;
      errors.block(3 * i, 3 * k, 3, 3) +=
          excess * excess * Eigen::Matrix3d::Identity();
    }
  }
  const Eigen::MatrixXd expected = estimator * errors * estimator.transpose();
  const Eigen::VectorXd deviations = found.prediction.Deviations();
  for (Eigen::Index k = 0; k < expected.rows(); ++k) {
    const double std = std::sqrt(expected(k, k));
    EXPECT_NEAR(deviations[k], std, 1e-5 * std);
    // Usual ones take repeats for looks, and know of noise alone.
    EXPECT_GT(found.robust_std[k],
              1.5 * CovarianceOf(fitted.problem()).Deviations()[k]);
  }
  EXPECT_NEAR(
      (found.robust_std.array() / expected.diagonal().array().sqrt()).mean(),
      1.0, 0.2);
}

// The same with priors as wide as the standard deviations from the data alone:
// C F C. Normal equations in doubles, of a condition of some thousands, leave
// 1e-5.
TEST(LackOfFitTest, PriorsAreInThePredictionsCovariance) {
  const Fitted fitted(50, 1, 6, OffBy(0.1e-3, 9));
  const FittedProblem at = fitted.problem();
  Eigen::VectorXd priors =
      Eigen::VectorXd::Constant(at.values.size(), HUGE_VAL);
  const Eigen::VectorXd usual = CovarianceOf(at).Deviations();
  for (std::size_t k = 0; k < at.free_columns.size(); ++k) {
    priors[at.free_columns[k]] = usual[static_cast<Eigen::Index>(k)];
  }
  const FittedProblem problem{at.model, at.data,   at.free_columns,
                              priors,   at.losses, at.values};
  const LackAssessment found =
      AssessLackOfFit(problem, CovarianceOf(problem), kGiven);
  ASSERT_TRUE(found.differs);
  const Eigen::MatrixXd jacobian = fitted.Rows().jacobian;
  const Eigen::MatrixXd information = jacobian.transpose() * jacobian;
  const Eigen::MatrixXd of_priors =
      usual.cwiseAbs2().cwiseInverse().asDiagonal();
  const Eigen::MatrixXd inverse = (information + of_priors).inverse();
  const double variance =
      1.0 + found.lack.excess_variance / (3.0 * kSigma * kSigma);
  const Eigen::MatrixXd expected =
      inverse * (variance * information + of_priors) * inverse;
  const Eigen::VectorXd deviations = found.prediction.Deviations();
  for (Eigen::Index k = 0; k < expected.rows(); ++k) {
    const double std = std::sqrt(expected(k, k));
    EXPECT_NEAR(deviations[k], std, 1e-5 * std);
  }
}

// What is alike at neighbouring configurations does not average out as errors
// of each do, by which the usual deviations and those of predictions go.
TEST(LackOfFitTest, RobustDeviationsAreThoseOfBlocks) {
  const auto mean_ratio = [](const RealArm& real) {
    const LackAssessment found = Fitted(300, 1, 8, real).Assess(kGiven);
    return (found.robust_std.array() / found.prediction.Deviations().array())
        .mean();
  };
  EXPECT_NEAR(mean_ratio(Rigid), 1.05, 0.15);
  EXPECT_NEAR(mean_ratio(OffBy(0.05e-3, 9)), 1.05, 0.15);
  EXPECT_GT(mean_ratio(Bent), 1.3);
}

// A loss that is tuned to sigma leaves of the noise what the excess does not
// take, where that is more than repeats show.
TEST(LackOfFitTest, RobustFitsLeaveTheRestOfSigmaToTheNoise) {
  const Fitted fitted(80, 3, 6, OffBy(0.5 * kSigma, 9), 0.5 * kSigma);
  const FittedProblem at = fitted.problem();
  const std::vector<RobustLoss> losses = TunedLosses(LossKind::kHuber);
  const FittedProblem problem{at.model,  at.data, at.free_columns,
                              at.priors, losses,  at.values};
  const LackAssessment found =
      AssessLackOfFit(problem, CovarianceOf(problem), kGiven);
  EXPECT_EQ(found.lack.source, NoiseSource::kRepeats);
  const ModelExcess& excess = found.prediction.excess;
  const double part = excess.length / (kSigma * kSigma);
  // (0.5 sigma)^2; the variance of 80 means, 0.33, is known to a tenth: 0.08 is
  // 2.5 standard errors.
  EXPECT_NEAR(part, 0.25, 0.08);
  EXPECT_NEAR(excess.noise_ratio[kLengths], 1.0 - part, 1e-9);
}

// Without anything stated, what is left beside the structure is the noise.
TEST(LackOfFitTest, StructureIsNamedAndTakenForTheExcess) {
  const LackAssessment found = Fitted(60, 1, 8, Bent).Assess(StatedNoise());
  EXPECT_EQ(found.lack.source, NoiseSource::kStructure);
  ASSERT_FALSE(found.lack.structure.empty());
  EXPECT_TRUE(found.lack.structure[0].is_found);
  EXPECT_EQ(found.lack.structure[0].kind, StructureKind::kGravityMoment);
  EXPECT_EQ(found.lack.structure[0].joint, 2);
  EXPECT_NEAR(found.lack.noise, kSigma, 0.15 * kSigma);
  ASSERT_FALSE(found.warnings.empty());
  EXPECT_NE(found.warnings[0].find("the gravity moment of joint 2"),
            std::string::npos);
}

// Each pose twice, without any spread: what is left is of the mean of two.
TEST(LackOfFitTest, StructureOfMeansLeavesTheNoiseOfOneMeasurement) {
  const RealArm noisy = [](const Eigen::VectorXd& joints, int row) {
    return Eigen::Vector3d(OffBy(kSigma, 9)(joints, row) - Rigid(joints, row) +
                           Bent(joints, row));
  };
  const LackAssessment one = Fitted(60, 1, 8, noisy, 0.0).Assess(StatedNoise());
  const LackAssessment two = Fitted(60, 2, 8, noisy, 0.0).Assess(StatedNoise());
  EXPECT_EQ(one.lack.source, NoiseSource::kStructure);
  EXPECT_EQ(two.lack.source, NoiseSource::kStructure);
  EXPECT_EQ(two.lack.looks, 60);
  EXPECT_NEAR(two.lack.noise / one.lack.noise, std::sqrt(2.0), 1e-6);
}

// Orientations that are off by five times their sigma, positions by one.
TEST(LackOfFitTest, OrientationsHaveAnExcessOfTheirOwn) {
  constexpr double kAngle = 1e-4;
  const MeasurementModel model(testing::Rv2ajFlange());
  const Eigen::MatrixXd joints = DrawJointValues(model.nominal(), 60, 4);
  const testing::VectorXl exact = testing::MatrixValues(model.nominal());
  Random random(12);
  Dataset data = MakePositions(joints, Eigen::Matrix3Xd::Zero(3, 60), kSigma);
  Eigen::MatrixXd measured(6, 60);
  Eigen::MatrixXd sigmas(6, 60);
  for (int i = 0; i < 60; ++i) {
    const Eigen::Matrix4d frame =
        testing::MatrixTargetFrame(model.nominal(), exact, joints.col(i).data())
            .cast<double>();
    Eigen::Vector3d turn;
    for (double& x : turn) x = 5.0 * kAngle * random.Normal();
    for (int axis = 0; axis < 3; ++axis) {
      measured(axis, i) = frame(axis, 3) + kSigma * random.Normal();
    }
    measured.col(i).tail<3>() = VectorFromRotation(Eigen::Matrix3d(
        RotationFromVector<double>(turn) * frame.topLeftCorner<3, 3>()));
    sigmas.col(i) << kSigma, kSigma, kSigma, kAngle, kAngle, kAngle;
  }
  data.blocks[0].kind = MeasurementKind::kPose;
  data.blocks[0].measured = measured;
  data.blocks[0].sigmas = sigmas;
  const std::vector<int> columns = testing::FlangeFreeColumns(model.layout());
  const Eigen::VectorXd no_priors;
  const std::vector<RobustLoss> losses;
  const Eigen::VectorXd values = model.NominalValues();
  const FittedProblem problem{model, data, columns, no_priors, losses, values};
  const LackAssessment found =
      AssessLackOfFit(problem, CovarianceOf(problem), kGiven);
  EXPECT_EQ(found.lack.excess_variance, 0.0);
  // 24 of 25 variances of each component; 180 of them are good to a tenth.
  const double expected = 3.0 * 24.0 * kAngle * kAngle;
  EXPECT_NEAR(found.lack.rotation_excess_variance, expected, 0.35 * expected);
  EXPECT_FALSE(found.lack.structure.empty());
}

// Of a sample nobody knows where the arm came from.
TEST(LackOfFitTest, SamplesAreNotTestedForTheApproach) {
  const MeasurementModel model(testing::Rv2ajFlange());
  const std::vector<int> columns = testing::FlangeFreeColumns(model.layout());
  const Eigen::VectorXd no_priors;
  const std::vector<RobustLoss> losses;
  const Eigen::VectorXd values = model.NominalValues();
  for (const int num_poses : {1000, 6000}) {
    const Dataset data =
        testing::NoisyPositions(model.nominal(), num_poses, kSigma, 13);
    const FittedProblem problem{model,     data,   columns,
                                no_priors, losses, values};
    const LackOfFit lack =
        AssessLackOfFit(problem, CovarianceOf(problem), kGiven).lack;
    EXPECT_EQ(lack.is_sample, num_poses > 5000);
    const bool has_approach =
        std::any_of(lack.structure.begin(), lack.structure.end(),
                    [](const StructureTest& test) {
                      return test.kind == StructureKind::kApproach;
                    });
    EXPECT_EQ(has_approach, num_poses < 5000);
  }
}

// A temperature, recorded in no order, by which the arm grows.
TEST(LackOfFitTest, CovariateIsNamed) {
  const auto temperature = [](int row) {
    return 20.0 + 10.0 * std::sin(2.4 * row);
  };
  const RealArm grows = [&](const Eigen::VectorXd& joints, int row) {
    const double growth = 2e-5 * (temperature(row) - 20.0);
    return Eigen::Vector3d((1.0 + growth) * Rigid(joints, row));
  };
  Fitted fitted(60, 1, 8, grows);
  Eigen::MatrixXd values(1, 60);
  for (int i = 0; i < 60; ++i) values(0, i) = temperature(i);
  fitted.AddCovariate("t_c", values);
  const LackAssessment found = fitted.Assess(kGiven);
  ASSERT_FALSE(found.lack.structure.empty());
  EXPECT_TRUE(found.lack.structure[0].is_found);
  EXPECT_EQ(found.lack.structure[0].kind, StructureKind::kCovariate);
  EXPECT_EQ(found.lack.structure[0].covariate, "t_c");
  ASSERT_FALSE(found.warnings.empty());
  EXPECT_NE(found.warnings.back().find("depend on `t_c`"), std::string::npos);
}

// 50 data sets without any: both tests fail at most 0.5 % of them.
TEST(LackOfFitTest, NothingIsNamedWhereNothingIs) {
  int alarms = 0;
  for (std::uint64_t seed = 100; seed < 150; ++seed) {
    if (!Fitted(30, 1, seed, Rigid).Assess(kGiven).warnings.empty()) ++alarms;
  }
  EXPECT_LE(alarms, 3);
}

}  // namespace
}  // namespace alidade::internal::lack_of_fit_test
