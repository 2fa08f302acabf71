#include "src/planning/criterion.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <string>
#include <vector>

#include "src/common/random.h"
#include "src/identifiability/observability.h"
#include "src/planning/plan_fields.h"
#include "tests/planning/planning_test_util.h"

namespace alidade::internal {
namespace {

using testing::RandomRows;

Eigen::MatrixXd Stacked(const PoseRows& rows) {
  return rows.transposed.transpose();
}

class CriterionTest : public ::testing::Test {
 protected:
  double Value(const std::string& name) const {
    return CriterionValue(ValueOf<DesignCriterion>(name), information_,
                          region_);
  }

  Random random_{5};
  const PoseRows rows_ = RandomRows(4, 3, 10, &random_);
  const PoseRows region_ = RandomRows(4, 3, 6, &random_);
  const Eigen::MatrixXd information_ =
      Stacked(rows_).transpose() * Stacked(rows_);
};

// The indices of another module, from singular values.
TEST_F(CriterionTest, AgreesWithTheObservabilityIndices) {
  const ObservabilityIndices indices =
      ComputeObservability(Stacked(rows_), rows_.size());
  EXPECT_NEAR(Value("D"), 2.0 * std::log(indices.o1 * std::sqrt(rows_.size())),
              1e-12);
  EXPECT_EQ(Value("D"), Value("O1"));
  EXPECT_NEAR(Value("O2"), std::log(indices.o2), 1e-12);
  EXPECT_NEAR(Value("O3"), std::log(indices.o3), 1e-12);
  EXPECT_NEAR(Value("E"), 2.0 * std::log(indices.o3), 1e-12);
  EXPECT_NEAR(Value("O4"), std::log(indices.o4), 1e-12);
  EXPECT_NEAR(Value("O5"), std::log(indices.o5), 1e-12);
}

TEST_F(CriterionTest, VariancesAreThoseOfTheInverse) {
  const Eigen::MatrixXd inverse = information_.fullPivLu().inverse();
  EXPECT_NEAR(Value("A"), -std::log(inverse.trace()), 1e-12);
  double sum = 0.0;
  double worst = 0.0;
  for (int x = 0; x < region_.size(); ++x) {
    const Eigen::MatrixXd w = region_.Pose(x).transpose();
    const double variance = (w * inverse * w.transpose()).trace();
    sum += variance;
    worst = std::max(worst, variance);
  }
  EXPECT_NEAR(Value("I"), -std::log(sum / region_.size()), 1e-12);
  EXPECT_NEAR(Value("G"), -std::log(worst), 1e-12);
}

TEST_F(CriterionTest, SingularInformationIsMinusInfinity) {
  Eigen::MatrixXd singular = information_;
  singular.row(2).setZero();
  singular.col(2).setZero();
  for (const std::string& name : WordsOf<DesignCriterion>()) {
    EXPECT_EQ(CriterionValue(ValueOf<DesignCriterion>(name), singular, region_),
              -INFINITY)
        << name;
  }
}

// A slope scores candidates in proportion to what a little of each adds. The
// soft criteria are left out: their slopes look at more than the extreme.
TEST_F(CriterionTest, SlopesAreDerivatives) {
  constexpr double kStep = 1e-7;
  const PoseRows candidates = RandomRows(4, 3, 5, &random_);
  for (const char* name : {"A", "I", "O5"}) {
    const DesignCriterion criterion = ValueOf<DesignCriterion>(name);
    const DesignSlope slope = SlopeOf(criterion, information_, region_);
    double first_ratio = 0.0;
    for (int k = 0; k < candidates.size(); ++k) {
      const Eigen::MatrixXd rows = candidates.Pose(k);
      const double score = slope.weights.dot(
          (slope.factor.transpose() * rows).rowwise().squaredNorm());
      const double gain =
          (CriterionValue(criterion,
                          information_ + kStep * rows * rows.transpose(),
                          region_) -
           CriterionValue(criterion, information_, region_)) /
          kStep;
      if (k == 0) first_ratio = gain / score;
      EXPECT_GT(score, 0.0);
      EXPECT_NEAR(gain / score / first_ratio, 1.0, 1e-5) << name;
    }
  }
}

}  // namespace
}  // namespace alidade::internal
