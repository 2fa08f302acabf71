// Input mistakes that are named, and results that are warned of.

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "alidade/error.h"
#include "alidade/rotation.h"
#include "alidade/units.h"
#include "src/job/run_job.h"
#include "src/model/joint_draw.h"
#include "tests/calibration/kinds_util.h"

namespace alidade::internal::plausibility_test {
namespace {

// What people do wrong to a data set, and what the refusal has to say.
struct InputMistake {
  const char* name;
  const char* says;
  void (*spoil)(Dataset* data);
};

// Few, since what takes the tests their time is the fits of all mistakes that
// might have been made.
constexpr int kPoses = 32;

class InputMistakeTest : public ::testing::TestWithParam<InputMistake> {};

TEST_P(InputMistakeTest, IsNamed) {
  const Arm real = RealArm();
  const Eigen::MatrixXd q = DrawJointValues(real, kPoses, 5);
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
    Mistakes, InputMistakeTest,
    ::testing::Values(
        InputMistake{"degrees", "in degrees but read as radians",
                     [](Dataset* data) {
                       *testing::Edit(&data->joint_values) /= kDegree;
                     }},
        InputMistake{"radians", "in radians but read as degrees",
                     [](Dataset* data) {
                       *testing::Edit(&data->joint_values) *= kDegree;
                     }},
        InputMistake{
            "millimetres", "in mm but read as m",
            [](Dataset* data) { *testing::Edit(&data->positions()) *= 1e3; }},
        InputMistake{
            "metres", "in m but read as mm",
            [](Dataset* data) { *testing::Edit(&data->positions()) /= 1e3; }},
        // They lie within a thousandth of what the joints move the target by.
        InputMistake{"metres_and_columns", "in m but read as mm",
                     [](Dataset* data) {
                       auto q = testing::Edit(&data->joint_values);
                       q->row(1).swap(q->row(2));
                       *testing::Edit(&data->positions()) /= 1e3;
                     }},
        InputMistake{
            "centimetres", "cm read as mm",
            [](Dataset* data) { *testing::Edit(&data->positions()) *= 0.1; }},
        InputMistake{
            "inches", "in inches but read as mm",
            [](Dataset* data) { *testing::Edit(&data->positions()) /= 25.4; }},
        InputMistake{"zero", "zero of joint 2 is elsewhere: add 90 deg",
                     [](Dataset* data) {
                       testing::Edit(&data->joint_values)->row(1).array() -=
                           90.0 * kDegree;
                     }},
        InputMistake{"joints", "q2 and q3 are swapped",
                     [](Dataset* data) {
                       auto q = testing::Edit(&data->joint_values);
                       q->row(1).swap(q->row(2));
                     }},
        InputMistake{"axes", "mirror image",
                     [](Dataset* data) {
                       auto p = testing::Edit(&data->positions());
                       p->row(0).swap(p->row(2));
                     }},
        InputMistake{"sign", "joint 2 counts the other way",
                     [](Dataset* data) {
                       testing::Edit(&data->joint_values)->row(1) *= -1.0;
                     }},
        InputMistake{"coupling",
                     "joint 3 is coupled to joint 2: its motor counts q3 + q2; "
                     "give row 3 of `motors` a -1 in column 2",
                     [](Dataset* data) {
                       auto q = testing::Edit(&data->joint_values);
                       q->row(2) += q->row(1);
                     }},
        InputMistake{
            "grad", "in grad (400 a turn) but read as degrees",
            [](Dataset* data) { *testing::Edit(&data->joint_values) /= 0.9; }},
        InputMistake{"feet", "in feet but read as m",
                     [](Dataset* data) {
                       *testing::Edit(&data->positions()) /= 0.3048;
                     }},
        InputMistake{"order", "the joints are in reversed order",
                     [](Dataset* data) {
                       auto q = testing::Edit(&data->joint_values);
                       *q = q->colwise().reverse().eval();
                     }},
        InputMistake{"one_angle", "column q2 alone is in degrees",
                     [](Dataset* data) {
                       testing::Edit(&data->joint_values)->row(1) /= kDegree;
                     }},
        InputMistake{"one_length", "column z alone is in m but read as mm",
                     [](Dataset* data) {
                       testing::Edit(&data->positions())->row(2) /= 1e3;
                     }},
        InputMistake{"still", "the instrument had stopped",
                     [](Dataset* data) {
                       auto p = testing::Edit(&data->positions());
                       *p = p->col(0).replicate(1, kPoses).eval();
                     }},
        InputMistake{"column", "column q2 is one row late",
                     [](Dataset* data) {
                       auto q = testing::Edit(&data->joint_values);
                       q->row(1).tail(kPoses - 1) =
                           q->row(1).head(kPoses - 1).eval();
                     }},
        // A log of another program: both units at once.
        InputMistake{"both_units", "state the unit rad; and the positions are",
                     [](Dataset* data) {
                       *testing::Edit(&data->joint_values) *= kDegree;
                       *testing::Edit(&data->positions()) /= 1e3;
                     }},
        InputMistake{"two_signs",
                     "joint 2 counts the other way: give it `sign: -1` in the "
                     "arm file; and joint 3 counts the other way",
                     [](Dataset* data) {
                       testing::Edit(&data->joint_values)->middleRows(1, 2) *=
                           -1.0;
                     }},
        InputMistake{"lost", "2 positions are more than",
                     [](Dataset* data) {
                       auto p = testing::Edit(&data->positions());
                       p->col(7).setConstant(1e30);
                       p->col(20).setConstant(-9999.0);
                     }},
        InputMistake{"late", "one row late",
                     [](Dataset* data) {
                       auto p = testing::Edit(&data->positions());
                       p->rightCols(kPoses - 1) =
                           p->leftCols(kPoses - 1).eval();
                     }}),
    [](const ::testing::TestParamInfo<InputMistake>& mistake) {
      return std::string(mistake.param.name);
    });

std::string RefusalOf(const Dataset& data) {
  try {
    RunJob(WholeJobOf(data), "test");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

// A file that couples joints which are not: its own matrix is mended.
TEST(PlausibilityTest, CouplingsOfTheFileAreMended) {
  const Arm real = RealArm();
  JobConfig job;
  job.arm = NominalArm();
  job.arm.joints_from_motors = Eigen::MatrixXd::Identity(6, 6);
  job.arm.joints_from_motors(2, 1) = -1.0;
  job.arm.motor_offsets = Eigen::VectorXd::Zero(6);
  const Eigen::MatrixXd motors = DrawJointValues(real, 60, 5);
  job.data.training = Bench(real, motors).Positions(0).data();
  // As a reader of the file would have it.
  job.data.training.joint_values = JointsFromMotors(job.arm, motors);
  job.options.identifiability.candidates = {true, true, true};
  try {
    RunJob(job, "test");
    FAIL() << "expected an error";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what())
                  .find("make row 3 of `motors` [0, 0, 1, 0, 0, 0]"),
              std::string::npos)
        << error.what();
  }
}

// Repeats of one pose lie as far apart as the noise: no mistake of input.
TEST(PlausibilityTest, NoiseOfOnePoseIsNoMistake) {
  const Arm real = RealArm();
  const Eigen::MatrixXd q = DrawJointValues(real, 1, 5).replicate(1, 30).eval();
  JobConfig job;
  job.arm = NominalArm();
  job.data.training = Bench(real, q).Positions(0).data();
  job.options.identifiability.candidates = {true, true, true};
  EXPECT_TRUE(RunJob(job, "test").plausibility.empty());
}

// The instrument is moved after the first 35 of 60 poses.
TEST(PlausibilityTest, TwoStationsAreNamedWithTheirPlace) {
  const Arm real = RealArm();
  Arm moved = real;
  moved.instrument_from_base.pretranslate(Eigen::Vector3d(0.4, -0.9, 0.1));
  moved.instrument_from_base.prerotate(
      RotationFromVector<double>(Eigen::Vector3d(0.0, 0.1, 0.8)));
  const Eigen::MatrixXd q = DrawJointValues(real, 60, 5);
  Dataset data = Bench(real, q).Positions(0).data();
  const Dataset others = Bench(moved, q).Positions(0).data();
  for (Eigen::Index i = 35; i < 60; ++i) {
    testing::Edit(&data.blocks[0].measured)->col(i) =
        others.blocks[0].measured.col(i);
  }
  const std::string refusal = RefusalOf(data);
  EXPECT_NE(refusal.find("fit in two parts"), std::string::npos) << refusal;
  EXPECT_NE(refusal.find("position 36 on"), std::string::npos) << refusal;
}

// As of a camera on the tool that looks at a mark.
TEST(PlausibilityTest, InversePosesAreNamed) {
  const Arm real = RealArm();
  Dataset data = Bench(real, DrawJointValues(real, 60, 5)).Poses().data();
  EXPECT_EQ(RefusalOf(data), "");
  for (Eigen::Index i = 0; i < 60; ++i) {
    const Eigen::VectorXd measured = data.blocks[0].measured.col(i);
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = RotationFromVector<double>(measured.tail<3>().eval());
    pose.translation() = measured.head<3>();
    pose = pose.inverse();
    testing::Edit(&data.blocks[0].measured)->col(i).head<3>() =
        pose.translation();
    testing::Edit(&data.blocks[0].measured)->col(i).tail<3>() =
        VectorFromRotation<double>(pose.linear());
  }
  const std::string refusal = RefusalOf(data);
  EXPECT_NE(refusal.find("if the poses are inverse"), std::string::npos)
      << refusal;
}

TEST(PlausibilityTest, DataThatNoMistakeExplainsAreWarnedOf) {
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
  EXPECT_NE(outcome.warnings.front().find("No single mistake"),
            std::string::npos)
      << outcome.warnings.front();
  ASSERT_EQ(outcome.plausibility.size(), 1U);
  const Finding& finding = outcome.plausibility.front();
  EXPECT_EQ(finding.key, "plausibility.position_misfit");
  EXPECT_EQ(finding.sentence, outcome.warnings.front());
  EXPECT_GT(finding.statistic, finding.threshold);
  Arm in_base = job.arm;
  in_base.instrument_from_base.setIdentity();
  EXPECT_NEAR(finding.threshold, 0.02 * Reach(in_base), 1e-15);
}

// The joint 5 of a spherical wrist that counts the other way, and the zero of
// joint 4 half a turn elsewhere, differ by a turn of the tool alone: no data
// with an unknown tool tell which it is.
TEST(PlausibilityTest, CuresThatExplainTheDataAlikeAreAllNamed) {
  JobConfig job;
  job.arm = testing::Puma560();
  job.arm.last_from_target().translation() << 0.05, 0.03, 0.1;
  Bench bench(job.arm, DrawJointValues(job.arm, 60, 5));
  job.data.training = bench.Positions(0).data();
  job.options.identifiability.candidates = {true, true, true};
  testing::Edit(&job.data.training.joint_values)->row(4) *= -1.0;
  try {
    RunJob(job, "test");
    FAIL() << "expected an error";
  } catch (const InputError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("Several mistakes explain it alike"), std::string::npos)
        << text;
    EXPECT_NE(text.find("joint 5 counts the other way"), std::string::npos);
    EXPECT_NE(text.find("the zero of joint 4 is elsewhere"), std::string::npos);
  }
}

// A zero that is 5 degrees off is no mistake to refuse: the calibration finds
// it.
TEST(PlausibilityTest, WhatACalibrationExplainsIsNotDoubted) {
  Arm real = RealArm();
  real.joints[2].theta += 5.0 * kDegree;
  const JobConfig job =
      JobOf(Bench(real, DrawJointValues(real, 60, 5)).Positions(0).data());
  const CalibrationResult result = RunJob(job, "test");
  EXPECT_EQ(result.status, CalibrationStatus::kDone) << result.message;
  EXPECT_TRUE(result.plausibility.empty());
}

// An arm whose joints hardly moved would fit to a small cloud of positions.
TEST(PlausibilityTest, ASmallCloudExplainsNothing) {
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
  EXPECT_NE(outcome.warnings.front().find("No single mistake"),
            std::string::npos);
}

bool IsWarnedOf(const CalibrationResult& outcome, const std::string& what) {
  const std::vector<std::string>& warnings = outcome.warnings;
  return std::any_of(warnings.begin(), warnings.end(),
                     [&](const std::string& warning) {
                       return warning.find(what) != std::string::npos;
                     });
}

TEST(PlausibilityTest, LostTargetsAndTheWorstMeasurementAreNamed) {
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
  ASSERT_EQ(spoilt.plausibility.size(), 1U);
  EXPECT_EQ(spoilt.plausibility[0].statistic, 1.0);
  EXPECT_NE(spoilt.verdict.level, FindingLevel::kPassed)
      << spoilt.verdict.title;
  EXPECT_TRUE(
      IsWarnedOf(spoilt, "tracker.csv:5: the measurement that fits worst is"));
}

// What stands for a lost target where it is no zero, and an instrument that
// gives its last number again.
TEST(PlausibilityTest, SentinelsAndStaleReadingsAreNamed) {
  const Arm real = RealArm();
  JobConfig job =
      WholeJobOf(Bench(real, DrawJointValues(real, 60, 5)).Positions(0).data());
  job.data.training.files = {"tracker.csv"};
  job.data.training.sources.Append({0, 2}, 60);
  JobConfig far = job;
  testing::Edit(&far.data.training.positions())->col(3).setConstant(-9.999);
  testing::Edit(&far.data.training.positions())->col(9).setConstant(-9.999);
  const std::string refusal = RefusalOf(far.data.training);
  EXPECT_NE(refusal.find("`missing: [-9999]`"), std::string::npos) << refusal;
  EXPECT_NE(refusal.find("`exclude: [5, 11]` in `data`"), std::string::npos)
      << refusal;
  Arm here = real;
  here.instrument_from_base.setIdentity();
  JobConfig near = job;
  near.data.training.positions() =
      Bench(here, DrawJointValues(real, 60, 5)).Positions(0).data().positions();
  testing::Edit(&near.data.training.positions())->col(3).setConstant(0.99999);
  const CalibrationResult spoilt = RunJob(near, "test");
  EXPECT_TRUE(IsWarnedOf(spoilt, "`missing: [999.99]`"));
  EXPECT_TRUE(IsWarnedOf(spoilt, "`exclude: [5]` in `data`"));
  {
    auto points = testing::Edit(&job.data.training.positions());
    points->col(20) = points->col(19).eval();
  }
  EXPECT_TRUE(IsWarnedOf(RunJob(job, "test"),
                         "tracker.csv:22: 1 measurement is exactly the one "
                         "before"));
}

// Every row has the position of the one before, of 60 of which 40 % are held
// out: neighbours are rarely neighbours in the file.
TEST(PlausibilityTest, RowsThatAreOffByOneAreFoundThroughAHoldOut) {
  const Arm real = RealArm();
  Dataset data = Bench(real, DrawJointValues(real, 60, 5)).Positions(0).data();
  {
    auto points = testing::Edit(&data.positions());
    points->rightCols(59) = points->leftCols(59).eval();
  }
  data.files = {"tracker.csv"};
  data.sources.Append({0, 2}, 60);
  JobConfig job = WholeJobOf(data);
  job.options.holdout = HoldOutOptions{HoldOutBy::kPose, 0.4, 1};
  try {
    RunJob(job, "test");
    FAIL() << "expected an error";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("one row late"), std::string::npos)
        << error.what();
  }
  // Where the other rows are lost, those that have neighbours tell it.
  std::vector<Eigen::Index> kept;
  for (Eigen::Index i = 0; i < 60; ++i) {
    if (i % 5 != 0) kept.push_back(i);
  }
  const std::string refusal = RefusalOf(SelectPoses(data, kept));
  EXPECT_NE(refusal.find("one row late"), std::string::npos) << refusal;
}

// Nine equations, of which base and target take nine.
TEST(PlausibilityTest, SigmaOfThreePosesIsUnknown) {
  const Arm real = RealArm();
  JobConfig job =
      WholeJobOf(Bench(real, DrawJointValues(real, 3, 5)).Positions(0).data());
  job.options.estimate_sigma = true;
  const CalibrationResult result = RunJob(job, "test");
  EXPECT_EQ(result.status, CalibrationStatus::kRefused);
  EXPECT_NE(result.message.find("sigma is unknown"), std::string::npos)
      << result.message;
  EXPECT_EQ(result.estimated_sigma, 0.0);
}

TEST(PlausibilityTest, OrientationsInAnotherConventionAreRefused) {
  const Arm real = RealArm();
  const Eigen::MatrixXd q = DrawJointValues(real, 60, 5);
  JobConfig job = JobOf(Bench(real, q).Poses().data());
  // The inverse rotation: what reads target and instrument the wrong way.
  testing::Edit(&job.data.training.blocks[0].measured)->bottomRows<3>() *= -1.0;
  EXPECT_THROW(RunJob(job, "test"), InputError);
}

}  // namespace
}  // namespace alidade::internal::plausibility_test
