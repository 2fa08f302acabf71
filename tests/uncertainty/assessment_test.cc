#include "src/uncertainty/assessment.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "src/common/constants.h"
#include "tests/support/noisy_positions.h"
#include "tests/support/rv2aj_arms.h"
#include "tests/support/study.h"
#include "tests/uncertainty/fitted_arm.h"

namespace alidade::internal::assessment_test {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr double kSigma = 0.02e-3;

// An RV-2AJ fitted to positions whose noise is `noise`, of sigmas kSigma.
class AssessmentTest : public ::testing::Test {
 protected:
  AssessmentTest() { options_.map_configurations = 0; }

  void Measure(int num_poses, double noise) {
    data_ = testing::NoisyPositions(model_.nominal(), num_poses, noise, 6);
    data_ = MakePositions(data_.joint_values, data_.positions(), kSigma);
    values_ = testing::FitReference(model_, data_, columns_);
  }

  FittedProblem Fit() const {
    return {model_, data_, columns_, priors_, losses_, values_};
  }

  UncertaintyResult Assess(bool sigma_estimated,
                           const Dataset* validation = nullptr) const {
    const NoiseKnowledge noise{sigma_estimated, stated_};
    AssessmentInput input{Fit(), CovarianceWithLack(Fit(), noise), options_,
                          sigma_estimated};
    input.validation = validation;
    return AssessUncertainty(input);
  }

