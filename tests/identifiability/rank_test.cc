#include "src/identifiability/rank.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "src/common/constants.h"
#include "src/common/random.h"
#include "tests/support/random_arms.h"
#include "tests/support/random_datasets.h"
#include "tests/support/reference_solution.h"
#include "tests/support/rv2aj_arms.h"
#include "tests/support/study.h"

namespace alidade::internal {
namespace {

using testing::ColumnsOf;
using testing::JointColumns;
using testing::MatrixXl;
using testing::VectorXl;

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

TEST(AnalyzeRankTest, ReadsSingularValuesRankAndGap) {
  const Eigen::Vector4d diagonal(2e-9, 4.0, 0.002, -2.0);
  const RankReport report = AnalyzeRank(diagonal.asDiagonal(), 1e-6);
  EXPECT_EQ(report.rank, 3);
  const Eigen::Vector4d expected(1.0, 0.5, 5e-4, 5e-10);
  // Relative, since the Jacobi method finds small singular values so.
  EXPECT_TRUE(report.singular_values.isApprox(expected, 1e-14));
  EXPECT_NEAR(report.gap, 1e6, 1e-6);
}

TEST(AnalyzeRankTest, ToleranceIsRelativeToTheLargest) {
  for (const double scale : {1e-8, 1.0, 1e8}) {
    const Eigen::MatrixXd factor =
        Eigen::Vector2d(scale, 1e-3 * scale).asDiagonal();
    EXPECT_EQ(AnalyzeRank(factor, 0.99e-3).rank, 2) << scale;
    EXPECT_EQ(AnalyzeRank(factor, 1.01e-3).rank, 1) << scale;
  }
}

TEST(AnalyzeRankTest, EmptyAndZeroHaveRankZero) {
  EXPECT_EQ(AnalyzeRank(Eigen::MatrixXd(0, 0), 1e-6).rank, 0);
  EXPECT_EQ(AnalyzeRank(Eigen::MatrixXd::Zero(3, 3), 1e-6).rank, 0);
}

TEST(AnalyzeRankTest, GapIsInfiniteWhereNothingOrExactZeroIsDropped) {
  const Eigen::Matrix2d full = Eigen::Vector2d(1.0, 0.5).asDiagonal();
  EXPECT_EQ(AnalyzeRank(full, 1e-6).gap, kInfinity);
  const Eigen::Matrix2d singular = Eigen::Vector2d(1.0, 0.0).asDiagonal();
  EXPECT_EQ(AnalyzeRank(singular, 1e-6).gap, kInfinity);
}

TEST(RankReportTest, MiddleOfTheGapIsGeometric) {
  RankReport report;
  report.singular_values = Eigen::Vector3d(1.0, 4e-3, 1e-9);
  report.rank = 2;
  EXPECT_EQ(report.SmallestCounted(), 4e-3);
  EXPECT_NEAR(report.MiddleOfGap(), 2e-6, 1e-20);
}

TEST(RankReportTest, RoundingIsTheLowerEndOfTheGapWhereNothingIsBelow) {
  RankReport report;
  report.singular_values = Eigen::Vector2d(1.0, 0.25);
  report.rank = 2;
  EXPECT_NEAR(report.MiddleOfGap(), 0.5 * std::sqrt(kEpsilon), 1e-20);
  report.singular_values = Eigen::Vector3d(1.0, 0.25, 0.0);
  EXPECT_NEAR(report.MiddleOfGap(), 0.5 * std::sqrt(kEpsilon), 1e-20);
}

TEST(RankReportTest, EmptyCountsAsFullRank) {
  EXPECT_EQ(RankReport().SmallestCounted(), 1.0);
}

// Random arms, measured with a sigma of its own for each coordinate.
struct RandomProblem {
  explicit RandomProblem(int num_joints, int num_poses, int draw)
      : random(611 + num_joints, draw),
        model(testing::RandomArm(num_joints, &random)),
        data(testing::RandomDataset(model.nominal(), model.NominalValues(),
                                    num_poses, &random)) {}

  MatrixXl Differences(const std::vector<int>& columns) const {
    return testing::ScaledDifferences(model.nominal(),
                                      model.NominalValues().cast<long double>(),
                                      data, columns);
  }

