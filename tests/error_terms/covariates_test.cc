// Effects of columns of the data, from data to terms.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "src/common/random.h"
#include "src/error_terms/error_fit.h"
#include "tests/support/matrix_kinematics.h"
#include "tests/support/random_arms.h"

namespace alidade::internal {
namespace {

constexpr double kSigma = 5e-5;  // m
constexpr int kPoses = 120;

// An arm of four revolute joints, its real one with effects of covariates, and
// what was measured. Free are theta of three joints, and the tool.
class CovariatesTest : public ::testing::Test {
 protected:
  CovariatesTest() {
    testing::RandomArmOptions options;
    options.prismatic_fraction = 0.0;
    nominal_ = testing::RandomArm(4, &random_, options);
    for (Joint& joint : nominal_.joints) {
      joint.lower = -1.5;
      joint.upper = 1.5;
    }
    real_ = nominal_;
    real_.errors.joints.resize(4);
  }

  // A covariate of the real arm, with values of its own at each pose.
  CovariateEffect& AddEffect(const std::string& name, double reference,
                             const Eigen::RowVectorXd& values) {
    real_.errors.covariates.push_back({name, reference});
    names_.push_back(name);
    values_.conservativeResize(names_.size(), values.size());
    values_.bottomRows(1) = values;
    return real_.errors.covariates.back();
  }

  Eigen::RowVectorXd Draw(double lower, double upper) {
    return Eigen::RowVectorXd::NullaryExpr(
        kPoses, [&] { return random_.Uniform(lower, upper); });
  }

  Eigen::RowVectorXd DrawSigns() {
    return Eigen::RowVectorXd::NullaryExpr(
        kPoses, [&] { return random_.Uniform() < 0.5 ? -1.0 : 1.0; });
  }

  void Measure() {
    const Eigen::MatrixXd q =
        testing::RandomJointValues(nominal_, kPoses, &random_);
    const ParameterLayout layout(real_);
    const testing::VectorXl values = testing::MatrixValues(real_);
    Eigen::Matrix3Xd points(3, kPoses);
    for (int i = 0; i < kPoses; ++i) {
      const Eigen::VectorXd covariates = values_.col(i);
      const testing::Matrix4l frame = testing::MatrixTargetFrame(
          real_, layout, values, q.col(i).data(), 0, covariates.data());
      points.col(i) = frame.topRightCorner<3, 1>().cast<double>();
      for (double& coordinate : points.col(i)) {
        coordinate += kSigma * random_.Normal();
      }
    }
    data_ = MakePositions(q, points, kSigma);
    data_.covariate_names = names_;
    data_.covariates = values_;
  }

  ErrorFit Fit(const std::vector<CovariateUse>& uses,
               const std::vector<TermSet>& sets, bool selects = false) const {
    const ParameterLayout layout(nominal_);
    std::vector<int> columns;
    for (int j = 0; j < 3; ++j) {
      columns.push_back(layout.Column(ParameterKind::kTheta, j));
    }
    for (int axis = 0; axis < 3; ++axis) {
      columns.push_back(layout.Column(ParameterKind::kToolTranslation, axis));
    }
    const MeasurementModel model(nominal_, 1);
    const Eigen::VectorXd values = model.NominalValues();
    const std::optional<ErrorFit> fit = FitErrorTerms({model,
                                                       data_,
                                                       columns,
                                                       values,
                                                       Eigen::VectorXd(),
                                                       {},
                                                       sets,
                                                       uses,
                                                       selects});
    EXPECT_TRUE(fit.has_value());
    return *fit;
  }

  static TermSet Stated(bool elasticity) {
    TermSet set;
    set.elasticity = elasticity;
    set.covariates = true;
    return set;
  }

  // RMS of what is left, in sigmas.
  double Left(const ErrorFit& fit) const {
    Arm arm = nominal_;
    arm.errors = fit.terms;
    const MeasurementModel model(arm, 1);
    return std::sqrt(model.Errors(fit.values, data_).map().squaredNorm() /
                     (3.0 * kPoses)) /
           kSigma;
  }

