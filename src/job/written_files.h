#ifndef ALIDADE_SRC_JOB_WRITTEN_FILES_H_
#define ALIDADE_SRC_JOB_WRITTEN_FILES_H_

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace alidade::internal {

/// What a file was when Alidade had written it. The time saves reading it
/// again: a file of another time, as a copy is, may still be the same one.
struct FileMark {
  std::uint64_t bytes = 0;
  std::int64_t modified = 0;  ///< ns since 1970
  std::string sha256;         ///< "-": of more than 64 MB, not taken
};

/// @throws InputError where the file cannot be read.
FileMark MarkOf(const std::string& path);

/// The files of a directory that Alidade has written there, by name. Nothing
/// where the file may have become anything since: lists of earlier
/// versions, and of a run that was cut off while it wrote.
using WrittenFiles = std::map<std::string, std::optional<FileMark>>;

/// Of the directory's `.alidade-files`: a line each, a name or
/// "NAME<tab>BYTES<tab>MODIFIED<tab>SHA256". Empty where there is none. Whoever
/// wrote it, no name leads out of the directory. @throws InputError.
WrittenFiles ReadWrittenFiles(const std::string& directory);

/// Writes that list. @throws InputError.
void NoteWrittenFiles(const std::string& directory, const WrittenFiles& files);

/// The same into a directory that is put in place as a whole: of all `names`.
/// @throws InputError.
void NoteAllWritten(const std::string& directory,
                    const std::vector<std::string>& names);

/// Moves the list of one directory to another. @throws InputError.
void MoveWrittenFiles(const std::string& from, const std::string& to);

/// What must not be replaced or removed of `names` in `directory`: a file that
/// `written` does not list, and one that has been changed since. What is not
/// there is no matter. @throws InputError that names it and says what to do.
void RefuseForeign(const std::string& directory,
                   const std::set<std::string>& names,
                   const WrittenFiles& written);

/// Whether the file is a page that `report` made. Earlier versions have not
/// listed those.
bool IsOwnPage(const std::string& path);

/// Everything that is in the directory but the list itself.
std::set<std::string> NamesIn(const std::string& directory);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_JOB_WRITTEN_FILES_H_
