#ifndef ALIDADE_SRC_DATAIO_FILE_PATTERN_H_
#define ALIDADE_SRC_DATAIO_FILE_PATTERN_H_

#include <string>
#include <string_view>
#include <vector>

namespace alidade::internal {

/// Whether `name` is what `pattern` says, where each '*' stands for any
/// characters, also none. Time grows with the product of the sizes at most.
bool MatchesPattern(std::string_view pattern, std::string_view name);

/// Whether the file's name (not that of a folder) has a '*'.
bool IsPattern(const std::string& path);

/// The files, not folders, that the pattern's folder has of such names, in the
/// order of their bytes; as in shells, none that begins with '.' unless the
/// pattern does. Empty where there is none, or no such folder.
std::vector<std::string> MatchingFiles(const std::string& pattern);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATAIO_FILE_PATTERN_H_
