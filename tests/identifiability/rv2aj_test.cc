#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cstdint>
#include <string>
#include <vector>

#include "src/common/random.h"
#include "src/identifiability/rules.h"
#include "tests/identifiability/rules_test_util.h"
#include "tests/support/reference_solution.h"
#include "tests/support/rv2aj_arms.h"
#include "tests/support/study.h"

namespace alidade::internal {
namespace {

using testing::DecisionOn;
using testing::FixedBy;
using testing::Names;
using testing::WithReason;

// The reference's rank of the free columns at slightly different geometries.
Eigen::Index PerturbedReferenceRank(const Arm& arm, const Dataset& data,
                                    const std::vector<int>& columns) {
  Random random(5);
  testing::VectorXl values = testing::MatrixValues(arm);
  for (const int column : testing::JointColumns(ParameterLayout(5))) {
    values[column] += 5e-3L * random.Uniform(-1.0, 1.0);
  }
  return (testing::RelativeSingularValues(
              testing::ScaledDifferences(arm, values, data, columns))
              .array() > 1e-6L)
      .count();
}

Eigen::Index ReferenceRank(const Arm& arm, const Dataset& data,
                           const std::vector<int>& columns) {
  const testing::MatrixXl jacobian = testing::ScaledDifferences(
      arm, testing::MatrixValues(arm), data, columns);
  // In the plane, joint values of four decimals leave 1e-7 of the largest
  // singular value; the smallest that counts is 1e-3.
  Eigen::FullPivLU<testing::MatrixXl> lu(jacobian);
  lu.setThreshold(1e-5L);
  EXPECT_EQ(
      lu.rank(),
      (testing::RelativeSingularValues(jacobian).array() > 1e-5L).count());
  return lu.rank();
}

class Rv2ajStudyTest : public ::testing::TestWithParam<int> {
 protected:
  static testing::Measurement Seed() {
    return {static_cast<std::uint64_t>(GetParam()), 0.0};
  }

