#include "src/serialization/plan_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "alidade/units.h"
#include "src/serialization/result_json.h"
#include "tests/support/config_files.h"
#include "tests/support/io_test_util.h"

namespace alidade::internal {
namespace {

constexpr char kPlanText[] =
    "format: alidade-plan-1\n"
    "title: A plan\n"
    "units: {length: mm, angle: deg}\n"
    "arm: arm.yaml\n"
    "measured: data.csv\n"
    "measurement: {kind: position, sigma: 0.02, axes: [x, z]}\n"
    "identifiability: {policy: keep, fix: [d1]}\n"
    "poses:\n"
    "  count: 12\n"
    "  repeats: false\n"
    "  minimum_motion: {angle: 5}\n"
    "candidates:\n"
    "  count: 500\n"
    "  limit_faces: false\n"
    "  joint_decimals: 2\n"
    "  boxes: [{x: [0, 100], y: [-50, 50], z: [10, 20]}]\n"
    "  floor: {height: -10, margin: 5}\n"
    "  walls: [{normal: [0, 2, 0], point: [7, -300, 9], margin: 20}]\n"
    "  visibility: {instrument: [1000, 0, 500], axis: [0, 3, 4], angle: 40}\n"
    "criterion: G\n"
    "region: {joints: [[-10, 20], [100, 200]], count: 300}\n"
    "search: {starts: 2, shortlist: 9, max_passes: 7}\n"
    "curve: [20, 8, 12, 8]\n"
    "speeds: [90, 250]\n"
    "seed: 11\n";

class PlanFiles {
 public:
  explicit PlanFiles(const Edit& edit = {}) {
    directory_.Write("arm.yaml", kArmText);
    directory_.Write("data.csv", kDataText);
    path_ = directory_.Write("plan.yaml", Apply(kPlanText, edit));
  }

  const std::string& path() const { return path_; }

