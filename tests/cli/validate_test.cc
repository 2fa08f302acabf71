// `validate` on data with stations, points and a tool of their own, on an arm
// whose truth is known.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

#include "alidade/arm_file.h"
#include "alidade/units.h"
#include "src/common/random.h"
#include "src/model/joint_draw.h"
#include "tests/support/error_term_kinematics.h"
#include "tests/support/process.h"
#include "tests/support/rv2aj_arms.h"

namespace alidade::internal::validate_test {
namespace {

using ::testing::HasSubstr;
using testing::TemporaryDirectory;
using testing::WriteWhole;

constexpr char kHead[] = "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,";

Arm WithTool(Arm arm, const Eigen::Vector3d& tool) {
  arm.last_from_target().translation() = tool;
  return arm;
}

class ValidateTest : public ::testing::Test {
 protected:
  void SetUp() override {
    WriteWhole(directory_ / "arm.yaml", FormatArm(nominal_, "a test"));
    WriteWhole(directory_ / "data.csv",
               Positions(1, 80, "floor") + Positions(2, 60, "shelf", false));
    WriteWhole(directory_ / "job.yaml", JobText("arm.yaml", "data.csv"));
    const auto done = Alidade("calibrate job.yaml --out=result");
    ASSERT_EQ(done.status, 0) << done.err;
  }

  testing::ProcessResult Alidade(const std::string& arguments) const {
    return testing::RunProcess("cd " + directory_.path().string() + " && " +
                               ALIDADE_BINARY + " " + arguments);
  }

  static std::string JobText(const std::string& arm, const std::string& data) {
    return "format: alidade-job-2\ntitle: a test\n"
           "units: {length: mm, angle: deg}\n"
           "arm: " +
           arm + "\ndata: {file: " + data +
           ", columns: {station: place}}\n"
           "measurement: {sigma: 0.02}\n"
           "identifiability: {parameters: [joints, base, tool]}\n";
  }

  static std::string Cell(double value) {
    char text[40];
    std::snprintf(text, sizeof text, "%.6f,", value);
    return text;
  }

  static std::string JointCells(const Eigen::VectorXd& q) {
    std::string text;
    for (const double angle : q) text += Cell(angle / kDegree);
    return text;
  }

  // Seen from the floor, or from a shelf metres away.
  std::string Positions(std::uint64_t seed, int count, const std::string& place,
                        bool with_header = true) const {
    Arm arm = real_;
    if (place != "floor") {
      arm.instrument_from_base =
          Eigen::Translation3d(2.0, -1.0, 0.5) *
          Eigen::AngleAxisd(1.1, Eigen::Vector3d::UnitZ());
    }
    const testing::ErrorTermKinematics kinematics(arm);
    const Eigen::MatrixXd joints = DrawJointValues(arm, count, seed);
    Random random(seed, 9);
    std::string text =
        with_header ? std::string(kHead) + "x_mm,y_mm,z_mm,place\n" : "";
    for (const auto& q : joints.colwise()) {
      text += JointCells(q);
      const Eigen::Vector3d point =
          kinematics.TargetFrame(q).cast<double>().topRightCorner<3, 1>();
      for (const double x : point) {
        text += Cell(x / kMillimetre + 0.02 * random.Normal());
      }
      text += place + "\n";
    }
    return text;
  }

  // Lengths of a wire from an anchor to the target of `arm`.
  static std::string Wires(const Arm& arm) {
    const testing::ErrorTermKinematics kinematics(arm);
    Random random(3);
    std::string text = std::string(kHead) + "point,distance_mm\n";
    const Eigen::MatrixXd joints = DrawJointValues(arm, 40, 4);
    for (const auto& q : joints.colwise()) {
      const Eigen::Vector3d point =
          kinematics.TargetFrame(q).cast<double>().topRightCorner<3, 1>();
      const double length = (point - Eigen::Vector3d(0.9, -0.7, 0.2)).norm();
      std::string cell = Cell(length / kMillimetre + 0.02 * random.Normal());
      cell.back() = '\n';
      text += JointCells(q) + "hook," + cell;
    }
    return text;
  }

  // The mean error in mm of the row of a table that begins so; -1: none.
  static double MeanOf(const testing::ProcessResult& result,
                       const std::string& row) {
    const std::size_t at = result.out.find("\n" + row + "  ");
    if (at == std::string::npos) return -1.0;
    int poses = 0;
    double mean = -1.0;
    std::sscanf(result.out.c_str() + at + 1 + row.size(), "%d %lf", &poses,
                &mean);
    return mean;
  }

