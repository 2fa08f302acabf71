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

inline std::string ReadWhole(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

inline void WriteWhole(const std::filesystem::path& path,
                       const std::string& text) {
  std::filesystem::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary) << text;
}

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
inline ProcessResult RunProcess(const std::string& command) {
  const TemporaryDirectory scratch;
  const std::string out = scratch / "out";
  const std::string err = scratch / "err";
  const int raw =
      std::system(("( " + command + " ) >" + out + " 2>" + err).c_str());
  ProcessResult result;
  result.status = WIFEXITED(raw) ? WEXITSTATUS(raw) : 128 + WTERMSIG(raw);
  result.out = ReadWhole(out);
  result.err = ReadWhole(err);
  return result;
}

/// The same in a directory.
inline ProcessResult RunIn(const std::filesystem::path& directory,
                           const std::string& command) {
  return RunProcess("cd " + directory.string() + " && " + command);
}

}  // namespace alidade::internal::testing

#endif  // ALIDADE_TESTS_SUPPORT_PROCESS_H_
