#include "src/simulation/simulation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "alidade/error.h"
#include "alidade/inverse_kinematics.h"
#include "alidade/units.h"
#include "src/kernel/measurement_model.h"
#include "src/model/chain_axes.h"
#include "src/serialization/simulation_file.h"

namespace alidade::internal {
namespace {

SimulationConfig StudySimulation(std::uint64_t seed) {
  SimulationConfig config =
      LoadSimulation(std::string(ALIDADE_SOURCE_DIR) +
                     "/configs/simulations/rv2aj_wrist_56.yaml");
  config.seed = seed;
  return config;
}

// What a file says of the motors is what the arm was measured at, to the bit.
TEST(SimulateTest, MotorsAreRoundedAndJointsFollow) {
  SimulationConfig config = StudySimulation(3);
  const int n = config.arm.num_joints();
  config.arm.motor_offsets =
      Eigen::VectorXd::Constant(n, 12.345678912345 * kDegree);
  config.arm.joints_from_motors = Eigen::MatrixXd::Identity(n, n);
  config.arm.joints_from_motors(2, 1) = -1.0;
  config.poses = RandomPoses{20};
  for (const int decimals : {1, 4}) {
    config.joint_decimals = decimals;
    const Dataset data = Simulate(config);
    const Eigen::MatrixXd motors =
        MotorsFromJoints(config.arm, data.joint_values.map().eval());
    const double scale = std::pow(10.0, decimals) / kDegree;
    for (const double motor : motors.reshaped()) {
      EXPECT_NEAR(motor * scale, std::round(motor * scale), 1e-8);
    }
  }
}

TEST(SimulateTest, PosesAreOnTheGridWithinLimitsAndElevation) {
  const SimulationConfig config = StudySimulation(3);
  const Dataset data = Simulate(config);
  ASSERT_EQ(data.num_poses(), 56);
  for (Eigen::Index i = 0; i < data.num_poses(); ++i) {
    const Eigen::VectorXd q = data.joint_values.col(i);
    EXPECT_TRUE(IsWithinLimits(config.arm, q));
    ChainAxes axes;
    ComputeChainAxes(config.arm, q.data(), &axes);
    const Eigen::Vector3d p = axes.instrument_from_target.translation();
    const double azimuth =
        (-140.0 + 40.0 * static_cast<double>(i / 7)) * kDegree;
    const double radius =
        (210.0 + 190.0 / 6.0 * static_cast<double>(i % 7)) * kMillimetre;
    // Joint values of four decimals leave less than a micrometre.
    EXPECT_NEAR(p.z(), 215e-3, 1e-6);
    EXPECT_NEAR(p.x(), radius * std::cos(azimuth), 2e-6);
    EXPECT_NEAR(p.y(), radius * std::sin(azimuth), 2e-6);
    const Eigen::Vector3d direction = axes.instrument_from_last.linear().col(2);
    const double outwards =
        direction.x() * std::cos(azimuth) + direction.y() * std::sin(azimuth);
    const double elevation = std::atan2(direction.z(), outwards) / kDegree;
    EXPECT_GE(elevation, -110.001);
    EXPECT_LE(elevation, -29.999);
  }
}

TEST(SimulateTest, JointValuesHaveTheDecimalsAskedFor) {
  SimulationConfig config = StudySimulation(3);
  config.joint_decimals = 2;
  const Dataset data = Simulate(config);
  for (Eigen::Index i = 0; i < data.num_poses(); ++i) {
    for (int j = 0; j < data.num_joints(); ++j) {
      const double hundredths = data.joint_values(j, i) / kDegree * 100.0;
      EXPECT_NEAR(hundredths, std::round(hundredths), 1e-9);
    }
  }
}

TEST(SimulateTest, ExactPositionsAreThoseOfTheRealArm) {
  const SimulationConfig config = StudySimulation(3);
  const Dataset data = Simulate(config);
  const MeasurementModel model(config.arm);
  const SharedVector errors = model.Errors(config.true_values, data);
  // A few units in the last place of half a metre.
  EXPECT_LT(errors.map().cwiseAbs().maxCoeff(), 4e-16);
  EXPECT_GT(model.Errors(model.NominalValues(), data).map().norm(), 1e-3);
}

TEST(SimulateTest, NoiseHasItsSigmaAndLeavesThePosesAlone) {
  SimulationConfig config = StudySimulation(3);
  config.poses = RandomPoses{2000};
  const Dataset exact = Simulate(config);
  config.noise_sigma = 0.02 * kMillimetre;
  const Dataset noisy = Simulate(config);
  EXPECT_EQ(exact.joint_values, noisy.joint_values);
  const Eigen::Matrix3Xd noise =
      noisy.positions().map() - exact.positions().map();
  const double sigma = std::sqrt(noise.squaredNorm() / 6000.0);
  // The estimate's own standard deviation is sigma / sqrt(2 * 6000): 0.9 %.
  EXPECT_NEAR(sigma / config.noise_sigma, 1.0, 0.04);
  EXPECT_NEAR(noise.mean() / config.noise_sigma, 0.0, 4.0 / std::sqrt(6000.0));
  EXPECT_EQ(noisy.sigmas().map().minCoeff(), config.noise_sigma);
}

TEST(SimulateTest, SameSeedSameBitsOtherSeedOtherPoses) {
  const Dataset a = Simulate(StudySimulation(3));
  const Dataset b = Simulate(StudySimulation(3));
  const Dataset c = Simulate(StudySimulation(4));
  EXPECT_EQ(a.joint_values, b.joint_values);
  EXPECT_EQ(a.positions(), b.positions());
  EXPECT_NE(a.joint_values, c.joint_values);
}

TEST(SimulateTest, GridOutOfReachIsAnErrorThatNamesTheTarget) {
  SimulationConfig config = StudySimulation(3);
  std::get<CylinderGrid>(config.poses).radius.to = 0.9;
  try {
    Simulate(config);
    FAIL() << "expected an error";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("radius"), std::string::npos);
    EXPECT_EQ(error.location().key, "poses.cylinder");
  }
}

}  // namespace
}  // namespace alidade::internal
