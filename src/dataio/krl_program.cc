// KUKA KRL: {X 1,Y 2,Z 3,A 0,B 90,C 0,S 2,T 10} in mm and deg, {A1 0,A2 -90,
// ...} in deg; a .src file with its .dat, or one of both alone.

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>
#include <map>
#include <set>
#include <string_view>
#include <tuple>
#include <utility>

#include "src/dataio/krl_frames.h"
#include "src/dataio/program_routines.h"
#include "src/dataio/program_text.h"

namespace alidade::internal {
namespace {

bool IsMotion(const std::string& word) {
  static const std::set<std::string> kMotions = {
      "PTP", "LIN", "CIRC", "SPTP", "SLIN", "SCIRC", "SPL"};
  return kMotions.count(word) > 0;
}

// PTP_REL, LIN_REL and their like.
bool IsRelative(const std::string& word) {
  constexpr std::string_view kEnding = "_REL";
  return word.size() > kEnding.size() &&
         word.substr(word.size() - kEnding.size()) == kEnding &&
         IsMotion(word.substr(0, word.size() - kEnding.size()));
}

// A position that a variable holds.
struct Variable {
  std::string name;
  std::string type;  // E6POS, POS, FRAME, E6AXIS, AXIS; empty: not declared
  KrlAggregate value;
};

class KrlReader : ProgramReader {
 public:
  KrlReader(int num_joints, RobotProgram* program)
      : ProgramReader(";", '"', false, program), frames_(text_, program) {
    for (int j = 1; j <= num_joints; ++j) {
      axes_.push_back("A" + std::to_string(j));
    }
  }

  void Read() {
    for (std::size_t at = 0; (at = text_.text().find('{', at)) != kNowhere;
         ++at) {
      ReadAggregate(at);
    }
    for (const Variable& variable : variables_) ReadVariable(variable);
    ListOtherMoves();
    ListRelativeMoves();
    ListStraight([](const std::string& word) {
      return IsMotion(word) && word.substr(word.size() - 3) != "PTP";
    });
    SortTargets();
    ListRoutines(text_, program_);
    std::set<std::string> own;
    for (const auto& [name, frames] : point_frames_) own.insert("X" + name);
    ListBorrowedFrames(frames_.settings(), own, program_);
  }

 private:
  // The statement up to the brace, from the start of its line.
  std::string Before(std::size_t brace) const {
    const std::size_t start = text_.SkipSpaces(text_.LineStart(brace));
    const std::size_t end = text_.SkipSpacesBack(brace);
    return end > start ? text_.text().substr(start, end - start) : "";
  }

  void ReadAggregate(std::size_t at) {
    const KrlAggregate aggregate = ParseKrlAggregate(text_, at);
    const std::string before = Before(at);
    if (aggregate.HasAll({"TOOL_NO", "BASE_NO"})) {
      KeepPointData(before, aggregate, at);
      return;
    }
    const bool is_axes = aggregate.HasAny(axes_) && !aggregate.HasAny({"X"});
    const auto& names = is_axes ? axes_ : KrlPoseNames();
    if (!aggregate.HasAny(names)) return;
    const std::size_t word_begin = text_.SkipSpaces(text_.LineStart(at));
    const std::string first = text_.WordAt(word_begin);
    if (IsRelative(first)) return;
    if (IsMotion(first)) {
      ReadMotion(first, before, aggregate, is_axes);
      return;
    }
    if (before.empty() || before.back() != '=') {
      const bool is_frame = first == "$TOOL" || first == "$BASE";
      if (!is_frame) Leave(at, "a position in an expression");
      return;
    }
    KeepVariable(before.substr(0, before.size() - 1), aggregate);
  }

  // By numbers or by a variable.
  void ListRelativeMoves() {
    for (std::size_t start = 0; start < text_.size();
         start = text_.LineEnd(start) + 1) {
      const std::size_t at = text_.SkipSpaces(start);
      const std::string word = text_.WordAt(at);
      if (!IsRelative(word)) continue;
      Leave(at, word + " moves relative to where the robot is",
            Uncorrected::kRelativeMotion);
    }
  }

  void ReadMotion(const std::string& motion, const std::string& before,
                  const KrlAggregate& aggregate, bool is_axes) {
    const bool is_arc = motion.back() == 'C';
    const char last = before.back();
    if (before != motion && !(is_arc && last == ',')) {
      Leave(aggregate.begin, "a position is computed at run time",
            Uncorrected::kMotion);
      return;
    }
    AddTarget(aggregate, is_axes, "", frames_.At(aggregate.begin));
  }

