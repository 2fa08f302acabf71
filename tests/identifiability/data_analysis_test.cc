#include "src/identifiability/data_analysis.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <regex>
#include <string>
#include <vector>

#include "src/identifiability/analysis.h"
#include "src/identifiability/perturbation.h"
#include "src/kernel/partition.h"
#include "src/kernel/reduction.h"
#include "tests/support/classic_arms.h"
#include "tests/support/edit.h"
#include "tests/support/reference_solution.h"
#include "tests/support/study.h"

namespace alidade::internal {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using testing::StudyData;

// Each joint in turn stands still. Redrawing another joint's values does not
// raise the rank; redrawing this one's restores it.
TEST(AnalyzeDataTest,
     AdviceNamesTheJointThatStoodStillAndHowManyParametersItWouldDetermine) {
  const Arm arm = testing::Ur10();
  const MeasurementModel model(arm);
  const Dataset all =
      testing::MeasureGenericPoses(arm, model.NominalValues(), 60);
  const std::vector<int> kept =
      AnalyzeGeneric(model, testing::JointColumns(model.layout()), all, {})
          .kept;
  const int rank = AnalyzeData(model, all, kept, {}, {}).rank.rank;
  EXPECT_EQ(rank, static_cast<int>(kept.size()));
  for (int joint = 0; joint < 6; ++joint) {
    Dataset still = all;
    testing::Edit(&still.joint_values)->row(joint).setConstant(0.3);
    const DataAnalysis analysis = AnalyzeData(model, still, kept, {}, {});
    const int gain = rank - analysis.rank.rank;
    ASSERT_GT(gain, 0) << joint;
    EXPECT_THAT(
        analysis.advice,
        ::testing::ElementsAre(
            "moving joint " + std::to_string(joint + 1) +
            " through its range, the others as measured, would determine " +
            std::to_string(gain) + " more " +
            (gain == 1 ? "parameter" : "parameters")));
  }
}

// A tip in a socket cannot leave it, nor a joint turn alone.
TEST(AnalyzeDataTest, ContactsAreNotAdvisedToMoveOneJoint) {
  const Arm arm = testing::Ur10();
  References references;
  references.points.resize(1);
  references.points[0].position = Eigen::Vector3d(0.5, 0.2, 0.3);
  const MeasurementModel model(arm, references, {});
  Dataset still = testing::MeasureGenericPoses(
      arm, MeasurementModel(arm).NominalValues(), 60);
  testing::Edit(&still.joint_values)->row(2).setConstant(0.3);
  still.blocks.front().kind = MeasurementKind::kFixedPoint;
  still.blocks.front().references.assign(60, 0);
  const std::vector<int> columns = testing::JointColumns(model.layout());
  const DataAnalysis analysis = AnalyzeData(model, still, columns, {}, {});
  ASSERT_FALSE(analysis.relations.empty());
  EXPECT_THAT(analysis.advice,
              ::testing::ElementsAre("no joint alone would help: vary several "
                                     "of them together"));
}

// The median, over arms that are off by their tolerances, of the standard
// deviations by dense normal equations in extended precision.
TEST(AnalyzeDataTest,
     SecondOrderDeviationsAreThoseOfArmsWithinTheirTolerances) {
  const Arm arm = testing::Rv2ajWrist();
  const MeasurementModel model(arm);
  const ParameterLayout& layout = model.layout();
  const Dataset data = StudyData(arm);
  const IdentifiabilityOptions options;
  const GenericAnalysis generic =
      AnalyzeGeneric(model, testing::JointColumns(layout), data, options);
  const std::string text =
      AnalyzeData(model, data, generic.kept, generic.weak, options)
          .second_order;
  std::vector<int> columns = generic.kept;
  columns.insert(columns.end(), generic.weak.begin(), generic.weak.end());
  // A uniform draw has a third of its half width's square as its variance.
  Eigen::VectorXd sizes = options.priors.Deviations(layout) * std::sqrt(3.0);
  for (int c = 0; c < layout.size(); ++c) {
    if (!ParameterLayout::IsJointKind(layout.parameter(c).kind)) sizes[c] = 0.0;
  }
  int num_named = 0;
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const Parameter& parameter = layout.parameter(columns[k]);
    std::vector<double> deviations;
    for (int draw = 0; draw < 9; ++draw) {
      const testing::MatrixXl covariance = testing::ReferenceCovariance(
          JacobianFactor(model, PerturbedValues(model, sizes, draw), data,
                         columns)
              .cast<long double>(),
          testing::VectorXl::Constant(static_cast<Eigen::Index>(columns.size()),
                                      HUGE_VAL));
      const auto at = static_cast<Eigen::Index>(k);
      deviations.push_back(static_cast<double>(std::sqrt(covariance(at, at))));
    }
    std::sort(deviations.begin(), deviations.end());
    std::smatch found;
    const std::regex name(" " + parameter.name + " ([0-9.e+]+) m");
    const bool is_named = std::regex_search(text, found, name);
    // Those that the noise leaves worse than they were known before.
    EXPECT_EQ(is_named, deviations[4] > options.priors.Of(parameter.kind))
        << parameter.name;
    if (!is_named) continue;
    ++num_named;
    // Both units are of a thousandth; two digits are shown.
    EXPECT_NEAR(std::stod(found[1]) * 1e-3 / deviations[4], 1.0, 0.05)
        << parameter.name;
  }
  EXPECT_GE(num_named, 2);
}

