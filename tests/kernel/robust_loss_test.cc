#include "alidade/robust_loss.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <vector>

#include "src/common/distributions.h"
#include "src/common/random.h"

namespace alidade::internal {
namespace {

constexpr LossKind kRobustKinds[] = {LossKind::kHuber, LossKind::kCauchy,
                                     LossKind::kTukey};

Eigen::VectorXd RandomNormal(int dimension, Random* random) {
  return Eigen::VectorXd::NullaryExpr(dimension,
                                      [&] { return random->Normal(); });
}

TEST(RobustLossTest, ValuesOfTheDefinitions) {
  double rho[3];
  RobustLoss{LossKind::kNone}.Evaluate(7.0, rho);
  EXPECT_EQ(rho[0], 7.0);
  EXPECT_EQ(rho[1], 1.0);
  EXPECT_EQ(rho[2], 0.0);
  RobustLoss{LossKind::kHuber, 2.0}.Evaluate(3.0, rho);
  EXPECT_EQ(rho[0], 3.0);
  RobustLoss{LossKind::kHuber, 2.0}.Evaluate(25.0, rho);
  EXPECT_NEAR(rho[0], 2.0 * 2.0 * 5.0 - 4.0, 1e-14);
  RobustLoss{LossKind::kCauchy, 2.0}.Evaluate(25.0, rho);
  EXPECT_NEAR(rho[0], 4.0 * std::log(1.0 + 25.0 / 4.0), 1e-14);
  RobustLoss{LossKind::kTukey, 2.0}.Evaluate(1.0, rho);
  EXPECT_NEAR(rho[0], 4.0 / 3.0 * (1.0 - std::pow(0.75, 3)), 1e-15);
  RobustLoss{LossKind::kTukey, 2.0}.Evaluate(25.0, rho);
  EXPECT_NEAR(rho[0], 4.0 / 3.0, 1e-15);
}

TEST(RobustLossTest, DerivativesAreThoseOfTheValue) {
  for (const LossKind kind : kRobustKinds) {
    const RobustLoss loss{kind, 1.7};
    for (const double s : {0.1, 1.0, 2.8, 3.0, 30.0, 3000.0}) {
      const double step = 1e-5 * s;
      double rho[3];
      double below[3];
      double above[3];
      loss.Evaluate(s, rho);
      loss.Evaluate(s - step, below);
      loss.Evaluate(s + step, above);
      // Rounding of the difference, 1e-16 / 1e-5, dominates.
      EXPECT_NEAR((above[0] - below[0]) / (2.0 * step), rho[1], 1e-9);
      EXPECT_NEAR((above[1] - below[1]) / (2.0 * step), rho[2], 1e-9);
      EXPECT_EQ(loss.Weight(s), rho[1]);
      EXPECT_LE(rho[2], 0.0);
      EXPECT_GE(rho[1], 0.0);
    }
  }
}

TEST(RobustLossTest, IsSquaresForSmallResiduals) {
  for (const LossKind kind : kRobustKinds) {
    double rho[3];
    RobustLoss{kind, 1.7}.Evaluate(0.0, rho);
    EXPECT_EQ(rho[0], 0.0);
    EXPECT_EQ(rho[1], 1.0);
    // The term of s^2 is below the rounding of rho = s.
    RobustLoss{kind, 1.7}.Evaluate(1e-20, rho);
    EXPECT_NEAR(rho[0] / 1e-20, 1.0, 1e-15);
  }
}

TEST(RobustLossTest, ValueAndWeightAreContinuousAtTheConstant) {
  for (const LossKind kind : kRobustKinds) {
    const double c = 1.7;
    double below[3];
    double above[3];
    RobustLoss{kind, c}.Evaluate(c * c * (1.0 - 1e-12), below);
    RobustLoss{kind, c}.Evaluate(c * c * (1.0 + 1e-12), above);
    EXPECT_NEAR(below[0], above[0], 1e-11);
    EXPECT_NEAR(below[1], above[1], 1e-11);
    // Huber's weight has a kink of known size there.
    const double jump = kind == LossKind::kHuber ? -0.5 / (c * c) : 0.0;
    EXPECT_NEAR(above[2] - below[2], jump, 1e-11);
  }
}

TEST(RobustLossTest, GrossErrorsStayFinite) {
  const double s = 1e200;
  double rho[3];
  RobustLoss{LossKind::kHuber, 1.5}.Evaluate(s, rho);
  EXPECT_NEAR(rho[0] / 3e100, 1.0, 1e-15);
  EXPECT_NEAR(rho[1] / 1.5e-100, 1.0, 1e-15);
  RobustLoss{LossKind::kCauchy, 2.0}.Evaluate(s, rho);
  EXPECT_NEAR(rho[0], 4.0 * (200.0 * std::log(10.0) - std::log(4.0)), 1e-11);
  EXPECT_NEAR(rho[1] / 4e-200, 1.0, 1e-15);
  RobustLoss{LossKind::kTukey, 3.0}.Evaluate(s, rho);
  EXPECT_EQ(rho[0], 3.0);
  EXPECT_EQ(rho[1], 0.0);
  EXPECT_EQ(rho[2], 0.0);
}

// Holland and Welsch 1977, "Robust regression using iteratively reweighted
// least-squares": three decimals.
TEST(TuningConstantTest, PublishedForOneDimension) {
  EXPECT_NEAR(TuningConstant(LossKind::kHuber, 1), 1.345, 5e-4);
  EXPECT_NEAR(TuningConstant(LossKind::kCauchy, 1), 2.385, 5e-4);
  EXPECT_NEAR(TuningConstant(LossKind::kTukey, 1), 4.685, 5e-4);
  EXPECT_EQ(TuningConstant(LossKind::kNone, 1),
            std::numeric_limits<double>::infinity());
}

// E[s^k; s < bound] for s chi-square with d degrees of freedom.
double TruncatedMoment(double k, double bound, int d) {
  return std::exp2(k) * std::tgamma(0.5 * d + k) / std::tgamma(0.5 * d) *
         ChiSquareCdf(bound, d + 2.0 * k);
}

// By Stein's identity E[w + |r| w' / d] = E[w |r|^2] / d, which has no
// derivative, so that eff = E[w |r|^2]^2 / (d E[w^2 |r|^2]).
TEST(TuningConstantTest, HuberIsEfficientByClosedForm) {
  for (int d = 1; d <= 8; ++d) {
    const double c = TuningConstant(LossKind::kHuber, d);
    const double norm_beyond = std::sqrt(2.0) * std::tgamma(0.5 * (d + 1)) /
                               std::tgamma(0.5 * d) *
                               ChiSquareSurvival(c * c, d + 1.0);
    const double inside = TruncatedMoment(1.0, c * c, d);
    const double slope = inside + c * norm_beyond;
    const double influence = inside + c * c * ChiSquareSurvival(c * c, d);
    EXPECT_NEAR(slope * slope / (d * influence), 0.95, 1e-10) << d;
  }
}

TEST(TuningConstantTest, TukeyIsEfficientByClosedForm) {
  const double kBinomial[] = {1.0, -4.0, 6.0, -4.0, 1.0};
  for (const int d : {1, 2, 3, 4, 5, 6, 30, 60}) {
    const double c = TuningConstant(LossKind::kTukey, d);
    double slope = 0.0;
    double influence = 0.0;
    for (int k = 0; k <= 4; ++k) {
      const double moment =
          TruncatedMoment(k + 1.0, c * c, d) / std::pow(c, 2 * k);
      influence += kBinomial[k] * moment;
      if (k <= 2) slope += (k == 1 ? -2.0 : 1.0) * moment;
    }
    EXPECT_NEAR(slope * slope / (d * influence), 0.95, 1e-10) << d;
  }
}

// The trapezoidal rule over log s, whose error falls exponentially.
TEST(TuningConstantTest, CauchyIsEfficientByAnotherQuadrature) {
  for (int d = 1; d <= 8; ++d) {
    const double c = TuningConstant(LossKind::kCauchy, d);
    double one = 0.0;
    double slope = 0.0;
    double influence = 0.0;
    for (double t = -60.0; t < 6.0; t += 1.0 / 64.0) {
      const double s = std::exp(t);
      const double w = 1.0 / (1.0 + s / (c * c));
      const double density = std::exp(0.5 * d * t - 0.5 * s);
      one += density;
      slope += density * w * s;
      influence += density * w * w * s;
    }
    EXPECT_NEAR(slope * slope / (d * one * influence), 0.95, 1e-10) << d;
  }
}

// From the definition: how much the M-estimate of a mean varies.
TEST(TuningConstantTest, EstimatesVaryFivePercentMoreThanMeans) {
  constexpr int kTrials = 2000;
  constexpr int kSamples = 100;
  for (const LossKind kind : kRobustKinds) {
    const RobustLoss loss{kind, TuningConstant(kind, 3)};
    Random random(11);
    double of_means = 0.0;
    double of_estimates = 0.0;
    for (int trial = 0; trial < kTrials; ++trial) {
      Eigen::Matrix3Xd samples(3, kSamples);
      for (int k = 0; k < kSamples; ++k) {
        samples.col(k) = RandomNormal(3, &random);
      }
      const Eigen::Vector3d mean = samples.rowwise().mean();
      Eigen::Vector3d estimate = mean;
      for (int iteration = 0; iteration < 20; ++iteration) {
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        double weights = 0.0;
        for (int k = 0; k < kSamples; ++k) {
          const double weight =
              loss.Weight((samples.col(k) - estimate).squaredNorm());
          sum += weight * samples.col(k);
          weights += weight;
        }
        estimate = sum / weights;
      }
      of_means += mean.squaredNorm();
      of_estimates += estimate.squaredNorm();
    }
    // The standard error is 0.6 %, since both see the same samples:
    // 2 sqrt(0.05 / 6000). Terms of order 1 / kSamples add to it.
    EXPECT_NEAR(of_means / of_estimates, 0.95, 0.015);
  }
}

TEST(TuningConstantTest, ThereIsOneOfEachNumberOfRows) {
  for (const LossKind kind : kRobustKinds) {
    const std::vector<RobustLoss> losses = TunedLosses(kind);
    ASSERT_EQ(losses.size(), 6U);
    for (int dimension = 1; dimension <= 6; ++dimension) {
      EXPECT_EQ(losses[dimension - 1].kind, kind);
      EXPECT_EQ(losses[dimension - 1].tuning_constant,
                TuningConstant(kind, dimension));
    }
  }
}

TEST(TuningConstantTest, ManyDimensionsGiveTheLowerEnd) {
  EXPECT_EQ(TuningConstant(LossKind::kHuber, 12), 0.1 * MedianOfChi(12));
  EXPECT_EQ(TuningConstant(LossKind::kCauchy, 60), 0.1 * MedianOfChi(60));
}

TEST(RobustScaleTest, MedianOfChiIsThatOfKnownDistributions) {
  EXPECT_NEAR(MedianOfChi(1), 0.674489750196082, 1e-14);
  EXPECT_NEAR(MedianOfChi(2), std::sqrt(2.0 * std::log(2.0)), 1e-14);
  EXPECT_NEAR(std::pow(MedianOfChi(3), 2), 2.36597, 5e-6);  // tabulated
}

TEST(RobustScaleTest, MedianOfOddEvenAndNone) {
  EXPECT_EQ(RobustScale({}, 3), 0.0);
  EXPECT_NEAR(RobustScale({4.0, 1.0, 9.0}, 1) * MedianOfChi(1), 4.0, 1e-15);
  EXPECT_NEAR(RobustScale({9.0, 1.0, 5.0, 2.0}, 1) * MedianOfChi(1), 3.5,
              1e-15);
}

TEST(RobustScaleTest, FindsTheFactorOfGaussianResiduals) {
  for (const int dimension : {1, 3, 6}) {
    Random random(5);
    std::vector<double> norms;
    for (int k = 0; k < 20000; ++k) {
      norms.push_back(2.5 * RandomNormal(dimension, &random).norm());
    }
    // Five standard errors of a median in one dimension, 1.17 / sqrt(20000)
    // each; less in more.
    EXPECT_NEAR(RobustScale(norms, dimension) / 2.5, 1.0, 0.041);
  }
}

TEST(RobustScaleTest, OutliersRaiseItNoFurtherThanTheirShareTells) {
  for (const double gross : {1e2, 1e12}) {
    Random random(6);
    std::vector<double> norms;
    for (int k = 0; k < 20000; ++k) {
      const double factor = k % 5 < 2 ? gross : 1.0;
      norms.push_back(factor * (RandomNormal(3, &random).norm() +
                                (factor > 1.0 ? 1.0 : 0.0)));
    }
    // All outliers are above: the median is the 5/6 quantile of the others.
    const double expected =
        std::sqrt(ChiSquareQuantile(5.0 / 6.0, 3.0)) / MedianOfChi(3);
    EXPECT_NEAR(RobustScale(norms, 3) / expected, 1.0, 0.03);
  }
}

}  // namespace
}  // namespace alidade::internal