  // DECL FDAT FP1={TOOL_NO 1,BASE_NO 2,IPO_FRAME #BASE,...} goes with XP1.
  void KeepPointData(const std::string& before, const KrlAggregate& data,
                     std::size_t at) {
    const std::size_t equals = before.find('=');
    std::string name = before.substr(0, equals);
    name.erase(name.find_last_not_of(" \t") + 1);
    name.erase(0, name.find_last_of(" \t") + 1);
    if (name.empty()) return;
    const std::string rest =
        text_.text().substr(at, text_.text().find('}', at) - at);
    const bool is_at_tool = rest.find("#TCP") != kNowhere;
    const std::optional<int> tool = data.numbers.at("TOOL_NO").Whole();
    const std::optional<int> base = data.numbers.at("BASE_NO").Whole();
    point_frames_[name.substr(1)] =
        is_at_tool || !tool || !base ? KrlFrames{"?", "?"}
                                     : KrlFrames{KrlFrameName("tool", *tool),
                                                 KrlFrameName("base", *base)};
  }

  void KeepVariable(std::string left, const KrlAggregate& value) {
    left.erase(left.find_last_not_of(" \t") + 1);
    const std::string name = left.substr(left.find_last_of(" \t") + 1);
    if (!MayBeName(name)) {
      Leave(value.begin, "is given to no variable");
      return;
    }
    if (name.front() == '$' || name.back() == ']') {
      const bool is_known = name.rfind("TOOL_DATA", 0) == 0 ||
                            name.rfind("BASE_DATA", 0) == 0 ||
                            name.front() == '$';
      if (!is_known) Leave(value.begin, name + " is an element of an array");
      return;
    }
    if (!IsName(name)) {
      Leave(value.begin, "is given to no variable");
      return;
    }
    std::string type;
    for (const char* candidate : {"E6AXIS", "AXIS", "E6POS", "POS", "FRAME"}) {
      const std::string word = candidate;
      const std::size_t at = (" " + left).find(" " + word + " ");
      if (at != kNowhere && type.empty()) type = word;
    }
    variables_.push_back({name, type, value});
  }

  // Where a variable is moved to, and whether anything else is done with it.
  struct Uses {
    std::set<KrlFrames> frames;
    bool is_computed_with = false;
  };
  // Found once of a name, which may be given many positions.
  const Uses& UsesOfVariable(const std::string& name) {
    const auto [found, is_new] = uses_.try_emplace(name);
    Uses& uses = found->second;
    if (!is_new) return uses;
    for (std::size_t at = 0; (at = text_.FindWord(name, at)) != kNowhere;
         at += name.size()) {
      const std::size_t start = text_.SkipSpaces(text_.LineStart(at));
      const std::size_t after = text_.SkipSpaces(at + name.size());
      const std::string first = text_.WordAt(start);
      const bool is_set = start == at && text_.at(after) == '=' &&
                          text_.at(text_.SkipSpaces(after + 1)) != '{';
      if (is_set || text_.at(after) == '.' || text_.at(after) == ':' ||
          (at > 0 && text_.at(text_.SkipSpacesBack(at) - 1) == ':')) {
        uses.is_computed_with = true;
      } else if (IsMotion(first)) {
        uses.frames.insert(frames_.At(at));
      }
    }
    return uses;
  }

  // Whether $TOOL or $BASE are set before a motion, and not to `stated`.
  static bool IsSetOtherwise(const std::set<KrlFrames>& at_motions,
                             const KrlFrames& stated) {
    return std::any_of(
        at_motions.begin(), at_motions.end(), [&](const KrlFrames& set) {
          return (set.tool != kUnstatedTool && set.tool != stated.tool) ||
                 (set.base != kUnstatedBase && set.base != stated.base);
        });
  }

  // Whether the data of a point are used: FDAT_ACT=FP1, $TOOL=STOOL2(FP1).
  bool IsActivated(const std::string& point) const {
    for (std::size_t at = 0; (at = text_.FindWord(point, at)) != kNowhere;
         at += point.size()) {
      if (text_.at(text_.SkipSpaces(at + point.size())) != '=') return true;
    }
    return false;
  }

