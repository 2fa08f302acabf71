#include "src/common/number_text.h"

#include <fast_float/fast_float.h>
#include <fmt/compile.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <limits>
#include <system_error>

#include "src/common/constants.h"

namespace alidade::internal {
namespace {

constexpr double kMaxInteger = 1e15;

constexpr int kMostDigits = 16;

// "00" to "99".
constexpr std::array<char, 200> kPairs = [] {
  std::array<char, 200> pairs{};
  for (std::size_t i = 0; i < 100; ++i) {
    pairs[2 * i] = static_cast<char>('0' + i / 10);
    pairs[2 * i + 1] = static_cast<char>('0' + i % 10);
  }
  return pairs;
}();

// The sixteen digits of a number below 1e16, and how many zeros stand before
// it (15 of zero). Always as many: a processor guesses the length of random
// numbers wrongly, which takes it longer than the digits.
int WriteDigits(std::uint64_t number, char* digits) {
  auto high = static_cast<std::uint32_t>(number / 100000000);
  auto low = static_cast<std::uint32_t>(number % 100000000);
  for (int i = 6; i >= 0; i -= 2, high /= 100, low /= 100) {
    std::memcpy(digits + i, &kPairs[std::size_t{2} * (high % 100)], 2);
    std::memcpy(digits + 8 + i, &kPairs[std::size_t{2} * (low % 100)], 2);
  }
  int zeros = kMostDigits - 1;
  double power = 10.0;
  for (int i = 1; i < kMostDigits; ++i, power *= 10.0) {
    zeros -= static_cast<double>(number) >= power ? 1 : 0;
  }
  return zeros;
}

// w * 10^-decimals, with all of the decimals or without zeros at the end.
// @pre 0 <= decimals <= 9, |w| < 1e15.
void AppendScaled(double w, int decimals, bool drops_zeros, std::string* text) {
  std::array<char, std::size_t{2} * kMostDigits> digits;
  const int zeros =
      WriteDigits(static_cast<std::uint64_t>(std::abs(w)), digits.data());
  const int point = kMostDigits - decimals;
  const int first = std::min(zeros, point - 1);
  int end = kMostDigits;
  while (drops_zeros && end > point && digits[end - 1] == '0') --end;
  // Copies of one length, of which only the beginning stays.
  std::array<char, std::size_t{3} * kMostDigits> buffer;
  char* p = buffer.data();
  *p = '-';
  p += w < 0.0 ? 1 : 0;
  std::memcpy(p, &digits[first], kMostDigits);
  p += point - first;
  *p = '.';
  p += end > point ? 1 : 0;
  std::memcpy(p, &digits[point], kMostDigits);
  p += end - point;
  const std::size_t size = text->size() + (p - buffer.data());
  text->append(buffer.data(), std::size_t{2} * kMostDigits);
  text->resize(size);
}

// To the nearest integer, of numbers below 2^51: without SSE 4.1 the standard's
// function is a call.
double Round(double value) {
  constexpr double kUlpIsOne = 0x1.8p52;
  return (value + kUlpIsOne) - kUlpIsOne;
}

// The integer w that value is 10^-decimals times of, rounded once: then w *
// 10^-decimals is the shortest decimal that reads back to the value, as
// different decimals of at most 15 digits have different doubles.
bool IsScaled(double value, int decimals, double* w) {
  const double product = value * kPowersOfTen[decimals];
  *w = Round(product);
  return std::abs(product) < kMaxInteger &&
         *w / kPowersOfTen[decimals] == value;
}

// digits * 10^(exponent - number of digits + 1), with an exponent where the
// text would be long without.
void AppendDecimal(std::string_view digits, int exponent, std::string* text) {
  const auto size = static_cast<int>(digits.size());
  if (exponent < -5 || exponent > 15) {
    *text += digits[0];
    if (size > 1) (*text += '.') += digits.substr(1);
    *text += 'e';
    const fmt::format_int number(exponent);
    text->append(number.data(), number.size());
  } else if (exponent < 0) {
    text->append("0.00000", static_cast<std::size_t>(1 - exponent));
    *text += digits;
  } else if (size <= exponent + 1) {
    *text += digits;
    text->append(static_cast<std::size_t>(exponent + 1 - size), '0');
  } else {
    const auto point = static_cast<std::size_t>(exponent) + 1;
    ((*text += digits.substr(0, point)) += '.') += digits.substr(point);
  }
}

}  // namespace

std::string FixedNumber(double value, int decimals) {
  std::string text;
  AppendFixed(value, decimals, &text);
  return text;
}

std::string FixedPercent(double share, int decimals) {
  return FixedNumber(100.0 * share, decimals) + " %";
}

void AppendFixed(double value, int decimals, std::string* text) {
  // Where the product, which is off by half a unit in its last place, is not
  // halfway between integers, it rounds as the value does.
  const double product = value * kPowersOfTen[std::clamp(decimals, 0, 9)];
  const double w = Round(product);
  const double to_halfway = std::abs(std::abs(product - w) - 0.5);
  if (decimals >= 0 && decimals <= 9 && std::abs(product) < kMaxInteger &&
      to_halfway > std::abs(product) * 1e-15) {
    return AppendScaled(w, decimals, false, text);
  }
  const std::size_t begin = text->size();
  fmt::format_to(std::back_inserter(*text), FMT_COMPILE("{:.{}f}"), value,
                 std::clamp(decimals, 0, 60));
  if ((*text)[begin] == '-' &&
      text->find_first_not_of("-0.", begin) == std::string::npos) {
    text->erase(begin, 1);
  }
}

std::string ShortestNumber(double value) {
  std::string text;
  AppendShortest(value, &text);
  return text;
}

void AppendShortest(double value, std::string* text) {
  // The longest is as -1.2345678901234567e-308.
  std::array<char, 32> buffer;
  char* end = buffer.data();
  const double magnitude = std::abs(value);
  double w = 0.0;
  if (magnitude >= 1e-3 && magnitude < 1e5) {
    if (IsScaled(value, 6, &w)) return AppendScaled(w, 6, true, text);
    // Faster than std::to_chars, which gives the same text here; elsewhere the
    // two differ in where an exponent begins.
    end = fmt::format_to(end, FMT_COMPILE("{}"), value);
  } else if (value == 0.0) {
    *end++ = '0';
  } else if (std::isnan(value)) {
    end = std::copy_n("nan", 3, end);
  } else {
    end = std::to_chars(end, end + buffer.size(), value).ptr;
  }
  text->append(buffer.data(), end);
}

double NumberOrNan(std::string_view text) {
  double value = 0.0;
  const char* const end = text.data() + text.size();
  const auto [last, error] = fast_float::from_chars(text.data(), end, value);
  return error == std::errc() && last == end
             ? value
             : std::numeric_limits<double>::quiet_NaN();
}

std::string FormatShifted(double value, int exponent) {
  std::string text;
  AppendShifted(value, exponent, &text);
  return text;
}

void AppendShifted(double value, int exponent, std::string* text) {
  const double magnitude = std::abs(value);
  const bool has_no_exponent = magnitude >= 1e-3 && magnitude < 1e5;
  if (!std::isfinite(value) || (exponent == 0 && has_no_exponent)) {
    return AppendShortest(value, text);
  }
  double w = 0.0;
  if (exponent == 3 && IsScaled(value, 9, &w) && std::abs(w) >= 10.0) {
    return AppendScaled(w, 6, true, text);
  }
  std::array<char, 40> buffer;  // as 1.2345e-06
  const char* const end =
      std::to_chars(buffer.data(), buffer.data() + buffer.size(),
                    std::abs(value), std::chars_format::scientific)
          .ptr;
  char* const e = std::find(buffer.data(), buffer.data() + buffer.size(), 'e');
  int own = 0;
  std::from_chars(e[1] == '+' ? e + 2 : e + 1, end, own);
  if (value != 0.0) own += exponent;
  if (std::signbit(value)) *text += '-';
  // Without the point, by the first digit in its place.
  char* digits = buffer.data();
  if (e - digits > 1) {
    digits[1] = digits[0];
    ++digits;
  }
  AppendDecimal({digits, static_cast<std::size_t>(e - digits)}, own, text);
}

}  // namespace alidade::internal
