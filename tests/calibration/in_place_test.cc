// Data that stay in their file (src/dataio/npy_table.h), all the way through a
// job.

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <string>

#include "src/dataio/dataset_csv.h"
#include "src/dataio/dataset_npy.h"
#include "src/job/run_job.h"
#include "tests/support/noisy_positions.h"
#include "tests/support/process.h"
#include "tests/support/rv2aj_arms.h"

namespace alidade::internal::in_place_test {
namespace {

constexpr double kSigma = 2e-5;  // m

class InPlaceTest : public ::testing::Test {
 protected:
  InPlaceTest() {
    const Dataset measured = testing::NoisyPositions(
        testing::WithRv2ajDeviations(arm_), 500, kSigma, 7);
    testing::WriteWhole(path_, FormatNpy(measured, arm_, true));
  }

  CalibrationResult Calibrate(std::int64_t fewest_bytes_in_place) {
    ReadOptions options;
    options.fewest_bytes_in_place = fewest_bytes_in_place;
    References references;
    JobConfig job;
    job.arm = arm_;
    job.data.training =
        LoadDataWith({path_, arm_, format_}, &references, options).data;
    job.data.validation = job.data.training;
    stride_ = job.data.training.joint_values.stride();
    job.options.num_threads = 2;
    return RunJob(job, "test");
  }

  const DataFormat format_;
  const Arm arm_ = testing::Rv2ajFlange();
  const testing::TemporaryDirectory directory_;
  const std::string path_ = directory_ / "data.npy";
  Eigen::Index stride_ = 0;
};

TEST_F(InPlaceTest, AJobHasTheBitsThatItHasOfACopy) {
  const CalibrationResult copied =
      Calibrate(std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(stride_, 5);
  const CalibrationResult in_place = Calibrate(0);
  EXPECT_EQ(stride_, 11);  // joints, a position and its sigmas
  ASSERT_EQ(copied.status, CalibrationStatus::kDone) << copied.message;
  ASSERT_EQ(in_place.status, CalibrationStatus::kDone) << in_place.message;
  const CalibrationResult& a = copied;
  const CalibrationResult& b = in_place;
  EXPECT_EQ(a.runs[0].values, b.runs[0].values);
  EXPECT_EQ(a.train.joint_values, b.train.joint_values);
  EXPECT_EQ(a.train.positions, b.train.positions);
  EXPECT_EQ(a.train.residual_after, b.train.residual_after);
  EXPECT_EQ(a.validation->residual_after, b.validation->residual_after);
  EXPECT_EQ(a.train.after.p95, b.train.after.p95);
  EXPECT_EQ(a.uncertainty->residuals.chi_square,
            b.uncertainty->residuals.chi_square);
  // That they are of the same calibration is not enough: it is a good one.
  EXPECT_NEAR(a.reduced_chi_square, 1.0, 0.15);
}

}  // namespace
}  // namespace alidade::internal::in_place_test
