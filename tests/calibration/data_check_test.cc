#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>

#include "alidade/calibration.h"
#include "alidade/error.h"
#include "tests/support/edit.h"
#include "tests/support/noisy_positions.h"
#include "tests/support/rv2aj_arms.h"

namespace alidade::internal::data_check_test {
namespace {

using ::testing::HasSubstr;

// What Calibrate says of data that `spoil` has changed; empty: nothing.
std::string Refusal(const std::function<void(CalibrationData*)>& spoil,
                    const CalibrationOptions& options = {}) {
  const Arm arm = testing::Rv2ajFlange();
  CalibrationData data(testing::NoisyPositions(arm, 40, 2e-5, 7));
  spoil(&data);
  try {
    Calibrate(arm, data, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(DataCheckTest, ConsistentDataAreCalibrated) {
  EXPECT_EQ(Refusal([](CalibrationData*) {}), "");
}

TEST(DataCheckTest, EverySizeThatDisagreesIsNamed) {
  EXPECT_THAT(Refusal([](CalibrationData* data) {
                Dataset& set = data->training;
                set.positions() = set.positions().Columns(0, 39);
                set.sigmas() = set.sigmas().Columns(0, 39);
              }),
              HasSubstr("39 observations of kind \"position\" at 40 poses"));
  EXPECT_THAT(Refusal([](CalibrationData* data) {
                data->training.sigmas() =
                    data->training.sigmas().Columns(0, 39);
              }),
              HasSubstr("sigmas of kind \"position\" are 3 x 39, expected 3 x "
                        "40"));
  EXPECT_THAT(Refusal([](CalibrationData* data) {
                const Eigen::MatrixXd all = data->training.joint_values.map();
                data->training.joint_values = all.topRows(4);
              }),
              HasSubstr("4 joint values a pose, expected 5"));
}

TEST(DataCheckTest, IndicesBeyondWhatIsThereAreNamed) {
  EXPECT_THAT(Refusal([](CalibrationData* data) {
                data->training.blocks[0].targets.assign(40, 1);
              }),
              HasSubstr("target 1 is not among the 1 there are"));
  EXPECT_THAT(Refusal([](CalibrationData* data) {
                data->training.blocks[0].poses.assign(40, -1);
              }),
              HasSubstr("pose -1 is not among the 40 there are"));
  EXPECT_THAT(Refusal([](CalibrationData* data) {
                data->training.blocks[0].kind = MeasurementKind::kFixedPoint;
              }),
              HasSubstr("0 indices of reference, expected 40"));
}

// A fit finds out by itself; the error at validation poses would be no number.
TEST(DataCheckTest, ValidationThatIsNotFiniteIsRefusedAtItsPose) {
  EXPECT_THAT(Refusal([](CalibrationData* data) {
                data->validation = data->training;
                testing::Edit(&data->validation->positions()).at(2, 7) =
                    std::numeric_limits<double>::quiet_NaN();
              }),
              HasSubstr("pose 7 (from 0): a measured value is not a finite"));
}

TEST(DataCheckTest, AHoldOutThatLeavesNothingToFitIsRefused) {
  CalibrationOptions options;
  options.holdout = HoldOutOptions{HoldOutBy::kPose, 0.99, 1};
  EXPECT_THAT(Refusal([](CalibrationData*) {}, options),
              HasSubstr("holdout.fraction leaves no configuration"));
}

// 5000 would take 12 GB before anybody hears of it.
TEST(DataCheckTest, MoreReferencesThanFitAreRefused) {
  EXPECT_THAT(
      Refusal([](CalibrationData* data) {
        data->references.points.resize(5000);
        for (std::size_t k = 3000; k < 5000; ++k) {
          data->references.points[k].is_known = true;
        }
      }),
      HasSubstr("3000 points and planes are to be found, at most 1000"));
}

TEST(DataCheckTest, BoundsOfUnknownParametersAreRefused) {
  CalibrationOptions options;
  options.bounds = {{"d9", -1.0, 1.0}};
  EXPECT_THAT(Refusal([](CalibrationData*) {}, options),
              HasSubstr("bounds: the arm has no parameter \"d9\""));
}

}  // namespace
}  // namespace alidade::internal::data_check_test
