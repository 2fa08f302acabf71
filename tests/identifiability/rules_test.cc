#include "src/identifiability/rules.h"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "alidade/units.h"
#include "src/common/random.h"
#include "src/identifiability/perturbation.h"
#include "src/identifiability/rank.h"
#include "tests/identifiability/rules_test_util.h"
#include "tests/support/edit.h"
#include "tests/support/random_arms.h"
#include "tests/support/random_datasets.h"
#include "tests/support/reference_solution.h"
#include "tests/support/rv2aj_arms.h"
#include "tests/support/study.h"

namespace alidade::internal::rules_test {
namespace {

using testing::DecisionOn;
using testing::FixedBy;
using testing::Names;
using testing::WithReason;

// A chain without any column that is zero.
Joint GenericJoint(int index) {
  Joint joint;
  joint.d = 0.1 + 0.01 * index;
  joint.theta = 0.3 * index;
  joint.r = 0.2 - 0.02 * index;
  joint.lower = -2.0;
  joint.upper = 2.0;
  return joint;
}

Arm ChainWithAlphas(const std::vector<double>& alphas) {
  Arm arm;
  for (const double alpha : alphas) {
    arm.joints.push_back(GenericJoint(arm.num_joints() + 1));
    arm.joints.back().alpha = alpha;
  }
  arm.last_from_target().translation() = Eigen::Vector3d(0.05, 0.02, 0.11);
  return arm;
}

Dataset GenericPoses(const Arm& arm) {
  Random random(77);
  return testing::RandomDataset(
      arm, ParameterLayout(arm.num_joints()).Values(arm), 40, &random);
}

IdentifiabilityResult Analyze(const Arm& arm,
                              const IdentifiabilityOptions& options = {}) {
  return ApplyRules(MeasurementModel(arm), GenericPoses(arm), options);
}

TEST(BetaRuleTest, FreezesBetaWhereAxesAreNotParallel) {
  const Arm arm =
      ChainWithAlphas({0.5 * kPi, 0.0, kPi, -kPi, 0.3, -0.5 * kPi, 1e-9});
  const IdentifiabilityResult result = Analyze(arm);
  EXPECT_EQ(FixedBy(result, "beta_rule"), (Names{"beta1", "beta5", "beta6"}));
  for (const char* name : {"beta2", "beta3", "beta4", "beta7"}) {
    EXPECT_EQ(DecisionOn(result, name).state, ParameterState::kFree) << name;
  }
  EXPECT_EQ(DecisionOn(result, "beta5").reason,
            "axis 5 is not parallel to axis 4 (sin alpha5 is not 0), where "
            "beta is not needed");
}

TEST(BetaRuleTest, HoldsForPrismaticJoints) {
  Arm arm = ChainWithAlphas({0.0, 0.4, 0.0});
  for (Joint& joint : arm.joints) joint.type = JointType::kPrismatic;
  EXPECT_EQ(FixedBy(Analyze(arm), "beta_rule"), Names{"beta2"});
}

TEST(BetaRuleTest, ToleranceIsOfTheSineAboutZeroAndPi) {
  for (const double tolerance : {1e-6, 1e-3, 0.05}) {
    IdentifiabilityOptions options;
    options.angle_tolerance = tolerance;
    for (const double parallel : {0.0, kPi, -kPi}) {
      for (const double side : {-1.0, 1.0}) {
        const double inside = parallel + side * 0.99 * tolerance;
        const double outside = parallel + side * 1.01 * tolerance;
        const IdentifiabilityResult result =
            Analyze(ChainWithAlphas({inside, outside}), options);
        EXPECT_EQ(FixedBy(result, "beta_rule"), Names{"beta2"})
            << parallel << ", " << side * tolerance;
      }
    }
  }
}

TEST(ZeroColumnRuleTest, FindsTheZeroColumnsOfTheReference) {
  testing::RandomArmOptions arm_options;
  arm_options.with_frames = false;
  for (int num_joints = 1; num_joints <= 6; ++num_joints) {
    Random random(81, num_joints);
    Arm arm = testing::RandomArm(num_joints, &random, arm_options);
    // A wrist at the end: the last axis meets the target.
    arm.joints.back().type = JointType::kRevolute;
    arm.joints.back().d = 0.0;
    arm.joints.back().r = 0.0;
    const Dataset data = testing::RandomDataset(
        arm, testing::MatrixValues(arm).cast<double>(), 20, &random);
    const Names expected = testing::ZeroColumns(arm, data);
    EXPECT_GE(expected.size(), 3U);
    EXPECT_EQ(WithReason(ApplyRules(MeasurementModel(arm), data, {}),
                         "its column is zero: no measured position moves with "
                         "it"),
              expected)
        << num_joints;
  }
}

TEST(ZeroColumnRuleTest, FreezesNothingWhereTheTargetIsOffEveryAxis) {
  const Arm arm = ChainWithAlphas({0.1, 0.5 * kPi, 0.0, kPi});
  EXPECT_EQ(FixedBy(Analyze(arm), "zero_column"), Names{});
}

// The target of a sliding joint lies on the x axis that alpha turns about, as
// long as the joint does not slide.
TEST(ZeroColumnRuleTest, LooksAtTheMeasuredPosesOnly) {
  Arm arm = ChainWithAlphas({0.5 * kPi, 0.0});
  arm.joints[1].type = JointType::kPrismatic;
  arm.joints[1].r = 0.0;
  arm.last_from_target().setIdentity();
  Dataset data = GenericPoses(arm);
  EXPECT_EQ(FixedBy(ApplyRules(MeasurementModel(arm), data, {}), "zero_column"),
            Names{"theta2"});
  testing::Edit(&data.joint_values)->row(1).setZero();
  EXPECT_EQ(FixedBy(ApplyRules(MeasurementModel(arm), data, {}), "zero_column"),
            (Names{"alpha2", "theta2"}));
}

// The column of alpha5 at the flange is as long as r5 / reach.
TEST(ZeroColumnRuleTest, ToleranceIsRelativeToTheLargestScaledColumn) {
  Arm arm = testing::Rv2ajFlange();
  const Dataset data =
      testing::MeasureGenericPoses(arm, ParameterLayout(5).Values(arm), 30);
  arm.joints[4].r = 1e-3;
  const testing::MatrixXl scaled =
      testing::ScaledDifferences(arm, testing::MatrixValues(arm), data,
                                 testing::JointColumns(ParameterLayout(5)));
  const Eigen::Index alpha5 = ParameterLayout(5).Find("alpha5").value();
  const auto relative = static_cast<double>(scaled.col(alpha5).norm() /
                                            scaled.colwise().norm().maxCoeff());
  IdentifiabilityOptions options;
  options.relative_tolerance = 0.99 * relative;
  EXPECT_EQ(
      DecisionOn(ApplyRules(MeasurementModel(arm), data, options), "alpha5")
          .state,
      ParameterState::kFree);
  options.relative_tolerance = 1.01 * relative;
  EXPECT_EQ(
      DecisionOn(ApplyRules(MeasurementModel(arm), data, options), "alpha5")
          .rule,
      "zero_column");
}

struct ParallelCase {
  std::string name;
  std::vector<double> alphas;
  Names fixed;
  Names stand_for;
  std::vector<double> betas;   // empty: all zero
  std::vector<int> prismatic;  // joints from 0
};

std::string NameOf(const ::testing::TestParamInfo<ParallelCase>& info) {
  return info.param.name;
}

class ParallelRuleTest : public ::testing::TestWithParam<ParallelCase> {
 protected:
  ParallelRuleTest() : arm_(ChainWithAlphas(GetParam().alphas)) {
    for (std::size_t j = 0; j < GetParam().betas.size(); ++j) {
      arm_.joints[j].beta = GetParam().betas[j];
    }
    for (const int j : GetParam().prismatic) {
      arm_.joints[j].type = JointType::kPrismatic;
    }
  }

