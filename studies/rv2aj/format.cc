#include "studies/rv2aj/format.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdlib>

namespace alidade::rv2aj {
namespace {

std::string Digits(double value, std::chars_format format, int decimals) {
  std::array<char, 400> buffer;  // the largest double has 309
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(),
                                 value, format, decimals)
                       .ptr;
  return {buffer.data(), end};
}

}  // namespace

std::string Fixed(double value, int decimals) {
  const std::string text = Digits(value, std::chars_format::fixed, decimals);
  const bool is_zero = text.find_first_of("123456789infa") == std::string::npos;
  return is_zero && text[0] == '-' ? text.substr(1) : text;
}

std::string Significant(double value, int digits) {
  if (value == 0.0) return "0";
  const std::string text =
      Digits(value, std::chars_format::scientific, digits - 1);
  const int exponent = std::atoi(text.c_str() + text.find('e') + 1);
  if (exponent < -3 || exponent > 5) return text;
  return Fixed(value, std::max(0, digits - 1 - exponent));
}

std::string Millimetres(double metres, int digits) {
  return Significant(metres * 1e3, digits) + " mm";
}

std::string Duration(double seconds) {
  if (seconds < 1e-3) return Significant(seconds * 1e6, 3) + " us";
  if (seconds < 1.0) return Significant(seconds * 1e3, 3) + " ms";
  if (seconds < 120.0) return Significant(seconds, 3) + " s";
  return Significant(seconds / 60.0, 3) + " min";
}

std::string Count(std::int64_t number, const std::string& singular) {
  return std::to_string(number) + " " + singular + (number == 1 ? "" : "s");
}

std::string Join(const std::vector<std::string>& parts,
                 const std::string& separator) {
  std::string joined;
  for (const std::string& part : parts) {
    joined += (&part == &parts.front() ? "" : separator) + part;
  }
  return joined;
}

}  // namespace alidade::rv2aj
