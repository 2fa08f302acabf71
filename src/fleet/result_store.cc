#include "src/fleet/result_store.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <memory>
#include <set>
#include <sstream>
#include <system_error>

#include "alidade/error.h"
#include "alidade/version.h"
#include "src/common/files.h"
#include "src/job/directory_swap.h"
#include "src/job/written_files.h"
#include "src/serialization/result_json.h"

namespace alidade::internal {

namespace {

namespace fs = std::filesystem;

constexpr const char* kSummaryNames[] = {"summary.csv", "summary.json",
                                         "comparison.html"};

[[noreturn]] void Fail(const std::string& path, const std::string& what,
                       int error) {
  throw InputError({path, 0, 0, ""},
                   what + ": " + std::generic_category().message(error));
}

// Released where the file is closed: with the process at last, however it ends.
void TakeLock(const std::string& path, const FileDescriptor& file) {
  if (file.get() < 0) Fail(path, "cannot be written", errno);
  if (flock(file.get(), LOCK_EX | LOCK_NB) == 0) return;
  if (errno != EWOULDBLOCK) Fail(path, "cannot be locked", errno);
  throw InputError({path, 0, 0, ""},
                   "another batch is writing to this directory: wait for its "
                   "end, or choose another --out");
}

// The directory, which then exists.
const std::string& Made(const std::string& directory) {
  if (fs::is_symlink(directory)) {
    throw InputError({directory, 0, 0, ""},
                     "is a symbolic link, through which a batch does not "
                     "write: remove it, or choose another --out");
  }
  MakeDirectories(directory);
  return directory;
}

bool IsResult(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path / "result.json", error);
}

// Puts `staged` at `place` and what was there at `staged`.
void Exchange(const std::string& staged, const std::string& place) {
  if (TryExchangeNames(staged, place)) return;
  // Not every file system can; then there is a moment with no result.
  const std::string old = staged + "-old";
  if (rename(place.c_str(), old.c_str()) != 0 ||
      rename(staged.c_str(), place.c_str()) != 0 ||
      rename(old.c_str(), staged.c_str()) != 0) {
    Fail(place, "cannot be replaced", errno);
  }
}

}  // namespace

ResultStore::ResultStore(const std::string& directory)
    : directory_(directory),
      staging_(directory, ""),
      lock_(Made(staging_.path()) + "/lock", O_RDWR | O_CREAT | O_NOFOLLOW) {
  const std::string& work_directory = staging_.path();
  TakeLock(work_directory + "/lock", lock_);
  staging_.Clear();
  RemoveTemporaries(directory);
  const std::string journal = work_directory + "/journal.jsonl";
  records_ = ReadJournal(journal);
  journal_ = std::make_unique<JournalWriter>(journal);
  SyncDirectory(work_directory);
}

void ResultStore::CheckName(const std::string& name) const {
  const fs::path path = fs::path(directory_) / name;
  std::error_code error;
  const fs::file_status status = fs::symlink_status(path, error);
  if (!fs::exists(status)) return;
  if (fs::is_directory(status)) {
    if (fs::is_empty(path)) return;
    if (IsResult(path)) {
      RefuseForeign(path.string(), NamesIn(path.string()), FilesOf(name));
      return;
    }
  }
  throw InputError({path.string(), 0, 0, ""},
                   "is there already and no result of a job, which the batch "
                   "would replace: choose another --out, or move it away");
}

// Earlier versions have left no lists, but the journal has the names.
WrittenFiles ResultStore::FilesOf(const std::string& name) const {
  WrittenFiles written =
      ReadWrittenFiles((fs::path(directory_) / name).string());
  const auto record = records_.find(name);
  if (!written.empty() || record == records_.end()) return written;
  for (const ResultFile& file : record->second.files) {
    written[file.name] = std::nullopt;
  }
  return written;
}

void ResultStore::CheckSummaries() const {
  WrittenFiles written = ReadWrittenFiles(directory_);
  // An earlier version has worked here.
  if (written.empty() && !records_.empty()) {
    for (const char* name : kSummaryNames) written[name] = std::nullopt;
  }
  RefuseForeign(directory_,
                {std::begin(kSummaryNames), std::end(kSummaryNames)}, written);
}

void ResultStore::Commit(const BatchRecord& record, const std::string& staged) {
  Pending pending{&record, &staged, false};
  std::unique_lock<std::mutex> lock(mutex_);
  waiting_.push_back(&pending);
  changed_.wait(lock, [&] { return pending.is_done || !is_committing_; });
  if (!pending.is_done) {
    is_committing_ = true;
    std::vector<Pending*> group;
    group.swap(waiting_);
    if (!failure_) {
      lock.unlock();
      const std::exception_ptr failure = TryCommit(group);
      lock.lock();
      failure_ = failure;
    }
    for (Pending* const done : group) done->is_done = true;
    is_committing_ = false;
    changed_.notify_all();
  }
  if (!failure_) return;
  RemoveStaged(staged);
  std::rethrow_exception(failure_);
}

