// What the program shows of work that takes its time, to people at a terminal
// and to them alone.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/support/process.h"

namespace alidade::internal::progress_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using testing::ProcessResult;

std::string Calibrate(const std::string& directory) {
  return std::string(ALIDADE_BINARY) + " calibrate " + ALIDADE_SOURCE_DIR +
         "/configs/jobs/rv2aj_flange.yaml --out=" + directory;
}

TEST(ProgressTest, IsShownOnATerminalAndTakenAway) {
  const testing::TemporaryDirectory scratch;
  // Of both streams, as the terminal gets them.
  const ProcessResult result = testing::RunProcess(
      "script --quiet --return --command '" + Calibrate(scratch / "result") +
      "' /dev/null </dev/null");
  EXPECT_EQ(result.status, 0) << result.out;
  EXPECT_THAT(result.out, HasSubstr("\r\x1b[Kreading "));
  EXPECT_THAT(result.out, HasSubstr("\r\x1b[K56 poses, iteration "));
  // The results are on a line that is clean.
  EXPECT_THAT(result.out, HasSubstr("\r\x1b[KRV-2AJ measured at the flange"));
}

TEST(ProgressTest, IsNotInALog) {
  const testing::TemporaryDirectory scratch;
  const ProcessResult result =
      testing::RunProcess(Calibrate(scratch / "result"));
  EXPECT_EQ(result.status, 0);
  EXPECT_THAT(result.err, Not(HasSubstr("\r")));
  EXPECT_THAT(result.err, Not(HasSubstr("iteration")));
}

}  // namespace
}  // namespace alidade::internal::progress_test
