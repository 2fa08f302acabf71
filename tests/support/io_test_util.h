#ifndef ALIDADE_TESTS_SUPPORT_IO_TEST_UTIL_H_
#define ALIDADE_TESTS_SUPPORT_IO_TEST_UTIL_H_

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "alidade/arm.h"
#include "alidade/error.h"

namespace alidade::internal {

/// A directory that belongs to one test case and is removed with it.
class TestDirectory {
 public:
  TestDirectory() {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    std::string name =
        std::string(info->test_suite_name()) + "." + info->name();
    for (char& c : name) {
      if (c == '/') c = '.';
    }
    path_ = std::filesystem::path(::testing::TempDir()) / ("alidade." + name);
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~TestDirectory() { std::filesystem::remove_all(path_); }
  TestDirectory(const TestDirectory&) = delete;
  TestDirectory& operator=(const TestDirectory&) = delete;

  std::string Path(const std::string& name) const {
    return (path_ / name).string();
  }
  std::string Write(const std::string& name, const std::string& text) const {
    std::ofstream(Path(name), std::ios::binary) << text;
    return Path(name);
  }

 private:
  std::filesystem::path path_;
};

/// What an InputError is expected to say. Zero and empty mean "says none";
/// `message` is a distinctive part.
struct ExpectedError {
  int line;
  int column;
  std::string key;
  std::string message;
};

/// Calls `call` and compares the InputError that it must throw.
template <typename Call>
void ExpectInputError(const Call& call, const ExpectedError& expected) {
  try {
    call();
  } catch (const InputError& error) {
    EXPECT_EQ(error.location().line, expected.line) << error.what();
    EXPECT_EQ(error.location().column, expected.column) << error.what();
    EXPECT_EQ(error.location().key, expected.key) << error.what();
    EXPECT_NE(error.message().find(expected.message), std::string::npos)
        << error.what() << "\n  has no part\n"
        << expected.message;
    EXPECT_EQ(error.message().find('\n'), std::string::npos) << error.what();
    return;
  }
  ADD_FAILURE() << "no InputError, expected one with: " << expected.message;
}

inline std::string SourcePath(const std::string& path) {
  return std::string(ALIDADE_SOURCE_DIR) + "/" + path;
}

}  // namespace alidade::internal

#endif  // ALIDADE_TESTS_SUPPORT_IO_TEST_UTIL_H_
