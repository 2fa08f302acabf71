#ifndef ALIDADE_SRC_FLEET_RESULT_STORE_H_
#define ALIDADE_SRC_FLEET_RESULT_STORE_H_

#include <atomic>
#include <condition_variable>
#include <exception>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "src/calibration/batch_summary.h"
#include "src/common/file_descriptor.h"
#include "src/job/written_files.h"
#include "src/report/report.h"

namespace alidade::internal {

/// Where the results of a batch are written before they come to their names:
/// DIR/.batch/staged-MARK-N. Safe to use from several threads.
class StagingArea {
 public:
  /// `mark`: distinguished by it are processes that write to one directory,
  /// those of an earlier batch included, which may still be ending on another
  /// machine. The process that holds the directory needs none.
  StagingArea(const std::string& directory, const std::string& mark);

  const std::string& path() const { return path_; }
  /// Removes all that is there, whoever wrote it.
  void Clear() const;
  /// A name that was not given before.
  std::string NewName();
  /// Writes files to a new staged directory and syncs them; returns its path,
  /// and in `written` what they are and how long. @throws InputError.
  std::string Stage(const std::vector<ReportFile>& files,
                    std::vector<ResultFile>* written);

 private:
  const std::string path_;
  const std::string mark_;
  std::atomic<int> next_{0};
};

/// The last record of every job, by its name.
using JournalRecords = std::unordered_map<std::string, BatchRecord>;

/// Reads a journal: lines of JSON, the last one of a name counts. Empty where
/// there is no file; a line that a crash tore is passed over.
/// @throws InputError where the file is there and cannot be read.
JournalRecords ReadJournal(const std::string& path);

/// Appends to a journal. @throws InputError where it cannot be written.
class JournalWriter {
 public:
  /// Ends a line that a crash tore, so that the next record is whole.
  explicit JournalWriter(const std::string& path);

  /// Writes the records and syncs them, all at once.
  void Append(const std::vector<const BatchRecord*>& records);

 private:
  const std::string path_;
  const FileDescriptor file_;
};

/// SHA-256 of files, each read once: jobs of a batch share their inputs. Safe
/// to use from several threads.
class FileHashes {
 public:
  /// Nothing where the file cannot be read.
  std::optional<std::string> Of(const std::string& path);

 private:
  std::mutex mutex_;
  std::map<std::string, std::optional<std::string>> hashes_;
};

/// The directory that a batch writes to, held by one process at a time:
///
///     DIR/NAME/...               a job's result, whole or not there at all
///     DIR/.alidade-files         what summaries were when they were written
///     DIR/.batch/lock            held while a batch works here
///     DIR/.batch/journal.jsonl   what has been done (journal.h)
///     DIR/.batch/staged-N/       a result that is being written
///
/// (The result may be written by another process of the same batch:
/// staging_area.h.)
///
/// A result is written to a staged directory, and files and directory synced;
/// then its record goes to the journal, synced; then the directory is renamed,
/// and the name synced. Whatever moment the process is killed at, a name has
/// either its old result, its new one or none, and the journal's word counts
/// only where the hash that it states is that of the result.json which is
/// there.
///
/// Safe to use from several threads. Results that come while others are being
/// written to the journal wait and go together, for one sync.
class ResultStore {
 public:
  /// Makes the directory, takes the lock, clears what an interrupted batch left
  /// staged. @throws InputError, also where another process holds the lock.
  explicit ResultStore(const std::string& directory);
  ResultStore(const ResultStore&) = delete;
  ResultStore& operator=(const ResultStore&) = delete;

  const JournalRecords& records() const { return records_; }

  /// @throws InputError where something stands at the job's name that is no
  /// result, or one with files that no batch has written or that have been
  /// changed since: it is not for a batch to replace.
  void CheckName(const std::string& name) const;

  /// The same of what WriteSummary is to replace.
  void CheckSummaries() const;

  /// As StagingArea::Stage.
  std::string Stage(const std::vector<ReportFile>& files,
                    std::vector<ResultFile>* written) {
    return staging_.Stage(files, written);
  }

  /// Records an outcome and puts the staged directory in its place; where
  /// `staged` is empty, no result: an older one is removed. Returns when it
  /// would outlast a loss of power. @throws InputError and whatever else went
  /// wrong, also where it did for another one: the staged directory is gone.
  void Commit(const BatchRecord& record, const std::string& staged);

  /// Puts a file into the directory, whole; what is left of it where the
  /// process is killed is cleared like a staged result. @throws InputError.
  void WriteSummary(const std::string& name, const std::string& content);

 private:
  struct Pending {
    const BatchRecord* record;
    const std::string* staged;
    bool is_done;
  };

  WrittenFiles FilesOf(const std::string& name) const;
  // What went wrong, or null.
  std::exception_ptr TryCommit(const std::vector<Pending*>& group);
  void CommitAll(const std::vector<Pending*>& group);
  void Place(const Pending& pending);

  const std::string directory_;
  StagingArea staging_;
  JournalRecords records_;
  const FileDescriptor lock_;
  std::unique_ptr<JournalWriter> journal_;

  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<Pending*> waiting_;
  bool is_committing_ = false;
  std::exception_ptr failure_;  ///< of a commit: none is tried after it
};

/// Whether a record still holds: the same program, job and inputs,
/// and its result in place. `fingerprint` is the job's as it is now.
bool IsCurrent(const BatchRecord& record, const std::string& directory,
               const std::string& fingerprint, FileHashes* hashes);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_FLEET_RESULT_STORE_H_
