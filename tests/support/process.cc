#include "tests/support/process.h"

namespace alidade::internal::testing {

std::string ReadWhole(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

void WriteWhole(const std::filesystem::path& path, const std::string& text) {
  std::filesystem::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary) << text;
}

ProcessResult RunProcess(const std::string& command) {
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

ProcessResult RunIn(const std::filesystem::path& directory,
                    const std::string& command) {
  return RunProcess("cd " + directory.string() + " && " + command);
}

}  // namespace alidade::internal::testing
