#include "src/uncertainty/nonlinearity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <vector>

#include "src/common/constants.h"
#include "src/kernel/reduction.h"

namespace alidade::internal {
namespace {

constexpr double kRadius = 0.5;

// One joint whose target is measured once: polar coordinates of a point in the
// plane, which is all that can be worked out by hand.
class Polar {
 public:
  // `bend`: sigma over the radius.
  explicit Polar(double bend) : sigma_(bend * kRadius), model_(MakeArm()) {
    data_ = MakePositions(Eigen::MatrixXd::Zero(1, 1),
                          Eigen::Vector3d(kRadius, 0.0, 0.0),
                          Eigen::Vector3d(sigma_, sigma_, kInfinity));
    values_ = model_.NominalValues();
    angle_ = model_.layout().Find("theta1").value();
    radius_ = model_.layout().Find("tool_x").value();
    columns_ = {angle_, radius_};
  }

  FittedProblem problem() const {
    return {model_, data_, columns_, no_priors_, losses_, values_};
  }
  ParameterCovariance covariance() const { return CovarianceOf(problem()); }
  double sigma() const { return sigma_; }

  // Over the radius for a held angle, and the other way round.
  Resolve resolve() const {
    return [this](int fixed, Eigen::VectorXd* values) -> std::optional<double> {
      if (fixed == angle_) {
        const double angle = (*values)[angle_];
        (*values)[radius_] = kRadius * std::cos(angle);
        return std::pow(kRadius * std::sin(angle) / sigma_, 2);
      }
      (*values)[angle_] = 0.0;
      return std::pow(((*values)[radius_] - kRadius) / sigma_, 2);
    };
  }

 private:
  static Arm MakeArm() {
    Arm arm;
    arm.name = "polar";
    arm.joints.resize(1);
    arm.targets[0].last_from_target.translation().x() = kRadius;
    return arm;
  }

  double sigma_;
  MeasurementModel model_;
  Dataset data_;
  Eigen::VectorXd values_;
  std::vector<int> columns_;
  const Eigen::VectorXd no_priors_;
  const std::vector<RobustLoss> losses_;
  int angle_ = 0;
  int radius_ = 0;
};

// With e = sigma / radius the second derivatives in standard deviations are
// (0, e) for one step of each and (-e, 0) for two of the angle, so that the
// measure is e for the angle and e sqrt(3) / 2 for the radius. Differences over
// one standard deviation: relative error e^2.
TEST(NonlinearityTest, IsThatOfPolarCoordinates) {
  for (const double bend : {0.001, 0.02}) {
    const Polar polar(bend);
    const Eigen::VectorXd measured =
        MeasureNonlinearity(polar.problem(), polar.covariance());
    EXPECT_NEAR(measured[0], bend, bend * (bend * bend + 1e-9));
    EXPECT_NEAR(measured[1], bend * std::sqrt(0.75),
                bend * (bend * bend + 1e-9));
  }
}

// Where the angle is held at t, the best radius leaves radius sin(t) of error.
TEST(NonlinearityTest, ProfileBendsWithTheModel) {
  const Polar polar(0.3);
  const double quantile = 1.96;
  const ConfidenceInterval angle = ProfileInterval(
      polar.problem(), polar.covariance(), 0, quantile, 0.0, polar.resolve());
  EXPECT_TRUE(angle.is_profile);
  EXPECT_NEAR(angle.upper, std::asin(0.3 * quantile), 2e-4);
  EXPECT_NEAR(angle.lower, -angle.upper, 1e-9);
  EXPECT_GT(angle.upper, 1.05 * 0.3 * quantile);
  const ConfidenceInterval radius = ProfileInterval(
      polar.problem(), polar.covariance(), 1, quantile, 0.0, polar.resolve());
  EXPECT_NEAR(radius.upper - kRadius, quantile * polar.sigma(), 1e-6);
}

// Growth beyond the cost of the fit counts, whatever that is.
TEST(NonlinearityTest, ProfileIsOfTheGrowthOfTheCost) {
  const Polar polar(0.3);
  const Resolve raised = [&](int fixed, Eigen::VectorXd* values) {
    return std::optional<double>(*polar.resolve()(fixed, values) + 50.0);
  };
  const ConfidenceInterval angle = ProfileInterval(
      polar.problem(), polar.covariance(), 0, 1.96, 50.0, raised);
  EXPECT_NEAR(angle.upper, std::asin(0.3 * 1.96), 2e-4);
  EXPECT_NEAR(angle.lower, -angle.upper, 1e-9);
}

// The cost grows faster than a parabola, so that the linear bound lies beyond
// the profile's. Secants find the crossing from both sides, without halving.
TEST(NonlinearityTest, ProfileIsFoundInAFewSolves) {
  const Polar polar(0.3);
  const ParameterCovariance covariance = polar.covariance();
  const double deviation = covariance.Deviations()[1];
  int solves = 0;
  const Resolve steep = [&](int fixed, Eigen::VectorXd* values) {
    ++solves;
    const double z = ((*values)[fixed] - kRadius) / deviation;
    // 2 at |z| = 1.423318 (cubic equation). The root of a bound is within 1e-4
    // of the quantile, over a slope of 2.2: 9e-5.
    const double root = std::abs(z) * (1.0 + 0.2 * z * z);
    return std::optional<double>(root * root);
  };
  const ConfidenceInterval radius =
      ProfileInterval(polar.problem(), covariance, 1, 2.0, 0.0, steep);
  EXPECT_NEAR((radius.upper - kRadius) / deviation, 1.423318, 1e-4);
  EXPECT_NEAR((kRadius - radius.lower) / deviation, 1.423318, 1e-4);
  EXPECT_LE(solves, 12);  // six a side; halving takes eight
}

// An error of the size of the radius leaves any angle possible.
TEST(NonlinearityTest, ProfileWithoutEndIsInfinite) {
  const Polar polar(0.7);
  const ConfidenceInterval angle = ProfileInterval(
      polar.problem(), polar.covariance(), 0, 1.96, 0.0, polar.resolve());
  EXPECT_EQ(angle.lower, -kInfinity);
  EXPECT_EQ(angle.upper, kInfinity);
}

}  // namespace
}  // namespace alidade::internal
