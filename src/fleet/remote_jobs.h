#ifndef ALIDADE_SRC_FLEET_REMOTE_JOBS_H_
#define ALIDADE_SRC_FLEET_REMOTE_JOBS_H_

#include <cstdint>
#include <exception>
#include <functional>
#include <optional>
#include <string>

#include "alidade/batch_summary.h"
#include "alidade/team.h"
#include "src/fleet/job_computer.h"
#include "src/fleet/staging_area.h"

namespace alidade::internal {

/// What another member has done: a job's record, and where it wrote the result,
/// empty where there is none.
struct RemoteOutcome {
  std::int64_t number = 0;
  BatchRecord record;
  std::optional<ComparisonItem> item;
  std::string staged;
};

/// What member 0 does for the others. None of it may throw.
struct JobDesk {
  /// The next job's number; nothing: no more.
  std::function<std::optional<std::int64_t>()> take;
  std::function<void(RemoteOutcome)> finish;
  /// A member cannot go on: as DescribeError.
  std::function<void(const std::string&)> fail;
  /// Of a member that has left.
  std::function<void(const WorkTimes&)> add_times;
};

/// Hands out jobs to the other members, each when it asks for one, and takes
/// what came of them, until all have left: they do once they are told that
/// there are no more. For the one thread of member 0 that speaks with others;
/// it sleeps while there is nothing to say.
void ServeJobs(Team* team, const JobDesk& desk);

/// Ends WorkForFirst on all others.
void DismissMembers(Team* team);

/// What other members than 0 do: `num_threads` at a time ask for a job, compute
/// it and write its result to the staging area, as workers of member 0 do,
/// while this thread speaks for them. Returns once member 0 dismisses it. What
/// a worker throws goes to member 0.
void WorkForFirst(Team* team, const BatchPlan& plan,
                  const JobComputer& computer, int num_threads,
                  StagingArea* staging, WorkTimes* times);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_FLEET_REMOTE_JOBS_H_
