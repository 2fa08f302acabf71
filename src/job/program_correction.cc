#include "src/job/program_correction.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "alidade/error.h"
#include "alidade/units.h"
#include "src/common/format.h"
#include "src/common/text.h"
#include "src/dataio/target_table.h"
#include "src/report/correction_report.h"

namespace alidade::internal {
namespace {

constexpr std::size_t kMostListed = 20;

// The arms with a program's tool behind the flange.
CorrectionArms WithTool(const CorrectionArms& arms,
                        const Eigen::Isometry3d& flange_from_tool) {
  CorrectionArms with = arms;
  for (Arm* arm : {&with.nominal, &with.real}) {
    const Eigen::Vector3d load = MeanTargetOf(*arm);
    arm->last_from_target() = arm->last_from_target() * flange_from_tool;
    if (arm->errors.load_geometry.size() > 0) continue;
    arm->errors.payload.centre += load - MeanTargetOf(*arm);
  }
  return with;
}

// Limits narrowed to what the posture allows, where each motor turns a joint
// of its own.
Arm WithBounds(const Arm& arm, const Eigen::MatrixXd& bounds) {
  Arm narrow = arm;
  const Eigen::MatrixXd& map = arm.joints_from_motors;
  for (int j = 0; j < arm.num_joints(); ++j) {
    double scale = 1.0;
    if (map.size() > 0) {
      scale = map(j, j);
      if (std::abs(map.row(j).cwiseAbs().sum() - std::abs(scale)) > 0.0 ||
          scale == 0.0) {
        continue;
      }
    }
    const double offset =
        arm.motor_offsets.size() > 0 ? arm.motor_offsets[j] : 0.0;
    double lower = scale * bounds(j, 0) + offset;
    double upper = scale * bounds(j, 1) + offset;
    if (lower > upper) std::swap(lower, upper);
    Joint& joint = narrow.joints[j];
    const bool has_limits = HasLimits(joint);
    joint.lower = has_limits ? std::max(joint.lower, lower) : lower;
    joint.upper = has_limits ? std::min(joint.upper, upper) : upper;
  }
  return narrow;
}

void Put(const Correction& one, Eigen::Index i, Correction* all) {
  all->targets[i] = one.targets[0];
  all->asked_motors.col(i) = one.asked_motors;
  all->asked_status[i] = one.asked_status[0];
  all->motors.col(i) = one.motors;
  all->poses[i] = one.poses[0];
  PoseSolutions& solutions = all->solutions;
  solutions.joint_values.col(i) = one.solutions.joint_values;
  solutions.status[i] = one.solutions.status[0];
  solutions.position_error[i] = one.solutions.position_error[0];
  solutions.rotation_error[i] = one.solutions.rotation_error[0];
  solutions.iterations[i] = one.solutions.iterations[0];
  all->shift[i] = one.shift[0];
  all->turn[i] = one.turn[0];
}

std::string UnstatedFrameNote(const std::string& kind,
                              const std::vector<int>& lines) {
  const auto others = static_cast<std::int64_t>(lines.size()) - 1;
  const bool is_tool = kind == "tool";
  return "line " + std::to_string(lines.front()) +
         (others > 0 ? " and " + Count(others, "other position") : "") +
         ": the program sets no " + kind + " before, so " +
         (is_tool ? "the arm file's target" : "the arm's own base") +
         " is taken for it; where another " + kind +
         " is active on the controller, " +
         (is_tool ? "its installation's for one, " : "") +
         "the correction is wrong: set it in the program, or give --frames a "
         "row named " +
         kind;
}

[[noreturn]] void Refuse(const RobotProgram& program,
                         const std::vector<ProgramNote>& notes) {
  std::string text =
      "nothing is written, as " +
      Count(static_cast<std::int64_t>(notes.size()), "position") +
      " cannot be corrected:";
  for (std::size_t i = 0; i < std::min(notes.size(), kMostListed); ++i) {
    text += (i == 0 ? " line " : "; line ") + std::to_string(notes[i].line) +
            ": " + notes[i].text;
  }
  throw InputError({program.path, notes.front().line, 0, ""}, text);
}

class ProgramCorrector {
 public:
  ProgramCorrector(const RobotProgram& program, const CorrectionArms& arms,
                   const CorrectionOptions& options)
      : program_(program), arms_(arms), options_(options) {}

