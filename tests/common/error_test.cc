#include "alidade/error.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

namespace alidade::internal {
namespace {

std::string What(const SourceLocation& location) {
  return InputError(location, "expected a number").what();
}

TEST(InputErrorTest, PrintsTheWholeLocation) {
  EXPECT_EQ(What({"arm.yaml", 12, 7, "joints[2].limits"}),
            "arm.yaml:12:7: joints[2].limits: expected a number");
}

TEST(InputErrorTest, LeavesOutWhatIsNotKnown) {
  EXPECT_EQ(What({}), "expected a number");
  EXPECT_EQ(What({"arm.yaml", 0, 0, ""}), "arm.yaml: expected a number");
  EXPECT_EQ(What({"arm.yaml", 3, 0, ""}), "arm.yaml:3: expected a number");
  EXPECT_EQ(What({"arm.yaml", 3, 4, ""}), "arm.yaml:3:4: expected a number");
  EXPECT_EQ(What({"data.csv", 5, 0, "x"}), "data.csv:5: x: expected a number");
  EXPECT_EQ(What({"", 0, 0, "--threads"}), "--threads: expected a number");
}

TEST(InputErrorTest, AColumnWithoutALineIsLeftOut) {
  EXPECT_EQ(What({"arm.yaml", 0, 4, ""}), "arm.yaml: expected a number");
}

TEST(InputErrorTest, KeepsItsParts) {
  const InputError error({"arm.yaml", 12, 7, "joints"}, "is empty");
  EXPECT_EQ(error.location().file, "arm.yaml");
  EXPECT_EQ(error.location().line, 12);
  EXPECT_EQ(error.location().column, 7);
  EXPECT_EQ(error.location().key, "joints");
  EXPECT_EQ(error.message(), "is empty");
}

TEST(InputErrorTest, NamesOfAnyCharactersStayOnOneLine) {
  const InputError error({"a.npy", 0, 0, "q1\n\tdeg"}, "is unknown");
  EXPECT_STREQ(error.what(), "a.npy: q1\\n\\x09deg: is unknown");
}

TEST(InputErrorTest, TextsAndFilesToo) {
  const InputError error({"a\nb.yaml", 0, 0, ""}, "\"x\x1b[2J\" is unknown");
  EXPECT_STREQ(error.what(), "a\\nb.yaml: \"x\\x1b[2J\" is unknown");
  EXPECT_EQ(error.message(), "\"x\\x1b[2J\" is unknown");
}

TEST(InputErrorTest, IsARuntimeError) {
  try {
    throw InputError({"arm.yaml", 1, 1, ""}, "is empty");
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "arm.yaml:1:1: is empty");
  }
}

}  // namespace
}  // namespace alidade::internal
