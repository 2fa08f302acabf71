#ifndef ALIDADE_SRC_SERIALIZATION_JOB_LIST_H_
#define ALIDADE_SRC_SERIALIZATION_JOB_LIST_H_

#include <string>
#include <vector>

namespace alidade::internal {

/// The paths in a list: one a line, relative to the list's folder; empty lines
/// and those that begin with '#' are passed over. @throws InputError.
std::vector<std::string> ReadJobList(const std::string& path);
/// The same of a list's text.
std::vector<std::string> ParseJobList(const std::string& text,
                                      const std::string& path);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_JOB_LIST_H_
