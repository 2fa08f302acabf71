// Observations that are off: found among training and validation poses, left
// out where the loss rejects them, and nearly half of them off together.

#include "src/calibration/outliers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "src/calibration/evaluate.h"
#include "src/job/run_job.h"
#include "src/model/joint_draw.h"
#include "tests/calibration/kinds_util.h"

namespace alidade::internal::outliers_test {
namespace {

using ::testing::HasSubstr;

constexpr int kPoses = 60;

Dataset Measured(const Arm& real, int poses, int seed) {
  return Bench(real,
               DrawJointValues(real, poses, static_cast<std::uint64_t>(seed)))
      .Positions(0)
      .data();
}

JobConfig JobWithValidation(LossKind loss) {
  JobConfig job = WholeJobOf(Measured(RealArm(), kPoses, 5));
  job.data.validation = Measured(RealArm(), kPoses, 6);
  job.options.loss = loss;
  return job;
}

void Shift(const Eigen::Vector3d& by, Eigen::Index i, Dataset* data) {
  testing::Edit(&data->blocks[0].measured)->col(i) += by;
}

const Finding* Find(const CalibrationResult& result, const std::string& key) {
  for (const Finding& finding : result.verdict.findings) {
    if (finding.key == key) return &finding;
  }
  return nullptr;
}

// The error at the other poses, of which `skipped` is none.
Accuracy ErrorsWithout(const EvaluatedSet& set, Eigen::Index skipped) {
  Eigen::VectorXd errors(set.after.n - 1);
  for (Eigen::Index i = 0, k = 0; i < set.after.n; ++i) {
    if (i != skipped) errors[k++] = set.residual_after.col(i).norm();
  }
  return SummarizeErrors(errors);
}

TEST(ValidationOutlierTest, IsRejectedByARobustLoss) {
  JobConfig job = JobWithValidation(LossKind::kTukey);
  job.options.acceptance.validation_max = 5e-4;
  Shift({0, 0, 4e-3}, 17, &*job.data.validation);
  const CalibrationResult result = RunJob(job, "test");
  ASSERT_EQ(result.status, CalibrationStatus::kDone) << result.message;
  ASSERT_EQ(result.validation_outliers.size(), 1u);
  const Outlier& outlier = result.validation_outliers[0];
  EXPECT_EQ(outlier.observation, 17);
  EXPECT_EQ(outlier.weight, 0.0);
  // 4 mm of some 0.05 mm, the parameters' part included.
  EXPECT_GT(outlier.standardised, 40.0);
  EXPECT_LT(outlier.standardised, 85.0);
  ASSERT_TRUE(result.validation->kept);
  EXPECT_EQ(result.validation->kept->num_rejected, 1);
  const Accuracy expected = ErrorsWithout(*result.validation, 17);
  EXPECT_DOUBLE_EQ(result.validation->kept->after.mean, expected.mean);
  EXPECT_DOUBLE_EQ(result.validation->kept->after.max, expected.max);
  EXPECT_GT(result.validation->after.max, 3.5e-3);
  EXPECT_EQ(result.acceptance[0].obtained, expected.max);
  EXPECT_EQ(result.acceptance[0].num_rejected, 1);
  EXPECT_THAT(result.verdict.sentence,
              HasSubstr("at 59 validation poses, without 1 rejected "
                        "observation, falls"));
  // Predictions are compared with the others.
  EXPECT_EQ(result.uncertainty->validation->num_outliers, 1);
  EXPECT_EQ(result.uncertainty->validation->axes.n, 3 * (kPoses - 1));
  EXPECT_NEAR(result.uncertainty->validation->rms_z, 1.0, 0.25);
}

TEST(ValidationOutlierTest, IsListedWithoutALossAndCounts) {
  JobConfig job = JobWithValidation(LossKind::kNone);
  job.options.acceptance.validation_max = 5e-4;
  Shift({0, 0, 4e-3}, 17, &*job.data.validation);
  const CalibrationResult result = RunJob(job, "test");
  EXPECT_EQ(result.status, CalibrationStatus::kMissedLimits);
  ASSERT_EQ(result.validation_outliers.size(), 1u);
  EXPECT_EQ(result.validation_outliers[0].weight, 1.0);
  EXPECT_FALSE(result.validation->kept);
  EXPECT_GT(result.acceptance[0].obtained, 3.5e-3);
  const Finding* found = Find(result, "validation_outliers");
  ASSERT_NE(found, nullptr);
  EXPECT_THAT(found->sentence, HasSubstr("The errors contain them."));
  EXPECT_EQ(found->level, FindingLevel::kAttention);
  EXPECT_NEAR(result.uncertainty->validation->rms_z, 1.0, 0.25);
}

// A fit that does not describe the validation poses is not excused by calling
// half of them outliers.
TEST(ValidationOutlierTest, TooManyAreNoOutliers) {
  JobConfig job = JobWithValidation(LossKind::kTukey);
  for (Eigen::Index i = 0; i < 20; ++i) {
    Shift({2e-3, 0, 0}, 3 * i, &*job.data.validation);
  }
  const CalibrationResult result = RunJob(job, "test");
  EXPECT_GE(result.validation_outliers.size(), 20u);
  EXPECT_FALSE(result.validation->kept);
  EXPECT_EQ(result.uncertainty->validation->num_outliers, 0);
  EXPECT_GT(result.uncertainty->validation->rms_z, 5.0);
  const Finding* found = Find(result, "validation_outliers");
  ASSERT_NE(found, nullptr);
  EXPECT_THAT(found->sentence, HasSubstr("none is left out"));
}

// Accuracy, chi-square and the last iteration are of the same observations.
TEST(RejectedTest, AreLeftOutOfAllThatIsJudged) {
  JobConfig job = WholeJobOf(Measured(RealArm(), 2 * kPoses, 5));
  job.options.loss = LossKind::kTukey;
  Shift({0, 6e-3, 0}, 3, &job.data.training);
  const CalibrationResult result = RunJob(job, "test");
  ASSERT_EQ(result.status, CalibrationStatus::kDone) << result.message;
  ASSERT_TRUE(result.train.kept);
  const KeptErrors& kept = *result.train.kept;
  EXPECT_EQ(kept.after.n, 2 * kPoses - kept.num_rejected);
  EXPECT_LT(kept.after.max, 3e-4);
  EXPECT_GT(result.train.after.max, 5e-3);
  const SolverSummary& summary = result.runs[0].summary;
  EXPECT_EQ(summary.num_rejected, kept.num_rejected);
  EXPECT_EQ(summary.iterations.back().max_error, kept.after.max);
  EXPECT_EQ(summary.iterations.back().rms_error, kept.after.rms);
  // 333 degrees of freedom: 8 % is a standard deviation.
  EXPECT_NEAR(result.reduced_chi_square, 1.0, 0.25);
  EXPECT_NEAR(result.uncertainty->residuals.reduced_chi_square, 1.0, 0.25);
}

class CoherentOutlierTest : public ::testing::TestWithParam<int> {};

// A scale from all residuals would take both groups in and call it noise.
TEST_P(CoherentOutlierTest, NearlyHalfAreFoundWithSigmaEstimated) {
  const Arm real = RealArm();
  JobConfig job = WholeJobOf(Measured(real, 90, 5));
  job.options.loss = LossKind::kTukey;
  job.options.estimate_sigma = true;
  for (Eigen::Index i = 0; i < 90; ++i) {
    if ((i * 37) % 100 < GetParam()) {
      Shift({3e-3, -4e-3, 2e-3}, i, &job.data.training);
    }
  }
  const CalibrationResult result = RunJob(job, "test");
  ASSERT_EQ(result.status, CalibrationStatus::kDone) << result.message;
  // Of the median of all, which outliers raise to the 5/6 quantile.
  EXPECT_GT(result.estimated_sigma, 0.6 * kSigma);
  EXPECT_LT(result.estimated_sigma, 2.0 * kSigma);
  EXPECT_LT(CompareArms(result.arm, real, 500, 9).rms, 1.2e-4);
  ASSERT_TRUE(result.train.kept.has_value());
  const auto rejected = static_cast<double>(result.train.kept->num_rejected);
  EXPECT_NEAR(rejected / 90.0, GetParam() / 100.0, 0.05);
  EXPECT_NE(result.verdict.level, FindingLevel::kPassed);
}

INSTANTIATE_TEST_SUITE_P(Percent, CoherentOutlierTest,
                         ::testing::Values(20, 40, 44));

// Those that were rejected, if any were, since they are what a note speaks of.
TEST(PlacesTest, TheFirstThreeAreNamed) {
  std::vector<Outlier> outliers(5);
  for (std::size_t k = 0; k < outliers.size(); ++k) {
    outliers[k].label.where = "a.csv:" + std::to_string(k + 2);
  }
  EXPECT_EQ(PlacesOf(outliers), " (a.csv:2, a.csv:3, a.csv:4 and 2 more)");
  outliers[1].weight = outliers[4].weight = 0.0;
  EXPECT_EQ(PlacesOf(outliers), " (a.csv:3, a.csv:6)");
  outliers[4].label.where.clear();
  EXPECT_EQ(PlacesOf(outliers), "");
  EXPECT_EQ(PlacesOf({}), "");
}

}  // namespace
}  // namespace alidade::internal::outliers_test
