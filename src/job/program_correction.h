#ifndef ALIDADE_SRC_JOB_PROGRAM_CORRECTION_H_
#define ALIDADE_SRC_JOB_PROGRAM_CORRECTION_H_

#include <optional>
#include <string>
#include <vector>

#include "alidade/correction.h"
#include "src/dataio/robot_program.h"
#include "src/job/program_notes.h"

namespace alidade::internal {

/// The corrections of a program's positions, and the texts that have them.
struct ProgramCorrection {
  Correction correction;
  std::vector<std::string> names;  ///< "line 12, P[1]"
  std::vector<std::string> texts;  ///< of the program's files
  /// What the program does not state and was taken: tools, bases, postures.
  std::vector<std::string> assumed;
  /// Positions that keep their numbers, of which `correction` has nothing.
  std::vector<std::string> left;
  /// Straight motions that do not lead to the posture which their end was
  /// solved in.
  std::vector<std::string> warnings;
  /// Where a position is refused or cannot be corrected; then there are no
  /// texts, and nothing may be written.
  std::optional<ProgramRefusal> refusal;
};

/// Corrects a program's positions in the order of its motions, each pose in the
/// posture that the program states or, without, the one that a straight motion
/// arrives in, else the one nearest to the position before. Tools stand behind
/// the arm's target (the flange), bases in its base frame.
ProgramCorrection CorrectProgram(const RobotProgram& program,
                                 const CorrectionArms& arms,
                                 const CorrectionOptions& options);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_JOB_PROGRAM_CORRECTION_H_
