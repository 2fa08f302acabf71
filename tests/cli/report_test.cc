// `alidade report` and `calibrate --report`. What the pages show is looked at
// in a browser: tests/browser.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/support/process.h"

namespace alidade::internal::report_test {
namespace {

namespace fs = std::filesystem;

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::ProcessResult;
using testing::ReadWhole;
using testing::TemporaryDirectory;
using testing::WriteWhole;

const std::string kSource = ALIDADE_SOURCE_DIR;

class ReportTest : public ::testing::Test {
 protected:
  ProcessResult Alidade(const std::string& arguments) {
    return testing::RunIn(directory_.path(),
                          std::string(ALIDADE_BINARY) + " " + arguments);
  }

  void Calibrate(const std::string& flags) {
    ASSERT_EQ(Alidade("calibrate " + kSource +
                      "/configs/jobs/rv2aj_flange.yaml " + flags)
                  .status,
              0);
  }

  void ExpectRefused(const ProcessResult& result, const std::string& message) {
    EXPECT_EQ(result.status, 2);
    EXPECT_THAT(result.err, HasSubstr(message));
    EXPECT_THAT(result.out, IsEmpty());
  }

  TemporaryDirectory directory_;
};

TEST_F(ReportTest, CalibrateWritesThePageThatReportMakes) {
  Calibrate("--out=result --report");
  const std::string with_result = ReadWhole(directory_ / "result/report.html");
  EXPECT_THAT(with_result, HasSubstr("<!DOCTYPE html>"));
  const ProcessResult result = Alidade("report result");
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(result.out, "result/report.html\n");
  EXPECT_EQ(ReadWhole(directory_ / "result/report.html").size(),
            with_result.size());
  EXPECT_EQ(Alidade("report result/result.json --out=pages").out,
            "pages/report.html\n");
  EXPECT_EQ(Alidade("report result --out=one.html").out, "one.html\n");
  EXPECT_TRUE(fs::exists(directory_ / "one.html"));
}

TEST_F(ReportTest, SeveralResultsMakeOnePage) {
  Calibrate("--out=a");
  Calibrate("--out=b");
  EXPECT_FALSE(fs::exists(directory_ / "a/report.html"));
  const ProcessResult result = Alidade("report a b --read-as=time");
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(result.out, "comparison.html\n");
  // Into a result's own folder: its page stays.
  testing::WriteWhole(directory_ / "a/report.html", "its own");
  EXPECT_EQ(Alidade("report a b --out=a").out, "a/comparison.html\n");
  EXPECT_EQ(ReadWhole(directory_ / "a/report.html"), "its own");
  EXPECT_THAT(ReadWhole(directory_ / "comparison.html"),
              HasSubstr("id=\"read-as-2\" checked>"));
}

TEST_F(ReportTest, WrongInputIsToldAndNothingWritten) {
  ExpectRefused(Alidade("report"), "expected RESULT...");
  ExpectRefused(Alidade("report nowhere"), "nowhere");
  WriteWhole(directory_ / "bad/result.json", "{\"format\": ");
  ExpectRefused(Alidade("report bad"), "bad/result.json:1:");
  Calibrate("--out=a");
  ExpectRefused(Alidade("report a a --read-as=fleets"),
                "expected fleet, time or methods");
  ExpectRefused(Alidade("report a bad"), "bad/result.json:1:");
  EXPECT_FALSE(fs::exists(directory_ / "comparison.html"));
  EXPECT_FALSE(fs::exists(directory_ / "bad/report.html"));
}

}  // namespace
}  // namespace alidade::internal::report_test