  Random random_ = Random(190);
  Arm nominal_;
  Arm real_;
  std::vector<std::string> names_;
  Eigen::MatrixXd values_;
  Dataset data_;
};

TEST_F(CovariatesTest, EffectsOnTargetAndJointAreRecovered) {
  CovariateEffect& warm = AddEffect("temperature", 20.0, Draw(15.0, 35.0));
  warm.target.head<3>() << 2e-5, -1e-5, 3e-5;  // m per K
  warm.joints = Eigen::Vector4d(0.0, 4e-5, 0.0, 0.0);
  Measure();
  const ErrorFit fit =
      Fit({{"temperature", false, true, {1}}}, {Stated(false)});
  ASSERT_EQ(fit.terms.covariates.size(), 1U);
  const CovariateEffect& found = fit.terms.covariates[0];
  // A tenth of the largest effect; sigma over ten degrees and ten poses is
  // 5e-7.
  EXPECT_LT((found.target.head<3>() - warm.target.head<3>()).norm(), 4e-6);
  EXPECT_NEAR(found.joints[1], 4e-5, 4e-6);
  EXPECT_EQ(found.joints[2], 0.0);
  EXPECT_TRUE(found.base.isZero(0.0));
  EXPECT_NEAR(found.reference, 25.0, 2.0);
  EXPECT_NEAR(Left(fit), 1.0, 0.12);
}

TEST_F(CovariatesTest, BacklashFollowsTheApproachOfEachJoint) {
  AddEffect("from", 0.0, DrawSigns()).joints =
      Eigen::Vector4d(2e-4, 0.0, 0.0, 0.0);
  AddEffect("from2", 0.0, DrawSigns()).joints =
      Eigen::Vector4d(0.0, -3e-4, 0.0, 0.0);
  Measure();
  CovariateUse first{"from", false, false, {0}};
  first.is_approach = true;
  CovariateUse second{"from2", false, false, {1}};
  second.is_approach = true;
  const ErrorFit fit = Fit({first, second}, {Stated(false)});
  EXPECT_EQ(fit.terms.covariates[0].reference, 0.0);
  EXPECT_NEAR(fit.terms.covariates[0].joints[0], 2e-4, 3e-5);
  EXPECT_NEAR(fit.terms.covariates[1].joints[1], -3e-4, 3e-5);
  EXPECT_EQ(fit.terms.covariates[1].joints[0], 0.0);
  EXPECT_NEAR(Left(fit), 1.0, 0.12);
}

TEST_F(CovariatesTest, PayloadChangesTheMomentsThatJointsBendUnder) {
  for (Arm* arm : {&nominal_, &real_}) {
    arm->errors.links.resize(4);
    for (Load& load : arm->errors.links) load.mass = 5.0;
  }
  for (JointErrors& joint : real_.errors.joints) {
    joint.compliance = Eigen::Vector3d(8e-6, -6e-6, 2e-5);
  }
  real_.errors.payload.mass = 2.0;
  AddEffect("mass", 2.0, Draw(0.0, 8.0)).payload = 1.0;
  Measure();
  CovariateUse use{"mass", false};
  use.is_payload = true;
  const ErrorFit fit = Fit({use}, {Stated(true)});
  ASSERT_EQ(fit.terms.covariates.size(), 1U);
  EXPECT_EQ(fit.terms.covariates[0].payload, 1.0);
  EXPECT_TRUE(fit.terms.covariates[0].base.isZero(0.0));
  EXPECT_NEAR(fit.terms.payload.mass, values_.mean(), 1e-12);
  EXPECT_NEAR(fit.terms.covariates[0].reference, values_.mean(), 1e-12);
  EXPECT_NEAR(Left(fit), 1.0, 0.12);
  // Without it the loads that differ are left.
  data_.covariates = Eigen::MatrixXd(values_ * 0.0);
  EXPECT_GT(Left(Fit({use}, {Stated(true)})), 1.5);
  data_.covariate_names.clear();
  data_.covariates = {};
  EXPECT_GT(Left(Fit({}, {Stated(true)})), 1.5);
}

TEST_F(CovariatesTest, StationsHaveABaseInEverySet) {
  Eigen::RowVectorXd second = Eigen::RowVectorXd::Zero(kPoses);
  second.tail(50).setOnes();
  AddEffect("station B", 0.0, second).base << 2e-3, -1e-3, 5e-4, 1e-3, 0.0,
      -2e-3;
  Measure();
  CovariateUse use{"station B"};
  use.is_station = true;
  TermSet elastic;
  elastic.name = "elasticity";
  elastic.elasticity = true;
  const ErrorFit fit = Fit({use}, {elastic}, true);
  EXPECT_EQ(fit.rungs.front().columns.size(), 6);
  ASSERT_NE(fit.covariance, nullptr);
  ASSERT_EQ(fit.terms.covariates.size(), 1U);
  EXPECT_EQ(fit.terms.covariates[0].reference, 0.0);
  EXPECT_NEAR(fit.terms.covariates[0].base[0], 2e-3, 2e-4);
  EXPECT_NEAR(Left(fit), 1.0, 0.12);
  // The arm is rigid, whatever its base.
  EXPECT_EQ(fit.stacking.share, 0.0);
  // Of one station nothing is to be found.
  data_.covariates = Eigen::MatrixXd::Zero(1, kPoses).eval();
  EXPECT_EQ(Fit({use}, {elastic}, true).rungs.front().columns.size(), 0);
}

}  // namespace
}  // namespace alidade::internal
