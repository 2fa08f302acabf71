// Jobs that identify frames alone, and `export --as=frames`, against closed
// forms: linear least squares of the touched pin, Kabsch's fit of the corners.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "alidade/arm_file.h"
#include "alidade/rotation.h"
#include "alidade/units.h"
#include "tests/support/error_term_kinematics.h"
#include "tests/support/process.h"

namespace alidade::internal::frames_test {
namespace {

using ::testing::HasSubstr;
using testing::ReadWhole;
using testing::TemporaryDirectory;
using testing::WriteWhole;

const std::string kSource = ALIDADE_SOURCE_DIR;
constexpr double kSigma = 0.1e-3;  // of the jobs (m)

testing::ProcessResult Alidade(const std::string& arguments) {
  return testing::RunProcess(std::string(ALIDADE_BINARY) + " " + arguments);
}

std::vector<std::vector<std::string>> Cells(const std::string& text) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    rows.emplace_back();
    std::istringstream cells(line + ",");
    for (std::string cell; std::getline(cells, cell, ',');) {
      rows.back().push_back(cell);
    }
  }
  return rows;
}

// Poses of the flange at the rows of a data set, and the names touched.
struct Touches {
  std::vector<Eigen::Matrix4d> flange;
  std::vector<std::string> names;
};

Touches Touched(const std::string& file, Arm arm) {
  arm.last_from_target().setIdentity();
  const testing::ErrorTermKinematics kinematics(arm);
  Touches touches;
  const auto rows = Cells(ReadWhole(kSource + "/datasets/frames/" + file));
  for (std::size_t i = 1; i < rows.size(); ++i) {
    Eigen::VectorXd q(6);
    for (int j = 0; j < 6; ++j) q[j] = std::stod(rows[i][j]) * kDegree;
    touches.flange.push_back(kinematics.TargetFrame(q).cast<double>());
    touches.names.push_back(rows[i][6]);
  }
  return touches;
}

// A row of the exported table (m, rad): origin, rotation vector, deviations.
struct FrameRow {
  Eigen::Vector3d origin;
  Eigen::Vector3d turn;
  std::array<std::string, 6> deviations;  // mm, deg
};

class FramesTest : public ::testing::Test {
 protected:
  std::map<std::string, FrameRow> Exported(const std::string& job) {
    const std::string out = directory_ / "result";
    const auto done = Alidade("calibrate " + kSource + "/configs/jobs/" + job +
                              " --out=" + out);
    EXPECT_EQ(done.status, 0) << done.err;
    EXPECT_EQ(done.err, "");
    table_ = directory_ / "frames.csv";
    EXPECT_EQ(Alidade("export " + out + " --as=frames --out=" + table_).status,
              0);
    std::map<std::string, FrameRow> frames;
    const auto rows = Cells(ReadWhole(table_));
    for (std::size_t i = 1; i < rows.size(); ++i) {
      FrameRow& row = frames[rows[i][0]];
      for (int k = 0; k < 3; ++k) {
        row.origin[k] = std::stod(rows[i][1 + k]) * kMillimetre;
        row.turn[k] = std::stod(rows[i][4 + k]) * kDegree;
      }
      for (int k = 0; k < 6; ++k) row.deviations[k] = rows[i][7 + k];
    }
    return frames;
  }

  const TemporaryDirectory directory_;
  std::string table_;
};

// What is stated has three digits.
void ExpectDeviations(const FrameRow& row, const Eigen::VectorXd& expected) {
  for (Eigen::Index k = 0; k < expected.size(); ++k) {
    const double unit = k < 3 ? kMillimetre : kDegree;
    EXPECT_NEAR(std::stod(row.deviations[k]) * unit, expected[k],
                0.006 * expected[k]);
  }
}

// Controllers have tools in the flange, which robots with alpha1 = 180 deg have
// turned in the last joint's frame.
TEST_F(FramesTest, ToolsAreInTheFlangeOfTheNominalArm) {
  const std::string flange = kSource + "/configs/robots/kr6_r900_2.yaml";
  std::string arm = ReadWhole(flange);
  const std::string tool = "tool: {rx: 180}";
  ASSERT_NE(arm.find(tool), std::string::npos);
  arm.replace(arm.find(tool), tool.size(),
              "tool: {x: 12.5, y: 21.25, z: -151.75, rx: 180}");
  WriteWhole(directory_ / "arm.yaml", arm);
  const auto run =
      Alidade("export " + (directory_ / "arm.yaml") +
              " --as=frames --rotation=intrinsic_zyx --nominal=" + flange);
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("\ntool,12.500000000,-21.250000000,"
                                 "151.750000000,0.0000000000,0.0000000000,"
                                 "0.0000000000"));
}

// "Before" has the frames fitted as well: no comparison says anything.
TEST_F(FramesTest, FramesAloneAreNotComparedWithThemselves) {
  const std::string out = directory_ / "touched";
  const auto run = Alidade("calibrate " + kSource +
                           "/configs/jobs/tool_touched.yaml --out=" + out);
  ASSERT_EQ(run.status, 0) << run.err;
  const std::string report = ReadWhole(out + "/report.txt");
  EXPECT_NE(report.find("With the frames that were found the mean position "
                        "error at 6"),
            std::string::npos);
  EXPECT_EQ(report.find("hardly better"), std::string::npos);
}

