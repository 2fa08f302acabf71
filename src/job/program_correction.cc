#include "src/job/program_correction.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "alidade/error.h"
#include "alidade/forward_kinematics.h"
#include "alidade/units.h"
#include "src/common/format.h"
#include "src/common/number_text.h"
#include "src/dataio/target_table.h"
#include "src/job/arm_branch.h"
#include "src/job/posture_search.h"

namespace alidade::internal {
namespace {

// Axis 5 near zero is of either sign.
constexpr double kStraight = 0.1 * kDegree;

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

class ProgramCorrector {
 public:
  ProgramCorrector(const RobotProgram& program, const CorrectionArms& arms,
                   const CorrectionOptions& options)
      : program_(program), arms_(arms), options_(options) {}

  ProgramCorrection Run() {
    result_.assumed = FrameAssumptions(program_, arms_.nominal);
    for (const std::string& note : OrderAssumptions(program_)) {
      result_.assumed.push_back(note);
    }
    if (!program_.refused.empty() || !program_.missing.empty()) {
      result_.refusal = MakeRefusal(program_, program_.refused);
      return std::move(result_);
    }
    const auto count = static_cast<Eigen::Index>(program_.targets.size());
    Resize(count, &result_.correction);
    std::vector<ProgramValues> values(static_cast<std::size_t>(count));
    for (const Eigen::Index i : InOrderOfMotion()) {
      values[i] = CorrectOne(program_.targets[i], i);
      is_solved_[i] = result_.correction.IsReached(i);
    }
    std::vector<ProgramNote> failed;
    for (Eigen::Index i = 0; i < count; ++i) {
      const ProgramTarget& target = program_.targets[i];
      const std::string name = target.name.empty() ? "" : ", " + target.name;
      result_.names.push_back(LineName(program_, target.line) + name);
      if (is_solved_[i]) continue;
      // Other postures are sought for what is listed alone.
      failed.push_back(
          {target.line, failed.size() < kMostListed ? WhyNot(i) : ""});
    }
    if (!failed.empty()) {
      result_.refusal = MakeRefusal(program_, failed);
      return std::move(result_);
    }
    CheckWays();
    result_.texts = RewriteProgram(program_, values);
    return std::move(result_);
  }

 private:
  // A line that moves to a target; in the order of the text in a line.
  using Motion = std::pair<int, Eigen::Index>;

  // Where the program is before a motion.
  struct Place {
    std::optional<Eigen::Index> target;    // the last that was solved
    const ProgramNote* unknown = nullptr;  // a motion after that
    bool IsKnown() const { return target && unknown == nullptr; }
  };

  void Resize(Eigen::Index count, Correction* all) const {
    const int n = arms_.nominal.num_joints();
    const auto size = static_cast<std::size_t>(count);
    all->asked_motors.resize(n, count);
    all->motors.resize(n, count);
    all->solutions.joint_values.resize(n, count);
    all->solutions.position_error.resize(count);
    all->solutions.rotation_error.resize(count);
    all->shift.resize(count);
    all->turn.resize(count);
    all->targets.resize(size);
    all->poses.resize(size);
    all->asked_status.resize(size);
    all->solutions.status.resize(size);
    all->solutions.iterations.resize(size);
  }

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
    starts_.resize(program_.targets.size());
    std::vector<Eigen::Index> order;
    for (const Motion& motion : first) order.push_back(motion.second);
    return order;
  }

  // Before the program first moves to target i: the position that the nearest
  // line above moves to, or the one before in the same line. Called in the
  // order of motion.
  Place PlaceBefore(Eigen::Index i) {
    const Motion first(program_.targets[i].uses.front(), i);
    for (; motions_[num_passed_] < first; ++num_passed_) {
      const auto& [line, target] = motions_[num_passed_];
      if (is_solved_[target]) nearest_ = motions_[num_passed_];
    }
    Place place;
    if (nearest_) place.target = nearest_->second;
    place.unknown = UnknownBetween(nearest_ ? nearest_->first : 0, first.first);
    return place;
  }

  // The last motion to what is not stated, of lines from `from` to before `to`.
  const ProgramNote* UnknownBetween(int from, int to) const {
    const std::vector<ProgramNote>& left = program_.left;
    auto note = std::lower_bound(
        left.begin(), left.end(), to,
        [](const ProgramNote& one, int line) { return one.line < line; });
    while (note != left.begin() && (--note)->line >= from) {
      if (note->kind == Uncorrected::kMotion) return &*note;
    }
    return nullptr;
  }

  Eigen::Isometry3d Frame(const std::string& name) const {
    return name.empty() ? Eigen::Isometry3d::Identity()
                        : program_.frames.at(name);
  }

  CorrectionArms ArmsFor(const ProgramTarget& target) const {
    return target.tool.empty() ? arms_ : WithTool(arms_, Frame(target.tool));
  }

  bool IsStraight(int line) const { return program_.straight.count(line) > 0; }

  Eigen::VectorXd JointsAt(const Arm& nominal, Eigen::Index i) const {
    return JointsFromMotors(nominal, result_.correction.asked_motors.col(i));
  }

