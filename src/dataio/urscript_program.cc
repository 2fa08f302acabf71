// URScript: p[x, y, z, rx, ry, rz] in m and rad (rotation vector), joint lists
// in rad.

#include <algorithm>
#include <cctype>
#include <iterator>
#include <set>
#include <utility>

#include "src/dataio/program_routines.h"
#include "src/dataio/program_text.h"

namespace alidade::internal {
namespace {

// What a value is an argument of, or the variable that it is assigned to.
struct Use {
  std::string function;
  int argument = 0;
  std::string keyword;
  std::string variable;
};

// A position in numbers.
struct Literal {
  std::size_t begin = 0;
  bool is_pose = false;
  std::vector<NumberSpan> numbers;
};

class UrScriptReader : ProgramReader {
 public:
  UrScriptReader(int num_joints, RobotProgram* program)
      : ProgramReader("#", '"', true, program),
        num_joints_(static_cast<std::size_t>(num_joints)) {}

  void Read() {
    ReadTools();
    for (std::size_t at = 0; (at = text_.text().find('[', at)) != kNowhere;
         ++at) {
      ReadList(at);
    }
    for (const auto& [name, literals] : variables_) {
      ReadVariable(name, literals);
    }
    ListComputedMoves();
    for (const std::string word : {"movel", "movep", "movec", "optimovel"}) {
      for (std::size_t at = 0; (at = text_.FindWord(word, at)) != kNowhere;
           at += word.size()) {
        AddStraight(at);
      }
    }
    SortTargets();
    ListRoutines(text_, program_);
    std::vector<FrameSetting> settings;
    for (const auto& [at, name] : tools_) {
      settings.push_back({text_.LineOf(at), kUnstatedTool, name});
    }
    ListBorrowedFrames(settings, {}, program_);
  }

 private:
  // set_tcp(p[...]) is of what follows in the text.
  void ReadTools() {
    for (std::size_t at = 0; (at = text_.FindWord("set_tcp", at)) != kNowhere;
         ++at) {
      const std::size_t open = text_.SkipSpaces(at + 7);
      std::size_t list = text_.SkipSpaces(open + 1);
      std::string name = "?";
      std::size_t end = 0;
      if (text_.at(list) == 'p') {
        const auto numbers = text_.ListAt(list + 1, &end);
        if (numbers && numbers->size() == 6) {
          ProgramTarget frame;
          frame.numbers = *numbers;
          name = "set_tcp in line " + std::to_string(text_.LineOf(at));
          program_->frames[name] = PoseOf(ProgramLanguage::kUrScript, frame);
        }
      }
      tools_.emplace_back(at, name);
    }
  }

  std::string ToolAt(std::size_t at) const {
    const auto after = std::lower_bound(
        tools_.begin(), tools_.end(), at,
        [](const auto& tool, std::size_t place) { return tool.first < place; });
    return after == tools_.begin() ? kUnstatedTool : std::prev(after)->second;
  }

  void ReadList(std::size_t at) {
    const bool is_pose = at > 0 && text_.at(at - 1) == 'p' &&
                         (at < 2 || !IsWordCharacter(text_.at(at - 2)));
    // An element of a variable is no list.
    if (!is_pose && at > 0 &&
        (IsWordCharacter(text_.at(at - 1)) || text_.at(at - 1) == ']')) {
      return;
    }
    const std::size_t begin = is_pose ? at - 1 : at;
    std::size_t end = 0;
    const auto numbers = text_.ListAt(at, &end);
    const Use use = UseOf(begin);
    if (!numbers) {
      if (IsTarget(use, is_pose)) {
        Leave(at, "a position is computed at run time", Uncorrected::kMotion);
      }
      return;
    }
    if (numbers->size() != (is_pose ? 6 : num_joints_)) {
      if (IsTarget(use, is_pose)) {
        Refuse(at, "a position of " + std::to_string(numbers->size()) +
                       " numbers, expected " +
                       std::to_string(is_pose ? 6 : num_joints_));
      }
      return;
    }
    const Literal literal{begin, is_pose, *numbers};
    if (IsTarget(use, is_pose)) {
      AddTarget(literal, "", ToolAt(begin));
    } else if (!use.variable.empty()) {
      variables_[use.variable].push_back(literal);
    } else if (is_pose && use.function != "set_tcp") {
      Leave(at, use.function.empty() ? "a pose in an expression"
                                     : use.function + " computes with a pose");
    }
  }

  // What the value at `at` is given to, on its own line.
  Use UseOf(std::size_t at) const {
    Use use;
    int depth = 0;
    const std::size_t start = text_.LineStart(at);
    for (std::size_t p = at; p > start; --p) {
      const char c = text_.at(p - 1);
      if (c == ')' || c == ']') ++depth;
      if (c == '[') --depth;
      if (c == '(' && --depth < 0) {
        use.function = text_.WordBefore(text_.SkipSpacesBack(p - 1));
        return use;
      }
      if (depth == 0 && c == ',') ++use.argument;
      if (depth == 0 && c == '=' && use.argument == 0 && use.keyword.empty() &&
          text_.at(p) != '=') {
        use.keyword = text_.WordBefore(text_.SkipSpacesBack(p - 1));
      }
    }
    const std::size_t equals = text_.SkipSpacesBack(at);
    if (MayBeName(use.keyword) && text_.at(equals - 1) == '=') {
      use.variable = use.keyword;
    }
    return use;
  }

