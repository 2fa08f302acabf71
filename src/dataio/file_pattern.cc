#include "src/dataio/file_pattern.h"

#include <algorithm>
#include <filesystem>
#include <system_error>

namespace alidade::internal {

namespace fs = std::filesystem;

// Goes back to the last star alone: an earlier one that took more would only
// leave less for it.
bool MatchesPattern(std::string_view pattern, std::string_view name) {
  std::size_t p = 0;
  std::size_t n = 0;
  std::size_t star = std::string_view::npos;
  std::size_t star_ends = 0;  // in `name`
  while (n < name.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      star_ends = n;
    } else if (p < pattern.size() && pattern[p] == name[n]) {
      ++p;
      ++n;
    } else if (star != std::string_view::npos) {
      p = star + 1;
      n = ++star_ends;
    } else {
      return false;
    }
  }
  return pattern.find_first_not_of('*', p) == std::string_view::npos;
}

bool IsPattern(const std::string& path) {
  return fs::path(path).filename().string().find('*') != std::string::npos;
}

std::vector<std::string> MatchingFiles(const std::string& pattern) {
  const fs::path path(pattern);
  const std::string wanted = path.filename().string();
  fs::path directory = path.parent_path();
  const bool is_here = directory.empty();
  if (is_here) directory = ".";
  std::vector<std::string> found;
  std::error_code error;
  for (fs::directory_iterator it(directory, error), end; !error && it != end;
       it.increment(error)) {
    const std::string name = it->path().filename().string();
    std::error_code ignored;
    const bool is_hidden = name.front() == '.' && wanted.front() != '.';
    if (is_hidden || !MatchesPattern(wanted, name) ||
        it->is_directory(ignored)) {
      continue;
    }
    found.push_back(is_here ? name : it->path().string());
  }
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace alidade::internal
