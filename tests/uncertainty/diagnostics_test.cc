#include "src/uncertainty/diagnostics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "src/common/distributions.h"
#include "src/common/random.h"
#include "src/kernel/reduction.h"
#include "src/solve/solve.h"
#include "tests/support/edit.h"
#include "tests/support/noisy_positions.h"
#include "tests/support/reference_solution.h"
#include "tests/support/rv2aj_arms.h"
#include "tests/support/study.h"
#include "tests/uncertainty/fitted_arm.h"

namespace alidade::internal::diagnostics_test {
namespace {

constexpr double kSigma = 0.02e-3;

// An RV-2AJ fitted to its own positions.
class Fitted {
 public:
  explicit Fitted(const Dataset& measured)
      : model_(testing::Rv2ajFlange()),
        data_(measured),
        columns_(testing::FlangeFreeColumns(ParameterLayout(5))),
        values_(Solve(data_)) {}

  Eigen::VectorXd Solve(const Dataset& data) const {
    return testing::FitReference(model_, data, columns_);
  }

  FittedProblem problem() const {
    return {model_, data_, columns_, no_priors_, losses_, values_};
  }
  ResidualDiagnostics Diagnose() const {
    return DiagnoseResiduals(problem(), CovarianceOf(problem()), true,
                             problem().data);
  }
  const MeasurementModel& model() const { return model_; }
  const std::vector<int>& columns() const { return columns_; }
  const Eigen::VectorXd& values() const { return values_; }

 private:
  const MeasurementModel model_;
  const Dataset data_;
  const std::vector<int> columns_;
  const Eigen::VectorXd no_priors_;
  const std::vector<RobustLoss> losses_;
  const Eigen::VectorXd values_;
};

Dataset Without(const Dataset& data, Eigen::Index pose) {
  const Eigen::Index n = data.num_poses();
  std::vector<Eigen::Index> kept;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (i != pose) kept.push_back(i);
  }
  return MakePositions(data.joint_values.map()(Eigen::all, kept),
                       data.positions().map()(Eigen::all, kept),
                       data.sigmas().map()(Eigen::all, kept));
}

TEST(DiagnosticsTest, LeveragesSumToTheNumberOfParameters) {
  const Fitted fitted(
      testing::NoisyPositions(testing::Rv2ajFlange(), 40, kSigma, 6));
  const ResidualDiagnostics diagnostics = fitted.Diagnose();
  double sum = 0.0;
  for (const Influence& pose : diagnostics.poses) sum += pose.leverage;
  EXPECT_NEAR(sum, 18.0, 1e-9);
  EXPECT_NEAR(diagnostics.degrees_of_freedom, 102.0, 1e-9);
  EXPECT_EQ(diagnostics.studentised.size(), 120);
  // 120 values of unit variance: standard error 0.13.
  EXPECT_NEAR(diagnostics.studentised.squaredNorm() / 120.0, 1.0, 0.4);
}

// By leaving the pose out and solving again. The model is straight to 1e-4
// within such steps.
TEST(DiagnosticsTest, CooksDistanceIsHowFarTheEstimateMoves) {
  const Dataset data =
      testing::NoisyPositions(testing::Rv2ajFlange(), 25, kSigma, 16);
  const Fitted fitted(data);
  const ResidualDiagnostics diagnostics = fitted.Diagnose();
  const Eigen::MatrixXd factor =
      JacobianFactor(fitted.model(), fitted.values(), data, fitted.columns());
  for (const Eigen::Index pose : {0, 7, 24}) {
    const Eigen::VectorXd moved =
        fitted.Solve(Without(data, pose)) - fitted.values();
    const double expected =
        (factor * moved(fitted.columns())).squaredNorm() / 18.0;
    EXPECT_NEAR(diagnostics.poses[pose].cooks_distance, expected,
                0.01 * expected);
  }
}

TEST(DiagnosticsTest, ABadPoseIsTheOneThatIsFound) {
  Dataset data = testing::NoisyPositions(testing::Rv2ajFlange(), 40, kSigma, 6);
  testing::Edit(&data.positions())->col(11) +=
      Eigen::Vector3d(0.3e-3, 0.0, 0.0);
  const ResidualDiagnostics diagnostics = Fitted(data).Diagnose();
  const auto worst =
      std::max_element(diagnostics.poses.begin(), diagnostics.poses.end(),
                       [](const Influence& a, const Influence& b) {
                         return a.cooks_distance < b.cooks_distance;
                       });
  EXPECT_EQ(worst->pose, 11);
  EXPECT_LT(diagnostics.normality.p_value, 0.001);
  EXPECT_LT(diagnostics.chi_square_p_value, 0.001);
}

// A slow drift of two sigmas in the order of measurement.
TEST(DiagnosticsTest, DriftIsNotWhite) {
  const Dataset still =
      testing::NoisyPositions(testing::Rv2ajFlange(), 100, kSigma, 21);
  EXPECT_GT(Fitted(still).Diagnose().whiteness.p_value, 0.01);
  Dataset drifting = still;
  for (Eigen::Index i = 0; i < 100; ++i) {
    testing::Edit(&drifting.positions())->col(i).array() +=
        2.0 * kSigma * std::sin(0.06 * static_cast<double>(i));
  }
  EXPECT_LT(Fitted(drifting).Diagnose().whiteness.p_value, 1e-4);
}

// By their definition: n (n + 2) times the sum of squared autocorrelations over
// n - lag, of each coordinate by itself.
TEST(DiagnosticsTest, WhitenessIsLjungAndBoxs) {
  const ResidualDiagnostics diagnostics =
      Fitted(testing::NoisyPositions(testing::Rv2ajFlange(), 40, kSigma, 6))
          .Diagnose();
  EXPECT_EQ(diagnostics.lags, 8);
  ASSERT_EQ(diagnostics.studentised.size(), 120);
  long double statistic = 0.0L;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<long double> series;
    long double mean = 0.0L;
    for (int i = 0; i < 40; ++i) {
      series.push_back(diagnostics.studentised[3 * i + axis]);
      mean += series.back() / 40.0L;
    }
    for (int lag = 1; lag <= 8; ++lag) {
      long double products = 0.0L;
      long double squares = 0.0L;
      for (int i = 0; i < 40; ++i) {
        squares += (series[i] - mean) * (series[i] - mean);
        if (i >= lag) products += (series[i] - mean) * (series[i - lag] - mean);
      }
      const long double correlation = products / squares;
      statistic += 40.0L * 42.0L * correlation * correlation /
                   static_cast<long double>(40 - lag);
    }
  }
  const auto expected = static_cast<double>(statistic);
  EXPECT_NEAR(diagnostics.whiteness.statistic, expected, 1e-12 * expected);
  EXPECT_NEAR(diagnostics.whiteness.p_value, ChiSquareSurvival(expected, 24.0),
              1e-12);
}

