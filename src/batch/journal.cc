#include "journal.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <sstream>
#include <system_error>

#include "alidade/base/error.h"
#include "alidade/io/batch_json.h"
#include "alidade/io/files.h"

namespace alidade {
namespace {

[[noreturn]] void FailWriting(const std::string& path, int error) {
  throw InputError({path, 0, 0, ""},
                   "the journal cannot be written: " +
                       std::generic_category().message(error));
}

void WriteAll(const std::string& path, int file, const std::string& text) {
  std::size_t written = 0;
  while (written < text.size()) {
    const ssize_t count =
        write(file, text.data() + written, text.size() - written);
    if (count < 0 && errno != EINTR) FailWriting(path, errno);
    if (count > 0) written += static_cast<std::size_t>(count);
  }
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
    : path_(path),
      file_(open(path.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666)) {
  if (file_ < 0) FailWriting(path, errno);
  const off_t end = lseek(file_, 0, SEEK_END);
  char last = '\n';
  if (end > 0 && pread(file_, &last, 1, end - 1) != 1) FailWriting(path, errno);
  if (last != '\n') WriteAll(path_, file_, "\n");
}

JournalWriter::~JournalWriter() {
  if (file_ >= 0) close(file_);
}

void JournalWriter::Append(const std::vector<const BatchRecord*>& records) {
  std::string text;
  for (const BatchRecord* const record : records) {
    text += FormatBatchRecord(*record) + "\n";
  }
  WriteAll(path_, file_, text);
  if (fdatasync(file_) != 0) FailWriting(path_, errno);
}

std::optional<std::string> FileHashes::Of(const std::string& path) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto known = hashes_.find(path);
  if (known != hashes_.end()) return known->second;
  std::optional<std::string> hash;
  try {
    hash = Sha256(ReadFile(path));
  } catch (const InputError&) {
    // Gone, or not to be read: not what it was.
  }
  hashes_[path] = hash;
  return hash;
}

}  // namespace alidade
