// Error terms of jobs whose columns say more than joints and positions.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "alidade/arm_file.h"
#include "alidade/error.h"
#include "alidade/job.h"
#include "alidade/units.h"
#include "src/common/random.h"
#include "src/model/joint_draw.h"
#include "tests/support/matrix_kinematics.h"
#include "tests/support/process.h"
#include "tests/support/rv2aj_arms.h"

namespace alidade::internal {
namespace {

using ::testing::HasSubstr;
using testing::TemporaryDirectory;

constexpr double kSigma = 2e-5;  // m
constexpr int kPoses = 150;

// A directory with an arm, what was measured of a real one, and a job.
class ErrorTermsJobTest : public ::testing::Test {
 protected:
  ErrorTermsJobTest() {
    Arm nominal = testing::Rv2ajFlange();
    nominal.last_from_target().translation() =
        Eigen::Vector3d(0.03, -0.02, 0.05);
    testing::WriteWhole(directory_ / "arm.yaml", FormatArm(nominal, "a test"));
    real_ = testing::WithRv2ajDeviations(nominal);
    real_.errors.joints.resize(5);
  }

  // A covariate of the real arm, in a column of its own.
  CovariateEffect& AddEffect(const std::string& name, double reference) {
    real_.errors.covariates.push_back({name, reference});
    return real_.errors.covariates.back();
  }

  // `columns`: the cells beside those of joints and positions, one row for each
  // pose; covariates: names x poses, of the effects.
  void WriteData(const std::string& headers,
                 const std::vector<std::string>& cells,
                 const Eigen::MatrixXd& covariates) {
    q_ = DrawJointValues(real_, kPoses, 5);
    const ParameterLayout layout(real_);
    const testing::VectorXl values = testing::MatrixValues(real_);
    Random random(6);
    std::string text = "a,b,c,d,e,x_mm,y_mm,z_mm," + headers + "\n";
    for (int i = 0; i < kPoses; ++i) {
      const Eigen::VectorXd at = covariates.col(i);
      Eigen::Vector3d point =
          testing::MatrixTargetFrame(real_, layout, values, q_.col(i).data(), 0,
                                     at.data())
              .topRightCorner<3, 1>()
              .cast<double>();
      for (double& coordinate : point) coordinate += kSigma * random.Normal();
      for (const double angle : q_.col(i)) text += Number(angle) + ",";
      for (const double coordinate : point) {
        text += Number(coordinate / kMillimetre) + ",";
      }
      text += cells[i] + "\n";
    }
    testing::WriteWhole(directory_ / "data.csv", text);
  }

  static std::string Number(double value) {
    char text[40];
    std::snprintf(text, sizeof text, "%.12g", value);
    return text;
  }

  Job JobWith(const std::string& columns, const std::string& lines) {
    const std::string text =
        "format: alidade-job-2\n"
        "title: A test\n"
        "units: {length: mm, angle: rad}\n"
        "arm: arm.yaml\n"
        "data:\n"
        "  file: data.csv\n"
        "  columns:\n"
        "    joints: [a, b, c, d, e]\n" +
        columns +
        "measurement: {sigma: 0.02}\n"
        "identifiability: {parameters: [joints, base, tool]}\n" +
        lines;
    testing::WriteWhole(directory_ / "job.yaml", text);
    return alidade::LoadJob(directory_ / "job.yaml");
  }

