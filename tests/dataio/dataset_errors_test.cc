#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "alidade/dataset_file.h"
#include "src/dataio/dataset_csv.h"
#include "tests/support/io_test_util.h"

namespace alidade::internal::dataset_errors_test {
namespace {

// One turning joint; two targets where they are asked for.
Arm OneJoint(bool has_targets) {
  Arm arm;
  arm.name = "test";
  arm.joints.resize(1);
  if (has_targets) {
    arm.targets = {{"ball", Eigen::Isometry3d::Identity()},
                   {"probe", Eigen::Isometry3d::Identity()}};
  }
  return arm;
}

struct ErrorCase {
  const char* name;
  std::string text;
  ExpectedError expected;
  bool has_targets = false;
};

void PrintTo(const ErrorCase& error_case, std::ostream* out) {
  *out << error_case.name;
}

std::string CaseName(const ::testing::TestParamInfo<ErrorCase>& info) {
  return info.param.name;
}

void ExpectError(const ErrorCase& error_case, const DataFormat& format) {
  const TestDirectory directory;
  const std::string path = directory.Write("data.csv", error_case.text);
  const Arm arm = OneJoint(error_case.has_targets);
  References references;
  ExpectInputError([&] { LoadData(path, arm, format, &references); },
                   error_case.expected);
}

class LoadDataErrorTest : public ::testing::TestWithParam<ErrorCase> {};

TEST_P(LoadDataErrorTest, NamesLineColumnAndWhatWasExpected) {
  ExpectError(GetParam(), {});
}

INSTANTIATE_TEST_SUITE_P(
    Encodings, LoadDataErrorTest,
    ::testing::Values(
        ErrorCase{"Workbook",
                  "PK\x03\x04 and so on",
                  {0, 0, "", "save the sheet as CSV"}},
        ErrorCase{"NoText",
                  std::string("q1_deg,x_mm\n1,\0\n", 17),
                  {0, 0, "", "not a text file"}},
        ErrorCase{
            "DecimalOrThousands",
            "q1_deg;x_mm\n1;2,500\n3;4,500\n",
            {2, 0, "", "expected `decimal: \",\"` or `thousands: \",\"`"}},
        ErrorCase{
            "PointsOfThousandsPerhaps",
            "q1_deg;x_mm\n1;2.500\n3;500\n",
            {2, 0, "", "expected `decimal: \".\"` or `thousands: \".\"`"}},
        ErrorCase{"DecimalCommasAndPoints",
                  "q1_deg;x_mm\n1;2,5\n3;4.5\n",
                  {3, 0, "", "found \"4.5\" in line 3 and \"2,5\" in line 2"}},
        ErrorCase{"DecimalCommasBetweenCommas",
                  "q1_deg,x_mm\n1,5,2,5\n",
                  {2, 0, "", "numbers take a decimal point, not a comma"}}),
    CaseName);

INSTANTIATE_TEST_SUITE_P(
    Orientations, LoadDataErrorTest,
    ::testing::Values(
        ErrorCase{"NoConvention",
                  "q1_deg,rx_deg,ry_deg,rz_deg\n1,2,3,4\n",
                  {1, 0, "rx_deg",
                   "the convention of the angles is not stated, expected "
                   "`rotation: NAME` in the job's `data`, one of "
                   "intrinsic_xyz"}},
        ErrorCase{"PartOfTheColumns",
                  "q1_deg,wx_deg,wz_deg\n1,2,3\n",
                  {1, 0, "wy_deg", "column is missing, expected wy_deg or"}},
        ErrorCase{"TwoOrientations",
                  "q1_deg,wx_deg,wy_deg,wz_deg,qw,qx,qy,qz\n1,2,3,4,5,6,7,8\n",
                  {1, 0, "", "more than once"}},
        ErrorCase{"PartOfARow",
                  "q1_deg,wx_deg,wy_deg,wz_deg\n1,2,,4\n",
                  {2, 5, "wy_deg", "an orientation is measured as a whole"}},
        ErrorCase{"QuaternionNorm",
                  "q1_deg,qw,qx,qy,qz\n1,0.5,0.5,0.5,0\n",
                  {2, 3, "qw",
                   "the quaternion's norm is 0.8660254037844386, expected 1 "
                   "to within 0.001"}},
        ErrorCase{"SigmaOfNothing",
                  "q1_deg,x_mm,std_wx_deg,std_wy_deg,std_wz_deg\n1,2,3,4,5\n",
                  {1, 0, "wx_deg", "column is missing"}},
        ErrorCase{"SigmaOfOtherNumbers",
                  "q1_deg,qw,qx,qy,qz,std_rx_deg,std_ry_deg,std_rz_deg\n"
                  "1,1,0,0,0,1,1,1\n",
                  {1, 0, "rx_deg", "column is missing"}},
        ErrorCase{"ZeroSigma",
                  "q1_deg,wx_deg,wy_deg,wz_deg,std_wx_deg,std_wy_deg,"
                  "std_wz_deg\n1,2,3,4,0,1,1\n",
                  {2, 9, "std_wx_deg",
                   "expected a standard deviation above zero, found 0"}}),
    CaseName);

const char kCovariance[] =
    "q1_deg,x_mm,y_mm,z_mm,cov_xx_mm2,cov_xy_mm2,cov_xz_mm2,cov_yy_mm2,"
    "cov_yz_mm2,cov_zz_mm2";

INSTANTIATE_TEST_SUITE_P(
    Sigmas, LoadDataErrorTest,
    ::testing::Values(
        ErrorCase{"SigmaWithoutItsAxis",
                  "q1_deg,x_mm,std_x_mm,std_y_mm\n1,2,3,4\n",
                  {1, 0, "y_mm", "expected y_mm or y_m beside std_y_mm"}},
        ErrorCase{"AxisWithoutSigma",
                  "q1_deg,x_mm,y_mm,std_x_mm\n1,2,3,4\n",
                  {1, 0, "std_y_mm", "column is missing"}},
        ErrorCase{"EmptySigma",
                  "q1_deg,x_mm,std_x_mm\n1,2,\n",
                  {2, 5, "std_x_mm", "expected a number, found nothing"}},
        ErrorCase{"NotPositiveDefinite",
                  kCovariance + std::string("\n1,2,3,4,1,2,0,1,0,1\n"),
                  {2, 9, "cov_xx_mm2", "not positive definite, expected"}},
        ErrorCase{"Singular",
                  kCovariance + std::string("\n1,2,3,4,1,1,0,1,0,1\n"),
                  {2, 9, "cov_xx_mm2", "not positive definite"}},
        ErrorCase{"CovarianceAndSigma",
                  kCovariance + std::string(",std_x_mm,std_y_mm,std_z_mm\n"),
                  {1, 0, "std_x_mm", "beside the covariance"}},
        ErrorCase{"CovarianceInMm",
                  "q1_deg,x_mm,cov_xx_mm\n",
                  {1, 13, "cov_xx_mm",
                   "cov_xx is a squared length, expected cov_xx_mm2 or "
                   "cov_xx_m2"}}),
    CaseName);

INSTANTIATE_TEST_SUITE_P(
    References, LoadDataErrorTest,
    ::testing::Values(
        ErrorCase{"DistanceFromNothing",
                  "q1_deg,distance_mm\n1,2\n",
                  {1, 0, "point", "the point it is measured from"}},
        ErrorCase{"DistanceFromAnEmptyCell",
                  "q1_deg,distance_mm,point\n1,2,\n",
                  {2, 5, "point", "expected the name of the point"}},
        ErrorCase{"NoDistanceAtAll",
                  "q1_deg,distance_mm,point\n1,0,A\n",
                  {2, 3, "distance_mm", "expected a number above zero"}},
        ErrorCase{"DifferenceFromNothing",
                  "q1_deg,dx_mm\n1,2\n",
                  {1, 0, "from", "the row that the difference is to"}},
        ErrorCase{"FromNoRow",
                  "q1_deg,dx_mm,from\n1,,\n2,5,3\n",
                  {3, 5, "from", "expected a data row from 1 to 2, found 3"}},
        ErrorCase{"FromItself",
                  "q1_deg,dx_mm,from\n1,5,1\n",
                  {2, 5, "from", "number of another data row"}},
        ErrorCase{"FromText",
                  "q1_deg,dx_mm,from\n1,5,first\n",
                  {2, 5, "from", "counted from 1, found \"first\""}},
        ErrorCase{
            "UnknownTarget",
            "q1_deg,x_mm,target\n1,2,bal\n",
            {2, 5, "target", "unknown target \"bal\", did you mean \"ball\"?"},
            true},
        ErrorCase{"EmptyTarget",
                  "q1_deg,x_mm,target\n1,2,\n",
                  {2, 5, "target", "expected one of ball, probe"},
                  true},
        ErrorCase{"NoTargetColumn",
                  "q1_deg,x_mm\n1,2\n",
                  {1, 0, "target", "has the targets ball, probe"},
                  true},
        ErrorCase{"ArmNamesNoTargets",
                  "q1_deg,x_mm,target\n1,2,ball\n",
                  {2, 5, "target", "names none, expected `targets`"}},
        ErrorCase{"RepeatedText",
                  "q1_deg,x_mm,set,set\n1,2,a,b\n",
                  {1, 17, "set", "repeated, expected set once"}},
        ErrorCase{"NothingAtAll",
                  "q1_deg,x_mm\n1,\n2,nan\n",
                  {3, 0, "", "no row holds a measurement"}}),
    CaseName);

TEST(LoadDataErrorTest, GimbalLock) {
  DataFormat format;
  format.rotation = FindRotationConvention("intrinsic_zyx");
  ExpectError({"GimbalLock",
               "q1_deg,rx_deg,ry_deg,rz_deg,std_rx_deg,std_ry_deg,std_rz_deg\n"
               "1,10,90,30,1,1,1\n",
               {2, 12, "std_rx_deg", "gimbal lock"}},
              format);
}

TEST(LoadDataErrorTest, ConstantsBesideColumns) {
  DataFormat format;
  format.point = "A";
  ExpectError({"Point",
               "q1_deg,point\n1,B\n",
               {1, 0, "point", "named for all of its rows too"}},
              format);
  format.point.clear();
  format.target = "ball";
  ExpectError({"Target",
               "q1_deg,x_mm,target\n1,2,ball\n",
               {1, 0, "target", "named for all of its rows too"},
               true},
              format);
}

TEST(LoadDataErrorTest, FiltersThatLeaveNothing) {
  DataFormat format;
  format.where = {{"series", "C"}};
  ExpectError({"Column",
               "q1_deg,x_mm\n1,2\n",
               {1, 0, "series", "unknown column \"series\""}},
              format);
  ExpectError({"Value",
               "q1_deg,x_mm,series\n1,2,A\n",
               {2, 0, "", "`where` and `exclude` leave no row"}},
              format);
  ExpectError({"From",
               "q1_deg,dx_mm,from,series\n1,,,A\n2,5,1,C\n",
               {3, 5, "from", "data row 1 is left out by `where`"}},
              format);
}

TEST(LoadDatasetTest, SendsReferencesToAJob) {
  const TestDirectory directory;
  const std::string path =
      directory.Write("data.csv", "q1_deg,point\n1,socket\n");
  ExpectInputError([&] { LoadDataset(path, OneJoint(false), 1e-5); },
                   {0, 0, "", "measured against socket: expected a job"});
}

}  // namespace
}  // namespace alidade::internal::dataset_errors_test
