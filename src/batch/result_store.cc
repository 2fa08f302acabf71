#include "result_store.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <set>
#include <system_error>

#include "alidade/base/error.h"
#include "alidade/base/version.h"
#include "alidade/io/files.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void Fail(const std::string& path, const std::string& what,
                       int error) {
  throw InputError({path, 0, 0, ""},
                   what + ": " + std::generic_category().message(error));
}

// Held until the process ends, however it does.
int TakeLock(const std::string& path) {
  const int lock = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (lock < 0) Fail(path, "cannot be written", errno);
  if (flock(lock, LOCK_EX | LOCK_NB) == 0) return lock;
  const int error = errno;
  close(lock);
  if (error != EWOULDBLOCK) Fail(path, "cannot be locked", error);
  throw InputError({path, 0, 0, ""},
                   "another batch is writing to this directory: wait for its "
                   "end, or choose another --out");
}

bool IsResult(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path / "result.json", error);
}

// Puts `staged` at `place` and what was there at `staged`.
void Exchange(const std::string& staged, const std::string& place) {
  if (renameat2(AT_FDCWD, staged.c_str(), AT_FDCWD, place.c_str(),
                RENAME_EXCHANGE) == 0) {
    return;
  }
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
    : directory_(directory), staging_(directory, "") {
  const std::string& work_directory = staging_.path();
  MakeDirectories(work_directory);
  lock_ = TakeLock(work_directory + "/lock");
  staging_.Clear();
  const std::string journal = work_directory + "/journal.jsonl";
  records_ = ReadJournal(journal);
  journal_ = std::make_unique<JournalWriter>(journal);
  SyncDirectory(work_directory);
}

ResultStore::~ResultStore() {
  if (lock_ >= 0) close(lock_);
}

void ResultStore::CheckName(const std::string& name) const {
  const fs::path path = fs::path(directory_) / name;
  std::error_code error;
  const fs::file_status status = fs::symlink_status(path, error);
  if (!fs::exists(status)) return;
  if (fs::is_directory(status) && (IsResult(path) || fs::is_empty(path))) {
    return;
  }
  throw InputError({path.string(), 0, 0, ""},
                   "is there already and no result of a job, which the batch "
                   "would replace: choose another --out, or move it away");
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
    if (failure_.empty()) {
      lock.unlock();
      std::string failure;
      try {
        CommitAll(group);
      } catch (const std::exception& error) {
        failure = error.what();
      }
      lock.lock();
      failure_ = failure;
    }
    for (Pending* const done : group) done->is_done = true;
    is_committing_ = false;
    changed_.notify_all();
  }
  if (!failure_.empty()) throw InputError({}, failure_);
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
  if (rename(staged.c_str(), path.c_str()) != 0) {
    const int error = errno;
    RemoveStaged(staged);
    Fail(path, "cannot be written", error);
  }
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
  const std::string result =
      directory + "/" + record.entry.directory + "/result.json";
  try {
    return Sha256(ReadFile(result)) == record.result_sha256;
  } catch (const InputError&) {
    return false;
  }
}

}  // namespace alidade