  void ReadVariable(const Variable& variable) {
    const std::string& name = variable.name;
    const Uses& uses = UsesOfVariable(name);
    std::set<KrlFrames> frames = uses.frames;
    const std::size_t begin = variable.value.begin;
    const bool is_point = !variable.type.empty() && variable.type != "FRAME";
    const auto data = point_frames_.find(name.substr(1));
    const bool is_axes =
        variable.value.HasAny(axes_) && !variable.value.HasAny({"X"});
    if (data != point_frames_.end() && is_point) {
      const std::string point = "F" + name.substr(1);
      if (!is_axes && IsSetOtherwise(frames, data->second) &&
          !IsActivated(point)) {
        Refuse(begin, name + ": a motion to it has another tool or base than " +
                          point + " states, which no FDAT_ACT=" + point +
                          " activates: state the same in both");
        return;
      }
      frames = {data->second};
    }
    // Of declarations alone every position counts.
    const bool is_whole = program_->files.size() > 1;
    if (frames.empty() && is_point && !is_whole) frames = {frames_.At(begin)};
    if (frames.empty()) {
      Leave(begin, name + " is not moved to in this " +
                       (is_whole ? "program" : "file"));
      return;
    }
    if (uses.is_computed_with) {
      Refuse(begin, name + " is moved to and also computed with");
      return;
    }
    if (frames.size() > 1 && !is_axes) {
      Refuse(begin, name + " is moved to with several tools or bases");
      return;
    }
    AddTarget(variable.value, is_axes, name, *frames.begin());
  }

  // Motions to what is no variable of numbers: names of others, and what the
  // geometric operator, an index or a function gives.
  void ListOtherMoves() {
    for (std::size_t start = 0; start < text_.size();
         start = text_.LineEnd(start) + 1) {
      const std::size_t at = text_.SkipSpaces(start);
      const std::string motion = text_.WordAt(at);
      if (!IsMotion(motion)) continue;
      std::size_t next = at + motion.size();
      for (int left = motion.back() == 'C' ? 2 : 1; left > 0; --left) {
        next = text_.SkipSpaces(next);
        CheckEnd(at, next);
        while (text_.at(next) != '\n' && text_.at(next) != ',') {
          next = text_.at(next) == '{' ? CloseOf(next) : next + 1;
        }
        if (text_.at(next) != ',') break;
        ++next;
      }
    }
  }

  // Behind a brace, or at the end of its line.
  std::size_t CloseOf(std::size_t brace) const {
    const std::size_t close = text_.text().find('}', brace);
    const std::size_t end = text_.LineEnd(brace);
    return close < end ? close + 1 : end;
  }

  // Of a motion at `at`, whose end stands at `place`.
  void CheckEnd(std::size_t at, std::size_t place) {
    const bool is_literal = text_.at(place) == '{';
    const std::string name = is_literal ? "" : text_.WordAt(place);
    const std::size_t after = is_literal ? CloseOf(place) : place + name.size();
    const char next = text_.at(text_.SkipSpaces(after));
    if (next == ':' || next == '.' || next == '[' || next == '(') {
      Leave(at, "moves to what is computed at run time", Uncorrected::kMotion);
    } else if (!name.empty() && uses_.count(name) == 0) {
      Leave(at,
            "moves to " + name + ", which is not stated in this " +
                (program_->files.size() > 1 ? "program" : "file"),
            Uncorrected::kMotion);
    }
  }

  void AddTarget(const KrlAggregate& value, bool is_axes,
                 const std::string& name, const KrlFrames& frames) {
    const auto& names = is_axes ? axes_ : KrlPoseNames();
    if (!value.HasAll(names)) {
      Refuse(value.begin, "states only some of " + names.front() + " to " +
                              names.back() +
                              ", the others being where the robot is");
      return;
    }
    for (int e = 1; e <= 6; ++e) {
      const auto axis = value.numbers.find("E" + std::to_string(e));
      if (axis != value.numbers.end() && axis->second.value != 0.0) {
        Refuse(value.begin, "has an external axis (" + axis->first +
                                "), which the arm file does not know");
        return;
      }
    }
    ProgramTarget target;
    target.is_joints = is_axes;
    target.line = text_.LineOf(value.begin);
    target.name = name;
    target.numbers = value.Of(names);
    if (!is_axes) {
      target.tool = FrameOrOwn(frames.tool, value.begin);
      target.frame = FrameOrOwn(frames.base, value.begin);
      const auto turn = value.numbers.find("T");
      if (turn != value.numbers.end()) target.posture = {turn->second};
      if (turn != value.numbers.end() && !turn->second.Whole()) {
        Refuse(value.begin, "its turn (T) is no whole number");
        return;
      }
    }
    const bool knows_tool = KnowsFrame(target.tool, target.line, program_);
    const bool knows_base = KnowsFrame(target.frame, target.line, program_);
    if (!knows_tool || !knows_base) return;
    program_->targets.push_back(target);
  }

  const KrlFrameReader frames_;
  std::vector<std::string> axes_;
  std::map<std::string, KrlFrames> point_frames_;
  std::vector<Variable> variables_;
  std::map<std::string, Uses> uses_;
};

}  // namespace

void ReadKrl(int num_joints, RobotProgram* program) {
  KrlReader(num_joints, program).Read();
}

}  // namespace alidade::internal
