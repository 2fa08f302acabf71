#include "src/serialization/yaml_reader.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "src/common/constants.h"
#include "src/serialization/field_records.h"
#include "tests/support/io_test_util.h"

namespace alidade::internal {
namespace {

YamlMap ParseMap(const std::string& text,
                 const std::vector<std::string>& keys) {
  return ParseYaml(text, "x.yaml").Map(keys);
}

YamlValue ParseValue(const std::string& value) {
  return ParseMap("a: " + value + "\n", {"a"}).Required("a");
}

Units MillimetresAndDegrees() {
  return Units(ParseMap("units: {length: mm, angle: deg}", {"units"}));
}

TEST(ReadYamlTest, NamesFilesThatAreNotThere) {
  const TestDirectory directory;
  ExpectInputError([&] { ReadYaml(directory.Path("none.yaml")); },
                   {0, 0, "", "No such file"});
  ExpectInputError([&] { ReadYaml(directory.Path("")); },
                   {0, 0, "", "Is a directory"});
}

TEST(ParseYamlTest, KeepsTextBlocksWhole) {
  EXPECT_EQ(ParseValue("|\n  x\n  y").Text(), "x\ny\n");
}

TEST(YamlValueTest, CountsColumnsInBytesFromOne) {
  ExpectInputError(
      [] {
        ParseMap("b: 1\na: [\"\xc3\xa9\", x]\n", {"a", "b"})
            .Required("a")
            .List()[1]
            .Number();
      },
      {2, 11, "a[2]", "expected a number"});
}

TEST(YamlValueTest, AcceptsAByteOrderMark) {
  const YamlMap map = ParseMap(
      "\xef\xbb\xbf"
      "a: 1\nb: x\n",
      {"a", "b"});
  EXPECT_EQ(map.Required("a").Number(), 1.0);
  ExpectInputError([&] { map.Required("b").Number(); },
                   {2, 4, "b", "expected a number"});
}

TEST(YamlValueTest, AcceptsCarriageReturns) {
  const YamlMap map =
      ParseMap("a: 1\r\nb: text\r\nc:\r\n  - x\r\n", {"a", "b", "c"});
  EXPECT_EQ(map.Required("a").Number(), 1.0);
  EXPECT_EQ(map.Required("b").Text(), "text");
  EXPECT_EQ(map.Required("c").List()[0].Text(), "x");
  ExpectInputError([&] { map.Required("b").Number(); },
                   {2, 4, "b", "found \"text\""});
}

TEST(YamlValueTest, ReadsNumbersToTheLastBit) {
  EXPECT_EQ(ParseValue("0.1").Number(), 0.1);
  EXPECT_EQ(ParseValue("-1.5e-3").Number(), -0.0015);
  EXPECT_EQ(ParseValue("1E+2").Number(), 100.0);
  EXPECT_EQ(ParseValue("5e-324").Number(), 5e-324);
  EXPECT_EQ(ParseValue(".5").Number(), 0.5);
}

TEST(YamlValueTest, ReadsLengthsToTheNearestDoubleInMetres) {
  const Units units = MillimetresAndDegrees();
  // 0.3 * 1e-3 and 72 * 1e-3 are not the doubles nearest to these.
  EXPECT_EQ(ParseValue("0.3").Quantity(Dimension::kLength, units), 0.0003);
  EXPECT_EQ(ParseValue("72").Quantity(Dimension::kLength, units), 0.072);
  EXPECT_EQ(ParseValue("-7.2e+1").Quantity(Dimension::kLength, units), -0.072);
  EXPECT_EQ(ParseValue("90").Quantity(Dimension::kAngle, units), kPi / 2.0);
}

TEST(YamlValueTest, ReadsEveryUnit) {
  const auto read = [](const std::string& unit, Dimension dimension) {
    const bool is_length = dimension == Dimension::kLength;
    const std::string length = is_length ? unit : "m";
    const std::string angle = is_length ? "rad" : unit;
    const Units units(ParseMap(
        "units: {length: " + length + ", angle: " + angle + "}", {"units"}));
    return ParseValue("3").Quantity(dimension, units);
  };
  EXPECT_EQ(read("m", Dimension::kLength), 3.0);
  EXPECT_EQ(read("mm", Dimension::kLength), 0.003);
  EXPECT_EQ(read("um", Dimension::kLength), 0.000003);
  EXPECT_EQ(read("rad", Dimension::kAngle), 3.0);
  EXPECT_EQ(read("mrad", Dimension::kAngle), 0.003);
  EXPECT_EQ(read("deg", Dimension::kAngle), 3.0 * kDegree);
}

TEST(YamlValueTest, ReadsInfinityOnlyAsALimit) {
  const Units units = MillimetresAndDegrees();
  EXPECT_EQ(ParseValue(".inf").Limit(Dimension::kAngle, units), kInfinity);
  EXPECT_EQ(ParseValue("-.inf").Limit(Dimension::kAngle, units), -kInfinity);
  EXPECT_EQ(ParseValue("90").Limit(Dimension::kAngle, units), kPi / 2.0);
  EXPECT_THROW(ParseValue(".nan").Limit(Dimension::kAngle, units), InputError);
}

TEST(YamlValueTest, ReadsOtherTypes) {
  EXPECT_EQ(ParseValue("-12").Integer(-100, 100), -12);
  EXPECT_EQ(ParseValue("18446744073709551615").Seed(), UINT64_MAX);
  EXPECT_TRUE(ParseValue("true").Boolean());
  EXPECT_FALSE(ParseValue("false").Boolean());
  EXPECT_EQ(ParseValue("12").Text(), "12");
  EXPECT_EQ(ParseValue("\"a: b\"").Text(), "a: b");
  EXPECT_EQ(ParseValue("[]").List().size(), 0U);
}

TEST(YamlFieldsTest, LeavesDefaultsAloneWhereKeysAreMissing) {
  int integer = 1;
  double number = 2.0;
  bool boolean = true;
  std::string text = "x";
  std::optional<double> nothing;
  const Units units(ParseMap("units: {length: mm, angle: deg}\n", {"units"}));
  ReadFields(ParseYaml("a: 7\n", "x.yaml"), units, [&](auto& v) {
    v.Field(Key("a").AtLeast(7), integer, "");
    v.Field(Key("b"), number, "");
    v.Field(Key("c"), boolean, "");
    v.Field(Key("d"), text, "");
    v.Field(LengthKey("e"), nothing, "");
  });
  EXPECT_EQ(integer, 7);
  EXPECT_EQ(number, 2.0);
  EXPECT_TRUE(boolean);
  EXPECT_EQ(text, "x");
  EXPECT_FALSE(nothing.has_value());
}

// Bounds are told in the file's units.
TEST(YamlFieldsTest, NamesWhatAFieldMayBe) {
  const Units units(ParseMap("units: {length: um, angle: deg}\n", {"units"}));
  double value = 0.0;
  const auto read = [&](const std::string& text, const Key& key) {
    ReadFields(ParseYaml(text, "x.yaml"), units,
               [&](auto& v) { v.Field(key, value, ""); });
  };
  ExpectInputError(
      [&] { read("a: 5001\n", LengthKey("a").AtMost(5e-3)); },
      {1, 4, "a", "expected a length at most 5000 um, found 5001"});
  ExpectInputError(
      [&] { read("a: 181\n", AngleKey("a").Above(0).AtMost(kPi)); },
      {1, 4, "a", "expected an angle above 0 and at most 180 deg, found 181"});
  ExpectInputError([&] { read("b: 1\n", Key("a").Required()); },
                   {1, 1, "b", "unknown key \"b\""});
  read("a: 5000\n", LengthKey("a").AtMost(5e-3));
  EXPECT_EQ(value, 5e-3);
}

// Every text that a damaged file may hold ends in a value or an InputError.
TEST(ParseYamlTest, SurvivesDamagedText) {
  const std::string text =
      "format: x\nunits: {length: mm, angle: deg}\njoints:\n"
      "  - {type: revolute, limits: [-1, 1]}  # c\n  - type: \"a\\n\"\n";
  const std::string inserted = "[]{}:,-?!&*|>'\"%@`#\n\t ~x";
  for (std::size_t i = 0; i <= text.size(); ++i) {
    for (const char c : inserted) {
      for (const std::size_t removed : {0, 1, 9}) {
        std::string damaged = text;
        damaged.replace(i, removed, 1, c);
        try {
          ParseYaml(damaged, "x.yaml");
        } catch (const InputError&) {
        }
      }
    }
  }
}

}  // namespace
}  // namespace alidade::internal
