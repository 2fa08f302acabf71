#include "alidade/run_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "alidade/dataset_file.h"
#include "alidade/error.h"
#include "alidade/forward_kinematics.h"
#include "src/common/constants.h"
#include "tests/support/io_test_util.h"
#include "tests/support/matrix_kinematics.h"
#include "tests/support/rv2aj_arms.h"

namespace alidade::internal {
namespace {

using ::testing::HasSubstr;

const std::string kSource = ALIDADE_SOURCE_DIR;

TEST(DrawConfigurationsTest, DrawsWithinTheLimits) {
  const Arm arm = testing::Rv2ajFlange();
  const Eigen::MatrixXd drawn = DrawConfigurations(arm, 4000, 1);
  ASSERT_EQ(drawn.rows(), 5);
  for (int j = 0; j < 5; ++j) {
    const double lower = arm.joints[j].lower, upper = arm.joints[j].upper;
    EXPECT_GE(drawn.row(j).minCoeff(), lower);
    EXPECT_LE(drawn.row(j).maxCoeff(), upper);
    // Of a uniform distribution: range / sqrt(12 n) is 0.5 % of the range.
    EXPECT_NEAR(drawn.row(j).mean(), 0.5 * (lower + upper),
                0.02 * (upper - lower));
    EXPECT_NEAR(drawn.row(j).maxCoeff(), upper, 0.01 * (upper - lower));
    EXPECT_NEAR(drawn.row(j).minCoeff(), lower, 0.01 * (upper - lower));
  }
  EXPECT_EQ(DrawConfigurations(arm, 4000, 1), drawn);
  EXPECT_NE(DrawConfigurations(arm, 4000, 2), drawn);
  Arm unlimited = arm;
  unlimited.joints[2].lower = -kInfinity;
  unlimited.joints[2].upper = kInfinity;
  const Eigen::MatrixXd turns = DrawConfigurations(unlimited, 500, 1);
  EXPECT_TRUE(turns.allFinite());
  EXPECT_LE(turns.row(2).cwiseAbs().maxCoeff(), kPi);
}

TEST(SimulatePositionsTest, WithoutNoiseTheyAreThoseOfTheArm) {
  const Arm arm = testing::Rv2ajFlange();
  const Eigen::MatrixXd joints = DrawConfigurations(arm, 50, 3);
  const Dataset data = SimulatePositions(arm, joints, 0.0, 1);
  EXPECT_EQ(Eigen::MatrixXd(data.joint_values.map()), joints);
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector3d expected =
        testing::MatrixPosition(arm, joints.col(i).data()).cast<double>();
    // Half a unit in the last place of 1 m.
    EXPECT_LT((data.positions().col(i) - expected).cwiseAbs().maxCoeff(),
              2.3e-16);
  }
}

TEST(SimulatePositionsTest, NoiseIsGaussianAndOfItsStream) {
  const Arm arm = testing::Rv2ajFlange();
  constexpr double kSigma = 3e-5;
  const Eigen::MatrixXd joints = DrawConfigurations(arm, 3000, 3);
  const Dataset exact = SimulatePositions(arm, joints, 0.0, 1);
  const Dataset noisy = SimulatePositions(arm, joints, kSigma, 1);
  const Eigen::MatrixXd noise =
      (noisy.positions().map() - exact.positions().map()) / kSigma;
  const auto n = static_cast<double>(noise.size());
  EXPECT_NEAR(noise.mean(), 0.0, 4.0 / std::sqrt(n));
  EXPECT_NEAR(noise.squaredNorm() / n, 1.0, 4.0 * std::sqrt(2.0 / n));
  const double within =
      static_cast<double>((noise.array().abs() < 1.0).count()) / n;
  EXPECT_NEAR(within, 0.6827, 4.0 * std::sqrt(0.22 / n));
  EXPECT_TRUE((noisy.sigmas().map().array() == kSigma).all());
  // Pose k has the noise of stream k, however many there are.
  const Dataset few = SimulatePositions(arm, joints.leftCols(10), kSigma, 1);
  EXPECT_EQ(Eigen::MatrixXd(few.positions().map()),
            Eigen::MatrixXd(noisy.positions().map().leftCols(10)));
  EXPECT_NE(
      Eigen::MatrixXd(SimulatePositions(arm, joints.leftCols(10), kSigma, 2)
                          .positions()
                          .map()),
      Eigen::MatrixXd(few.positions().map()));
}

TEST(SimulatePositionsTest, RefusesWhatIsNotFinite) {
  const Arm arm = testing::Rv2ajFlange();
  Eigen::MatrixXd joints = DrawConfigurations(arm, 4, 3);
  joints(1, 2) = kInfinity;
  EXPECT_THROW(SimulatePositions(arm, joints, 0.0, 1), InputError);
  Arm huge = arm;
  huge.joints[1].d = std::numeric_limits<double>::max();
  huge.joints[2].d = std::numeric_limits<double>::max();
  EXPECT_THROW(SimulatePositions(huge, Eigen::MatrixXd::Zero(5, 1), 0.0, 1),
               InputError);
}

TEST(RunSimulationFileTest, IsTheDataSetThatIsThere) {
  const SimulatedMeasurements simulated =
      RunSimulationFile(kSource + "/configs/simulations/rv2aj_wrist_56.yaml");
  EXPECT_EQ(simulated.data.num_poses(), 56);
  EXPECT_EQ(simulated.arm.num_joints(), 5);
  // The real arm of the study (tests/support/rv2aj_arms.h).
  const Arm real = testing::WithRv2ajDeviations(testing::Rv2ajWrist());
  for (int j = 0; j < 5; ++j) {
    EXPECT_NEAR(simulated.real.joints[j].d, real.joints[j].d, 1e-15);
    EXPECT_NEAR(simulated.real.joints[j].alpha, real.joints[j].alpha, 1e-15);
  }
  const Eigen::MatrixXd joints = simulated.data.joint_values.map();
  const Eigen::Vector3d expected =
      testing::MatrixPosition(real, joints.col(7).data()).cast<double>();
  EXPECT_LT(
      (simulated.data.positions().col(7) - expected).cwiseAbs().maxCoeff(),
      5 * simulated.sigma + 1e-9);
  EXPECT_THAT(simulated.output, HasSubstr(".csv"));
}

// A small arm whose job makes its own data.
class RunFilesTest : public ::testing::Test {
 protected:
  RunFilesTest() {
    directory_.Write(
        "arm.yaml",
        "format: alidade-arm-1\nname: three\nunits: {length: m, angle: rad}\n"
        "joints:\n  - {type: revolute, r: 0.3, limits: [-2, 2]}\n"
        "  - {type: revolute, alpha: -1.5707963267948966, limits: [-2, 1]}\n"
        "  - {type: revolute, d: 0.25, limits: [-1.5, 1.5]}\n"
        "tool: {x: 0.2}\n");
    job_ = directory_.Write(
        "job.yaml",
        "format: alidade-job-1\ntitle: Three joints\n"
        "units: {length: m, angle: rad}\narm: arm.yaml\n"
        "data: {simulate: {poses: {random: {count: 30}}, noise: {sigma: "
        "2.0e-5}, seed: 1}}\n"
        "measurement: {sigma: 2.0e-5}\n"
        "montecarlo: {trials: 12, seed: 3, workspace_poses: 20}\n");
  }
  TestDirectory directory_;
  std::string job_;
};

TEST_F(RunFilesTest, AStudyIsTheSameWithThreadsAndSaysHowFarItIs) {
  std::vector<int> done;
  const MonteCarloResult study =
      RunMonteCarloFile(job_, 1, [&](int finished, int wanted) {
        EXPECT_EQ(wanted, 12);
        done.push_back(finished);
      });
  EXPECT_EQ(study.title, "Three joints");
  EXPECT_EQ(study.seed, 3U);
  ASSERT_EQ(study.trials.size(), 12U);
  ASSERT_FALSE(done.empty());
  EXPECT_EQ(done.back(), 12);
  EXPECT_TRUE(std::is_sorted(done.begin(), done.end()));
  const MonteCarloResult same = RunMonteCarloFile(job_, 3);
  for (std::size_t k = 0; k < 12; ++k) {
    EXPECT_EQ(same.trials[k].estimates, study.trials[k].estimates);
  }
}

TEST_F(RunFilesTest, APlanFile) {
  const std::string file = directory_.Write(
      "plan.yaml",
      "format: alidade-plan-1\ntitle: Twelve\nunits: {length: m, angle: rad}\n"
      "arm: arm.yaml\nmeasurement: {sigma: 2.0e-5}\nposes: {count: 12}\n"
      "candidates: {count: 60}\ncurve: []\nseed: 1\n");
  const PlanResult plan = RunPlanFile(file);
  EXPECT_EQ(plan.status, PlanStatus::kDone) << plan.message;
  ASSERT_EQ(plan.joint_values.cols(), 12);
  for (int j = 0; j < 3; ++j) {
    EXPECT_GE(plan.joint_values.row(j).minCoeff(), -2.0);
    EXPECT_LE(plan.joint_values.row(j).maxCoeff(), 2.0);
  }
  EXPECT_EQ(Eigen::MatrixXd(RunPlanFile(file, 3).joint_values),
            Eigen::MatrixXd(plan.joint_values));
}

TEST_F(RunFilesTest, FilesThatAreNoneOfTheirKind) {
  for (const std::string& path :
       {directory_.Path("no.yaml"), directory_.Path("arm.yaml"),
        directory_.Path(""), directory_.Write("empty.yaml", ""),
        directory_.Write("bytes.yaml", std::string("\xff\xfe\0{", 4))}) {
    EXPECT_THROW(RunPlanFile(path), InputError) << path;
    EXPECT_THROW(RunMonteCarloFile(path), InputError) << path;
    EXPECT_THROW(RunSimulationFile(path), InputError) << path;
  }
  EXPECT_THROW(RunPlanFile(job_), InputError);
}

TEST(ExportArmTest, EveryFormatHasItsNumbers) {
  const Arm nominal = testing::Rv2ajFlange();
  Arm real = nominal;
  real.joints[3].d += 1.25e-3;
  real.joints[2].theta += 0.001;
  const ExportedArm json = ExportArm(nominal, real, "json");
  EXPECT_TRUE(nlohmann::json::accept(json.text));
  EXPECT_LT(json.cost.max, 1e-12);
  const ExportedArm table = ExportArm(nominal, real, "mdh", "csv");
  EXPECT_THAT(table.text, HasSubstr("161.25"));
  EXPECT_NE(ExportArm(nominal, real, "mdh", "yaml").text, table.text);
  EXPECT_THAT(ExportArm(nominal, real, "dh", "latex").text,
              HasSubstr("tabular"));
  // Offsets alone leave the length out, and say so.
  const ExportedArm offsets = ExportArm(nominal, real, "offsets");
  EXPECT_FALSE(offsets.lost.empty());
  EXPECT_GT(offsets.cost.max, 1e-4);
  EXPECT_LT(offsets.cost.max, 5e-3);
}

TEST(ExportArmTest, RefusesByKey) {
  const Arm arm = testing::Rv2ajFlange();
  const std::vector<std::array<std::string, 3>> cases = {
      {"step", "csv", "format"},
      {"", "csv", "format"},
      {"DH", "csv", "format"},
      {"dh", "xls", "table"},
      {"dh", "", "table"}};
  for (const auto& [format, table, key] : cases) {
    try {
      ExportArm(arm, arm, format, table);
      ADD_FAILURE() << format << " " << table;
    } catch (const InputError& error) {
      EXPECT_EQ(error.location().key, key);
    }
  }
  // No URDF is named.
  EXPECT_THROW(ExportArm(arm, arm, "urdf"), InputError);
}

TEST(SaveDatasetTest, IsReadBackToTheSameBits) {
  const TestDirectory directory;
  const Arm arm = testing::Rv2ajFlange();
  const Dataset data =
      SimulatePositions(arm, DrawConfigurations(arm, 40, 3), 2e-5, 1);
  for (const char* name : {"set.csv", "set.npy"}) {
    SaveDataset(data, arm, directory.Path(name));
    const Dataset read = LoadDataset(directory.Path(name), arm, 1.0);
    EXPECT_EQ(Eigen::MatrixXd(read.joint_values.map()),
              Eigen::MatrixXd(data.joint_values.map()));
    EXPECT_EQ(Eigen::MatrixXd(read.positions().map()),
              Eigen::MatrixXd(data.positions().map()));
    EXPECT_EQ(Eigen::MatrixXd(read.sigmas().map()),
              Eigen::MatrixXd(data.sigmas().map()));
  }
}

TEST(SaveDatasetTest, RefusesOtherKindsAndPlaces) {
  const TestDirectory directory;
  const Arm arm = testing::Rv2ajFlange();
  Dataset data = SimulatePositions(arm, DrawConfigurations(arm, 2, 3), 0.0, 1);
  EXPECT_THROW(SaveDataset(data, arm, directory.Path("no/such/set.csv")),
               InputError);
  data.blocks[0].kind = MeasurementKind::kFixedPoint;
  EXPECT_THROW(SaveDataset(data, arm, directory.Path("set.csv")), InputError);
}

}  // namespace
}  // namespace alidade::internal
