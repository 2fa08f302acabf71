#ifndef ALIDADE_SRC_CALIBRATION_BATCH_SUMMARY_H_
#define ALIDADE_SRC_CALIBRATION_BATCH_SUMMARY_H_

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "alidade/accuracy.h"
#include "alidade/calibration_result.h"

namespace alidade::internal {

/// How a job of a batch ended, from best to worst.
enum class BatchStatus {
  kNotRun,        ///< another one failed before, and the batch was to stop then
  kDone,          ///< calibrated, all acceptance limits met
  kMissedLimits,  ///< calibrated, but an acceptance limit is missed
  kBadInput,      ///< the job, or a file that it names, is wrong
  kFailed,        ///< refused, or no usable solution: a numerical failure
};

/// What stands of one job in the summary of a batch; all of it but times, so
/// that the same jobs give the same summary. Lengths in m.
struct BatchEntry {
  std::string name;      ///< "fleet/left_seed-17"
  std::string job_file;  ///< as the user named it
  BatchStatus status = BatchStatus::kNotRun;
  std::string message;  ///< why the status is not kDone, else empty
  /// Below the batch's own; empty where there is no result.
  std::string directory;

  // The rest is empty or zero where the job did not get so far.
  std::string title;
  std::string arm;   ///< its name
  std::string data;  ///< file of the poses that were fitted
  Accuracy train_before;
  Accuracy train_after;
  Accuracy validation_before;  ///< n = 0 without validation poses
  Accuracy validation_after;
  int num_free = 0;
  int iterations = 0;
  std::string solver_status;  ///< "converged" ...
  /// Estimated standard deviation of a coordinate; NaN where it was given.
  double sigma = std::numeric_limits<double>::quiet_NaN();
  double reduced_chi_square = 0.0;
  std::int64_t num_outliers = 0;
  std::vector<std::string> warnings;
};

/// What a batch came to, in the order of its jobs.
struct BatchSummary {
  std::string version;
  std::vector<BatchEntry> entries;
  /// What a comparison of the results shows (comparison.h), in words; empty of
  /// fewer than two.
  std::string comparison;

  std::int64_t Count(BatchStatus status) const;
  /// Of the worst entry.
  BatchStatus Worst() const;
};

/// A file of a result directory: its name there, and how long it is.
struct ResultFile {
  std::string name;
  std::uint64_t bytes = 0;
};

/// An entry of a batch's journal: an outcome, and what it came from.
struct BatchRecord {
  BatchEntry entry;
  std::string version;  ///< of the program
  /// Of the job (JobMatrix::FingerprintOf) and the batch's own options.
  std::string fingerprint;
  /// Files that the job read, but job files: the fingerprint covers them.
  std::vector<InputFile> inputs;
  /// Of the result.json in the entry's directory; empty where there is none.
  std::string result_sha256;
  /// All files of that directory.
  std::vector<ResultFile> files;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_BATCH_SUMMARY_H_