  // Where the search for a pose begins: at the position before or, where the
  // program states no posture, where a straight motion from there arrives.
  Eigen::VectorXd StartOf(const ProgramTarget& target, const Place& before,
                          const Arm& nominal,
                          const Eigen::Isometry3d& pose) const {
    if (!before.target) return MiddleOfLimits(nominal);
    const Eigen::VectorXd joints = JointsAt(nominal, *before.target);
    if (!before.IsKnown() || !target.posture.empty() ||
        !IsStraight(target.uses.front())) {
      return joints;
    }
    const StraightWay way =
        FollowStraightWay(nominal, joints, pose, options_.solver);
    return way.status == PoseStatus::kReached ? way.joint_values : joints;
  }

  ProgramValues CorrectOne(const ProgramTarget& target, Eigen::Index i) {
    const ProgramLanguage language = program_.language;
    const CorrectionArms arms = ArmsFor(target);
    const Place before = PlaceBefore(i);
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
    Eigen::VectorXd& from = starts_[static_cast<std::size_t>(i)];
    from = StartOf(target, before, arms.nominal, pose);
    const PoseSolutions start =
        FindPoses(narrow, {pose}, from, options_.num_trials, options_.seed,
                  options_.solver);
    const Eigen::VectorXd joints =
        start.status[0] == PoseStatus::kReached
            ? InBranch(target, narrow, pose, start.joint_values.col(0))
            : Eigen::VectorXd(start.joint_values.col(0));
    Correction one =
        CorrectPoses(arms, {pose}, MotorsFromJoints(narrow, joints), options_);
    // Not in another posture than the program's.
    if (start.status[0] != PoseStatus::kReached) {
      one.asked_status[0] = start.status[0];
    }
    Put(one, i, &result_.correction);
    if (target.posture.empty() && !before.IsKnown() &&
        one.asked_status[0] == PoseStatus::kReached) {
      AssumePosture(target, before, one.asked_motors);
    }
    values.numbers =
        NumbersOfPose(language, target, frame.inverse() * one.poses[0]);
    values.posture = PostureOf(language, target, one.motors.col(0));
    return values;
  }

  // The posture that cfx states, where the quadrants leave more than one; the
  // one that was found where they leave none of it.
  Eigen::VectorXd InBranch(const ProgramTarget& target, const Arm& narrow,
                           const Eigen::Isometry3d& pose,
                           const Eigen::VectorXd& found) {
    if (!target.branch || *target.branch < 0 || *target.branch > 7) {
      return found;
    }
    const std::optional<int> branch = ArmBranch(narrow, found);
    if (!branch) {
      Assume(
          "cfx of configurations is not used: it is not known of arms whose "
          "wrist axes do not meet in a point");
      return found;
    }
    const auto is_stated = [&](const Eigen::VectorXd& joints) {
      const int differs =
          ArmBranch(narrow, joints).value_or(-1) ^ *target.branch;
      return differs == 0 || (differs == 1 && std::abs(joints[4]) < kStraight);
    };
    if (is_stated(found)) return found;
    for (const Eigen::VectorXd& other :
         FindPostures(narrow, pose, found, options_.seed, options_.solver)) {
      if (is_stated(other)) return other;
    }
    Assume(
        LineName(program_, target.line) + ": cfx " +
        std::to_string(*target.branch) + " states " +
        BranchMeaning(*target.branch) +
        ", and there is no solution so in the quadrants of cf1, cf4, cf6; "
        "taken: cfx " +
        std::to_string(*branch) + ", " + BranchMeaning(*branch) + " (" +
        JointText(program_.language, narrow, MotorsFromJoints(narrow, found)) +
        ")");
    return found;
  }

  void Assume(const std::string& note) {
    const auto& notes = result_.assumed;
    if (std::find(notes.begin(), notes.end(), note) == notes.end()) {
      result_.assumed.push_back(note);
    }
  }

  void AssumePosture(const ProgramTarget& target, const Place& before,
                     const Eigen::VectorXd& motors) {
    const std::string why = before.unknown == nullptr
                                ? "nothing that is stated is moved to before it"
                                : LineName(program_, before.unknown->line) +
                                      " " + before.unknown->text;
    result_.assumed.push_back(
        LineName(program_, target.uses.front()) +
        ": no posture is known before it (" + why +
        "); taken: " + JointText(program_.language, arms_.nominal, motors) +
        ". Where the arm is in another one there, the correction is wrong: "
        "move to a position in joint values before it");
  }

  // Why a position cannot be corrected, and in which postures it can.
  std::string WhyNot(Eigen::Index i) const {
    const ProgramTarget& target = program_.targets[i];
    const Correction& all = result_.correction;
    const std::string name =
        target.name.empty() ? "" : ", " + target.name + ": ";
    if (all.asked_status[i] == PoseStatus::kReached) {
      return name + "the calibrated arm does not reach it: " +
             ToString(all.solutions.status[i]);
    }
    const Arm nominal = ArmsFor(target).nominal;
    const std::string status = ToString(all.asked_status[i]);
    const std::string arm = " of the nominal arm";
    const auto postures = FindPostures(nominal, all.targets[i],
                                       starts_[static_cast<std::size_t>(i)],
                                       options_.seed, options_.solver);
    if (target.posture.empty() || postures.empty()) {
      return name + status + arm +
             (target.posture.empty() ? "" : ", in any posture");
    }
    return name + PostureConflict(target, nominal, postures);
  }

