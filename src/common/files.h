#ifndef ALIDADE_SRC_COMMON_FILES_H_
#define ALIDADE_SRC_COMMON_FILES_H_

#include <cstdint>
#include <string>

#include "alidade/error.h"
#include "src/common/text_pieces.h"

namespace alidade::internal {

/// Refuses pipes and devices, which may never end, and files that are hardly
/// more than holes; what is not there passes. @throws InputError.
void RefuseEndless(const std::string& path);

/// The whole file, of at most 1 GiB. What is endless is refused at once, here
/// and below. @throws InputError naming the path and
/// the cause.
std::string ReadFile(const std::string& path);

/// Writes to a temporary name in the same directory, syncs it and renames it,
/// so that no reader ever sees half a file. @throws InputError.
void WriteFileAtomically(const std::string& path, const std::string& content);
/// The same of a text that comes in pieces; returns how many bytes they are.
/// Nothing is left of it either where `content` throws, which goes on to the
/// caller. Memory does not grow with the text.
std::uint64_t WriteFileAtomically(const std::string& path,
                                  const TextSource& content);

/// Writes a file that is not there yet and syncs it: for directories that are
/// renamed as a whole. @throws InputError.
void WriteNewFile(const std::string& path, const std::string& content);
/// The same in pieces, as WriteFileAtomically.
std::uint64_t WriteNewFile(const std::string& path, const TextSource& content);

/// Makes names in a directory, or their removal, outlast a loss of power.
/// @throws InputError.
void SyncDirectory(const std::string& path);

/// Removes what killed processes have left half written in a directory: files
/// of the names that WriteFileAtomically uses meanwhile. @pre nobody else
/// writes there now.
void RemoveTemporaries(const std::string& directory);

/// Creates a directory and its parents. @throws InputError.
void MakeDirectories(const std::string& path);

/// SHA-256 of a string, as 64 hexadecimal digits.
std::string Sha256(const std::string& content);

/// The same of a file, read piece by piece: memory does not grow with it.
/// @throws InputError.
std::string Sha256OfFile(const std::string& path);

/// Line and column, from 1, of a byte of a file, from 0; the column counts
/// bytes.
SourceLocation LocationOfByte(const std::string& path, const std::string& text,
                              std::size_t byte);

/// `path` as seen from the directory of `from_file`; absolute paths stay.
std::string ResolvePath(const std::string& from_file, const std::string& path);

/// work(), whose InputErrors are of this file where they name none.
template <typename Work>
auto WithFileInErrors(const std::string& path, const Work& work) {
  try {
    return work();
  } catch (const InputError& error) {
    if (!error.location().file.empty()) throw;
    SourceLocation location = error.location();
    location.file = path;
    throw InputError(location, error.message());
  }
}

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_COMMON_FILES_H_
