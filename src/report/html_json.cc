#include "src/report/html_json.h"

#include <array>
#include <charconv>
#include <cmath>

namespace alidade::internal {
namespace {

constexpr char kEscapedLess[] = "\\u003c";

bool IsSpace(char c) { return c == ' ' || c == '\n' || c == '\r' || c == '\t'; }

bool IsNumberPart(char c) {
  return (c >= '0' && c <= '9') || c == '-' || c == '+' || c == '.' ||
         c == 'e' || c == 'E';
}

// The string that begins at `from`, its quotes included.
std::string_view StringAt(std::string_view json, std::size_t from) {
  std::size_t end = from + 1;
  while (end < json.size() && json[end] != '"') {
    end += json[end] == '\\' ? 2 : 1;
  }
  return json.substr(from, end + 1 - from);
}

std::string Shortened(std::string_view number, int digits) {
  double value = 0.0;
  const auto [end, error] =
      std::from_chars(number.data(), number.data() + number.size(), value);
  const bool is_fraction = number.find_first_of(".eE") < number.size();
  if (digits == 0 || !is_fraction || error != std::errc() ||
      end != number.data() + number.size()) {
    return std::string(number);
  }
  std::string shorter = JsonNumber(value, digits);
  return shorter.size() < number.size() ? shorter : std::string(number);
}

}  // namespace

std::string JsonText(std::string_view text) {
  constexpr char kHex[] = "0123456789abcdef";
  std::string json = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      json += {'\\', c};
    } else if (c == '<') {
      json += kEscapedLess;
    } else if (static_cast<unsigned char>(c) < 0x20) {
      json += std::string("\\u00") + kHex[c >> 4] + kHex[c & 15];
    } else {
      json += c;
    }
  }
  return json + "\"";
}

std::string JsonNumber(double value, int digits) {
  if (!std::isfinite(value)) return "null";
  if (value == 0.0) return "0";
  std::array<char, 64> text{};
  const auto result = std::to_chars(text.data(), text.data() + text.size(),
                                    value, std::chars_format::general, digits);
  return std::string(text.data(), result.ptr);
}

std::string CompactJson(std::string_view json, int digits) {
  std::string compact;
  for (std::size_t i = 0; i < json.size();) {
    if (json[i] == '"') {
      const std::string_view text = StringAt(json, i);
      for (const char c : text) {
        if (c == '<') {
          compact += kEscapedLess;
        } else {
          compact += c;
        }
      }
      i += text.size();
    } else if (json[i] == '-' || (json[i] >= '0' && json[i] <= '9')) {
      std::size_t end = i;
      while (end < json.size() && IsNumberPart(json[end])) ++end;
      compact += Shortened(json.substr(i, end - i), digits);
      i = end;
    } else {
      if (!IsSpace(json[i])) compact += json[i];
      ++i;
    }
  }
  return compact;
}

}  // namespace alidade::internal
