// Fanuc TP programs as text (.ls): P[1]{ GP1: UF : 0, UT : 1, CONFIG : '...',
// X = 1.000 mm, ... W = 0.000 deg, ... }; or J1 = 0.000 deg, ....

#include <algorithm>
#include <cctype>
#include <cstring>
#include <map>
#include <string_view>
#include <utility>

#include "src/dataio/program_text.h"

namespace alidade::internal {
namespace {

class FanucReader : ProgramReader {
 public:
  FanucReader(int num_joints, RobotProgram* program)
      : ProgramReader("//", '"', false, program) {
    for (int j = 1; j <= num_joints; ++j) {
      axes_.push_back("J" + std::to_string(j));
    }
  }

  void Read() {
    const std::size_t positions = text_.text().find("/POS");
    ListComputed(std::min(positions, text_.size()));
    ListChosen(std::min(positions, text_.size()));
    ListLineMotions(std::min(positions, text_.size()));
    if (positions == kNowhere) return;
    for (std::size_t at = positions;
         (at = text_.text().find("P[", at)) != kNowhere; ++at) {
      if (at > 0 && IsWordCharacter(text_.at(at - 1))) continue;
      const std::size_t open = text_.text().find('{', at);
      if (open >= text_.LineEnd(at)) continue;
      const std::size_t close =
          std::min(text_.text().find('}', open), text_.size());
      ReadPosition(at, open, close);
    }
    auto uses = UsesAbove(positions);
    for (ProgramTarget& target : program_->targets) {
      // Of a position that is stated twice, the first is used.
      const auto lines =
          uses.extract(target.name.substr(0, target.name.find_first_of(":]")));
      target.uses = lines.empty() ? std::vector<int>{target.line}
                                  : std::move(lines.mapped());
    }
  }

 private:
  // Positions stand behind the motions that name them, "P[1]" or "P[1:home]":
  // the lines that have each "P[1".
  std::map<std::string, std::vector<int>> UsesAbove(std::size_t end) const {
    std::map<std::string, std::vector<int>> uses;
    for (std::size_t at = 0; (at = text_.text().find("P[", at)) < end; ++at) {
      if (at > 0 && IsWordCharacter(text_.at(at - 1))) continue;
      const std::string_view line =
          std::string_view(text_.text()).substr(at, text_.LineEnd(at) - at);
      const std::size_t name_end = line.find_first_of(":]");
      if (name_end == kNowhere) continue;
      uses[std::string(line.substr(0, name_end))].push_back(text_.LineOf(at));
    }
    return uses;
  }

  // Motions that move by what registers hold.
  void ListComputed(std::size_t end) {
    for (const auto& [word, why] :
         {std::pair<const char*, const char*>{
              "OFFSET", "moves to a position plus an offset at run time"},
          {"VOFFSET", "moves to a position plus an offset at run time"},
          {"TOOL_OFFSET", "moves to a position plus an offset at run time"},
          {"INC", "moves relative to where the robot is"},
          {"PR", "uses a position register"}}) {
      int last = 0;
      for (std::size_t at = 0; (at = text_.FindWord(word, at)) < end; ++at) {
        const int line = text_.LineOf(at);
        if (line != last) Leave(at, why, KindOf(at, word));
        last = line;
      }
    }
  }

  // "L P[R[5]] ...": which position, a register says.
  void ListChosen(std::size_t end) {
    for (std::size_t at = 0; (at = text_.text().find("P[", at)) < end; ++at) {
      if (MotionOf(at) == ' ' || text_.NumberAt(at + 2) ||
          std::isdigit(static_cast<unsigned char>(text_.at(at + 2))) != 0 ||
          (at > 0 && IsWordCharacter(text_.at(at - 1)))) {
        continue;
      }
      Leave(at, "moves to a position that a register chooses",
            Uncorrected::kMotion);
    }
  }

  // The J, L, C or A of "3:L P[2] 100mm/sec ..."; nothing of other lines.
  char MotionOf(std::size_t at) const {
    const std::size_t colon = text_.text().find(':', text_.LineStart(at));
    if (colon >= text_.LineEnd(at)) return ' ';
    const std::string word = text_.WordAt(text_.SkipSpaces(colon + 1));
    const bool is_motion = word.size() == 1 && std::strchr("JLCA", word[0]);
    return is_motion ? word[0] : ' ';
  }

