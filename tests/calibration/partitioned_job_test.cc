// Jobs whose data are in many files, done by ranks of which each reads some of
// them: what comes out must be what one process finds, to the bit.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "alidade/arm_file.h"
#include "alidade/communicator.h"
#include "alidade/error.h"
#include "alidade/units.h"
#include "src/common/random.h"
#include "src/job/result_directory.h"
#include "src/job/run_job.h"
#include "src/kernel/measurement_model.h"
#include "src/model/joint_draw.h"
#include "src/serialization/job_config.h"
#include "tests/support/process.h"

namespace alidade::internal::partitioned_job_test {
namespace {

using Files = std::vector<std::pair<std::string, std::string>>;

std::string Robots() {
  return std::string(ALIDADE_SOURCE_DIR) + "/configs/robots/";
}

// An arm off by tolerances, a metre away from where its file has it, and what
// is measured of it, as the text of CSV files.
class Bench {
 public:
  Bench() : real_(LoadArm(Robots() + "rv2aj_flange.yaml")) {
    Random random(3);
    for (Joint& joint : real_.joints) {
      joint.alpha += random.Uniform(-2e-3, 2e-3);
      joint.theta += random.Uniform(-2e-3, 2e-3);
      joint.d += random.Uniform(-5e-4, 5e-4);
    }
    real_.instrument_from_base.translation() << 1.0, -0.4, 0.2;
    real_.last_from_target().translation() << 0.03, -0.02, 0.05;
  }

  std::string Positions(int count) {
    std::string text = Header() + ",x_mm,y_mm,z_mm\n";
    ForEach(
        count,
        [&](const Eigen::Vector3d& point) {
          for (int axis = 0; axis < 3; ++axis) {
            text += "," + Number((point[axis] + Noise()) / kMillimetre);
          }
        },
        &text);
    return text;
  }

  // Every pose twice, and of some one axis alone.
  std::string RepeatsInSets(int count) {
    std::string text = Header() + ",x_mm,y_mm,z_mm,set\n";
    const std::uint64_t seed = seed_;
    for (int repeat = 0; repeat < 2; ++repeat) {
      seed_ = seed;
      int row = 0;
      ForEach(
          count,
          [&](const Eigen::Vector3d& point) {
            text += "," + Number((point[0] + Noise()) / kMillimetre) + ",";
            if (row % 5 != 0)
              text += Number((point[1] + Noise()) / kMillimetre);
            text += ",";
            if (row % 5 != 0)
              text += Number((point[2] + Noise()) / kMillimetre);
            text += row++ % 4 == 0 ? ",check" : ",fit";
          },
          &text);
    }
    return text;
  }

  // From anchors that the job does not know.
  std::string Distances(int count, const std::vector<std::string>& anchors) {
    std::string text = Header() + ",distance_mm,point\n";
    std::size_t row = 0;
    ForEach(
        count,
        [&](const Eigen::Vector3d& point) {
          const std::string& anchor = anchors[row++ % anchors.size()];
          const Eigen::Vector3d place(anchor == "left" ? -0.5 : 1.5, 0.8, 0.9);
          text += "," +
                  Number(((point - place).norm() + Noise()) / kMillimetre) +
                  "," + anchor;
        },
        &text);
    return text;
  }

 private:
  static std::string Header() { return "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg"; }
  static std::string Number(double value) {
    std::array<char, 40> text{};
    std::snprintf(text.data(), text.size(), "%.6f", value);
    return text.data();
  }
  double Noise() { return 3e-5 * noise_.Normal(); }

