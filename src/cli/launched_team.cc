#include "src/cli/launched_team.h"

#include <memory>
#include <string>
#include <vector>

#include "alidade/error.h"
#include "src/cli/launch.h"
#include "src/cli/mpi_team.h"
#include "src/kernel/compression.h"

namespace alidade::internal {
namespace {

// Vector code adds up in another order where vectors have another length.
void RequireSameMachines(Team* team) {
  const std::string mine = VectorInstructions();
  const std::vector<std::string> all = team->Gather(mine);
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

ExitStatus RunAsLaunched(const std::function<ExitStatus(Team*)>& work) {
  const Launch launch = FindLaunch();
  if (!launch.is_team()) return work(nullptr);
  const std::unique_ptr<Team> team = JoinTeam(launch);
  ExitStatus status = kExitDone;
  team->RunTogether([&] {
    RequireSameMachines(team.get());
    status = work(team.get());
  });
  return status;
}

}  // namespace alidade::internal
