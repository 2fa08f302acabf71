#ifndef ALIDADE_TESTS_SUPPORT_CONFIG_FILES_H_
#define ALIDADE_TESTS_SUPPORT_CONFIG_FILES_H_

#include <gtest/gtest.h>

#include <string>

#include "tests/support/io_test_util.h"

namespace alidade::internal {

inline constexpr char kArmText[] =
    "format: alidade-arm-1\n"
    "name: two joints\n"
    "units: {length: mm, angle: deg}\n"
    "joints:\n"
    "  - {type: revolute, r: 100, limits: [-90, 90]}\n"
    "  - {type: prismatic, alpha: 90, limits: [0, 500]}\n";

inline constexpr char kDeviationsText[] =
    "format: alidade-deviations-1\n"
    "units: {length: mm, angle: mrad}\n"
    "deviations: {r1: 0.5, alpha2: 2}\n";

inline constexpr char kDataText[] =
    "q1_deg,q2_mm,x_mm,y_mm,z_mm\n"
    "10,100,1,2,3\n"
    "20,200,4,5,6\n";

inline constexpr char kJobText[] =
    "format: alidade-job-1\n"
    "title: A test\n"
    "units: {length: mm, angle: mrad}\n"
    "arm: arm.yaml\n"
    "data: data.csv\n"
    "measurement: {sigma: 0.02}\n"
    "truth: deviations.yaml\n"
    "validation: {data: validation.csv}\n"
    "identifiability:\n"
    "  method: rules\n"
    "  fix: [alpha2, d1]\n"
    "  proceed_beyond_rank: true\n"
    "  angle_tolerance: 0.5\n"
    "  relative_tolerance: 1e-8\n"
    "  perturbation: 0.02\n"
    "  seed: 7\n"
    "solver:\n"
    "  name: pseudo_inverse\n"
    "  max_iterations: 12\n"
    "  function_tolerance: 1e-14\n"
    "  precision_limit_factor: 2\n"
    "  wanted_precision: 0.001\n"
    "  initial_trust_region_radius: 1e6\n"
    "  pseudo_inverse_tolerance: 1e-9\n"
    "compare_with: [ceres]\n"
    "acceptance: {train_rms: 0.1, train_max: 0.2, validation_rms: 0.3, "
    "validation_max: 0.4}\n"
    "published:\n"
    "  source: A study\n"
    "  deviations: {r1: 0.4}\n"
    "  angle_decimals: 3\n"
    "  length_decimals: 2\n"
    "  baseline: {iterations: 5, time_s: 60.5}\n"
    "  figures:\n"
    "    - {quantity: after_max, published: 1 mm}\n";

inline constexpr char kSimulationText[] =
    "format: alidade-simulation-1\n"
    "title: A test\n"
    "units: {length: mm, angle: deg}\n"
    "arm: arm.yaml\n"
    "deviations: deviations.yaml\n"
    "poses:\n"
    "  cylinder:\n"
    "    azimuth: {from: -90, to: 90, count: 3}\n"
    "    radius: {from: 100, to: 200, count: 2}\n"
    "    height: 250\n"
    "    elevation: [-45, 30]\n"
    "    start: [10, 20]\n"
    "noise: {sigma: 0.02}\n"
    "seed: 5\n"
    "joint_decimals: 3\n"
    "output: out/data.csv\n";

/// Text that is replaced once in a file that is right without it.
struct Edit {
  std::string from;
  std::string to;
};

inline std::string Apply(std::string text, const Edit& edit) {
  if (edit.from.empty()) return text;
  const std::size_t at = text.find(edit.from);
  EXPECT_NE(at, std::string::npos) << edit.from;
  return text.replace(at, edit.from.size(), edit.to);
}

/// A job, a simulation and the files they name.
class ConfigFiles {
 public:
  explicit ConfigFiles(const Edit& edit = {}) {
    directory_.Write("arm.yaml", kArmText);
    directory_.Write("deviations.yaml", kDeviationsText);
    directory_.Write("data.csv", kDataText);
    directory_.Write("validation.csv", kDataText);
    job_ = directory_.Write("job.yaml", EditIfFound(kJobText, edit));
    simulation_ =
        directory_.Write("simulation.yaml", EditIfFound(kSimulationText, edit));
  }

  const TestDirectory& directory() const { return directory_; }
  const std::string& job() const { return job_; }
  const std::string& simulation() const { return simulation_; }

 private:
  static std::string EditIfFound(const std::string& text, const Edit& edit) {
    return text.find(edit.from) == std::string::npos ? text : Apply(text, edit);
  }

  TestDirectory directory_;
  std::string job_;
  std::string simulation_;
};

/// An edit that makes a file wrong, and the error that it must give.
struct ConfigErrorCase {
  const char* name;
  Edit edit;
  ExpectedError expected;
};

inline void PrintTo(const ConfigErrorCase& error_case, std::ostream* out) {
  *out << error_case.name;
}

inline std::string CaseName(
    const ::testing::TestParamInfo<ConfigErrorCase>& info) {
  return info.param.name;
}

}  // namespace alidade::internal

#endif  // ALIDADE_TESTS_SUPPORT_CONFIG_FILES_H_
