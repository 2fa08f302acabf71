#include <algorithm>

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

}  // namespace

RobotProgram ReadProgram(
    const std::string& path, int num_joints,
    const std::map<std::string, Eigen::Isometry3d>& frames) {
  return ParseProgram(ReadFile(path), path, num_joints, frames);
}

RobotProgram ParseProgram(
    const std::string& text, const std::string& path, int num_joints,
    const std::map<std::string, Eigen::Isometry3d>& frames) {
  RobotProgram program;
  program.path = path;
  program.text = text;
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
  // The first note of a line says enough.
  program.left.erase(
      std::unique(program.left.begin(), program.left.end(),
                  [](const ProgramNote& a, const ProgramNote& b) {
                    return a.line == b.line;
                  }),
      program.left.end());
  std::stable_sort(program.refused.begin(), program.refused.end(), by_line);
  for (auto& [kind, lines] : program.unstated) {
    std::sort(lines.begin(), lines.end());
  }
  return program;
}

}  // namespace alidade::internal
