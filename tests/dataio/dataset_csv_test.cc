#include "src/dataio/dataset_csv.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "alidade/dataset_file.h"
#include "alidade/units.h"
#include "src/common/random.h"
#include "src/common/text.h"
#include "tests/dataio/loaded_data_util.h"
#include "tests/support/edit.h"
#include "tests/support/io_test_util.h"

namespace alidade::internal {
namespace {

constexpr double kSigma = 2e-5;

// A turning joint, then a sliding one.
Arm TwoJoints() {
  Arm arm;
  arm.name = "test";
  arm.joints.resize(2);
  arm.joints[1].type = JointType::kPrismatic;
  return arm;
}

Dataset LoadText(const std::string& text) {
  const TestDirectory directory;
  return LoadDataset(directory.Write("data.csv", text), TwoJoints(), kSigma);
}

TEST(LoadDatasetTest, ReadsColumnsInAnyOrderAndUnit) {
  const Dataset data = LoadText(
      "z_m,q2_mm,x_mm,q1_deg,y_mm\n"
      "0.003,40,1,90,2\n"
      "-0.003,-40,-1,-90,-2\n");
  ASSERT_EQ(data.num_poses(), 2);
  EXPECT_EQ(data.joint_values.col(0), Eigen::Vector2d(kPi / 2.0, 0.04));
  EXPECT_EQ(data.positions().col(0), Eigen::Vector3d(0.001, 0.002, 0.003));
  EXPECT_EQ(data.joint_values.col(1), Eigen::Vector2d(-kPi / 2.0, -0.04));
  EXPECT_EQ(data.positions().col(1), Eigen::Vector3d(-0.001, -0.002, -0.003));
}

TEST(LoadDatasetTest, TakesTheDefaultSigmaWhereTheFileHasNone) {
  const Dataset data = LoadText("q1_rad,q2_m,x_m,y_m,z_m\n1,2,3,4,5\n");
  EXPECT_TRUE((data.sigmas().map().array() == kSigma).all());
}

TEST(LoadDatasetTest, ReadsSigmas) {
  const Dataset data = LoadText(
      "q1_rad,q2_m,x_m,y_m,z_m,std_x_mm,std_y_mm,std_z_m\n"
      "1,2,3,4,5,0.1,0.2,0.3\n");
  EXPECT_EQ(data.sigmas().col(0), Eigen::Vector3d(0.0001, 0.0002, 0.3));
}

TEST(LoadDatasetTest, PassesOverCommentsBlankLinesQuotesAndSpaces) {
  const Dataset data = LoadText(
      "\xef\xbb\xbf# made by hand\r\n"
      "\r\n"
      " \"q1_rad\" , q2_m,x_m,y_m, z_m\r\n"
      "  # in between\r\n"
      "1,\t2, \"3\" ,4,\" 5 \"\r\n"
      "   \r\n"
      "6,7,8,9,10");
  ASSERT_EQ(data.num_poses(), 2);
  EXPECT_EQ(data.joint_values.col(0), Eigen::Vector2d(1, 2));
  EXPECT_EQ(data.positions().col(0), Eigen::Vector3d(3, 4, 5));
  EXPECT_EQ(data.positions().col(1), Eigen::Vector3d(8, 9, 10));
}

TEST(LoadDatasetTest, TakesItsNameFromTheFile) {
  const TestDirectory directory;
  const std::string path =
      directory.Write("x.csv", "q1_rad,q2_m,x_m,y_m,z_m\n1,2,3,4,5\n");
  EXPECT_EQ(LoadDataset(path, TwoJoints(), kSigma).name, path);
}

TEST(LoadDatasetTest, LeavesLimitsToOthers) {
  const TestDirectory directory;
  Arm arm = TwoJoints();
  arm.joints[0].lower = -1.0;
  arm.joints[0].upper = 1.0;
  const std::string path =
      directory.Write("x.csv", "q1_rad,q2_m,x_m,y_m,z_m\n2,2,3,4,5\n");
  EXPECT_EQ(LoadDataset(path, arm, kSigma).joint_values(0, 0), 2.0);
}

struct CsvErrorCase {
  const char* name;
  std::string text;
  ExpectedError expected;
};

void PrintTo(const CsvErrorCase& error_case, std::ostream* out) {
  *out << error_case.name;
}

class LoadDatasetErrorTest : public ::testing::TestWithParam<CsvErrorCase> {};

TEST_P(LoadDatasetErrorTest, NamesLineColumnAndWhatWasExpected) {
  ExpectInputError([&] { LoadText(GetParam().text); }, GetParam().expected);
}

std::string CaseName(const ::testing::TestParamInfo<CsvErrorCase>& info) {
  return info.param.name;
}

INSTANTIATE_TEST_SUITE_P(
    Headers, LoadDatasetErrorTest,
    ::testing::Values(
        CsvErrorCase{"Empty",
                     "",
                     {0, 0, "",
                      "no header, expected a line of column names: "
                      "x_mm, y_mm, z_mm, std_x_mm"}},
        CsvErrorCase{"OnlyComments",
                     "# a\n# b\n",
                     {2, 0, "", "no header, expected a line"}},
        CsvErrorCase{
            "Binary", std::string("q1\0", 3), {0, 0, "", "not a text file"}},
        CsvErrorCase{"TooManyJoints",
                     "q1_deg,q2_mm,q3_deg,x_mm,y_mm,z_mm\n1,2,3,4,5,6\n",
                     {1, 0, "", "data set has 3 joints, arm \"test\" has 2"}},
        CsvErrorCase{"TooFewJoints",
                     "# c\nq1_deg,x_mm,y_mm,z_mm\n1,2,3,4\n",
                     {2, 0, "", "data set has 1 joints, arm \"test\" has 2"}},
        CsvErrorCase{
            "MissingJoint",
            "q2_mm,x_mm,y_mm,z_mm\n1,2,3,4\n",
            {1, 0, "q1_deg", "column is missing, expected q1_deg or q1_rad"}},
        CsvErrorCase{"NoMeasurement",
                     "q1_deg,q2_mm\n1,2\n",
                     {1, 0, "", "no column holds a measurement, expected"}},
        CsvErrorCase{"MissingSigma",
                     "q1_deg,q2_mm,x_mm,y_mm,z_mm,std_x_mm,std_z_mm\n",
                     {1, 0, "std_y_mm", "column is missing"}},
        CsvErrorCase{"UnknownColumn",
                     "q1_deg, q2_mm,x_mm,y_mm,z_mm,sdt_x_mm\n",
                     {1, 30, "",
                      "unknown column \"sdt_x_mm\", did you mean "
                      "\"std_x_mm\"?"}},
        CsvErrorCase{"EmptyColumnName",
                     "q1_deg,q2_mm,,x_mm,y_mm,z_mm\n",
                     {1, 14, "", "unknown column \"\""}},
        CsvErrorCase{"RepeatedColumn",
                     "q1_deg,q2_mm,x_mm,y_mm,z_mm,x_mm\n",
                     {1, 29, "x_mm", "repeated, expected x_mm or x_m once"}},
        CsvErrorCase{"RepeatedInOtherUnit",
                     "q1_deg,q1_rad,q2_mm,x_mm,y_mm,z_mm\n",
                     {1, 8, "q1_rad", "(it is there as \"q1_deg\")"}},
        CsvErrorCase{"LengthForAngle",
                     "q1_mm,q2_mm,x_mm,y_mm,z_mm\n",
                     {1, 1, "q1_mm",
                      "unit \"mm\" does not fit: q1 is an angle, expected "
                      "q1_deg or q1_rad"}},
        CsvErrorCase{"AngleForLength",
                     "q1_deg,q2_deg,x_mm,y_mm,z_mm\n",
                     {1, 8, "q2_deg", "q2 is a length, expected q2_mm"}},
        CsvErrorCase{"NoUnit",
                     "q1_deg,q2_mm,x,y_mm,z_mm\n",
                     {1, 14, "x", "no unit: x is a length"}},
        CsvErrorCase{"Tabs",
                     "q1_deg\tq2_mm\tx_mm\ty_mm\tz_mm\n",
                     {1, 0, "", "no rows after the header"}},
        CsvErrorCase{"NoRows",
                     "q1_deg,q2_mm,x_mm,y_mm,z_mm\n\n# c\n",
                     {3, 0, "", "no rows after the header"}}),
    CaseName);

std::string WithRow(const std::string& row) {
  return "q1_deg,q2_mm,x_mm,y_mm,z_mm,std_x_mm,std_y_mm,std_z_mm\n"
         "1,2,3,4,5,6,7,8\n" +
         row + "\n";
}

INSTANTIATE_TEST_SUITE_P(
    Rows, LoadDatasetErrorTest,
    ::testing::Values(
        CsvErrorCase{"TooFewCells",
                     WithRow("1,2,3,4,5,6,7"),
                     {3, 0, "", "expected 8 cells as in the header, found 7"}},
        CsvErrorCase{"DecimalCommas",
                     WithRow("1,5,2,3,4,5,6,7,8"),
                     {3, 0, "", "found 9: numbers take a decimal point"}},
        CsvErrorCase{"QuotedDecimalComma",
                     WithRow("\"1,5\",2,3.5,4,5,6,7,8"),
                     {3, 0, "", "found \"3.5\" in line 3 and \"1,5\""}},
        CsvErrorCase{"EmptyCell",
                     WithRow("1,,3,4,5,6,7,8"),
                     {3, 3, "q2_mm", "expected a number, found nothing"}},
        CsvErrorCase{"EmptyLastCell",
                     WithRow("1,2,3,4,5,6,7,"),
                     {3, 15, "std_z_mm", "expected a number, found nothing"}},
        CsvErrorCase{"Text",
                     WithRow("1,2,3,four,5,6,7,8"),
                     {3, 7, "y_mm", "expected a number, found \"four\""}},
        CsvErrorCase{"Nan",
                     WithRow("1, nan,3,4,5,6,7,8"),
                     {3, 4, "q2_mm", "expected a finite number"}},
        CsvErrorCase{"MeasuredInfinity",
                     WithRow("1,2,3,inf,5,6,7,8"),
                     {3, 7, "y_mm", "expected a finite number"}},
        CsvErrorCase{"Infinity",
                     WithRow("-inf,2,3,4,5,6,7,8"),
                     {3, 1, "q1_deg", "expected a finite number"}},
        CsvErrorCase{"Overflow",
                     WithRow("1e999,2,3,4,5,6,7,8"),
                     {3, 1, "q1_deg", "too large or too small"}},
        CsvErrorCase{"Hexadecimal",
                     WithRow("0x1,2,3,4,5,6,7,8"),
                     {3, 1, "q1_deg", "expected a number, found \"0x1\""}},
        CsvErrorCase{"UnitInCell",
                     WithRow("1,2 mm,3,4,5,6,7,8"),
                     {3, 3, "q2_mm", "state its unit in the column's name"}},
        CsvErrorCase{"ZeroSigma",
                     WithRow("1,2,3,4,5,6,0,8"),
                     {3, 13, "std_y_mm",
                      "expected a standard deviation above zero, found 0"}},
        CsvErrorCase{"NegativeSigma",
                     WithRow("1,2,3,4,5,-6,7,8"),
                     {3, 11, "std_x_mm", "above zero, found -6"}},
        CsvErrorCase{"UnclosedQuote",
                     WithRow("1,\"2,3,4,5,6,7,8"),
                     {3, 3, "", "expected a closing quote"}},
        CsvErrorCase{"TextBehindQuote",
                     WithRow("1,\"2\"x,3,4,5,6,7,8"),
                     {3, 5, "", "expected a comma after the closing quote"}}),
    CaseName);

TEST(LoadDatasetTest, NamesFilesThatCannotBeRead) {
  const TestDirectory directory;
  const auto load = [&](const std::string& name) {
    LoadDataset(directory.Path(name), TwoJoints(), kSigma);
  };
  ExpectInputError([&] { load("none.csv"); }, {0, 0, "", "No such file"});
  ExpectInputError([&] { load(""); }, {0, 0, "", "Is a directory"});
}

TEST(LoadJointValuesTest, IgnoresOtherColumns) {
  const TestDirectory directory;
  const std::string path = directory.Write(
      "x.csv", "station,q2_mm,q1_deg,comment\nA,10,90,x y\nB,20,-90,\n");
  const Eigen::MatrixXd q = LoadJointValues(path, TwoJoints());
  ASSERT_EQ(q.cols(), 2);
  EXPECT_EQ(q.col(0), Eigen::Vector2d(kPi / 2.0, 0.01));
  EXPECT_EQ(q.col(1), Eigen::Vector2d(-kPi / 2.0, 0.02));
}

TEST(LoadJointValuesTest, NeedsEveryJoint) {
  const TestDirectory directory;
  const std::string path = directory.Write("x.csv", "q2_mm,x\n1,2\n");
  ExpectInputError([&] { LoadJointValues(path, TwoJoints()); },
                   {1, 0, "q1_deg", "column is missing"});
}

// Joint values that four decimals state exactly, positions of any size.
Dataset RandomDataset(int num_poses) {
  Random random(1);
  Eigen::MatrixXd joint_values(2, num_poses);
  Eigen::MatrixXd positions(3, num_poses);
  Eigen::MatrixXd sigmas(3, num_poses);
  for (int i = 0; i < num_poses; ++i) {
    joint_values(0, i) =
        std::round(random.Uniform(-180e4, 180e4)) / 1e4 * kDegree;
    joint_values(1, i) = std::round(random.Uniform(-500e4, 500e4)) / 1e7;
    for (int axis = 0; axis < 3; ++axis) {
      const double size = std::pow(10.0, random.Uniform(-20.0, 20.0));
      positions(axis, i) = random.Normal() * size;
      sigmas(axis, i) = random.Uniform() + 1e-9;
    }
  }
  positions(0, 0) = 0.0;
  return MakePositions(std::move(joint_values), std::move(positions),
                       std::move(sigmas));
}

TEST(FormatDatasetTest, ReadsBackToTheSameBits) {
  const Dataset data = RandomDataset(500);
  const Dataset read = LoadText(
      FormatDataset(data, TwoJoints(), 4, true, {"made by", "a test"}));
  EXPECT_EQ(read.joint_values, data.joint_values);
  EXPECT_EQ(read.positions(), data.positions());
  EXPECT_EQ(read.sigmas(), data.sigmas());
}

TEST(FormatDatasetTest, CommentCannotBreakOutOfItsLine) {
  const Dataset read = LoadText(
      FormatDataset(RandomDataset(3), TwoJoints(), 4, false, {"a\n1,2\rb"}));
  EXPECT_EQ(read.num_poses(), 3);
}

TEST(FormatDatasetTest, WritesWhatPeopleExpect) {
  Dataset data;
  data.joint_values = Eigen::MatrixXd(2, 2);
  *testing::Edit(&data.joint_values) << -90.0 * kDegree, -1e-9, 0.0125, 0.0;
  data.positions() = Eigen::MatrixXd(3, 2);
  *testing::Edit(&data.positions()) << 0.0721, -0.21, 0.3, 12.0, 0.0, 1e-12;
  data.sigmas() = Eigen::MatrixXd::Constant(3, 2, kSigma);
  EXPECT_EQ(FormatDataset(data, TwoJoints(), 2, false, {"Two poses."}),
            "# Two poses.\n"
            "q1_deg,q2_mm,x_mm,y_mm,z_mm\n"
            "-90.00,12.50,72.1,300,0\n"
            "0.00,0.00,-210,12000,1e-9\n");
  EXPECT_EQ(FormatDataset(data, TwoJoints(), 0, true, {}),
            "q1_deg,q2_mm,x_mm,y_mm,z_mm,std_x_mm,std_y_mm,std_z_mm\n"
            "-90,12,72.1,300,0,0.02,0.02,0.02\n"
            "0,0,-210,12000,1e-9,0.02,0.02,0.02\n");
}

TEST(DatasetTest, HoldsMotorValuesWhereMotorsAreCoupled) {
  Arm arm;
  arm.joints.resize(2);
  arm.joints_from_motors.resize(2, 2);
  arm.joints_from_motors << 1.0, 0.0, -1.0, 1.0;
  arm.motor_offsets = Eigen::Vector2d(0.0, 90.0 * kDegree);
  const TestDirectory directory;
  const std::string path = directory.Write("data.csv",
                                           "q1_deg,q2_deg,x_mm,y_mm,z_mm\n"
                                           "30.0,50.0,1,2,3\n");
  const Dataset read = LoadDataset(path, arm, 1e-5);
  EXPECT_NEAR(read.joint_values(0, 0), 30.0 * kDegree, 1e-15);
  EXPECT_NEAR(read.joint_values(1, 0), 110.0 * kDegree, 1e-15);
  EXPECT_EQ(LoadJointValues(path, arm), read.joint_values);
  EXPECT_NE(FormatDataset(read, arm, 1, false, {}).find("\n30.0,50.0,"),
            std::string::npos);
}

TEST(FormatDatasetTest, FewestDigitsAreInRadWhereDegreesCannotStateTheBits) {
  const TestDirectory directory;
  const Arm arm = TwoJoints();
  Random random(2);
  Eigen::MatrixXd joints(2, 2000);
  for (double& joint : joints.reshaped()) joint = random.Uniform(-3.0, 3.0);
  Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Constant(3, 2000, 0.1);
  const Dataset data = MakePositions(joints, points, points);
  const std::string text = FormatDataset(data, arm, kFewestDigits, false, {});
  EXPECT_EQ(text.rfind("q1_rad,q2_mm,", 0), 0u);
  const Dataset back = LoadDataset(directory.Write("data.csv", text), arm, 0.1);
  ExpectSameNumbers(data, back);
}

}  // namespace
}  // namespace alidade::internal
