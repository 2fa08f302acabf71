#ifndef ALIDADE_SRC_SERIALIZATION_ROBOT_FILES_H_
#define ALIDADE_SRC_SERIALIZATION_ROBOT_FILES_H_

#include <string>
#include <vector>

#include "alidade/error.h"

namespace alidade::internal {

/// Where arm files that are named "robots/NAME" are looked for, in this order:
/// folders of the environment variable ALIDADE_ROBOTS (separated by ':'), that
/// of the program's installation, the source tree's, that of the library's
/// installation. Those that are there, each once.
std::vector<std::string> RobotFolders();

/// An arm file of these folders.
struct RobotFile {
  std::string name;  ///< "robots/ur10e"
  std::string path;
};

/// All of them by name. One of an earlier folder hides those of its name.
std::vector<RobotFile> ListRobots();

/// Whether `part` is in a name, whatever its case, blanks and marks: "KR 6" is
/// in "robots/kr6_r900_2". Empty ones are in all.
bool HasRobotName(const std::string& name, const std::string& part);

/// "robots/NAME" of a path that ArmPath gave for it; nothing of others.
std::string RobotNameOf(const std::string& path);

/// The path of an arm: `path`, which `text` stands for as a file's name, or,
/// where there is no such file and `text` is "robots/NAME", that arm file.
/// @throws InputError at `location` where no folder has it.
std::string ArmPath(const std::string& text, const std::string& path,
                    const SourceLocation& location);

/// Refuses the name of an arm without its folder, "ur10", where there is no
/// such file: says that "robots/ur10" is meant; of "kr6" it names all that
/// have it in their names. For what is to be read as a
/// file; other texts pass. @throws InputError at `location`.
void RefuseBareName(const std::string& text, const std::string& path,
                    const SourceLocation& location);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_ROBOT_FILES_H_
