#include <glog/logging.h>

#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include "alidade/base/units.h"
#include "alidade/io/dataset_csv.h"
#include "src/io/csv_columns.h"
#include "src/io/dataset_columns.h"
#include "src/io/names.h"
#include "src/io/numbers.h"

namespace alidade {
namespace {

// Rounding must not leave "-0.0000".
std::string FormatFixed(double value, int decimals) {
  std::array<char, 400> buffer;
  const std::to_chars_result result =
      std::to_chars(buffer.data(), buffer.data() + buffer.size(), value,
                    std::chars_format::fixed, decimals);
  std::string text(buffer.data(), result.ptr);
  const bool is_zero = text.find_first_not_of("-0.") == std::string::npos;
  return is_zero && text.front() == '-' ? text.substr(1) : text;
}

class DatasetText {
 public:
  DatasetText(const Dataset& data, const Arm& arm, int joint_decimals,
              bool with_sigmas)
      : data_(data),
        arm_(arm),
        motors_(MotorsFromJoints(arm, data.joint_values)),
        joint_decimals_(joint_decimals),
        with_sigmas_(with_sigmas),
        has_orientations_(data.Has(MeasurementKind::kPose)),
        has_targets_(arm.num_targets() > 1) {}

  std::string Header() const {
    const DatasetColumns columns = MakeDatasetColumns(arm_, DataFormat());
    std::vector<std::pair<int, int>> groups = {{0, arm_.num_joints()},
                                               {columns.position, 3}};
    if (has_orientations_) groups.emplace_back(columns.vector, 3);
    if (with_sigmas_) groups.emplace_back(columns.position_sigma, 3);
    if (with_sigmas_ && has_orientations_) {
      groups.emplace_back(columns.turn_sigma, 3);
    }
    if (has_targets_) groups.emplace_back(columns.target, 1);
    std::string header;
    for (const auto& [first, count] : groups) {
      for (int i = first; i < first + count; ++i) {
        if (!header.empty()) header += ",";
        header += FirstName(columns.specs[i]);
      }
    }
    return header + "\n";
  }

  std::string Row(const ObservationBlock& block, Eigen::Index i) const {
    std::string text;
    for (int j = 0; j < data_.num_joints(); ++j) {
      const bool is_revolute = arm_.joints[j].type == JointType::kRevolute;
      const double unit = is_revolute ? kDegree : kMillimetre;
      if (j > 0) text += ",";
      text += FormatFixed(motors_(j, block.pose(i)) / unit, joint_decimals_);
    }
    AppendNumbers(block, block.measured.col(i), i, &text);
    if (with_sigmas_) AppendNumbers(block, block.sigmas.col(i), i, &text);
    if (has_targets_) text += "," + arm_.targets[block.target(i)].name;
    return text + "\n";
  }

 private:
  // Lengths, then angles; empty where nothing was measured.
  void AppendNumbers(const ObservationBlock& block,
                     const Eigen::VectorXd& numbers, Eigen::Index i,
                     std::string* text) const {
    const int size = has_orientations_ ? 6 : 3;
    for (int row = 0; row < size; ++row) {
      *text += ",";
      if (row >= numbers.size() || std::isinf(block.sigmas(row, i))) continue;
      *text += row < 3 ? FormatShifted(numbers[row], 3)
                       : FormatShortest(numbers[row] / kDegree);
    }
  }

  const Dataset& data_;
  const Arm& arm_;
  const Eigen::MatrixXd motors_;
  const int joint_decimals_;
  const bool with_sigmas_;
  const bool has_orientations_;
  const bool has_targets_;
};

}  // namespace

std::string FormatDataset(const Dataset& dataset, const Arm& arm,
                          int joint_decimals, bool with_sigmas,
                          const std::vector<std::string>& comments) {
  std::string text;
  for (const std::string& comment : comments) {
    text += "# " + OneLine(comment) + "\n";
  }
  const DatasetText rows(dataset, arm, joint_decimals, with_sigmas);
  text += rows.Header();
  for (const ObservationBlock& block : dataset.blocks) {
    CHECK(HoldsPosition(block.kind));
    for (Eigen::Index i = 0; i < block.size(); ++i) text += rows.Row(block, i);
  }
  return text;
}

}  // namespace alidade