  static bool IsTarget(const Use& use, bool is_pose) {
    const auto is = [&](int argument, const char* keyword) {
      return use.keyword.empty() ? use.argument == argument
                                 : use.keyword == keyword;
    };
    const std::string& f = use.function;
    if (f == "movej" || f == "optimovej") {
      return is(0, is_pose ? "pose" : "q") || is(0, "q");
    }
    if (f == "movel" || f == "movep" || f == "optimovel") {
      return is(0, "pose") || is(0, "q");
    }
    if (f == "movec") return is(0, "pose_via") || is(1, "pose_to");
    if (f == "servoj") return !is_pose && is(0, "q");
    if (f == "servoc") return is(0, "pose");
    return f == "get_inverse_kin" && is_pose && is(0, "x");
  }

  void AddTarget(const Literal& literal, const std::string& name,
                 const std::string& tool) {
    ProgramTarget target;
    target.is_joints = !literal.is_pose;
    target.line = text_.LineOf(literal.begin);
    target.name = name;
    target.numbers = literal.numbers;
    target.tool = literal.is_pose ? FrameOrOwn(tool, literal.begin) : "";
    if (KnowsFrame(target.tool, target.line, program_)) {
      program_->targets.push_back(target);
    }
  }

  // A variable is corrected where all that is done with it is to move there.
  void ReadVariable(const std::string& name,
                    const std::vector<Literal>& literals) {
    std::set<std::string> tools;
    std::size_t other = kNowhere;
    bool is_target = false;
    const bool is_pose = literals.front().is_pose;
    for (std::size_t at = 0; (at = text_.FindWord(name, at)) != kNowhere;
         at += name.size()) {
      const std::size_t after = text_.SkipSpaces(at + name.size());
      const bool assigns = text_.at(after) == '=' && text_.at(after + 1) != '=';
      const Use use = UseOf(at);
      if (assigns && use.function.empty()) {
        if (!IsLiteral(text_.SkipSpaces(after + 1), literals)) other = at;
        continue;
      }
      if (assigns) continue;  // a keyword of that name
      if (text_.at(after) != '[' && IsTarget(use, is_pose)) {
        is_target = true;
        tools.insert(ToolAt(at));
      } else if (use.keyword != "qnear" &&
                 !(use.function == "get_inverse_kin" && use.argument == 1)) {
        other = at;
      }
    }
    if (!is_target) {
      if (is_pose) {
        Leave(literals.front().begin, name + " is not moved to as it is");
      }
      return;
    }
    if (other != kNowhere || tools.size() > 1) {
      Refuse(literals.front().begin,
             other != kNowhere
                 ? name + " is moved to and also used otherwise (line " +
                       std::to_string(text_.LineOf(other)) +
                       "): let a variable of its own, of the same numbers, be "
                       "used there"
                 : name +
                       " is moved to with several tools: give each a "
                       "variable of its own");
      return;
    }
    for (const Literal& literal : literals) {
      AddTarget(literal, name, *tools.begin());
    }
  }

  static bool IsLiteral(std::size_t at, const std::vector<Literal>& literals) {
    const auto found = std::lower_bound(
        literals.begin(), literals.end(), at,
        [](const Literal& l, std::size_t place) { return l.begin < place; });
    return found != literals.end() && found->begin == at;
  }

  // Moves to what is no number and no variable of numbers, or to nowhere.
  void ListComputedMoves() {
    for (const char* name : {"speedj", "speedl"}) {
      for (std::size_t at = 0; (at = text_.FindWord(name, at)) != kNowhere;
           ++at) {
        Leave(at, name + std::string(" moves by a speed, to no position"),
              Uncorrected::kMotion);
      }
    }
    for (const char* name : {"movej", "movel", "movep", "movec", "servoc",
                             "servoj", "optimovej", "optimovel"}) {
      const std::string word = name;
      for (std::size_t at = 0; (at = text_.FindWord(word, at)) != kNowhere;
           at += word.size()) {
        const std::size_t open = text_.SkipSpaces(at + word.size());
        if (text_.at(open) != '(') continue;
        std::size_t argument = open + 1;
        bool is_stated = IsStated(argument);
        if (word == "movec") {
          argument = ArgumentEnd(argument) + 1;
          is_stated = is_stated && IsStated(argument);
        }
        if (is_stated) continue;
        Leave(at, "moves to what is computed at run time",
              Uncorrected::kMotion);
      }
    }
  }

  // Whether the argument at a place is a list, or a variable of numbers.
  bool IsStated(std::size_t argument) const {
    argument = text_.SkipSpaces(argument);
    if (text_.WordAt(argument) == "get_inverse_kin") {
      argument = text_.SkipSpaces(text_.text().find('(', argument) + 1);
    }
    std::string first = text_.WordAt(argument);
    const std::size_t equals = text_.SkipSpaces(argument + first.size());
    if (!first.empty() && text_.at(equals) == '=') {
      argument = text_.SkipSpaces(equals + 1);
      first = text_.WordAt(argument);
    }
    return text_.at(argument) == '[' ||
           (first == "p" && text_.at(argument + 1) == '[') ||
           variables_.count(first) > 0;
  }

  // The comma or bracket behind an argument, or its line's end.
  std::size_t ArgumentEnd(std::size_t at) const {
    int depth = 0;
    for (; text_.at(at) != '\n'; ++at) {
      const char c = text_.at(at);
      if (c == '(' || c == '[') ++depth;
      if ((c == ')' || c == ']') && --depth < 0) break;
      if (c == ',' && depth == 0) break;
    }
    return at;
  }

  const std::size_t num_joints_;
  std::vector<std::pair<std::size_t, std::string>> tools_;
  std::map<std::string, std::vector<Literal>> variables_;
};

}  // namespace

void ReadUrScript(int num_joints, RobotProgram* program) {
  UrScriptReader(num_joints, program).Read();
}

}  // namespace alidade::internal