// They are of lengths, whatever the sigmas: one for all, or one that differs.
TEST(AnalyzeFreeTest, IndicesDoNotDependOnSigmas) {
  const Arm arm = testing::Rv2ajFlange();
  const MeasurementModel model(arm);
  const std::vector<int> free = testing::FlangeFreeColumns(model.layout());
  const Dataset data = StudyData(arm);
  const FreeAnalysis expected = AnalyzeFree(model, data, free, {});
  ASSERT_GT(expected.unscaled.o1, 0.0);
  Dataset uneven = data;
  testing::Edit(&uneven.sigmas()).at(0, 0) *= 3.0;
  Dataset larger = data;
  *testing::Edit(&larger.sigmas()) *= 2.0;
  for (const Dataset& other : {uneven, larger}) {
    const FreeAnalysis actual = AnalyzeFree(model, other, free, {});
    EXPECT_NEAR(actual.unscaled.o1 / expected.unscaled.o1, 1.0, 1e-6);
    EXPECT_NEAR(actual.scaled.o1 / expected.scaled.o1, 1.0, 1e-6);
  }
}

// Of poses the rows are of two units.
TEST(AnalyzeFreeTest, IndicesOfPosesDoNotDependOnSigmas) {
  const Arm arm = testing::Rv2ajFlange();
  const MeasurementModel model(arm);
  const std::vector<int> free = testing::FlangeFreeColumns(model.layout());
  Dataset data = StudyData(arm);
  ObservationBlock& block = data.blocks.front();
  block.kind = MeasurementKind::kPose;
  block.measured = Eigen::MatrixXd::Zero(6, data.num_poses());
  block.sigmas = Eigen::MatrixXd::Constant(6, data.num_poses(), 1e-4);
  const FreeAnalysis expected = AnalyzeFree(model, data, free, {});
  testing::Edit(&data.blocks.front().sigmas)->bottomRows(3).setConstant(7e-4);
  const FreeAnalysis actual = AnalyzeFree(model, data, free, {});
  EXPECT_NEAR(actual.unscaled.o1 / expected.unscaled.o1, 1.0, 1e-6);
  EXPECT_NEAR(actual.scaled.o5 / expected.scaled.o5, 1.0, 1e-6);
}

// Of two kinds that differ in their sigmas: neither is all the data's.
TEST(AnalyzeFreeTest, IndicesOfSeveralKindsDoNotDependOnSigmas) {
  const Arm arm = testing::Rv2ajFlange();
  const MeasurementModel model(arm);
  const std::vector<int> free = testing::FlangeFreeColumns(model.layout());
  Dataset data = StudyData(arm);
  ObservationBlock differences;
  differences.kind = MeasurementKind::kDifference;
  for (int i = 0; i < 10; ++i) {
    differences.poses.push_back(i);
    differences.seconds.push_back(i + 1);
  }
  differences.measured = Eigen::MatrixXd::Zero(3, 10);
  differences.sigmas = Eigen::MatrixXd::Constant(3, 10, 2e-5);
  data.blocks.push_back(differences);
  const FreeAnalysis expected = AnalyzeFree(model, data, free, {});
  data.blocks.back().sigmas = Eigen::MatrixXd::Constant(3, 10, 5e-4);
  const FreeAnalysis actual = AnalyzeFree(model, data, free, {});
  EXPECT_NEAR(actual.unscaled.o1 / expected.unscaled.o1, 1.0, 1e-6);
  EXPECT_NEAR(actual.scaled.o5 / expected.scaled.o5, 1.0, 1e-6);
}

// Nor where each rank's are the same but another rank's are not.
TEST(AnalyzeFreeTest, IndicesOfPartsDoNotDependOnSigmas) {
  const Arm arm = testing::Rv2ajFlange();
  const Dataset data = StudyData(arm);
  const MeasurementModel whole(arm);
  const std::vector<int> free = testing::FlangeFreeColumns(whole.layout());
  const FreeAnalysis expected = AnalyzeFree(whole, data, free, {});
  const Eigen::Index first = data.num_poses() / 2;
  RunOnThreads(2, [&](Communicator* communicator) {
    const bool is_root = communicator->is_root();
    const Eigen::Index begin = is_root ? 0 : first;
    const Eigen::Index count = is_root ? first : data.num_poses() - first;
    Dataset part = MakePositions(
        data.joint_values.map().middleCols(begin, count),
        data.positions().map().middleCols(begin, count),
        Eigen::Matrix3Xd::Constant(3, count, is_root ? 2e-5 : 3e-4));
    MakePartition(communicator, &part);
    const MeasurementModel model(arm, Execution{1, communicator});
    const FreeAnalysis actual = AnalyzeFree(model, part, free, {});
    EXPECT_NEAR(actual.unscaled.o1 / expected.unscaled.o1, 1.0, 1e-6);
    EXPECT_NEAR(actual.scaled.o5 / expected.scaled.o5, 1.0, 1e-6);
  });
}

TEST(FormatDeviationTest, IsInMillimetresAndMilliradians) {
  EXPECT_EQ(FormatDeviation(1.5e-3, Dimension::kLength), "1.5 mm");
  EXPECT_EQ(FormatDeviation(2.5e-3, Dimension::kAngle), "2.5 mrad");
  EXPECT_EQ(FormatDeviation(HUGE_VAL, Dimension::kAngle), "no bound");
}

}  // namespace
}  // namespace alidade::internal
