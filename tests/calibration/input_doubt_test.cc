// Slips of the input that are named, and results that are doubted.

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "alidade/error.h"
#include "alidade/units.h"
#include "src/job/run_job.h"
#include "src/model/joint_draw.h"
#include "tests/calibration/kinds_util.h"
#include "tests/support/edit.h"

namespace alidade::internal {
namespace {

// What people do wrong to a data set, and what the refusal has to say.
struct Slip {
  const char* name;
  const char* says;
  void (*spoil)(Dataset* data);
};

class SlipTest : public ::testing::TestWithParam<Slip> {};

TEST_P(SlipTest, IsNamed) {
  const Arm real = RealArm();
  const Eigen::MatrixXd q = DrawJointValues(real, 60, 5);
  JobConfig job;
  job.arm = NominalArm();
  job.data.training = Bench(real, q).Positions(0).data();
  job.options.identifiability.candidates = {true, true, true};
  GetParam().spoil(&job.data.training);
  try {
    RunJob(job, "test");
    FAIL() << "expected an error";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find(GetParam().says),
              std::string::npos)
        << error.what();
  }
}

INSTANTIATE_TEST_SUITE_P(
    Slips, SlipTest,
    ::testing::Values(
        Slip{"degrees", "in degrees but read as radians",
             [](Dataset* data) {
               *testing::Edit(&data->joint_values) /= kDegree;
             }},
        Slip{"radians", "in radians but read as degrees",
             [](Dataset* data) {
               *testing::Edit(&data->joint_values) *= kDegree;
             }},
        Slip{"millimetres", "in mm but read as m",
             [](Dataset* data) { *testing::Edit(&data->positions()) *= 1e3; }},
        Slip{"metres", "in m but read as mm",
             [](Dataset* data) { *testing::Edit(&data->positions()) /= 1e3; }},
        Slip{"centimetres", "cm read as mm",
             [](Dataset* data) { *testing::Edit(&data->positions()) *= 0.1; }},
        Slip{"inches", "in inches but read as mm",
             [](Dataset* data) { *testing::Edit(&data->positions()) /= 25.4; }},
        Slip{"zero", "zero of joint 2 is elsewhere: add 90 deg",
             [](Dataset* data) {
               testing::Edit(&data->joint_values)->row(1).array() -=
                   90.0 * kDegree;
             }},
        Slip{"joints", "q2 and q3 are swapped",
             [](Dataset* data) {
               auto q = testing::Edit(&data->joint_values);
               q->row(1).swap(q->row(2));
             }},
        Slip{"axes", "mirror image",
             [](Dataset* data) {
               auto p = testing::Edit(&data->positions());
               p->row(0).swap(p->row(2));
             }},
        Slip{"sign", "joint 2 counts the other way",
             [](Dataset* data) {
               testing::Edit(&data->joint_values)->row(1) *= -1.0;
             }},
        Slip{"late", "one row late",
             [](Dataset* data) {
               auto p = testing::Edit(&data->positions());
               p->rightCols(59) = p->leftCols(59).eval();
             }}),
    [](const ::testing::TestParamInfo<Slip>& slip) {
      return std::string(slip.param.name);
    });

TEST(DoubtTest, DataThatNoSlipExplainsAreWarnedOf) {
  const Arm real = RealArm();
  const Eigen::MatrixXd q = DrawJointValues(real, 60, 5);
  JobConfig job;
  job.arm = NominalArm();
  job.data.training = Bench(real, q).Positions(0).data();
  job.options.identifiability.candidates = {true, true, true};
  job.data.training.positions() =
      job.data.training.positions().map().rowwise().reverse();
  const CalibrationResult outcome = RunJob(job, "test");
  ASSERT_FALSE(outcome.warnings.empty());
  EXPECT_NE(outcome.warnings.front().find("No single slip"), std::string::npos)
      << outcome.warnings.front();
}

// An arm whose joints hardly moved would fit to a small cloud of positions.
TEST(DoubtTest, ASmallCloudExplainsNothing) {
  const Arm real = RealArm();
  const Eigen::MatrixXd q = DrawJointValues(real, 60, 5);
  JobConfig job;
  job.arm = NominalArm();
  job.data.training = Bench(real, q).Positions(0).data();
  job.options.identifiability.candidates = {true, true, true};
  *testing::Edit(&job.data.training.positions()) /= 300.0;  // no unit
  testing::Edit(&job.data.training.positions())->colwise() +=
      Eigen::Vector3d(0.4, 0.1, 0.3);
  const CalibrationResult outcome = RunJob(job, "test");
  EXPECT_NE(outcome.warnings.front().find("No single slip"), std::string::npos);
}

bool IsWarnedOf(const CalibrationResult& outcome, const std::string& what) {
  const std::vector<std::string>& warnings = outcome.warnings;
  return std::any_of(warnings.begin(), warnings.end(),
                     [&](const std::string& warning) {
                       return warning.find(what) != std::string::npos;
                     });
}

TEST(DoubtTest, LostTargetsAndTheWorstMeasurementAreNamed) {
  const Arm real = RealArm();
  const Eigen::MatrixXd q = DrawJointValues(real, 60, 5);
  JobConfig job = JobOf(Bench(real, q).Positions(0).data());
  job.data.training.files = {"tracker.csv"};
  job.data.training.sources.Append({0, 2}, 42);
  const CalibrationResult clean = RunJob(job, "test");
  EXPECT_FALSE(IsWarnedOf(clean, "0, 0, 0"));
  EXPECT_FALSE(IsWarnedOf(clean, "fits worst"));
  testing::Edit(&job.data.training.positions())->col(3).setZero();
  const CalibrationResult spoilt = RunJob(job, "test");
  EXPECT_TRUE(IsWarnedOf(
      spoilt, "tracker.csv:5: 1 position is exactly 0, 0, 0, which"));
  EXPECT_TRUE(
      IsWarnedOf(spoilt, "tracker.csv:5: the measurement that fits worst is"));
}

// One wrong position in 42: the solver wanders until it is stopped, and what it
// ends with is further off elsewhere.
TEST(DoubtTest, StoppedAndWorseThanBeforeIsAFailure) {
  const Arm real = RealArm();
  const Eigen::MatrixXd q = DrawJointValues(real, 60, 5);
  JobConfig job = JobOf(Bench(real, q).Positions(0).data());
  EXPECT_EQ(RunJob(job, "test").status, CalibrationStatus::kDone);
  testing::Edit(&job.data.training.positions())->col(3).setZero();
  const CalibrationResult outcome = RunJob(job, "test");
  EXPECT_EQ(outcome.runs[0].summary.status, SolverStatus::kIterationLimit);
  EXPECT_EQ(outcome.status, CalibrationStatus::kFailed);
  EXPECT_NE(outcome.message.find("further off than before"), std::string::npos)
      << outcome.message;
}

TEST(DoubtTest, OrientationsInAnotherConventionAreRefused) {
  const Arm real = RealArm();
  const Eigen::MatrixXd q = DrawJointValues(real, 60, 5);
  JobConfig job = JobOf(Bench(real, q).Poses().data());
  // The inverse rotation: what reads target and instrument the wrong way.
  testing::Edit(&job.data.training.blocks[0].measured)->bottomRows<3>() *= -1.0;
  EXPECT_THROW(RunJob(job, "test"), InputError);
}

}  // namespace
}  // namespace alidade::internal
