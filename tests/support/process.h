#ifndef ALIDADE_TESTS_SUPPORT_PROCESS_H_
#define ALIDADE_TESTS_SUPPORT_PROCESS_H_

#include <sys/wait.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace alidade::internal::testing {

struct ProcessResult {
  int status = -1;  ///< exit status; 128 + signal where one ended it
  std::string out;
  std::string err;
};

std::string ReadWhole(const std::filesystem::path& path);

void WriteWhole(const std::filesystem::path& path, const std::string& text);

/// A directory of its own that is gone when the object is.
class TemporaryDirectory {
 public:
  TemporaryDirectory() {
    std::string name =
        (std::filesystem::temp_directory_path() / "alidade_test_XXXXXX")
            .string();
    path_ = mkdtemp(name.data());
  }
  ~TemporaryDirectory() { std::filesystem::remove_all(path_); }
  TemporaryDirectory(const TemporaryDirectory&) = delete;
  TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::string operator/(const std::string& name) const {
    return (path_ / name).string();
  }

 private:
  std::filesystem::path path_;
};

/// Runs a command line of the shell and keeps what it prints.
ProcessResult RunProcess(const std::string& command);

/// The same in a directory.
ProcessResult RunIn(const std::filesystem::path& directory,
                    const std::string& command);

}  // namespace alidade::internal::testing

#endif  // ALIDADE_TESTS_SUPPORT_PROCESS_H_
