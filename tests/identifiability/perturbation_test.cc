#include "src/identifiability/perturbation.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>

#include "src/common/random.h"
#include "tests/support/random_arms.h"

namespace alidade::internal {
namespace {

constexpr int kDraws = 200;

// Even draws of +-size: mean 0, standard deviation size / sqrt(3), none beyond;
// of 200 the largest is above nine tenths of it, with a chance of 1e-9 that it
// is not.
void ExpectEvenDraws(const Eigen::VectorXd& moves, double size) {
  EXPECT_NEAR(moves.mean(), 0.0, 0.2 * size);
  EXPECT_NEAR(moves.norm() / std::sqrt(kDraws), size / std::sqrt(3.0),
              0.1 * size);
  EXPECT_LE(moves.cwiseAbs().maxCoeff(), size * (1.0 + 1e-9));
  EXPECT_GE(moves.maxCoeff(), 0.9 * size);
  EXPECT_LE(moves.minCoeff(), -0.9 * size);
}

TEST(PerturbedValuesTest, MoveCandidatesEvenlyToBothSides) {
  Random random(440);
  const MeasurementModel model(testing::RandomArm(3, &random));
  IdentifiabilityOptions options;
  options.perturbation = 0.01;
  options.candidates.base = true;
  options.candidates.tool = false;
  Eigen::MatrixXd moves(model.layout().size(), kDraws);
  for (int draw = 0; draw < kDraws; ++draw) {
    moves.col(draw) =
        PerturbedValues(model, options, draw) - model.NominalValues();
  }
  const double reach = ArmReach(model.nominal());
  for (int c = 0; c < model.layout().size(); ++c) {
    const Parameter& parameter = model.layout().parameter(c);
    SCOPED_TRACE(parameter.name);
    if (parameter.name.find("tool") == 0) {
      EXPECT_TRUE(moves.row(c).isZero(0.0));
      continue;
    }
    const double unit = parameter.dimension == Dimension::kAngle ? 1.0 : reach;
    ExpectEvenDraws(moves.row(c), 0.01 * unit);
  }
}

TEST(PerturbedValuesTest, EachColumnHasItsSize) {
  Random random(441);
  const MeasurementModel model(testing::RandomArm(2, &random));
  Eigen::VectorXd sizes = Eigen::VectorXd::Zero(model.layout().size());
  sizes[1] = 0.5;
  sizes[7] = 2.0;
  Eigen::MatrixXd moves(sizes.size(), kDraws);
  for (int draw = 0; draw < kDraws; ++draw) {
    moves.col(draw) =
        PerturbedValues(model, sizes, draw) - model.NominalValues();
  }
  ExpectEvenDraws(moves.row(1), 0.5);
  ExpectEvenDraws(moves.row(7), 2.0);
  moves.row(1).setZero();
  moves.row(7).setZero();
  EXPECT_TRUE(moves.isZero(0.0));
}

}  // namespace
}  // namespace alidade::internal
