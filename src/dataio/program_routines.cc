#include "src/dataio/program_routines.h"

#include <algorithm>
#include <iterator>
#include <set>
#include <tuple>

namespace alidade::internal {
namespace {

struct RoutineWords {
  std::set<std::string> before;  // "GLOBAL DEF"
  std::set<std::string> begin;
  std::set<std::string> end;
  std::set<std::string> blocks;  // that end with the same word
};

const RoutineWords& WordsOf(ProgramLanguage language) {
  static const RoutineWords kKrl = {
      {"GLOBAL"}, {"DEF", "DEFFCT"}, {"END", "ENDFCT"}, {}};
  static const RoutineWords kRapid = {{"LOCAL"},
                                      {"PROC", "FUNC", "TRAP"},
                                      {"ENDPROC", "ENDFUNC", "ENDTRAP"},
                                      {}};
  static const RoutineWords kUrScript = {
      {}, {"def", "thread", "sec"}, {"end"}, {"if", "while", "for"}};
  switch (language) {
    case ProgramLanguage::kKrl:
      return kKrl;
    case ProgramLanguage::kRapid:
      return kRapid;
    default:
      return kUrScript;
  }
}

// A routine that begins at `at` with `word`, to the end of the text.
ProgramRoutine RoutineFrom(const ProgramText& text, std::size_t at,
                           const std::string& word, const std::string& source) {
  const std::size_t open = text.text().find('(', at);
  std::size_t name = text.SkipSpaces(at + word.size());
  std::string name_text = text.WordAt(name);
  if (open < text.LineEnd(at)) {
    const std::size_t end = text.SkipSpacesBack(open);
    name_text = text.WordBefore(end);
    name = end - name_text.size();
  }
  ProgramRoutine routine;
  routine.name = name_text;
  routine.title = word + " " + source.substr(name, name_text.size());
  routine.first_line = text.LineOf(at);
  routine.last_line = text.LineOf(text.size());
  return routine;
}

// Whether a routine's name at `at` calls it.
bool IsCall(const ProgramText& text, const std::string& name, std::size_t at,
            ProgramLanguage language) {
  if (text.at(text.SkipSpaces(at + name.size())) == '(') return true;
  if (language != ProgramLanguage::kRapid) return false;
  const std::size_t before = text.SkipSpacesBack(at);
  if (before == 0 || text.at(before - 1) == '\n' ||
      text.at(before - 1) == ';') {
    return true;
  }
  const std::string word = text.WordBefore(before);
  return word == "THEN" || word == "ELSE" || word == "DO";
}

class RoutineReader {
 public:
  RoutineReader(const ProgramText& text, RobotProgram* program)
      : text_(text), program_(program) {}

  void Read() {
    FindRoutines();
    for (const ProgramTarget& target : program_->targets) {
      motions_.insert(target.uses.begin(), target.uses.end());
    }
    for (const ProgramNote& note : program_->left) {
      if (note.kind != Uncorrected::kNoMotion) motions_.insert(note.line);
    }
    FindCalls();
    for (std::size_t k = 0; k < routines().size(); ++k) {
      const ProgramRoutine& routine = routines()[k];
      if (!Moves(routine)) continue;
      Break(routine.first_line, "begins " + routine.title);
      if (is_nested_[k]) Break(routine.last_line, "ends " + routine.title);
    }
    std::stable_sort(program_->breaks.begin(), program_->breaks.end(),
                     [](const ProgramNote& a, const ProgramNote& b) {
                       return a.line < b.line;
                     });
  }

 private:
  std::vector<ProgramRoutine>& routines() const { return program_->routines; }

  void Break(int line, const std::string& why) {
    program_->breaks.push_back({line, why, Uncorrected::kMotion});
  }

  void FindRoutines() {
    const RoutineWords& words = WordsOf(program_->language);
    constexpr std::size_t kBlock = kNowhere;
    std::vector<std::size_t> open;  // routines, and blocks in them
    for (std::size_t start = 0; start < text_.size();
         start = text_.LineEnd(start) + 1) {
      std::size_t at = text_.SkipSpaces(start);
      std::string word = text_.WordAt(at);
      if (words.before.count(word) > 0) {
        at = text_.SkipSpaces(at + word.size());
        word = text_.WordAt(at);
      }
      if (words.begin.count(word) > 0) {
        is_nested_.push_back(!open.empty());
        open.push_back(routines().size());
        routines().push_back(RoutineFrom(text_, at, word, program_->text));
      } else if (words.blocks.count(word) > 0) {
        open.push_back(kBlock);
      } else if (words.end.count(word) > 0 && !open.empty()) {
        if (open.back() != kBlock) {
          routines()[open.back()].last_line = text_.LineOf(at);
        }
        open.pop_back();
      }
    }
  }

  bool Moves(const ProgramRoutine& routine) const {
    const auto motion = motions_.lower_bound(routine.first_line);
    return motion != motions_.end() && *motion <= routine.last_line;
  }

  // Of routines that move; a call of one is a motion of the one that calls.
  void FindCalls() {
    std::vector<bool> is_done(routines().size(), false);
    for (bool is_new = true; is_new;) {
      is_new = false;
      for (std::size_t k = 0; k < routines().size(); ++k) {
        if (is_done[k] || !Moves(routines()[k])) continue;
        is_done[k] = is_new = true;
        FindCallsOf(routines()[k]);
      }
    }
  }

  void FindCallsOf(const ProgramRoutine& routine) {
    if (routine.name.empty()) return;
    for (std::size_t at = 0;
         (at = text_.FindWord(routine.name, at)) != kNowhere; ++at) {
      const int line = text_.LineOf(at);
      const bool is_head = std::any_of(
          routines().begin(), routines().end(),
          [&](const ProgramRoutine& one) { return one.first_line == line; });
      if (is_head || !IsCall(text_, routine.name, at, program_->language)) {
        continue;
      }
      motions_.insert(line);
      Break(line, "calls " + routine.title);
    }
  }

  const ProgramText& text_;
  RobotProgram* const program_;
  std::vector<bool> is_nested_;
  std::set<int> motions_;  // their lines
};

}  // namespace

void ListRoutines(const ProgramText& text, RobotProgram* program) {
  RoutineReader(text, program).Read();
}

void ListBorrowedFrames(const std::vector<FrameSetting>& settings,
                        const std::set<std::string>& own,
                        RobotProgram* program) {
  std::set<std::tuple<std::string, int, const ProgramRoutine*>> known;
  for (const std::string kind : {"tool", "base"}) {
    std::map<int, const FrameSetting*> by_line;
    for (const FrameSetting& one : settings) {
      if (one.kind == kind) by_line[one.line] = &one;
    }
    for (const ProgramTarget& target : program->targets) {
      if (target.is_joints || own.count(target.name) > 0) continue;
      for (const int line : target.uses) {
        const auto after = by_line.upper_bound(line);
        if (after == by_line.begin()) continue;
        const FrameSetting& setting = *std::prev(after)->second;
        const ProgramRoutine* routine = RoutineAt(*program, line);
        const std::string& name = kind == "tool" ? target.tool : target.frame;
        if (routine == nullptr || setting.name != name ||
            RoutineAt(*program, setting.line) == routine ||
            !known.emplace(kind, setting.line, routine).second) {
          continue;
        }
        program->borrowed.push_back({kind, line, setting.line});
      }
    }
  }
}

}  // namespace alidade::internal
