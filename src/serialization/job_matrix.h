#ifndef ALIDADE_SRC_SERIALIZATION_JOB_MATRIX_H_
#define ALIDADE_SRC_SERIALIZATION_JOB_MATRIX_H_

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "src/serialization/job_config.h"
#include "src/serialization/yaml_reader.h"
#include "src/serialization/yaml_tree.h"

namespace alidade::internal {

/// What a job is, known from its file alone: nothing else has been read.
struct JobOutline {
  std::string name;  ///< "fleet/left_seed-17": of the file and its values
  std::string arm;   ///< path as read from here; empty where none is stated
  std::string data;  ///< likewise, or "simulated"; several are joined by ", "
};

/// A job file as the jobs it describes: one, or every combination of the values
/// in its `matrix` (docs/batch.md). Jobs are numbered in the order of the file,
/// the last axis fastest, and are the same at every reading.
///
/// Holds the file's tree and no job: 10^6 of them cost no more memory than one.
/// Read-only, so safe to share between threads.
class JobMatrix {
 public:
  /// Reads the file and those it extends. @throws InputError with file, line,
  /// column and key.
  explicit JobMatrix(const std::string& path);
  /// The same of a job file's root.
  explicit JobMatrix(const YamlValue& root);

  std::int64_t size() const;
  const std::string& path() const;
  /// The job file and those it extends.
  const std::vector<std::string>& files() const;
  /// The name of a file's only job: "fleet" of "jobs/fleet.yaml".
  static std::string NameOfFile(const std::string& path);
  /// NameOfFile, and with a matrix the values after it:
  /// "fleet/left_seed-17". Letters, digits, '.', '+', '-', '_' and one '/'.
  std::string NameOf(std::int64_t job) const;
  JobOutline OutlineOf(std::int64_t job) const;
  /// The job with every file it names. @throws InputError as LoadJob.
  JobConfig Load(std::int64_t job, const Execution& execution) const;
  /// SHA-256 of all that the job's file and those it extends say of this job:
  /// where it changes, or the content of a file that the job reads, so may the
  /// result. Patterns and environment variables count as what they stand for.
  std::string FingerprintOf(std::int64_t job) const;

 private:
  struct Contents;
  std::shared_ptr<const Contents> contents_;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_JOB_MATRIX_H_
