#ifndef ALIDADE_SRC_JOB_PROGRAM_CORRECTION_H_
#define ALIDADE_SRC_JOB_PROGRAM_CORRECTION_H_

#include <Eigen/Geometry>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "alidade/correction.h"
#include "src/dataio/robot_program.h"
#include "src/dataio/rotation_convention.h"

namespace alidade::internal {

/// The corrections of a program's positions, and the text that has them.
struct ProgramCorrection {
  Correction correction;
  std::vector<std::string> names;  ///< "line 12, P[1]"
  std::string text;
};

/// Corrects a program's positions in the order of its text, each pose in the
/// posture that the program states or, without, nearest to the position before.
/// Tools stand behind the arm's target (the flange), bases in its base frame.
/// @throws InputError, a line for each position that is refused or cannot be
/// corrected: then nothing may be written.
ProgramCorrection CorrectProgram(const RobotProgram& program,
                                 const CorrectionArms& arms,
                                 const CorrectionOptions& options);

/// What was assumed: of positions before which the program sets no frame
/// (RobotProgram::unstated), and that the arm's target is the flange, which the
/// program's tools are taken from, where it is away from the last joint's
/// frame.
std::vector<std::string> AssumptionsOf(const RobotProgram& program,
                                       const Arm& nominal);

/// Tools and bases of a table with the columns name, x_mm, y_mm, z_mm and an
/// orientation. @throws InputError.
std::map<std::string, Eigen::Isometry3d> LoadFrames(
    const std::string& path, const Arm& arm,
    const std::optional<RotationConvention>& rotation);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_JOB_PROGRAM_CORRECTION_H_
