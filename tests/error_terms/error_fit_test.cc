#include "src/error_terms/error_fit.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "alidade/forward_kinematics.h"
#include "src/common/random.h"
#include "tests/support/matrix_kinematics.h"
#include "tests/support/random_arms.h"

namespace alidade::internal::error_fit_test {
namespace {

constexpr double kSigma = 5e-5;  // m

// An arm of four joints whose third one is prismatic where wanted, and the real
// one that was measured. Free are theta of all joints but the last, on which
// the tool depends, and the tool.
struct Measured {
  Arm nominal;
  Arm real;
  Dataset data;
  std::vector<int> columns;
};

ErrorTerms TrueTerms(const Arm& arm, bool with_functions) {
  ErrorTerms errors;
  errors.joints.resize(arm.joints.size());
  for (int j = 0; j < arm.num_joints(); ++j) {
    JointErrors& joint = errors.joints[j];
    const double sign = j % 2 == 0 ? 1.0 : -1.0;
    joint.compliance = sign * Eigen::Vector3d(3e-5, -2e-5, 8e-5);
    if (arm.joints[j].type == JointType::kPrismatic) {
      joint.compliance.z() = 0.0;
    } else if (with_functions) {
      joint.harmonics = {{1.5, 4e-4 * sign, 3e-4}};
    }
  }
  return errors;
}

Dataset MeasureAt(const Arm& real, const Eigen::MatrixXd& q, double sigma,
                  Random* random) {
  Eigen::Matrix3Xd points(3, q.cols());
  for (Eigen::Index i = 0; i < q.cols(); ++i) {
    points.col(i) =
        testing::MatrixPosition(real, q.col(i).data()).cast<double>();
    for (double& coordinate : points.col(i)) {
      coordinate += sigma * random->Normal();
    }
  }
  return MakePositions(q, points, kSigma);
}

Measured Make(int num_poses, const ErrorTerms& terms, const Arm& arm,
              Random* random) {
  Measured measured;
  measured.nominal = arm;
  measured.real = arm;
  measured.real.errors = terms;
  const Eigen::MatrixXd q = testing::RandomJointValues(arm, num_poses, random);
  measured.data = MeasureAt(measured.real, q, kSigma, random);
  const ParameterLayout layout(arm);
  for (int j = 0; j + 1 < arm.num_joints(); ++j) {
    measured.columns.push_back(layout.Column(ParameterKind::kTheta, j));
  }
  for (int axis = 0; axis < 3; ++axis) {
    measured.columns.push_back(
        layout.Column(ParameterKind::kToolTranslation, axis));
  }
  return measured;
}

Arm MakeArm(Random* random, bool has_prismatic = false) {
  testing::RandomArmOptions options;
  options.prismatic_fraction = 0.0;
  Arm arm = testing::RandomArm(4, random, options);
  if (has_prismatic) {
    arm.joints[2].type = JointType::kPrismatic;
    arm.joints[2].lower = -0.3;
    arm.joints[2].upper = 0.3;
  }
  for (Joint& joint : arm.joints) {
    joint.lower = std::max(joint.lower, -1.5);
    joint.upper = std::min(joint.upper, 1.5);
  }
  return arm;
}

std::vector<TermSet> Rungs() {
  TermSet elastic;
  elastic.name = "elasticity";
  elastic.elasticity = true;
  TermSet functions = elastic;
  functions.name = "functions";
  functions.function_length = 1.5;
  return {elastic, functions};
}

// The geometry alone, by Gauss-Newton.
Eigen::VectorXd RigidValues(const MeasurementModel& model,
                            const Measured& measured) {
  Eigen::VectorXd values = model.NominalValues();
  for (int iteration = 0; iteration < 5; ++iteration) {
    Linearization linear;
    model.Linearize(values, measured.data, measured.columns, &linear);
    const Eigen::VectorXd step =
        linear.jacobian.colPivHouseholderQr().solve(linear.residuals);
    for (std::size_t k = 0; k < measured.columns.size(); ++k) {
      values[measured.columns[k]] -= step[static_cast<Eigen::Index>(k)];
    }
  }
  return values;
}

std::optional<ErrorFit> FitWith(const Measured& measured,
                                std::vector<TermSet> sets, bool selects,
                                int threads = 1,
                                std::vector<RobustLoss> losses = {}) {
  const MeasurementModel model(measured.nominal, threads);
  const Eigen::VectorXd values = RigidValues(model, measured);
  return FitErrorTerms({model,
                        measured.data,
                        measured.columns,
                        values,
                        Eigen::VectorXd(),
                        std::move(losses),
                        std::move(sets),
                        {},
                        selects});
}

// RMS of the position error at new poses, and of the arm without the terms.
double ErrorAtNewPoses(const Measured& measured, const ErrorFit& fit,
                       Random* random) {
  Arm arm = measured.nominal;
  arm.errors = fit.terms;
  const MeasurementModel model(arm, 1);
  const Eigen::MatrixXd q =
      testing::RandomJointValues(measured.nominal, 200, random);
  const Dataset exact = MeasureAt(measured.real, q, 0.0, random);
  return std::sqrt(
      (model.Predict(fit.values, q) - exact.positions().map()).squaredNorm() /
      200.0);
}

TEST(FitErrorTermsTest, CompliancesOfKnownArmsAreRecovered) {
  for (const bool has_prismatic : {false, true}) {
    Random random(160, has_prismatic ? 1 : 0);
    const Arm arm = MakeArm(&random, has_prismatic);
    const Measured measured = Make(80, TrueTerms(arm, false), arm, &random);
    const std::optional<ErrorFit> fit =
        FitWith(measured, {Rungs().front()}, false);
    ASSERT_TRUE(fit.has_value());
    EXPECT_EQ(fit->stacking.share, 1.0);
    EXPECT_NEAR(fit->rungs.back().variance, 1.0, 0.3);
    const TermColumns& columns = fit->covariance->columns;
    const Eigen::VectorXd estimated = columns.CoefficientsOf(fit->terms);
    const Eigen::VectorXd truth = columns.CoefficientsOf(measured.real.errors);
    const auto p = static_cast<Eigen::Index>(measured.columns.size());
    int told = 0;
    for (int k = 0; k < columns.num_dense(); ++k) {
      const double deviation = fit->covariance->root.row(p + k).norm();
      EXPECT_LT(std::abs(estimated[k] - truth[k]), 4.0 * deviation) << k;
      if (deviation < 0.25 * std::abs(truth[k])) ++told;
    }
    EXPECT_GE(told, 5);
    EXPECT_LT(ErrorAtNewPoses(measured, *fit, &random), 1.5 * kSigma);
  }
}

TEST(FitErrorTermsTest, StackOfRungsIsBetterThanTheGeometry) {
  Random random(161);
  const Arm arm = MakeArm(&random);
  const Measured measured = Make(100, TrueTerms(arm, true), arm, &random);
  const std::optional<ErrorFit> fit = FitWith(measured, Rungs(), true);
  ASSERT_TRUE(fit.has_value());
  EXPECT_GT(fit->stacking.share, 0.9);
  ASSERT_GE(fit->rungs.size(), 3U);
  EXPECT_EQ(fit->rungs[0].set.name, "geometry");
  EXPECT_TRUE(fit->rungs[0].terms.joints[0].function.empty());
  EXPECT_GT(fit->rungs[2].weight, 0.7);
  EXPECT_LT(fit->rungs[2].region_error, 0.5 * fit->rungs[0].region_error);
  EXPECT_LT(fit->rungs[2].random_error, 0.5 * fit->rungs[0].random_error);
  ErrorFit rigid = *fit;
  rigid.values = fit->rungs[0].values;
  rigid.terms = ErrorTerms();
  const double after = ErrorAtNewPoses(measured, *fit, &random);
  EXPECT_LT(after, 0.3 * ErrorAtNewPoses(measured, rigid, &random));
  EXPECT_LT(after, 3.0 * kSigma);
  // Bands of the functions are known, and wider where there are no data.
  const JointFunction& function = fit->terms.joints[1].function;
  ASSERT_EQ(function.deviations.size(), function.values.size());
  EXPECT_GT(function.DeviationAt(function.first + 0.1),
            1.2 * function.DeviationAt(0.0));
}

TEST(FitErrorTermsTest, ChanceOfAGainIsThatOfMixedChiSquares) {
  // Of one and two degrees of freedom: erfc and exp.
  for (const double gain : {0.5, 2.7055, 6.0}) {
    const double one = std::erfc(std::sqrt(0.5 * gain));
    EXPECT_NEAR(ChanceOfGain(gain, 1), 0.5 * one, 1e-12);
    EXPECT_NEAR(ChanceOfGain(gain, 2), 0.5 * one + 0.25 * std::exp(-0.5 * gain),
                1e-12);
  }
  EXPECT_NEAR(ChanceOfGain(2.7055, 1), 0.05, 1e-5);
  EXPECT_EQ(ChanceOfGain(0.0, 1), 1.0);
  EXPECT_EQ(ChanceOfGain(-3.0, 2), 1.0);
  EXPECT_EQ(ChanceOfGain(std::nan(""), 2), 1.0);
}

TEST(FitErrorTermsTest, SetsWhoseTermsAreNotThereAreNotWeighed) {
  int right = 0;
  for (int stream = 0; stream < 8; ++stream) {
    Random random(167, stream);
    const Arm arm = MakeArm(&random);
    const Measured measured = Make(60, TrueTerms(arm, false), arm, &random);
    const std::optional<ErrorFit> fit = FitWith(measured, Rungs(), true);
    ASSERT_TRUE(fit.has_value());
    ASSERT_EQ(fit->rungs.size(), 3U);
    EXPECT_TRUE(fit->rungs[0].is_weighed);
    EXPECT_TRUE(fit->rungs[1].is_weighed);
    EXPECT_GT(fit->rungs[0].criterion, fit->rungs[1].criterion);
    const RungFit& functions = fit->rungs[2];
    EXPECT_EQ(functions.set.name, "functions");
    if (functions.is_weighed) continue;
    ++right;
    EXPECT_EQ(functions.weight, 0.0);
    EXPECT_GT(fit->rungs[1].weight, 0.95);
    // What it would be is described all the same.
    EXPECT_EQ(functions.values.size(), fit->values.size());
    EXPECT_FALSE(functions.terms.joints[0].function.empty());
  }
  // One in twenty has as much evidence by chance.
  EXPECT_GE(right, 6);
}

TEST(FitErrorTermsTest, FunctionsOfPrismaticJointsAreFound) {
  Random random(168);
  const Arm arm = MakeArm(&random, true);
  ErrorTerms truth = TrueTerms(arm, false);
  JointFunction& function = truth.joints[2].function;
  function.first = -0.3;
  function.spacing = 0.1;
  function.values.resize(7);
  function.values << 3e-4, -2e-4, 4e-4, 6e-4, -5e-4, -4e-4, 1e-4;
  const Measured measured = Make(200, truth, arm, &random);
  TermSet set = Rungs().back();
  set.function_length = 0.1;
  const std::optional<ErrorFit> fit = FitWith(measured, {set}, false);
  ASSERT_TRUE(fit.has_value());
  EXPECT_LT(ErrorAtNewPoses(measured, *fit, &random), 2.0 * kSigma);
  const JointFunction& found = fit->terms.joints[2].function;
  // But for a constant, which is r of the joint.
  const double shift = found.At(0.0) - function.At(0.0);
  for (const double q : {-0.25, -0.1, 0.13, 0.2, 0.28}) {
    EXPECT_NEAR(found.At(q) - shift, function.At(q), 2e-4) << q;
  }
}

TEST(FitErrorTermsTest, FunctionsAreModuloATurnWhereTheJointSaysSo) {
  for (const bool repeats : {true, false}) {
    Random random(169);
    Arm arm = MakeArm(&random);
    arm.joints[0].lower = -9.0;
    arm.joints[0].upper = 9.0;
    ErrorTerms truth = TrueTerms(arm, true);
    truth.joints[0].harmonics = {{repeats ? 2.0 : 0.37, 6e-4, 4e-4}};
    const Measured measured = Make(150, truth, arm, &random);
    const std::optional<ErrorFit> fit = FitWith(measured, Rungs(), true);
    ASSERT_TRUE(fit.has_value());
    EXPECT_EQ(fit->terms.joints[0].function.is_periodic, repeats);
    EXPECT_FALSE(fit->terms.joints[1].function.is_periodic);
    EXPECT_GT(fit->stacking.share, 0.9);
    EXPECT_LT(ErrorAtNewPoses(measured, *fit, &random), 3.0 * kSigma);
  }
}

TEST(FitErrorTermsTest, RigidArmStaysRigid) {
  int none = 0;
  for (int stream = 0; stream < 10; ++stream) {
    Random random(162, stream);
    const Arm arm = MakeArm(&random);
    const Measured measured = Make(60, ErrorTerms(), arm, &random);
    const std::optional<ErrorFit> fit = FitWith(measured, Rungs(), true);
    ASSERT_TRUE(fit.has_value());
    if (fit->stacking.share == 0.0) {
      ++none;
      EXPECT_TRUE(fit->terms.empty());
      EXPECT_EQ(fit->covariance, nullptr);
      const MeasurementModel model(measured.nominal, 1);
      EXPECT_EQ(fit->values, RigidValues(model, measured));
    } else {
      // The geometry's own error is some 0.3 sigma.
      EXPECT_LT(ErrorAtNewPoses(measured, *fit, &random), kSigma);
    }
  }
  EXPECT_GE(none, 8);
}

TEST(FitErrorTermsTest, FewConfigurationsDecideNothing) {
  Random random(163);
  const Arm arm = MakeArm(&random);
  Measured measured =
      Make(kFewestForErrorTerms - 1, TrueTerms(arm, true), arm, &random);
  EXPECT_FALSE(FitWith(measured, Rungs(), true).has_value());
  // Repeats are no more configurations.
  const Eigen::MatrixXd q = measured.data.joint_values.map().replicate(1, 3);
  measured.data = MeasureAt(measured.real, q, kSigma, &random);
  EXPECT_FALSE(FitWith(measured, Rungs(), true).has_value());
  // Stated terms are fitted to whatever there is.
  EXPECT_TRUE(FitWith(measured, {Rungs().front()}, false).has_value());
}

TEST(FitErrorTermsTest, ThreadsDoNotChangeBits) {
  Random random(164);
  const Arm arm = MakeArm(&random);
  const Measured measured = Make(70, TrueTerms(arm, true), arm, &random);
  const std::optional<ErrorFit> one = FitWith(measured, Rungs(), true, 1);
  const std::optional<ErrorFit> two = FitWith(measured, Rungs(), true, 2);
  EXPECT_EQ(one->values, two->values);
  EXPECT_EQ(one->stacking.weights, two->stacking.weights);
  EXPECT_EQ(one->stacking.share, two->stacking.share);
  EXPECT_EQ(one->covariance->root, two->covariance->root);
  for (int j = 0; j < arm.num_joints(); ++j) {
    EXPECT_EQ(one->terms.joints[j].compliance, two->terms.joints[j].compliance);
    EXPECT_EQ(one->terms.joints[j].function.values,
              two->terms.joints[j].function.values);
  }
}

TEST(FitErrorTermsTest, RobustLossJudgesWhatTheTermsLeave) {
  Random random(165);
  const Arm arm = MakeArm(&random);
  Measured measured = Make(100, TrueTerms(arm, false), arm, &random);
  Eigen::MatrixXd points = measured.data.positions().map();
  for (const int outlier : {3, 40, 77}) {
    points.col(outlier) += Eigen::Vector3d(4e-3, -6e-3, 5e-3);
  }
  measured.data.positions() = points;
  const std::optional<ErrorFit> plain =
      FitWith(measured, {Rungs().front()}, false);
  const std::optional<ErrorFit> robust = FitWith(
      measured, {Rungs().front()}, false, 1, TunedLosses(LossKind::kTukey));
  EXPECT_GT(ErrorAtNewPoses(measured, *plain, &random), 4.0 * kSigma);
  EXPECT_LT(ErrorAtNewPoses(measured, *robust, &random), 1.5 * kSigma);
  for (const int outlier : {3, 40, 77}) {
    EXPECT_LT(robust->weights[outlier], 0.05);
  }
  // What bends is no outlier.
  int kept = 0;
  for (const double weight : robust->weights) kept += weight > 0.3 ? 1 : 0;
  EXPECT_GE(kept, 90);
}

// Stated terms of data that determine hardly any of them.
void ExpectSomeFit(const Measured& measured, const char* what,
                   bool is_regular = true) {
  SCOPED_TRACE(what);
  TermSet all = Rungs().back();
  all.cycles = {1.0};
  all.scale = true;
  all.backlash = true;
  const std::optional<ErrorFit> fit = FitWith(measured, {all}, false);
  ASSERT_TRUE(fit.has_value());
  EXPECT_TRUE(fit->values.allFinite());
  if (is_regular) {
    EXPECT_TRUE(fit->covariance->root.allFinite());
  }
  for (const JointErrors& joint : fit->terms.joints) {
    EXPECT_TRUE(joint.compliance.allFinite());
    EXPECT_TRUE(joint.function.values.allFinite());
  }
  const std::optional<ErrorFit> chosen = FitWith(measured, Rungs(), true);
  if (chosen) {
    EXPECT_TRUE(chosen->values.allFinite());
    EXPECT_GE(chosen->stacking.share, 0.0);
    EXPECT_LE(chosen->stacking.share, 1.0);
  }
}

TEST(FitErrorTermsTest, PoorDataAreNoTrouble) {
  Random random(166);
  const Arm arm = MakeArm(&random, true);
  const ErrorTerms terms = TrueTerms(arm, true);
  ExpectSomeFit(Make(1, terms, arm, &random), "one pose");
  Measured still = Make(40, terms, arm, &random);
  still.data = MeasureAt(still.real, Eigen::MatrixXd::Constant(4, 40, 0.2),
                         kSigma, &random);
  ExpectSomeFit(still, "forty times the same");
  Measured one_joint = Make(40, terms, arm, &random);
  Eigen::MatrixXd q = one_joint.data.joint_values.map();
  for (const int j : {0, 2, 3}) q.row(j).setConstant(0.1);
  one_joint.data = MeasureAt(one_joint.real, q, kSigma, &random);
  ExpectSomeFit(one_joint, "one joint moves");
  Measured exact = Make(40, ErrorTerms(), arm, &random);
  exact.data =
      MeasureAt(exact.real, exact.data.joint_values.map(), 0.0, &random);
  ExpectSomeFit(exact, "exact data of a rigid arm");
  Measured huge = Make(40, terms, arm, &random);
  huge.data.positions() = Eigen::MatrixXd(huge.data.positions().map() * 1e9);
  ExpectSomeFit(huge, "positions of a million kilometres", false);
  Measured far = Make(40, terms, arm, &random);
  q = far.data.joint_values.map();
  q.row(1).array() += 1e4;
  far.data = MeasureAt(far.real, q, kSigma, &random);
  ExpectSomeFit(far, "a joint thousands of turns away");
  q.row(1) *= 1e4;
  far.data = MeasureAt(far.real, q, kSigma, &random);
  ExpectSomeFit(far, "a joint that turns millions of times");
}

}  // namespace
}  // namespace alidade::internal::error_fit_test
