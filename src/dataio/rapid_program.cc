// ABB RAPID: robtarget [[x,y,z],[q1,q2,q3,q4],[cf1,cf4,cf6,cfx],[eax_a ...
// eax_f]] in mm, jointtarget [[rax_1 ... rax_6],[eax_a ... eax_f]] in deg.

#include <algorithm>
#include <cctype>
#include <cmath>
#include <initializer_list>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "src/common/characters.h"
#include "src/dataio/program_routines.h"
#include "src/dataio/program_text.h"

namespace alidade::internal {
namespace {

// What RAPID calls an external axis that is not there.
constexpr double kNoAxis = 8e9;

using Lists = std::vector<std::vector<NumberSpan>>;

// Tool and work object of a motion.
using Frames = std::pair<std::string, std::string>;

// A robtarget or jointtarget in numbers.
struct Literal {
  std::size_t begin = 0;
  std::size_t end = 0;
  Lists lists;
  bool is_joints() const { return lists.size() == 2; }
};

class RapidReader : ProgramReader {
 public:
  RapidReader(int num_joints, RobotProgram* program)
      : ProgramReader("!", '"', false, program),
        num_joints_(static_cast<std::size_t>(num_joints)) {}

  void Read() {
    ReadFrames("TOOLDATA", "TRUE", 1);
    ReadFrames("WOBJDATA", "FALSE", 2);
    for (std::size_t at = 0; (at = text_.text().find('[', at)) != kNowhere;
         ++at) {
      // Of an array of targets the elements come next.
      if (const auto literal = LiteralAt(at)) ReadLiteral(*literal);
    }
    for (const auto& [name, literals] : variables_) {
      ReadVariable(name, literals);
    }
    ListMoves();
    SortTargets();
    ListRoutines(text_, program_);
  }

 private:
  std::size_t SkipWhite(std::size_t at) const {
    while (at < text_.size() &&
           std::isspace(static_cast<unsigned char>(text_.at(at))) != 0) {
      ++at;
    }
    return at;
  }

  // [[...],[...]] of so many lists of numbers.
  std::optional<Lists> ListsAt(std::size_t at, std::size_t count,
                               std::size_t* end) const {
    Lists lists;
    std::size_t next = SkipWhite(at + 1);
    while (lists.size() < count) {
      std::size_t after = 0;
      const auto list = text_.ListAt(next, &after);
      if (!list) return std::nullopt;
      lists.push_back(*list);
      next = SkipWhite(after);
      if (lists.size() < count) {
        if (text_.at(next) != ',') return std::nullopt;
        next = SkipWhite(next + 1);
      }
    }
    if (text_.at(next) != ']') return std::nullopt;
    *end = next + 1;
    return lists;
  }

  std::optional<Literal> LiteralAt(std::size_t at) const {
    Literal literal;
    literal.begin = at;
    const auto sizes = [](const Lists& lists) {
      std::vector<std::size_t> all;
      for (const auto& list : lists) all.push_back(list.size());
      return all;
    };
    using Sizes = std::vector<std::size_t>;
    auto lists = ListsAt(at, 4, &literal.end);
    if (lists && sizes(*lists) == Sizes{3, 4, 4, 6}) {
      literal.lists = *lists;
      return literal;
    }
    lists = ListsAt(at, 2, &literal.end);
    if (lists && sizes(*lists) == Sizes{6, 6}) {
      literal.lists = *lists;
      return literal;
    }
    return std::nullopt;
  }

  static Eigen::Isometry3d FrameOf(const Lists& lists) {
    ProgramTarget frame;
    for (const auto& list : lists) {
      frame.numbers.insert(frame.numbers.end(), list.begin(), list.end());
    }
    return PoseOf(ProgramLanguage::kRapid, frame);
  }

  std::size_t StatementEnd(std::size_t at) const {
    return std::min(text_.text().find(';', at), text_.size());
  }

