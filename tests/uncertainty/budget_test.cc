#include "src/uncertainty/budget.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "src/common/constants.h"
#include "src/common/distributions.h"
#include "src/common/random.h"
#include "src/kernel/reduction.h"
#include "tests/support/classic_arms.h"
#include "tests/support/noisy_positions.h"

namespace alidade::internal::budget_test {
namespace {

constexpr double kSigma = 0.05e-3;

BudgetContribution Part(double std, double freedom) {
  return {BudgetSource::kResiduals, EvaluationType::kA, std, freedom, ""};
}

// The gauge block of JCGM 100:2008, H.1.6: 16.7.
TEST(BudgetTest, EffectiveDegreesOfFreedomAreThoseOfTheGuide) {
  EXPECT_NEAR(WelchSatterthwaite({Part(25e-9, 18.0), Part(9.7e-9, 25.6),
                                  Part(2.9e-9, 50.0), Part(16.6e-9, 2.0)}),
              16.7, 0.1);
  EXPECT_EQ(WelchSatterthwaite({Part(1e-3, kInfinity)}), kInfinity);
  // What contributes nothing has no part, however little is known of it.
  EXPECT_EQ(WelchSatterthwaite({Part(1e-3, kInfinity), Part(0.0, 1.0)}),
            kInfinity);
}

// A UR10 after a calibration with 56 positions.
class BudgetOf {
 public:
  BudgetOf()
      : model_(testing::Ur10()),
        values_(model_.NominalValues()),
        data_(testing::NoisyPositions(model_.nominal(), 56, kSigma, 3)),
        columns_(testing::TellableColumns(model_, data_)) {
    prediction = InverseInformation(
        JacobianFactor(model_, values_, data_, columns_), columns_,
        Eigen::VectorXd::Constant(static_cast<Eigen::Index>(columns_.size()),
                                  kInfinity));
    lack.source = NoiseSource::kStated;
    measurement.stated_sigma = kSigma;
    options.region_configurations = 300;
  }

  std::optional<UncertaintyBudget> Make() const {
    return MakeBudget(
        {model_, values_, prediction, lack, measurement, options});
  }
  double Std(BudgetSource source) const {
    const std::optional<UncertaintyBudget> budget = Make();
    for (const BudgetContribution& one : budget->contributions) {
      if (one.source == source) return one.std;
    }
    return -1.0;
  }
  const MeasurementModel& model() const { return model_; }
  const Eigen::VectorXd& values() const { return values_; }

  ParameterCovariance prediction;
  LackOfFit lack;
  MeasurementKnowledge measurement;
  UncertaintyOptions options;

