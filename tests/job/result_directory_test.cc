#include "src/job/result_directory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <stdexcept>
#include <string>

#include "alidade/error.h"
#include "tests/support/process.h"

namespace alidade::internal {
namespace {

using ::testing::UnorderedElementsAre;

namespace fs = std::filesystem;

std::set<std::string> NamesIn(const std::string& directory) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(directory)) {
    const std::string name = entry.path().filename().string();
    if (name.front() != '.') names.insert(name);
  }
  return names;
}

std::set<std::string> EverythingIn(const std::string& directory) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(directory)) {
    names.insert(entry.path().filename().string());
  }
  return names;
}

TEST(WriteResultDirectoryTest, LeavesNothingOfAnEarlierResult) {
  const testing::TemporaryDirectory scratch;
  const std::string directory = scratch / "result";
  WriteResultDirectory(
      directory,
      {{"arm.yaml", "1"}, {"residuals.csv", "1"}, {"result.json", "1"}});
  testing::WriteWhole(directory + "/report.html",
                      "by `report`: <style id=\"page-style\">");
  testing::WriteWhole(directory + "/notes.txt", "of the user");
  WriteResultDirectory(directory, {{"arm.yaml", "2"}, {"result.json", "2"}});
  EXPECT_THAT(NamesIn(directory),
              UnorderedElementsAre("arm.yaml", "result.json", "notes.txt"));
  EXPECT_EQ(testing::ReadWhole(directory + "/arm.yaml"), "2");
  EXPECT_EQ(testing::ReadWhole(directory + "/result.json"), "2");
}

// Whatever goes wrong while files are written, the old result stays whole.
TEST(WriteResultDirectoryTest, IsWholeOrOld) {
  const testing::TemporaryDirectory scratch;
  const std::string directory = scratch / "result";
  WriteResultDirectory(directory, {{"arm.yaml", "1"}, {"result.json", "1"}});
  // Too long for a file's name.
  EXPECT_THROW(WriteResultDirectory(directory, {{"residuals.csv", "2"},
                                                {std::string(300, 'h'), "2"},
                                                {"result.json", "2"}}),
               InputError);
  const auto fail = [](const TextSink& sink) {
    sink("pose\n1\n");
    throw std::runtime_error("out of rows");
  };
  EXPECT_THROW(WriteResultDirectory(directory, {{"arm.yaml", "3"},
                                                {"residuals.csv", fail},
                                                {"result.json", "3"}}),
               std::runtime_error);
  EXPECT_THAT(NamesIn(directory),
              UnorderedElementsAre("arm.yaml", "result.json"));
  EXPECT_EQ(testing::ReadWhole(directory + "/arm.yaml"), "1");
  EXPECT_EQ(testing::ReadWhole(directory + "/result.json"), "1");
  EXPECT_THAT(EverythingIn(scratch.path()), UnorderedElementsAre("result"));
}

// What a killed run has left beside the directory or in it: a result that was
// being written, and the old one after the exchange, with a folder of the user
// that had not yet moved on.
TEST(WriteResultDirectoryTest, AFailureNamesThePlaceAndLeavesNoNewDirectory) {
  const testing::TemporaryDirectory scratch;
  const std::string directory = scratch / "new";
  const std::string too_long(300, 'a');
  try {
    WriteResultDirectory(directory, {{"arm.yaml", "1"}, {too_long, "1"}});
    ADD_FAILURE() << "nothing was thrown";
  } catch (const InputError& error) {
    EXPECT_EQ(error.location().file, directory + "/" + too_long);
    EXPECT_THAT(error.message(), ::testing::HasSubstr("choose another --out"));
  }
  EXPECT_FALSE(fs::exists(directory));
}

TEST(WriteResultDirectoryTest, ClearsWhatAKilledRunLeft) {
  const testing::TemporaryDirectory scratch;
  const std::string directory = scratch / "result";
  WriteResultDirectory(directory, {{"result.json", "1"}});
  const std::string begun = scratch / ".result.alidade-staged-1-0";
  const std::string old = scratch / ".result.alidade-staged-2-0";
  const std::string inside = directory + "/.alidade-staged-3-0";
  for (const std::string& left : {begun, old, inside}) {
    fs::create_directory(left);
    testing::WriteWhole(left + "/arm.yaml", "0");
  }
  testing::WriteWhole(old + "/.alidade-files", "arm.yaml\n");
  fs::create_directory(old + "/photos");
  testing::WriteWhole(old + "/photos/1", "kept");
  WriteResultDirectory(directory, {{"result.json", "2"}});
  EXPECT_THAT(EverythingIn(scratch.path()), UnorderedElementsAre("result"));
  EXPECT_THAT(EverythingIn(directory),
              UnorderedElementsAre(".alidade-files", "result.json", "photos"));
  EXPECT_EQ(testing::ReadWhole(directory + "/photos/1"), "kept");
}

// Where the directory has the current one in it, it is not exchanged; through a
// link it is, and the link stays one.
TEST(WriteResultDirectoryTest, WritesToTheCurrentDirectoryAndThroughLinks) {
  const testing::TemporaryDirectory scratch;
  const std::string directory = scratch / "result";
  WriteResultDirectory(directory, {{"arm.yaml", "1"}, {"result.json", "1"}});
  const fs::path before = fs::current_path();
  fs::current_path(directory);
  WriteResultDirectory(".", {{"report.txt", "2"}, {"result.json", "2"}});
  EXPECT_EQ(testing::ReadWhole("result.json"), "2");
  EXPECT_EQ(fs::current_path(), fs::canonical(directory));
  fs::current_path(before);
  EXPECT_THAT(
      EverythingIn(directory),
      UnorderedElementsAre(".alidade-files", "report.txt", "result.json"));
  fs::create_symlink("result", scratch / "link");
  WriteResultDirectory(scratch / "link", {{"result.json", "3"}});
  EXPECT_TRUE(fs::is_symlink(scratch / "link"));
  EXPECT_THAT(EverythingIn(directory),
              UnorderedElementsAre(".alidade-files", "result.json"));
  EXPECT_EQ(testing::ReadWhole(directory + "/result.json"), "3");
}

// A link where the list should be leads nowhere.
TEST(WriteResultDirectoryTest, WritesThroughNoPlantedLink) {
  const testing::TemporaryDirectory scratch;
  const std::string directory = scratch / "result";
  fs::create_directory(directory);
  testing::WriteWhole(scratch / "precious", "stays");
  fs::create_symlink("../precious", directory + "/.alidade-files");
  WriteResultDirectory(directory, {{"result.json", "1"}});
  EXPECT_EQ(testing::ReadWhole(scratch / "precious"), "stays");
  EXPECT_FALSE(fs::is_symlink(directory + "/.alidade-files"));
}

// A list of names that somebody has changed never leads out of the directory.
TEST(WriteResultDirectoryTest, RemovesNothingElsewhere) {
  const testing::TemporaryDirectory scratch;
  const std::string directory = scratch / "result";
  WriteResultDirectory(directory, {{"result.json", "1"}});
  testing::WriteWhole(scratch / "precious", "stays");
  testing::WriteWhole(directory + "/.alidade-files",
                      "../precious\n.\n..\n\nresult.json\n");
  WriteResultDirectory(directory, {{"result.json", "2"}});
  EXPECT_TRUE(fs::exists(scratch / "precious"));
}

}  // namespace
}  // namespace alidade::internal
