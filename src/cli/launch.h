#ifndef ALIDADE_SRC_CLI_LAUNCH_H_
#define ALIDADE_SRC_CLI_LAUNCH_H_

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

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CLI_LAUNCH_H_