std::exception_ptr ResultStore::TryCommit(const std::vector<Pending*>& group) {
  try {
    CommitAll(group);
  } catch (...) {
    return std::current_exception();
  }
  return nullptr;
}

void ResultStore::CommitAll(const std::vector<Pending*>& group) {
  std::vector<const BatchRecord*> records;
  for (const Pending* const pending : group) {
    records.push_back(pending->record);
  }
  journal_->Append(records);
  std::set<std::string> parents;
  for (const Pending* const pending : group) {
    Place(*pending);
    parents.insert(
        (fs::path(directory_) / pending->record->entry.name).parent_path());
  }
  for (const std::string& parent : parents) {
    if (fs::exists(parent)) SyncDirectory(parent);
  }
}

void ResultStore::Place(const Pending& pending) {
  const fs::path place = fs::path(directory_) / pending.record->entry.name;
  const bool exists = fs::exists(place);
  std::string staged = *pending.staged;
  if (staged.empty()) {
    if (!exists) return;
    staged = staging_.NewName();
    if (rename(place.c_str(), staged.c_str()) != 0) {
      Fail(place, "cannot be removed", errno);
    }
  } else if (exists) {
    Exchange(staged, place);
  } else {
    if (!fs::exists(place.parent_path())) {
      MakeDirectories(place.parent_path());
      SyncDirectory(directory_);
    }
    if (rename(staged.c_str(), place.c_str()) != 0) {
      Fail(place, "cannot be written", errno);
    }
    return;
  }
  RemoveStaged(staged);
}

void ResultStore::WriteSummary(const std::string& name,
                               const std::string& content) {
  const std::string staged = staging_.NewName();
  const std::string path = directory_ + "/" + name;
  WriteNewFile(staged, content);
  // Whenever the process is killed, the next one knows whose file it is.
  WrittenFiles written = ReadWrittenFiles(directory_);
  written[name] = std::nullopt;
  NoteWrittenFiles(directory_, written);
  if (rename(staged.c_str(), path.c_str()) != 0) {
    const int error = errno;
    RemoveStaged(staged);
    Fail(path, "cannot be written", error);
  }
  written[name] = MarkOf(path);
  NoteWrittenFiles(directory_, written);
  SyncDirectory(directory_);
}

bool IsCurrent(const BatchRecord& record, const std::string& directory,
               const std::string& fingerprint, FileHashes* hashes) {
  if (record.version != Version() || record.fingerprint != fingerprint ||
      record.result_sha256.empty()) {
    return false;
  }
  for (const InputFile& input : record.inputs) {
    if (hashes->Of(input.path) != input.sha256) return false;
  }
  const fs::path result = fs::path(directory) / record.entry.directory;
  for (const ResultFile& file : record.files) {
    std::error_code error;
    if (fs::file_size(result / file.name, error) != file.bytes) return false;
  }
  try {
    return Sha256OfFile(result / "result.json") == record.result_sha256;
  } catch (const InputError&) {
    return false;
  }
}

namespace {

namespace fs = std::filesystem;

constexpr char kStaged[] = "staged-";

}  // namespace

StagingArea::StagingArea(const std::string& directory, const std::string& mark)
    : path_(directory + "/.batch"), mark_(mark.empty() ? "" : mark + "-") {}

void StagingArea::Clear() const {
  for (const auto& entry : fs::directory_iterator(path_)) {
    if (entry.path().filename().string().rfind(kStaged, 0) == 0) {
      RemoveStaged(entry.path().string());
    }
  }
}

std::string StagingArea::NewName() {
  return path_ + "/" + kStaged + mark_ + std::to_string(next_.fetch_add(1));
}

std::string StagingArea::Stage(const std::vector<ReportFile>& files,
                               std::vector<ResultFile>* written) {
  written->clear();
  std::string staged = NewName();
  try {
    MakeDirectories(staged);
    std::vector<std::string> names;
    for (const ReportFile& file : files) {
      const std::uint64_t size =
          WriteNewFile(staged + "/" + file.name, file.content);
      written->push_back({file.name, size});
      names.push_back(file.name);
    }
    NoteAllWritten(staged, names);
    SyncDirectory(staged);
  } catch (...) {
    RemoveStaged(staged);
    throw;
  }
  return staged;
}

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
    const std::string name = record->entry.name;
    records[name] = *std::move(record);
  }
  return records;
}

JournalWriter::JournalWriter(const std::string& path)
    : path_(path), file_(path, O_RDWR | O_CREAT | O_APPEND | O_NOFOLLOW) {
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