  ProgramCorrection Run() {
    if (!program_.refused.empty()) Refuse(program_, program_.refused);
    const auto count = static_cast<Eigen::Index>(program_.targets.size());
    const int n = arms_.nominal.num_joints();
    Correction& all = result_.correction;
    all.asked_motors.resize(n, count);
    all.motors.resize(n, count);
    all.solutions.joint_values.resize(n, count);
    all.solutions.position_error.resize(count);
    all.solutions.rotation_error.resize(count);
    all.shift.resize(count);
    all.turn.resize(count);
    all.targets.resize(static_cast<std::size_t>(count));
    all.poses.resize(static_cast<std::size_t>(count));
    all.asked_status.resize(static_cast<std::size_t>(count));
    all.solutions.status.resize(static_cast<std::size_t>(count));
    all.solutions.iterations.resize(static_cast<std::size_t>(count));
    std::vector<ProgramValues> values(static_cast<std::size_t>(count));
    std::vector<ProgramNote> failed;
    for (const Eigen::Index i : InOrderOfMotion()) {
      values[i] = CorrectOne(program_.targets[i], i);
      is_solved_[i] = all.IsReached(i);
    }
    for (Eigen::Index i = 0; i < count; ++i) {
      const ProgramTarget& target = program_.targets[i];
      result_.names.push_back("line " + std::to_string(target.line) +
                              (target.name.empty() ? "" : ", ") + target.name);
      if (is_solved_[i]) continue;
      failed.push_back({target.line, StatusOf(all, i) + Posture(target)});
    }
    if (!failed.empty()) Refuse(program_, failed);
    result_.text = RewriteProgram(program_, values);
    return std::move(result_);
  }

 private:
  // A line that moves to a target; in the order of the text in a line.
  using Motion = std::pair<int, Eigen::Index>;

  // By the first lines that move to them.
  std::vector<Eigen::Index> InOrderOfMotion() {
    const auto count = static_cast<Eigen::Index>(program_.targets.size());
    std::vector<Motion> first;
    for (Eigen::Index i = 0; i < count; ++i) {
      const std::vector<int>& lines = program_.targets[i].uses;
      first.emplace_back(lines.front(), i);
      for (const int line : lines) motions_.emplace_back(line, i);
    }
    std::sort(first.begin(), first.end());
    std::sort(motions_.begin(), motions_.end());
    is_solved_.assign(program_.targets.size(), false);
    std::vector<Eigen::Index> order;
    for (const Motion& motion : first) order.push_back(motion.second);
    return order;
  }

  // Where the program is before it first moves to target i: at the position
  // that the nearest line above moves to, or the one before in the same line.
  // Called in the order of motion.
  Eigen::VectorXd MotorsBefore(Eigen::Index i) {
    const Motion first(program_.targets[i].uses.front(), i);
    for (; motions_[num_passed_] < first; ++num_passed_) {
      const Eigen::Index target = motions_[num_passed_].second;
      if (is_solved_[target]) nearest_ = target;
    }
    if (nearest_) return result_.correction.asked_motors.col(*nearest_);
    return MotorsFromJoints(arms_.nominal, MiddleOfLimits(arms_.nominal));
  }

  static std::string Posture(const ProgramTarget& target) {
    return target.posture.empty() ? "" : ", in the posture that is stated";
  }

  Eigen::Isometry3d Frame(const std::string& name) const {
    return name.empty() ? Eigen::Isometry3d::Identity()
                        : program_.frames.at(name);
  }

