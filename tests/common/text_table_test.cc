#include "src/common/text_table.h"

#include <gtest/gtest.h>

namespace alidade::internal {
namespace {

using Align = TextTable::Align;

TEST(TextTableTest, AlignsLeftAndRight) {
  TextTable table({{"name"}, {"value", Align::kRight}});
  table.AddRow({"beta1", "0.5"});
  table.AddRow({"d", "-160.25"});
  EXPECT_EQ(table.ToString(),
            "name     value\n"
            "-----  -------\n"
            "beta1      0.5\n"
            "d      -160.25\n");
}

TEST(TextTableTest, CountsCharactersAndNotBytes) {
  TextTable table({{"unité"}, {"größe", Align::kRight}});
  table.AddRow({"µm", "±1"});
  table.AddRow({"10⁻¹³", "x"});
  EXPECT_EQ(table.ToString(),
            "unité  größe\n"
            "-----  -----\n"
            "µm        ±1\n"
            "10⁻¹³      x\n");
}

TEST(TextTableTest, LeavesNoTrailingSpace) {
  TextTable table({{"a long title"}, {"another"}});
  table.AddRow({"x", ""});
  table.AddRow({"", ""});
  const std::string text = table.ToString();
  EXPECT_EQ(text.find(" \n"), std::string::npos);
  EXPECT_NE(text.find("\nx\n\n"), std::string::npos);
}

TEST(TextTableTest, IndentsEveryLine) {
  TextTable table({{"a"}});
  table.AddRow({"1"});
  EXPECT_EQ(table.ToString(3), "   a\n   -\n   1\n");
}

TEST(TextTableTest, WithoutRowsHasItsHeader) {
  const TextTable table({{"a"}, {"b"}});
  EXPECT_TRUE(table.empty());
  EXPECT_EQ(table.ToString(), "a  b\n-  -\n");
}

TEST(TextTableDeathTest, RefusesRowOfOtherLength) {
  TextTable table({{"a"}, {"b"}});
  EXPECT_DEATH(table.AddRow({"1"}), "size");
}

}  // namespace
}  // namespace alidade::internal
