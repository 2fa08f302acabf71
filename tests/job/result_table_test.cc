#include "src/job/result_table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "src/report/report.h"
#include "tests/report/report_test_util.h"
#include "tests/support/edit.h"

namespace alidade::internal {
namespace {

using testing::ContentOf;

void ExpectTable(const ResultTable& table) {
  ASSERT_EQ(table.columns,
            (std::vector<std::string>{"pose", "target", "x_mm"}));
  ASSERT_EQ(table.num_rows, 3U);
  EXPECT_EQ(table.texts[1][0], "a, \"b\"");
  EXPECT_TRUE(table.texts[2].empty());
  EXPECT_EQ(table.Number(0, "x_mm"), 2.5);
  EXPECT_TRUE(std::isnan(table.Number(1, "x_mm")));
  EXPECT_TRUE(std::isnan(table.Number(2, "x_mm")));
  EXPECT_TRUE(std::isnan(table.Number(0, "target")));
  EXPECT_TRUE(std::isnan(table.Number(0, "y_mm")));
  EXPECT_EQ(table.Column("y_mm"), -1);
}

TEST(ResultTableTest, ReadsQuotedCellsAndShortRows) {
  const std::string csv = "pose,target,x_mm\r\n1,\"a, \"\"b\"\"\",2.5\n2,,\n3";
  ExpectTable(ReadResultTable(MappedFile("a.csv", csv), {"target"}));
  EXPECT_TRUE(ReadResultTable(MappedFile("a.csv", ""), {}).columns.empty());
}

EvaluatedSet ReadBack(const EvaluatedSet& set) {
  CalibrationResult result = testing::MakeResult();
  result.train = set;
  EvaluatedSet read;
  ReadObservations(ReadResultTable(MappedFile("residuals.csv",
                                              ContentOf(MakeCsvFiles(result),
                                                        "residuals.csv")),
                                   {"kind", "target", "where"}),
                   &read);
  return read;
}

void ExpectNear(const SharedMatrix& read, const SharedMatrix& written) {
  // Units are changed twice, which rounds.
  constexpr double kRounding = 1e-15;
  ASSERT_EQ(read.rows(), written.rows());
  ASSERT_EQ(read.cols(), written.cols());
  for (Eigen::Index i = 0; i < read.cols(); ++i) {
    for (Eigen::Index k = 0; k < read.rows(); ++k) {
      if (std::isnan(written(k, i))) {
        EXPECT_TRUE(std::isnan(read(k, i)));
      } else {
        EXPECT_NEAR(read(k, i), written(k, i), kRounding);
      }
    }
  }
}

TEST(ReadObservationsTest, APositionPerPoseReadsBack) {
  const EvaluatedSet set = testing::MakeSet(5, 5.21e-3, 2.1e-16);
  const EvaluatedSet read = ReadBack(set);
  EXPECT_EQ(read.joint_dimensions, set.joint_dimensions);
  EXPECT_TRUE(read.labels.empty());
  ExpectNear(read.joint_values, set.joint_values);
  ExpectNear(read.positions, set.positions);
  ExpectNear(read.residual_before, set.residual_before);
  ExpectNear(read.residual_after, set.residual_after);
}

TEST(ReadObservationsTest, SeveralKindsReadBack) {
  const EvaluatedSet set = testing::MakeMixedSet();
  const EvaluatedSet read = ReadBack(set);
  ASSERT_EQ(read.labels.size(), set.labels.size());
  for (std::size_t i = 0; i < set.labels.size(); ++i) {
    EXPECT_EQ(read.labels[i].kind, set.labels[i].kind);
    EXPECT_EQ(read.labels[i].target, set.labels[i].target);
    EXPECT_EQ(read.labels[i].where, set.labels[i].where);
    EXPECT_EQ(read.labels[i].pose, set.labels[i].pose);
    EXPECT_EQ(read.labels[i].has_length, set.labels[i].has_length);
    EXPECT_EQ(read.labels[i].has_rotation, set.labels[i].has_rotation);
  }
  ExpectNear(read.joint_values, set.joint_values);
  ExpectNear(read.positions, set.positions);
  ExpectNear(read.residual_before, set.residual_before);
  ExpectNear(read.residual_after, set.residual_after);
  EXPECT_NEAR(read.rotation_residual_after.col(2).norm(), 0.25 * kDegree,
              1e-15);
}

TEST(ReadJointResidualsTest, ReadsBackWhatIsWritten) {
  CalibrationResult result = testing::MakeResult();
  result.arm.joints.resize(2);
  result.arm.joints[1].type = JointType::kPrismatic;
  result.arm.errors.joints.resize(2);
  ErrorTermsResult& errors = result.error_terms.emplace();
  errors.share = 1.0;
  errors.residuals.poses = {0, 4, 9};
  errors.residuals.joint_values = Eigen::MatrixXd::Random(2, 3);
  errors.residuals.geometry = 1e-3 * Eigen::MatrixXd::Random(2, 3);
  errors.residuals.remaining = 1e-4 * Eigen::MatrixXd::Random(2, 3);
  errors.residuals.remaining(1, 2) = std::nan("");
  JointResiduals read;
  ReadJointResiduals(
      ReadResultTable(MappedFile("joint_residuals.csv",
                                 ContentOf(MakeErrorTermFiles(result),
                                           "joint_residuals.csv")),
                      {}),
      &read);
  EXPECT_EQ(read.poses, errors.residuals.poses);
  ExpectNear(read.joint_values, errors.residuals.joint_values);
  ExpectNear(read.geometry, errors.residuals.geometry);
  ExpectNear(read.remaining, errors.residuals.remaining);
}

}  // namespace
}  // namespace alidade::internal
