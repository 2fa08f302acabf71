#include <glog/logging.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "src/common/constants.h"
#include "src/dataio/dataset_columns.h"
#include "src/dataio/dataset_npy.h"
#include "src/dataio/npy_header.h"
#include "src/dataio/observation_order.h"
#include "src/model/motors.h"

namespace alidade::internal {
namespace {

void AppendDouble(double value, std::string* bytes) {
  std::uint64_t bits = 0;
  std::memcpy(&bits, &value, sizeof(bits));
  std::array<char, 8> little_endian;
  for (char& byte : little_endian) {
    byte = static_cast<char>(bits & 0xff);
    bits >>= 8;
  }
  bytes->append(little_endian.data(), little_endian.size());
}

// Names in SI, in the order of a row.
std::vector<std::string> ColumnsInSi(const Arm& arm, bool has_orientations,
                                     const StatedSigmas& sigmas) {
  const DatasetColumns columns = MakeDatasetColumns(arm, DataFormat());
  std::vector<std::string> names;
  const auto add = [&](int first, int count) {
    for (int i = first; i < first + count; ++i) {
      const ColumnSpec& spec = columns.specs[i];
      const bool is_angle = spec.type == ColumnType::kAngle;
      names.push_back(spec.base + (is_angle ? "_rad" : "_m"));
    }
  };
  add(0, NumMotors(arm));
  add(columns.position, 3);
  if (has_orientations) add(columns.vector, 3);
  if (sigmas.positions) add(columns.position_sigma, 3);
  if (sigmas.orientations) add(columns.turn_sigma, 3);
  return names;
}

// Three rows of a matrix of the block; NaN where it was not measured.
void AppendRows(const ObservationRef& one, const SharedMatrix& numbers,
                int first, std::string* bytes) {
  for (int row = first; row < first + 3; ++row) {
    const bool is_measured =
        row < numbers.rows() && !std::isinf(one.block->sigmas(row, one.index));
    AppendDouble(is_measured ? numbers(row, one.index) : kNan, bytes);
  }
}

}  // namespace

bool IsNpy(const std::string& path) {
  constexpr std::string_view kEnding = ".npy";
  if (path.size() < kEnding.size()) return false;
  return std::equal(kEnding.begin(), kEnding.end(),
                    path.end() - static_cast<std::ptrdiff_t>(kEnding.size()),
                    [](char a, char b) {
                      return a == std::tolower(static_cast<unsigned char>(b));
                    });
}

std::string FormatNpy(const Dataset& dataset, const Arm& arm,
                      bool with_sigmas) {
  for (const ObservationBlock& block : dataset.blocks) {
    CHECK(HoldsPosition(block.kind));
    CHECK(block.targets.empty());
    CHECK(block.whiteners.empty());
  }
  const bool has_orientations = dataset.Has(MeasurementKind::kPose);
  StatedSigmas sigmas{false, false};
  if (with_sigmas) sigmas = FindStatedSigmas(dataset);
  sigmas.orientations = sigmas.orientations && has_orientations;
  const std::vector<std::string> names =
      ColumnsInSi(arm, has_orientations, sigmas);
  const std::vector<ObservationRef> rows = InOrderOfPoses(dataset);
  const SharedMatrix motors = MotorsFromJoints(arm, dataset.joint_values);
  std::string bytes =
      FormatNpyHeader(names, static_cast<std::int64_t>(rows.size()));
  bytes.reserve(bytes.size() + 8 * names.size() * rows.size());
  for (const ObservationRef& one : rows) {
    for (int j = 0; j < motors.rows(); ++j) {
      AppendDouble(motors(j, one.pose()), &bytes);
    }
    const ObservationBlock& block = *one.block;
    AppendRows(one, block.measured, 0, &bytes);
    if (has_orientations) AppendRows(one, block.measured, 3, &bytes);
    if (sigmas.positions) AppendRows(one, block.sigmas, 0, &bytes);
    if (sigmas.orientations) AppendRows(one, block.sigmas, 3, &bytes);
  }
  return bytes;
}

}  // namespace alidade::internal
