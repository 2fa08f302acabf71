#include "src/fleet/journal.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <sstream>
#include <system_error>

#include "alidade/error.h"
#include "src/common/files.h"
#include "src/serialization/result_json.h"

namespace alidade::internal {
namespace {

[[noreturn]] void FailWriting(const std::string& path, int error) {
  throw InputError({path, 0, 0, ""},
                   "the journal cannot be written: " +
                       std::generic_category().message(error));
}

}  // namespace

JournalRecords ReadJournal(const std::string& path) {
  JournalRecords records;
  if (!std::filesystem::exists(path)) return records;
  std::istringstream lines(ReadFile(path));
  std::string line;
  while (std::getline(lines, line)) {
    std::optional<BatchRecord> record = ParseBatchRecord(line);
    if (!record) continue;
    records[record->entry.name] = *std::move(record);
  }
  return records;
}

JournalWriter::JournalWriter(const std::string& path)
    : path_(path), file_(path, O_RDWR | O_CREAT | O_APPEND) {
  if (file_.get() < 0) FailWriting(path, errno);
  const off_t end = lseek(file_.get(), 0, SEEK_END);
  char last = '\n';
  if (end > 0 && pread(file_.get(), &last, 1, end - 1) != 1) {
    FailWriting(path, errno);
  }
  if (last != '\n' && !file_.WriteAll("\n")) FailWriting(path, errno);
}

void JournalWriter::Append(const std::vector<const BatchRecord*>& records) {
  std::string text;
  for (const BatchRecord* const record : records) {
    text += FormatBatchRecord(*record) + "\n";
  }
  if (!file_.WriteAll(text) || fdatasync(file_.get()) != 0) {
    FailWriting(path_, errno);
  }
}

// Two threads that ask for the same file at once may both read it, to the same
// end; none waits for another one's file.
std::optional<std::string> FileHashes::Of(const std::string& path) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto known = hashes_.find(path);
    if (known != hashes_.end()) return known->second;
  }
  std::optional<std::string> hash;
  try {
    hash = Sha256OfFile(path);
  } catch (const InputError&) {
    // Gone, or not to be read: not what it was.
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  return hashes_.emplace(path, hash).first->second;
}

}  // namespace alidade::internal
