#include "src/serialization/job_list.h"

#include <sstream>

#include "alidade/error.h"
#include "src/common/files.h"

namespace alidade::internal {

std::vector<std::string> ReadJobList(const std::string& path) {
  return ParseJobList(ReadFile(path), path);
}

std::vector<std::string> ParseJobList(const std::string& text,
                                      const std::string& path) {
  std::istringstream lines(text);
  std::vector<std::string> paths;
  std::string line;
  while (std::getline(lines, line)) {
    const std::size_t first = line.find_first_not_of(" \t\r");
    if (first == std::string::npos || line[first] == '#') continue;
    const std::size_t last = line.find_last_not_of(" \t\r");
    paths.push_back(ResolvePath(path, line.substr(first, last - first + 1)));
  }
  if (paths.empty()) {
    throw InputError({path, 0, 0, ""},
                     "the list is empty, expected a job file or folder a line");
  }
  return paths;
}

}  // namespace alidade::internal
