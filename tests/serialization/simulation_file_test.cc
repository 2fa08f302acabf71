#include "src/serialization/simulation_file.h"

#include <gtest/gtest.h>

#include <string>
#include <variant>

#include "alidade/parameter_layout.h"
#include "alidade/units.h"
#include "tests/support/config_files.h"
#include "tests/support/io_test_util.h"

namespace alidade::internal {
namespace {

TEST(LoadSimulationTest, ReadsACylinder) {
  const ConfigFiles files;
  const SimulationConfig config = LoadSimulation(files.simulation());
  EXPECT_EQ(config.title, "A test");
  EXPECT_EQ(config.noise_sigma, 2e-5);
  EXPECT_EQ(config.seed, 5U);
  EXPECT_EQ(config.joint_decimals, 3);
  EXPECT_EQ(config.output, files.directory().Path("out/data.csv"));
  const auto& grid = std::get<CylinderGrid>(config.poses);
  EXPECT_EQ(grid.azimuth.from, -kPi / 2.0);
  EXPECT_EQ(grid.azimuth.to, kPi / 2.0);
  EXPECT_EQ(grid.azimuth.count, 3);
  EXPECT_EQ(grid.radius.from, 0.1);
  EXPECT_EQ(grid.radius.to, 0.2);
  EXPECT_EQ(grid.radius.count, 2);
  EXPECT_EQ(grid.height, 0.25);
  EXPECT_EQ(grid.elevation_from, -45.0 * kDegree);
  EXPECT_EQ(grid.elevation_to, 30.0 * kDegree);
  EXPECT_EQ(grid.start, Eigen::Vector2d(10.0 * kDegree, 0.02));
}

TEST(LoadSimulationTest, AddsDeviationsToTheNominalArm) {
  const ConfigFiles files;
  const SimulationConfig config = LoadSimulation(files.simulation());
  const ParameterLayout layout(2);
  EXPECT_NEAR(config.true_values[*layout.Find("r1")], 0.1005, 1e-15);
  EXPECT_NEAR(config.true_values[*layout.Find("alpha2")], kPi / 2.0 + 0.002,
              1e-15);
}

SimulationConfig LoadWithPoses(const std::string& poses) {
  const ConfigFiles files;
  const std::string text =
      "format: alidade-simulation-1\nunits: {length: mm, angle: deg}\n"
      "arm: arm.yaml\nposes: " +
      poses + "\nseed: 0\noutput: o.csv\n";
  return LoadSimulation(files.directory().Write("poses.yaml", text));
}

TEST(LoadSimulationTest, ReadsOtherKindsOfPoses) {
  const SimulationConfig random = LoadWithPoses("{random: {count: 10}}");
  EXPECT_EQ(std::get<RandomPoses>(random.poses).count, 10);
  EXPECT_EQ(random.noise_sigma, 0.0);
  EXPECT_EQ(random.joint_decimals, 4);
  const SimulationConfig file = LoadWithPoses("{file: data.csv}");
  const auto& poses = std::get<PosesFromFile>(file.poses);
  EXPECT_EQ(poses.joint_values.col(1), Eigen::Vector2d(20.0 * kDegree, 0.2));
  ASSERT_EQ(file.input_files.size(), 3U);
  EXPECT_EQ(file.input_files[2], poses.path);
}

TEST(LoadSimulationTest, RandomPosesNeedLimits) {
  const ConfigFiles files;
  files.directory().Write("arm.yaml",
                          Apply(kArmText, {", limits: [0, 500]", ""}));
  const std::string path = files.directory().Write(
      "poses.yaml",
      "format: alidade-simulation-1\nunits: {length: mm, angle: deg}\n"
      "arm: arm.yaml\nposes:\n  random: {count: 10}\nseed: 0\noutput: o.csv\n");
  ExpectInputError([&] { LoadSimulation(path); },
                   {5, 11, "poses.random", "joint 2 of arm \"two joints\""});
}

class LoadSimulationErrorTest
    : public ::testing::TestWithParam<ConfigErrorCase> {};

TEST_P(LoadSimulationErrorTest, NamesLineColumnKeyAndWhatWasExpected) {
  const ConfigFiles files(GetParam().edit);
  ExpectInputError([&] { LoadSimulation(files.simulation()); },
                   GetParam().expected);
}

INSTANTIATE_TEST_SUITE_P(
    Simulations, LoadSimulationErrorTest,
    ::testing::Values(
        ConfigErrorCase{"UnknownPoses",
                        {"  cylinder:", "  cilinder:"},
                        {7, 3, "poses.cilinder", "did you mean \"cylinder\""}},
        ConfigErrorCase{"TwoKindsOfPoses",
                        {"poses:\n", "poses:\n  random: {count: 1}\n"},
                        {7, 3, "poses",
                         "expected exactly one of cylinder, "
                         "random, file, found 2"}},
        ConfigErrorCase{"NegativeCount",
                        {"count: 3", "count: -3"},
                        {8, 41, "poses.cylinder.azimuth.count",
                         "expected an integer from 1 to 10000000, found -3"}},
        ConfigErrorCase{
            "CountOfOne",
            {"count: 3", "count: 1"},
            {8, 41, "poses.cylinder.azimuth.count", "expected 2 or more"}},
        ConfigErrorCase{"TooManyPoses",
                        {"count: 3", "count: 9000000"},
                        {8, 5, "poses.cylinder",
                         "expected at most 10000000 poses, found 18000000"}},
        ConfigErrorCase{"NegativeRadius",
                        {"from: 100", "from: -100"},
                        {9, 13, "poses.cylinder.radius", "not below zero"}},
        ConfigErrorCase{
            "ElevationSwapped",
            {"[-45, 30]", "[30, -45]"},
            {11, 16, "poses.cylinder.elevation",
             "expected [lower, upper] with lower not above upper, found [30"}},
        ConfigErrorCase{"StartTooShort",
                        {"[10, 20]", "[10]"},
                        {12, 12, "poses.cylinder.start",
                         "expected a list of 2 (a value for every joint of "
                         "the arm), found 1"}},
        ConfigErrorCase{"NegativeNoise",
                        {"sigma: 0.02", "sigma: -0.02"},
                        {13, 16, "noise.sigma",
                         "expected a length of 0 or more, found -0.02"}},
        ConfigErrorCase{"NoSeed",
                        {"seed: 5\n", ""},
                        {1, 1, "seed", "missing, expected this key"}},
        ConfigErrorCase{"TooManyDecimals",
                        {"joint_decimals: 3", "joint_decimals: 13"},
                        {15, 17, "joint_decimals",
                         "expected an integer from 0 to 12, found 13"}},
        ConfigErrorCase{"OutputIsInput",
                        {"out/data.csv", "./arm.yaml"},
                        {16, 9, "output",
                         "expected a file that the simulation does not read"}}),
    CaseName);

}  // namespace
}  // namespace alidade::internal
