#ifndef ALIDADE_SRC_CLI_LAUNCH_H_
#define ALIDADE_SRC_CLI_LAUNCH_H_

#include <functional>
#include <memory>

#include "alidade/communicator.h"
#include "src/cli/command.h"

namespace alidade::internal {

/// How this process was started, as Open MPI's mpirun and Slurm's srun say it
/// in the environment.
struct Launch {
  int rank = 0;
  int size = 1;  ///< processes that were started together

  bool are_several() const { return size > 1; }
};

/// @throws InputError where the environment contradicts itself.
Launch FindLaunch();

/// Nothing that this process prints or logs is seen any more: process 0 speaks
/// for all.
void Mute();

/// work(communicator) with the processes that were started together, within
/// Communicator::RunTogether, or with this one alone.
/// @throws what work does, on all of them; InputError where the machines are
/// not of one kind, or the program was built without MPI.
ExitStatus RunAsLaunched(const std::function<ExitStatus(Communicator*)>& work);

/// The processes that were launched together as a communicator, over MPI, which
/// starts now and ends when the object goes. To be called once, by the main
/// thread, which makes all collective calls.
/// @throws InputError where the program was built without MPI, or MPI knows of
/// other processes than the launcher.
std::unique_ptr<Communicator> JoinProcesses(const Launch& launch);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CLI_LAUNCH_H_
