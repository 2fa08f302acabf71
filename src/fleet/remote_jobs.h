#ifndef ALIDADE_SRC_FLEET_REMOTE_JOBS_H_
#define ALIDADE_SRC_FLEET_REMOTE_JOBS_H_

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "alidade/communicator.h"
#include "src/calibration/batch_summary.h"
#include "src/fleet/job_computer.h"
#include "src/fleet/result_store.h"

namespace alidade::internal {

/// What another rank has done: a job's record, and where it wrote the result,
/// empty where there is none.
struct RemoteOutcome {
  std::int64_t number = 0;
  BatchRecord record;
  std::optional<ComparisonItem> item;
  std::string staged;
};

/// What rank 0 does for the others. None of it may throw.
struct JobDispatcher {
  /// The next job's number; nothing: no more.
  std::function<std::optional<std::int64_t>()> take;
  std::function<void(RemoteOutcome)> finish;
  /// A rank cannot go on: as DescribeError.
  std::function<void(const std::string&)> fail;
  /// Of a rank that has left.
  std::function<void(const WorkTimes&)> add_times;
};

/// Hands out jobs to the other ranks, each when it asks for one, and takes
/// what came of them, until all have left: they do once they hear that
/// there are no more. For the one thread of rank 0 that speaks with others;
/// it sleeps while there is nothing to say.
void ServeJobs(Communicator* communicator, const JobDispatcher& dispatcher);

/// Ends WorkForRoot on all others.
void DismissRanks(Communicator* communicator);

/// What other ranks than 0 do: `num_threads` at a time ask for a job, compute
/// it and write its result to the staging area, as workers of rank 0 do,
/// while this thread speaks for them. Returns once rank 0 dismisses it. What
/// a worker throws goes to rank 0.
void WorkForRoot(Communicator* communicator, const BatchPlan& plan,
                 const JobComputer& computer, int num_threads,
                 StagingArea* staging, WorkTimes* times);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_FLEET_REMOTE_JOBS_H_