  Random random;
  MeasurementModel model;
  Dataset data;
};

class RandomArmRankTest : public ::testing::TestWithParam<int> {};

void ExpectGramMatrixOf(const MatrixXl& jacobian,
                        const Eigen::MatrixXd& factor) {
  const MatrixXl gram = jacobian.transpose() * jacobian;
  const MatrixXl wide = factor.cast<long double>();
  // Backward errors of a QR factorisation, some 100 eps, and 1e-12 of the
  // differences.
  EXPECT_TRUE((wide.transpose() * wide).isApprox(gram, 1e-11L));
  EXPECT_TRUE(factor.isUpperTriangular(0.0));
}

TEST_P(RandomArmRankTest, FactorHasTheGramMatrixOfTheScaledJacobian) {
  const RandomProblem problem(GetParam(), 30, 0);
  const std::vector<int> columns = JointColumns(problem.model.layout());
  const Eigen::MatrixXd factor = ScaledFactor(
      problem.model, problem.model.NominalValues(), problem.data, columns);
  EXPECT_EQ(factor.rows(), 5 * GetParam());
  EXPECT_EQ(factor.cols(), 5 * GetParam());
  ExpectGramMatrixOf(problem.Differences(columns), factor);
}

TEST_P(RandomArmRankTest, FactorIsSquareWhereMeasurementsAreFew) {
  const RandomProblem problem(GetParam(), 1, 1);
  const std::vector<int> columns = JointColumns(problem.model.layout());
  const Eigen::MatrixXd factor = ScaledFactor(
      problem.model, problem.model.NominalValues(), problem.data, columns);
  EXPECT_EQ(factor.rows(), 5 * GetParam());
  EXPECT_EQ(factor.cols(), 5 * GetParam());
  EXPECT_EQ(AnalyzeRank(factor, 1e-9).rank, 3);
  ExpectGramMatrixOf(problem.Differences(columns), factor);
}

TEST_P(RandomArmRankTest, RankIsThatOfTheReference) {
  constexpr double kTolerance = 1e-9;
  for (int draw = 0; draw < 3; ++draw) {
    const RandomProblem problem(GetParam(), 30, draw);
    const std::vector<int> columns = JointColumns(problem.model.layout());
    const RankReport report =
        AnalyzeRank(ScaledFactor(problem.model, problem.model.NominalValues(),
                                 problem.data, columns),
                    kTolerance);
    const MatrixXl jacobian = problem.Differences(columns);
    const VectorXl expected = testing::RelativeSingularValues(jacobian);
    EXPECT_EQ(report.rank, (expected.array() > kTolerance).count());
    Eigen::FullPivLU<MatrixXl> lu(jacobian);
    lu.setThreshold(kTolerance);
    EXPECT_EQ(report.rank, lu.rank());
    // Absolute: what rounding of the whole matrix does to any of them.
    const VectorXl difference =
        report.singular_values.cast<long double>() - expected;
    EXPECT_LT(difference.cwiseAbs().maxCoeff(), 1e-12L);
  }
}

// Every relation holds between the columns of the reference Jacobian, and there
// are as many as the rank lacks.
TEST_P(RandomArmRankTest, DependenciesHoldAndCompleteTheRank) {
  const RandomProblem problem(GetParam(), 30, 3);
  const MeasurementModel& model = problem.model;
  const std::vector<int> columns = JointColumns(model.layout());
  const testing::ReferenceLinearization exact = testing::LinearizeReference(
      model.nominal(), model.NominalValues().cast<long double>(), problem.data,
      columns);
  const auto rank =
      (testing::RelativeSingularValues(problem.Differences(columns)).array() >
       1e-9L)
          .count();
  const std::vector<Dependency> dependencies = FindDependencies(
      model, model.NominalValues(), problem.data, columns, 1e-9);
  EXPECT_EQ(static_cast<Eigen::Index>(dependencies.size()),
            exact.jacobian.cols() - rank);
  for (const Dependency& dependency : dependencies) {
    const VectorXl column = exact.jacobian.col(dependency.column);
    VectorXl rest = column;
    for (const auto& [other, coefficient] : dependency.terms) {
      rest -= coefficient * exact.jacobian.col(other);
    }
    // Terms below 1e-4 of the column are left out, at most one per column.
    EXPECT_LT(rest.norm(),
              1e-4L * static_cast<long double>(columns.size()) * column.norm())
        << DescribeDependency(model.layout(), dependency);
  }
}

INSTANTIATE_TEST_SUITE_P(Joints, RandomArmRankTest, ::testing::Range(1, 7));

// What the rules keep at the flange.
std::vector<int> FlangeColumns(const ParameterLayout& layout) {
  std::vector<int> columns = testing::FlangeFreeColumns(layout);
  for (const int column : ColumnsOf(layout, {"alpha5", "theta4"})) {
    columns.push_back(column);
  }
  return columns;
}

// "beta4" -> {"r2", -0.160}
using Relations = std::map<std::string, std::pair<std::string, double>>;

struct RelationCase {
  std::string name;
  Arm arm;
  bool in_plane;
  Relations expected;  // coefficients in m
};

std::string NameOf(const ::testing::TestParamInfo<RelationCase>& info) {
  return info.param.name;
}

class Rv2ajRelationTest : public ::testing::TestWithParam<RelationCase> {
 protected:
  Rv2ajRelationTest()
      : model_(GetParam().arm),
        data_(GetParam().in_plane
                  ? testing::MeasureStudyPoses(model_.nominal())
                  : testing::MeasureGenericPoses(model_.nominal(),
                                                 model_.NominalValues(), 60)) {
    const ParameterLayout& layout = model_.layout();
    const std::vector<int> columns = model_.nominal().joints[4].r == 0.0
                                         ? testing::WristFreeColumns(layout)
                                         : FlangeColumns(layout);
    // Far above what joint values of four decimals make of a relation in the
    // plane, far below every other effect.
    dependencies_ =
        FindDependencies(model_, model_.NominalValues(), data_, columns, 1e-5);
  }