 private:
  MeasurementModel model_;
  Eigen::VectorXd values_;
  Dataset data_;
  std::vector<int> columns_;
};

// By differences of products of matrices in long double over a step of 1e-5.
TEST(BudgetTest, ParametersContributeWhatTheirCovarianceMovesPositionsBy) {
  const BudgetOf ur10;
  const UncertaintyBudget budget = *ur10.Make();
  ASSERT_EQ(budget.configurations, 300);
  const Arm& arm = ur10.model().nominal();
  const Eigen::MatrixXd joints = DrawJointValues(arm, 300, ur10.options.seed);
  const std::vector<int>& columns = ur10.prediction.columns;
  Eigen::MatrixXd jacobian(900, ur10.prediction.size());
  const testing::VectorXl values = testing::MatrixValues(arm);
  constexpr long double kStep = 1e-5L;
  for (int k = 0; k < ur10.prediction.size(); ++k) {
    testing::VectorXl plus = values;
    testing::VectorXl minus = values;
    plus[columns[k]] += kStep;
    minus[columns[k]] -= kStep;
    for (int i = 0; i < 300; ++i) {
      jacobian.block<3, 1>(3 * i, k) =
          ((testing::MatrixTargetFrame(arm, plus, joints.col(i).data()) -
            testing::MatrixTargetFrame(arm, minus, joints.col(i).data()))
               .topRightCorner<3, 1>() /
           (2.0L * kStep))
              .cast<double>();
    }
  }
  const double expected =
      (jacobian * ur10.prediction.root).norm() / std::sqrt(900.0);
  EXPECT_NEAR(ur10.Std(BudgetSource::kParameters), expected, 1e-8 * expected);
  EXPECT_NEAR(budget.position.std, expected, 1e-8 * expected);
  EXPECT_NEAR(budget.measured.std, std::hypot(expected, kSigma),
              1e-8 * expected);
  double before = kInfinity;
  for (const ParameterContribution& one : budget.parameters) {
    EXPECT_LE(one.contribution(), before) << one.name;
    before = one.contribution();
    const auto column = ur10.model().layout().Find(one.name);
    const auto k =
        std::find(columns.begin(), columns.end(), *column) - columns.begin();
    EXPECT_NEAR(one.sensitivity, jacobian.col(k).norm() / std::sqrt(900.0),
                1e-7 * one.sensitivity)
        << one.name;
    EXPECT_EQ(one.std, ur10.prediction.Deviations()[k]);
  }
}

// Estimates are drawn from their covariance, and the positions they are off by
// computed: 2000 of them at 300 configurations. All of one share an error, so
// that the share is known to +- 0.3 %.
TEST(BudgetTest, ExpandedUncertaintyHoldsAsOftenAsItSays) {
  BudgetOf ur10;
  ur10.lack.excess_variance = 3.0 * kSigma * kSigma;
  ur10.lack.excess_degrees_of_freedom = kInfinity;
  const UncertaintyBudget budget = *ur10.Make();
  const Eigen::MatrixXd joints =
      DrawJointValues(ur10.model().nominal(), 300, ur10.options.seed);
  const Dataset positions =
      MakePositions(joints, Eigen::Matrix3Xd::Zero(3, 300), 1.0);
  Linearization rows;
  ur10.model().Linearize(ur10.values(), positions, ur10.prediction.columns,
                         &rows);
  const Eigen::MatrixXd spread = rows.jacobian * ur10.prediction.root;
  Random random(5);
  double axes = 0.0;
  double distances = 0.0;
  constexpr int kTrials = 2000;
  for (int trial = 0; trial < kTrials; ++trial) {
    Eigen::VectorXd u(spread.cols());
    for (double& x : u) x = random.Normal();
    Eigen::VectorXd error = spread * u;
    for (double& x : error) x += kSigma * random.Normal();
    axes += static_cast<double>(
                (error.array().abs() <= budget.position.expanded).count()) /
            900.0;
    const Eigen::ArrayXd norms =
        error.reshaped(3, 300).colwise().norm().transpose();
    distances += static_cast<double>(
                     (norms <= budget.position.expanded_distance).count()) /
                 300.0;
  }
  // Exactly, over the axes of all configurations. Fifty even quantiles stand
  // for them, which moves the rate by 2e-5 here.
  double exceeded = 0.0;
  for (const double variance : spread.rowwise().squaredNorm()) {
    const double std = std::sqrt(variance + kSigma * kSigma);
    exceeded += 2.0 * NormalCdf(-budget.position.expanded / std) / 900.0;
  }
  EXPECT_NEAR(exceeded, 0.05, 1e-4);
  EXPECT_NEAR(axes / kTrials, 0.95, 0.004);
  EXPECT_NEAR(distances / kTrials, 0.95, 0.006);
}

TEST(BudgetTest, CoverageFactorIsStudentsWhereAllPlacesAreAlike) {
  BudgetOf ur10;
  // The model alone: the same everywhere.
  ur10.prediction.root *= 1e-9;
  ur10.lack.excess_variance = 3.0 * 4e-8;
  ur10.lack.excess_degrees_of_freedom = 8.0;
  const CombinedUncertainty position = ur10.Make()->position;
  EXPECT_NEAR(position.std, 2e-4, 1e-12);
  EXPECT_NEAR(position.degrees_of_freedom, 8.0, 1e-6);
  EXPECT_NEAR(position.coverage_factor, 2.306, 5e-4);  // JCGM 100, table G.2
  // sqrt(3 F(0.95; 3, 8)), F = 4.066 of tables.
  EXPECT_NEAR(position.expanded_distance, 2e-4 * std::sqrt(3.0 * 4.066), 1e-7);
}

// All contributions are zero: the coverage factor is the normal quantile.
TEST(BudgetTest, OfNothingIsNothing) {
  BudgetOf ur10;
  ur10.prediction.root.setZero();
  ur10.options.confidence = 0.9;
  const CombinedUncertainty position = ur10.Make()->position;
  EXPECT_EQ(position.std, 0.0);
  EXPECT_EQ(position.expanded, 0.0);
  EXPECT_EQ(position.expanded_distance, 0.0);
  EXPECT_NEAR(position.coverage_factor, 1.644854, 1e-5);
}

TEST(BudgetTest, NothingCountsTwice) {
  using Source = BudgetSource;
  BudgetOf ur10;
  ur10.lack.excess_variance = 3.0 * 25e-10;
  ur10.lack.excess_degrees_of_freedom = 100.0;
  // Without repeats the model's part contains the repeatability.
  EXPECT_NEAR(ur10.Std(Source::kModel), 5e-5, 1e-15);
  EXPECT_EQ(ur10.Std(Source::kRepeatability), 0.0);
  EXPECT_EQ(ur10.Std(Source::kMeasurement), kSigma);
  // So few repeats that they say nothing, or of a spread that the instrument
  // explains: as none.
  ur10.measurement.repeat_std = std::hypot(kSigma, 3e-5);
  ur10.measurement.repeat_freedom = 6.0;
  EXPECT_EQ(ur10.Std(Source::kRepeatability), 0.0);
  EXPECT_NEAR(ur10.Std(Source::kModel), 5e-5, 1e-15);
  ur10.measurement.repeat_std = 1.2 * kSigma;  // chi-square: p = 0.15
  ur10.measurement.repeat_freedom = 12.0;
  EXPECT_EQ(ur10.Std(Source::kRepeatability), 0.0);
  EXPECT_NEAR(ur10.Std(Source::kModel), 5e-5, 1e-15);
  // Enough of them: it is taken out of there, and the instrument out of it.
  ur10.measurement.repeat_std = std::hypot(kSigma, 3e-5);
  ur10.measurement.repeat_freedom = 60.0;
  EXPECT_NEAR(ur10.Std(Source::kRepeatability), 3e-5, 1e-15);
  EXPECT_NEAR(ur10.Std(Source::kModel), 4e-5, 1e-15);
  const std::optional<UncertaintyBudget> few = ur10.Make();
  // 60 (9 / 34)^2.
  EXPECT_NEAR(few->contributions[2].degrees_of_freedom, 60.0 * 81.0 / 1156.0,
              1e-8);
  // Many: the model's part is beyond them already.
  ur10.lack.source = NoiseSource::kRepeats;
  EXPECT_NEAR(ur10.Std(Source::kModel), 5e-5, 1e-15);
  // Without a stated sigma repeats are instrument and arm together.
  ur10.measurement.stated_sigma.reset();
  EXPECT_NEAR(ur10.Std(Source::kRepeatability), std::hypot(kSigma, 3e-5),
              1e-15);
  EXPECT_EQ(ur10.Std(Source::kMeasurement), -1.0);
  EXPECT_EQ(ur10.Std(Source::kResiduals), -1.0);
  // And without repeats the residuals are all that there is.
  ur10.measurement.repeat_freedom = 0.0;
  ur10.lack = {};
  ur10.lack.residual = 7e-5;
  ur10.lack.degrees_of_freedom = 120.0;
  EXPECT_NEAR(ur10.Std(Source::kResiduals), 7e-5, 1e-15);
}

TEST(BudgetTest, RegionIsInTheBaseFrame) {
  BudgetOf ur10;
  ur10.options.region = {
      {Eigen::Vector3d(0.2, -0.3, 0.1), Eigen::Vector3d(0.7, 0.3, 0.8)}};
  const std::optional<UncertaintyBudget> inside = ur10.Make();
  ASSERT_TRUE(inside);
  EXPECT_GT(inside->configurations, 250);
  ur10.options.region[0].upper.setConstant(50.0);
  ur10.options.region[0].lower.setConstant(49.0);
  EXPECT_FALSE(ur10.Make());
}

}  // namespace
}  // namespace alidade::internal::budget_test
