#include "src/common/numbers.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <system_error>

#include "src/common/names.h"

namespace alidade::internal {
namespace {

constexpr std::array<Unit, 6> kUnits = {{
    {"mm", Dimension::kLength, -3, 1.0},
    {"m", Dimension::kLength, 0, 1.0},
    {"um", Dimension::kLength, -6, 1.0},
    {"deg", Dimension::kAngle, 0, kDegree},
    {"rad", Dimension::kAngle, 0, 1.0},
    {"mrad", Dimension::kAngle, -3, 1.0},
}};

// Longer than any number that a program prints with all its digits.
constexpr std::size_t kMaxNumberSize = 400;

bool IsDigit(char c) { return c >= '0' && c <= '9'; }

// std::from_chars alone would take "inf" and "nan".
bool StartsLikeNumber(std::string_view text) {
  if (!text.empty() && text.front() == '-') text.remove_prefix(1);
  return !text.empty() && (IsDigit(text.front()) || text.front() == '.');
}

// The exponent after an 'e', which may have a sign.
std::optional<int> ParseExponent(std::string_view text) {
  if (!text.empty() && text.front() == '+') {
    text.remove_prefix(1);
    if (text.empty() || !IsDigit(text.front())) return std::nullopt;
  }
  constexpr int kMaxExponent = 100000;
  const std::optional<int> value = ParseWhole<int>(text);
  if (value < -kMaxExponent || value > kMaxExponent) return std::nullopt;
  return value;
}

bool IsNotFinite(std::string_view text) {
  if (!text.empty() && (text[0] == '-' || text[0] == '+')) {
    text.remove_prefix(1);
  }
  if (!text.empty() && text.front() == '.') text.remove_prefix(1);
  std::string word(text);
  for (char& c : word) c = static_cast<char>(c | 0x20);
  return word == "nan" || word == "inf" || word == "infinity";
}

// How many characters from the start are a number.
std::size_t NumberPrefix(std::string_view text) {
  if (!StartsLikeNumber(text)) return 0;
  double value = 0.0;
  const std::from_chars_result result =
      std::from_chars(text.data(), text.data() + text.size(), value);
  return static_cast<std::size_t>(result.ptr - text.data());
}

std::string AdviceForBadNumber(std::string_view text,
                               std::string_view unit_hint) {
  const std::size_t prefix = NumberPrefix(text);
  if (prefix == text.size()) return ", which is too large or too small";
  if (text.front() == '+') return ": write it without the plus sign";
  if (prefix == 0) return "";
  if (text[prefix] == ',') return ": write a decimal point, not a comma";
  const std::string_view rest = text.substr(prefix);
  const std::string_view word =
      rest.substr(std::min(rest.find_first_not_of(' '), rest.size()));
  if (FindUnit(word) == nullptr) return "";
  return ": write the number alone and " + std::string(unit_hint);
}

struct Decimal {
  bool negative = false;
  std::string digits;  // without a point, the first one in front of it
  int exponent = 0;
};

Decimal SplitShortest(double value) {
  std::array<char, 40> buffer;
  const std::to_chars_result result =
      std::to_chars(buffer.data(), buffer.data() + buffer.size(),
                    std::abs(value), std::chars_format::scientific);
  const std::string_view text(
      buffer.data(), static_cast<std::size_t>(result.ptr - buffer.data()));
  const std::size_t e = text.find('e');
  Decimal decimal;
  decimal.negative = std::signbit(value);
  for (const char c : text.substr(0, e)) {
    if (c != '.') decimal.digits += c;
  }
  decimal.exponent = ParseExponent(text.substr(e + 1)).value_or(0);
  return decimal;
}

std::string FormatDecimal(const Decimal& decimal) {
  const std::string sign = decimal.negative ? "-" : "";
  const int size = static_cast<int>(decimal.digits.size());
  const int exponent = decimal.exponent;
  if (exponent < -5 || exponent > 15) {
    const std::string tail = decimal.digits.substr(1);
    return sign + decimal.digits[0] + (tail.empty() ? "" : "." + tail) + "e" +
           std::to_string(exponent);
  }
  if (exponent < 0) {
    return sign + "0." +
           std::string(static_cast<std::size_t>(-exponent - 1), '0') +
           decimal.digits;
  }
  if (size <= exponent + 1) {
    return sign + decimal.digits +
           std::string(static_cast<std::size_t>(exponent + 1 - size), '0');
  }
  const std::size_t point = static_cast<std::size_t>(exponent) + 1;
  return sign + decimal.digits.substr(0, point) + "." +
         decimal.digits.substr(point);
}

}  // namespace

const Unit* FindUnit(std::string_view name) {
  for (const Unit& unit : kUnits) {
    if (unit.name == name) return &unit;
  }
  return nullptr;
}

std::vector<std::string> UnitNames(Dimension dimension) {
  std::vector<std::string> names;
  for (const Unit& unit : kUnits) {
    if (unit.dimension == dimension) names.emplace_back(unit.name);
  }
  return names;
}

const char* DimensionName(Dimension dimension) {
  return dimension == Dimension::kLength ? "length" : "angle";
}

std::optional<double> ParseNumber(std::string_view text, int exponent) {
  if (!StartsLikeNumber(text) || text.size() > kMaxNumberSize) {
    return std::nullopt;
  }
  if (exponent == 0) return ParseWhole<double>(text);
  const std::size_t e = text.find_first_of("eE");
  if (e != std::string_view::npos) {
    const std::optional<int> own = ParseExponent(text.substr(e + 1));
    if (!own) return std::nullopt;
    exponent += *own;
  }
  std::array<char, kMaxNumberSize + 16> buffer;
  char* end = std::copy_n(text.data(), std::min(e, text.size()), buffer.data());
  *end++ = 'e';
  end = std::to_chars(end, buffer.data() + buffer.size(), exponent).ptr;
  return ParseWhole<double>(std::string_view(
      buffer.data(), static_cast<std::size_t>(end - buffer.data())));
}

std::optional<double> ParseQuantity(std::string_view text, const Unit& unit) {
  const std::optional<double> value = ParseNumber(text, unit.exponent);
  if (!value) return std::nullopt;
  return *value * unit.factor;
}

std::string DescribeBadNumber(std::string_view text,
                              std::string_view unit_hint) {
  if (text.empty()) return "expected a number, found nothing";
  if (IsNotFinite(text)) {
    return "expected a finite number, found " + Quote(text);
  }
  return "expected a number, found " + Quote(text) +
         AdviceForBadNumber(text, unit_hint);
}

std::string FormatShortest(double value) {
  std::array<char, 40> buffer;
  const std::to_chars_result result =
      std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return std::string(buffer.data(), result.ptr);
}

std::string FormatShifted(double value, int exponent) {
  if (!std::isfinite(value)) return FormatShortest(value);
  Decimal decimal = SplitShortest(value);
  if (value != 0.0) decimal.exponent += exponent;
  return FormatDecimal(decimal);
}

}  // namespace alidade::internal