  void ForEach(int count,
               const std::function<void(const Eigen::Vector3d&)>& measure,
               std::string* text) {
    Eigen::MatrixXd joints = DrawJointValues(real_, count, seed_++);
    // As the file has them.
    joints = (joints / kDegree * 1e4).array().round() / 1e4;
    const MeasurementModel model(real_);
    const Eigen::Matrix3Xd points =
        model.Predict(model.NominalValues(), joints * kDegree);
    for (int i = 0; i < count; ++i) {
      for (int j = 0; j < 5; ++j) {
        *text += (j == 0 ? "" : ",") + Number(joints(j, i));
      }
      measure(points.col(i));
      *text += "\n";
    }
  }

  Arm real_;
  Random noise_{17};
  std::uint64_t seed_ = 40;
};

// All files of a result, but for times and the number of threads.
Files ResultOf(CalibrationResult outcome) {
  EXPECT_NE(outcome.status, CalibrationStatus::kRefused) << outcome.message;
  EXPECT_NE(outcome.status, CalibrationStatus::kFailed) << outcome.message;
  CalibrationResult& result = outcome;
  result.identify_time_s = 0.0;
  result.total_time_s = 0.0;
  for (SolverRun& run : result.runs) {
    run.summary.setup_time_s = 0.0;
    run.summary.solve_time_s = 0.0;
    run.summary.threads_given = 0;
    run.summary.threads_used = 0;
    for (IterationRecord& record : run.summary.iterations) record.time_s = 0.0;
  }
  Files files = {{"message", outcome.message}};
  for (const ReportFile& file : RenderResult(outcome)) {
    files.emplace_back(file.name, file.Text());
  }
  return files;
}

class PartitionedJobTest : public ::testing::Test {
 protected:
  void Write(const std::string& name, const std::string& text) {
    testing::WriteWhole(scratch_ / name, text);
  }

  std::string WriteJob(const std::string& rest) {
    Write("job.yaml",
          "format: alidade-job-1\ntitle: shards\n"
          "units: {length: mm, angle: deg}\narm: " +
              Robots() + "rv2aj_flange.yaml\n" + rest);
    return scratch_ / "job.yaml";
  }

  // What the root of so many ranks finds; size 0: one process.
  static Files Find(const std::string& job, int size, int threads = 1) {
    if (size == 0) {
      return ResultOf(RunJob(LoadJob(job, threads), "test"));
    }
    Files found;
    RunOnThreads(size, [&](Communicator* communicator) {
      CalibrationResult outcome =
          RunJob(LoadJob(job, {threads, communicator}), "test");
      if (communicator->is_root()) found = ResultOf(std::move(outcome));
    });
    return found;
  }

  static void ExpectSame(const std::string& job, int size) {
    const Files expected = Find(job, 0);
    const Files found = Find(job, size);
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t k = 0; k < found.size(); ++k) {
      EXPECT_EQ(found[k].first, expected[k].first);
      // What differs would be too much to print.
      EXPECT_TRUE(found[k].second == expected[k].second)
          << found[k].first << " of " << size;
    }
  }

