#include "src/cli/targets.h"

#include <iostream>

#include "alidade/error.h"
#include "src/common/files.h"
#include "src/common/names.h"
#include "src/job/result_directory.h"

namespace alidade::internal {

std::optional<RotationConvention> RotationFlag(const CommandLine& line) {
  if (line.rotation.empty()) return std::nullopt;
  const auto convention = FindRotationConvention(line.rotation);
  if (convention) return convention;
  throw InputError({}, "--rotation: " + UnknownName("convention", line.rotation,
                                                    RotationConventionNames()));
}

int TargetFlag(const CommandLine& line, const Arm& arm) {
  if (line.target.empty()) return 0;
  std::vector<std::string> names;
  for (int i = 0; i < arm.num_targets(); ++i) {
    if (arm.targets[i].name == line.target) return i;
    names.push_back(arm.targets[i].name);
  }
  throw InputError({},
                   "--target: " + UnknownName("target", line.target, names));
}

void WriteTable(const CommandLine& line, const std::string& text,
                const std::vector<std::string>& inputs) {
  if (line.out.empty()) {
    std::cout << text;
    return;
  }
  CheckOutputFile(line.out, inputs);
  WriteFileAtomically(line.out, text);
}

}  // namespace alidade::internal