  std::string PostureConflict(
      const ProgramTarget& target, const Arm& nominal,
      const std::vector<Eigen::VectorXd>& postures) const {
    constexpr std::size_t kMostPostures = 3;
    const ProgramLanguage language = program_.language;
    std::vector<int> stated;
    for (const NumberSpan& span : target.posture) {
      stated.push_back(span.Whole().value_or(0));
    }
    std::string text =
        (language == ProgramLanguage::kRapid ? "cf1, cf4, cf6 = " : "") +
        PostureText(language, stated) + " states " +
        PostureMeaning(language, stated, nominal.num_joints()) +
        ", and the nominal arm does not reach it so. It does with ";
    std::set<std::string> named;
    for (const Eigen::VectorXd& joints : postures) {
      const Eigen::VectorXd motors = MotorsFromJoints(nominal, joints);
      const std::string other =
          PostureText(language, PostureOf(language, target, motors));
      if (named.size() == kMostPostures || !named.insert(other).second) {
        continue;
      }
      text += (named.size() > 1 ? "; " : "") + other + " (" +
              JointText(language, nominal, motors) + ")";
    }
    return text;
  }

  // Straight motions end in the posture that their way leads to, whatever was
  // solved for their end.
  void CheckWays() {
    std::set<std::pair<Eigen::Index, Eigen::Index>> checked;
    for (std::size_t k = 1; k < motions_.size(); ++k) {
      const auto& [from_line, from] = motions_[k - 1];
      const auto& [line, to] = motions_[k];
      if (!IsStraight(line) || UnknownBetween(from_line, line) != nullptr) {
        continue;
      }
      if (!checked.emplace(from, to).second) continue;
      CheckWay(from_line, from, line, to);
    }
  }

  void CheckWay(int from_line, Eigen::Index from, int line, Eigen::Index to) {
    const Arm nominal = ArmsFor(program_.targets[to]).nominal;
    const Eigen::VectorXd end = JointsAt(nominal, to);
    const StraightWay way =
        FollowStraightWay(nominal, JointsAt(nominal, from),
                          TargetPose(nominal, end), options_.solver);
    const std::string lines = "from " + LineName(program_, from_line) + " to " +
                              LineName(program_, line) + ": ";
    const std::string differing =
        Differing(nominal, MotorsFromJoints(nominal, way.joint_values),
                  result_.correction.asked_motors.col(to));
    if (way.status != PoseStatus::kReached) {
      result_.warnings.push_back(
          lines +
          (way.fraction > 0.0
               ? "after " + FormatPercent(way.fraction, 2) + " of"
               : "at the start of") +
          " the straight way " + Obstacle(way.status) +
          (differing.empty() ? ""
                             : "; from there to the posture that its end is "
                               "corrected in: " +
                                   differing));
    } else if (!differing.empty()) {
      result_.warnings.push_back(lines +
                                 "the straight way arrives in another posture "
                                 "than its end is corrected in: " +
                                 differing);
    }
  }

  static std::string Obstacle(PoseStatus status) {
    if (status == PoseStatus::kLimit) {
      return "the nominal arm comes to a joint limit";
    }
    return status == PoseStatus::kOutOfReach
               ? "the nominal arm is out of reach, or at a singular pose"
               : "joints turn by more than 30 deg within 10 mm or 2 deg, as "
                 "wrists do at a singular pose";
  }

  // "A4 -180.0 -> -49.2 deg": joints that differ by more than a degree.
  std::string Differing(const Arm& arm, const Eigen::VectorXd& first,
                        const Eigen::VectorXd& second) const {
    std::string text;
    for (int j = 0; j < arm.num_joints(); ++j) {
      if (arm.joints[j].type != JointType::kRevolute ||
          std::abs(first[j] - second[j]) < kDegree) {
        continue;
      }
      text += (text.empty() ? "" : ", ") + JointName(program_.language, j) +
              " " + FixedNumber(first[j] / kDegree, 1) + " -> " +
              FixedNumber(second[j] / kDegree, 1) + " deg";
    }
    return text;
  }

  const RobotProgram& program_;
  const CorrectionArms& arms_;
  const CorrectionOptions& options_;
  std::vector<bool> is_solved_;
  std::vector<Motion> motions_;
  std::size_t num_passed_ = 0;  // of motions_
  std::optional<Motion> nearest_;
  std::vector<Eigen::VectorXd> starts_;  // of each target's search
  ProgramCorrection result_;
};

}  // namespace

ProgramCorrection CorrectProgram(const RobotProgram& program,
                                 const CorrectionArms& arms,
                                 const CorrectionOptions& options) {
  return ProgramCorrector(program, arms, options).Run();
}

}  // namespace alidade::internal
