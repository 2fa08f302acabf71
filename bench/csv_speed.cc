// How fast data sets are read and written (Google Benchmark): bytes of the
// file, which is in the system's cache, by elapsed time, and by the processor
// time of all threads. Six turning joints in degrees, positions in mm, as
// Alidade and as Python's repr write them.

#include <benchmark/benchmark.h>
#include <unistd.h>

#include <cmath>
#include <ctime>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

#include "alidade/calibration_result.h"
#include "alidade/units.h"
#include "src/common/files.h"
#include "src/common/numbers.h"
#include "src/common/random.h"
#include "src/common/text.h"
#include "src/dataio/dataset_csv.h"
#include "src/dataio/dataset_npy.h"
#include "src/report/report.h"

namespace alidade::internal {
namespace {

constexpr int kPoses = 400000;

enum class Text { kCsv, kLongCsv, kNpy };

Arm SixJoints() {
  Arm arm;
  arm.name = "six joints";
  arm.joints.resize(6);
  return arm;
}

Dataset RandomData(const Arm& arm) {
  Random random(1);
  Eigen::MatrixXd joints(arm.num_joints(), kPoses);
  Eigen::Matrix3Xd points(3, kPoses);
  for (int i = 0; i < kPoses; ++i) {
    for (double& joint : joints.col(i)) joint = random.Uniform(-kPi, kPi);
    for (double& x : points.col(i)) {
      x = std::round(random.Uniform(-1e6, 1e6)) * kMicrometre;
    }
  }
  return MakePositions(joints, points,
                       Eigen::Matrix3Xd::Constant(3, kPoses, 2e-5));
}

int DecimalsOf(Text text) { return text == Text::kCsv ? 4 : kFewestDigits; }

std::string Content(const Dataset& data, const Arm& arm, Text text) {
  if (text == Text::kNpy) return FormatNpy(data, arm, true);
  return FormatDataset(data, arm, DecimalsOf(text), true, {});
}

// A file that is gone with the object.
class TemporaryFile {
 public:
  TemporaryFile(const std::string& ending, const std::string& content)
      : path_((std::filesystem::temp_directory_path() /
               ("alidade_csv_speed." + std::to_string(getpid()) + ending))
                  .string()) {
    WriteFileAtomically(path_, content);
  }
  ~TemporaryFile() { std::filesystem::remove(path_); }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  const std::string& path() const { return path_; }

 private:
  const std::string path_;
};

void Read(benchmark::State& state, Text text) {
  const Arm arm = SixJoints();
  const std::string content = Content(RandomData(arm), arm, text);
  const TemporaryFile file(text == Text::kNpy ? ".npy" : ".csv", content);
  DataFormat format;
  ReadOptions options;
  options.num_threads = static_cast<int>(state.range(0));
  const std::clock_t start = std::clock();
  for (auto unused : state) {
    References references;
    const LoadedData loaded =
        LoadDataWith({file.path(), arm, format}, &references, options);
    benchmark::DoNotOptimize(loaded.data.joint_values.data());
  }
  const auto bytes = static_cast<double>(state.iterations()) *
                     static_cast<double>(content.size());
  // Of all threads.
  const double cpu_s =
      static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  state.SetBytesProcessed(static_cast<std::int64_t>(bytes));
  state.counters["MB_per_core_second"] = bytes / 1e6 / cpu_s;
  state.SetItemsProcessed(state.iterations() * kPoses);
}

BENCHMARK_CAPTURE(Read, csv, Text::kCsv)->Arg(1)->Arg(2)->UseRealTime();
BENCHMARK_CAPTURE(Read, csv_all_digits, Text::kLongCsv)
    ->Arg(1)
    ->Arg(2)
    ->UseRealTime();
BENCHMARK_CAPTURE(Read, npy, Text::kNpy)->Arg(1)->Arg(2)->UseRealTime();

void Write(benchmark::State& state, Text text) {
  const Arm arm = SixJoints();
  const Dataset data = RandomData(arm);
  std::size_t bytes = 0;
  for (auto unused : state) {
    if (text == Text::kNpy) {
      bytes += FormatNpy(data, arm, true).size();
    } else {
      WriteDatasetText(data, arm, DecimalsOf(text), true, {},
                       [&](std::string_view piece) { bytes += piece.size(); });
    }
  }
  state.SetBytesProcessed(static_cast<std::int64_t>(bytes));
}

BENCHMARK_CAPTURE(Write, csv, Text::kCsv)->UseRealTime();
BENCHMARK_CAPTURE(Write, csv_all_digits, Text::kLongCsv)->UseRealTime();
BENCHMARK_CAPTURE(Write, npy, Text::kNpy)->UseRealTime();

// residuals.csv of a calibration: 17 digits each, but for numbers of poses.
void WriteResiduals(benchmark::State& state) {
  Random random(1);
  const auto draw = [&](Eigen::Index rows, double size) {
    Eigen::MatrixXd matrix(rows, kPoses);
    for (double& x : matrix.reshaped()) x = random.Uniform(-size, size);
    return SharedMatrix(std::move(matrix));
  };
  CalibrationResult result;
  EvaluatedSet& set = result.train;
  set.joint_dimensions.assign(6, Dimension::kAngle);
  set.joint_values = draw(6, kPi);
  set.positions = draw(3, 1.0);
  set.residual_before = draw(3, 5e-3);
  set.residual_after = draw(3, 5e-5);
  std::size_t bytes = 0;
  for (auto unused : state) {
    for (const ReportFile& file : MakeCsvFiles(result)) {
      file.content([&](std::string_view piece) { bytes += piece.size(); });
    }
  }
  state.SetBytesProcessed(static_cast<std::int64_t>(bytes));
}

BENCHMARK(WriteResiduals);

}  // namespace
}  // namespace alidade::internal

BENCHMARK_MAIN();
