#include "src/common/format.h"

#include <gtest/gtest.h>

#include "src/common/constants.h"

namespace alidade::internal {
namespace {

TEST(FormatPercentTest, KeepsSignificantDigits) {
  EXPECT_EQ(FormatPercent(0.95, 3), "95.0 %");
  EXPECT_EQ(FormatPercent(1e-4, 3), "0.0100 %");
}

TEST(FormatSignificantTest, KeepsSignificantDigits) {
  EXPECT_EQ(FormatSignificant(0.012341, 4), "0.01234");
  EXPECT_EQ(FormatSignificant(5.2, 4), "5.200");
  EXPECT_EQ(FormatSignificant(-160.1004, 6), "-160.100");
  EXPECT_EQ(FormatSignificant(123456.7, 3), "123457");
  EXPECT_EQ(FormatSignificant(2.0, 1), "2");
}

TEST(FormatSignificantTest, IsScientificFarFromOne) {
  EXPECT_EQ(FormatSignificant(2.314e-13, 3), "2.31e-13");
  EXPECT_EQ(FormatSignificant(4e-4, 5), "4.0000e-04");
  EXPECT_EQ(FormatSignificant(1e-3, 2), "0.0010");
  EXPECT_EQ(FormatSignificant(999999.0, 7), "999999.0");
  EXPECT_EQ(FormatSignificant(1e6, 3), "1.00e+06");
}

TEST(FormatSignificantTest, ChoosesNotationAfterRounding) {
  EXPECT_EQ(FormatSignificant(9.99996, 4), "10.00");
  EXPECT_EQ(FormatSignificant(0.00099999, 3), "0.00100");
  EXPECT_EQ(FormatSignificant(999999.9, 3), "1.00e+06");
}

TEST(FormatSignificantTest, KnowsTheEndsOfTheDoubles) {
  EXPECT_EQ(FormatSignificant(0.0, 4), "0");
  EXPECT_EQ(FormatSignificant(-0.0, 4), "0");
  EXPECT_EQ(FormatSignificant(5e-324, 2), "4.9e-324");
  EXPECT_EQ(FormatSignificant(-1.7976931348623157e308, 3), "-1.80e+308");
  EXPECT_EQ(FormatSignificant(kNan, 4), "nan");
  EXPECT_EQ(FormatSignificant(kInfinity, 4), "inf");
  EXPECT_EQ(FormatSignificant(-kInfinity, 4), "-inf");
}

TEST(FormatLengthTest, IsInMillimetres) {
  EXPECT_EQ(FormatLength(5.21e-3), "5.210 mm");
  EXPECT_EQ(FormatLength(2.1e-16, 2), "2.1e-13 mm");
  EXPECT_EQ(FormatLength(0.0), "0 mm");
}

TEST(FormatParameterTest, IsInTheUnitPeopleRead) {
  EXPECT_EQ(FormatParameter(0.1601004, Dimension::kLength, 6), "160.100400");
  EXPECT_EQ(FormatParameter(-kPi / 2.0, Dimension::kAngle, 3), "-90.000");
  EXPECT_STREQ(UnitForPeople(Dimension::kLength), "mm");
  EXPECT_STREQ(UnitForPeople(Dimension::kAngle), "deg");
}

TEST(FormatParameterTest, HasNoMinusZero) {
  EXPECT_EQ(FormatParameter(-0.0, Dimension::kLength, 2), "0.00");
  EXPECT_EQ(FormatParameter(-1e-9, Dimension::kLength, 3), "0.000");
  EXPECT_EQ(FormatParameter(-1e-6, Dimension::kLength, 3), "-0.001");
}

TEST(FormatParameterTest, KnowsTheEndsOfTheDoubles) {
  EXPECT_EQ(FormatParameter(kNan, Dimension::kLength, 2), "nan");
  EXPECT_EQ(FormatParameter(-kInfinity, Dimension::kAngle, 2), "-inf");
  EXPECT_EQ(FormatParameter(1e300, Dimension::kLength, 2), "1.000000000e+303");
}

TEST(FormatDurationTest, ChoosesTheUnit) {
  EXPECT_EQ(FormatDuration(0.0), "0 s");
  EXPECT_EQ(FormatDuration(2.5e-8), "25.0 ns");
  EXPECT_EQ(FormatDuration(4.2e-5), "42.0 us");
  EXPECT_EQ(FormatDuration(0.0123), "12.3 ms");
  EXPECT_EQ(FormatDuration(1.25), "1.25 s");
  EXPECT_EQ(FormatDuration(59.0533 * 60.0), "59.1 min");
  EXPECT_EQ(FormatDuration(3.0 * 3600.0), "3.00 h");
  EXPECT_EQ(FormatDuration(10.0 * 86400.0), "10.0 days");
  EXPECT_EQ(FormatDuration(kNan), "nan s");
}

TEST(FormatAccuracyTest, NamesEveryStatistic) {
  Accuracy accuracy;
  accuracy.mean = 3.2e-3;
  accuracy.rms = 3.4e-3;
  accuracy.p95 = 5.0e-3;
  accuracy.max = 5.2e-3;
  accuracy.n = 56;
  EXPECT_EQ(FormatAccuracy(accuracy),
            "mean 3.200 mm, rms 3.400 mm, p95 5.000 mm, max 5.200 mm (n = 56)");
  EXPECT_EQ(FormatAccuracy(Accuracy()), "nothing was evaluated");
}

}  // namespace
}  // namespace alidade::internal
