#ifndef ALIDADE_SRC_DATAIO_PROGRAM_ROUTINES_H_
#define ALIDADE_SRC_DATAIO_PROGRAM_ROUTINES_H_

#include <set>
#include <string>
#include <vector>

#include "src/dataio/program_text.h"
#include "src/dataio/robot_program.h"

namespace alidade::internal {

/// Fills the routines of a program, and where its text is not in the order of
/// its motions. @pre its targets and what is left are known.
void ListRoutines(const ProgramText& text, RobotProgram* program);

/// A statement that sets the tool or the base of the motions that follow.
struct FrameSetting {
  int line = 0;
  std::string kind;  ///< "tool", "base"
  std::string name;  ///< among the program's frames
};

/// Fills RobotProgram::borrowed by `settings`, which ascend. `own`: names of
/// positions that state their frames themselves. @pre routines are listed.
void ListBorrowedFrames(const std::vector<FrameSetting>& settings,
                        const std::set<std::string>& own,
                        RobotProgram* program);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATAIO_PROGRAM_ROUTINES_H_
