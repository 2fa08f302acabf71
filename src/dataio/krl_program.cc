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

#include "src/dataio/program_routines.h"
#include "src/dataio/program_text.h"

namespace alidade::internal {
namespace {

bool IsMotion(const std::string& word) {
  static const std::set<std::string> kMotions = {"PTP",  "LIN",  "CIRC",
                                                 "SPTP", "SLIN", "SCIRC"};
  return kMotions.count(word) > 0;
}

// PTP_REL, LIN_REL and their like.
bool IsRelative(const std::string& word) {
  constexpr std::string_view kEnding = "_REL";
  return word.size() > kEnding.size() &&
         word.substr(word.size() - kEnding.size()) == kEnding &&
         IsMotion(word.substr(0, word.size() - kEnding.size()));
}

// {NAME value, NAME value, ...} as far as it holds numbers.
struct Aggregate {
  std::size_t begin = 0;
  std::map<std::string, NumberSpan> numbers;
  bool only_numbers = true;

  bool HasAll(const std::vector<std::string>& names) const {
    return std::all_of(names.begin(), names.end(), [&](const auto& name) {
      return numbers.count(name) > 0;
    });
  }
  bool HasAny(const std::vector<std::string>& names) const {
    return std::any_of(names.begin(), names.end(), [&](const auto& name) {
      return numbers.count(name) > 0;
    });
  }
  std::vector<NumberSpan> Of(const std::vector<std::string>& names) const {
    std::vector<NumberSpan> spans;
    for (const std::string& name : names) spans.push_back(numbers.at(name));
    return spans;
  }
};

// Tool and base that hold at a place of the text.
struct Frames {
  std::string tool = kUnstatedTool;
  std::string base = kUnstatedBase;
  bool operator<(const Frames& other) const {
    return std::tie(tool, base) < std::tie(other.tool, other.base);
  }
};

// A position that a variable holds.
struct Variable {
  std::string name;
  std::string type;  // E6POS, POS, FRAME, E6AXIS, AXIS; empty: not declared
  Aggregate value;
};

class KrlReader : ProgramReader {
 public:
  KrlReader(int num_joints, RobotProgram* program)
      : ProgramReader(";", '"', false, program) {
    for (int j = 1; j <= num_joints; ++j) {
      axes_.push_back("A" + std::to_string(j));
    }
  }

  void Read() {
    ReadNumberedFrames();
    ReadFrameChanges();
    for (std::size_t at = 0; (at = text_.text().find('{', at)) != kNowhere;
         ++at) {
      ReadAggregate(at);
    }
    for (const Variable& variable : variables_) ReadVariable(variable);
    ListOtherMoves(IsMotion, [this](const std::string& name) {
      return uses_.count(name) > 0;
    });
    ListRelativeMoves();
    ListStraight([](const std::string& word) {
      return IsMotion(word) && word.substr(word.size() - 3) != "PTP";
    });
    SortTargets();
    ListRoutines(text_, program_);
    std::set<std::string> own;
    for (const auto& [name, frames] : point_frames_) own.insert("X" + name);
    ListBorrowedFrames(Settings(), own, program_);
  }

 private:
  Aggregate Parse(std::size_t at) const {
    Aggregate aggregate;
    aggregate.begin = at;
    std::size_t next = text_.SkipSpaces(at + 1);
    // {FRAME: X 1, ...}
    const std::string type = text_.WordAt(next);
    if (text_.at(text_.SkipSpaces(next + type.size())) == ':') {
      next = text_.SkipSpaces(text_.SkipSpaces(next + type.size()) + 1);
    }
    while (text_.at(next) != '}') {
      const std::string name = text_.WordAt(next);
      const std::size_t value = text_.SkipSpaces(next + name.size());
      const auto number = text_.NumberAt(value);
      if (name.empty() || !number) {
        aggregate.only_numbers = false;
      } else {
        aggregate.numbers[name] = *number;
      }
      const std::size_t end =
          std::min(text_.text().find_first_of(",}\n", value), text_.size());
      if (text_.at(end) != ',') break;
      next = text_.SkipSpaces(end + 1);
    }
    return aggregate;
  }