  const MeasurementModel wrist_{testing::Rv2ajWrist()};
  const MeasurementModel flange_{testing::Rv2ajFlange()};
};

TEST_P(Rv2ajStudyTest, WristFreezesTheEightOfTheStudy) {
  const IdentifiabilityResult result = ApplyRules(
      wrist_, testing::MeasureStudyPoses(wrist_.nominal(), Seed()), {});
  EXPECT_EQ(FixedBy(result, "beta_rule"), (Names{"beta2", "beta5"}));
  EXPECT_EQ(FixedBy(result, "zero_column"),
            (Names{"alpha4", "alpha5", "theta4", "theta5"}));
  EXPECT_EQ(FixedBy(result, "parallel_r"), (Names{"r3", "r4"}));
  EXPECT_EQ(result.num_free, 17);
  EXPECT_EQ(DecisionOn(result, "r2").identified_combination, "r2 + r3 + r4");
  EXPECT_EQ(WithReason(result, "its column is zero"),
            (Names{"beta5", "alpha4", "alpha5", "theta4", "theta5"}));
}

TEST_P(Rv2ajStudyTest, WristHasTwoParametersOnlySecondOrderEffectsTell) {
  const Dataset data = testing::MeasureStudyPoses(wrist_.nominal(), Seed());
  const IdentifiabilityResult result = ApplyRules(wrist_, data, {});
  const std::vector<int> free = FreeColumns(result);
  EXPECT_EQ(result.nominal_rank.rank, 15);
  EXPECT_EQ(ReferenceRank(wrist_.nominal(), data, free), 15);
  EXPECT_EQ(result.perturbed_rank.rank, 17);
  EXPECT_EQ(PerturbedReferenceRank(wrist_.nominal(), data, free), 17);
  EXPECT_FALSE(result.exceeds_rank);
  EXPECT_EQ(result.refusal, "");
  EXPECT_EQ(result.weak, (Names{"alpha2", "beta4"}));
  ASSERT_EQ(result.warnings.size(), 1U);
  const std::string& warning = result.warnings[0];
  EXPECT_NE(warning.find("only 15 of 17 parameters"), std::string::npos)
      << warning;
  EXPECT_NE(warning.find("alpha2 is linearly dependent on 85 mm * r2;"),
            std::string::npos)
      << warning;
  EXPECT_NE(warning.find("beta4 is linearly dependent on -160 mm * r2)"),
            std::string::npos)
      << warning;
}

TEST_P(Rv2ajStudyTest, WristOverGenericPosesLacksOneRank) {
  const Dataset data = testing::MeasureGenericPoses(
      wrist_.nominal(), wrist_.NominalValues(), 60, Seed());
  const IdentifiabilityResult result = ApplyRules(wrist_, data, {});
  EXPECT_EQ(result.num_free, 17);
  EXPECT_EQ(result.nominal_rank.rank, 16);
  EXPECT_EQ(ReferenceRank(wrist_.nominal(), data, FreeColumns(result)), 16);
  EXPECT_EQ(result.weak, Names{"beta4"});
}

TEST_P(Rv2ajStudyTest, FlangeHasTwoZeroColumnsAndIsRefused) {
  const Dataset data = testing::MeasureStudyPoses(flange_.nominal(), Seed());
  const IdentifiabilityResult result = ApplyRules(flange_, data, {});
  EXPECT_EQ(WithReason(result, "its column is zero"),
            (Names{"beta5", "theta5"}));
  EXPECT_EQ(testing::ZeroColumns(flange_.nominal(), data),
            (Names{"beta5", "theta5"}));
  EXPECT_EQ(result.num_free, 20);
  EXPECT_EQ(result.perturbed_rank.rank, 18);
  EXPECT_EQ(
      PerturbedReferenceRank(flange_.nominal(), data, FreeColumns(result)), 18);
  EXPECT_TRUE(result.exceeds_rank);
  EXPECT_NE(result.refusal.find("alpha5"), std::string::npos) << result.refusal;
  EXPECT_NE(result.refusal.find("theta4"), std::string::npos) << result.refusal;
  EXPECT_NE(result.refusal.find("geometry: theta4, alpha5 depend"),
            std::string::npos)
      << result.refusal;
  EXPECT_NE(result.refusal.find("keep 20 parameters"), std::string::npos);
  EXPECT_NE(result.refusal.find("only 18"), std::string::npos);
}

TEST_P(Rv2ajStudyTest, FollowingTheRefusalOfTheFlangeResolvesIt) {
  testing::ExpectFollowingTheRefusalHelps(
      flange_, testing::MeasureStudyPoses(flange_.nominal(), Seed()));
}

TEST_P(Rv2ajStudyTest, FlangeIsSolvableOnceTheUserFixesTwo) {
  IdentifiabilityOptions options;
  options.fix = {"alpha5", "theta4"};
  const Dataset plane = testing::MeasureStudyPoses(flange_.nominal(), Seed());
  const IdentifiabilityResult in_plane = ApplyRules(flange_, plane, options);
  EXPECT_EQ(in_plane.num_free, 18);
  EXPECT_FALSE(in_plane.exceeds_rank);
  EXPECT_EQ(in_plane.weak, Names{"alpha2"});
  const Dataset generic = testing::MeasureGenericPoses(
      flange_.nominal(), flange_.NominalValues(), 60, Seed());
  const IdentifiabilityResult result = ApplyRules(flange_, generic, options);
  EXPECT_EQ(result.num_free, 18);
  EXPECT_FALSE(result.exceeds_rank);
  EXPECT_EQ(result.nominal_rank.rank, 18);
  EXPECT_EQ(ReferenceRank(flange_.nominal(), generic, FreeColumns(result)), 18);
  EXPECT_TRUE(result.weak.empty());
  EXPECT_TRUE(result.warnings.empty());
}

INSTANTIATE_TEST_SUITE_P(Seeds, Rv2ajStudyTest, ::testing::Values(1, 2, 3));

}  // namespace
}  // namespace alidade::internal