  std::string LoadingError(const std::string& columns) {
    try {
      JobWith(columns, "");
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  TemporaryDirectory directory_;
  Arm real_;
  Eigen::MatrixXd q_;
};

TEST_F(ErrorTermsJobTest, CovariatesAndStationsOfACsvMoveWhatTheyShould) {
  AddEffect("temperature", 20.0).joints =
      Eigen::VectorXd::Unit(5, 1) * 3e-5;  // rad per K
  AddEffect("tilt", 0.0).base << 0.0, 0.0, 1e-4, 0.0, 0.0, 0.0;
  AddEffect("shelf", 0.0).base << 4e-3, -2e-3, 1e-3, 0.0, 0.0, 1e-3;
  Random random(7);
  Eigen::MatrixXd covariates(3, kPoses);
  std::vector<std::string> cells;
  for (int i = 0; i < kPoses; ++i) {
    covariates.col(i) << random.Uniform(15.0, 30.0), random.Uniform(-3.0, 3.0),
        i % 3 == 2 ? 1.0 : 0.0;
    cells.push_back(Number(covariates(0, i)) + "," + Number(covariates(1, i)) +
                    (i % 3 == 2 ? ",shelf" : ",floor"));
  }
  WriteData("temperature,tilt,place", cells, covariates);
  const std::string columns =
      "    covariates: [temperature, tilt]\n"
      "    effects: {temperature: [joint 2]}\n"
      "    station: place\n";
  const Job job = JobWith(
      columns, "errors: {covariates: true}\nvalidation: {fraction: 0.3}\n");
  EXPECT_EQ(job.data.training.covariate_names,
            (std::vector<std::string>{"temperature", "tilt", "station shelf"}));
  const CalibrationResult result = alidade::RunJob(job, "test");
  ASSERT_TRUE(result.IsUsable()) << result.message;
  const std::vector<CovariateEffect>& effects = result.arm.errors.covariates;
  ASSERT_EQ(effects.size(), 3U);
  EXPECT_EQ(effects[0].name, "temperature");
  EXPECT_NEAR(effects[0].joints[1], 3e-5, 5e-6);
  EXPECT_TRUE(effects[0].base.isZero(0.0));
  EXPECT_NEAR(effects[1].base.head<3>().norm(), 1e-4, 2e-5);
  EXPECT_EQ(effects[1].joints.cwiseAbs().sum(), 0.0);
  EXPECT_NEAR(effects[2].base.head<3>().norm(), std::sqrt(21.0) * 1e-3, 2e-4);
  EXPECT_LT(result.validation->after.rms, 1.3 * std::sqrt(3.0) * kSigma);
  // And by its evidence.
  const CalibrationResult automatic = alidade::RunJob(
      JobWith(columns, "validation: {fraction: 0.3}\n"), "test");
  EXPECT_LT(automatic.validation->after.rms, 1.3 * std::sqrt(3.0) * kSigma);
  EXPECT_NEAR(automatic.arm.errors.covariates[0].joints[1], 3e-5, 5e-6);
  // Effects on the base are sums, which motions of metres are not.
  real_.errors.covariates[2].base << 2.0, -1.0, 0.5, 0.0, 0.0, 1.0;
  WriteData("temperature,tilt,place", cells, covariates);
  EXPECT_THROW(alidade::RunJob(JobWith(columns, ""), "test"), InputError);
}

// The tracker was moved by metres between two rows, and nobody edits the file.
TEST_F(ErrorTermsJobTest, StationsAreLinesOfTheFile) {
  AddEffect("second", 0.0).base << 2.0, -1.0, 0.5, 0.0, 0.0, 1.0;
  Eigen::MatrixXd covariates = Eigen::MatrixXd::Zero(1, kPoses);
  covariates.rightCols(60).setOnes();
  WriteData("note", std::vector<std::string>(kPoses, "-"), covariates);
  const std::string rest = "errors: none\nvalidation: {fraction: 0.3}\n";
  const CalibrationResult result = alidade::RunJob(
      JobWith("  stations: {first: 2-91, second: 92-}\n", rest), "test");
  ASSERT_TRUE(result.IsUsable()) << result.message;
  EXPECT_LT(result.validation->after.rms, 1.3 * std::sqrt(3.0) * kSigma);
  EXPECT_GT(result.validation->after.rms, 0.8 * std::sqrt(3.0) * kSigma);
  ASSERT_EQ(result.arm.errors.covariates.size(), 1U);
  EXPECT_EQ(result.arm.errors.covariates[0].name, "station second");
  // Without, the place is found, and what to state said.
  try {
    alidade::RunJob(JobWith("", rest), "test");
    FAIL() << "expected an error";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("`stations: {first: 1-9"));
  }
  EXPECT_THAT(LoadingError("  stations: {first: 2-91, second: 93-}\n"),
              HasSubstr("line 92 belongs to none of `stations`"));
  EXPECT_THAT(LoadingError("  stations: {first: 2-91, second: 90-}\n"),
              HasSubstr("in part, those of \"first\""));
  EXPECT_THAT(LoadingError("  stations: {first: 2 to 91}\n"),
              HasSubstr("expected lines of the file"));
}

TEST_F(ErrorTermsJobTest, PayloadAndApproachHaveColumns) {
  for (JointErrors& joint : real_.errors.joints) {
    joint.compliance = Eigen::Vector3d(4e-6, -3e-6, 8e-6);
  }
  real_.errors.links.resize(5);
  for (Load& load : real_.errors.links) load.mass = 3.0;
  real_.errors.payload.mass = 0.0;
  testing::WriteWhole(directory_ / "arm.yaml", [&] {
    Arm nominal = testing::Rv2ajFlange();
    nominal.last_from_target().translation() =
        Eigen::Vector3d(0.03, -0.02, 0.05);
    nominal.errors.links = real_.errors.links;
    return FormatArm(nominal, "a test");
  }());
  AddEffect("mass", 0.0).payload = 1.0;
  AddEffect("way", 0.0).joints = Eigen::VectorXd::Constant(5, 1e-4);
  Random random(8);
  Eigen::MatrixXd covariates(2, kPoses);
  std::vector<std::string> cells;
  for (int i = 0; i < kPoses; ++i) {
    covariates.col(i) << (i % 2 == 0 ? 0.5 : 6.0),
        random.Uniform() < 0.5 ? -1.0 : 1.0;
    cells.push_back(Number(covariates(0, i)) + "," + Number(covariates(1, i)));
  }
  WriteData("mass,way", cells, covariates);
  const CalibrationResult result =
      alidade::RunJob(JobWith("    payload: mass\n    approach: way\n",
                              "errors: {elasticity: true, covariates: true}\n"
                              "validation: {fraction: 0.3}\n"),
                      "test");
  ASSERT_TRUE(result.IsUsable()) << result.message;
  const std::vector<CovariateEffect>& effects = result.arm.errors.covariates;
  ASSERT_EQ(effects.size(), 2U);
  EXPECT_EQ(effects[0].payload, 1.0);
  EXPECT_EQ(effects[1].reference, 0.0);
  EXPECT_NEAR(effects[1].joints[1], 1e-4, 2e-5);
  EXPECT_LT(result.validation->after.rms, 1.3 * std::sqrt(3.0) * kSigma);
}

TEST_F(ErrorTermsJobTest, ColumnsThatDoNotGoTogetherAreRefused) {
  WriteData("mass,way", std::vector<std::string>(kPoses, "1,1"),
            Eigen::MatrixXd::Zero(0, kPoses));
  EXPECT_THAT(LoadingError("    effects: {mass: base}\n"),
              HasSubstr("without \"covariates\""));
  EXPECT_THAT(LoadingError("    covariates: [way]\n"
                           "    effects: {mass: base}\n"),
              HasSubstr("unknown covariate"));
  EXPECT_THAT(LoadingError("    covariates: [mass]\n"
                           "    effects: {mass: [joint 6]}\n"),
              HasSubstr("joint 6"));
  EXPECT_THAT(LoadingError("    covariates: [mass]\n"
                           "    effects: {mass: [joints, joint 2]}\n"),
              HasSubstr("joint 2 again"));
  EXPECT_THAT(LoadingError("    covariates: [mass]\n    payload: mass\n"),
              HasSubstr("already"));
  EXPECT_THAT(LoadingError("    approach: [way, mass]\n"), HasSubstr("5"));
  EXPECT_EQ(LoadingError("    covariates: [way]\n    payload: mass\n"), "");
}

// Whether each row of data.csv was held out.
std::vector<bool> HeldOut(const Job& job, const Eigen::MatrixXd& q) {
  const CalibrationResult result = alidade::RunJob(job, "test");
  EXPECT_TRUE(result.IsUsable()) << result.message;
  std::vector<bool> held_out(static_cast<std::size_t>(q.cols()), false);
  for (Eigen::Index k = 0; k < result.validation->joint_values.cols(); ++k) {
    for (Eigen::Index i = 0; i < q.cols(); ++i) {
      const Eigen::VectorXd at = result.validation->joint_values.col(k);
      if ((q.col(i) - at).norm() < 1e-9) held_out[i] = true;
    }
  }
  return held_out;
}

// Mean distance from held-out poses to the nearest one that is not.
double Gap(const Eigen::MatrixXd& q, const std::vector<bool>& held_out) {
  double sum = 0.0;
  int count = 0;
  for (Eigen::Index i = 0; i < q.cols(); ++i) {
    if (!held_out[i]) continue;
    double nearest = 1e9;
    for (Eigen::Index k = 0; k < q.cols(); ++k) {
      if (!held_out[k])
        nearest = std::min(nearest, (q.col(i) - q.col(k)).norm());
    }
    sum += nearest;
    ++count;
  }
  return sum / count;
}

TEST_F(ErrorTermsJobTest, ValidationIsByPoseBlockOrRegion) {
  WriteData("more", std::vector<std::string>(kPoses, "1"),
            Eigen::MatrixXd::Zero(0, kPoses));
  const auto by = [&](const std::string& what) {
    return HeldOut(
        JobWith("", "errors: none\nvalidation: {fraction: 0.3, seed: 1, by: " +
                        what + "}\n"),
        q_);
  };
  const auto runs = [](const std::vector<bool>& held_out) {
    int count = 0;
    for (std::size_t i = 0; i < held_out.size(); ++i) {
      if (held_out[i] && (i == 0 || !held_out[i - 1])) ++count;
    }
    return count;
  };
  const std::vector<bool> pose = by("pose");
  const std::vector<bool> block = by("block");
  const std::vector<bool> region = by("region");
  for (const auto& one : {pose, block, region}) {
    const auto count = std::count(one.begin(), one.end(), true);
    EXPECT_NEAR(static_cast<double>(count), 0.3 * kPoses, 0.06 * kPoses);
  }
  // Six blocks of twenty; of 45 single poses some thirty have no neighbour.
  EXPECT_LE(runs(block), 6);
  EXPECT_GE(runs(pose), 20);
  // Of 150 poses in five dimensions the nearest is far anyway.
  EXPECT_GT(Gap(q_, region), 1.05 * Gap(q_, pose));
}

}  // namespace
}  // namespace alidade::internal