  static std::vector<std::string> PoseNames() {
    return {"X", "Y", "Z", "A", "B", "C"};
  }

  static Eigen::Isometry3d FrameOf(const Aggregate& aggregate) {
    ProgramTarget frame;
    frame.numbers = aggregate.Of(PoseNames());
    return PoseOf(ProgramLanguage::kKrl, frame);
  }

  // "TOOL 1": the number in brackets or behind a comma at `at`.
  std::optional<int> Index(std::size_t at) const {
    const auto number = text_.NumberAt(text_.SkipSpaces(at));
    if (!number || number->decimals > 0) return std::nullopt;
    return number->Whole();
  }

  static std::string Numbered(const char* kind, int index) {
    return index == 0 ? "" : std::string(kind) + " " + std::to_string(index);
  }

  // TOOL_DATA[1]={...} and BASE_DATA[2]={...}.
  void ReadNumberedFrames() {
    for (const auto& [word, kind] :
         {std::pair<std::string, const char*>{"TOOL_DATA", "tool"},
          {"BASE_DATA", "base"}}) {
      for (std::size_t at = 0; (at = text_.FindWord(word, at)) != kNowhere;
           at += word.size()) {
        const auto index = Index(at + word.size() + 1);
        const std::size_t close = text_.text().find(']', at);
        if (!index || close == kNowhere) continue;
        const std::size_t equals = text_.SkipSpaces(close + 1);
        const std::size_t brace = text_.SkipSpaces(equals + 1);
        if (text_.at(equals) != '=' || text_.at(brace) != '{') continue;
        const Aggregate value = Parse(brace);
        if (!value.HasAll(PoseNames())) continue;
        program_->frames[Numbered(kind, *index)] = FrameOf(value);
      }
    }
  }

  // What $TOOL or $BASE is set to by the text from `at` on.
  std::string AssignedFrame(std::size_t at, const std::string& word,
                            const char* kind) {
    const std::string value = text_.WordAt(at);
    if (value == "$NULLFRAME" || value == "$WORLD" || value == "$ROBROOT") {
      return "";
    }
    if (value == word + "_DATA") {
      const auto index = Index(at + value.size() + 1);
      return index ? Numbered(kind, *index) : "?";
    }
    if (text_.at(at) != '{') return "?";
    const Aggregate aggregate = Parse(at);
    if (!aggregate.HasAll(PoseNames()) || !aggregate.only_numbers) return "?";
    std::string name = std::string("$") + word + " in line " +
                       std::to_string(text_.LineOf(at));
    program_->frames[name] = FrameOf(aggregate);
    return name;
  }

  // $TOOL = ..., BAS(#TOOL, 1): of the motions that follow in the text.
  void ReadFrameChanges() {
    for (std::size_t start = 0; start < text_.size();
         start = text_.LineEnd(start) + 1) {
      const std::size_t at = text_.SkipSpaces(start);
      const std::string word = text_.WordAt(at);
      if (word == "$TOOL" || word == "$BASE") {
        const std::size_t equals = text_.SkipSpaces(at + word.size());
        if (text_.at(equals) != '=') continue;
        const bool is_tool = word == "$TOOL";
        Change(at, is_tool,
               AssignedFrame(text_.SkipSpaces(equals + 1), word.substr(1),
                             is_tool ? "tool" : "base"));
      } else if (word == "BAS") {
        const std::size_t hash = text_.text().find('#', at);
        if (hash >= text_.LineEnd(at)) continue;
        const std::string what = text_.WordAt(hash + 1);
        if (what != "TOOL" && what != "BASE") continue;
        const std::size_t comma = text_.text().find(',', hash);
        const auto index =
            comma < text_.LineEnd(at) ? Index(comma + 1) : std::optional<int>();
        const bool is_tool = what == "TOOL";
        Change(at, is_tool,
               index ? Numbered(is_tool ? "tool" : "base", *index) : "?");
      }
    }
  }

  void Change(std::size_t at, bool is_tool, const std::string& name) {
    Frames frames = changes_.empty() ? Frames() : changes_.back().second;
    (is_tool ? frames.tool : frames.base) = name;
    changes_.emplace_back(at, frames);
  }

