#include "alidade/job.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "tests/report/well_formed.h"
#include "tests/support/process.h"

namespace alidade::internal {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::ReadWhole;
using testing::TemporaryDirectory;

const std::string kJob =
    std::string(ALIDADE_SOURCE_DIR) + "/configs/jobs/rv2aj_study.yaml";

TEST(PublicJobTest, IsAValueThatCalibratesAndIsSaved) {
  const Job job = alidade::LoadJob(kJob);
  EXPECT_EQ(job.title, "Published calibration of the RV-2AJ");
  EXPECT_EQ(job.data.validation->num_poses(), 3600);
  EXPECT_EQ(job.published->figures.size(), 9u);
  EXPECT_EQ(job.input_files.front(), job.path);
  const CalibrationResult result = alidade::RunJob(job, "a command");
  ASSERT_TRUE(result.IsUsable());
  EXPECT_EQ(result.command, "a command");
  EXPECT_EQ(result.title, job.title);
  EXPECT_EQ(result.inputs.size(), job.input_files.size());
  EXPECT_FALSE(result.published_source.empty());

  const TemporaryDirectory directory;
  SaveOptions options;
  options.sections = {
      {"more",
       "More & better",
       {"In <words>",
        ReportTable{"t", "A table", {"a", ">b"}, {{"x y", "1"}}, {1, 0}},
        ReportFigure{"f", "A figure", "<svg></svg>", "A & B."}}}};
  options.files = {{"more.csv", "a,b\n"}};
  options.report_page = true;
  const auto paths = Save(result, directory / "r", options);
  EXPECT_EQ(paths.back(), directory / "r/result.json");
  EXPECT_EQ(ReadWhole(directory / "r/more.csv"), "a,b\n");
  const std::string text = ReadWhole(directory / "r/report.txt");
  EXPECT_THAT(text, HasSubstr("\nMore & better\n-------------\nIn <words>\n\n"
                              "A table\n\na  b\n-  -\nx  1\ny\n"));
  EXPECT_LT(text.find("More & better"), text.find("\nProvenance\n"));
  const std::string page = ReadWhole(directory / "r/report.html");
  const std::size_t begin = page.find("<section id=\"more\"");
  const std::size_t end = page.find("</section>", begin) + 10;
  const std::string markup = page.substr(begin, end - begin);
  EXPECT_EQ(WhatIsMalformed(markup), "");
  EXPECT_THAT(markup, AllOf(HasSubstr("More &amp; better</h2>"),
                            HasSubstr("<p>In &lt;words&gt;</p>"),
                            HasSubstr("<td class=\"right\" "
                                      "data-value=\"1\">1</td>"),
                            HasSubstr("<svg></svg></div>"
                                      "<figcaption>A &amp; B.<")));
  for (const ReportFigure& figure : Figures(result)) {
    EXPECT_EQ(WhatIsMalformed(figure.svg), "");
    const std::string file = ReadWhole(directory / ("r/" + figure.id + ".svg"));
    EXPECT_THAT(file, HasSubstr("<title>" + figure.title + "</title>"));
    EXPECT_THAT(page, HasSubstr(figure.svg));  // among those of every page
  }
  EXPECT_EQ(Figures(result).size(), 5u);

  // What is saved there next has nothing of it.
  Save(result, directory / "r");
  EXPECT_FALSE(std::filesystem::exists(directory / "r/more.csv"));
  EXPECT_FALSE(std::filesystem::exists(directory / "r/report.html"));
}

}  // namespace
}  // namespace alidade::internal
