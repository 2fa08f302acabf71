#include "alidade/identifiability/observability.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>

namespace alidade {
namespace {

TEST(ObservabilityTest, IndicesOfKnownSingularValues) {
  const Eigen::Vector3d s(8.0, 4.0, 2.0);
  const ObservabilityIndices indices =
      ComputeObservability(Eigen::MatrixXd(s.asDiagonal()), 16);
  EXPECT_NEAR(indices.o1, 1.0, 1e-14);  // cube root of 64, over sqrt(16)
  EXPECT_NEAR(indices.o2, 0.25, 1e-15);
  EXPECT_NEAR(indices.o3, 2.0, 1e-14);
  EXPECT_NEAR(indices.o4, 0.5, 1e-14);
  EXPECT_NEAR(indices.o5, 8.0 / 7.0, 1e-14);
  EXPECT_NEAR(indices.condition, 4.0, 1e-14);
}

TEST(ObservabilityTest, ShortRankHasZeroIndices) {
  const Eigen::Vector3d s(8.0, 4.0, 0.0);
  const ObservabilityIndices indices =
      ComputeObservability(Eigen::MatrixXd(s.asDiagonal()), 16);
  EXPECT_EQ(indices.o1, 0.0);
  EXPECT_EQ(indices.o5, 0.0);
  EXPECT_TRUE(std::isinf(indices.condition));
}

TEST(PredictDeviationsTest, MatchesTheInverseOfTheInformationMatrix) {
  Eigen::MatrixXd factor = Eigen::MatrixXd::Zero(4, 4);
  factor << 3, 1, -2, 0.5, 0, 2, 0.3, 1, 0, 0, 1.5, -0.7, 0, 0, 0, 0.9;
  Eigen::VectorXd prior(4);
  prior << 0.5, std::numeric_limits<double>::infinity(), 2.0, 0.1;
  const Eigen::MatrixXd information =
      factor.transpose() * factor +
      Eigen::MatrixXd(prior.cwiseInverse().cwiseAbs2().asDiagonal());
  const Eigen::VectorXd expected = information.inverse().diagonal().cwiseSqrt();
  const Eigen::VectorXd deviations = PredictDeviations(factor, prior);
  for (int k = 0; k < 4; ++k) {
    EXPECT_NEAR(deviations[k] / expected[k], 1.0, 1e-12);
  }
}

TEST(PredictDeviationsTest, UntoldParametersAreInfiniteAndOthersAreNot) {
  Eigen::MatrixXd factor = Eigen::MatrixXd::Zero(3, 3);
  factor << 2, 0, 0, 0, 1, 1, 0, 0, 0;
  const Eigen::VectorXd none =
      Eigen::VectorXd::Constant(3, std::numeric_limits<double>::infinity());
  const Eigen::VectorXd deviations = PredictDeviations(factor, none);
  EXPECT_NEAR(deviations[0], 0.5, 1e-14);
  EXPECT_TRUE(std::isinf(deviations[1]));
  EXPECT_TRUE(std::isinf(deviations[2]));
}

}  // namespace
}  // namespace alidade
