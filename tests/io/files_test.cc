#include "alidade/io/files.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "tests/io/io_test_util.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;

std::size_t NumFiles(const std::string& directory) {
  std::size_t count = 0;
  for (const auto& entry : fs::directory_iterator(directory)) {
    count += entry.exists() ? 1 : 0;
  }
  return count;
}

TEST(ReadFileTest, GivesEveryByte) {
  const TestDirectory directory;
  const std::string content("a\0b\r\n\xff", 6);
  EXPECT_EQ(ReadFile(directory.Write("x", content)), content);
  EXPECT_EQ(ReadFile(directory.Write("empty", "")), "");
}

TEST(ReadFileTest, ReadsFilesLargerThanItsBuffer) {
  const TestDirectory directory;
  const std::string content(300000, 'x');
  EXPECT_EQ(ReadFile(directory.Write("x", content)), content);
}

TEST(ReadFileTest, NamesAMissingFile) {
  const TestDirectory directory;
  const std::string path = directory.Path("none.yaml");
  try {
    ReadFile(path);
    FAIL() << "expected an InputError";
  } catch (const InputError& error) {
    EXPECT_EQ(error.location().file, path);
    EXPECT_EQ(error.message(), "cannot be read: No such file or directory");
  }
}

TEST(ReadFileTest, RefusesADirectory) {
  const TestDirectory directory;
  ExpectInputError([&] { ReadFile(directory.Path("")); },
                   {0, 0, "", "Is a directory"});
}

TEST(WriteFileAtomicallyTest, ReplacesAFileAndLeavesNothingElse) {
  const TestDirectory directory;
  const std::string path = directory.Write("x", "old and longer");
  WriteFileAtomically(path, "new");
  EXPECT_EQ(ReadFile(path), "new");
  EXPECT_EQ(NumFiles(directory.Path("")), 1U);
}

TEST(WriteFileAtomicallyTest, GivesTheModeOfANewFile) {
  const TestDirectory directory;
  const mode_t mask = umask(0027);
  WriteFileAtomically(directory.Path("x"), "text");
  umask(mask);
  struct stat status = {};
  ASSERT_EQ(stat(directory.Path("x").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0640U);
}

TEST(WriteFileAtomicallyTest, RemovesTheTemporaryFileOnFailure) {
  const TestDirectory directory;
  // A file cannot take the place of a directory.
  MakeDirectories(directory.Path("taken"));
  const std::string path = directory.Path("taken");
  ExpectInputError([&] { WriteFileAtomically(path, "text"); },
                   {0, 0, "", "cannot be written: Is a directory"});
  EXPECT_EQ(NumFiles(directory.Path("")), 1U);
}

TEST(WriteFileAtomicallyTest, NamesADirectoryThatDoesNotExist) {
  const TestDirectory directory;
  const std::string path = directory.Path("none/x");
  ExpectInputError([&] { WriteFileAtomically(path, "text"); },
                   {0, 0, "", "cannot be written: No such file"});
}

TEST(MakeDirectoriesTest, MakesParentsAndAcceptsWhatExists) {
  const TestDirectory directory;
  MakeDirectories(directory.Path("a/b/c"));
  MakeDirectories(directory.Path("a/b/c"));
  EXPECT_TRUE(fs::is_directory(directory.Path("a/b/c")));
}

TEST(MakeDirectoriesTest, RefusesAPathThatLeadsThroughAFile) {
  const TestDirectory directory;
  directory.Write("x", "");
  ExpectInputError([&] { MakeDirectories(directory.Path("x/y")); },
                   {0, 0, "", "directory cannot be made: Not a directory"});
}

// FIPS 180-2, appendix B.
TEST(Sha256Test, GivesThePublishedDigests) {
  EXPECT_EQ(Sha256("abc"),
            "ba7816bf8f01cfea414140de5dae2223"
            "b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(Sha256(""),
            "e3b0c44298fc1c149afbf4c8996fb924"
            "27ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(Sha256(std::string(1000000, 'a')),
            "cdc76e5c9914fb9281a1c7e284d73e67"
            "f1809a48a497200e046d39ccc7112cd0");
}

TEST(ResolvePathTest, SeesPathsFromTheDirectoryOfTheFile) {
  EXPECT_EQ(ResolvePath("configs/jobs/a.yaml", "b.csv"), "configs/jobs/b.csv");
  EXPECT_EQ(ResolvePath("configs/jobs/a.yaml", "../../data/b.csv"),
            "data/b.csv");
  EXPECT_EQ(ResolvePath("a.yaml", "b.csv"), "b.csv");
  EXPECT_EQ(ResolvePath("a.yaml", "../b.csv"), "../b.csv");
  EXPECT_EQ(ResolvePath("/x/a.yaml", "./b.csv"), "/x/b.csv");
}

TEST(ResolvePathTest, LeavesAbsolutePathsAlone) {
  EXPECT_EQ(ResolvePath("configs/a.yaml", "/data/../b.csv"), "/data/../b.csv");
}

TEST(ResolvePathTest, KeepsDotsThatLeaveASymbolicLink) {
  const TestDirectory directory;
  MakeDirectories(directory.Path("real/inner"));
  fs::create_directory_symlink(directory.Path("real/inner"),
                               directory.Path("link"));
  WriteFileAtomically(directory.Path("real/b.csv"), "text");
  const std::string path =
      ResolvePath(directory.Path("link/a.yaml"), "../b.csv");
  EXPECT_EQ(ReadFile(path), "text");
}

TEST(WriteFileAtomicallyTest, PipesAndDevicesAreNotReplaced) {
  const std::string pipe = ::testing::TempDir() + "alidade_files_test_pipe";
  unlink(pipe.c_str());
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_THROW(WriteFileAtomically(pipe, "text"), InputError);
  EXPECT_TRUE(std::filesystem::is_fifo(pipe));
  unlink(pipe.c_str());
}

TEST(WriteFileAtomicallyTest, LinksStayAndTheirTargetsAreWritten) {
  const std::string target = ::testing::TempDir() + "alidade_files_test_target";
  const std::string link = ::testing::TempDir() + "alidade_files_test_link";
  unlink(link.c_str());
  WriteFileAtomically(target, "before");
  std::filesystem::create_symlink(target, link);
  WriteFileAtomically(link, "after");
  EXPECT_TRUE(std::filesystem::is_symlink(link));
  EXPECT_EQ(ReadFile(target), "after");
  unlink(link.c_str());
  unlink(target.c_str());
}

}  // namespace
}  // namespace alidade
