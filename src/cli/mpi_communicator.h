#ifndef ALIDADE_SRC_CLI_MPI_COMMUNICATOR_H_
#define ALIDADE_SRC_CLI_MPI_COMMUNICATOR_H_

#include <memory>

#include "alidade/communicator.h"
#include "src/cli/launch.h"

namespace alidade::internal {

/// The processes that were launched together as a communicator, over MPI, which
/// starts now and ends when the object goes. To be called once, by the main
/// thread, which makes all collective calls.
/// @throws InputError where the program was built without MPI, or MPI knows of
/// other processes than the launcher.
std::unique_ptr<Communicator> JoinProcesses(const Launch& launch);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CLI_MPI_COMMUNICATOR_H_