  ProgramValues CorrectOne(const ProgramTarget& target, Eigen::Index i) {
    const ProgramLanguage language = program_.language;
    const CorrectionArms arms =
        target.tool.empty() ? arms_ : WithTool(arms_, Frame(target.tool));
    ProgramValues values;
    if (target.is_joints) {
      const Eigen::VectorXd motors = MotorsOf(language, target, arms.nominal);
      const Correction one = CorrectJoints(arms, motors, options_);
      Put(one, i, &result_.correction);
      values.numbers =
          NumbersOfMotors(language, arms.nominal, one.motors.col(0));
      return values;
    }
    const Eigen::Isometry3d frame = Frame(target.frame);
    const Eigen::Isometry3d pose = frame * PoseOf(language, target);
    const Arm narrow =
        WithBounds(arms.nominal,
                   PostureBounds(language, target, arms.nominal.num_joints()));
    const PoseSolutions start =
        FindPoses(narrow, {pose}, JointsFromMotors(narrow, MotorsBefore(i)),
                  options_.num_trials, options_.seed, options_.solver);
    Correction one = CorrectPoses(
        arms, {pose}, MotorsFromJoints(narrow, start.joint_values), options_);
    // Not in another posture than the program's.
    if (start.status[0] != PoseStatus::kReached) {
      one.asked_status[0] = start.status[0];
    }
    Put(one, i, &result_.correction);
    values.numbers =
        NumbersOfPose(language, target, frame.inverse() * one.poses[0]);
    values.posture = PostureOf(language, target, one.motors.col(0));
    return values;
  }

  const RobotProgram& program_;
  const CorrectionArms& arms_;
  const CorrectionOptions& options_;
  std::vector<bool> is_solved_;
  std::vector<Motion> motions_;
  std::size_t num_passed_ = 0;  // of motions_
  std::optional<Eigen::Index> nearest_;
  ProgramCorrection result_;
};

}  // namespace

ProgramCorrection CorrectProgram(const RobotProgram& program,
                                 const CorrectionArms& arms,
                                 const CorrectionOptions& options) {
  return ProgramCorrector(program, arms, options).Run();
}

std::vector<std::string> AssumptionsOf(const RobotProgram& program,
                                       const Arm& nominal) {
  std::vector<std::string> notes;
  for (const auto& [kind, lines] : program.unstated) {
    notes.push_back(UnstatedFrameNote(kind, lines));
  }
  if (program.language == ProgramLanguage::kUrScript &&
      program.frames.count("base") > 0) {
    notes.emplace_back(
        "poses are in the robot's own base: URScript knows no other, and the "
        "row base of --frames is not used");
  }
  const double away = nominal.last_from_target().translation().norm();
  const bool has_tools =
      std::any_of(program.targets.begin(), program.targets.end(),
                  [](const ProgramTarget& one) { return !one.tool.empty(); });
  if (has_tools && away > 0.0) {
    notes.push_back(
        "the program's tools begin at the arm file's target, " +
        FormatSignificant(away / kMillimetre, 3) +
        " mm from the frame of the last joint: where that is not the flange, "
        "name an arm whose target it is by --nominal");
  }
  return notes;
}

std::map<std::string, Eigen::Isometry3d> LoadFrames(
    const std::string& path, const Arm& arm,
    const std::optional<RotationConvention>& rotation) {
  const TargetTable table = ReadTargets(path, arm, rotation);
  if (table.names.empty() || !table.has_positions ||
      table.format.form == OrientationForm::kNone) {
    throw InputError({path, 0, 0, ""},
                     "expected the columns name, x_mm, y_mm, z_mm and an "
                     "orientation");
  }
  std::map<std::string, Eigen::Isometry3d> frames;
  for (std::size_t i = 0; i < table.poses.size(); ++i) {
    frames[table.names[i]] = table.poses[i];
  }
  return frames;
}

}  // namespace alidade::internal
