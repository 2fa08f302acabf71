#include "src/identifiability/analysis.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "src/identifiability/data_analysis.h"
#include "src/identifiability/rules.h"
#include "tests/support/classic_arms.h"
#include "tests/support/edit.h"
#include "tests/support/matrix_kinematics.h"
#include "tests/support/reference_solution.h"
#include "tests/support/study.h"

namespace alidade::internal {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::StudyData;
using ::testing::UnorderedElementsAre;

const ParameterDecision& Find(const IdentifiabilityResult& result,
                              const std::string& name) {
  return *std::find_if(
      result.decisions.begin(), result.decisions.end(),
      [&](const ParameterDecision& d) { return d.name == name; });
}

std::vector<std::string> FreeNames(const IdentifiabilityResult& result) {
  std::vector<std::string> names;
  for (const int c : FreeColumns(result)) {
    names.push_back(result.decisions[c].name);
  }
  return names;
}

IdentifiabilityOptions WithPolicy(WeakPolicy policy) {
  IdentifiabilityOptions options;
  options.policy = policy;
  return options;
}

TEST(AnalysisTest, DefaultFreesTheStructuralRankWithPriors) {
  const Arm arm = testing::Rv2ajWrist();
  const MeasurementModel model(arm);
  const IdentifiabilityResult result =
      AnalyzeIdentifiability(model, StudyData(arm), {});
  EXPECT_EQ(result.method, "rank");
  EXPECT_EQ(result.policy, "prior");
  EXPECT_EQ(result.num_free, 18);
  EXPECT_FALSE(result.exceeds_rank);
  const Eigen::VectorXd priors = PriorsOf(result);
  ASSERT_EQ(priors.size(), model.layout().size());
  EXPECT_EQ(priors[*model.layout().Find("beta4")], 5e-3);
  // r2 identifies r2 + r3 + r4, each known to 1 mm beforehand.
  EXPECT_NEAR(priors[*model.layout().Find("r2")], std::sqrt(3.0) * 1e-3, 1e-12);
  EXPECT_EQ(priors[*model.layout().Find("r1")], 1e-3);
  EXPECT_TRUE(std::isnan(priors[*model.layout().Find("r3")]));
}

TEST(AnalysisTest, WarnsBeforeASolveAndNamesWhatTheNoiseDrowns) {
  const Arm arm = testing::Rv2ajWrist();
  const IdentifiabilityResult result =
      AnalyzeIdentifiability(MeasurementModel(arm), StudyData(arm), {});
  EXPECT_THAT(
      result.warnings,
      Contains(AllOf(HasSubstr("beta4 is linearly dependent on -160 mm * r2"),
                     HasSubstr("alpha2 is linearly dependent on 85 mm * r2"))));
  EXPECT_THAT(result.warnings, Contains(HasSubstr("last joint")));
  // A list of names, each with a number.
  EXPECT_THAT(result.warnings,
              Contains(::testing::ContainsRegex(
                  "standard deviations of about [a-z]+[0-9] [0-9][^,]*, "
                  "[a-z]+[0-9] [0-9]")));
  EXPECT_THAT(result.weak, UnorderedElementsAre("alpha4", "beta4", "alpha2"));
  EXPECT_THAT(result.advice, Contains(HasSubstr("joint 2")));
}

// By more than a millionth of the arm's reach.
TEST(AnalysisTest, ATargetOffTheLastAxisIsNotWarnedOf) {
  Arm arm = testing::Rv2ajWrist();
  const auto warnings = [&] {
    return AnalyzeIdentifiability(MeasurementModel(arm), StudyData(arm), {})
        .warnings;
  };
  const double reach = ArmReach(arm);
  arm.last_from_target().translation().x() = 0.05;
  EXPECT_THAT(warnings(), ::testing::Not(Contains(HasSubstr("last joint"))));
  arm.last_from_target().translation().x() = 1.5e-6 * reach;
  EXPECT_THAT(warnings(), ::testing::Not(Contains(HasSubstr("last joint"))));
  arm.last_from_target().translation().x() = 0.5e-6 * reach;
  EXPECT_THAT(warnings(), Contains(HasSubstr("last joint")));
}

// Measured orientations show the rotation of the last joint.
TEST(AnalysisTest, ATargetOnTheLastAxisIsNotWarnedOfWherePosesAreMeasured) {
  const Arm arm = testing::Rv2ajWrist();
  const MeasurementModel model(arm);
  Dataset data = StudyData(arm);
  ObservationBlock& block = data.blocks.front();
  block.kind = MeasurementKind::kPose;
  block.measured = Eigen::MatrixXd::Zero(6, data.num_poses());
  block.sigmas = Eigen::MatrixXd::Constant(6, data.num_poses(), 1e-4);
  EXPECT_THAT(AnalyzeIdentifiability(model, data, {}).warnings,
              ::testing::Not(Contains(HasSubstr("last joint"))));
}

TEST(AnalysisTest, DecisionsAreNamedAsTheLayoutNamesThem) {
  const MeasurementModel model(testing::Rv2ajWrist());
  const IdentifiabilityResult result =
      AnalyzeIdentifiability(model, StudyData(model.nominal()), {});
  ASSERT_EQ(static_cast<int>(result.decisions.size()), model.layout().size());
  for (int c = 0; c < model.layout().size(); ++c) {
    EXPECT_EQ(result.decisions[c].name, model.layout().parameter(c).name);
  }
}

TEST(AnalysisTest, FreezeHoldsWhatIsToldBadlyAndSaysWhatStandsForIt) {
  const Arm arm = testing::Rv2ajWrist();
  const IdentifiabilityResult result = AnalyzeIdentifiability(
      MeasurementModel(arm), StudyData(arm), WithPolicy(WeakPolicy::kFreeze));
  EXPECT_EQ(result.num_free, 15);
  EXPECT_EQ(Find(result, "beta4").rule, "at_geometry");
  EXPECT_EQ(Find(result, "alpha2").rule, "not_excited");
  EXPECT_EQ(Find(result, "alpha5").rule, "no_effect");
  EXPECT_EQ(Find(result, "alpha5").reason,
            "no measured position moves with it");
  EXPECT_EQ(Find(result, "r2").identified_combination,
            "r2 + r3 + r4 - 160 mm * beta4 + 85 mm * alpha2");
  EXPECT_EQ(PriorsOf(result).size(), 0);
}

TEST(AnalysisTest, KeepRefusesNothingThatSecondOrderEffectsTell) {
  const Arm arm = testing::Rv2ajFlange();
  const IdentifiabilityResult result = AnalyzeIdentifiability(
      MeasurementModel(arm), StudyData(arm), WithPolicy(WeakPolicy::kKeep));
  EXPECT_EQ(result.num_free, 18);
  EXPECT_FALSE(result.exceeds_rank) << result.refusal;
  EXPECT_EQ(result.perturbed_rank.rank, 18);
}

TEST(AnalysisTest, RulesKeepTheirPublishedAnswer) {
  const Arm arm = testing::Rv2ajWrist();
  IdentifiabilityOptions options;
  options.method = IdentifiabilityMethod::kRules;
  const IdentifiabilityResult result =
      AnalyzeIdentifiability(MeasurementModel(arm), StudyData(arm), options);
  EXPECT_EQ(result.policy, "keep");
  EXPECT_EQ(result.num_free, 17);
  EXPECT_EQ(PriorsOf(result).size(), 0);
}

TEST(AnalysisTest, PreferIsRespectedAndImpossibleFreeIsRefusedWithTheReason) {
  const Arm arm = testing::Rv2ajFlange();
  IdentifiabilityOptions options;
  options.prefer = {"r4"};
  EXPECT_THAT(FreeNames(AnalyzeIdentifiability(MeasurementModel(arm),
                                               StudyData(arm), options)),
              AllOf(Contains("r4"), ::testing::Not(Contains("r2"))));
  options.prefer.clear();
  options.free = {"r2", "r3"};
  const IdentifiabilityResult refused =
      AnalyzeIdentifiability(MeasurementModel(arm), StudyData(arm), options);
  EXPECT_TRUE(refused.exceeds_rank);
  EXPECT_THAT(refused.refusal,
              AllOf(HasSubstr("r3"), HasSubstr("is linearly dependent on r2")));
}

TEST(AnalysisTest, FixedParametersStayOutOfTheAnalysis) {
  const Arm arm = testing::Rv2ajWrist();
  IdentifiabilityOptions options;
  options.fix = {"r2"};
  const IdentifiabilityResult result =
      AnalyzeIdentifiability(MeasurementModel(arm), StudyData(arm), options);
  EXPECT_EQ(Find(result, "r2").rule, "fixed_by_user");
  EXPECT_EQ(Find(result, "r3").state, ParameterState::kFree);
  EXPECT_THAT(Find(result, "r4").reason,
              HasSubstr("is linearly dependent on r3"));
}

TEST(AnalysisTest, LargeNoiseMakesParametersImpractical) {
  const Arm arm = testing::Ur10();
  const MeasurementModel model(arm);
  Dataset data = testing::MeasureGenericPoses(arm, model.NominalValues(), 60);
  testing::Edit(&data.sigmas())->setConstant(1e-6);
  EXPECT_THAT(AnalyzeIdentifiability(model, data, {}).weak, IsEmpty());
  testing::Edit(&data.sigmas())->setConstant(0.5);
  const IdentifiabilityResult noisy =
      AnalyzeIdentifiability(model, data, WithPolicy(WeakPolicy::kFreeze));
  EXPECT_GT(noisy.weak.size(), 5u);
  EXPECT_EQ(Find(noisy, noisy.weak.front()).rule, "not_practical");
  EXPECT_THAT(Find(noisy, noisy.weak.front()).reason,
              HasSubstr("known a priori"));
}

// The noise takes one parameter to 1.3 times what was known before, or to 0.9.
TEST(AnalysisTest, WhatTheNoiseLeavesWorseThanBeforeIsImpractical) {
  const Arm arm = testing::Ur10();
  const MeasurementModel model(arm);
  Dataset data = testing::MeasureGenericPoses(arm, model.NominalValues(), 60);
  testing::Edit(&data.sigmas())->setConstant(1.0);
  const IdentifiabilityOptions options;
  const std::vector<int> kept =
      AnalyzeGeneric(model, testing::JointColumns(model.layout()), data,
                     options)
          .kept;
  const Eigen::VectorXd deviations =
      AnalyzeData(model, data, kept, {}, options).Deviations(kept);
  double largest = 0.0;
  std::string worst;
  for (std::size_t k = 0; k < kept.size(); ++k) {
    const Parameter& parameter = model.layout().parameter(kept[k]);
    const double ratio = deviations[static_cast<Eigen::Index>(k)] /
                         options.priors.Of(parameter.kind);
    if (ratio > largest) worst = parameter.name;
    largest = std::max(largest, ratio);
  }
  testing::Edit(&data.sigmas())->setConstant(0.9 / largest);
  EXPECT_THAT(AnalyzeIdentifiability(model, data, {}).weak, IsEmpty());
  testing::Edit(&data.sigmas())->setConstant(1.3 / largest);
  EXPECT_THAT(AnalyzeIdentifiability(model, data, {}).weak, Contains(worst));
}

// The study's poses with the tool held vertical.
Dataset VerticalToolData(const Arm& arm) {
  SimulationConfig config =
      testing::MeasurementOf(arm, testing::Rv2ajTrueValues(arm), {});
  CylinderGrid grid;
  grid.azimuth = {-140.0 * kDegree, 140.0 * kDegree, 8};
  grid.radius = {210.0 * kMillimetre, 330.0 * kMillimetre, 7};
  grid.height = 215.0 * kMillimetre;
  grid.elevation_from = -90.0 * kDegree;
  grid.elevation_to = -90.0 * kDegree;
  grid.start.resize(5);
  grid.start << 0.0, 40.0, 80.0, 40.0, 0.0;
  grid.start *= kDegree;
  config.poses = grid;
  Dataset data = Simulate(config);
  testing::Edit(&data.sigmas())->setConstant(0.02 * kMillimetre);
  return data;
}

TEST(AnalysisTest, VerticalToolTellsThirteenOfTheStudysSeventeen) {
  const Arm arm = testing::Rv2ajWrist();
  const MeasurementModel model(arm);
  const Dataset data = VerticalToolData(arm);
  IdentifiabilityOptions options;
  options.method = IdentifiabilityMethod::kRules;
  const IdentifiabilityResult result =
      AnalyzeIdentifiability(model, data, options);
  EXPECT_EQ(result.num_free, 17);
  EXPECT_EQ(result.nominal_rank.rank, 13);
  // The same from matrix products in extended precision.
  const testing::VectorXl singular_values =
      testing::RelativeSingularValues(testing::ScaledDifferences(
          arm, testing::MatrixValues(arm), data, FreeColumns(result)));
  EXPECT_EQ((singular_values.array() > 1e-6L).count(), 13);
}

TEST(AnalysisTest, NothingIsLeftWhereTheNoiseDrownsEverything) {
  const Arm arm = testing::Rv2ajWrist();
  Dataset data = StudyData(arm);
  testing::Edit(&data.sigmas())->setConstant(1e6);
  for (const WeakPolicy policy :
       {WeakPolicy::kFreeze, WeakPolicy::kPrior, WeakPolicy::kKeep}) {
    const IdentifiabilityResult result =
        AnalyzeIdentifiability(MeasurementModel(arm), data, WithPolicy(policy));
    EXPECT_EQ(result.num_free, policy == WeakPolicy::kFreeze ? 0 : 18);
    EXPECT_GE(result.weak.size(), 18u);
  }
}

TEST(AnalysisTest, EverythingFixedLeavesNothingFree) {
  const Arm arm = testing::Rv2ajWrist();
  const MeasurementModel model(arm);
  IdentifiabilityOptions options;
  for (const int c : testing::JointColumns(model.layout())) {
    options.fix.push_back(model.layout().parameter(c).name);
  }
  EXPECT_EQ(AnalyzeIdentifiability(model, StudyData(arm), options).num_free, 0);
}

TEST(AnalysisTest, RowsInAnyOrderAndThreadsGiveTheSameAnswer) {
  const Arm arm = testing::Rv2ajWrist();
  const Dataset data = StudyData(arm);
  Dataset reversed = data;
  reversed.joint_values = data.joint_values.map().rowwise().reverse();
  reversed.positions() = data.positions().map().rowwise().reverse();
  const IdentifiabilityResult first =
      AnalyzeIdentifiability(MeasurementModel(arm), data, {});
  for (const IdentifiabilityResult& other :
       {AnalyzeIdentifiability(MeasurementModel(arm), reversed, {}),
        AnalyzeIdentifiability(MeasurementModel(arm, 8), data, {})}) {
    EXPECT_EQ(FreeNames(other), FreeNames(first));
    EXPECT_EQ(other.warnings, first.warnings);
    ASSERT_EQ(other.relations.size(), first.relations.size());
    for (std::size_t i = 0; i < first.relations.size(); ++i) {
      EXPECT_EQ(other.relations[i].text, first.relations[i].text);
    }
  }
}

}  // namespace
}  // namespace alidade::internal