  const testing::TemporaryDirectory scratch_;
};

// Uneven shards, sigma from the residuals, base and tool from nothing.
TEST_F(PartitionedJobTest, OfPositionsFindsTheSameBitsWhateverItsSize) {
  Bench bench;
  Write("a1.csv", bench.Positions(700));
  Write("a2.csv", bench.Positions(40));
  Write("a3.csv", bench.Positions(1300));
  const std::string job = WriteJob(
      "data: [a1.csv, a2.csv, a3.csv]\nmeasurement: {sigma: estimate}\n"
      "validation: {fraction: 0.2, seed: 5}\n"
      "identifiability: {parameters: [joints, base, tool]}\n"
      "acceptance: {validation_max: 0.01}\n");
  // More ranks than files: one has nothing.
  for (const int size : {1, 2, 3, 4}) ExpectSame(job, size);
  // What differs would be too much to print.
  EXPECT_TRUE(Find(job, 2, 2) == Find(job, 0, 1));
}

// Kinds, references and sets that only some of the files have; few enough poses
// for every subset to be all of them in one of the jobs, too many in the other.
TEST_F(PartitionedJobTest, OfManyKindsFindsTheSameBits) {
  Bench bench;
  Write("b1.csv", bench.Distances(150, {"right"}));
  Write("b2.csv", bench.RepeatsInSets(60));
  Write("b3.csv", bench.Distances(90, {"left", "right"}));
  Write("b4.csv", bench.Positions(30));
  const std::string job = WriteJob(
      "data: ['b*.csv']\nmeasurement: {sigma: 0.03}\n"
      "validation: {set: check}\nrobust: {loss: tukey}\n"
      "references: {points: [{name: right, position: [1500, 800, 900]}],\n"
      "  distances: [{between: [left, right], distance: 2000, sigma: 0.05}]}\n"
      "identifiability: {parameters: [joints, base, tool]}\n");
  for (const int size : {2, 3}) ExpectSame(job, size);
}

TEST_F(PartitionedJobTest, SimulatedDataAreMadeByOneMember) {
  const std::string simulate = "- simulate: {deviations: " + Robots() +
                               "rv2aj_deviations.yaml, poses: {random: "
                               "{count: 50}}, noise: {sigma: 0.03}, seed: ";
  const std::string job = WriteJob("data:\n" + simulate + "4}\n" + simulate +
                                   "5}\n" + "measurement: {sigma: 0.03}\n");
  ExpectSame(job, 2);
}

TEST_F(PartitionedJobTest, DataThatFitNowhereAreRefusedInTheSameWords) {
  Bench bench;
  std::string wrong = bench.Positions(200);
  // Radians that a header calls degrees would be refused the same; metres are
  // simpler.
  wrong.replace(wrong.find("x_mm,y_mm,z_mm"), 14, "x_m,y_m,z_m");
  Write("c1.csv", wrong);
  std::string more = bench.Positions(300);
  more.replace(more.find("x_mm,y_mm,z_mm"), 14, "x_m,y_m,z_m");
  Write("c2.csv", more);
  const std::string job =
      WriteJob("data: [c1.csv, c2.csv]\nmeasurement: {sigma: 0.03}\n");
  std::vector<std::string> errors;
  for (const int size : {0, 2}) {
    try {
      Find(job, size);
    } catch (const InputError& error) {
      errors.emplace_back(error.what());
    }
  }
  ASSERT_EQ(errors.size(), 2U);
  EXPECT_EQ(errors[0], errors[1]);
  EXPECT_NE(errors[0].find("state the unit mm"), std::string::npos);
}

TEST_F(PartitionedJobTest, AShardThatCannotBeReadEndsAllWithItsError) {
  Bench bench;
  Write("d1.csv", bench.Positions(50));
  std::string broken = bench.Positions(50);
  broken += "1,2,3,4,5,6,seven,8\n";
  Write("d2.csv", broken);
  const std::string job =
      WriteJob("data: [d1.csv, d2.csv]\nmeasurement: {sigma: 0.03}\n");
  try {
    Find(job, 2);
    FAIL() << "expected an error";
  } catch (const InputError& error) {
    EXPECT_EQ(error.location().line, 52);
    EXPECT_NE(std::string(error.what()).find("seven"), std::string::npos);
  }
}

TEST_F(PartitionedJobTest, WhatNeedsAllDataIsRefusedBeforeAnyWork) {
  // The data are not even there.
  for (const char* key :
       {"compare_with: [pseudo_inverse]", "solver: {name: pseudo_inverse}",
        "solver: {evaluation: autodiff}", "validation: {folds: 3}"}) {
    const std::string job = WriteJob(
        std::string("data: [e1.csv, e2.csv]\nmeasurement: {sigma: 1}\n") + key +
        "\n");
    try {
      Find(job, 2);
      ADD_FAILURE() << key;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("run without mpirun"),
                std::string::npos)
          << error.what();
    }
  }
}

}  // namespace
}  // namespace alidade::internal::partitioned_job_test
