#include "src/job/directory_swap.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <vector>

#include "alidade/error.h"
#include "src/common/files.h"
#include "src/job/written_files.h"

namespace alidade::internal {
namespace {

namespace fs = std::filesystem;

constexpr char kStagedMark[] = "alidade-staged-";
constexpr int kDirectory = O_RDONLY | O_DIRECTORY | O_NOFOLLOW;

[[noreturn]] void Fail(const std::string& path, const std::string& what,
                       int error) {
  throw InputError({path, 0, 0, ""},
                   what + ": " + std::generic_category().message(error));
}

// What the names of directories that are staged for a place begin with.
std::string PrefixBeside(const fs::path& place) {
  return "." + place.filename().string() + "." + kStagedMark;
}
std::string PrefixInside() { return std::string(".") + kStagedMark; }

bool BeginsWith(const fs::path& path, const std::string& prefix) {
  return path.filename().string().rfind(prefix, 0) == 0;
}

// Whether the file still has that name: it may have been exchanged meanwhile.
bool IsNamed(int file, const std::string& path) {
  struct stat here = {};
  struct stat there = {};
  return fstat(file, &here) == 0 && lstat(path.c_str(), &there) == 0 &&
         here.st_ino == there.st_ino && here.st_dev == there.st_dev;
}

dev_t DeviceOf(const fs::path& path) {
  struct stat status = {};
  return stat(path.c_str(), &status) == 0 ? status.st_dev : 0;
}

// Mode and owner of `path` become those of `model`.
bool TakeAfter(const std::string& path, const std::string& model) {
  struct stat wanted = {};
  struct stat own = {};
  if (stat(model.c_str(), &wanted) != 0 || stat(path.c_str(), &own) != 0) {
    return false;
  }
  const bool is_owned =
      wanted.st_uid == own.st_uid && wanted.st_gid == own.st_gid;
  return (is_owned || chown(path.c_str(), wanted.st_uid, wanted.st_gid) == 0) &&
         chmod(path.c_str(), wanted.st_mode & 07777) == 0;
}

bool HasCurrentDirectory(const fs::path& place) {
  std::error_code error;
  const fs::path current = fs::current_path(error);
  if (error) return false;
  const fs::path relative = current.lexically_relative(place);
  return !relative.empty() && *relative.begin() != "..";
}

// Makes a directory of a new name that begins so; empty where it cannot.
std::string MakeStaged(const std::string& begin) {
  static std::atomic<unsigned> counter{0};
  while (true) {
    std::string path = begin + std::to_string(getpid()) + "-" +
                       std::to_string(counter.fetch_add(1));
    if (mkdir(path.c_str(), 0777) == 0) return path;
    if (errno != EEXIST) return "";
  }
}

// Takes what a killed process left back to the place, and the rest away. A
// directory without a list was cut off before anything of others was in it.
void ClearOne(const fs::path& staged, const fs::path& place) {
  const FileDescriptor file(staged.string(), kDirectory);
  if (file.get() < 0 || flock(file.get(), LOCK_EX | LOCK_NB) != 0) return;
  try {
    const WrittenFiles written = ReadWrittenFiles(staged.string());
    if (!written.empty()) {
      for (const std::string& name : NamesIn(staged.string())) {
        std::error_code ignored;
        if (written.count(name) > 0 || fs::exists(place / name, ignored)) {
          continue;
        }
        fs::rename(staged / name, place / name, ignored);
      }
    }
  } catch (const InputError&) {
    return;
  }
  RemoveStaged(staged.string());
}

}  // namespace

DirectoryLock::DirectoryLock(const std::string& path) {
  while (true) {
    file_.emplace(path, kDirectory);
    if (file_->get() < 0) Fail(path, "directory cannot be opened", errno);
    int result = 0;
    do {
      result = flock(file_->get(), LOCK_EX);
    } while (result != 0 && errno == EINTR);
    if (result != 0) Fail(path, "directory cannot be locked", errno);
    if (IsNamed(file_->get(), path)) return;
  }
}

StagedDirectory::StagedDirectory(const std::string& place) : place_(place) {
  const fs::path parent = fs::path(place).parent_path();
  if (DeviceOf(parent) == DeviceOf(place)) {
    path_ = MakeStaged((parent / PrefixBeside(place)).string());
  }
  is_beside_ = !path_.empty();
  if (!is_beside_) {
    path_ = MakeStaged((fs::path(place) / PrefixInside()).string());
  }
  if (path_.empty()) Fail(place, "cannot be written", errno);
  lock_.emplace(path_, kDirectory);
  if (lock_->get() < 0 || flock(lock_->get(), LOCK_EX | LOCK_NB) != 0) {
    Fail(path_, "directory cannot be locked", errno);
  }
}

StagedDirectory::~StagedDirectory() {
  if (!path_.empty()) RemoveStaged(path_);
}

void StagedDirectory::PutInPlace(const std::set<std::string>& own,
                                 const std::string& last) {
  SyncDirectory(path_);
  if (!TryExchange(own)) MoveFiles(own, last);
  SyncDirectory(place_);
}

bool StagedDirectory::TryExchange(const std::set<std::string>& own) {
  if (!is_beside_ || HasCurrentDirectory(place_) || !TakeAfter(path_, place_)) {
    return false;
  }
  // Files of others are in both meanwhile; what cannot be moves afterwards.
  std::vector<std::string> moved;
  for (const std::string& name : NamesIn(place_)) {
    if (own.count(name) > 0) continue;
    const std::string from = place_ + "/" + name;
    if (link(from.c_str(), (path_ + "/" + name).c_str()) != 0) {
      moved.push_back(name);
    }
  }
  if (!TryExchangeNames(path_, place_)) return false;
  for (const std::string& name : moved) {
    const std::string from = path_ + "/" + name;
    if (rename(from.c_str(), (place_ + "/" + name).c_str()) != 0) {
      const int error = errno;
      path_.clear();  // keeps it there
      Fail(from, "cannot be moved into " + place_, error);
    }
  }
  SyncDirectory(fs::path(place_).parent_path().string());
  return true;
}

void StagedDirectory::MoveFiles(const std::set<std::string>& own,
                                const std::string& last) {
  // Whatever happens below, the next run knows all that may be there.
  WrittenFiles unfinished;
  for (const std::string& name : own) unfinished[name] = std::nullopt;
  NoteWrittenFiles(place_, unfinished);
  const std::set<std::string> staged = NamesIn(path_);
  const auto remove = [this](const std::string& name) {
    const std::string path = place_ + "/" + name;
    if (unlink(path.c_str()) != 0 && errno != ENOENT) {
      Fail(path, "is of an earlier result and cannot be removed", errno);
    }
  };
  const auto move = [this](const std::string& name) {
    const std::string path = place_ + "/" + name;
    if (rename((path_ + "/" + name).c_str(), path.c_str()) != 0) {
      Fail(path, "cannot be written", errno);
    }
  };
  if (!last.empty()) remove(last);
  for (const std::string& name : own) {
    if (staged.count(name) == 0) remove(name);
  }
  for (const std::string& name : staged) {
    if (name != last && own.count(name) > 0) move(name);
  }
  if (staged.count(last) > 0) move(last);
  MoveWrittenFiles(path_, place_);
}

void ClearStaged(const std::string& place) {
  const fs::path parent = fs::path(place).parent_path();
  for (const auto& [directory, prefix] :
       {std::pair{parent, PrefixBeside(place)},
        std::pair{fs::path(place), PrefixInside()}}) {
    std::vector<fs::path> found;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(directory, error)) {
      if (BeginsWith(entry.path(), prefix)) found.push_back(entry.path());
    }
    for (const fs::path& staged : found) ClearOne(staged, place);
  }
  RemoveTemporaries(place);
}

bool TryExchangeNames(const std::string& staged, const std::string& place) {
  return renameat2(AT_FDCWD, staged.c_str(), AT_FDCWD, place.c_str(),
                   RENAME_EXCHANGE) == 0;
}

void RemoveStaged(const std::string& path) {
  std::error_code ignored;
  fs::remove_all(path, ignored);
}

}  // namespace alidade::internal
