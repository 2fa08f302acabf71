#include <gtest/gtest.h>

#include <functional>
#include <ostream>
#include <string>

#include "src/serialization/yaml_reader.h"
#include "tests/support/io_test_util.h"

namespace alidade::internal {
namespace {

Units MmAndDeg() {
  return Units(
      ParseYaml("units: {length: mm, angle: deg}", "x.yaml").Map({"units"}));
}

struct ErrorCase {
  const char* name;
  std::string text;
  std::function<void(const YamlValue&)> read;
  ExpectedError expected;
};

void PrintTo(const ErrorCase& error_case, std::ostream* out) {
  *out << error_case.name;
}

class YamlErrorTest : public ::testing::TestWithParam<ErrorCase> {};

TEST_P(YamlErrorTest, NamesLineColumnKeyAndWhatWasExpected) {
  const ErrorCase& test = GetParam();
  ExpectInputError([&] { test.read(ParseYaml(test.text, "x.yaml")); },
                   test.expected);
}

void Nothing(const YamlValue&) {}

// Reads one entry of a map with the keys a, b and length.
template <typename Read>
std::function<void(const YamlValue&)> Entry(const Read& read) {
  return [read](const YamlValue& root) {
    read(root.Map({"a", "b", "length"}).Required("a"));
  };
}

std::function<void(const YamlValue&)> Number() {
  return Entry([](const YamlValue& value) { value.Number(); });
}

std::function<void(const YamlValue&)> Length() {
  return Entry([](const YamlValue& value) {
    value.Quantity(Dimension::kLength, MmAndDeg());
  });
}

std::function<void(const YamlValue&)> Count() {
  return Entry([](const YamlValue& value) { value.Integer(0, 100); });
}

std::function<void(const YamlValue&)> ReadUnits() {
  return [](const YamlValue& root) { Units units(root.Map({"units"})); };
}

std::string Name(const ::testing::TestParamInfo<ErrorCase>& info) {
  return info.param.name;
}

INSTANTIATE_TEST_SUITE_P(
    Syntax, YamlErrorTest,
    ::testing::Values(
        ErrorCase{"UnclosedList",
                  "a: [1, 2\nb: 3\n",
                  Nothing,
                  {2, 2, "", "not valid YAML"}},
        ErrorCase{"UnclosedQuote",
                  "a: 1\nb: \"x\n",
                  Nothing,
                  {3, 2, "", "not valid YAML"}},
        ErrorCase{"BadIndentation",
                  "a:\n    b: 1\n  c: 2\n",
                  Nothing,
                  {3, 3, "", "not valid YAML"}},
        ErrorCase{"Tab", "a:\n\tb: 1\n", Nothing, {2, 3, "", "not valid YAML"}},
        ErrorCase{"Empty", "", Nothing, {0, 0, "", "the file is empty"}},
        ErrorCase{"OnlyComments",
                  "# a\n# b\n",
                  Nothing,
                  {0, 0, "", "the file is empty"}},
        ErrorCase{"OnlyNull", "~\n", Nothing, {0, 0, "", "the file is empty"}},
        ErrorCase{"TwoDocuments",
                  "a: 1\n---\nb: 2\n",
                  Nothing,
                  {2, 1, "", "a second document begins here"}},
        ErrorCase{"NullByte",
                  std::string("a: 1\nb: \0\n", 10),
                  Nothing,
                  {2, 4, "", "not a text file: found a byte of value 0"}},
        ErrorCase{"EndOfTransmission",
                  "a: 1\n\x04q",
                  Nothing,
                  {2, 1, "", "not a text file: found a byte of value 4"}},
        ErrorCase{"Utf16",
                  std::string("\xff\xfe"
                              "a\0:\0",
                              6),
                  Nothing,
                  {1, 1, "", "not UTF-8: found a byte of value 255"}},
        ErrorCase{"Latin1",
                  "# Gr\xc3\xb6\xc3\x9f"
                  "e\na: Gr\xf6\xdf"
                  "e\n",
                  Nothing,
                  {2, 6, "", "not UTF-8: found a byte of value 246"}},
        ErrorCase{"EscapedNull",
                  "a: 1\nb: \"x\\0y\"\n",
                  Nothing,
                  {2, 4, "", "control character (0)"}},
        ErrorCase{"EscapedEscape",
                  "a: {\"\\e[2J\": 1}\n",
                  Nothing,
                  {1, 5, "", "control character (27)"}},
        ErrorCase{"RepeatedKey",
                  "a: 1\nb: 2\na: 3\n",
                  Nothing,
                  {3, 1, "",
                   "key \"a\" is repeated, expected once (it is in "
                   "line 1 already)"}},
        ErrorCase{"RepeatedInnerKey",
                  "a: {b: 1, c: {}, b: 3}\n",
                  Nothing,
                  {1, 18, "", "key \"b\" is repeated"}},
        ErrorCase{"ListAsKey",
                  "[1, 2]: 3\n",
                  Nothing,
                  {1, 1, "", "expected a key that is text, found a list"}},
        ErrorCase{"MapAsKey",
                  "? {a: 1}\n: 3\n",
                  Nothing,
                  {1, 3, "", "expected a key that is text, found a map"}},
        ErrorCase{"NullAsKey",
                  "a: 1\n~: 3\n",
                  Nothing,
                  {2, 1, "", "expected a key before \":\", found nothing"}},
        ErrorCase{"Alias",
                  "a: &x 1\nb: *x\n",
                  Nothing,
                  {2, 4, "", "aliases (*name) are not read here"}},
        ErrorCase{"Tag",
                  "a: !!int 1\n",
                  Nothing,
                  {1, 4, "", "tags (tag:yaml.org,2002:int) are not read"}},
        ErrorCase{"DeepLists",
                  "a: " + std::string(10000, '[') + std::string(10000, ']'),
                  Nothing,
                  {1, 103, "", "nested deeper than 100 levels"}},
        ErrorCase{"DeepMaps",
                  [] {
                    std::string text;
                    for (int i = 0; i < 10000; ++i) text += "{a: ";
                    text += std::string(10000, '}');
                    return text;
                  }(),
                  Nothing,
                  {1, 401, "", "nested deeper than 100 levels"}}),
    Name);

INSTANTIATE_TEST_SUITE_P(
    Keys, YamlErrorTest,
    ::testing::Values(
        ErrorCase{"Unknown",
                  "a: 1\nlenght: 2\n",
                  Number(),
                  {2, 1, "lenght",
                   "unknown key \"lenght\", did you mean "
                   "\"length\"? Expected one of a, b, length"}},
        ErrorCase{"UnknownWithoutNearest",
                  "a: 1\n  \nzebra: 2\n",
                  Number(),
                  {3, 1, "zebra", "unknown key \"zebra\", expected one of"}},
        ErrorCase{"MergeKey",
                  "a: 1\n<<: {b: 2}\n",
                  Number(),
                  {2, 1, "<<", "unknown key \"<<\""}},
        ErrorCase{"Missing",
                  "b: 1\n",
                  Number(),
                  {1, 1, "a", "missing, expected this key"}},
        ErrorCase{"MissingInside",
                  "b: 1\na:\n  - {b: 1}\n",
                  Entry([](const YamlValue& value) {
                    value.List()[0].Map({"b", "c"}).Required("c");
                  }),
                  {3, 5, "a[1].c", "missing, expected this key"}},
        ErrorCase{"RootIsList",
                  "- 1\n- 2\n",
                  Number(),
                  {1, 1, "", "expected a map of a, b, length, found a list"}},
        ErrorCase{"RootIsText",
                  "hello\n",
                  Number(),
                  {1, 1, "",
                   "expected a map of a, b, length, found a single "
                   "value"}}),
    Name);

INSTANTIATE_TEST_SUITE_P(
    Numbers, YamlErrorTest,
    ::testing::Values(
        ErrorCase{"Empty",
                  "b: 1\na:\n",
                  Number(),
                  {2, 1, "a", "expected a number, found nothing"}},
        ErrorCase{"Null",
                  "a: null\n",
                  Number(),
                  {1, 1, "a", "expected a number, found nothing"}},
        ErrorCase{"Text",
                  "a: five\n",
                  Number(),
                  {1, 4, "a", "expected a number, found \"five\""}},
        ErrorCase{"List",
                  "a:\n  - 1\n",
                  Number(),
                  {2, 3, "a", "expected a number, found a list"}},
        ErrorCase{"Map",
                  "a: {b: 1}\n",
                  Number(),
                  {1, 4, "a", "expected a number, found a map"}},
        ErrorCase{"Quoted",
                  "a: \"1\"\n",
                  Number(),
                  {1, 4, "a", "found the text \"1\": write it without quotes"}},
        ErrorCase{"Nan",
                  "a: .nan\n",
                  Number(),
                  {1, 4, "a", "expected a finite number, found \".nan\""}},
        ErrorCase{"PlainNan",
                  "a: NaN\n",
                  Number(),
                  {1, 4, "a", "expected a finite number, found \"NaN\""}},
        ErrorCase{"Infinity",
                  "a: -.inf\n",
                  Number(),
                  {1, 4, "a", "expected a finite number, found \"-.inf\""}},
        ErrorCase{"PlainInfinity",
                  "a: infinity\n",
                  Number(),
                  {1, 4, "a", "expected a finite number"}},
        ErrorCase{"Comma",
                  "a: 1,5\n",
                  Number(),
                  {1, 4, "a", "write a decimal point, not a comma"}},
        ErrorCase{"Hexadecimal",
                  "a: 0x10\n",
                  Number(),
                  {1, 4, "a", "expected a number, found \"0x10\""}},
        ErrorCase{"BareExponent",
                  "a: 1e\n",
                  Number(),
                  {1, 4, "a", "expected a number, found \"1e\""}},
        ErrorCase{"PlusSign",
                  "a: +1\n",
                  Number(),
                  {1, 4, "a", "write it without the plus sign"}},
        ErrorCase{"TooLarge",
                  "a: 1e999\n",
                  Number(),
                  {1, 4, "a", "which is too large or too small"}},
        ErrorCase{"UnitInPlace",
                  "a: 5 mm\n",
                  Length(),
                  {1, 4, "a",
                   "found \"5 mm\": write the number alone and "
                   "state its unit in \"units\""}},
        ErrorCase{"UnitAttached",
                  "a: 90deg\n",
                  Length(),
                  {1, 4, "a", "state its unit in \"units\""}},
        ErrorCase{"UnitWhereNoneFits",
                  "a: 5 mm\n",
                  Number(),
                  {1, 4, "a", "leave the unit out: this has none"}},
        ErrorCase{"LengthIsText",
                  "a: long\n",
                  Length(),
                  {1, 4, "a", "expected a number, found \"long\""}},
        ErrorCase{"LengthIsNan",
                  "a: .nan\n",
                  Length(),
                  {1, 4, "a", "expected a finite number"}}),
    Name);

INSTANTIATE_TEST_SUITE_P(
    OtherTypes, YamlErrorTest,
    ::testing::Values(
        ErrorCase{"IntegerWithPoint",
                  "a: 3.0\n",
                  Count(),
                  {1, 4, "a", "expected an integer, found \"3.0\""}},
        ErrorCase{"IntegerWithExponent",
                  "a: 1e3\n",
                  Count(),
                  {1, 4, "a", "expected an integer, found \"1e3\""}},
        ErrorCase{"IntegerTooSmall",
                  "a: -1\n",
                  Count(),
                  {1, 4, "a", "expected an integer from 0 to 100, found -1"}},
        ErrorCase{"IntegerTooLarge",
                  "a: 99999999999999999999\n",
                  Count(),
                  {1, 4, "a", "expected an integer"}},
        ErrorCase{"IntegerQuoted",
                  "a: '3'\n",
                  Count(),
                  {1, 4, "a", "write it without quotes"}},
        ErrorCase{"NegativeSeed",
                  "a: -1\n",
                  Entry([](const YamlValue& value) { value.Seed(); }),
                  {1, 4, "a",
                   "expected an integer from 0 to "
                   "18446744073709551615, found \"-1\""}},
        ErrorCase{"BooleanYes",
                  "a: yes\n",
                  Entry([](const YamlValue& value) { value.Boolean(); }),
                  {1, 4, "a", "expected true or false, found \"yes\""}},
        ErrorCase{"BooleanCapital",
                  "a: True\n",
                  Entry([](const YamlValue& value) { value.Boolean(); }),
                  {1, 4, "a", "expected true or false, found \"True\""}},
        ErrorCase{"BooleanQuoted",
                  "a: \"true\"\n",
                  Entry([](const YamlValue& value) { value.Boolean(); }),
                  {1, 4, "a", "expected true or false"}},
        ErrorCase{"ListIsScalar",
                  "a: 1\n",
                  Entry([](const YamlValue& value) { value.List(); }),
                  {1, 4, "a", "expected a list, found a single value"}},
        ErrorCase{"ListTooShort",
                  "a: [1]\n",
                  Entry([](const YamlValue& value) {
                    value.List(2, "lower, upper");
                  }),
                  {1, 4, "a", "expected a list of 2 (lower, upper), found 1"}},
        ErrorCase{
            "ListItem",
            "a: [1, x]\n",
            Entry([](const YamlValue& value) { value.List()[1].Number(); }),
            {1, 8, "a[2]", "expected a number, found \"x\""}},
        ErrorCase{
            "EmptyListItem",
            "a:\n  - 1\n  -\n",
            Entry([](const YamlValue& value) { value.List()[1].Number(); }),
            {3, 3, "a[2]", "expected a number, found nothing"}},
        ErrorCase{"MapIsScalar",
                  "a: 1\n",
                  Entry([](const YamlValue& value) { value.Map({"x"}); }),
                  {1, 4, "a", "expected a map of x, found a single value"}},
        ErrorCase{"EmptyText",
                  "a: \"\"\n",
                  Entry([](const YamlValue& value) { value.Text(); }),
                  {1, 4, "a", "expected text, found an empty one"}},
        ErrorCase{"TextIsList",
                  "a: [b]\n",
                  Entry([](const YamlValue& value) { value.Text(); }),
                  {1, 4, "a", "expected text, found a list"}},
        ErrorCase{"Choice",
                  "a: cerse\n",
                  Entry([](const YamlValue& value) {
                    value.Choice("solver", {"ceres", "pseudo_inverse"});
                  }),
                  {1, 4, "a",
                   "unknown solver \"cerse\", did you mean "
                   "\"ceres\"?"}}),
    Name);

INSTANTIATE_TEST_SUITE_P(
    UnitMaps, YamlErrorTest,
    ::testing::Values(
        ErrorCase{"Missing",
                  "units: {length: mm}\n",
                  ReadUnits(),
                  {1, 8, "units.angle", "missing, expected this key"}},
        ErrorCase{"NotAMap",
                  "units: mm\n",
                  ReadUnits(),
                  {1, 8, "units", "expected a map of length, angle"}},
        ErrorCase{"Unknown",
                  "units: {length: inch, angle: deg}\n",
                  ReadUnits(),
                  {1, 17, "units.length",
                   "unknown unit \"inch\", expected one of mm, m, um"}},
        ErrorCase{"DoesNotFit",
                  "units: {length: mm, angle: mm}\n",
                  ReadUnits(),
                  {1, 28, "units.angle",
                   "unit \"mm\" does not fit: it is a unit of length, expected "
                   "one of deg, rad, mrad"}}),
    Name);

}  // namespace
}  // namespace alidade::internal
