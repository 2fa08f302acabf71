#include "src/job/arm_verification.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "alidade/calibration.h"
#include "alidade/correction.h"
#include "alidade/dataset_file.h"
#include "alidade/error.h"
#include "alidade/forward_kinematics.h"
#include "src/calibration/input_mistakes.h"
#include "src/common/constants.h"
#include "src/common/format.h"
#include "src/dataio/dataset_csv.h"
#include "src/planning/check_poses.h"
#include "src/planning/pose_rows.h"

namespace alidade::internal {
namespace {

constexpr int kJointDecimals = 4;

const CalibratedArm& Calibrated(const ArmSource& source) {
  if (source.calibrated) return *source.calibrated;
  throw InputError({source.inputs.front(), 0, 0, ""},
                   "a check rests on what the calibration predicts, expected a "
                   "result directory of `calibrate` that states its "
                   "uncertainty");
}

// The controller's arm where the calibrated one stands.
Arm Uncalibrated(const ArmSource& source, const Arm& calibrated) {
  Arm arm = source.nominal;
  arm.instrument_from_base = calibrated.instrument_from_base;
  arm.targets = calibrated.targets;
  return arm;
}

std::vector<int> RefittedColumns(const ParameterLayout& layout,
                                 const VerificationOptions& options) {
  std::vector<int> columns;
  for (int column = 0; column < layout.size(); ++column) {
    const ParameterKind kind = layout.parameter(column).kind;
    const bool is_base = kind == ParameterKind::kBaseTranslation ||
                         kind == ParameterKind::kBaseRotation;
    const bool is_tool = kind == ParameterKind::kToolTranslation ||
                         kind == ParameterKind::kToolRotation;
    if ((is_base && options.refit_base) || (is_tool && options.refit_tool)) {
      columns.push_back(column);
    }
  }
  return columns;
}

// The joint values that the robot took when these were asked for.
Eigen::MatrixXd JointsTaken(const ArmSource& source, const Dataset& data,
                            const std::string& path) {
  const CorrectionArms arms = MakeCorrectionArms(source.nominal, source.real);
  const Correction correction = CorrectJoints(
      arms, MotorsFromJoints(arms.nominal, data.joint_values.map().eval()));
  for (Eigen::Index i = 0; i < correction.motors.cols(); ++i) {
    if (correction.IsReached(i)) continue;
    throw InputError({path, 0, 0, ""},
                     "the joint values of pose " + std::to_string(i + 1) +
                         " cannot be corrected, so that the robot was not "
                         "there");
  }
  return JointsFromMotors(arms.real, correction.motors);
}

// Base and target from the check's own measurements, the arm held.
Arm Refitted(const Arm& arm, const Dataset& data,
             const VerificationOptions& options) {
  CalibrationOptions fit;
  fit.identifiability.candidates.joints = false;
  fit.identifiability.candidates.base = options.refit_base;
  fit.identifiability.candidates.tool = options.refit_tool;
  fit.errors.selection = ErrorTermSelection::kNone;
  fit.num_threads = options.num_threads;
  CalibrationData measured;
  measured.training = data;
  return Calibrate(arm, measured, fit).arm;
}

ArmCheckResult Check(const ArmSource& source, const Arm& arm,
                     const Dataset& data, const VerificationOptions& options) {
  const MeasurementModel model(arm, options.num_threads);
  const MeasurementModel uncalibrated(Uncalibrated(source, arm),
                                      options.num_threads);
  ArmCheckOptions check;
  check.refitted = RefittedColumns(model.layout(), options);
  return CheckArm(model, uncalibrated, Calibrated(source).covariance, data,
                  check);
}

// The root mean square distance of positions from those of the arm (m).
double ErrorOf(const Arm& arm, const PositionSample& sample) {
  const Eigen::Matrix3Xd errors =
      TargetPositions(arm, sample.joint_values) - sample.points;
  return std::sqrt(errors.colwise().squaredNorm().mean());
}

// Units that positions or joint angles were read in by mistake, where others
// make them agree with the arm.
std::string UnitHint(const Arm& arm, const Dataset& data, double predicted) {
  constexpr double kNotNoise = 20.0;  // times what is predicted
  constexpr double kExplains = 0.02;  // of the error as read
  PositionSample sample;
  for (const ObservationBlock& block : data.blocks) {
    if (!HoldsPosition(block.kind) || sample.size() > 0) continue;
    sample.points = block.measured.map().topRows(3);
    sample.joint_values.resize(data.num_joints(), block.size());
    for (Eigen::Index i = 0; i < block.size(); ++i) {
      sample.joint_values.col(i) = data.joint_values.col(block.pose(i));
    }
  }
  if (sample.size() == 0 || !sample.points.allFinite()) return "";
  sample.joint_values_before = sample.joint_values_after = sample.joint_values;
  const double as_read = ErrorOf(arm, sample);
  if (!(as_read > kNotNoise * predicted)) return "";
  using Kind = InputMistake::Kind;
  std::vector<InputMistake> angles = {{Kind::kAngleUnit, "", [](auto*) {}}};
  std::vector<InputMistake> lengths = {{Kind::kLengthUnit, "", [](auto*) {}}};
  for (InputMistake& mistake : SingleMistakes(arm)) {
    if (mistake.kind == Kind::kAngleUnit) {
      angles.push_back(std::move(mistake));
    } else if (mistake.kind == Kind::kLengthUnit) {
      lengths.push_back(std::move(mistake));
    }
  }
  double best = kExplains * as_read;
  std::string hint;
  for (const InputMistake& angle : angles) {
    for (const InputMistake& length : lengths) {
      PositionSample mended = sample;
      angle.mend(&mended);
      length.mend(&mended);
      const double error = ErrorOf(arm, mended);
      if (!(error < best)) continue;
      best = error;
      const bool are_both = !angle.text.empty() && !length.text.empty();
      hint =
          "This is no change of the arm: the measurements agree with it, to " +
          FormatLength(error, 2) + ", if " + angle.text +
          (are_both ? ", and " : "") + length.text + ".";
    }
  }
  return hint;
}

// Whether the check passes with other options; not where it cannot be made.
bool WouldPass(const ArmSource& source, const Dataset& data,
               const std::string& path, const VerificationOptions& options) {
  try {
    const Arm& arm = Calibrated(source).arm;
    Dataset taken = data;
    if (options.corrected) {
      taken.joint_values = JointsTaken(source, data, path);
    }
    const bool refits = options.refit_base || options.refit_tool;
    const ArmCheckResult check = Check(
        source, refits ? Refitted(arm, taken, options) : arm, taken, options);
    // A base fits few measurements whatever is wrong with them.
    constexpr double kFewest = 10.0;
    return check.passes &&
           check.degrees_of_freedom >= (options.refit_base ? kFewest : 1.0);
  } catch (const InputError&) {
    return false;
  }
}

// What was done otherwise than said, where the check passes so: the other kind
// of joint values, or an instrument that has been moved. `data` as they were
// read.
std::string OptionHint(const ArmSource& source, const Dataset& data,
                       const std::string& path,
                       const VerificationOptions& options) {
  VerificationOptions other = options;
  other.corrected = !options.corrected;
  if (WouldPass(source, data, path, other)) {
    return options.corrected
               ? "Without --corrected it would pass: were the joint values "
                 "driven as they stand in the file?"
               : "With --corrected it would pass: were these poses driven with "
                 "corrected joint values?";
  }
  if (options.refit_base) return "";
  for (const bool corrected : {options.corrected, !options.corrected}) {
    other = options;
    other.refit_base = true;
    other.corrected = corrected;
    if (!WouldPass(source, data, path, other)) continue;
    return std::string("With --refit=base") +
           (options.refit_tool ? ",tool" : "") +
           (corrected == options.corrected ? ""
            : corrected                    ? " and --corrected"
                                           : " and without --corrected") +
           " it would pass: was the instrument, or the robot's base, moved "
           "since the calibration, or joint 1's zero, which no base sets "
           "apart?";
  }
  return "";
}

// Limits narrowed to what was measured: elsewhere the calibration is an
// extrapolation, and a check would be one too.
Arm WithinMeasured(const ArmSource& source) {
  Arm arm = Calibrated(source).arm;
  for (int j = 0; j < source.measured.rows(); ++j) {
    Joint& joint = arm.joints[j];
    const bool has_limits = HasLimits(joint);
    const double lower = source.measured(j, 0);
    const double upper = source.measured(j, 1);
    joint.lower = has_limits ? std::max(joint.lower, lower) : lower;
    joint.upper = has_limits ? std::min(joint.upper, upper) : upper;
  }
  return arm;
}

// As a plan's sheet: poses at which nothing is measured yet.
Dataset Unmeasured(Dataset planned) {
  ObservationBlock& block = planned.blocks.front();
  block.sigmas =
      Eigen::MatrixXd::Constant(block.rows_each(), block.size(), kInfinity);
  return planned;
}

}  // namespace

ArmCheckResult VerifyArm(const ArmSource& source, const std::string& path,
                         const VerificationOptions& options) {
  const CalibratedArm& calibrated = Calibrated(source);
  Dataset data =
      LoadDataset(path, calibrated.arm, calibrated.sigma, options.num_threads);
  if (data.num_observations() > kMostChecked) {
    throw InputError({path, 0, 0, ""},
                     std::to_string(data.num_observations()) +
                         " measurements, expected at most " +
                         std::to_string(kMostChecked) +
                         " of a check; `validate` without --check takes any "
                         "number");
  }
  const Dataset as_read = data;
  if (options.corrected) {
    data.joint_values = JointsTaken(source, data, path);
  }
  const bool refits = options.refit_base || options.refit_tool;
  const Arm arm =
      refits ? Refitted(calibrated.arm, data, options) : calibrated.arm;
  ArmCheckResult result = Check(source, arm, data, options);
  if (result.degrees_of_freedom < 1.0) {
    throw InputError({path, 0, 0, ""},
                     "too few measurements for what is found from them, "
                     "expected more poses");
  }
  if (!result.passes) {
    result.hint = UnitHint(calibrated.arm, data, result.predicted_rms);
    if (result.hint.empty()) {
      result.hint = OptionHint(source, as_read, path, options);
    }
  }
  return result;
}

VerificationPlan PlanVerification(const ArmSource& source, int num_poses,
                                  std::uint64_t seed,
                                  const VerificationOptions& options) {
  const CalibratedArm& calibrated = Calibrated(source);
  const Arm arm = WithinMeasured(source);
  const MeasurementModel model(arm, options.num_threads);
  const MeasurementModel uncalibrated(Uncalibrated(source, arm),
                                      options.num_threads);
  CheckPoseOptions choice;
  choice.refitted = RefittedColumns(model.layout(), options);
  choice.noise = calibrated.sigma;
  choice.joint_decimals = kJointDecimals;
  choice.seed = seed;
  choice.num_threads = options.num_threads;
  PoseMeasurement measurement;
  measurement.sigma = calibrated.sigma;
  VerificationPlan plan;
  std::set<int> numbers = {4, 6, 8, 10, 15, 20, 30};
  numbers.insert(num_poses);
  for (const int number : numbers) {
    choice.num_poses = number;
    const Dataset poses = MakePlannedData(
        model,
        ChooseCheckPoses(model, uncalibrated, calibrated.covariance, choice),
        measurement);
    plan.by_number.push_back(Check(source, arm, poses, options));
    if (number != num_poses) continue;
    plan.planned = plan.by_number.back();
    plan.text = FormatDataset(Unmeasured(poses), arm, kJointDecimals, false,
                              {"poses to check " + calibrated.arm.name +
                               ", in an order with little "
                               "travel; fill in what is measured"});
  }
  return plan;
}

}  // namespace alidade::internal