// They do not depend on how large the residuals are.
TEST(DiagnosticsTest, WhitenessIsThatOfAnySigma) {
  Dataset data = testing::NoisyPositions(testing::Rv2ajFlange(), 40, kSigma, 6);
  const double statistic = Fitted(data).Diagnose().whiteness.statistic;
  *testing::Edit(&data.sigmas()) *= 100.0;
  EXPECT_NEAR(Fitted(data).Diagnose().whiteness.statistic, statistic,
              1e-6 * statistic);
}

TEST(HistogramTest, EndsTakeInAllBeyond) {
  Eigen::VectorXd values(7);
  values << -100.0, -4.0, -3.8, 0.0, 0.1, 3.9, 100.0;
  const Histogram histogram = CountStandardised(values);
  std::vector<std::int64_t> expected(32, 0);
  expected[0] = 3;
  expected[16] = 2;
  expected[31] = 2;
  EXPECT_EQ(histogram.counts, expected);
}

// A coordinate that was never measured has no series.
TEST(DiagnosticsTest, WhitenessIsOfWhatWasMeasured) {
  Dataset data = testing::NoisyPositions(testing::Rv2ajFlange(), 60, kSigma, 6);
  testing::Edit(&data.sigmas())
      ->row(1)
      .setConstant(std::numeric_limits<double>::infinity());
  const ResidualDiagnostics diagnostics = Fitted(data).Diagnose();
  EXPECT_EQ(diagnostics.lags, 10);
  EXPECT_EQ(diagnostics.studentised.size(), 120);
  EXPECT_NEAR(diagnostics.whiteness.p_value,
              ChiSquareSurvival(diagnostics.whiteness.statistic, 20.0), 1e-12);
}

