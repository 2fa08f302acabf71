#ifndef ALIDADE_SRC_JOB_PROGRAM_NOTES_H_
#define ALIDADE_SRC_JOB_PROGRAM_NOTES_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "alidade/arm.h"
#include "src/dataio/robot_program.h"

namespace alidade::internal {

// What is said of a program's positions, in the words of its language.

/// "A4": what the language calls joint `j` (from 0).
std::string JointName(ProgramLanguage language, int j);

/// "A1 -17.3, A2 ... A6 0.0 deg", of revolute joints; prismatic ones in mm.
std::string JointText(ProgramLanguage language, const Arm& arm,
                      const Eigen::VectorXd& motors);

/// "lines 4, 5 and 7": as LineName has them, twelve at most.
std::string LineList(const RobotProgram& program,
                     const std::vector<int>& lines);

/// What was assumed of frames: of positions before which the program sets none
/// (RobotProgram::unstated), and that the arm's target is the flange, which the
/// program's tools are taken from, where it is away from the last joint's
/// frame.
std::vector<std::string> FrameAssumptions(const RobotProgram& program,
                                          const Arm& nominal);

/// That declarations are read without the motions to them; may be empty.
std::vector<std::string> OrderAssumptions(const RobotProgram& program);

/// Positions that a refusal explains; of more it says how many.
inline constexpr std::size_t kMostListed = 20;

/// As many of a list, and how many more there are.
std::vector<std::string> FirstOf(std::vector<std::string> lines);

/// Why a program's positions cannot be corrected.
struct ProgramRefusal {
  std::string opening;             ///< "a.src:4: nothing is written, as ..."
  std::vector<std::string> lines;  ///< one each
};

/// Of `notes`, and of each frame that is missing. @pre there are some.
ProgramRefusal MakeRefusal(const RobotProgram& program,
                           const std::vector<ProgramNote>& notes);

/// The motions that go on without a correction; may be empty.
std::string UncorrectedMotions(const RobotProgram& program);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_JOB_PROGRAM_NOTES_H_
