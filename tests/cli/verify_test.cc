// `plan --check` and `validate --check` as they are run, on an arm whose truth
// is known.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <sstream>
#include <string>
#include <vector>

#include "alidade/arm_file.h"
#include "alidade/units.h"
#include "src/common/random.h"
#include "tests/support/error_term_kinematics.h"
#include "tests/support/process.h"
#include "tests/support/rv2aj_arms.h"

namespace alidade::internal::verify_test {
namespace {

using ::testing::HasSubstr;
using testing::ReadWhole;
using testing::TemporaryDirectory;
using testing::WriteWhole;

const std::string kSource = ALIDADE_SOURCE_DIR;

testing::ProcessResult Alidade(const std::string& arguments) {
  return testing::RunProcess(std::string(ALIDADE_BINARY) + " " + arguments);
}

class VerifyTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto done =
        Alidade("calibrate " + kSource +
                "/configs/jobs/rv2aj_flange.yaml --out=" + result_);
    ASSERT_EQ(done.status, 0) << done.err;
    const auto plan =
        Alidade("plan --check " + result_ + " --poses=8 --out=" + poses_);
    ASSERT_EQ(plan.status, 0) << plan.err;
    EXPECT_THAT(plan.out, HasSubstr("8 poses to check whether"));
    EXPECT_THAT(plan.out, HasSubstr("\nNext\n  the arm alone: drive to"));
    EXPECT_THAT(plan.out, HasSubstr("alidade correct " + result_ + " " +
                                    poses_ + " --out=results/corrected/"));
    EXPECT_THAT(plan.out, HasSubstr("alidade validate --check --corrected " +
                                    result_ + " " + poses_));
    std::istringstream lines(ReadWhole(poses_));
    for (std::string line; std::getline(lines, line);) {
      if (line.empty() || line[0] == '#' || line[0] == 'q') continue;
      std::istringstream cells(line);
      Eigen::VectorXd q(5);
      for (double& angle : q) {
        std::string cell;
        std::getline(cells, cell, ',');
        angle = std::stod(cell) * kDegree;
      }
      joints_.push_back(q);
    }
    ASSERT_EQ(joints_.size(), 8u);
  }

  // The filled-in file of an arm, measured with 0.02 mm, and what is said of
  // it.
  testing::ProcessResult Check(const Arm& arm, const std::string& flags = "",
                               const std::string& header =
                                   "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,x_mm,"
                                   "y_mm,z_mm\n") {
    const testing::ErrorTermKinematics kinematics(arm);
    std::string text = header;
    Random random(1);
    for (const Eigen::VectorXd& q : joints_) {
      const Eigen::Vector3d point =
          kinematics.TargetFrame(q).cast<double>().topRightCorner<3, 1>();
      std::array<char, 64> cell;
      for (const double angle : q) {
        std::snprintf(cell.data(), cell.size(), "%.4f,", angle / kDegree);
        text += cell.data();
      }
      for (int k = 0; k < 3; ++k) {
        std::snprintf(cell.data(), cell.size(), "%.4f%s",
                      point[k] / kMillimetre + 0.02 * random.Normal(),
                      k < 2 ? "," : "\n");
        text += cell.data();
      }
    }
    const std::string file = directory_ / "measured.csv";
    WriteWhole(file, text);
    return Alidade("validate --check " + result_ + " " + file + " " + flags);
  }

  const TemporaryDirectory directory_;
  const std::string result_ = directory_ / "result";
  const std::string poses_ = directory_ / "poses.csv";
  std::vector<Eigen::VectorXd> joints_;
  const Arm nominal_ = LoadArm(kSource + "/configs/robots/rv2aj_flange.yaml");
  const Arm real_ = testing::WithRv2ajDeviations(nominal_);
};

TEST_F(VerifyTest, AnArmAsCalibratedPasses) {
  const auto check = Check(real_);
  EXPECT_EQ(check.status, 0) << check.err;
  EXPECT_THAT(check.out, HasSubstr("PASSED: RV-2AJ at the flange"));
  // The flange lies on the axis of the last joint, which moves nothing.
  EXPECT_THAT(check.out, ::testing::ContainsRegex("\n5 +- +deg"));
}

TEST_F(VerifyTest, AnUncalibratedArmAndAChangedOneFail) {
  const auto nominal = Check(nominal_);
  EXPECT_EQ(nominal.status, 1) << nominal.err;
  EXPECT_THAT(nominal.out, HasSubstr("FAILED"));
  EXPECT_THAT(nominal.out, HasSubstr("With --corrected it would pass"));
  Arm changed = real_;
  changed.joints[1].theta += 0.1 * kDegree;
  EXPECT_EQ(Check(changed).status, 1);
}

