#include <iostream>

#include "alidade/arm_file.h"
#include "alidade/error.h"
#include "src/cli/command.h"
#include "src/report/table.h"
#include "src/serialization/robot_files.h"

namespace alidade::internal {

ExitStatus RunRobots(const CommandLine& /*line*/) {
  Table table({"name", "arm", ">joints"});
  for (const RobotFile& file : ListRobots()) {
    try {
      const Arm arm = LoadArm(file.path);
      table.AddRow({file.name, arm.name, CountCell(arm.num_joints())});
    } catch (const InputError& error) {
      table.AddRow({file.name, std::string("wrong: ") + error.what(), ""});
    }
  }
  std::cout << table.ToText() << "\nFolders\n";
  for (const std::string& folder : RobotFolders()) {
    std::cout << "  " << folder << "\n";
  }
  return kExitDone;
}

}  // namespace alidade::internal
