#ifndef ALIDADE_SRC_REPORT_HTML_JSON_H_
#define ALIDADE_SRC_REPORT_HTML_JSON_H_

#include <string>
#include <string_view>

namespace alidade::internal {

// JSON for a <script> element: no '<' is ever written as such, so that nothing
// in it can end the element.

/// A string with its quotes.
std::string JsonText(std::string_view text);

/// `digits` significant digits, `null` where the value is not finite.
std::string JsonNumber(double value, int digits);

/// A JSON document without the white space between its parts. Numbers of more
/// than `digits` significant digits are rounded to so many; 0 = all stay.
std::string CompactJson(std::string_view json, int digits);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_REPORT_HTML_JSON_H_