  const TemporaryDirectory directory_;
  const Arm nominal_ = WithTool(testing::Rv2ajFlange(), {0.03, -0.02, 0.05});
  const Arm real_ = testing::WithRv2ajDeviations(nominal_);
};

TEST_F(ValidateTest, StationsAreKnownByName) {
  WriteWhole(directory_ / "shelf.csv", Positions(5, 30, "shelf"));
  WriteWhole(directory_ / "check.yaml",
             JobText("result/arm.yaml", "shelf.csv"));
  const auto known = Alidade("validate result/arm.yaml check.yaml");
  ASSERT_EQ(known.status, 0) << known.err;
  EXPECT_GT(MeanOf(known, "check.yaml"), 0.015) << known.out;
  EXPECT_LT(MeanOf(known, "check.yaml"), 0.06) << known.out;
  WriteWhole(directory_ / "check.yaml", JobText("arm.yaml", "shelf.csv"));
  const auto unknown = Alidade("validate result/arm.yaml check.yaml");
  EXPECT_EQ(unknown.status, 2);
  EXPECT_THAT(unknown.err,
              HasSubstr("stations, which the job's `arm` does not know"));
  WriteWhole(directory_ / "attic.csv",
             Positions(5, 30, "floor") + Positions(6, 30, "attic", false));
  WriteWhole(directory_ / "check.yaml",
             JobText("result/arm.yaml", "attic.csv"));
  const auto attic = Alidade("validate result/arm.yaml check.yaml");
  EXPECT_EQ(attic.status, 2);
  EXPECT_THAT(attic.err, HasSubstr("not calibrated with station attic"));
}

// A result is a file that people may have changed.
TEST_F(ValidateTest, WhatIsNoCovarianceIsRefused) {
  const std::string path = directory_ / "result/result.json";
  const auto whole = nlohmann::json::parse(testing::ReadWhole(path));
  const auto expect_refused = [&](const nlohmann::json& changed,
                                  const std::string& key) {
    WriteWhole(path, changed.dump());
    const auto done = Alidade("validate result data.csv");
    EXPECT_EQ(done.status, 2) << key;
    EXPECT_THAT(done.err, HasSubstr("uncertainty." + key));
    EXPECT_THAT(done.err, HasSubstr("or a negative variance"));
  };
  nlohmann::json changed = whole;
  nlohmann::json& covariance = changed["uncertainty"]["covariance"];
  nlohmann::json& other = changed["uncertainty"]["prediction_covariance"];
  const nlohmann::json right = covariance;
  covariance[0][0] = -1e-6;
  expect_refused(changed, "covariance");
  covariance[0][0] = nullptr;
  expect_refused(changed, "covariance");
  covariance = right;
  other = right;
  other[1][1] = -1e-6;
  expect_refused(changed, "prediction_covariance");
  other = right;
  other[0][1] = other[1][0] = nullptr;
  expect_refused(changed, "prediction_covariance");
  // As square as it may be, of other parameters.
  other = {{1.0}};
  expect_refused(changed, "prediction_covariance");
}

TEST_F(ValidateTest, PointsOfTheCheckAreFoundThere) {
  WriteWhole(directory_ / "wires.csv", Wires(real_));
  const auto found = Alidade("validate result/arm.yaml wires.csv");
  ASSERT_EQ(found.status, 0) << found.err;
  const double mean = MeanOf(found, "wires.csv; hook found here");
  EXPECT_GT(mean, 0.005) << found.out;
  EXPECT_LT(mean, 0.05) << found.out;
  // With a probe of its own.
  WriteWhole(directory_ / "probe.csv",
             Wires(WithTool(real_, {-0.01, 0.04, 0.12})));
  const auto refitted =
      Alidade("validate result/arm.yaml probe.csv --refit=tool");
  ASSERT_EQ(refitted.status, 0) << refitted.err;
  EXPECT_LT(MeanOf(refitted, "probe.csv, tool refitted; hook found here"), 0.05)
      << refitted.out;
  const auto as_mounted = Alidade("validate result/arm.yaml probe.csv");
  EXPECT_NE(as_mounted.status, 0) << as_mounted.out;
  EXPECT_THAT(as_mounted.err, HasSubstr("--refit=tool"));
}

}  // namespace
}  // namespace alidade::internal::validate_test
