#include "src/report/html_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "src/report/html_json.h"
#include "src/report/result_table.h"

namespace alidade::internal {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

// The JSON that the page carries, by an independent parser.
json DataOf(const std::string& page) {
  const std::string mark = "id=\"alidade-data\">";
  const std::size_t from = page.find(mark) + mark.size();
  return json::parse(page.substr(from, page.find("</script>", from) - from));
}

TEST(HtmlJsonTest, TextReadsBackAndCannotEndAScript) {
  const std::string hostile = "</script><!--\"\\\n\t\x01 caf\xc3\xa9";
  const std::string text = JsonText(hostile);
  EXPECT_THAT(text, Not(HasSubstr("<")));
  EXPECT_EQ(json::parse(text).get<std::string>(), hostile);
}

TEST(HtmlJsonTest, NumbersAreShortAndNeverInvalid) {
  EXPECT_EQ(JsonNumber(0.1234567, 3), "0.123");
  EXPECT_EQ(JsonNumber(-2.5e-13, 4), "-2.5e-13");
  EXPECT_EQ(JsonNumber(-0.0, 4), "0");
  EXPECT_EQ(JsonNumber(std::numeric_limits<double>::quiet_NaN(), 4), "null");
  EXPECT_EQ(JsonNumber(std::numeric_limits<double>::infinity(), 4), "null");
}

TEST(HtmlJsonTest, CompactDocumentMeansTheSame) {
  const json document = {{"text", "a  \"quoted\\\" <b>\n"},
                         {"list", {1, 2.5, -1e-300, nullptr, true}},
                         {"third", 1.0 / 3.0},
                         {"seed", 18446744073709551615U}};
  const std::string compact = CompactJson(document.dump(2), 0);
  EXPECT_EQ(json::parse(compact), document);
  EXPECT_THAT(compact, Not(HasSubstr("\n")));
  EXPECT_THAT(compact, Not(HasSubstr("<")));
  const json rounded = json::parse(CompactJson(document.dump(2), 7));
  EXPECT_EQ(rounded["third"].get<double>(), 0.3333333);
  EXPECT_EQ(rounded["seed"], document["seed"]);
  EXPECT_EQ(rounded["text"], document["text"]);
}

void ExpectTable(const ResultTable& table) {
  ASSERT_EQ(table.columns,
            (std::vector<std::string>{"pose", "target", "x_mm"}));
  ASSERT_EQ(table.rows.size(), 3U);
  EXPECT_EQ(table.rows[0][1], "a, \"b\"");
  EXPECT_EQ(table.Number(0, table.Column("x_mm")), 2.5);
  EXPECT_TRUE(std::isnan(table.Number(1, table.Column("x_mm"))));
  EXPECT_TRUE(std::isnan(table.Number(2, table.Column("x_mm"))));
  EXPECT_EQ(table.Column("y_mm"), -1);
}

TEST(ResultTableTest, ReadsQuotedCellsAndShortRows) {
  const std::string csv = "pose,target,x_mm\r\n1,\"a, \"\"b\"\"\",2.5\n2,,\n3";
  // In one piece, and in pieces of a character each.
  for (const TextSource& source :
       {WholeText(csv), TextSource([csv](const TextSink& sink) {
          for (const char& c : csv) sink({&c, 1});
        })}) {
    ExpectTable(ReadResultTable(source, 100));
  }
  EXPECT_TRUE(ReadResultTable(WholeText(""), 100).columns.empty());
}

TEST(ResultTableTest, ThinningKeepsTheWorst) {
  std::string csv = "pose,after_error_mm\n";
  for (int i = 1; i <= 1000; ++i) {
    csv += std::to_string(i) + (i == 778 ? ",9.87654321\n" : ",0.1\n");
  }
  const json table =
      json::parse(TableJson(ReadResultTable(WholeText(csv), 100)));
  EXPECT_EQ(table["total"], 1000);
  const auto index = table["index"].get<std::vector<int>>();
  const auto errors =
      table["columns"]["after_error_mm"].get<std::vector<double>>();
  ASSERT_EQ(index.size(), errors.size());
  // Every tenth, and fifty of the worst, of which some are among those.
  EXPECT_GE(index.size(), 100U);
  EXPECT_LE(index.size(), 150U);
  EXPECT_TRUE(std::is_sorted(index.begin(), index.end()));
  const auto worst = std::find(index.begin(), index.end(), 778);
  ASSERT_NE(worst, index.end());
  EXPECT_EQ(errors[worst - index.begin()], 9.877);  // four digits
}

TEST(ResultPageTest, HoldsItsSourcesAndNothingFromElsewhere) {
  ReportSource source;
  source.label = "job";
  source.title = "<script>alert(1)</script>";
  source.result_json = "{\"title\": \"<script>alert(1)</script>\", \"n\": 3}";
  source.report_text = "first line\n<b>second</b>\n";
  source.residuals_csv = WholeText("pose,x_mm\n1,12.5\n");
  ArmPicture picture;
  picture.instrument_from_base.setZero();
  picture.instrument_from_base(2, 3) = 0.25;
  picture.poses = {1};
  picture.lines.push_back(Eigen::Matrix3Xd::Constant(3, 2, 0.1));
  source.picture = picture;
  const std::string page = RenderResultPage(source);
  EXPECT_THAT(page, Not(HasSubstr("<script>alert")));
  EXPECT_THAT(page, HasSubstr("first line\n&lt;b&gt;second&lt;/b&gt;\n"));
  EXPECT_THAT(page, Not(HasSubstr("{{")));
  // The only address is the name space of SVG.
  for (std::size_t at = page.find("http"); at != std::string::npos;
       at = page.find("http", at + 1)) {
    const std::string rest = page.substr(at, 32);
    EXPECT_TRUE(rest.rfind("http-equiv", 0) == 0 ||
                rest.rfind("http://www.w3.org/2000/svg", 0) == 0)
        << rest;
  }
  const json entry = DataOf(page)["results"][0];
  EXPECT_EQ(entry["result"]["title"], source.title);
  EXPECT_EQ(entry["tables"]["residuals"]["columns"]["x_mm"][0], 12.5);
  EXPECT_FALSE(entry["tables"].contains("heldout"));
  EXPECT_EQ(entry["picture"]["instrument_from_base"][2][3], 250.0);
  EXPECT_EQ(entry["picture"]["lines"][0][1][2], 100.0);
}

CalibrationResult MakeResult(const std::string& arm,
                             const std::string& data_hash) {
  CalibrationResult result;
  result.arm_name = arm;
  result.inputs = {{"job.yaml", data_hash + "of the job"},
                   {"data.csv", data_hash}};
  ParameterResult parameter;
  parameter.name = "d1";
  parameter.kind = "d";
  parameter.nominal = 0.25;
  parameter.value = 0.2503;
  parameter.decision.predicted_std = 1e-5;
  result.parameters = {parameter};
  return result;
}

TEST(ComparisonPageTest, HasResultsFailuresAndWhatWasDecided) {
  ComparisonPage page;
  page.Add("<first>", MakeResult("arm", "a"), "first/report.html");
  page.Add("second", MakeResult("arm", "b"), "");
  CalibrationResult other = MakeResult("arm", "c");
  other.parameters[0].value = 0.2504;
  page.Add("third", other, "");
  page.AddFailure("fourth", "the solver </script> failed");
  const json data = DataOf(page.Render(ComparisonKind::kTime))["comparison"];
  EXPECT_EQ(data["kind"], "time");
  ASSERT_EQ(data["results"].size(), 3U);
  EXPECT_EQ(data["results"][0]["label"], "<first>");
  EXPECT_EQ(data["results"][0]["href"], "first/report.html");
  EXPECT_FALSE(data["results"][1].contains("href"));
  // 0.1 mm from the median, of which 0.01 mm is a standard deviation.
  EXPECT_EQ(data["fleet"]["verdict"]["level"], "attention");
  EXPECT_EQ(data["fleet"]["arms"][0]["result"], 2);
  EXPECT_EQ(data["fleet"]["arms"][0]["outlier"], true);
  EXPECT_EQ(data["fleet"]["arms"][0]["parameter_scores"][0], 10.0);
  EXPECT_EQ(data["fleet"]["threshold"], 3.5);
  EXPECT_EQ(data["fleet"]["parameters"][0]["name"], "d1");
  ASSERT_EQ(data["fleet"]["arms"].size(), 3U);
  // 0.3 mm, to the digits that are written of 0.2503 - 0.25.
  EXPECT_NEAR(data["fleet"]["arms"][1]["deviations"][0].get<double>(), 3e-4,
              1e-9);
  EXPECT_EQ(data["time"]["verdict"]["level"], "attention");
  EXPECT_EQ(data["time"]["verdict"]["sentence"],
            page.Sentence(ComparisonKind::kTime));
  ASSERT_EQ(data["time"]["changes"].size(), 2U);
  // The surest first: 0.1 mm with twice a variance of 1e-10 m^2.
  EXPECT_EQ(data["time"]["changes"][0]["from"], 1);
  EXPECT_EQ(data["time"]["changes"][0]["significant"], true);
  EXPECT_NEAR(data["time"]["changes"][0]["score"].get<double>(),
              10.0 / std::sqrt(2.0), 1e-3);
  EXPECT_EQ(data["time"]["changes"][1]["significant"], false);
  EXPECT_EQ(data["methods"]["ranking"], (std::vector<int>{0, 1, 2}));
  EXPECT_EQ(data["failures"][0]["message"], "the solver </script> failed");
}

TEST(ComparisonPageTest, SameDataOfTheSameArmAreMethods) {
  ComparisonPage same;
  same.Add("a", MakeResult("arm", "x"), "");
  CalibrationResult other_job = MakeResult("arm", "x");
  other_job.inputs[0].sha256 = "another job";
  same.Add("b", other_job, "");
  EXPECT_EQ(same.GuessKind(), ComparisonKind::kMethods);
  same.Add("c", MakeResult("arm", "y"), "");
  EXPECT_EQ(same.GuessKind(), ComparisonKind::kFleet);
}

TEST(ComparisonPageTest, StaysSmallWithManyResults) {
  ComparisonPage page;
  for (int i = 0; i < 2003; ++i) {
    page.Add(std::to_string(i), MakeResult("arm", std::to_string(i)), "");
  }
  const std::string text = page.Render(ComparisonKind::kFleet);
  const json data = DataOf(text)["comparison"];
  EXPECT_EQ(data["results"].size(), 2000U);
  EXPECT_EQ(data["left_out"], 3);
  EXPECT_LT(text.size(), 3'000'000U);
}

}  // namespace
}  // namespace alidade::internal
