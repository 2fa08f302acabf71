#ifndef ALIDADE_SRC_FLEET_BATCH_H_
#define ALIDADE_SRC_FLEET_BATCH_H_

#include <string>
#include <vector>

#include "alidade/communicator.h"
#include "src/calibration/batch_summary.h"
#include "src/fleet/batch_plan.h"
#include "src/serialization/job_config.h"

namespace alidade::internal {

/// Which jobs RunBatch would find done and unchanged, one per job of the plan.
/// Writes nothing. @throws InputError where the journal cannot be read.
std::vector<bool> FindDone(const BatchPlan& plan, const BatchOptions& options);

/// Runs every job of the plan that is not done already (docs/batch.md): loads
/// it, calibrates as RunJob, and writes its result directory, as many at a time
/// as there are threads; four for each thread are in memory at most, most of
/// them waiting for the disk. What goes wrong
/// with a job stays with it: its entry has the message.
///
/// An interrupted batch is continued by the same call. What was done then is
/// kept where job, inputs and program are what they were, so that the end is as
/// if there had been no interruption: the same bytes, but for times
/// (`time_s` and others in result.json, report.txt and iterations.csv).
///
/// Writes summary.json, summary.csv and comparison.html at the end.
///
/// Ranks divide the work, each with so many threads, in a directory that all
/// see; to be called by all, within Communicator::RunTogether. The root hands
/// out jobs as ranks become free, keeps the journal, gives results their names
/// and has the summary; other ranks return an empty one. The bytes are those of
/// one process.
/// @throws InputError where the directory cannot be written or another process
/// works in it. What was finished before stays.
BatchSummary RunBatch(const BatchPlan& plan, const BatchOptions& options,
                      Communicator* communicator = SingleProcess());

/// summary.csv of a batch (docs/batch.md): a row per job, in the order of the
/// jobs; lengths in mm with the digits that read back to the same bits; empty
/// cells for what a job does not have.
std::string FormatBatchCsv(const BatchSummary& summary);

/// "done", "missed limits" ...
std::string ToString(BatchStatus status);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_FLEET_BATCH_H_
