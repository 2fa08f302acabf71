// Measurements from several stations, each with a base of its own.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <vector>

#include "alidade/calibration.h"
#include "alidade/rotation.h"
#include "src/calibration/station_frames.h"
#include "src/common/random.h"
#include "src/kernel/measurement_model.h"
#include "src/model/joint_draw.h"
#include "tests/support/matrix_kinematics.h"
#include "tests/support/rv2aj_arms.h"

namespace alidade::internal::stations_test {
namespace {

constexpr double kSigma = 2e-5;  // m
constexpr int kPosesEach = 60;

Arm NominalArm() {
  Arm arm = testing::Rv2ajFlange();
  arm.last_from_target().translation() = Eigen::Vector3d(0.03, -0.02, 0.05);
  return arm;
}

// Where the instrument of each station sees that of the first one's frame.
std::vector<Eigen::Isometry3d> FarStations() {
  std::vector<Eigen::Isometry3d> stations(3, Eigen::Isometry3d::Identity());
  // On the other side of the arm, and on a shelf.
  stations[1].linear() =
      Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  stations[1].translation() = Eigen::Vector3d(3.2, -0.4, 0.05);
  stations[2].linear() =
      Eigen::AngleAxisd(1.1, Eigen::Vector3d(0.3, -0.5, 0.8).normalized())
          .toRotationMatrix();
  stations[2].translation() = Eigen::Vector3d(-1.0, 2.5, 1.5);
  return stations;
}

// Positions, or poses, from each station in turn.
Dataset Measure(const Arm& real, const std::vector<Eigen::Isometry3d>& stations,
                bool with_orientation, std::uint64_t seed) {
  const auto count = static_cast<int>(stations.size());
  const int poses = kPosesEach * count;
  const Eigen::MatrixXd q = DrawJointValues(real, poses, seed);
  Random random(seed, 7);
  Eigen::MatrixXd measured(with_orientation ? 6 : 3, poses);
  Eigen::MatrixXd covariates = Eigen::MatrixXd::Zero(count - 1, poses);
  for (int i = 0; i < poses; ++i) {
    const int station = i % count;
    if (station > 0) covariates(station - 1, i) = 1.0;
    const Eigen::Matrix4d seen =
        stations[station].matrix() *
        testing::MatrixTargetFrame(real, q.col(i).data()).cast<double>();
    measured.col(i).head<3>() = seen.topRightCorner<3, 1>();
    for (double& value : measured.col(i).head<3>()) {
      value += kSigma * random.Normal();
    }
    if (!with_orientation) continue;
    Eigen::Vector3d noise;
    for (double& value : noise) value = 1e-4 * random.Normal();
    measured.col(i).tail<3>() = VectorFromRotation(Eigen::Matrix3d(
        RotationFromVector<double>(noise) * seen.topLeftCorner<3, 3>()));
  }
  Dataset data = MakePositions(q, measured.topRows(3).eval(), kSigma);
  if (with_orientation) {
    data.blocks[0].kind = MeasurementKind::kPose;
    data.blocks[0].measured = measured;
    Eigen::MatrixXd sigmas(6, poses);
    sigmas.topRows(3).setConstant(kSigma);
    sigmas.bottomRows(3).setConstant(1e-4);
    data.blocks[0].sigmas = sigmas;
  }
  for (int k = 1; k < count; ++k) {
    data.covariate_names.push_back("station " + std::to_string(k));
  }
  data.covariates = covariates;
  return data;
}

CalibrationOptions Options(int stations, ErrorTermSelection selection) {
  CalibrationOptions options;
  options.identifiability.candidates = {true, true, true};
  options.errors.selection = selection;
  options.errors.elasticity = true;
  for (int k = 1; k < stations; ++k) {
    CovariateUse use{"station " + std::to_string(k)};
    use.is_station = true;
    options.errors.uses.push_back(use);
  }
  return options;
}

// Positions that the arm of a result predicts for what was measured (m).
double ErrorOf(const Arm& arm, const Dataset& data) {
  const MeasurementModel model(arm);
  const Dataset positions = [&] {
    Dataset copy = data;
    copy.blocks[0].kind = MeasurementKind::kPosition;
    copy.blocks[0].measured = data.blocks[0].measured.map().topRows(3).eval();
    copy.blocks[0].sigmas = data.blocks[0].sigmas.map().topRows(3).eval();
    return copy;
  }();
  return std::sqrt(
      model.Errors(model.NominalValues(), positions).map().squaredNorm() /
      static_cast<double>(data.num_poses()));
}

class FarStationsTest
    : public ::testing::TestWithParam<std::tuple<bool, ErrorTermSelection>> {};

TEST_P(FarStationsTest, EachGetsItsBase) {
  const auto [with_orientation, selection] = GetParam();
  const Arm real = testing::WithRv2ajDeviations(NominalArm());
  CalibrationData data(Measure(real, FarStations(), with_orientation, 1));
  data.validation = Measure(real, FarStations(), with_orientation, 2);
  const CalibrationResult result =
      Calibrate(NominalArm(), data, Options(3, selection));
  ASSERT_TRUE(result.IsUsable()) << result.message;
  ASSERT_EQ(result.arm.errors.covariates.size(), 2U);
  // Noise of three coordinates, and the error of some forty coefficients.
  EXPECT_LT(result.validation->after.rms, 1.25 * std::sqrt(3.0) * kSigma);
  // The arm holds the stations as they were measured.
  EXPECT_LT(ErrorOf(result.arm, *data.validation),
            1.25 * std::sqrt(3.0) * kSigma);
  EXPECT_LT(ErrorOf(result.arm, data.training), 1.1 * std::sqrt(3.0) * kSigma);
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, FarStationsTest,
    ::testing::Combine(::testing::Bool(),
                       ::testing::Values(ErrorTermSelection::kAuto,
                                         ErrorTermSelection::kStated)));

// `errors: none` leaves the arm rigid, and each station has its base.
TEST(StationsTest, RigidArmsHaveABaseAtEachStation) {
  const Arm real = testing::WithRv2ajDeviations(NominalArm());
  const CalibrationData data(Measure(real, FarStations(), false, 1));
  const CalibrationResult result =
      Calibrate(NominalArm(), data, Options(3, ErrorTermSelection::kNone));
  EXPECT_LT(result.train.after.rms, 1.1 * std::sqrt(3.0) * kSigma);
  EXPECT_EQ(result.arm.errors.covariates.size(), 2U);
}

TEST(StationsTest, OnesOfTwoPosesAreNamed) {
  const Arm real = testing::WithRv2ajDeviations(NominalArm());
  const std::vector<Eigen::Isometry3d> alike(2, Eigen::Isometry3d::Identity());
  Dataset measured = Measure(real, alike, false, 1);
  const auto warned = [&measured](int poses) {
    Eigen::MatrixXd covariates = Eigen::MatrixXd::Zero(1, measured.num_poses());
    covariates.leftCols(poses).setOnes();
    measured.covariates = covariates;
    const CalibrationResult result =
        Calibrate(NominalArm(), CalibrationData(measured),
                  Options(2, ErrorTermSelection::kStated));
    return std::any_of(result.warnings.begin(), result.warnings.end(),
                       [](const std::string& warning) {
                         return warning.find(
                                    "fewer than three training poses "
                                    "were measured from ") == 0;
                       });
  };
  EXPECT_TRUE(warned(2));
  EXPECT_FALSE(warned(12));
}

TEST(StationsTest, NearOnesAreNotMoved) {
  std::vector<Eigen::Isometry3d> stations(2, Eigen::Isometry3d::Identity());
  stations[1].translation() = Eigen::Vector3d(2e-3, -1e-3, 3e-3);
  const Arm real = testing::WithRv2ajDeviations(NominalArm());
  CalibrationTask task;
  task.arm = NominalArm();
  task.data.training = Measure(real, stations, false, 1);
  task.options = Options(2, ErrorTermSelection::kAuto);
  const Eigen::MatrixXd before = task.data.training.positions().map();
  EXPECT_TRUE(AlignStations(&task).empty());
  EXPECT_EQ(task.data.training.positions().map(), before);
  const CalibrationResult result = Calibrate(task);
  ASSERT_EQ(result.arm.errors.covariates.size(), 1U);
  const Eigen::Vector3d moved = result.arm.instrument_from_base.linear() *
                                result.arm.errors.covariates[0].base.head<3>();
  EXPECT_LT((moved - stations[1].translation()).norm(), 1e-4);
  EXPECT_LT(ErrorOf(result.arm, task.data.training),
            1.1 * std::sqrt(3.0) * kSigma);
}

TEST(StationsTest, ErrorsOfDirectionsTurnWithTheirStation) {
  const Arm real = testing::WithRv2ajDeviations(NominalArm());
  CalibrationTask task;
  task.arm = NominalArm();
  task.data.training = Measure(real, FarStations(), false, 1);
  task.options = Options(3, ErrorTermSelection::kAuto);
  Eigen::Matrix3Xd sigmas(3, 3 * kPosesEach);
  sigmas.colwise() = Eigen::Vector3d(1e-5, 1e-4, 1e-3);
  task.data.training.sigmas() = sigmas;
  const Dataset before = task.data.training;
  const std::vector<MovedStation> moved = AlignStations(&task);
  ASSERT_EQ(moved.size(), 2U);
  const ObservationBlock& block = task.data.training.blocks[0];
  // A small error in the instrument's axes has the same size, whitened.
  const Eigen::Vector3d error(2e-5, -3e-4, 5e-4);
  for (int i = 0; i < 6; ++i) {
    Eigen::MatrixXd turned = error;
    if (i % 3 > 0)
      turned = moved[i % 3 - 1].first_from_station.linear() * error;
    Eigen::MatrixXd plain = error;
    Whiten(block, i, 1, turned);
    Whiten(before.blocks[0], i, 1, plain);
    EXPECT_LT((turned - plain).norm(), 1e-9) << i;
  }
}

}  // namespace
}  // namespace alidade::internal::stations_test
