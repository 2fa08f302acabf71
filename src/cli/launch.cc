#include "launch.h"

#include <glog/logging.h>

#include <cstdlib>
#include <initializer_list>
#include <iostream>
#include <streambuf>

namespace alidade {
namespace {

// The first of these variables that is set, as a number.
int NumberIn(std::initializer_list<const char*> variables, int otherwise) {
  for (const char* name : variables) {
    const char* const text = std::getenv(name);
    if (text != nullptr && *text != '\0') return std::atoi(text);
  }
  return otherwise;
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
  Launch launch;
  // Open MPI's mpirun; srun --mpi=pmix; srun --mpi=pmi2.
  constexpr int kNone = -1;
  launch.rank =
      NumberIn({"OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK"}, kNone);
  if (launch.rank == kNone) return Launch();
  launch.size =
      NumberIn({"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS"}, 1);
  return launch;
}

void Mute() {
  // Never destroyed: streams are used to the end of the process.
  static auto* const nowhere = new NullBuffer;
  std::cout.rdbuf(nowhere);
  std::cerr.rdbuf(nowhere);
  FLAGS_stderrthreshold = google::GLOG_FATAL;
  FLAGS_minloglevel = google::GLOG_FATAL;
}

}  // namespace alidade
