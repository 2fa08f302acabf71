#include "src/job/report_page.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace alidade::internal {
namespace {

TEST(ReportPageTest, LabelsTellResultsApart) {
  EXPECT_EQ(ResultLabels({"/data/left/result.json", "/data/right/"}),
            (std::vector<std::string>{"left", "right"}));
  EXPECT_EQ(ResultLabels({"/2024/arm", "/2025/arm", "/2025/other"}),
            (std::vector<std::string>{"2024/arm", "2025/arm", "2025/other"}));
  // The same twice: as far as there is something to tell.
  const std::vector<std::string> same = ResultLabels({"/a/b", "/a/b"});
  EXPECT_EQ(same, (std::vector<std::string>{"a/b", "a/b"}));
}

}  // namespace
}  // namespace alidade::internal
