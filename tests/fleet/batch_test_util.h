#ifndef ALIDADE_TESTS_FLEET_BATCH_TEST_UTIL_H_
#define ALIDADE_TESTS_FLEET_BATCH_TEST_UTIL_H_

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "src/fleet/batch.h"
#include "tests/support/process.h"

namespace alidade::internal {

inline const std::string kSource = ALIDADE_SOURCE_DIR;

// Simulated, so that a job needs no file of its own.
inline const std::string kJob =
    "format: alidade-job-1\n"
    "title: Simulated\n"
    "units: {length: mm, angle: rad}\n"
    "arm: arm.yaml\n"
    "data:\n"
    "  simulate:\n"
    "    deviations: " +
    kSource +
    "/configs/robots/rv2aj_deviations.yaml\n"
    "    poses: {random: {count: 12}}\n"
    "    noise: {sigma: 0.02}\n"
    "    seed: 1\n"
    "measurement: {sigma: 0.02}\n"
    "identifiability: {method: rules}\n"
    "outputs: minimal\n";

class BatchTest : public ::testing::Test {
 protected:
  BatchTest() {
    testing::WriteWhole(
        Path("arm.yaml"),
        testing::ReadWhole(kSource + "/configs/robots/rv2aj_wrist.yaml"));
    testing::WriteWhole(Path("fleet.yaml"),
                        kJob + "matrix: {data.simulate.seed: {range: 3}}\n");
    options_.directory = Path("out");
    options_.on_finished = [this](const BatchProgress& progress) {
      if (!progress.last_was_found) ran_.push_back(progress.last->name);
    };
  }

  std::string Path(const std::string& name) const { return directory_ / name; }

  BatchSummary Run(const std::vector<std::string>& files) {
    ran_.clear();
    std::vector<std::string> paths;
    for (const std::string& file : files) paths.push_back(Path(file));
    BatchSummary summary = RunBatch(PlanBatch(paths), options_);
    std::sort(ran_.begin(), ran_.end());
    return summary;
  }

  testing::TemporaryDirectory directory_;
  BatchOptions options_;
  std::vector<std::string> ran_;  ///< jobs that were not found done, sorted
};

}  // namespace alidade::internal

#endif  // ALIDADE_TESTS_FLEET_BATCH_TEST_UTIL_H_
