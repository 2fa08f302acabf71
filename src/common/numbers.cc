#include "src/common/numbers.h"

#include <fast_float/fast_float.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <system_error>

#include "src/common/characters.h"
#include "src/common/constants.h"
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
  const std::string word = LowerCase(std::string(text));
  return word == "nan" || word == "inf" || word == "infinity";
}

// How many characters from the start are a number.
std::size_t NumberPrefix(std::string_view text) {
  if (!StartsLikeNumber(text)) return 0;
  double value = 0.0;
  const char* const last =
      fast_float::from_chars(text.data(), text.data() + text.size(), value).ptr;
  return static_cast<std::size_t>(last - text.data());
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

// Whether a number that was read as zero is one: versions of fast_float before
// 5 read numbers that are too small as zero.
bool IsZero(std::string_view text) {
  for (const char c : text) {
    if ((c | 0x20) == 'e') break;
    if (c >= '1' && c <= '9') return false;
  }
  return true;
}

// NaN where the text is none.
double ParseFinite(std::string_view text) {
  double value = 0.0;
  const char* const end = text.data() + text.size();
  const auto [last, error] = fast_float::from_chars(text.data(), end, value);
  const bool is_finite = error == std::errc() && last == end &&
                         std::isfinite(value) && (value != 0.0 || IsZero(text));
  return is_finite ? value : kNan;
}

// NaN where ParseNumber gives nothing.
double ShiftedNumber(std::string_view text, int exponent) {
  if (!StartsLikeNumber(text) || text.size() > kMaxNumberSize) {
    return kNan;
  }
  if (exponent == 0) return ParseFinite(text);
  constexpr std::size_t kFewCharacters = 16;
  if (text.size() <= kFewCharacters && exponent >= -6 && exponent < 0) {
    const double shifted = ShiftShort(ParseFinite(text), exponent);
    if (!std::isnan(shifted)) return shifted;
  }
  const auto* const e = std::find_if(text.begin(), text.end(),
                                     [](char c) { return (c | 0x20) == 'e'; });
  if (e != text.end()) {
    const auto own = ParseExponent(text.substr(e - text.begin() + 1));
    if (!own) return kNan;
    exponent += *own;
  }
  // The text with another exponent.
  std::array<char, kMaxNumberSize + 16> buffer;
  char* end = std::copy(text.begin(), e, buffer.data());
  *end++ = 'e';
  end = std::to_chars(end, buffer.data() + buffer.size(), exponent).ptr;
  return ParseFinite(
      {buffer.data(), static_cast<std::size_t>(end - buffer.data())});
}

std::optional<double> UnlessNan(double value) {
  if (std::isnan(value)) return std::nullopt;
  return value;
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
  return UnlessNan(ShiftedNumber(text, exponent));
}

// Different decimals of at most 15 digits have different doubles, so that w *
// 1e-6 is the decimal; w and the power of ten are doubles.
double ShiftShort(double value, int exponent) {
  constexpr double kUlpIsOne = 0x1.8p52;  // rounds sums to integers
  const double millionths = value * 1e6;
  const double w = (millionths + kUlpIsOne) - kUlpIsOne;
  if (!(std::abs(millionths) < 1e15) || w / 1e6 != value) return kNan;
  return std::copysign(w / kPowersOfTen[6 - exponent], value);
}

std::optional<double> ParseQuantity(std::string_view text, const Unit& unit) {
  return UnlessNan(QuantityOrNan(text, unit));
}

double QuantityOrNan(std::string_view text, const Unit& unit) {
  return ShiftedNumber(text, unit.exponent) * unit.factor;
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

}  // namespace alidade::internal