TEST_F(VerifyTest, ACorrectedRobotStandsWhereTheNominalArmWould) {
  EXPECT_EQ(Check(nominal_, "--corrected").status, 0);
  // The correction was not loaded.
  const auto uncorrected = Check(real_, "--corrected");
  EXPECT_EQ(uncorrected.status, 1);
  EXPECT_THAT(uncorrected.out, HasSubstr("Without --corrected it would pass"));
}

TEST_F(VerifyTest, AnInstrumentThatWasSetUpAnewIsNoFault) {
  Arm moved = real_;
  moved.instrument_from_base =
      Eigen::Translation3d(0.4, -0.2, 0.1) *
      Eigen::AngleAxisd(2.0, Eigen::Vector3d(0.6, 0.0, 0.8));
  const auto as_it_was = Check(moved);
  EXPECT_EQ(as_it_was.status, 1);
  EXPECT_THAT(as_it_was.out, HasSubstr("With --refit=base it would pass"));
  EXPECT_THAT(as_it_was.out,
              HasSubstr("or joint 1's zero, which no base sets"));
  const auto refitted = Check(moved, "--refit=base");
  EXPECT_EQ(refitted.status, 0) << refitted.out << refitted.err;
  moved.joints[2].theta += 0.2 * kDegree;
  EXPECT_EQ(Check(moved, "--refit=base").status, 1);
}

// The poses of a check, whose positions are empty, are corrected, and it is
// said what to expect of it.
TEST_F(VerifyTest, CorrectionsOfTheResultSayWhatToExpect) {
  const auto correct = [&](const std::string& more) {
    const auto run = Alidade("correct " + result_ + " " + poses_ +
                             " --out=" + (directory_ / "c.csv") + " " + more);
    EXPECT_EQ(run.status, 0) << run.err;
    return run.out;
  };
  const std::string out = correct("");
  EXPECT_THAT(out, HasSubstr("The controller is taken to compute with RV-2AJ"));
  EXPECT_THAT(out, HasSubstr("that of the position in space (root of"));
  EXPECT_THAT(out, ::testing::Not(HasSubstr("far larger")));
  Arm other = nominal_;
  other.joints[2].d += 0.05;
  WriteWhole(directory_ / "other.yaml", FormatArm(other, ""));
  EXPECT_THAT(correct("--nominal=" + (directory_ / "other.yaml")),
              HasSubstr("Warnings\n  corrections of "));
  // Joints that were not measured are named with what was.
  WriteWhole(directory_ / "far.csv",
             "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg\n-149,0,90,0,0\n");
  const auto far =
      Alidade("correct " + result_ + " " + (directory_ / "far.csv") +
              " --out=" + (directory_ / "c.csv"));
  EXPECT_THAT(far.out, ::testing::ContainsRegex(
                           "row 1: q1 = -1[0-9.]+, measured -[0-9.]+ to "));
}

TEST_F(VerifyTest, WrongUnitsAreNamed) {
  const auto metres =
      Check(real_, "", "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,x_m,y_m,z_m\n");
  EXPECT_EQ(metres.status, 1) << metres.err;
  // Lines are wrapped.
  EXPECT_THAT(metres.out, HasSubstr("but read as m: state"));
  const auto radians =
      Check(real_, "", "q1_rad,q2_rad,q3_rad,q4_rad,q5_rad,x_mm,y_mm,z_mm\n");
  EXPECT_EQ(radians.status, 1) << radians.err;
  EXPECT_THAT(radians.out,
              ::testing::ContainsRegex("in.degrees.but.read.as.radians"));
  EXPECT_THAT(Check(nominal_).out, ::testing::Not(HasSubstr("read as")));
}

TEST_F(VerifyTest, WhatIsMeasuredIsNotOverwritten) {
  const auto again = Alidade("plan --check " + result_ + " --out=" + poses_);
  EXPECT_EQ(again.status, 2);
  EXPECT_THAT(again.err, HasSubstr("is there already"));
  EXPECT_THAT(Alidade("plan --check " + result_ +
                      "/arm.yaml --out=" + (directory_ / "other.csv"))
                  .err,
              HasSubstr("expected --nominal"));
}

TEST_F(VerifyTest, OnlyCovariatesWithAnEffectStandInTheWay) {
  const std::string file = result_ + "/arm.yaml";
  const std::string rigid = ReadWhole(file);
  const auto plan_with = [&](const char* move) {
    WriteWhole(file, rigid +
                         "errors: {covariates: [{name: temp, reference: 22, "
                         "move: " +
                         move + "}]}\n");
    return Alidade("plan --check " + result_ +
                   " --out=" + (directory_ / (move + std::string(".csv"))));
  };
  const auto without = plan_with("[0,0,0]");
  EXPECT_EQ(without.status, 0) << without.err;
  const auto with = plan_with("[0.001,0,0]");
  EXPECT_EQ(with.status, 2);
  EXPECT_THAT(with.err, HasSubstr("an effect of `temp`"));
}

}  // namespace
}  // namespace alidade::internal::verify_test