  // Behind the last semicolon or, as PROC and IF have none, at the line, unless
  // the line before is not complete.
  std::size_t StatementStart(std::size_t at) const {
    std::size_t start = at;
    for (std::size_t p = at; p > 0 && text_.at(p - 1) != ';'; --p) {
      const char c = text_.at(p - 1);
      if (c == '\n') {
        const std::size_t end = text_.SkipSpacesBack(p - 1);
        const char last = end > 0 ? text_.at(end - 1) : ' ';
        const bool goes_on = last == '=' || last == ',' || last == '[';
        if (!goes_on) break;
      }
      start = p - 1;
    }
    return SkipWhite(start);
  }

  // The motion of the statement that has `at`: behind the condition of an IF in
  // one line.
  std::size_t MotionStart(std::size_t at) const {
    const std::size_t start = StatementStart(at);
    if (text_.WordAt(start) != "IF") return start;
    for (std::size_t p = start; p < at; ++p) {
      const std::string word = text_.WordAt(p);
      if (IsMove(word)) return p;
      p += word.size();
    }
    return start;
  }

  // Lines and arcs, and motions to what is not stated in numbers here.
  void ListMoves() {
    for (std::size_t at = 0; at < text_.size(); ++at) {
      const std::string word = text_.WordAt(at);
      if (word.empty()) continue;
      if (IsMove(word) && MotionStart(at + word.size()) == at) {
        ListMove(at, word);
      }
      at += word.size() - 1;
    }
  }

  void ListMove(std::size_t at, const std::string& motion) {
    const bool is_arc = motion.rfind("MOVEC", 0) == 0 || motion == "TRIGGC" ||
                        motion == "SEARCHC";
    if (is_arc || motion.rfind("MOVEL", 0) == 0 || motion == "TRIGGL" ||
        motion == "SEARCHL") {
      AddStraight(at);
    }
    const std::size_t end = StatementEnd(at);
    std::size_t next = SkipWhite(at + motion.size());
    // A search names its signal first; switches go before.
    int skipped = motion.front() == 'S' ? 1 : 0;
    for (int left = is_arc ? 2 : 1; left > 0 && next < end;) {
      const bool is_switch = text_.at(next) == '\\';
      if (!is_switch && skipped-- <= 0) {
        CheckEnd(at, next);
        --left;
      }
      next = SkipWhite(std::min(ArgumentEnd(next, end), end) + 1);
    }
  }

  // The comma behind an argument.
  std::size_t ArgumentEnd(std::size_t at, std::size_t end) const {
    int depth = 0;
    for (; at < end; ++at) {
      const char c = text_.at(at);
      if (c == '(' || c == '[') ++depth;
      if (c == ')' || c == ']') --depth;
      if (c == ',' && depth == 0) return at;
    }
    return end;
  }

  // Of a motion at `at`, whose end stands at `place`.
  void CheckEnd(std::size_t at, std::size_t place) {
    std::string name = text_.WordAt(place);
    if (name == "OFFS" || name == "RELTOOL") {
      const std::size_t open = SkipWhite(place + name.size());
      name = text_.WordAt(SkipWhite(open + 1));
    }
    if (name.empty() || variables_.count(name) > 0) return;
    Leave(at, "moves to " + name + ", which is not stated in this file",
          Uncorrected::kMotion);
  }

  // tooldata NAME:=[TRUE,[[x,y,z],[q]],...], and wobjdata with two frames, one
  // in the other; `holds` is what their first entry must be.
  void ReadFrames(const std::string& type, const std::string& holds,
                  std::size_t count) {
    for (std::size_t at = 0; (at = text_.FindWord(type, at)) != kNowhere;
         at += type.size()) {
      const std::string name = text_.WordAt(SkipWhite(at + type.size()));
      const std::size_t end = StatementEnd(at);
      const std::size_t open = text_.text().find('[', at);
      if (name.empty() || open >= end) continue;
      if (text_.WordAt(SkipWhite(open + 1)) != holds) {
        moving_[Key(name)] = type == "TOOLDATA"
                                 ? "is a tool that the robot does not hold"
                                 : "is held by the robot";
        continue;
      }
      if (type == "WOBJDATA" && !IsFixed(open, end)) {
        moving_[Key(name)] = "is moved by a mechanical unit";
        continue;
      }
      RefuseChanges(name);
      Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
      std::size_t found = 0;
      for (std::size_t next = open + 1; found < count && next < end; ++next) {
        next = text_.text().find("[[", next);
        if (next >= end) break;
        std::size_t after = 0;
        const auto lists = ListsAt(next, 2, &after);
        if (!lists || (*lists)[0].size() != 3 || (*lists)[1].size() != 4) {
          break;
        }
        frame = frame * FrameOf(*lists);
        ++found;
        next = after;
      }
      if (found == count) program_->frames[Key(name)] = frame;
    }
  }