  // The farthest that a pose moves from nominal where `column` moves by `step`
  // and, along the relation, the others take it back.
  long double Displacement(const Dependency& dependency, long double step,
                           bool along_relation) const {
    const VectorXl nominal = model_.NominalValues().cast<long double>();
    VectorXl moved = nominal;
    moved[dependency.column] += step;
    for (const auto& [other, coefficient] : dependency.terms) {
      if (along_relation) moved[other] -= coefficient * step;
    }
    long double farthest = 0.0L;
    for (Eigen::Index i = 0; i < data_.num_poses(); ++i) {
      const double* q = data_.joint_values.col(i).data();
      const testing::Vector3l way =
          testing::MatrixPosition(model_.nominal(), moved, q) -
          testing::MatrixPosition(model_.nominal(), nominal, q);
      farthest = std::max(farthest, way.norm());
    }
    return farthest;
  }

  MeasurementModel model_;
  Dataset data_;
  std::vector<Dependency> dependencies_;
};

TEST_P(Rv2ajRelationTest, CoefficientsAreTheKnownLengths) {
  Relations found;
  for (const Dependency& dependency : dependencies_) {
    ASSERT_EQ(dependency.terms.size(), 1U)
        << DescribeDependency(model_.layout(), dependency);
    const auto& [other, coefficient] = dependency.terms[0];
    found[model_.layout().parameter(dependency.column).name] = {
        model_.layout().parameter(other).name, coefficient};
  }
  ASSERT_EQ(found.size(), GetParam().expected.size());
  for (const auto& [name, relation] : GetParam().expected) {
    EXPECT_EQ(found[name].first, relation.first) << name;
    // In the plane the poses are off by the rounding of the joint values, 1e-6
    // of a radian, times what the other directions of the plane amplify.
    EXPECT_NEAR(found[name].second, relation.second, 1e-6) << name;
  }
}

// A relation holds to first order: the points stay but for the square of the
// step, a quarter of which is left at half the step.
TEST_P(Rv2ajRelationTest, MovingAlongItLeavesThePointsToSecondOrder) {
  constexpr long double kStep = 1e-2L;
  for (const Dependency& dependency : dependencies_) {
    SCOPED_TRACE(DescribeDependency(model_.layout(), dependency));
    const long double alone = Displacement(dependency, kStep, false);
    const long double whole = Displacement(dependency, kStep, true);
    const long double half = Displacement(dependency, kStep / 2, true);
    EXPECT_GT(alone, 0.05L * kStep);
    EXPECT_LT(whole, 2.0L * kStep * alone);
    EXPECT_NEAR(static_cast<double>(whole / half), 4.0, 0.05);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Arms, Rv2ajRelationTest,
    ::testing::Values(
        RelationCase{"WristInPlane",
                     testing::Rv2ajWrist(),
                     true,
                     {{"beta4", {"r2", -0.160}}, {"alpha2", {"r2", 0.085}}}},
        RelationCase{"WristGeneric",
                     testing::Rv2ajWrist(),
                     false,
                     {{"beta4", {"r2", -0.160}}}},
        RelationCase{"FlangeInPlane",
                     testing::Rv2ajFlange(),
                     true,
                     {{"alpha2", {"r2", 0.085}},
                      {"alpha5", {"r2", -0.072}},
                      {"theta4", {"d5", 0.072}}}},
        RelationCase{"FlangeGeneric",
                     testing::Rv2ajFlange(),
                     false,
                     {{"alpha5", {"r2", -0.072}}, {"theta4", {"d5", 0.072}}}}),
    NameOf);

// The base of the RV-2AJ turns about its first axis and moves along it.
TEST(FindDependenciesTest, KeepsWhatComesFirstInCanonicalOrder) {
  const MeasurementModel model(testing::Rv2ajFlange());
  const ParameterLayout& layout = model.layout();
  const Dataset data = testing::MeasureStudyPoses(model.nominal());
  const std::vector<int> columns =
      ColumnsOf(layout, {"alpha1", "theta1", "theta5", "r1", "base_z",
                         "base_rx", "base_rz", "tool_rx"});
  const std::vector<Dependency> dependencies =
      FindDependencies(model, model.NominalValues(), data, columns, 1e-6);
  std::vector<std::string> texts;
  for (const Dependency& dependency : dependencies) {
    texts.push_back(DescribeDependency(layout, dependency));
  }
  EXPECT_EQ(
      texts,
      (std::vector<std::string>{
          "tool_rx has no effect", "r1 is linearly dependent on base_z",
          "theta1 is linearly dependent on base_rz", "theta5 has no effect",
          "alpha1 is linearly dependent on base_rx"}));
}

// Two joints whose axes are `angle` apart: r2 is as far from r1.
MeasurementModel AlmostParallelAxes(double angle) {
  Arm arm;
  arm.joints.resize(2);
  arm.joints[0].r = 0.3;
  arm.joints[1].alpha = angle;
  arm.joints[1].d = 0.4;
  return MeasurementModel(arm);
}

Dataset TwoJointPoses(const MeasurementModel& model) {
  Dataset data;
  data.joint_values = Eigen::MatrixXd::Zero(2, 3);
  data.positions() = model.Predict(model.NominalValues(), data.joint_values);
  data.sigmas() = Eigen::MatrixXd::Ones(3, 3);
  return data;
}

TEST(FindDependenciesTest, ToleranceIsTheSineBetweenAColumnAndThoseKept) {
  const MeasurementModel model = AlmostParallelAxes(1e-3);
  const Dataset data = TwoJointPoses(model);
  const std::vector<int> columns = ColumnsOf(model.layout(), {"r1", "r2"});
  EXPECT_TRUE(
      FindDependencies(model, model.NominalValues(), data, columns, 0.99e-3)
          .empty());
  EXPECT_EQ(
      FindDependencies(model, model.NominalValues(), data, columns, 1.01e-3)
          .size(),
      1U);
}

// r1 points along (0, -sin angle, cos angle), so that it is linearly dependent
// on -sin angle * base_y + cos angle * base_z.
TEST(FindDependenciesTest, LeavesOutTermsBelowOneTenThousandth) {
  for (const double angle : {0.9e-4, 1.1e-4}) {
    Arm arm = AlmostParallelAxes(0.1).nominal();
    arm.instrument_from_base.linear() =
        testing::MatrixFromVector({angle, 0.0L, 0.0L}).cast<double>();
    const MeasurementModel model(arm);
    const std::vector<Dependency> dependencies = FindDependencies(
        model, model.NominalValues(), TwoJointPoses(model),
        ColumnsOf(model.layout(), {"r1", "base_y", "base_z"}), 1e-8);
    ASSERT_EQ(dependencies.size(), 1U);
    const auto& terms = dependencies[0].terms;
    ASSERT_EQ(terms.size(), angle < 1e-4 ? 1U : 2U);
    EXPECT_NEAR(terms.back().second, 1.0, 1e-7);  // cos(1e-4)
    if (terms.size() > 1) {
      EXPECT_NEAR(terms.front().second, -angle, 1e-9);
    }
  }
}

TEST(DescribeDependencyTest, SaysWhatActsAsWhatInMillimetresAndRadians) {
  const ParameterLayout layout(5);
  const auto describe =
      [&](const std::string& name,
          const std::vector<std::pair<std::string, double>>& terms) {
        Dependency dependency;
        dependency.column = layout.Find(name).value();
        for (const auto& [other, coefficient] : terms) {
          dependency.terms.emplace_back(layout.Find(other).value(),
                                        coefficient);
        }
        return DescribeDependency(layout, dependency);
      };
  EXPECT_EQ(describe("theta5", {}), "theta5 has no effect");
  EXPECT_EQ(describe("r4", {{"r2", 1.0}}), "r4 is linearly dependent on r2");
  EXPECT_EQ(describe("r4", {{"r2", -1.0}}), "r4 is linearly dependent on -r2");
  EXPECT_EQ(describe("r4", {{"r2", 0.5}}),
            "r4 is linearly dependent on 0.5 * r2");
  EXPECT_EQ(describe("alpha5", {{"r2", -0.072}}),
            "alpha5 is linearly dependent on -72 mm * r2");
  EXPECT_EQ(describe("d5", {{"theta4", 2.0}}),
            "d5 is linearly dependent on 0.002 /mm * theta4");
  EXPECT_EQ(
      describe("theta5", {{"theta4", 0.5}, {"d5", -0.072}, {"r1", 0.01}}),
      "theta5 is linearly dependent on 0.5 * theta4 - 72 mm * d5 + 10 mm * r1");
  EXPECT_EQ(describe("r3", {{"r1", -1.0}, {"r2", -1.0}, {"d2", 1.0}}),
            "r3 is linearly dependent on -r1 - r2 + d2");
}

}  // namespace
}  // namespace alidade::internal