  Uncorrected KindOf(std::size_t at, const std::string& word) const {
    if (MotionOf(at) == ' ') return Uncorrected::kNoMotion;
    const std::string_view line =
        std::string_view(text_.text())
            .substr(text_.LineStart(at), at - text_.LineStart(at));
    // "L P[1] 100mm/sec FINE Offset,PR[2]" names its register, too.
    const bool is_register =
        word == "PR" && line.find(" P[") == std::string_view::npos;
    return is_register ? Uncorrected::kMotion : Uncorrected::kRelativeMotion;
  }

  void ListLineMotions(std::size_t end) {
    for (std::size_t start = 0; start < end; start = text_.LineEnd(start) + 1) {
      const char motion = MotionOf(start);
      if (motion != ' ' && motion != 'J') AddStraight(start);
    }
  }

  // The number behind "NAME =" or "NAME :" between two places.
  std::optional<NumberSpan> Entry(const std::string& name, std::size_t from,
                                  std::size_t to) const {
    for (std::size_t at = from; (at = text_.FindWord(name, at)) < to; ++at) {
      const std::size_t sign = text_.SkipSpaces(at + name.size());
      if (text_.at(sign) != '=' && text_.at(sign) != ':') continue;
      return text_.NumberAt(text_.SkipSpaces(sign + 1));
    }
    return std::nullopt;
  }

  std::vector<NumberSpan> Entries(const std::vector<std::string>& names,
                                  std::size_t from, std::size_t to) const {
    std::vector<NumberSpan> spans;
    for (const std::string& name : names) {
      const auto span = Entry(name, from, to);
      if (span) spans.push_back(*span);
    }
    return spans;
  }

  void ReadPosition(std::size_t at, std::size_t open, std::size_t close) {
    const std::size_t group = text_.FindWord("GP1", open);
    const std::size_t other = text_.FindWord("GP2", open);
    if (group >= close) {
      Leave(at, "has no group 1");
      return;
    }
    if (other < close) Leave(other, "other groups than 1 are not touched");
    const std::size_t end = std::min(other, close);
    const std::vector<std::string> names = {"X", "Y", "Z", "W", "P", "R"};
    const auto pose = Entries(names, group, end);
    const auto joints = Entries(axes_, group, end);
    if (pose.empty() && joints.empty()) {
      Leave(at, "is not taught");
      return;
    }
    ProgramTarget target;
    target.is_joints = pose.empty();
    target.line = text_.LineOf(at);
    const std::size_t bracket = text_.text().find(']', at);
    target.name = program_->text.substr(at, bracket + 1 - at);
    target.numbers = target.is_joints ? joints : pose;
    const std::size_t wanted = target.is_joints ? axes_.size() : names.size();
    const bool has_extra =
        text_.FindWord("E1", group) < end ||
        text_.FindWord("J" + std::to_string(axes_.size() + 1), group) < end;
    if (target.numbers.size() != wanted || has_extra) {
      Refuse(at, has_extra ? "has more axes than the arm file"
                           : "states only some of its numbers");
      return;
    }
    if (!target.is_joints && !SetFrames(group, end, &target)) return;
    program_->targets.push_back(target);
  }

  bool SetFrames(std::size_t from, std::size_t to, ProgramTarget* target) {
    const auto frame = Entry("UF", from, to);
    const auto tool = Entry("UT", from, to);
    if (!frame || !tool || !frame->Whole() || !tool->Whole()) {
      Refuse(from, "uses the current frame or tool (F), expected numbers");
      return false;
    }
    const auto name = [](const char* kind, int index) {
      return index == 0 ? "" : kind + (" " + std::to_string(index));
    };
    target->frame = name("base", *frame->Whole());
    target->tool = name("tool", *tool->Whole());
    const bool knows_tool = KnowsFrame(target->tool, target->line, program_);
    return KnowsFrame(target->frame, target->line, program_) && knows_tool;
  }

  std::vector<std::string> axes_;
};

}  // namespace

void ReadFanuc(int num_joints, RobotProgram* program) {
  FanucReader(num_joints, program).Read();
}

}  // namespace alidade::internal
