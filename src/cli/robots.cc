#include <iostream>

#include "alidade/arm_file.h"
#include "alidade/error.h"
#include "src/cli/command.h"
#include "src/common/names.h"
#include "src/report/table.h"
#include "src/serialization/robot_files.h"

namespace alidade::internal {
namespace {

// Arms of one name differ by them.
std::string TitleOf(const Arm& arm) {
  std::vector<std::string> names;
  for (const Target& target : arm.targets) {
    if (!target.name.empty()) names.push_back(target.name);
  }
  if (arm.num_targets() < 2) return arm.name;
  return arm.name + ", targets " + JoinNames(names);
}

}  // namespace

ExitStatus RunRobots(const CommandLine& line) {
  const std::string part = line.files.empty() ? "" : line.files.front();
  Table table({"name", "arm", ">joints"});
  bool is_any = false;
  for (const RobotFile& file : ListRobots()) {
    std::string title;
    std::string joints;
    try {
      const Arm arm = LoadArm(file.path);
      title = TitleOf(arm);
      joints = std::to_string(arm.num_joints());
    } catch (const InputError& error) {
      title = std::string("wrong: ") + error.what();
    }
    if (!HasRobotName(file.name, part) && !HasRobotName(title, part)) continue;
    table.AddRow({file.name, title, joints});
    is_any = true;
  }
  if (!is_any) {
    throw InputError({}, "no arm's name has " + Quote(part) +
                             "; 'alidade robots' lists all of them");
  }
  std::cout << table.ToText() << "\nFolders\n";
  for (const std::string& folder : RobotFolders()) {
    std::cout << "  " << folder << "\n";
  }
  return kExitDone;
}

}  // namespace alidade::internal