TEST_F(FramesTest, ToolOfATouchedPinIsThatOfLinearLeastSquares) {
  const Touches touches = Touched(
      "tool_touched.csv", LoadArm(kSource + "/configs/robots/irb120.yaml"));
  const auto n = static_cast<Eigen::Index>(touches.flange.size());
  // R_i tool + p_i = pin.
  Eigen::MatrixXd a(3 * n, 6);
  Eigen::VectorXd b(3 * n);
  for (Eigen::Index i = 0; i < n; ++i) {
    a.block<3, 3>(3 * i, 0) = touches.flange[i].topLeftCorner<3, 3>();
    a.block<3, 3>(3 * i, 3) = -Eigen::Matrix3d::Identity();
    b.segment<3>(3 * i) = -touches.flange[i].topRightCorner<3, 1>();
  }
  const Eigen::VectorXd solved = a.colPivHouseholderQr().solve(b);
  const Eigen::MatrixXd covariance = (a.transpose() * a).inverse();
  const FrameRow tool = Exported("tool_touched.yaml").at("tool");
  // The prior of 50 mm about the first fit weighs next to nothing.
  EXPECT_LT((tool.origin - solved.head<3>()).norm(), 1e-9);
  ExpectDeviations(tool, kSigma * covariance.diagonal().head<3>().cwiseSqrt());
  for (int k = 3; k < 6; ++k) EXPECT_EQ(tool.deviations[k], "");
  // Within three standard deviations of what the data were made with.
  const Eigen::Vector3d truth(31e-3, -12e-3, 118e-3);
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(tool.origin[k], truth[k],
                3.0 * kSigma * std::sqrt(covariance(k, k)));
  }
  // `correct` finds a tool of that name in the table.
  const std::string arm = kSource + "/configs/robots/irb120.yaml";
  WriteWhole(directory_ / "a.mod",
             "MoveL [[420,80,210],[0,1,0,0],[0,0,-2,0],[9E9,9E9,9E9,9E9,9E9,"
             "9E9]],v1,z1,tool;\n");
  const auto corrected = Alidade(
      "correct " + arm + " " + (directory_ / "a.mod") + " --nominal=" + arm +
      " --frames=" + table_ + " --out=" + (directory_ / "b.mod"));
  EXPECT_EQ(corrected.status, 0) << corrected.err;
}

TEST_F(FramesTest, WorkObjectOfTouchedCornersIsKabschsFit) {
  const Arm arm = LoadArm(kSource + "/configs/robots/irb120_pointer.yaml");
  const Touches touches = Touched("object_touched.csv", arm);
  const std::map<std::string, Eigen::Vector3d> corners = {{"A", {0, 0, 0}},
                                                          {"B", {0.2, 0, 0}},
                                                          {"C", {0.2, 0.12, 0}},
                                                          {"D", {0, 0.12, 0}}};
  const auto n = static_cast<Eigen::Index>(touches.flange.size());
  Eigen::Matrix3Xd in_base(3, n);
  Eigen::Matrix3Xd in_object(3, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    in_base.col(i) =
        (touches.flange[i] * arm.last_from_target().translation().homogeneous())
            .head<3>();
    in_object.col(i) = corners.at(touches.names[i]);
  }
  const Eigen::Vector3d mean = in_base.rowwise().mean();
  const Eigen::Vector3d object_mean = in_object.rowwise().mean();
  const Eigen::Matrix3d product =
      (in_base.colwise() - mean) *
      (in_object.colwise() - object_mean).transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(
      product, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d sign = Eigen::Matrix3d::Identity();
  sign(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant();
  const Eigen::Matrix3d turn = svd.matrixU() * sign * svd.matrixV().transpose();
  const Eigen::Vector3d origin = mean - turn * object_mean;
  // To first order: what a small move and turn of the object does to points.
  Eigen::MatrixXd jacobian(3 * n, 6);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Vector3d arm_of = turn * in_object.col(i);
    jacobian.block<3, 3>(3 * i, 0).setIdentity();
    for (int k = 0; k < 3; ++k) {
      jacobian.block<3, 1>(3 * i, 3 + k) =
          Eigen::Vector3d::Unit(k).cross(arm_of);
    }
  }
  const Eigen::MatrixXd covariance =
      (jacobian.transpose() * jacobian).inverse();

  const auto frames = Exported("work_object.yaml");
  const FrameRow& object = frames.at("instrument");
  // The first fit is a prior of 50 mm and 50 mrad.
  EXPECT_LT((object.origin - origin).norm(), 1e-8);
  EXPECT_LT((RotationFromVector<double>(object.turn) - turn).norm(), 1e-7);
  ExpectDeviations(object, kSigma * covariance.diagonal().cwiseSqrt());
  // The base is its inverse.
  const FrameRow& base = frames.at("base");
  EXPECT_LT((turn * base.origin + origin).norm(), 1e-8);
  EXPECT_EQ(frames.at("tool").deviations[0], "");
}

}  // namespace
}  // namespace alidade::internal::frames_test
