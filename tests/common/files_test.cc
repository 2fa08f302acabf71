#include "src/common/files.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "src/common/file_descriptor.h"
#include "tests/support/io_test_util.h"

namespace alidade::internal {
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

// `count` pieces of 1000 bytes, each of another letter.
TextSource Letters(int count) {
  return [count](const TextSink& sink) {
    for (int i = 0; i < count; ++i) {
      sink(std::string(1000, static_cast<char>('a' + i % 26)));
    }
  };
}

// Gives some of its text and then fails.
void GiveHalf(const TextSink& sink) {
  sink(std::string(100000, 'x'));
  throw std::runtime_error("out of rows");
}

// As long as it lives, files end at a size, as on a full disk: a write gives
// EFBIG.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit full = {bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &full);
  }
  ~FullDisk() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  void (*const handler_)(int);
  rlimit before_ = {};
};

TEST(WritePiecesTest, GivesTheBytesOfTheWholeAndTheirNumber) {
  const TestDirectory directory;
  std::string whole;
  Letters(300)([&](std::string_view piece) { whole += piece; });
  ASSERT_EQ(whole.size(), 300000U);
  const std::string path = directory.Write("x", "old");
  EXPECT_EQ(WriteFileAtomically(path, Letters(300)), 300000U);
  EXPECT_EQ(ReadFile(path), whole);
  EXPECT_EQ(WriteNewFile(directory.Path("new"), Letters(300)), 300000U);
  EXPECT_EQ(ReadFile(directory.Path("new")), whole);
  EXPECT_EQ(WriteNewFile(directory.Path("empty"), Letters(0)), 0U);
  EXPECT_EQ(ReadFile(directory.Path("empty")), "");
  EXPECT_EQ(NumFiles(directory.Path("")), 3U);
}

TEST(WritePiecesTest, LeavesNothingOfASourceThatFails) {
  const TestDirectory directory;
  const std::string old = directory.Write("old", "as it was");
  EXPECT_THROW(WriteFileAtomically(old, GiveHalf), std::runtime_error);
  EXPECT_THROW(WriteFileAtomically(directory.Path("a"), GiveHalf),
               std::runtime_error);
  EXPECT_THROW(WriteNewFile(directory.Path("b"), GiveHalf), std::runtime_error);
  EXPECT_EQ(ReadFile(old), "as it was");
  EXPECT_EQ(NumFiles(directory.Path("")), 1U);
}

TEST(WritePiecesTest, LeavesNothingWhereTheDiskIsFull) {
  const TestDirectory directory;
  const std::string old = directory.Write("old", "as it was");
  const ExpectedError expected = {0, 0, "", "cannot be written: File too"};
  {
    const FullDisk disk(100500);  // in the middle of a piece
    ExpectInputError([&] { WriteFileAtomically(old, Letters(300)); }, expected);
    ExpectInputError([&] { WriteNewFile(directory.Path("new"), Letters(300)); },
                     expected);
    EXPECT_EQ(WriteNewFile(directory.Path("fits"), Letters(100)), 100000U);
  }
  EXPECT_EQ(ReadFile(old), "as it was");
  EXPECT_EQ(NumFiles(directory.Path("")), 2U);
}

TEST(WritePiecesTest, ReplacesNoFileByANewOne) {
  const TestDirectory directory;
  const std::string path = directory.Write("x", "as it was");
  ExpectInputError([&] { WriteNewFile(path, Letters(1)); },
                   {0, 0, "", "cannot be written: File exists"});
  EXPECT_EQ(ReadFile(path), "as it was");
}

TEST(FileDescriptorTest, TellsThatTheDeviceIsFull) {
  const FileDescriptor full("/dev/full", O_WRONLY);
  ASSERT_GE(full.get(), 0);
  EXPECT_FALSE(full.WriteAll("text"));
  EXPECT_EQ(errno, ENOSPC);
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

TEST(RemoveTemporariesTest, RemovesWhatKilledProcessesLeftAndNothingElse) {
  const TestDirectory directory;
  std::vector<std::string> left;
  for (const char* name :
       {"summary.json.tmp-123-4", "a.tmp-b.tmp-1-2", ".tmp-0-0"}) {
    left.push_back(directory.Write(name, "{"));
  }
  std::vector<std::string> mine;
  for (const char* name :
       {"summary.json", "notes.tmp-today", "a.tmp-1", "a.tmp--1", "a.tmp-1-",
        "a.tmp-1-2-3", "a.tmp-1-2.csv", "a.tmp-1-2 "}) {
    mine.push_back(directory.Write(name, "kept"));
  }
  RemoveTemporaries(fs::path(left[0]).parent_path().string());
  for (const std::string& path : left) {
    EXPECT_FALSE(std::filesystem::exists(path)) << path;
  }
  for (const std::string& path : mine) {
    EXPECT_TRUE(std::filesystem::exists(path)) << path;
  }
}

}  // namespace
}  // namespace alidade::internal
