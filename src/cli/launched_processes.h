#ifndef ALIDADE_SRC_CLI_LAUNCHED_PROCESSES_H_
#define ALIDADE_SRC_CLI_LAUNCHED_PROCESSES_H_

#include <functional>

#include "alidade/communicator.h"
#include "src/cli/command.h"

namespace alidade::internal {

/// work(communicator) with the processes that were started together, within
/// Communicator::RunTogether, or with this one alone.
/// @throws what work does, on all of them; InputError where the machines are
/// not of one kind, or the program was built without MPI.
ExitStatus RunAsLaunched(const std::function<ExitStatus(Communicator*)>& work);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CLI_LAUNCHED_PROCESSES_H_
