#include "src/calibration/plausibility.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "alidade/forward_kinematics.h"
#include "src/calibration/mistake_search.h"
#include "src/calibration/position_sample.h"
#include "src/calibration/sigma_estimation.h"
#include "src/common/format.h"
#include "src/common/number_text.h"
#include "src/common/text.h"
#include "src/kernel/partition.h"

namespace alidade::internal {
namespace {

// How many rows are lost, and what is known of them here.
struct LostRows {
  std::int64_t count = 0;
  std::string first;       // where it was read
  Eigen::Vector3d point;   // of the first
  std::vector<int> lines;  // of the same file, in ascending order

  // "leave them out by `exclude: [12, 40]` in `data`"
  std::string Cure() const {
    constexpr std::size_t kMostNamed = 12;
    std::string text = "leave the rows out";
    if (lines.empty()) return text;
    std::vector<std::string> numbers;
    for (const int line : lines) {
      if (numbers.size() == kMostNamed) break;
      numbers.push_back(std::to_string(line));
    }
    if (lines.size() > kMostNamed) numbers.emplace_back("...");
    return text + " by `exclude: [" + Join(numbers, ", ") + "]` in `data`";
  }
};

// Those of which is_lost().
template <typename IsLost>
LostRows FindLost(const Dataset& data, Communicator* communicator,
                  const IsLost& is_lost) {
  LostRows lost;
  for (const ObservationBlock& block : data.blocks) {
    if (!HoldsPosition(block.kind)) continue;
    for (Eigen::Index i = 0; i < block.size(); ++i) {
      const auto sigmas = block.sigmas.col(i).head<3>();
      if (!sigmas.allFinite() || !is_lost(block.measured.col(i).head<3>())) {
        continue;
      }
      if (++lost.count == 1) {
        lost.first = SourceOf(data, block.pose(i));
        lost.point = block.measured.col(i).head<3>();
      }
      if (data.files.size() == 1 && !data.sources.empty()) {
        lost.lines.push_back(data.sources[block.pose(i)].line);
      }
    }
  }
  std::sort(lost.lines.begin(), lost.lines.end());
  lost.count = SumOverRanks(communicator, data, lost.count);
  return lost;
}

bool IsOneNumber(const Eigen::Vector3d& point) {
  return point[0] == point[1] && point[1] == point[2];
}

Eigen::Vector3d MedianPoint(const PositionSample& sample) {
  Eigen::Vector3d median;
  for (int axis = 0; axis < 3; ++axis) {
    Eigen::VectorXd values = sample.points.row(axis);
    double* const middle = values.data() + values.size() / 2;
    std::nth_element(values.data(), middle, values.data() + values.size());
    median[axis] = *middle;
  }
  return median;
}

// A few positions that no arm of this size can reach from the others.
std::optional<Finding> DiagnoseFar(const Arm& arm, const Dataset& data,
                                   const PositionSample& sample,
                                   Communicator* communicator) {
  constexpr double kFar = 8.0;       // of the reach
  constexpr double kFarOfOne = 2.5;  // where x, y and z are one number
  constexpr double kFewPart = 0.2;   // of the positions
  Arm at_origin = arm;
  at_origin.instrument_from_base.setIdentity();
  const double far = kFar * Reach(at_origin);
  const Eigen::Vector3d median = MedianPoint(sample);
  double nearest = std::numeric_limits<double>::infinity();
  const LostRows lost =
      FindLost(data, communicator, [&](const Eigen::Vector3d& point) {
        const double distance = (point - median).norm();
        const double limit =
            (IsOneNumber(point) && !point.isZero(0.0) ? kFarOfOne / kFar
                                                      : 1.0) *
            far;
        if (distance <= limit) return false;
        nearest = std::min(nearest, limit);
        return true;
      });
  if (lost.count == 0 ||
      static_cast<double>(lost.count) >
          kFewPart * static_cast<double>(data.global_poses())) {
    return std::nullopt;
  }
  return Finding{
      "plausibility.far_positions", static_cast<double>(lost.count), 0.0,
      (lost.first.empty() ? "" : lost.first + ": ") +
          Count(lost.count, "position") + (lost.count == 1 ? " is" : " are") +
          " more than " +
          FormatLength(std::isfinite(nearest) ? nearest : far, 2) +
          " from the others, which no arm of this size reaches: "
          "instruments write such numbers when they have lost the target. "
          "State the number that stands for that (`missing: [-9999]` in "
          "`data`), or " +
          lost.Cure(),
      FindingLevel::kFailed};
}

// Positions that stay where they are while the joints move.
std::optional<Finding> DiagnoseStill(const Arm& arm,
                                     const PositionSample& sample) {
  // Of what the nominal arm moves its target: m that were read as mm are 1e-3.
  constexpr double kStill = 2e-4;
  const double measured = ExtentOf(sample.points);
  const double expected = ExtentOf(TargetPositions(arm, sample.joint_values));
  if (measured >= kStill * expected) return std::nullopt;
  return Finding{"plausibility.still_positions", measured, kStill * expected,
                 "the measured positions lie within " +
                     FormatLength(measured, 2) +
                     " where these joint values move the target by " +
                     FormatLength(expected, 2) +
                     ": the instrument had stopped, or one row was copied. "
                     "Look at the position columns",
                 FindingLevel::kFailed};
}

// Of "file:line"; 0 of nothing.
int LineOf(const std::string& where) {
  return where.empty() ? 0 : std::stoi(where.substr(where.rfind(':') + 1));
}

// Where the second station begins, if this rank knows it.
void AddStations(const Dataset& data, InputDiagnosis* diagnosis) {
  const Eigen::Index number = diagnosis->first_of_second_station;
  std::string where = PlaceOfPosition(data, number);
  const int line = LineOf(where);
  const int before = number > 0 ? LineOf(PlaceOfPosition(data, number - 1)) : 0;
  if (where.empty()) where = "position " + std::to_string(number + 1);
  diagnosis->finding->sentence +=
      " (from about " + where +
      " on): the instrument was moved, or set up anew. Say which lines of the "
      "file belong to which place, and each has a base of its own: " +
      (line > 1 ? "`stations: {first: 1-" + std::to_string(line - 1) +
                      ", second: " + std::to_string(line) + "-}` in `data`"
                : std::string("`stations` in `data`, or a column of them"));
  if (before > 0 && before + 1 < line) {
    diagnosis->finding->sentence +=
        ". Rows between lines " + std::to_string(before) + " and " +
        std::to_string(line) +
        " are held out or left out, and may be of either";
  }
}

}  // namespace

InputDiagnosis DiagnoseInput(const Arm& arm, const Dataset& data,
                             const CandidateGroups& candidates,
                             Communicator* communicator,
                             const Dataset* held_out) {
  std::optional<PositionSample> sample = SamplePositions(data, communicator);
  if (!sample) return {};
  if (auto far = DiagnoseFar(arm, data, *sample, communicator)) {
    return {std::move(far), true};
  }
  if (auto still = DiagnoseStill(arm, *sample)) return {std::move(still), true};
  const std::optional<PositionSample> inverse =
      data.Has(MeasurementKind::kPose)
          ? SamplePositions(WithInversePoses(data), communicator)
          : std::nullopt;
  const std::optional<Dataset> rows =
      held_out != nullptr ? PositionsInRowOrder(data, *held_out) : std::nullopt;
  if (rows) {
    auto in_order = SamplePositions(*rows, SingleProcess());
    if (in_order) sample = std::move(in_order);
  }
  InputDiagnosis diagnosis = FindMistakes(
      arm, *sample, inverse, candidates, MedianLengthSigma(data, communicator));
  if (diagnosis.first_of_second_station > 0) {
    AddStations(rows ? *rows : data, &diagnosis);
  }
  return diagnosis;
}

std::optional<Finding> DiagnoseLost(const Dataset& data,
                                    Communicator* communicator) {
  const LostRows lost = FindLost(data, communicator, IsOneNumber);
  if (lost.count == 0) return std::nullopt;
  const bool is_one = lost.count == 1;
  const bool is_zero = lost.point.isZero(0.0);
  const std::string missing =
      is_zero ? ""
              : ", state what stands for that (`missing: [" +
                    ShortestNumber(NumberOrNan(
                        FormatSignificant(lost.point[0] / kMillimetre, 6))) +
                    "]` in `data`)";
  return Finding{
      is_zero ? "plausibility.zero_positions" : "plausibility.one_number",
      static_cast<double>(lost.count), 0.0,
      (lost.first.empty() ? "" : lost.first + ": ") +
          std::to_string(lost.count) +
          (is_zero ? (is_one ? " position is exactly 0, 0, 0"
                             : " positions are exactly 0, 0, 0")
                   : (is_one ? " position has" : " positions have") +
                         std::string(" the same number in x, y and z (") +
                         FormatLength(lost.point[0], 6) + ")") +
          ", which instruments write when they have lost the target: empty "
          "these cells" +
          missing + " or " + lost.Cure(),
      FindingLevel::kAttention};
}

std::optional<Finding> DiagnoseStale(const MeasurementModel& model,
                                     const Eigen::VectorXd& values,
                                     const Dataset& data) {
  constexpr double kMoved = 10.0;  // standard deviations
  if (data.partition) return std::nullopt;
  LostRows stale;
  for (const ObservationBlock& block : data.blocks) {
    if (!HoldsPosition(block.kind)) continue;
    for (Eigen::Index i = 1; i < block.size(); ++i) {
      if (block.measured.col(i) != block.measured.col(i - 1)) continue;
      const double sigma = block.sigmas.col(i).head<3>().maxCoeff();
      if (!std::isfinite(sigma) || block.target(i) != block.target(i - 1)) {
        continue;
      }
      Eigen::MatrixXd joints(data.num_joints(), 2);
      joints << data.joint_values.col(block.pose(i - 1)),
          data.joint_values.col(block.pose(i));
      const Eigen::Matrix3Xd points =
          model.Predict(values, joints, block.target(i));
      if ((points.col(1) - points.col(0)).norm() <= kMoved * sigma) continue;
      if (++stale.count == 1) stale.first = SourceOf(data, block.pose(i));
      if (data.files.size() == 1 && !data.sources.empty()) {
        stale.lines.push_back(data.sources[block.pose(i)].line);
      }
    }
  }
  if (stale.count == 0) return std::nullopt;
  return Finding{
      "plausibility.stale_readings", static_cast<double>(stale.count), 0.0,
      (stale.first.empty() ? "" : stale.first + ": ") +
          Count(stale.count, "measurement") +
          (stale.count == 1 ? " is" : " are") +
          " exactly the one before, although the arm had moved in between: the "
          "instrument had not measured anew. " +
          AsSentence(stale.Cure()),
      FindingLevel::kAttention};
}

}  // namespace alidade::internal
