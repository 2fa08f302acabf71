#ifndef ALIDADE_ARM_FILE_H_
#define ALIDADE_ARM_FILE_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "alidade/arm.h"

namespace alidade {

/// Reads an arm (docs/files.md, "format: alidade-arm-1"). `file` is a path, or,
/// where there is no such file, "robots/NAME" for an arm that comes with
/// Alidade (docs/robots.md). @throws InputError with file, line, column and
/// key.
Arm LoadArm(const std::string& file);

/// The same; the paths of further files that the arm file names (a URDF) are
/// appended to `input_files`.
Arm LoadArm(const std::string& file, std::vector<std::string>* input_files);

/// The arm of an arm file's text. `name` is that of messages; paths in it are
/// relative to it. @throws InputError with line, column and key.
Arm ParseArm(const std::string& text, const std::string& name);

/// The text of an arm file that LoadArm reads back to the same bits (rotations
/// of base and targets to about 1e-15). Numbers are in m and rad, with mm and
/// deg beside them in comments for people. `comment` goes on top, each of its
/// lines after "# ".
std::string FormatArm(const Arm& arm, const std::string& comment);

/// Reads deviations from nominal (docs/files.md, "alidade-deviations-1"): one
/// entry per column of the layout of the arm alone, zero where the file names
/// none.
/// @throws InputError with file, line, column and key.
Eigen::VectorXd LoadDeviations(const std::string& path, const Arm& arm);
/// The same of a file's text; `name` is that of messages.
Eigen::VectorXd ParseDeviations(const std::string& text,
                                const std::string& name, const Arm& arm);

}  // namespace alidade

#endif  // ALIDADE_ARM_FILE_H_
