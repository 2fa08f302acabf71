#ifndef ALIDADE_SRC_CLI_LAUNCHED_TEAM_H_
#define ALIDADE_SRC_CLI_LAUNCHED_TEAM_H_

#include <functional>

#include "alidade/team.h"
#include "src/cli/command.h"

namespace alidade::internal {

/// work(team) within Team::RunTogether, with the processes that were started
/// together as a team; work(nullptr) where this one was started alone.
/// @throws what work does, on all of them; InputError where the machines are
/// not of one kind, or the program was built without MPI.
ExitStatus RunAsLaunched(const std::function<ExitStatus(Team*)>& work);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CLI_LAUNCHED_TEAM_H_
