#include "src/report/markup.h"

#include <array>
#include <cctype>

#include "src/common/text.h"

namespace alidade::internal {
namespace {

bool IsDigit(std::string_view text, std::size_t at) {
  return at < text.size() &&
         std::isdigit(static_cast<unsigned char>(text[at])) != 0;
}

bool IsWordPart(std::string_view text, std::size_t at) {
  return at < text.size() &&
         std::isalnum(static_cast<unsigned char>(text[at])) != 0;
}

bool IsSign(std::string_view text, std::size_t at) {
  return at < text.size() && (text[at] == '-' || text[at] == '+');
}

// Where the exponent ends whose "e" or "^" stands at `at`; `at` where it is
// none.
std::size_t ExponentEnd(std::string_view text, std::size_t at) {
  const bool is_power = text[at] == '^';
  if (is_power ? text.substr(0, at).size() < 2 || text.substr(at - 2, 2) != "10"
               : text[at] != 'e' || at == 0 || !IsDigit(text, at - 1)) {
    return at;
  }
  std::size_t end = at + 1;
  if (IsSign(text, end)) {
    ++end;
  } else if (!is_power) {
    return at;
  }
  if (!IsDigit(text, end)) return at;
  while (IsDigit(text, end)) ++end;
  return IsWordPart(text, end) ? at : end;
}

// Without the zeros that C writes in front of an exponent.
std::string Superscript(std::string_view exponent) {
  constexpr std::array<const char*, 10> kDigits = {"⁰", "¹", "²", "³", "⁴",
                                                   "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string text = exponent.front() == '-' ? "⁻" : "";
  if (IsSign(exponent, 0)) exponent.remove_prefix(1);
  while (exponent.size() > 1 && exponent.front() == '0') {
    exponent.remove_prefix(1);
  }
  for (const char c : exponent) text += kDigits[c - '0'];
  return text;
}

// A hyphen before a number that no other word ends in.
bool IsMinus(std::string_view text, std::size_t at) {
  if (text[at] != '-' || !IsDigit(text, at + 1)) return false;
  constexpr std::string_view kBefore = " ([\xA0";
  return at == 0 || kBefore.find(text[at - 1]) != std::string_view::npos;
}

}  // namespace

std::string EscapeXml(std::string_view text) {
  std::string escaped;
  for (const char c : CleanUtf8(text)) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      case '\'':
        escaped += "&#39;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

std::string Typeset(std::string_view text) {
  std::string typeset;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t end = ExponentEnd(text, i);
    if (end > i) {
      if (text[i] == 'e') typeset += "×10";
      typeset += Superscript(text.substr(i + 1, end - i - 1));
      i = end;
    } else if (IsMinus(text, i)) {
      typeset += "\u2212";
      ++i;
    } else {
      typeset += text[i++];
    }
  }
  return typeset;
}

std::string Words(std::string_view text) { return EscapeXml(Typeset(text)); }

std::string Element(std::string_view tag, const Attributes& attributes,
                    std::string_view content) {
  std::string element = "<";
  element += tag;
  for (const auto& [name, value] : attributes) {
    if (value.empty()) continue;
    element += ' ';
    element += name;
    element += "=\"" + EscapeXml(value) + "\"";
  }
  element += '>';
  element += content;
  element += "</";
  element += tag;
  element += '>';
  return element;
}

}  // namespace alidade::internal
