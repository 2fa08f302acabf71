// Pages as texts; what they show is looked at in a browser: tests/browser.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "src/report/comparison_page.h"
#include "src/report/markup.h"
#include "src/report/result_page.h"
#include "src/report/table.h"
#include "tests/report/report_test_util.h"

namespace alidade::internal {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(MarkupTest, NumbersAreTypeset) {
  EXPECT_EQ(Typeset("from -3.08 mm to 6.4e-14 mm"),
            "from \u22123.08 mm to 6.4×10⁻¹⁴ mm");
  EXPECT_EQ(Typeset("1e+06, 10^-13, 2^3"), "1×10⁶, 10⁻¹³, 2^3");
  EXPECT_EQ(Typeset("-5 (-7), 2024-03-05, r2-r3, pose-5"),
            "\u22125 (\u22127), 2024-03-05, r2-r3, pose-5");
  EXPECT_EQ(Typeset("case-1, 3e-5a, e-5, 10^"), "case-1, 3e-5a, e-5, 10^");
  EXPECT_EQ(Typeset("r2 + r3 - 70 mm * beta4, base_x - -0.5 * d1"),
            "r2 + r3 \u2212 70 mm × beta4, base_x \u2212 \u22120.5 × d1");
  EXPECT_EQ(Typeset("cell - tool, *, `a1 * -2`"), "cell - tool, *, `a1 * -2`");
}

TEST(MarkupTest, TextCannotBecomeMarkup) {
  EXPECT_EQ(Element("p", {{"class", "a\"b"}, {"id", ""}}, Words("<b> & 'c'")),
            "<p class=\"a&quot;b\">&lt;b&gt; &amp; &#39;c&#39;</p>");
}

TEST(MarkupTest, BackticksAreCode) {
  EXPECT_EQ(Sentences("use `loss: <x>` at -5 `"),
            "use <code>loss: &lt;x&gt;</code> at \u22125 `");
}

TEST(TableTest, GroupsHaveARowOfTheirOwnAndEmptyColumnsNone) {
  Table table("t", "A table", {"name", ">value", "remark", "note"});
  table.BeginGroup("joint 1");
  table.AddRow({"a", CountCell(1), "", "-"});
  table.BeginGroup("joint <2>");
  table.AddRow({"b", CountCell(2), "", "-"});
  const std::string html = table.ToHtml();
  EXPECT_THAT(html, HasSubstr("<th scope=\"rowgroup\" colspan=\"2\">"
                              "joint &lt;2&gt;</th>"));
  EXPECT_THAT(html, Not(HasSubstr("remark")));
  EXPECT_THAT(html, Not(HasSubstr("note")));
  EXPECT_THAT(table.ToText(), Not(HasSubstr("joint")));
}

// The rows of a table as their cells' text.
std::vector<std::string> RowsOf(const std::string& page,
                                const std::string& id) {
  std::vector<std::string> rows;
  std::size_t at = page.find("<table id=\"" + id + "\"");
  if (at == std::string::npos) return rows;
  const std::size_t end = page.find("</table>", at);
  at = page.find("<tbody>", at);
  while ((at = page.find("<tr", at)) < end) {
    const std::size_t stop = page.find("</tr>", at);
    std::string row;
    bool in_tag = false;
    for (const char c : page.substr(at, stop - at)) {
      if (c == '<') {
        in_tag = true;
      } else if (c == '>') {
        in_tag = false;
        if (!row.empty() && row.back() != '|') row += '|';
      } else if (!in_tag) {
        row += c;
      }
    }
    rows.push_back(row);
    at = stop;
  }
  return rows;
}

// The only address is the name space of SVG.
void ExpectNothingFromElsewhere(const std::string& page) {
  for (std::size_t at = page.find("http"); at != std::string::npos;
       at = page.find("http", at + 1)) {
    const std::string rest = page.substr(at, 32);
    EXPECT_TRUE(rest.rfind("http-equiv", 0) == 0 ||
                rest.rfind("http://www.w3.org/2000/svg", 0) == 0)
        << rest;
  }
}

TEST(ResultPageTest, IsCompleteWithoutScriptsAndAsksForNothing) {
  CalibrationResult result = testing::MakeResult();
  result.title = "<script>alert(1)</script>";
  const std::string json = R"({"title": "</script><!--", "n": 3})";
  const std::string page = RenderResultPage(
      result, json, {{"study", "The study", "<p>further</p>"}});
  EXPECT_THAT(page, Not(HasSubstr("<script>alert")));
  EXPECT_THAT(page,
              HasSubstr("<h1>&lt;script&gt;alert(1)&lt;/script&gt;</h1>"));
  EXPECT_THAT(page, Not(HasSubstr("{{")));
  ExpectNothingFromElsewhere(page);
  EXPECT_THAT(page, HasSubstr("<h2 id=\"study-title\">The study</h2>\n"
                              "<p>further</p>"));
  EXPECT_THAT(page, HasSubstr("<a href=\"#study\">The study</a>"));
  const std::string mark = "id=\"alidade-data\">";
  const std::size_t from = page.find(mark) + mark.size();
  EXPECT_EQ(nlohmann::json::parse(
                page.substr(from, page.find("</script>", from) - from)),
            nlohmann::json::parse(json));
  EXPECT_EQ(RowsOf(page, "accuracy").size(), 4U);
  for (const char* figure :
       {"by-joint-2", "by-pose-before", "by-pose", "validation-before",
        "validation-after", "singular-values", "convergence", "changes-lengths",
        "changes-angles"}) {
    EXPECT_THAT(page, HasSubstr("<figure id=\"" + std::string(figure) + "\""));
  }
  EXPECT_THAT(page, HasSubstr("<title>pose 3: 5.21 mm</title>"));
}

TEST(ResultPageTest, LongResultsAreNotInIt) {
  const std::string page = RenderResultPage(
      testing::MakeResult(), "[" + std::string(600'000, ' ') + "]", {});
  EXPECT_THAT(page, Not(HasSubstr("id=\"alidade-data\">")));
}

TEST(ResultPageTest, AnEmptyResultHasAPage) {
  const std::string page = RenderResultPage(CalibrationResult(), "{}", {});
  EXPECT_THAT(page, HasSubstr("</html>"));
  EXPECT_THAT(page, Not(HasSubstr("<figure")));
}

TEST(ResultPageTest, ManyPosesTakeAsMuchRoomAsTheirPixels) {
  CalibrationResult result = testing::MakeResult();
  result.train = testing::MakeSet(100'000, 5.21e-3, 1e-4);
  result.validation = testing::MakeSet(100'000, 5.21e-3, 1e-4);
  EXPECT_LT(RenderResultPage(result, "", {}).size(), 1'500'000U);
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
  page.Add("<first>", MakeResult("arm", "a"), "first/report <1>.html");
  page.Add("second", MakeResult("arm", "b"), "");
  CalibrationResult other = MakeResult("arm", "c");
  other.parameters[0].value = 0.2504;
  page.Add("third", other, "");
  page.AddFailure("fourth", "the solver </script> failed");
  const std::string html = page.Render(ComparisonKind::kTime);
  ExpectNothingFromElsewhere(html);
  EXPECT_THAT(html, HasSubstr("<title>One arm over time – Alidade</title>"));
  EXPECT_THAT(html, HasSubstr("id=\"read-as-2\" checked>"));
  EXPECT_THAT(html, HasSubstr("<a href=\"./first/report%20%3C1%3E.html\">"
                              "&lt;first&gt;</a>"));
  // 0.1 mm from the median, of which 0.01 mm is a standard deviation.
  const std::vector<std::string> arms = RowsOf(html, "fleet");
  ASSERT_EQ(arms.size(), 3U);
  EXPECT_THAT(arms[0], HasSubstr("third|!\u00a0|outlier|"));
  EXPECT_THAT(arms[0], HasSubstr("d1 +0.400 mm (z\u00a0=\u00a010)"));
  EXPECT_THAT(arms[1], HasSubstr("typical"));
  EXPECT_THAT(html, HasSubstr("above 3.5 is an outlier"));
  EXPECT_THAT(html, HasSubstr(EscapeXml(page.Sentence(ComparisonKind::kTime))));
  // The surest first: 0.1 mm with twice a variance of 1e-10 m^2.
  const std::vector<std::string> changes = RowsOf(html, "changes");
  ASSERT_EQ(changes.size(), 2U);
  EXPECT_THAT(changes[0],
              HasSubstr("d1|second|third|250.3000|250.4000|"
                        "+0.1000|0.014|mm|+7.1|!\u00a0|significant"));
  EXPECT_THAT(changes[1], HasSubstr("not significant"));
  EXPECT_THAT(RowsOf(html, "failures")[0],
              HasSubstr("fourth|the solver &lt;/script&gt; failed"));
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
  const std::string html = page.Render(ComparisonKind::kFleet);
  // Distributions of all, and the rows of those that stand out most.
  EXPECT_EQ(RowsOf(html, "fleet").size(), 100U);
  EXPECT_THAT(html, HasSubstr("100 of 2000 arms"));
  EXPECT_THAT(html, HasSubstr("id=\"error-distribution\""));
  EXPECT_THAT(html, HasSubstr("3 further results are not on this page."));
  EXPECT_LT(html.size(), 3'000'000U);
}

}  // namespace
}  // namespace alidade::internal
