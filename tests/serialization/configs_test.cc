#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "alidade/arm_file.h"
#include "alidade/error.h"
#include "src/serialization/config_file.h"
#include "src/serialization/job_config.h"
#include "src/serialization/job_matrix.h"
#include "src/serialization/plan_file.h"
#include "src/serialization/simulation_file.h"
#include "tests/support/io_test_util.h"
#include "tests/support/real_arm_data.h"

namespace alidade::internal {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> YamlFiles(const std::string& directory) {
  std::vector<std::string> paths;
  for (const auto& entry :
       fs::recursive_directory_iterator(SourcePath(directory))) {
    if (entry.path().extension() == ".yaml") {
      paths.push_back(entry.path().string());
    }
  }
  return paths;
}

// The first and the last job of a file.
void LoadEveryJob(const std::string& path) {
  const JobMatrix matrix(path);
  // The first and the last tell of the thousand between.
  for (const std::int64_t job : {std::int64_t{0}, matrix.size() - 1}) {
    matrix.Load(job, {});
  }
}

// Every file loads; deviations are read for the arm of the study, or of the
// cell that they lie beside. A job whose
// data are elsewhere is read as far as the key that names them.
TEST(ConfigsTest, EveryFileLoads) {
  const Arm arm = LoadArm(SourcePath("configs/robots/rv2aj_wrist.yaml"));
  const Arm cell = LoadArm(SourcePath("configs/simulations/kr6_cell.yaml"));
  const std::vector<std::string> paths = YamlFiles("configs");
  EXPECT_GE(paths.size(), 9U);
  for (const std::string& path : paths) {
    SCOPED_TRACE(path);
    switch (DetectFormat(path)) {
      case FileFormat::kArm:
        EXPECT_NO_THROW(LoadArm(path));
        break;
      case FileFormat::kDeviations:
        EXPECT_NO_THROW(LoadDeviations(
            path, path.find("kr6") == std::string::npos ? arm : cell));
        break;
      case FileFormat::kJob:
        if (testing::WhatDataLack(path).empty()) {
          EXPECT_NO_THROW(LoadEveryJob(path));
        } else {
          EXPECT_THROW(LoadJob(path), InputError);
        }
        break;
      case FileFormat::kSimulation:
        EXPECT_NO_THROW(LoadSimulation(path));
        break;
      case FileFormat::kPlan:
        EXPECT_NO_THROW(LoadPlan(path));
        break;
    }
  }
}

TEST(ConfigsTest, StudyIsTheOneOfTheDesign) {
  const JobConfig job = LoadJob(SourcePath("configs/jobs/rv2aj_study.yaml"));
  EXPECT_EQ(job.data.training.num_poses(), 56);
  EXPECT_EQ(job.data.validation->num_poses(), 3600);
  EXPECT_EQ(job.options.solver, SolverName::kCeres);
  EXPECT_EQ(job.options.compare_with,
            std::vector<SolverName>{SolverName::kPseudoInverse});
  EXPECT_EQ(job.options.acceptance.train_max, 1e-6);
  EXPECT_EQ(job.options.acceptance.validation_max, 1e-6);
  ASSERT_TRUE(job.published.has_value());
  EXPECT_NEAR(job.published->baseline_time_s / 60.0, 59.0533, 1e-12);
  EXPECT_EQ(job.published->figures.size(), PublishedQuantityNames().size());
}

TEST(ConfigsTest, FlangeJobHoldsWhatDepends) {
  const JobConfig job = LoadJob(SourcePath("configs/jobs/rv2aj_flange.yaml"));
  EXPECT_EQ(job.options.identifiability.fix,
            (std::vector<std::string>{"alpha5", "theta4"}));
  EXPECT_FALSE(job.published.has_value());
}

TEST(ConfigsTest, SimulationsWriteWhatTheJobsRead) {
  for (const std::string name : {"wrist", "flange"}) {
    const JobConfig job = LoadJob(
        SourcePath("configs/jobs/rv2aj_" +
                   std::string(name == "wrist" ? "study" : name) + ".yaml"));
    const std::string stem = "configs/simulations/rv2aj_" + name;
    const SimulationConfig train =
        LoadSimulation(SourcePath(stem + "_56.yaml"));
    EXPECT_EQ(train.output, job.data.training.name);
    EXPECT_EQ(train.true_values, *job.options.true_values);
    EXPECT_EQ(LoadSimulation(SourcePath(stem + "_3600.yaml")).output,
              job.data.validation->name);
  }
}

}  // namespace
}  // namespace alidade::internal
