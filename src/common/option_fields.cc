#include "src/common/option_fields.h"

#include <array>
#include <cstdio>
#include <sstream>

namespace alidade::internal {
std::string FormatBrief(double value) {
  std::array<char, 32> buffer;
  std::snprintf(buffer.data(), buffer.size(), "%.10g", value);
  std::string text = buffer.data();
  const std::size_t zero = text.find("e-0");
  return zero == std::string::npos ? text : text.erase(zero + 2, 1);
}

// Comparisons are written so that NaN fails them.
bool Key::Allows(double value) const {
  return std::isfinite(value) &&
         (excludes_lower ? value > lower : value >= lower) &&
         (excludes_upper ? value < upper : value <= upper);
}

std::string Key::Range(double scale, const std::string& unit) const {
  const auto bound = [&](double value) {
    return FormatBrief(value / scale) +
           (value == 0.0 || unit.empty() ? "" : " " + unit);
  };
  const bool has_lower = std::isfinite(lower);
  const bool has_upper = std::isfinite(upper);
  if (has_lower && !has_upper) {
    return excludes_lower ? "above " + bound(lower) : bound(lower) + " or more";
  }
  if (has_lower && !excludes_lower && !excludes_upper) {
    return "from " + bound(lower) + " to " + bound(upper);
  }
  std::string range;
  if (has_lower) {
    range = (excludes_lower ? "above " : "at least ") + bound(lower) + " and ";
  }
  if (!has_upper) return range;
  return range + (excludes_upper ? "below " : "at most ") + bound(upper);
}

void FieldCheck::CheckNumber(const Key& key, double value) {
  if (!error_.empty() || key.Allows(value)) return;
  std::string range =
      key.Range(1.0, key.dimension ? WordOf(*key.dimension) : "");
  const bool is_bounded = std::isfinite(key.lower) && std::isfinite(key.upper);
  if (!is_bounded && !std::isfinite(value)) {
    range = "finite" + (range.empty() ? "" : " and " + range);
  }
  constexpr int kDigits = 10;  // of any int
  std::ostringstream text;
  text.precision(kDigits);
  text << path_ << key.name << " = " << value << ", must be " << range;
  error_ = text.str();
}

}  // namespace alidade::internal
