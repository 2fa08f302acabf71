#ifndef ALIDADE_SRC_JOB_DIRECTORY_SWAP_H_
#define ALIDADE_SRC_JOB_DIRECTORY_SWAP_H_

#include <optional>
#include <set>
#include <string>

#include "src/common/file_descriptor.h"

namespace alidade::internal {

/// Holds a directory as its only writer until the end of the scope; waits for
/// another process that does. @throws InputError where it cannot be opened.
class DirectoryLock {
 public:
  /// `path`: a directory, by its own name, not by a link.
  explicit DirectoryLock(const std::string& path);

 private:
  std::optional<FileDescriptor> file_;
};

/// A new directory that is to take the place of another one as a whole. It
/// stands beside it, ".NAME.alidade-staged-PROCESS-N", or inside where the
/// parent cannot be written; what is left of it is removed at the end of the
/// scope.
///
/// Killed at whatever moment, the place holds all old files or all new ones, so
/// long as the two can be exchanged (renameat2(2)). Where they cannot, since
/// the place is a mount point, has the current directory in it or is on a file
/// system that knows no exchange, files are moved one by one, the last of them
/// taken away first and put last.
class StagedDirectory {
 public:
  /// `place`: an existing directory, by its canonical name, whose lock is held.
  /// @throws InputError.
  explicit StagedDirectory(const std::string& place);
  ~StagedDirectory();
  StagedDirectory(const StagedDirectory&) = delete;
  StagedDirectory& operator=(const StagedDirectory&) = delete;

  const std::string& path() const { return path_; }

  /// Puts what is staged in place. Of what is there now `own` is replaced or
  /// removed; all else stays. `last`: the name that says that all is there, or
  /// empty. @throws InputError.
  void PutInPlace(const std::set<std::string>& own, const std::string& last);

 private:
  bool TryExchange(const std::set<std::string>& own);
  void MoveFiles(const std::set<std::string>& own, const std::string& last);

  const std::string place_;
  std::string path_;
  bool is_beside_ = true;
  std::optional<FileDescriptor> lock_;
};

/// Removes what killed processes have left staged for a place whose lock is
/// held. What is not Alidade's in it goes back to the place. Never throws.
void ClearStaged(const std::string& place);

/// Puts `staged` at `place` and what was there at `staged`, at once; where the
/// file system cannot, false with errno set and nothing changed.
bool TryExchangeNames(const std::string& staged, const std::string& place);

/// Takes down a directory or file that nobody reads. Never throws.
void RemoveStaged(const std::string& path);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_JOB_DIRECTORY_SWAP_H_