  Arm arm_;
};

TEST_P(ParallelRuleTest, KeepsTheFirstOfEveryRun) {
  const IdentifiabilityResult result = Analyze(arm_);
  EXPECT_EQ(FixedBy(result, "parallel_r"), GetParam().fixed);
  Names stand_for;
  for (const ParameterDecision& decision : result.decisions) {
    if (decision.identified_combination.empty()) continue;
    EXPECT_EQ(decision.state, ParameterState::kFree);
    EXPECT_EQ(decision.identified_combination.find(decision.name + " "), 0U);
    stand_for.push_back(decision.identified_combination);
  }
  EXPECT_EQ(stand_for, GetParam().stand_for);
}

// "r2 - r3" says that taking h from r2 and giving -h to r3 moves no target.
TEST_P(ParallelRuleTest, SumsHaveTheSignsOfTheReference) {
  const Dataset data = GenericPoses(arm_);
  const ParameterLayout layout(arm_.num_joints());
  const testing::VectorXl nominal = testing::MatrixValues(arm_);
  for (const ParameterDecision& decision : Analyze(arm_).decisions) {
    std::istringstream terms(decision.identified_combination);
    std::string kept;
    terms >> kept;
    std::string sign;
    std::string name;
    while (terms >> sign >> name) {
      constexpr long double kStep = 0.05L;
      testing::VectorXl moved = nominal;
      moved[layout.Find(name).value()] += kStep;
      moved[layout.Find(kept).value()] -= sign == "+" ? kStep : -kStep;
      for (Eigen::Index i = 0; i < data.num_poses(); ++i) {
        const double* q = data.joint_values.col(i).data();
        // The sine of pi in double is 1e-16.
        EXPECT_LT((testing::MatrixPosition(arm_, moved, q) -
                   testing::MatrixPosition(arm_, nominal, q))
                      .norm(),
                  1e-15L)
            << decision.identified_combination << ", " << name;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Chains, ParallelRuleTest,
    ::testing::Values(
        ParallelCase{"NoRun", {0.2, 0.5 * kPi, -0.3}, {}, {}, {}, {}},
        ParallelCase{"RunOfThree",
                     {0.2, -0.5 * kPi, 0.0, 0.0, 0.5 * kPi},
                     {"r3", "r4"},
                     {"r2 + r3 + r4"},
                     {},
                     {}},
        ParallelCase{"Antiparallel",
                     {0.2, -0.5 * kPi, kPi, 0.5 * kPi},
                     {"r3"},
                     {"r2 - r3"},
                     {},
                     {}},
        ParallelCase{"SignsMultiplyAlongTheRun",
                     {0.2, 1.0, kPi, 0.0, -kPi, 0.0},
                     {"r3", "r4", "r5", "r6"},
                     {"r2 - r3 - r4 + r5 + r6"},
                     {},
                     {}},
        ParallelCase{"TwoRuns",
                     {0.2, 0.0, 0.5 * kPi, kPi, 0.0},
                     {"r2", "r4", "r5"},
                     {"r1 + r2", "r3 - r4 - r5"},
                     {},
                     {}},
        // Joint 1 is parallel to the base, whose r does not exist.
        ParallelCase{"FromTheFirstJoint",
                     {0.0, 0.0, 0.0, 0.7},
                     {"r2", "r3"},
                     {"r1 + r2 + r3"},
                     {},
                     {}},
        ParallelCase{"PrismaticJoints",
                     {0.2, 0.5 * kPi, 0.0, kPi},
                     {"r3", "r4"},
                     {"r2 + r3 - r4"},
                     {},
                     {1, 3}},
        ParallelCase{"BetaBreaksTheRun",
                     {0.2, 0.5 * kPi, 0.0, 0.0, 0.0},
                     {"r3", "r5"},
                     {"r2 + r3", "r4 + r5"},
                     {0.0, 0.0, 0.0, 0.1, 0.0},
                     {}},
        ParallelCase{"BetaOfPiTurnsTheAxisRound",
                     {0.2, 0.5 * kPi, 0.0, kPi},
                     {"r3", "r4"},
                     {"r2 - r3 + r4"},
                     {0.0, 0.0, kPi, 0.0},
                     {}}),
    NameOf);

TEST(ParallelRuleTest, ReasonNamesBothAxes) {
  const IdentifiabilityResult result =
      Analyze(ChainWithAlphas({0.2, 0.5 * kPi, 0.0, 0.0}));
  EXPECT_EQ(DecisionOn(result, "r4").reason,
            "axis 4 is parallel to axis 2: r4 moves the target as r2 does");
}

TEST(ParallelRuleTest, ToleranceIsOfAlphaAndOfBeta) {
  IdentifiabilityOptions options;
  options.angle_tolerance = 1e-3;
  for (const bool of_beta : {false, true}) {
    for (const double angle : {0.99e-3, 1.01e-3}) {
      Arm arm = ChainWithAlphas({0.2, 0.5 * kPi, of_beta ? 0.0 : angle});
      if (of_beta) arm.joints[2].beta = angle;
      EXPECT_EQ(FixedBy(Analyze(arm, options), "parallel_r"),
                angle < 1e-3 ? Names{"r3"} : Names{});
    }
  }
}

TEST(UserChoiceTest, FreezesWhatTheRulesKeep) {
  IdentifiabilityOptions options;
  options.fix = {"d2", "theta1"};
  const Arm arm = ChainWithAlphas({0.2, 0.5 * kPi, 0.3});
  const int before = Analyze(arm).num_free;
  const IdentifiabilityResult result = Analyze(arm, options);
  EXPECT_EQ(FixedBy(result, "fixed_by_user"), (Names{"d2", "theta1"}));
  EXPECT_EQ(DecisionOn(result, "d2").reason, "fixed by the user");
  EXPECT_EQ(result.num_free, before - 2);
}

TEST(UserChoiceTest, AddsItsReasonToThatOfARule) {
  IdentifiabilityOptions options;
  options.fix = {"beta2"};
  const IdentifiabilityResult result =
      Analyze(ChainWithAlphas({0.2, 0.5 * kPi, 0.3}), options);
  const ParameterDecision& decision = DecisionOn(result, "beta2");
  EXPECT_EQ(decision.rule, "beta_rule");
  EXPECT_NE(decision.reason.find("where beta is not needed; fixed by the user"),
            std::string::npos)
      << decision.reason;
}

TEST(UserChoiceTest, MayLeaveNothingFree) {
  const Arm arm = ChainWithAlphas({0.2});
  IdentifiabilityOptions options;
  options.fix = {"beta1", "alpha1", "d1", "theta1", "r1"};
  const IdentifiabilityResult result = Analyze(arm, options);
  EXPECT_EQ(result.num_free, 0);
  EXPECT_TRUE(FreeColumns(result).empty());
  EXPECT_FALSE(result.exceeds_rank);
  EXPECT_TRUE(result.warnings.empty());
}

TEST(GivenTest, BaseAndToolAreGivenWhateverTheUserFixes) {
  IdentifiabilityOptions options;
  options.fix = {"base_x", "tool_rz"};
  const IdentifiabilityResult result =
      Analyze(ChainWithAlphas({0.2, 0.5 * kPi}), options);
  int given = 0;
  for (const ParameterDecision& decision : result.decisions) {
    if (decision.state != ParameterState::kGiven) continue;
    ++given;
    EXPECT_EQ(decision.rule, "");
    EXPECT_EQ(decision.reason, "base and tool are given, not identified");
  }
  EXPECT_EQ(given, 12);
}

class RandomArmRulesTest : public ::testing::TestWithParam<int> {
 protected:
  RandomArmRulesTest()
      : random_(913, GetParam()),
        model_(testing::RandomArm(GetParam(), &random_)),
        data_(testing::RandomDataset(model_.nominal(), model_.NominalValues(),
                                     40, &random_)) {}

  Random random_;
  MeasurementModel model_;
  Dataset data_;
};

TEST_P(RandomArmRulesTest, EveryDecisionIsExplained) {
  const IdentifiabilityResult result = ApplyRules(model_, data_, {});
  EXPECT_EQ(result.method, "rules");
  ASSERT_EQ(static_cast<int>(result.decisions.size()), model_.layout().size());
  for (int c = 0; c < model_.layout().size(); ++c) {
    const ParameterDecision& decision = result.decisions[c];
    EXPECT_EQ(decision.name, model_.layout().parameter(c).name);
    const bool free = decision.state == ParameterState::kFree;
    const bool fixed = decision.state == ParameterState::kFixed;
    EXPECT_EQ(decision.rule.empty(), !fixed) << decision.name;
    EXPECT_EQ(decision.reason.empty(), free) << decision.name;
  }
}

TEST_P(RandomArmRulesTest, FreeColumnsAreThoseFreeAscending) {
  const IdentifiabilityResult result = ApplyRules(model_, data_, {});
  std::vector<int> expected;
  for (int c = 0; c < model_.layout().size(); ++c) {
    if (result.decisions[c].state == ParameterState::kFree) {
      expected.push_back(c);
    }
  }
  EXPECT_EQ(FreeColumns(result), expected);
  EXPECT_EQ(result.num_free, static_cast<int>(expected.size()));
}

TEST_P(RandomArmRulesTest, NominalRankIsThatOfTheReference) {
  const IdentifiabilityResult result = ApplyRules(model_, data_, {});
  const testing::VectorXl expected =
      testing::RelativeSingularValues(testing::ScaledDifferences(
          model_.nominal(), testing::MatrixValues(model_.nominal()), data_,
          FreeColumns(result)));
  EXPECT_EQ(result.nominal_rank.rank, (expected.array() > 1e-6L).count());
  ASSERT_EQ(result.nominal_rank.singular_values.size(), expected.size());
  EXPECT_LT((result.nominal_rank.singular_values.cast<long double>() - expected)
                .cwiseAbs()
                .maxCoeff(),
            1e-12L);
}

// Prismatic joints leave more parameters than can be distinguished.
TEST_P(RandomArmRulesTest, FollowingTheRefusalResolvesIt) {
  testing::ExpectFollowingTheRefusalHelps(model_, data_);
}

TEST_P(RandomArmRulesTest, DoesNotDependOnThreads) {
  const IdentifiabilityResult one = ApplyRules(model_, data_, {});
  const IdentifiabilityResult eight =
      ApplyRules(MeasurementModel(model_.nominal(), 8), data_, {});
  EXPECT_EQ(one.nominal_rank.singular_values,
            eight.nominal_rank.singular_values);
  EXPECT_EQ(one.perturbed_rank.singular_values,
            eight.perturbed_rank.singular_values);
  EXPECT_EQ(FreeColumns(one), FreeColumns(eight));
}

INSTANTIATE_TEST_SUITE_P(Joints, RandomArmRulesTest, ::testing::Range(1, 8));

// As for the rank method: between perturbations large enough for full rank and
// those without effect, the ranks of the three perturbed arms differ.
TEST(PerturbedRankTest, IsThatOfTheFirstArmOfLargestRank) {
  const Arm arm = testing::Rv2ajWrist();
  const MeasurementModel model(arm);
  const Dataset data = testing::MeasureStudyPoses(arm);
  IdentifiabilityOptions options;
  bool has_later = false;
  for (int step = 0; step < 160; ++step) {
    options.perturbation = 1e-2 * std::pow(10.0, -0.05 * step);
    const IdentifiabilityResult result = ApplyRules(model, data, options);
    const std::vector<int> order =
        InCanonicalOrder(model.layout(), FreeColumns(result));
    RankReport expected;
    for (int draw = 0; draw < 3; ++draw) {
      const RankReport report =
          AnalyzeRank(ScaledFactor(model, PerturbedValues(model, options, draw),
                                   data, order),
                      options.relative_tolerance);
      if (report.rank <= expected.rank) continue;
      expected = report;
      has_later = has_later || draw > 0;
    }
    EXPECT_EQ(result.perturbed_rank.rank, expected.rank) << step;
    // The same functions of the same numbers: equal to the last bit.
    EXPECT_EQ(result.perturbed_rank.gap, expected.gap) << step;
  }
  EXPECT_TRUE(has_later);
}

}  // namespace
}  // namespace alidade::internal::rules_test
