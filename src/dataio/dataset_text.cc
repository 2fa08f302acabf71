#include <glog/logging.h>

#include <cmath>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "alidade/units.h"
#include "src/common/constants.h"
#include "src/common/names.h"
#include "src/common/numbers.h"
#include "src/common/text.h"
#include "src/dataio/csv_columns.h"
#include "src/dataio/dataset_columns.h"
#include "src/dataio/dataset_csv.h"
#include "src/dataio/observation_order.h"
#include "src/model/motors.h"

namespace alidade::internal {
namespace {

// A number of degrees that reads back to exactly `angle` (rad), the one with
// the fewest decimals first; nothing where no double is near enough to do so.
std::optional<double> ExactDegrees(double angle) {
  const double degrees = angle / kDegree;
  double power = 1.0;
  for (int decimals = 0; decimals <= 15; ++decimals, power *= 10.0) {
    const double candidate = std::round(degrees * power) / power;
    if (candidate * kDegree == angle) return candidate;
  }
  for (const double candidate : {degrees, std::nextafter(degrees, -kInfinity),
                                 std::nextafter(degrees, kInfinity)}) {
    if (candidate * kDegree == angle) return candidate;
  }
  return std::nullopt;
}

class DatasetText {
 public:
  DatasetText(const Dataset& data, const Arm& arm, int joint_decimals,
              bool with_sigmas)
      : data_(data),
        arm_(arm),
        motors_(MotorsFromJoints(arm, data.joint_values)),
        dimensions_(MotorDimensions(arm)),
        joint_decimals_(joint_decimals),
        has_orientations_(data.Has(MeasurementKind::kPose)),
        sigmas_(SigmaColumns(data, with_sigmas)),
        has_targets_(arm.num_targets() > 1),
        in_radians_(FindInexactJoints()) {}

  std::string Header() const {
    const DatasetColumns columns = MakeDatasetColumns(arm_, DataFormat());
    std::vector<std::pair<int, int>> groups = {{0, NumMotors(arm_)},
                                               {columns.position, 3}};
    if (has_orientations_) groups.emplace_back(columns.vector, 3);
    if (sigmas_.positions) groups.emplace_back(columns.position_sigma, 3);
    if (sigmas_.orientations) groups.emplace_back(columns.turn_sigma, 3);
    if (has_targets_) groups.emplace_back(columns.target, 1);
    std::string header;
    for (const auto& [first, count] : groups) {
      for (int i = first; i < first + count; ++i) {
        if (!header.empty()) header += ",";
        const ColumnSpec& spec = columns.specs[i];
        header += i < NumMotors(arm_) && in_radians_[i] ? spec.base + "_rad"
                                                        : FirstName(spec);
      }
    }
    return header + "\n";
  }

  void AppendRow(const ObservationBlock& block, Eigen::Index i,
                 std::string* text) {
    for (int j = 0; j < NumMotors(arm_); ++j) {
      if (j > 0) *text += ',';
      AppendJoint(j, motors_(j, block.pose(i)), text);
    }
    AppendLengths(block, block.measured, i, text);
    if (has_orientations_) AppendAngles(block, block.measured, i, text);
    *text += SigmaText(block, i);
    if (has_targets_) (*text += ',') += arm_.targets[block.target(i)].name;
    *text += '\n';
  }

 private:
  bool IsRevolute(int j) const { return dimensions_[j] == Dimension::kAngle; }

  // Turning joints whose values degrees cannot state exactly, where all their
  // digits are asked for.
  std::vector<bool> FindInexactJoints() const {
    std::vector<bool> in_radians(arm_.joints.size(), false);
    for (int j = 0; j < NumMotors(arm_); ++j) {
      if (joint_decimals_ != kFewestDigits || !IsRevolute(j)) continue;
      for (Eigen::Index i = 0; i < motors_.cols() && !in_radians[j]; ++i) {
        in_radians[j] = !ExactDegrees(motors_(j, i));
      }
    }
    return in_radians;
  }

