#include <algorithm>
#include <filesystem>

#include "alidade/error.h"
#include "src/common/characters.h"
#include "src/common/files.h"
#include "src/dataio/program_text.h"
#include "src/dataio/robot_program.h"

namespace alidade::internal {
namespace {

// Where a bracket is missing, a position runs into the next.
void RefuseSharedNumbers(RobotProgram* program) {
  struct Use {
    std::size_t begin;
    std::size_t end;
    int line;
  };
  std::vector<Use> uses;
  for (const ProgramTarget& target : program->targets) {
    for (const auto* spans : {&target.numbers, &target.posture}) {
      for (const NumberSpan& span : *spans) {
        uses.push_back({span.begin, span.end, target.line});
      }
    }
  }
  std::sort(uses.begin(), uses.end(),
            [](const Use& a, const Use& b) { return a.begin < b.begin; });
  for (std::size_t i = 1; i < uses.size(); ++i) {
    if (uses[i].begin >= uses[i - 1].end) continue;
    program->refused.push_back(
        {uses[i].line, "shares its numbers with another position"});
    return;
  }
}

// A rotation vector, for one, whose square no number holds.
void RefuseEndlessPoses(RobotProgram* program) {
  const auto is_finite = [&](const std::string& name) {
    const auto frame = program->frames.find(name);
    return frame == program->frames.end() || frame->second.matrix().allFinite();
  };
  const auto is_endless = [&](const ProgramTarget& target) {
    if (target.is_joints ||
        (is_finite(target.tool) && is_finite(target.frame) &&
         PoseOf(program->language, target).matrix().allFinite())) {
      return false;
    }
    program->refused.push_back(
        {target.line,
         "a position, tool or base of numbers that are too large"});
    return true;
  };
  std::vector<ProgramTarget>& targets = program->targets;
  targets.erase(std::remove_if(targets.begin(), targets.end(), is_endless),
                targets.end());
}

// The first note of a line says enough; its kind is that of all of them.
void MergeNotes(std::vector<ProgramNote>* notes) {
  std::vector<ProgramNote> merged;
  for (const ProgramNote& note : *notes) {
    if (merged.empty() || merged.back().line != note.line) {
      merged.push_back(note);
    } else {
      merged.back().kind = std::max(merged.back().kind, note.kind);
    }
  }
  *notes = merged;
}

}  // namespace

std::string DeclarationsBeside(const std::string& path) {
  std::filesystem::path beside = path;
  const std::string ending = beside.extension().string();
  if (LowerCase(ending) != ".src") return "";
  const bool is_upper = ending == ".SRC";
  for (const char* declarations :
       {is_upper ? ".DAT" : ".dat", is_upper ? ".dat" : ".DAT", ".Dat"}) {
    beside.replace_extension(declarations);
    const auto status = std::filesystem::symlink_status(beside);
    if (!std::filesystem::exists(status)) continue;
    if (!std::filesystem::is_regular_file(beside)) {
      throw InputError({beside.string(), 0, 0, ""},
                       "expected a file, that of the declarations of " + path);
    }
    return beside.string();
  }
  return "";
}

std::pair<std::string, int> PlaceOf(const RobotProgram& program, int line) {
  const ProgramFile* file = &program.files.front();
  for (const ProgramFile& other : program.files) {
    if (other.first_line <= line) file = &other;
  }
  return {file->path, line - file->first_line + 1};
}

std::string LineName(const RobotProgram& program, int line) {
  const auto [path, number] = PlaceOf(program, line);
  std::string name = "line " + std::to_string(number);
  if (path == program.path) return name;
  return std::filesystem::path(path).filename().string() + " " + name;
}

const ProgramRoutine* RoutineAt(const RobotProgram& program, int line) {
  const ProgramRoutine* innermost = nullptr;
  for (const ProgramRoutine& routine : program.routines) {
    if (routine.first_line > line) break;
    if (routine.last_line >= line) innermost = &routine;
  }
  return innermost;
}

RobotProgram ReadProgram(
    const std::string& path, int num_joints,
    const std::map<std::string, Eigen::Isometry3d>& frames) {
  const std::string beside = DeclarationsBeside(path);
  std::optional<std::pair<std::string, std::string>> declarations;
  if (!beside.empty()) declarations.emplace(beside, ReadFile(beside));
  return ParseProgram(ReadFile(path), path, num_joints, frames, declarations);
}

RobotProgram ParseProgram(
    const std::string& text, const std::string& path, int num_joints,
    const std::map<std::string, Eigen::Isometry3d>& frames,
    const std::optional<std::pair<std::string, std::string>>& declarations) {
  RobotProgram program;
  program.path = path;
  if (declarations) {
    program.files.push_back({declarations->first});
    program.text = declarations->second + "\n";
  }
  const auto first_line =
      1 + std::count(program.text.begin(), program.text.end(), '\n');
  program.files.push_back(
      {path, program.text.size(), static_cast<int>(first_line)});
  program.text += text;
  program.language = *ProgramLanguageOf(path);
  program.frames = frames;
  switch (program.language) {
    case ProgramLanguage::kUrScript:
      ReadUrScript(num_joints, &program);
      break;
    case ProgramLanguage::kKrl:
      ReadKrl(num_joints, &program);
      break;
    case ProgramLanguage::kRapid:
      ReadRapid(num_joints, &program);
      break;
    case ProgramLanguage::kFanuc:
      ReadFanuc(num_joints, &program);
      break;
  }
  RefuseSharedNumbers(&program);
  RefuseEndlessPoses(&program);
  const auto by_line = [](const ProgramNote& a, const ProgramNote& b) {
    return a.line < b.line;
  };
  std::stable_sort(program.left.begin(), program.left.end(), by_line);
  MergeNotes(&program.left);
  std::stable_sort(program.refused.begin(), program.refused.end(), by_line);
  for (auto* frames_of : {&program.unstated, &program.missing}) {
    for (auto& [name, lines] : *frames_of) {
      std::sort(lines.begin(), lines.end());
    }
  }
  return program;
}

}  // namespace alidade::internal
