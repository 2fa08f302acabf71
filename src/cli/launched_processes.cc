#include "src/cli/launched_processes.h"

#include <memory>
#include <string>
#include <vector>

#include "alidade/error.h"
#include "src/cli/launch.h"
#include "src/cli/mpi_communicator.h"
#include "src/kernel/reduction.h"

namespace alidade::internal {
namespace {

// Vector code adds up in another order where vectors have another length.
void RequireSameMachines(Communicator* communicator) {
  const std::string mine = VectorInstructions();
  const std::vector<std::string> all = communicator->Gather(mine);
  for (const std::string& each : all) {
    if (each == all.front()) continue;
    throw InputError(
        {}, "the processes run on machines of different vector instructions (" +
                all.front() + ", " + each +
                "), and their bits would not agree: run them on machines of "
                "one kind");
  }
}

}  // namespace

ExitStatus RunAsLaunched(const std::function<ExitStatus(Communicator*)>& work) {
  const Launch launch = FindLaunch();
  if (!launch.are_several()) return work(SingleProcess());
  const std::unique_ptr<Communicator> communicator = JoinProcesses(launch);
  ExitStatus status = kExitDone;
  communicator->RunTogether([&] {
    RequireSameMachines(communicator.get());
    status = work(communicator.get());
  });
  return status;
}

}  // namespace alidade::internal
