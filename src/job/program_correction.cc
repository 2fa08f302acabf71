#include "src/job/program_correction.h"

#include <algorithm>
#include <cmath>
#include <functional>
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
#include "src/job/correction_columns.h"
#include "src/job/posture_search.h"
#include "src/job/program_arms.h"

namespace alidade::internal {
namespace {

// Axis 5 near zero is of either sign.
constexpr double kStraightWrist = 0.1 * kDegree;

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
    result_.correction = EmptyCorrection(count, arms_.nominal.num_joints());
    std::vector<ProgramValues> values(static_cast<std::size_t>(count));
    for (const Eigen::Index i : InOrderOfMotion()) {
      values[i] = CorrectOne(program_.targets[i], i);
      is_solved_[i] = is_left_[i] || result_.correction.IsReached(i);
    }
    std::vector<ProgramNote> failed;
    for (Eigen::Index i = 0; i < count; ++i) {
      const ProgramTarget& target = program_.targets[i];
      const std::string name = target.name.empty() ? "" : ", " + target.name;
      const std::string place = LineName(program_, target.line) + name;
      if (is_left_[i]) {
        result_.left.push_back(
            place + ": a joint position at a singular pose, left as it is");
        continue;
      }
      result_.names.push_back(place);
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
    is_left_.flip();
    result_.correction = KeptCorrections(result_.correction, is_left_);
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

  // By the first lines that move to them; those that nothing moves to, which
  // the program need not state, come last.
  std::vector<Eigen::Index> InOrderOfMotion() {
    const auto count = static_cast<Eigen::Index>(program_.targets.size());
    std::vector<Motion> first;
    std::vector<Eigen::Index> unused;
    for (Eigen::Index i = 0; i < count; ++i) {
      const std::vector<int>& lines = program_.targets[i].uses;
      if (!IsMovedTo(program_.targets[i])) {
        unused.push_back(i);
        continue;
      }
      first.emplace_back(lines.front(), i);
      for (const int line : lines) motions_.emplace_back(line, i);
    }
    std::sort(first.begin(), first.end());
    std::sort(motions_.begin(), motions_.end());
    is_solved_.assign(program_.targets.size(), false);
    is_left_.assign(program_.targets.size(), false);
    starts_.resize(program_.targets.size());
    std::vector<Eigen::Index> order;
    for (const Motion& motion : first) order.push_back(motion.second);
    order.insert(order.end(), unused.begin(), unused.end());
    return order;
  }

  // Declarations that are read with their program and that it does not use are
  // not of its motions.
  bool IsMovedTo(const ProgramTarget& target) const {
    return target.uses.front() >= program_.files.back().first_line;
  }

  // Before the program first moves to target i: the position that the nearest
  // line above moves to, or the one before in the same line. Called in the
  // order of motion.
  Place PlaceBefore(Eigen::Index i) {
    if (!IsMovedTo(program_.targets[i])) return {};
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

  static const ProgramNote* LastBefore(
      const std::vector<ProgramNote>& notes, int from, int to,
      const std::function<bool(Uncorrected)>& counts) {
    auto note = std::lower_bound(
        notes.begin(), notes.end(), to,
        [](const ProgramNote& one, int line) { return one.line < line; });
    while (note != notes.begin() && (--note)->line >= from) {
      if (counts(note->kind)) return &*note;
    }
    return nullptr;
  }

  // The last motion to what is not stated, of lines from `from` to before `to`,
  // or the last place where the text is not in the order of the motions.
  const ProgramNote* UnknownBetween(int from, int to) const {
    const ProgramNote* motion =
        LastBefore(program_.left, from, to, [this](Uncorrected kind) {
          return kind == Uncorrected::kMotion ||
                 (kind == Uncorrected::kRelativeMotion &&
                  program_.language == ProgramLanguage::kKrl);
        });
    // Before the first motion there is no order.
    if (from == 0 && motion == nullptr) return nullptr;
    const ProgramNote* other =
        LastBefore(program_.breaks, motion != nullptr ? motion->line : from, to,
                   [](Uncorrected /*kind*/) { return true; });
    return other != nullptr ? other : motion;
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
    Eigen::VectorXd joints = JointsAt(nominal, *before.target);
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
      PutCorrection(one, i, &result_.correction);
      is_left_[static_cast<std::size_t>(i)] = IsLeftAsItIs(arms.nominal, one);
      if (is_left_[static_cast<std::size_t>(i)]) return values;
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
    PutCorrection(one, i, &result_.correction);
    if (target.posture.empty() && !before.IsKnown() &&
        one.asked_status[0] == PoseStatus::kReached) {
      AssumePosture(target, before, one.asked_motors);
    }
    values.numbers =
        NumbersOfPose(language, target, frame.inverse() * one.poses[0]);
    values.posture = PostureOf(language, target, one.motors.col(0));
    return values;
  }

  // Joints at a singular pose are those of a home: no small change of them
  // moves the arm where the nominal one would be.
  static bool IsLeftAsItIs(const Arm& nominal, const Correction& one) {
    const PoseStatus status = one.solutions.status[0];
    return status == PoseStatus::kOutOfReach ||
           status == PoseStatus::kBranchChange ||
           IsSingular(nominal,
                      JointsFromMotors(nominal, one.asked_motors.col(0)));
  }

  // The posture that cfx states, where the quadrants leave more than one; the
  // one that was found where they leave none of it.
  Eigen::VectorXd InBranch(const ProgramTarget& target, const Arm& narrow,
                           const Eigen::Isometry3d& pose,
                           const Eigen::VectorXd& found) {
    if (!target.branch) return found;
    if (*target.branch < 0 || *target.branch > 7) {
      Assume(LineName(program_, target.line) + ": cfx " +
             std::to_string(*target.branch) +
             " is not used: of six joints it is 0 to 7");
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
      return differs == 0 ||
             (differs == 1 && std::abs(joints[4]) < kStraightWrist);
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
    if (assumed_.insert(note).second) result_.assumed.push_back(note);
  }

  void AssumePosture(const ProgramTarget& target, const Place& before,
                     const Eigen::VectorXd& motors) {
    const std::string why = !IsMovedTo(target) ? "nothing moves to it"
                            : before.unknown == nullptr
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
    const Arm nominal = ArmsFor(target).nominal;
    const std::string singular =
        IsSingular(nominal, JointsAt(nominal, i)) ? ", at a singular pose" : "";
    if (all.asked_status[i] == PoseStatus::kReached) {
      return name + "the calibrated arm does not reach it: " +
             ToString(all.solutions.status[i]) + singular;
    }
    const std::string status =
        ToString(all.asked_status[i]) + (" of the nominal arm" + singular);
    if (target.posture.empty()) return name + status;
    const auto postures = FindPostures(nominal, all.targets[i],
                                       starts_[static_cast<std::size_t>(i)],
                                       options_.seed, options_.solver);
    return name + (postures.empty()
                       ? status + ", in any posture"
                       : PostureConflict(target, nominal, postures));
  }

  std::string PostureConflict(
      const ProgramTarget& target, const Arm& nominal,
      const std::vector<Eigen::VectorXd>& postures) const {
    constexpr std::size_t kMostPostures = 3;
    const ProgramLanguage language = program_.language;
    const std::vector<int> stated = StatedPosture(target);
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
  std::vector<bool> is_left_;  // joints at a singular pose
  std::vector<Motion> motions_;
  std::size_t num_passed_ = 0;  // of motions_
  std::optional<Motion> nearest_;
  std::vector<Eigen::VectorXd> starts_;  // of each target's search
  std::set<std::string> assumed_;        // notes, once each
  ProgramCorrection result_;
};

}  // namespace

ProgramCorrection CorrectProgram(const RobotProgram& program,
                                 const CorrectionArms& arms,
                                 const CorrectionOptions& options) {
  return ProgramCorrector(program, arms, options).Run();
}

}  // namespace alidade::internal