  // wobjdata: [robhold, ufprog, ...]; ufprog is FALSE where a mechanical unit
  // moves the user frame.
  bool IsFixed(std::size_t open, std::size_t end) const {
    const std::size_t comma = text_.text().find(',', open);
    return comma < end && text_.WordAt(SkipWhite(comma + 1)) != "FALSE";
  }

  // A tool or work object that is given other values, whole or in parts.
  void RefuseChanges(const std::string& name) {
    for (std::size_t at = 0; (at = text_.FindWord(name, at)) != kNowhere;
         at += name.size()) {
      if (StatementStart(at) != at) continue;
      const std::size_t assigns = text_.text().find(":=", at);
      if (assigns >= StatementEnd(at)) continue;
      Refuse(at, LowerCase(name) + " is changed at run time");
    }
  }

  // RAPID makes no difference between small and capital letters.
  static std::string Key(std::string name) {
    name = LowerCase(std::move(name));
    return name == "tool0" || name == "wobj0" ? "" : name;
  }

  static bool IsMove(const std::string& word) {
    return (word.rfind("MOVE", 0) == 0 && word.size() > 4) ||
           IsOneOf(word, {"TRIGGL", "TRIGGJ", "TRIGGC", "SEARCHL", "SEARCHC"});
  }

  static bool IsOneOf(const std::string& word,
                      std::initializer_list<const char*> words) {
    return std::find(words.begin(), words.end(), word) != words.end();
  }

  // MoveLDO and its like go on with a signal and its value, MoveLSync with a
  // procedure.
  static int ArgumentsAfterTool(const std::string& motion) {
    const std::string end =
        motion.size() > 5 ? motion.substr(motion.size() - 2) : "";
    if (IsOneOf(end, {"DO", "AO", "GO"})) return 2;
    return end == "NC" ? 1 : 0;
  }

  // "..., tool1\WObj:=wobj1" of the motion that has a target at `at`.
  Frames FramesOf(std::size_t at) const {
    const std::size_t end = StatementEnd(at);
    const std::string motion = text_.WordAt(MotionStart(at));
    std::size_t comma = end;
    for (int skipped = ArgumentsAfterTool(motion); skipped >= 0; --skipped) {
      comma = text_.text().rfind(',', comma - 1);
      if (comma == kNowhere || comma < at) return {"?", "?"};
    }
    Frames frames = {Key(text_.WordAt(SkipWhite(comma + 1))), ""};
    const std::size_t object =
        at +
        std::min(
            std::string_view(text_.text()).substr(at, end - at).find("\\WOBJ"),
            end - at);
    if (object < end) {
      const std::size_t equals = text_.text().find('=', object);
      frames.second = Key(text_.WordAt(SkipWhite(equals + 1)));
      // Optional arguments may stand before the last comma of the tool.
      if (object < comma) return {"?", "?"};
    }
    return frames;
  }

  void ReadLiteral(const Literal& literal) {
    const std::size_t start = MotionStart(literal.begin);
    const std::string first = text_.WordAt(start);
    const std::string before =
        text_.text().substr(start, literal.begin - start);
    if (IsMove(first)) {
      if (before.find('(') == kNowhere) {
        AddTarget(literal, "", FramesOf(literal.end));
      } else {
        Leave(literal.begin, "a position is computed at run time",
              Uncorrected::kMotion);
      }
      return;
    }
    const std::size_t assigns = before.find(":=");
    if (assigns == kNowhere || before.find('(') != kNowhere) {
      Leave(literal.begin, "a position in an expression");
      return;
    }
    std::string name = before.substr(0, assigns);
    name.erase(name.find_last_not_of(" \t") + 1);
    const std::size_t brace = name.find('{');
    if (brace != kNowhere) name.erase(brace);
    name.erase(name.find_last_not_of(" \t") + 1);
    name.erase(0, name.find_last_of(" \t") + 1);
    if (!IsName(name)) {
      Leave(literal.begin, "is given to no variable");
      return;
    }
    variables_[name].push_back(literal);
  }

