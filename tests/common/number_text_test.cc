// Numbers as text, against the C++ and the C library's.

#include "src/common/number_text.h"

#include <gtest/gtest.h>

#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "src/common/constants.h"
#include "src/common/numbers.h"
#include "src/common/random.h"

namespace alidade::internal {
namespace {

// Of any size, of few digits, halfway between decimals, and around where
// exponents begin.
std::vector<double> AnyNumbers() {
  Random random(5);
  std::vector<double> numbers = {0.0,    -0.0,    1e-3,   9.999999e-4, 99999.9,
                                 1e5,    1e15,    1e16,   0.5,         2.5,
                                 -1e-6,  1e-5,    123e-9, 999.9995,    1e22,
                                 5e-324, 1.7e308, 0.0005, 1e6 - 1e-6};
  for (int i = 0; i < 60000; ++i) {
    const double number = random.Uniform(-1.0, 1.0);
    const int decimals = static_cast<int>(random.Uniform(0.0, 10.0));
    const double power = std::pow(10.0, decimals);
    numbers.push_back(std::round(number * 1e6) / power);
    numbers.push_back((std::round(number * 1e4) + 0.5) / power);
    numbers.push_back(std::round(number * 1e5) / 1024.0);
    numbers.push_back(number * std::pow(10.0, random.Uniform(-20.0, 20.0)));
  }
  return numbers;
}

TEST(NumberTextTest, ShortestIsThatOfTheStandardLibrary) {
  for (const double number : AnyNumbers()) {
    std::array<char, 40> buffer;
    char* const end =
        std::to_chars(buffer.data(), buffer.data() + buffer.size(), number).ptr;
    const std::string expected(buffer.data(), end);
    ASSERT_EQ(ShortestNumber(number), number == 0.0 ? "0" : expected);
    ASSERT_EQ(NumberOrNan(ShortestNumber(number)), number);
  }
}

TEST(NumberTextTest, FixedIsThatOfPrintf) {
  for (const double number : AnyNumbers()) {
    for (const int decimals : {0, 1, 4, 6, 9, 12}) {
      std::array<char, 400> buffer;
      std::snprintf(buffer.data(), buffer.size(), "%.*f", decimals, number);
      std::string expected = buffer.data();
      if (expected.find_first_of("123456789") == std::string::npos &&
          expected[0] == '-') {
        expected.erase(0, 1);
      }
      ASSERT_EQ(FixedNumber(number, decimals), expected) << decimals;
    }
  }
}

TEST(NumberTextTest, ShiftedReadsBackToTheSameBits) {
  for (const double number : AnyNumbers()) {
    for (const int exponent : {-3, 0, 3, 6}) {
      const std::string text = FormatShifted(number, exponent);
      const auto read = ParseNumber(text, -exponent);
      ASSERT_TRUE(read) << text;
      ASSERT_EQ(std::memcmp(&*read, &number, sizeof(number)), 0) << text;
    }
  }
}

TEST(NumberTextTest, ShiftedHasTheDigitsOfTheNumber) {
  EXPECT_EQ(FormatShifted(0.123456, 3), "123.456");
  EXPECT_EQ(FormatShifted(-2e-5, 3), "-0.02");
  EXPECT_EQ(FormatShifted(1e-9, 3), "1e-6");
  EXPECT_EQ(FormatShifted(1e-8, 3), "0.00001");
  EXPECT_EQ(FormatShifted(0.1 + 0.2, 3), "300.00000000000004");
  EXPECT_EQ(FormatShifted(1.0, 3), "1000");
  EXPECT_EQ(FormatShifted(1.5e20, 3), "1.5e23");
  EXPECT_EQ(FormatShifted(-0.0, 3), "-0");
}

TEST(NumberTextTest, WhatIsNotFiniteIsAWord) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double number : {nan, -nan}) {
    EXPECT_EQ(ShortestNumber(number), "nan");
    EXPECT_EQ(FormatShifted(number, 3), "nan");
  }
  EXPECT_EQ(FixedNumber(nan, 2), "nan");
  EXPECT_EQ(ShortestNumber(-kInfinity), "-inf");
  EXPECT_EQ(FixedNumber(kInfinity, 2), "inf");
  EXPECT_EQ(FixedPercent(0.9512, 1), "95.1 %");
  EXPECT_EQ(FixedPercent(nan, 1), "nan %");
  EXPECT_EQ(NumberOrNan("-inf"), -kInfinity);
  for (const char* const text : {"", "nan", "1,5", "1 ", "x"}) {
    EXPECT_TRUE(std::isnan(NumberOrNan(text))) << text;
  }
}

}  // namespace
}  // namespace alidade::internal
