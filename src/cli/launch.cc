#include "src/cli/launch.h"

#include <glog/logging.h>

#include <charconv>
#include <cstdlib>
#include <cstring>
#include <initializer_list>
#include <iostream>
#include <memory>
#include <streambuf>
#include <string>
#include <system_error>
#include <vector>

#include "alidade/error.h"
#include "src/kernel/reduction.h"

namespace alidade::internal {

namespace {

constexpr int kNone = -1;

// The first of these variables that is set, as a number; kNone where none is.
int NumberIn(std::initializer_list<const char*> variables) {
  for (const char* name : variables) {
    const char* const text = std::getenv(name);
    if (text == nullptr || *text == '\0') continue;
    int number = kNone;
    const char* const end = text + std::strlen(text);
    const auto [rest, error] = std::from_chars(text, end, number);
    if (error != std::errc() || rest != end || number < 0) {
      throw InputError({}, std::string("the environment variable ") + name +
                               " = \"" + text + "\" is no number of a process");
    }
    return number;
  }
  return kNone;
}

// Takes everything and keeps nothing.
class NullBuffer : public std::streambuf {
 protected:
  int_type overflow(int_type character) override {
    return traits_type::not_eof(character);
  }
};

}  // namespace

Launch FindLaunch() {
  // Open MPI's mpirun; srun --mpi=pmix; srun --mpi=pmi2.
  const int rank = NumberIn({"OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK"});
  const int size =
      NumberIn({"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS"});
  if (rank == kNone) return Launch();
  if (size == kNone || rank >= size) {
    throw InputError({},
                     "the environment says that this is process " +
                         std::to_string(rank) +
                         " of several, but not of how many: "
                         "start it by Open MPI's mpirun or by srun, or unset "
                         "PMIX_RANK and PMI_RANK");
  }
  return {rank, size};
}

void Mute() {
  // Never destroyed: streams are used to the end of the process.
  static auto* const nowhere = new NullBuffer;
  std::cout.rdbuf(nowhere);
  std::cerr.rdbuf(nowhere);
  FLAGS_stderrthreshold = google::GLOG_FATAL;
  FLAGS_minloglevel = google::GLOG_FATAL;
}

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