  const MeasurementModel model_{testing::Rv2ajFlange()};
  const std::vector<int> columns_ = testing::FlangeFreeColumns(model_.layout());
  const std::vector<RobustLoss> losses_;
  Eigen::VectorXd priors_;
  Dataset data_;
  Eigen::VectorXd values_;
  UncertaintyOptions options_;
  StatedNoise stated_ = std::array<double, 2>{1.0, 1.0};
};

// Of 30 equations for 18 parameters: Student's t of 12 degrees of freedom is
// 2.1788 at 97.5 % (tables).
TEST_F(AssessmentTest, IntervalsAreEstimatesAndQuantilesOfTheirDeviations) {
  options_.intervals = IntervalMethod::kLinear;
  Measure(10, kSigma);
  for (const bool sigma_estimated : {false, true}) {
    const UncertaintyResult result = Assess(sigma_estimated);
    // Bounded, so that neither is a difference of infinities.
    EXPECT_NEAR(std::min(result.degrees_of_freedom, 1e9),
                sigma_estimated ? 12.0 : 1e9, 1e-6);
    ASSERT_EQ(result.parameters.size(), 18U);
    for (std::size_t k = 0; k < 18; ++k) {
      const ParameterUncertainty& one = result.parameters[k];
      EXPECT_EQ(one.name, model_.layout().parameter(columns_[k]).name);
      const auto at = static_cast<Eigen::Index>(k);
      EXPECT_NEAR(one.std, std::sqrt(result.covariance(at, at)),
                  1e-12 * one.std);
      const double half = (sigma_estimated ? 2.17881 : 1.959964) * one.std;
      EXPECT_NEAR(one.interval.lower, values_[columns_[k]] - half, 1e-5 * half);
      EXPECT_NEAR(one.interval.upper, values_[columns_[k]] + half, 1e-5 * half);
      EXPECT_FALSE(one.interval.is_profile);
      EXPECT_EQ(one.prior_share, 0.0);
    }
  }
}

// As wide a prior as the data alone tell: half of what is known.
TEST_F(AssessmentTest, PriorsHaveTheirShare) {
  Measure(40, kSigma);
  const double alone = Assess(false).parameters[3].std;
  priors_ = Eigen::VectorXd::Constant(model_.layout().size(), kInfinity);
  priors_[columns_[3]] = alone;
  const UncertaintyResult result = Assess(true);
  EXPECT_NEAR(result.parameters[3].prior_share, 0.5, 1e-6);
  EXPECT_EQ(result.parameters[4].prior_share, 0.0);
  EXPECT_NEAR(result.degrees_of_freedom, 120.0 - 17.5, 1e-6);
}

TEST_F(AssessmentTest, StronglyCorrelatedPairsAreListedTheStrongestFirst) {
  Measure(8, kSigma);
  const UncertaintyResult result = Assess(false);
  const Eigen::VectorXd scale =
      result.covariance.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd correlations =
      scale.asDiagonal() * result.covariance * scale.asDiagonal();
  const auto index_of = [&](const std::string& name) {
    const auto found = std::find_if(
        result.parameters.begin(), result.parameters.end(),
        [&](const ParameterUncertainty& one) { return one.name == name; });
    return found - result.parameters.begin();
  };
  double before = 1.0;
  for (const CorrelatedPair& pair : result.correlated) {
    EXPECT_NEAR(pair.correlation,
                correlations(index_of(pair.first), index_of(pair.second)),
                1e-12);
    EXPECT_LE(std::abs(pair.correlation), before);
    before = std::abs(pair.correlation);
  }
  // Each pair twice, and each parameter with itself.
  const Eigen::Index strong = (correlations.array().abs() >= 0.9).count();
  EXPECT_EQ(static_cast<Eigen::Index>(result.correlated.size()),
            (strong - 18) / 2);
  EXPECT_GE(result.correlated.size(), 2U);
}

TEST_F(AssessmentTest, SigmasThatResidualsContradictAreNamed) {
  const auto of_sigma = HasSubstr("as large as the stated sigmas");
  // Nothing else is known of the noise, so that no lack of the model is seen.
  stated_.reset();
  Measure(60, 2.0 * kSigma);
  EXPECT_THAT(Assess(false).warnings,
              Contains(AllOf(of_sigma, HasSubstr("too narrow"))));
  EXPECT_THAT(Assess(true).warnings, Not(Contains(of_sigma)));
  Measure(60, 0.5 * kSigma);
  EXPECT_THAT(Assess(false).warnings,
              Contains(AllOf(of_sigma, HasSubstr("too wide"))));
  // As stated; so far above that the job itself warns; or so far below that the
  // data count as free of noise.
  for (const double factor : {1.0, 8.0, 0.02}) {
    Measure(60, factor * kSigma);
    EXPECT_THAT(Assess(false).warnings, Not(Contains(of_sigma))) << factor;
  }
}

TEST_F(AssessmentTest, ParametersBeyondTheLimitOfNonlinearityAreNamed) {
  const std::string nonlinear = "nonlinear within the uncertainty of ";
  Measure(40, kSigma);
  const UncertaintyResult usual = Assess(false);
  EXPECT_THAT(usual.warnings, Not(Contains(HasSubstr(nonlinear))));
  options_.nonlinearity_limit = 0.5 * usual.parameters[0].nonlinearity;
  std::string names;
  for (const ParameterUncertainty& one : usual.parameters) {
    if (!(one.nonlinearity > options_.nonlinearity_limit)) continue;
    names += (names.empty() ? "" : ", ") + one.name;
  }
  EXPECT_THAT(Assess(false).warnings,
              Contains(HasSubstr(nonlinear + names + ": linear intervals")));
}

TEST_F(AssessmentTest, PredictionsAreMadeWhereTheyAreAskedFor) {
  Measure(40, kSigma);
  options_.region_configurations = 0;
  const UncertaintyResult none = Assess(false);
  EXPECT_FALSE(none.workspace);
  EXPECT_FALSE(none.budget);
  EXPECT_FALSE(none.validation);
  EXPECT_THAT(none.warnings, IsEmpty());
  options_.region_configurations = 30;
  options_.map_configurations = 20;
  const Dataset others =
      testing::NoisyPositions(model_.nominal(), 50, kSigma, 61);
  const UncertaintyResult all = Assess(false, &others);
  ASSERT_TRUE(all.workspace);
  EXPECT_EQ(all.workspace->joint_values.cols(), 20);
  ASSERT_TRUE(all.budget);
  EXPECT_EQ(all.budget->configurations, 30);
  ASSERT_TRUE(all.validation);
  EXPECT_EQ(all.validation->verdict, "agree");
  options_.region = {
      {Eigen::Vector3d::Constant(49.0), Eigen::Vector3d::Constant(50.0)}};
  const UncertaintyResult nowhere = Assess(false);
  EXPECT_FALSE(nowhere.budget);
  EXPECT_THAT(nowhere.warnings,
              Contains(HasSubstr("there is no uncertainty budget")));
}

// Twice as large as predicted is worth a word, a tenth larger is not.
TEST_F(AssessmentTest, ValidationErrorsBeyondPredictionsAreNamed) {
  const auto larger = HasSubstr("validation errors are larger than predicted");
  Measure(200, kSigma);
  for (const double factor : {1.12, 2.0}) {
    Dataset others =
        testing::NoisyPositions(model_.nominal(), 400, factor * kSigma, 62);
    others = MakePositions(others.joint_values, others.positions(), kSigma);
    const UncertaintyResult result = Assess(false, &others);
    EXPECT_EQ(result.validation->verdict, "larger") << factor;
    if (factor > 1.5) {
      EXPECT_THAT(result.warnings, Contains(larger));
    } else {
      EXPECT_THAT(result.warnings, Not(Contains(larger)));
    }
  }
}

}  // namespace
}  // namespace alidade::internal::assessment_test
