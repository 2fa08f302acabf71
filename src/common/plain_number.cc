#include "src/common/plain_number.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace alidade::internal {
namespace {

// These powers of ten are doubles, and so are integers up to 2^53.
constexpr std::array<double, 23> kPowersOfTen = {
    1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
    1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
constexpr std::uint64_t kMaxMantissa = std::uint64_t{1} << 53;
// So many digits fit into 64 bits.
constexpr std::ptrdiff_t kMaxDigits = 19;

bool IsSpace(char c) { return c == ' ' || c == '\t'; }

const char* SkipSpaces(const char* p, const char* end) {
  while (p != end && IsSpace(*p)) ++p;
  return p;
}

// Overflows wrap: the caller counts digits.
const char* ReadDigits(const char* p, const char* end, std::uint64_t* number) {
  std::uint64_t value = *number;
  for (; p != end; ++p) {
    const unsigned digit =
        static_cast<unsigned char>(*p) - static_cast<unsigned>('0');
    if (digit > 9) break;
    value = value * 10 + digit;
  }
  *number = value;
  return p;
}

// The exponent after 'e'; null where it is not one of few digits.
const char* ReadExponent(const char* p, const char* end, int* exponent) {
  const bool is_negative = p != end && *p == '-';
  if (p != end && (*p == '-' || *p == '+')) ++p;
  std::uint64_t number = 0;
  const char* const first = p;
  p = ReadDigits(p, end, &number);
  if (p == first || p - first > 4) return nullptr;
  *exponent += is_negative ? -static_cast<int>(number)  // at most 9999
                           : static_cast<int>(number);
  return p;
}

// Reads what is simple; null for all else.
const char* ReadSimple(const char* p, const char* end, const Unit& unit,
                       double* value) {
  const bool is_negative = p != end && *p == '-';
  if (is_negative) ++p;
  const char* const first = p;
  std::uint64_t mantissa = 0;
  int exponent = unit.exponent;
  p = ReadDigits(p, end, &mantissa);
  std::ptrdiff_t digits = p - first;
  if (digits == 0) return nullptr;
  if (p != end && *p == '.') {
    const char* const point = p + 1;
    p = ReadDigits(point, end, &mantissa);
    if (p == point) return nullptr;
    digits += p - point;
    exponent -= static_cast<int>(std::min(p - point, kMaxDigits + 1));
  }
  if (digits > kMaxDigits || mantissa > kMaxMantissa) return nullptr;
  if (p != end && (*p | 0x20) == 'e') {
    p = ReadExponent(p + 1, end, &exponent);
    if (p == nullptr) return nullptr;
  }
  auto number = static_cast<double>(static_cast<std::int64_t>(mantissa));
  if (exponent < -22 || exponent > 22) return nullptr;
  if (exponent < 0) {
    number /= kPowersOfTen[static_cast<std::size_t>(-exponent)];
  } else {
    number *= kPowersOfTen[static_cast<std::size_t>(exponent)];
  }
  *value = (is_negative ? -number : number) * unit.factor;
  return p;
}

// A cell that ReadSimple left.
const char* ReadAny(const char* text, const char* end, const Unit& unit,
                    double* value) {
  const char* const comma = std::find(text, end, ',');
  const char* last = comma;
  while (last != text && IsSpace(last[-1])) --last;
  const std::optional<double> quantity = ParseQuantity(
      std::string_view(text, static_cast<std::size_t>(last - text)), unit);
  if (!quantity) return nullptr;
  *value = *quantity;
  return comma;
}

}  // namespace

const char* ParsePlainCell(const char* text, const char* end, const Unit& unit,
                           double* value) {
  text = SkipSpaces(text, end);
  const char* p = ReadSimple(text, end, unit, value);
  if (p != nullptr) {
    p = SkipSpaces(p, end);
    if (p == end || *p == ',') return p;
  }
  return ReadAny(text, end, unit, value);
}

}  // namespace alidade::internal
