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

// A sign between two terms of a formula, with a space on either side, one of
// which is a number or has one in its name: "theta2 - beta2", "-70 mm * r2".
bool IsBetweenTerms(std::string_view text, std::size_t at) {
  if (at < 2 || at + 2 >= text.size() || text[at - 1] != ' ' ||
      text[at + 1] != ' ') {
    return false;
  }
  const auto has_digit = [](std::string_view term) {
    return term.find_first_of("0123456789_") != std::string_view::npos &&
           term.find_first_of("/.:") != 0;
  };
  const std::string_view before = text.substr(0, at - 1);
  const std::size_t space = before.find_last_of(' ');
  const std::string_view after = text.substr(at + 2);
  return has_digit(after.substr(0, after.find(' '))) ||
         has_digit(space == std::string_view::npos ? before
                                                   : before.substr(space + 1));
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
    const std::size_t quoted =
        text[i] == '`' ? text.find('`', i + 1) : std::string_view::npos;
    if (quoted != std::string_view::npos) {
      typeset += text.substr(i, quoted + 1 - i);
      i = quoted + 1;
      continue;
    }
    const std::size_t end = ExponentEnd(text, i);
    if (end > i) {
      if (text[i] == 'e') typeset += "×10";
      typeset += Superscript(text.substr(i + 1, end - i - 1));
      i = end;
    } else if (IsMinus(text, i) ||
               (text[i] == '-' && IsBetweenTerms(text, i))) {
      typeset += "\u2212";
      ++i;
    } else if (text[i] == '*' && IsBetweenTerms(text, i)) {
      typeset += "×";
      ++i;
    } else {
      typeset += text[i++];
    }
  }
  return typeset;
}

std::string Words(std::string_view text) { return EscapeXml(Typeset(text)); }

std::string Sentences(std::string_view text) {
  std::string markup;
  const std::string typeset = Typeset(text);
  for (std::size_t from = 0; from < typeset.size();) {
    const std::size_t open = typeset.find('`', from);
    const std::size_t close =
        open == std::string::npos ? open : typeset.find('`', open + 1);
    if (close == std::string::npos) {
      return markup + EscapeXml(typeset.substr(from));
    }
    markup += EscapeXml(typeset.substr(from, open - from)) +
              Element("code", {},
                      EscapeXml(typeset.substr(open + 1, close - open - 1)));
    from = close + 1;
  }
  return markup;
}

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
