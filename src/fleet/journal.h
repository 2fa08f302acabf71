#ifndef ALIDADE_SRC_FLEET_JOURNAL_H_
#define ALIDADE_SRC_FLEET_JOURNAL_H_

#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "src/calibration/batch_summary.h"
#include "src/common/file_descriptor.h"

namespace alidade::internal {

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

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_FLEET_JOURNAL_H_