  // Whether ":= ..." follows that is no literal.
  bool IsComputed(std::size_t at) const {
    const std::size_t assigns = SkipWhite(at);
    return text_.at(assigns) == ':' && text_.at(assigns + 1) == '=' &&
           text_.at(SkipWhite(assigns + 2)) != '[';
  }

  void ReadVariable(const std::string& name,
                    const std::vector<Literal>& literals) {
    std::set<Frames> frames;
    std::size_t computed = kNowhere;
    const bool is_joints = literals.front().is_joints();
    for (std::size_t at = 0; (at = text_.FindWord(name, at)) != kNowhere;
         at += name.size()) {
      const std::size_t start = MotionStart(at);
      if (!IsMove(text_.WordAt(start))) {
        if (start == at && IsComputed(at + name.size())) computed = at;
        if (text_.at(at + name.size()) == '.') {
          Refuse(at, name + " is changed or read in parts at run time");
          return;
        }
        continue;
      }
      if (text_.text().substr(start, at - start).find('(') != kNowhere) {
        Leave(at, "moves relative to " + name + ", as it is corrected",
              Uncorrected::kRelativeMotion);
      }
      frames.insert(FramesOf(at));
    }
    const std::size_t begin = literals.front().begin;
    if (frames.empty()) {
      Leave(begin, name + " is not moved to in this file");
      return;
    }
    if (computed != kNowhere) {
      Refuse(computed, name + " is moved to and also set at run time");
      return;
    }
    if (frames.size() > 1 && !is_joints) {
      Refuse(begin, name + " is moved to with several tools or work objects");
      return;
    }
    for (const Literal& literal : literals) {
      AddTarget(literal, name, is_joints ? Frames() : *frames.begin());
    }
  }

  void AddTarget(const Literal& literal, const std::string& name,
                 const Frames& frames) {
    for (const NumberSpan& axis : literal.lists.back()) {
      if (axis.value == 0.0 || axis.value > kNoAxis) continue;
      Refuse(literal.begin,
             "has an external axis, which the arm file does not know");
      return;
    }
    ProgramTarget target;
    target.is_joints = literal.is_joints();
    target.line = text_.LineOf(literal.begin);
    target.name = name;
    target.numbers = literal.lists[0];
    if (target.is_joints) {
      if (num_joints_ != target.numbers.size()) {
        Refuse(literal.begin, "has six joints, the arm has others");
        return;
      }
    } else {
      const auto& turn = literal.lists[1];
      target.numbers.insert(target.numbers.end(), turn.begin(), turn.end());
      target.posture = {literal.lists[2].begin(), literal.lists[2].begin() + 3};
      target.branch = literal.lists[2][3].Whole();
      for (const NumberSpan& quarter : target.posture) {
        if (quarter.Whole()) continue;
        Refuse(literal.begin, "its configuration is not of whole numbers");
        return;
      }
      target.tool = frames.first;
      target.frame = frames.second;
      for (const std::string& frame : {frames.first, frames.second}) {
        const auto moving = moving_.find(frame);
        if (moving == moving_.end()) continue;
        Refuse(literal.begin, "its " + frame + " " + moving->second);
        return;
      }
      const bool knows_tool = KnowsFrame(target.tool, target.line, program_);
      const bool knows_base = KnowsFrame(target.frame, target.line, program_);
      if (!knows_tool || !knows_base) return;
      double norm = 0.0;
      for (const NumberSpan& q : turn) norm += q.value * q.value;
      if (std::abs(norm - 1.0) > 1e-2) {
        Refuse(literal.begin, "its quaternion is not of length 1");
        return;
      }
    }
    program_->targets.push_back(target);
  }

  const std::size_t num_joints_;
  std::map<std::string, std::vector<Literal>> variables_;
  std::map<std::string, std::string> moving_;  // frames, and how
};

}  // namespace

void ReadRapid(int num_joints, RobotProgram* program) {
  RapidReader(num_joints, program).Read();
}

}  // namespace alidade::internal
