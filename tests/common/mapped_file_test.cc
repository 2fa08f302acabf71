#include "src/common/mapped_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <string>
#include <thread>
#include <utility>

#include "src/common/files.h"
#include "tests/support/io_test_util.h"

namespace alidade::internal {
namespace {

TEST(MappedFileTest, HasTheBytesOfAFile) {
  const TestDirectory directory;
  const std::string text("a\0b\n", 4);
  const MappedFile file(directory.Write("file", text));
  EXPECT_EQ(file.text(), text);
  EXPECT_EQ(file.path(), directory.Path("file"));
}

TEST(MappedFileTest, EmptyFilesAndGivenTextsAreNotMapped) {
  const TestDirectory directory;
  EXPECT_EQ(MappedFile(directory.Write("empty", "")).text(), "");
  EXPECT_EQ(MappedFile("nowhere", "text").text(), "text");
}

TEST(MappedFileTest, MovesWithItsBytes) {
  const TestDirectory directory;
  MappedFile file(directory.Write("file", "mapped"));
  MappedFile text("nowhere", "short");
  const MappedFile moved_file(std::move(file));
  const MappedFile moved_text(std::move(text));
  EXPECT_EQ(moved_file.text(), "mapped");
  EXPECT_EQ(moved_text.text(), "short");
}

// Nobody writes to the pipe, and the device never ends.
TEST(MappedFileTest, PipesAndDevicesAreRefusedAtOnce) {
  const TestDirectory directory;
  const std::string path = directory.Path("pipe");
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  for (const std::string& endless : {path, std::string("/dev/zero")}) {
    ExpectInputError([&] { MappedFile{endless}; },
                     {0, 0, "", "is a pipe or a device"});
  }
}

// 20 GB of zeros that take no room.
TEST(MappedFileTest, FilesOfHolesAreRefusedAtOnce) {
  const TestDirectory directory;
  const std::string path = directory.Write("holes.csv", "q1,x_mm\n");
  ASSERT_EQ(truncate(path.c_str(), off_t{20000000000}), 0);
  ExpectInputError([&] { MappedFile{path}; }, {0, 0, "", "holds almost none"});
  ExpectInputError([&] { ReadFile(path); }, {0, 0, "", "holds almost none"});
  // Small ones may have some.
  ASSERT_EQ(truncate(path.c_str(), 100000), 0);
  EXPECT_EQ(MappedFile(path).text().size(), 100000U);
}

TEST(MappedFileTest, SaysWhyAFileCannotBeRead) {
  const TestDirectory directory;
  ExpectInputError([&] { MappedFile{directory.Path("none")}; },
                   {0, 0, "", "No such file"});
  ExpectInputError([&] { MappedFile{directory.Path(".")}; },
                   {0, 0, "", "directory"});
}

}  // namespace
}  // namespace alidade::internal