// A^2 in 50 decimal digits by its definition, and Stephens' correction.
TEST(DiagnosticsTest, NormalityIsAndersonAndDarlings) {
  Eigen::VectorXd values(12);
  values << -0.3, 1.2, 0.4, -1.7, 0.9, 2.1, -0.8, 0.05, 0.6, -1.1, 0.33, -0.45;
  EXPECT_NEAR(TestNormality(values).statistic, 0.102834413648724818, 1e-13);
  // Critical values of D'Agostino and Stephens, table 4.7.
  EXPECT_NEAR(AndersonDarlingPValue(0.341), 0.50, 0.01);
  EXPECT_NEAR(AndersonDarlingPValue(0.470), 0.25, 0.005);
  EXPECT_NEAR(AndersonDarlingPValue(0.561), 0.15, 0.004);
  EXPECT_NEAR(AndersonDarlingPValue(0.631), 0.10, 0.003);
  EXPECT_NEAR(AndersonDarlingPValue(0.752), 0.05, 0.002);
  EXPECT_NEAR(AndersonDarlingPValue(0.873), 0.025, 0.001);
  EXPECT_NEAR(AndersonDarlingPValue(1.035), 0.01, 0.001);
  EXPECT_NEAR(AndersonDarlingPValue(1.159), 0.005, 0.0005);
  // Falling all the way, without a step where the pieces meet.
  for (double a = 0.0; a < 3.0; a += 0.005) {
    const double fall =
        AndersonDarlingPValue(a) - AndersonDarlingPValue(a + 0.005);
    EXPECT_GT(fall, 0.0) << a;
    EXPECT_LT(fall, 0.02) << a;
  }
  // The published approximation changes its piece at 0.6, 0.34 and 0.2; each
  // belongs to the upper piece.
  EXPECT_NEAR(AndersonDarlingPValue(0.6), 0.11943, 1e-5);
  EXPECT_NEAR(AndersonDarlingPValue(0.34), 0.49823, 1e-5);
  EXPECT_NEAR(AndersonDarlingPValue(0.2), 0.88425, 1e-5);
  EXPECT_LT(AndersonDarlingPValue(1e4), 1e-100);  // where the fit would grow
  EXPECT_TRUE(std::isnan(TestNormality(Eigen::VectorXd::Ones(20)).p_value));
}

// Of 6000 residuals of the right arm five of six are tested, evenly.
TEST(DiagnosticsTest, NormalityOfManyIsThatOfAnEvenSample) {
  const MeasurementModel model(testing::Rv2ajFlange());
  const Dataset data =
      testing::NoisyPositions(model.nominal(), 2000, kSigma, 31);
  const std::vector<int> columns = testing::FlangeFreeColumns(model.layout());
  const Eigen::VectorXd no_priors;
  const std::vector<RobustLoss> losses;
  const Eigen::VectorXd values = model.NominalValues();
  const FittedProblem problem{model, data, columns, no_priors, losses, values};
  const ResidualDiagnostics diagnostics =
      DiagnoseResiduals(problem, CovarianceOf(problem), true, data);
  ASSERT_EQ(diagnostics.studentised.size(), 6000);
  Eigen::VectorXd some(5000);
  for (int k = 0; k < 5000; ++k) {
    some[k] = diagnostics.studentised[k + k / 5];
  }
  const TestResult expected = TestNormality(some);
  EXPECT_NEAR(diagnostics.normality.statistic, expected.statistic, 1e-9);
  EXPECT_GT(expected.p_value, 0.001);
}

// p-values of true normal samples are spread evenly over [0, 1].
TEST(DiagnosticsTest, TrueNormalsFailAsOftenAsTheySay) {
  int failed = 0;
  constexpr int kSamples = 2000;
  for (int sample = 0; sample < kSamples; ++sample) {
    Random random(3, static_cast<std::uint64_t>(sample));
    Eigen::VectorXd values(50);
    for (double& value : values) value = 5.0 + 2.0 * random.Normal();
    failed += TestNormality(values).p_value < 0.05 ? 1 : 0;
  }
  // Binomial: 100 +- 10, four of these.
  EXPECT_NEAR(failed, 100, 40);
}

}  // namespace
}  // namespace alidade::internal::diagnostics_test
