#include "src/common/utf8.h"

#include <gtest/gtest.h>

#include <string>

namespace alidade::internal {
namespace {

TEST(OnOneLineTest, KeepsText) {
  EXPECT_EQ(OnOneLine(""), "");
  EXPECT_EQ(OnOneLine("q1 (°), α₁ – 你好, 🤖"),
            "q1 (°), α₁ – 你好, 🤖");
}

TEST(OnOneLineTest, EscapesWhatATerminalWouldObey) {
  EXPECT_EQ(OnOneLine("a\nb\tc\x1b[2J\x7f"), "a\\nb\\x09c\\x1b[2J\\x7f");
  EXPECT_EQ(OnOneLine(std::string("a\0b", 3)), "a\\x00b");
  // The controls of ISO 8859, a line separator, a mark of direction, in UTF-8.
  EXPECT_EQ(OnOneLine("\xC2\x9B|\xE2\x80\xA8|\xE2\x80\xAE|\xE2\x81\xA6"),
            "\\xc2\\x9b|\\xe2\\x80\\xa8|\\xe2\\x80\\xae|\\xe2\\x81\\xa6");
  // Their neighbours are text: no-break space, narrow space, bullet.
  EXPECT_EQ(OnOneLine("\xC2\xA0\xE2\x80\xAF\xE2\x80\xA2"),
            "\xC2\xA0\xE2\x80\xAF\xE2\x80\xA2");
}

TEST(OnOneLineTest, EscapesWhatIsNoUtf8) {
  EXPECT_EQ(OnOneLine("Me\xDF"
                      "arm"),
            "Me\\xdfarm");                                  // ISO 8859-1
  EXPECT_EQ(OnOneLine("\xC0\xAF"), "\\xc0\\xaf");           // overlong
  EXPECT_EQ(OnOneLine("\xED\xA0\x80"), "\\xed\\xa0\\x80");  // a surrogate
  EXPECT_EQ(OnOneLine("\xE2\x82"), "\\xe2\\x82");           // cut off
}

}  // namespace
}  // namespace alidade::internal