 private:
  TestDirectory directory_;
  std::string path_;
};

TEST(LoadPlanTest, ReadsEveryKey) {
  const PlanFiles files;
  const PlanConfig plan = LoadPlan(files.path());
  EXPECT_EQ(plan.title, "A plan");
  EXPECT_EQ(plan.seed, 11U);
  EXPECT_EQ(plan.job.arm.num_joints(), 2);
  EXPECT_EQ(plan.job.data.training.num_poses(), 2);
  EXPECT_EQ(plan.job.data.training.sigmas()(0, 0), 2e-5);
  EXPECT_EQ(plan.job.options.identifiability.policy, WeakPolicy::kKeep);
  EXPECT_EQ(plan.job.options.identifiability.fix,
            std::vector<std::string>{"d1"});
  EXPECT_FALSE(plan.measurement.orientation);
  EXPECT_EQ(plan.measurement.sigma, 2e-5);
  EXPECT_EQ(plan.measurement.num_equations(), 2);
  EXPECT_FALSE(plan.measurement.axes[1]);
  EXPECT_EQ(plan.input_files.size(), 3U);
}

TEST(LoadPlanTest, ReadsTheSearch) {
  const PlanFiles files;
  const PlanConfig plan = LoadPlan(files.path());
  EXPECT_EQ(plan.design.criterion, DesignCriterion::kG);
  EXPECT_EQ(plan.design.num_poses, 12);
  EXPECT_FALSE(plan.design.allow_repeats);
  EXPECT_FALSE(plan.wanted);
  EXPECT_EQ(plan.minimum_motion[0], 5.0 * kDegree);
  EXPECT_TRUE(std::isinf(plan.minimum_motion[1]));
  EXPECT_EQ(plan.design.starts, 2);
  EXPECT_EQ(plan.design.shortlist, 9);
  EXPECT_EQ(plan.design.max_passes, 7);
  EXPECT_EQ(plan.curve, (std::vector<int>{8, 12, 20}));
  EXPECT_EQ(plan.speeds[0], kPi / 2.0);
  EXPECT_EQ(plan.speeds[1], 0.25);
  EXPECT_EQ(plan.region.count, 300);
  EXPECT_EQ(plan.region.joint_limits[1].second, 0.2);
}

TEST(LoadPlanTest, ReadsTheConstraints) {
  const PlanFiles files;
  const PlanConfig plan = LoadPlan(files.path());
  EXPECT_EQ(plan.candidates.count, 500);
  EXPECT_FALSE(plan.candidates.limit_faces);
  EXPECT_EQ(plan.candidates.joint_decimals, 2);
  const PoseConstraints& constraints = plan.constraints;
  ASSERT_EQ(constraints.boxes.size(), 1U);
  EXPECT_EQ(constraints.boxes[0].lower, Eigen::Vector3d(0.0, -0.05, 0.01));
  EXPECT_EQ(constraints.boxes[0].upper, Eigen::Vector3d(0.1, 0.05, 0.02));
  ASSERT_EQ(constraints.half_spaces.size(), 2U);
  EXPECT_EQ(constraints.half_spaces[0].offset, -0.01);
  EXPECT_EQ(constraints.half_spaces[0].margin, 0.005);
  EXPECT_EQ(constraints.half_spaces[1].normal, Eigen::Vector3d::UnitY());
  EXPECT_NEAR(constraints.half_spaces[1].offset, -0.3, 1e-15);
  ASSERT_TRUE(constraints.visibility);
  EXPECT_EQ(constraints.visibility->instrument, Eigen::Vector3d(1.0, 0.0, 0.5));
  EXPECT_LT(
      (constraints.visibility->axis - Eigen::Vector3d(0.0, 0.6, 0.8)).norm(),
      1e-15);
  EXPECT_EQ(constraints.visibility->angle, 40.0 * kDegree);
}

// A plan of more poses holds none out and calibrates nothing.
TEST(LoadPlanTest, ReadsAJobThatValidates) {
  TestDirectory directory;
  directory.Write("arm.yaml", kArmText);
  directory.Write("data.csv", kDataText);
  directory.Write("job.yaml",
                  "format: alidade-job-1\ntitle: A job\n"
                  "units: {length: mm, angle: deg}\narm: arm.yaml\n"
                  "data: data.csv\nmeasurement: {sigma: 0.02}\n"
                  "validation: {data: data.csv}\n"
                  "acceptance: {validation_max: 0.3, train_max: 0.2}\n");
  const std::string path = directory.Write(
      "plan.yaml",
      Apply(Apply(kPlanText, {"arm: arm.yaml\n", "job: job.yaml\n"}),
            {"measured: data.csv\n", ""}));
  const PlanConfig plan = LoadPlan(path);
  EXPECT_EQ(plan.job.data.training.num_poses(), 2);
  EXPECT_FALSE(plan.job.data.validation);
  EXPECT_FALSE(plan.job.options.acceptance.validation_max);
  EXPECT_EQ(plan.job.options.acceptance.train_max, 2e-4);
}

TEST(LoadPlanTest, ReadsRealConfigurations) {
  const PlanFiles files(
      {"  count: 500\n  limit_faces: false\n  joint_decimals: 2\n",
       "  file: data.csv\n"});
  const PlanConfig plan = LoadPlan(files.path());
  ASSERT_TRUE(plan.given_candidates);
  EXPECT_EQ((*plan.given_candidates)(1, 1), 0.2);
}

TEST(LoadPlanTest, ReadsAWantedAccuracy) {
  const PlanFiles files({"count: 12", "accuracy: 0.1\n  most: 40"});
  const PlanConfig plan = LoadPlan(files.path());
  EXPECT_EQ(plan.wanted.value(), 1e-4);
  EXPECT_EQ(plan.design.num_poses, 40);
}

class LoadPlanErrorTest : public ::testing::TestWithParam<ConfigErrorCase> {};

TEST_P(LoadPlanErrorTest, IsAtTheKey) {
  const PlanFiles files(GetParam().edit);
  ExpectInputError([&] { LoadPlan(files.path()); }, GetParam().expected);
}

INSTANTIATE_TEST_SUITE_P(
    All, LoadPlanErrorTest,
    ::testing::Values(
        ConfigErrorCase{"UnknownKey",
                        {"speeds:", "speed:"},
                        {24, 1, "speed", "did you mean \"speeds\""}},
        ConfigErrorCase{"ArmBesideJob",
                        {"arm: arm.yaml\n", "arm: arm.yaml\njob: job.yaml\n"},
                        {4, 6, "arm", "found beside \"job\""}},
        ConfigErrorCase{"CountAndAccuracy",
                        {"count: 12", "count: 12\n  accuracy: 0.1"},
                        {9, 3, "poses", "expected one of `count`"}},
        ConfigErrorCase{"MostWithoutAccuracy",
                        {"count: 12", "count: 12\n  most: 20"},
                        {10, 9, "poses.most", "goes with `accuracy`"}},
        ConfigErrorCase{"NoAxis",
                        {"[x, z]", "[]"},
                        {6, 50, "measurement.axes", "the list is empty"}},
        ConfigErrorCase{
            "RotationOfAPosition",
            {"axes: [x, z]", "sigma_rotation: 1"},
            {6, 60, "measurement.sigma_rotation", "goes with `kind: pose`"}},
        ConfigErrorCase{
            "BoxUpsideDown",
            {"[10, 20]", "[20, 10]"},
            {16, 42, "candidates.boxes[1].z", "lower not above upper"}},
        ConfigErrorCase{
            "NoDirection",
            {"[0, 2, 0]", "[0, 0, 0]"},
            {18, 20, "candidates.walls[1].normal", "expected a direction"}},
        ConfigErrorCase{"DrawnAndRead",
                        {"  count: 500\n", "  count: 500\n  file: data.csv\n"},
                        {13, 10, "candidates.count", "beside \"file\""}},
        ConfigErrorCase{"UnknownCriterion",
                        {"criterion: G", "criterion: O7"},
                        {20, 12, "criterion", "O7"}},
        ConfigErrorCase{"NoSlidingMotion",
                        {"{angle: 5}", "{}"},
                        {11, 19, "poses.minimum_motion", "expected `angle`"}}),
    CaseName);

TEST(FormatPlanJsonTest, IsJsonWithNullForWhatIsInfinite) {
  PlanResult result;
  result.title = "A plan";
  result.joint_dimensions = {Dimension::kAngle, Dimension::kLength};
  result.joint_values = Eigen::Matrix2d::Identity();
  result.pose_std = Eigen::Vector2d(0.1, 0.2);
  result.parameters.emplace_back();
  const nlohmann::json json = nlohmann::json::parse(FormatPlanJson(result));
  EXPECT_EQ(json["format"], "alidade-plan-result-2");
  EXPECT_EQ(json["poses"][1]["joints"], nlohmann::json({0.0, 1.0}));
  EXPECT_EQ(json["poses"][1]["std"], 0.2);
  EXPECT_EQ(json["joint_units"], nlohmann::json({"rad", "m"}));
  EXPECT_TRUE(json["parameters"][0]["prior_std"].is_null());
}

}  // namespace
}  // namespace alidade::internal