  void AppendJoint(int j, double value, std::string* text) const {
    if (joint_decimals_ != kFewestDigits) {
      const double unit = IsRevolute(j) ? kDegree : kMillimetre;
      AppendFixed(value / unit, joint_decimals_, text);
    } else if (!IsRevolute(j)) {
      AppendShifted(value, 3, text);
    } else {
      AppendShifted(in_radians_[j] ? value : *ExactDegrees(value), 0, text);
    }
  }

  // Nearly all rows have the same.
  const std::string& SigmaText(const ObservationBlock& block, Eigen::Index i) {
    const bool is_last = sigma_block_ == &block &&
                         block.sigmas.col(i) == block.sigmas.col(sigma_index_);
    if (is_last) return sigma_text_;
    sigma_text_.clear();
    if (sigmas_.positions) AppendLengths(block, block.sigmas, i, &sigma_text_);
    if (sigmas_.orientations) {
      AppendAngles(block, block.sigmas, i, &sigma_text_);
    }
    sigma_block_ = &block;
    sigma_index_ = i;
    return sigma_text_;
  }

  static StatedSigmas SigmaColumns(const Dataset& data, bool with_sigmas) {
    if (!with_sigmas) return {false, false};
    StatedSigmas sigmas = FindStatedSigmas(data);
    sigmas.orientations =
        sigmas.orientations && data.Has(MeasurementKind::kPose);
    return sigmas;
  }

  // Cells are empty where nothing was measured.
  static void AppendLengths(const ObservationBlock& block,
                            const SharedMatrix& numbers, Eigen::Index i,
                            std::string* text) {
    for (int row = 0; row < 3; ++row) {
      *text += ',';
      if (std::isinf(block.sigmas(row, i))) continue;
      AppendShifted(numbers(row, i), 3, text);
    }
  }

  static void AppendAngles(const ObservationBlock& block,
                           const SharedMatrix& numbers, Eigen::Index i,
                           std::string* text) {
    for (int row = 3; row < 6; ++row) {
      *text += ',';
      if (row >= numbers.rows() || std::isinf(block.sigmas(row, i))) continue;
      AppendShortest(numbers(row, i) / kDegree, text);
    }
  }

  const Dataset& data_;
  const Arm& arm_;
  const SharedMatrix motors_;
  const std::vector<Dimension> dimensions_;
  const int joint_decimals_;
  const bool has_orientations_;
  const StatedSigmas sigmas_;
  const bool has_targets_;
  const std::vector<bool> in_radians_;  // by joint
  // What SigmaText made last, and of which observation.
  std::string sigma_text_;
  const ObservationBlock* sigma_block_ = nullptr;
  Eigen::Index sigma_index_ = 0;
};

}  // namespace

void WriteDatasetText(const Dataset& dataset, const Arm& arm,
                      int joint_decimals, bool with_sigmas,
                      const std::vector<std::string>& comments,
                      const TextSink& sink) {
  constexpr std::size_t kPieceBytes = 1 << 16;
  std::string text;
  for (const std::string& comment : comments) {
    text += "# " + OneLine(comment) + "\n";
  }
  DatasetText rows(dataset, arm, joint_decimals, with_sigmas);
  text += rows.Header();
  for (const ObservationBlock& block : dataset.blocks) {
    CHECK(HoldsPosition(block.kind));
  }
  for (const ObservationRef& one : InOrderOfPoses(dataset)) {
    rows.AppendRow(*one.block, one.index, &text);
    if (text.size() < kPieceBytes) continue;
    sink(text);
    text.clear();
  }
  sink(text);
}

std::string FormatDataset(const Dataset& dataset, const Arm& arm,
                          int joint_decimals, bool with_sigmas,
                          const std::vector<std::string>& comments) {
  std::string text;
  WriteDatasetText(dataset, arm, joint_decimals, with_sigmas, comments,
                   [&](std::string_view piece) { text += piece; });
  return text;
}

}  // namespace alidade::internal
