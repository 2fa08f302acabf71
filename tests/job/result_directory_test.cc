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

// A run that ends in between leaves no result.json, and the next one knows what
// may be there.
TEST(WriteResultDirectoryTest, IsNoResultUntilAllIsWritten) {
  const testing::TemporaryDirectory scratch;
  const std::string directory = scratch / "result";
  WriteResultDirectory(directory, {{"arm.yaml", "1"}, {"result.json", "1"}});
  // Too long for a file's name.
  EXPECT_THROW(WriteResultDirectory(directory, {{"residuals.csv", "2"},
                                                {std::string(300, 'h'), "2"},
                                                {"result.json", "2"}}),
               InputError);
  EXPECT_TRUE(fs::exists(directory + "/residuals.csv"));
  EXPECT_FALSE(fs::exists(directory + "/result.json"));
  WriteResultDirectory(directory, {{"arm.yaml", "3"}, {"result.json", "3"}});
  EXPECT_THAT(NamesIn(directory),
              UnorderedElementsAre("arm.yaml", "result.json"));
}

// A table that fails while it is made is as if it had never been begun.
TEST(WriteResultDirectoryTest, LeavesNothingOfATableThatFails) {
  const testing::TemporaryDirectory scratch;
  const std::string directory = scratch / "result";
  const auto fail = [](const TextSink& sink) {
    sink("pose\n1\n");
    throw std::runtime_error("out of rows");
  };
  EXPECT_THROW(WriteResultDirectory(directory, {{"arm.yaml", "1"},
                                                {"residuals.csv", fail},
                                                {"result.json", "1"}}),
               std::runtime_error);
  EXPECT_THAT(NamesIn(directory), UnorderedElementsAre("arm.yaml"));
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
