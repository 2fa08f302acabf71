#include "src/calibration/improvement.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace alidade::internal {
namespace {

bool FindsFramesAlone(const CalibrationResult& result) {
  constexpr std::array<std::string_view, 5> kJoints = {"beta", "alpha", "d",
                                                       "theta", "r"};
  const auto is_of_joint = [&](const ParameterResult& parameter) {
    return parameter.decision.state == ParameterState::kFree &&
           std::find(kJoints.begin(), kJoints.end(), parameter.kind) !=
               kJoints.end();
  };
  return !result.before_note.empty() &&
         std::none_of(result.parameters.begin(), result.parameters.end(),
                      is_of_joint);
}

}  // namespace

namespace {

// What the uncertainty of the parameters lets errors grow by where the arm was
// right before: of a single weak direction, in 1 % of calibrations.
bool IsWithinUncertainty(const KeptErrors& judged,
                         const CalibrationResult& result) {
  constexpr double kChiSquare = 6.6;
  if (!result.uncertainty) return false;
  const UncertaintyResult& found = *result.uncertainty;
  double predicted = 0.0;
  if (found.validation) {
    predicted = found.validation->parts.from_parameters;
  } else if (found.workspace) {
    predicted = found.workspace->parts.from_parameters;
  }
  const double before = judged.before.rms;
  const double after = judged.after.rms;
  return after * after - before * before <= kChiSquare * predicted * predicted;
}

}  // namespace

const EvaluatedSet& JudgedSet(const CalibrationResult& result) {
  return result.validation && result.validation->after.n > 0
             ? *result.validation
             : result.train;
}

const char* LengthErrorName(const EvaluatedSet& set) {
  constexpr std::array<std::string_view, 3> kLengths = {
      "distance", "point distance", "plane"};
  const auto is_length = [&](const ObservationLabel& label) {
    return std::find(kLengths.begin(), kLengths.end(), label.kind) !=
           kLengths.end();
  };
  return !set.labels.empty() &&
                 std::all_of(set.labels.begin(), set.labels.end(), is_length)
             ? "length error"
             : "position error";
}

const char* LengthErrorName(const CalibrationResult& result) {
  return LengthErrorName(JudgedSet(result));
}

std::string ObservationName(const EvaluatedSet& set, const char* poses) {
  const bool is_one_each =
      set.labels.empty() ||
      static_cast<Eigen::Index>(set.labels.size()) == set.joint_values.cols();
  return std::string(poses) + (is_one_each ? " pose" : " observation");
}

std::string ObservationName(const CalibrationResult& result) {
  const EvaluatedSet& set = JudgedSet(result);
  return ObservationName(set,
                         &set == &result.train ? "training" : "validation");
}

bool IsWorse(const KeptErrors& judged, const CalibrationResult& result) {
  return judged.after.mean > judged.before.mean &&
         !(judged.change_t <= kBeyondChance) &&
         !IsWithinUncertainty(judged, result);
}

Improvement::Improvement(const CalibrationResult& result) {
  const KeptErrors errors = JudgedSet(result).Judged();
  num_rejected = errors.num_rejected;
  if (errors.after.n == 0 && errors.rotation_after.n > 0) {
    dimension = Dimension::kAngle;
  }
  const bool is_length = dimension == Dimension::kLength;
  before = is_length ? errors.before : errors.rotation_before;
  after = is_length ? errors.after : errors.rotation_after;
  is_worse = is_length ? IsWorse(errors, result) : ratio() > 1.0;
  is_of_frames = FindsFramesAlone(result);
}

}  // namespace alidade::internal
