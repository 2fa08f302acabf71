#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <string>
#include <vector>

#include "alidade/rotation.h"
#include "alidade/units.h"
#include "src/common/constants.h"
#include "src/dataio/dataset_csv.h"
#include "tests/support/io_test_util.h"

namespace alidade::internal::dataset_kinds_test {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kSigma = 2e-5;

// Two turning joints and the targets named.
Arm TwoJoints(const std::vector<std::string>& targets = {""}) {
  Arm arm;
  arm.name = "test";
  arm.joints.resize(2);
  arm.targets.clear();
  for (const std::string& name : targets) arm.targets.push_back({name, {}});
  for (Target& target : arm.targets) target.last_from_target.setIdentity();
  return arm;
}

// What one file gives, and the references it was read against.
struct Loaded {
  LoadedData file;
  References references;

  const Dataset& data() const { return file.data; }
  const ObservationBlock& block(std::size_t i = 0) const {
    return file.data.blocks.at(i);
  }
};

Loaded Load(const std::string& text, DataFormat format = {},
            const Arm& arm = TwoJoints(), const References& declared = {}) {
  const TestDirectory directory;
  if (format.sigma == DataFormat().sigma) format.sigma = kSigma;
  Loaded loaded;
  loaded.references = declared;
  loaded.file = LoadData(directory.Write("data.csv", text), arm, format,
                         &loaded.references);
  return loaded;
}

// Prefixes the two joints' columns to a header and to its rows.
std::string Rows(const std::string& header,
                 const std::vector<std::string>& rows) {
  std::string text = "q1_deg,q2_deg," + header + "\n";
  int number = 0;
  for (const std::string& row : rows) {
    text += std::to_string(10 * ++number) + ",20," + row + "\n";
  }
  return text;
}

DataFormat WithRotation(const std::string& name) {
  DataFormat format;
  format.rotation = FindRotationConvention(name);
  return format;
}

TEST(LoadDataTest, PositionsAloneAreOneBlockWithoutLists) {
  const Loaded loaded = Load(Rows("x_mm,y_mm,z_mm", {"1,2,3", "4,5,6"}));
  ASSERT_EQ(loaded.data().blocks.size(), 1U);
  const ObservationBlock& block = loaded.block();
  EXPECT_EQ(block.kind, MeasurementKind::kPosition);
  EXPECT_TRUE(block.poses.empty() && block.targets.empty());
  EXPECT_TRUE(block.references.empty() && block.seconds.empty());
  EXPECT_TRUE(block.whiteners.empty());
  EXPECT_EQ(block.measured.col(1), Vector3d(0.004, 0.005, 0.006));
  EXPECT_TRUE((block.sigmas.map().array() == kSigma).all());
  ASSERT_EQ(loaded.data().sources.size(), 2U);
  EXPECT_EQ(loaded.data().sources[1].line, 3);
  EXPECT_EQ(loaded.data().sources[1].file, 0);
  EXPECT_EQ(loaded.data().files.size(), 1U);
  EXPECT_TRUE(loaded.file.sets.empty());
  EXPECT_TRUE(loaded.file.rejected.empty());
}

TEST(LoadDataTest, AxesThatAreNotThereAreNotMeasured) {
  const Loaded loaded = Load(Rows("z_m,x_mm", {"3,1", "nan,2", "4,", "NaN, "}));
  const ObservationBlock& block = loaded.block();
  ASSERT_EQ(loaded.data().num_poses(), 3);
  EXPECT_EQ(block.measured.col(0), Vector3d(0.001, 0.0, 3.0));
  EXPECT_EQ(block.sigmas.col(0), Vector3d(kSigma, kInfinity, kSigma));
  EXPECT_EQ(block.measured.col(1), Vector3d(0.002, 0.0, 0.0));
  EXPECT_EQ(block.sigmas.col(1), Vector3d(kSigma, kInfinity, kInfinity));
  EXPECT_EQ(block.sigmas.col(2), Vector3d(kInfinity, kInfinity, kSigma));
  EXPECT_EQ(loaded.data().num_equations(), 4);
}

TEST(LoadDataTest, RejectsRowsWithoutAMeasurement) {
  const Loaded loaded =
      Load(Rows("x_mm,y_mm,z_mm", {"1,2,3", ",nan,", "4,5,6"}));
  ASSERT_EQ(loaded.file.rejected.size(), 1U);
  EXPECT_EQ(loaded.file.rejected[0].line, 3);
  EXPECT_EQ(loaded.file.rejected[0].reason, "nothing was measured");
  EXPECT_EQ(loaded.file.rejected[0].file, loaded.data().name);
  ASSERT_EQ(loaded.data().num_poses(), 2);
  EXPECT_NEAR(loaded.data().joint_values(0, 1), 30.0 * kDegree, 1e-15);
  EXPECT_EQ(loaded.data().sources[1].line, 4);
  EXPECT_TRUE(loaded.block().poses.empty());
}

TEST(LoadDataTest, SigmasMayBeEmptyWhereNothingWasMeasured) {
  const Loaded loaded =
      Load(Rows("x_mm,y_mm,std_x_mm,std_y_mm", {"1,2,0.1,0.2", ",2,,0.3"}));
  EXPECT_EQ(loaded.block().sigmas.col(0), Vector3d(1e-4, 2e-4, kInfinity));
  EXPECT_EQ(loaded.block().sigmas.col(1), Vector3d(kInfinity, 3e-4, kInfinity));
}

TEST(LoadDataTest, ReadsEulerAngles) {
  const Loaded loaded =
      Load(Rows("x_mm,y_mm,z_mm,rx_deg,ry_deg,rz_deg", {"1,2,3,10,-20,30"}),
           WithRotation("intrinsic_zyx"));
  ASSERT_EQ(loaded.block().kind, MeasurementKind::kPose);
  const Matrix3d rotation =
      (Eigen::AngleAxisd(30 * kDegree, Vector3d::UnitZ()) *
       Eigen::AngleAxisd(-20 * kDegree, Vector3d::UnitY()) *
       Eigen::AngleAxisd(10 * kDegree, Vector3d::UnitX()))
          .toRotationMatrix();
  const Eigen::VectorXd measured = loaded.block().measured.col(0);
  EXPECT_EQ(measured.head<3>(), Vector3d(0.001, 0.002, 0.003));
  EXPECT_LT((measured.tail<3>() - VectorFromRotation(rotation)).norm(), 1e-15);
  // 0.02 mm over 0.2 m.
  EXPECT_NEAR(loaded.block().sigmas(3, 0), 1e-4, 1e-18);
  EXPECT_TRUE(loaded.block().whiteners.empty());
}

TEST(LoadDataTest, PropagatesTheSigmasOfAngles) {
  const Loaded loaded =
      Load(Rows("x_mm,y_mm,z_mm,rx_deg,ry_deg,rz_deg,std_rx_deg,std_ry_deg,"
                "std_rz_deg",
                {"1,2,3,10,0,90,0.1,0.2,0.3"}),
           WithRotation("intrinsic_zyx"));
  // Rot(z, 90): the angle about y turns about -x, that about x about y.
  const Vector3d expected(0.2 * kDegree, 0.1 * kDegree, 0.3 * kDegree);
  const ObservationBlock& block = loaded.block();
  const Eigen::VectorXd sigmas = block.sigmas.col(0);
  EXPECT_LT((sigmas.tail<3>() - expected).norm(), 1e-16);
  ASSERT_EQ(block.whiteners.size(), 1U);
  const Eigen::MatrixXd& whitener = block.whiteners[0];
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(6, 6);
  covariance.diagonal().head<3>().setConstant(kSigma * kSigma);
  covariance.diagonal().tail<3>() = expected.array().square();
  EXPECT_LT((whitener * covariance * whitener.transpose() -
             Eigen::MatrixXd::Identity(6, 6))
                .norm(),
            1e-9);
}

TEST(LoadDataTest, CorrelatesObliqueAngles) {
  const Loaded loaded =
      Load(Rows("rx_rad,ry_rad,rz_rad,std_rx_rad,std_ry_rad,std_rz_rad",
                {"0.2,0.5,0,1e-3,2e-3,3e-3"}),
           WithRotation("intrinsic_zyx"));
  // z turns about z, y about y, x about (cos 0.5, 0, -sin 0.5).
  const double c = std::cos(0.5);
  const double s = std::sin(0.5);
  const double xx = 1e-6 * c * c;
  const double xz = -1e-6 * c * s;
  const double zz = 1e-6 * s * s + 9e-6;
  const Eigen::MatrixXd& whitener = loaded.block().whiteners.at(0);
  const Matrix3d inverse =
      (whitener.transpose() * whitener).bottomRightCorner<3, 3>().inverse();
  EXPECT_NEAR(inverse(0, 0), xx, 1e-18);
  EXPECT_NEAR(inverse(0, 2), xz, 1e-18);
  EXPECT_NEAR(inverse(2, 2), zz, 1e-18);
  EXPECT_NEAR(inverse(1, 1), 4e-6, 1e-18);
  EXPECT_NEAR(inverse(0, 1), 0.0, 1e-18);
  // No position: its rows are not measured and whitened to zero.
  EXPECT_EQ(loaded.block().sigmas(0, 0), kInfinity);
  EXPECT_TRUE(whitener.topRows(3).isZero(0.0));
  EXPECT_EQ(loaded.data().num_equations(), 3);
}

TEST(LoadDataTest, ReadsQuaternionsAndNormalisesThem) {
  const double h = std::sqrt(0.5) * 1.0005;
  const std::string half = std::to_string(h);
  const Loaded loaded =
      Load(Rows("x_mm,qw,qx,qy,qz", {"1," + half + ",0,0," + half, "2,,,,"}));
  ASSERT_EQ(loaded.data().blocks.size(), 2U);
  const Vector3d quarter(0.0, 0.0, kPi / 2.0);
  const Eigen::VectorXd measured = loaded.block(0).measured.col(0);
  EXPECT_LT((measured.tail<3>() - quarter).norm(), 1e-12);
  // The second row has no orientation: it is one of position.
  EXPECT_EQ(loaded.block(1).kind, MeasurementKind::kPosition);
  EXPECT_EQ(loaded.block(1).poses, std::vector<int>{1});
  EXPECT_EQ(loaded.block(0).poses, std::vector<int>{0});
}

TEST(LoadDataTest, ReadsRotationVectorsWithoutAConvention) {
  const Loaded loaded =
      Load(Rows("x_mm,y_mm,z_mm,wx_deg,wy_deg,wz_deg,std_wx_deg,std_wy_deg,"
                "std_wz_deg",
                {"1,2,3,90,0,0,0.1,0.2,0.3"}));
  const Eigen::VectorXd measured = loaded.block().measured.col(0);
  EXPECT_LT((measured.tail<3>() - Vector3d(kPi / 2.0, 0, 0)).norm(), 1e-15);
  EXPECT_TRUE(loaded.block().whiteners.empty());
  EXPECT_EQ(loaded.block().sigmas(4, 0), 0.2 * kDegree);
}

TEST(LoadDataTest, PassesOverOrientationsWhereAskedTo) {
  DataFormat format;
  format.ignore_rotation = true;
  const Loaded loaded =
      Load(Rows("x_mm,rx_deg,ry_deg,rz_deg", {"1,10,20,30"}), format);
  EXPECT_EQ(loaded.block().kind, MeasurementKind::kPosition);
}

TEST(LoadDataTest, WhitensByTheCovarianceOfARow) {
  const std::string header =
      "x_mm,y_mm,z_mm,cov_xx_mm2,cov_xy_mm2,cov_xz_mm2,cov_yy_mm2,cov_yz_mm2,"
      "cov_zz_mm2";
  const Loaded loaded =
      Load(Rows(header, {"1,2,3,4,2,0,5,0,9", "1,,3,4,2,1,5,0,9"}));
  Matrix3d covariance;
  covariance << 4, 2, 0, 2, 5, 0, 0, 0, 9;
  covariance *= 1e-6;
  const ObservationBlock& block = loaded.block();
  const Eigen::MatrixXd& whole = block.whiteners.at(0);
  EXPECT_LT(
      (whole.transpose() * whole * covariance - Matrix3d::Identity()).norm(),
      1e-12);
  EXPECT_LT((block.sigmas.col(0) - Vector3d(2e-3, std::sqrt(5.0) * 1e-3, 3e-3))
                .norm(),
            1e-17);
  // Without y: the marginal covariance of x and z.
  const Eigen::MatrixXd& part = block.whiteners.at(1);
  EXPECT_TRUE(part.row(1).isZero(0.0) && part.col(1).isZero(0.0));
  Matrix3d marginal;
  marginal << 4e-6, 0, 1e-6, 0, 1, 0, 1e-6, 0, 9e-6;
  Matrix3d expected = marginal.inverse();
  expected(1, 1) = 0.0;
  EXPECT_LT((part.transpose() * part - expected).norm() / expected.norm(),
            1e-12);
  EXPECT_EQ(block.sigmas(1, 1), kInfinity);
}

TEST(LoadDataTest, ReadsDistancesFromPoints) {
  References declared;
  declared.points.push_back({"B", Vector3d(1, 2, 3), true});
  const Loaded loaded =
      Load(Rows("distance_mm,std_distance_mm,point",
                {"500,0.1,A", "600,0.2,B", ",,A", "700,0.3,A"}),
           {}, TwoJoints(), declared);
  const ObservationBlock& block = loaded.block();
  ASSERT_EQ(block.kind, MeasurementKind::kDistance);
  EXPECT_EQ(block.references, (std::vector<int>{1, 0, 1}));
  EXPECT_EQ(block.measured(0, 1), 0.6);
  EXPECT_EQ(block.sigmas(0, 2), 3e-4);
  EXPECT_EQ(loaded.file.rejected.size(), 1U);
  ASSERT_EQ(loaded.references.num_points(), 2);
  EXPECT_TRUE(loaded.references.points[0].is_known);
  EXPECT_EQ(loaded.references.points[1].name, "A");
  EXPECT_FALSE(loaded.references.points[1].is_known);
  EXPECT_TRUE(loaded.references.points[1].position.isZero(0.0));
}

TEST(LoadDataTest, PointsAndPlanesAreTouched) {
  const Loaded loaded = Load(Rows("point,plane", {"A,", ",floor", "B,floor"}));
  ASSERT_EQ(loaded.data().blocks.size(), 2U);
  const ObservationBlock& points = loaded.block(0);
  const ObservationBlock& planes = loaded.block(1);
  EXPECT_EQ(points.kind, MeasurementKind::kFixedPoint);
  EXPECT_EQ(points.poses, (std::vector<int>{0, 2}));
  EXPECT_EQ(points.references, (std::vector<int>{0, 1}));
  EXPECT_TRUE(points.measured.map().isZero(0.0));
  EXPECT_EQ(points.sigmas(2, 1), kSigma);
  EXPECT_EQ(planes.kind, MeasurementKind::kPlane);
  EXPECT_EQ(planes.poses, (std::vector<int>{1, 2}));
  EXPECT_EQ(planes.references, (std::vector<int>{0, 0}));
  EXPECT_EQ(loaded.references.planes.at(0).name, "floor");
}

TEST(LoadDataTest, ConstantsStandForColumns) {
  DataFormat format;
  format.point = "anchor";
  format.target = "b";
  const Loaded loaded =
      Load(Rows("distance_m", {"1", "2"}), format, TwoJoints({"a", "b"}));
  EXPECT_EQ(loaded.references.points.at(0).name, "anchor");
  EXPECT_EQ(loaded.block().targets, (std::vector<int>{1, 1}));
  EXPECT_TRUE(loaded.block().poses.empty());
}

TEST(LoadDataTest, DifferencesReferToOtherRows) {
  const Loaded loaded = Load(
      Rows("dx_mm,dy_mm,dz_mm,from", {"1,2,3,4", "5,,6,1", ",,,", ",,,2"}));
  // Row 3 holds nothing; row 4 is what row 1 is measured from.
  ASSERT_EQ(loaded.data().num_poses(), 3);
  const ObservationBlock& block = loaded.block();
  ASSERT_EQ(block.kind, MeasurementKind::kDifference);
  EXPECT_EQ(block.poses, (std::vector<int>{0, 1}));
  EXPECT_EQ(block.seconds, (std::vector<int>{2, 0}));
  EXPECT_EQ(block.measured.col(0), Vector3d(0.001, 0.002, 0.003));
  EXPECT_EQ(block.sigmas.col(1), Vector3d(kSigma, kInfinity, kSigma));
  ASSERT_EQ(loaded.file.rejected.size(), 1U);
  EXPECT_EQ(loaded.file.rejected[0].line, 4);
}

TEST(LoadDataTest, TargetsAreNamed) {
  const Loaded loaded =
      Load(Rows("x_mm,y_mm,z_mm,target", {"1,2,3,b", "4,5,6,a"}), {},
           TwoJoints({"a", "b"}));
  EXPECT_EQ(loaded.block().targets, (std::vector<int>{1, 0}));
  EXPECT_TRUE(loaded.block().poses.empty());
}

TEST(LoadDataTest, KeepsTheSetOfEachPose) {
  const Loaded loaded =
      Load(Rows("x_mm,set,comment,approach_dir", {"1,a,,", ",b,x,", "2,,,y"}));
  EXPECT_EQ(loaded.file.sets, (std::vector<std::string>{"a", ""}));
}

TEST(LoadDataTest, KeepsOnlyTheRowsAskedFor) {
  DataFormat format;
  format.where = {{"series", "B"}};
  const Loaded loaded =
      Load(Rows("x_mm,series", {"1,A", "2,B", "3,B"}), format);
  EXPECT_EQ(loaded.data().num_poses(), 2);
  EXPECT_EQ(loaded.block().measured(0, 0), 0.002);
  EXPECT_EQ(loaded.data().sources[0].line, 3);
  EXPECT_TRUE(loaded.file.rejected.empty());
}

TEST(LoadDataTest, ReadsSeveralTargetsInARow) {
  DataFormat format;
  format.ignore_others = true;
  format.columns.targets = {{"b", {"s1_x_mm", "s1_y_mm", "s1_z_mm"}},
                            {"a", {"s2_x_mm", "s2_y_mm", "s2_z_mm"}}};
  const Loaded loaded =
      Load(Rows("s1_x_mm,s1_y_mm,s1_z_mm,s2_x_mm,s2_y_mm,s2_z_mm,x_mm",
                {"1,2,3,4,5,6,9", ",,,7,8,9,9", "nan,nan,nan,,,,9"}),
           format, TwoJoints({"a", "b"}));
  const ObservationBlock& block = loaded.block();
  EXPECT_EQ(loaded.data().blocks.size(), 1U);
  EXPECT_EQ(block.poses, (std::vector<int>{0, 0, 1}));
  EXPECT_EQ(block.targets, (std::vector<int>{1, 0, 0}));
  EXPECT_EQ(block.measured.col(1), Vector3d(0.004, 0.005, 0.006));
  EXPECT_EQ(loaded.file.rejected.size(), 1U);
}

TEST(LoadDataTest, ReadsMappedOrientationsAndPoints) {
  DataFormat format = WithRotation("rotation_vector");
  format.ignore_others = true;
  format.columns.orientation = {"a_rad", "b_rad", "c_rad"};
  format.columns.point = {"tool", "socket"};
  const Loaded loaded = Load(
      Rows("a_rad,b_rad,c_rad,tool,socket,qw", {"0.1,0,0,t1,s2,7", ",,,,,"}),
      format);
  EXPECT_EQ(loaded.block(0).kind, MeasurementKind::kPose);
  EXPECT_NEAR(loaded.block(0).measured(3, 0), 0.1, 1e-16);
  EXPECT_EQ(loaded.block(1).kind, MeasurementKind::kFixedPoint);
  EXPECT_EQ(loaded.references.points.at(0).name, "t1/s2");
}

TEST(LoadDataTest, ReadsMappedQuaternionsWithTheirSigmas) {
  DataFormat format;
  format.ignore_others = true;
  format.columns.orientation = {"w", "i", "j", "k"};
  format.columns.std_orientation = {"sx_rad", "sy_rad", "sz_rad"};
  const Loaded loaded = Load(
      Rows("w,i,j,k,sx_rad,sy_rad,sz_rad,rx_deg", {"0,1,0,0,1e-3,2e-3,3e-3,5"}),
      format);
  EXPECT_NEAR(std::abs(loaded.block().measured(3, 0)), kPi, 1e-15);
  EXPECT_EQ(loaded.block().sigmas(5, 0), 3e-3);
}

TEST(LoadDataTest, AcceptsMarksAndLineEndsOfWindows) {
  const Loaded loaded =
      Load("\xef\xbb\xbfq1_deg,q2_deg,x_mm\r\n1,2,\r\n3,4,5\r\n");
  EXPECT_EQ(loaded.data().num_poses(), 1);
  EXPECT_EQ(loaded.file.rejected.size(), 1U);
}

TEST(FormatDatasetTest, WritesPosesThatReadBack) {
  const Loaded loaded = Load(
      Rows("x_mm,y_mm,z_mm,qw,qx,qy,qz", {"1,2,3,0.6,0,0.8,0", "4,,6,,,,"}));
  const std::string text =
      FormatDataset(loaded.data(), TwoJoints(), 4, true, {});
  EXPECT_EQ(text.substr(0, text.find('\n')),
            "q1_deg,q2_deg,x_mm,y_mm,z_mm,wx_deg,wy_deg,wz_deg,std_x_mm,"
            "std_y_mm,std_z_mm,std_wx_deg,std_wy_deg,std_wz_deg");
  const Loaded read = Load(text);
  ASSERT_EQ(read.data().blocks.size(), 2U);
  for (int i = 0; i < 2; ++i) {
    EXPECT_LT(
        (read.block(i).measured.map() - loaded.block(i).measured.map()).norm(),
        1e-15);
    EXPECT_EQ(read.block(i).poses, loaded.block(i).poses);
  }
  EXPECT_EQ(read.block(1).sigmas.col(0), Vector3d(kSigma, kInfinity, kSigma));
  EXPECT_NEAR(read.block(0).sigmas(5, 0), 1e-4, 1e-19);
}

TEST(FormatDatasetTest, NamesTargetsWhereThereAreSeveral) {
  const Arm arm = TwoJoints({"a", "b"});
  const Loaded loaded =
      Load(Rows("x_mm,y_mm,z_mm,target", {"1,2,3,b", "4,5,6,a"}), {}, arm);
  const std::string text = FormatDataset(loaded.data(), arm, 0, false, {});
  EXPECT_EQ(text,
            "q1_deg,q2_deg,x_mm,y_mm,z_mm,target\n"
            "10,20,1,2,3,b\n20,20,4,5,6,a\n");
}

using Vector6d = Eigen::Matrix<double, 6, 1>;

// The inverse of a pose that is moved by `change` on the left, less the inverse
// of the pose itself.
Vector6d InverseMoved(const Vector3d& point, const Matrix3d& rotation,
                      const Vector6d& change) {
  const Vector3d turn = change.tail<3>();
  const Matrix3d moved = Eigen::AngleAxisd(turn.norm(), turn.stableNormalized())
                             .toRotationMatrix() *
                         rotation;
  Vector6d difference;
  difference.head<3>() = -moved.transpose() * (point + change.head<3>()) +
                         rotation.transpose() * point;
  const Eigen::AngleAxisd left(Matrix3d(moved.transpose() * rotation));
  difference.tail<3>() = left.angle() * left.axis();
  return difference;
}

TEST(LoadDataTest, InversePosesAreTurnedRoundWithTheirNoise) {
  DataFormat format;
  format.is_inverse = true;
  const Loaded loaded = Load(
      Rows("x_mm,y_mm,z_mm,wx_rad,wy_rad,wz_rad,std_x_mm,std_y_mm,std_z_mm,"
           "std_wx_rad,std_wy_rad,std_wz_rad",
           {"100,-250,900,0.3,-0.5,1.1,0.1,0.2,0.3,0.001,0.002,0.0005"}),
      format);
  const Vector3d point(0.1, -0.25, 0.9);
  const Vector3d vector(0.3, -0.5, 1.1);
  const Matrix3d rotation =
      Eigen::AngleAxisd(vector.norm(), vector.normalized()).toRotationMatrix();
  const ObservationBlock& block = loaded.block();
  ASSERT_EQ(block.kind, MeasurementKind::kPose);
  const Vector6d measured = block.measured.map().col(0);
  EXPECT_LT((measured.head<3>() + rotation.transpose() * point).norm(), 1e-14);
  EXPECT_LT((measured.tail<3>() + vector).norm(), 1e-14);
  // By differences.
  Eigen::Matrix<double, 6, 6> carried;
  for (int k = 0; k < 6; ++k) {
    constexpr double kStep = 1e-6;
    carried.col(k) =
        InverseMoved(point, rotation, kStep * Vector6d::Unit(k)) / kStep;
  }
  Vector6d sigmas;
  sigmas << 1e-4, 2e-4, 3e-4, 0.001, 0.002, 0.0005;
  const Eigen::Matrix<double, 6, 6> expected =
      carried * sigmas.cwiseAbs2().asDiagonal() * carried.transpose();
  const Eigen::MatrixXd& whitener = block.whiteners.at(0);
  const Eigen::MatrixXd one = whitener * expected * whitener.transpose();
  EXPECT_LT((one - Eigen::MatrixXd::Identity(6, 6)).cwiseAbs().maxCoeff(),
            1e-4);
}

TEST(LoadDataTest, RotationMatricesAreOrientations) {
  const std::string header =
      "x_mm,y_mm,z_mm,r11,r12,r13,r21,r22,r23,r31,r32,r33";
  const Loaded loaded = Load(Rows(header, {"1,2,3,0,-1,0,1,0,0,0,0,1"}));
  const Vector3d turn = loaded.block().measured.map().col(0).tail<3>();
  EXPECT_LT((turn - Vector3d(0.0, 0.0, 0.5 * kPi)).norm(), 1e-14);
  // A mirror, and lengths that are no unit.
  for (const char* row :
       {"1,2,3,0,1,0,1,0,0,0,0,1", "1,2,3,0,-2,0,2,0,0,0,0,2"}) {
    EXPECT_THROW(Load(Rows(header, {row})), InputError) << row;
  }
}

}  // namespace
}  // namespace alidade::internal::dataset_kinds_test