  std::vector<FrameSetting> Settings() const {
    std::vector<FrameSetting> settings;
    for (const auto& [at, frames] : changes_) {
      const std::string statement =
          text_.text().substr(at, text_.LineEnd(at) - at);
      const bool is_tool = statement.rfind("$TOOL", 0) == 0 ||
                           statement.find("#TOOL") != kNowhere;
      settings.push_back({text_.LineOf(at),
                          is_tool ? kUnstatedTool : kUnstatedBase,
                          is_tool ? frames.tool : frames.base});
    }
    return settings;
  }

  Frames FramesAt(std::size_t at) const {
    const auto after =
        std::lower_bound(changes_.begin(), changes_.end(), at,
                         [](const auto& change, std::size_t place) {
                           return change.first < place;
                         });
    return after == changes_.begin() ? Frames() : std::prev(after)->second;
  }

  // The statement up to the brace, from the start of its line.
  std::string Before(std::size_t brace) const {
    const std::size_t start = text_.SkipSpaces(text_.LineStart(brace));
    const std::size_t end = text_.SkipSpacesBack(brace);
    return end > start ? text_.text().substr(start, end - start) : "";
  }

  void ReadAggregate(std::size_t at) {
    const Aggregate aggregate = Parse(at);
    const std::string before = Before(at);
    if (aggregate.HasAll({"TOOL_NO", "BASE_NO"})) {
      KeepPointData(before, aggregate, at);
      return;
    }
    const bool is_axes = aggregate.HasAny(axes_) && !aggregate.HasAny({"X"});
    const auto& names = is_axes ? axes_ : PoseNames();
    if (!aggregate.HasAny(names)) return;
    const std::size_t word_begin = text_.SkipSpaces(text_.LineStart(at));
    const std::string first = text_.WordAt(word_begin);
    if (IsRelative(first)) return;
    if (IsMotion(first)) {
      ReadMotion(first, before, aggregate, is_axes);
      return;
    }
    if (before.empty() || before.back() != '=') return;
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
                  const Aggregate& aggregate, bool is_axes) {
    const bool is_arc = motion.back() == 'C';
    const char last = before.back();
    if (before != motion && !(is_arc && last == ',')) {
      Leave(aggregate.begin, "a position is computed at run time",
            Uncorrected::kMotion);
      return;
    }
    AddTarget(aggregate, is_axes, "", FramesAt(aggregate.begin));
  }

  // DECL FDAT FP1={TOOL_NO 1,BASE_NO 2,IPO_FRAME #BASE,...} goes with XP1.
  void KeepPointData(const std::string& before, const Aggregate& data,
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
        is_at_tool || !tool || !base
            ? Frames{"?", "?"}
            : Frames{Numbered("tool", *tool), Numbered("base", *base)};
  }

  void KeepVariable(std::string left, const Aggregate& value) {
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
    std::set<Frames> frames;
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
      if (text_.at(after) == '.' || text_.at(after) == ':' ||
          (at > 0 && text_.at(text_.SkipSpacesBack(at) - 1) == ':')) {
        uses.is_computed_with = true;
      } else if (IsMotion(first)) {
        uses.frames.insert(FramesAt(at));
      }
    }
    return uses;
  }

  // Whether $TOOL or $BASE are set before a motion, and not to `stated`.
  static bool IsSetOtherwise(const std::set<Frames>& at_motions,
                             const Frames& stated) {
    return std::any_of(
        at_motions.begin(), at_motions.end(), [&](const Frames& set) {
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
    std::set<Frames> frames = uses.frames;
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
    if (frames.empty() && is_point && !is_whole) frames = {FramesAt(begin)};
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

  void AddTarget(const Aggregate& value, bool is_axes, const std::string& name,
                 const Frames& frames) {
    const auto& names = is_axes ? axes_ : PoseNames();
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

  std::vector<std::string> axes_;
  std::vector<std::pair<std::size_t, Frames>> changes_;
  std::map<std::string, Frames> point_frames_;
  std::vector<Variable> variables_;
  std::map<std::string, Uses> uses_;
};

}  // namespace

void ReadKrl(int num_joints, RobotProgram* program) {
  KrlReader(num_joints, program).Read();
}

}  // namespace alidade::internal
