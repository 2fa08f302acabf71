#include "src/common/text.h"

#include <fmt/format.h>

#include <algorithm>

#include "src/common/characters.h"
#include "src/common/utf8.h"

namespace alidade::internal {
namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";  // U+FFFD

}  // namespace

int Utf8Length(std::string_view text) {
  return static_cast<int>(text.size() -
                          static_cast<std::size_t>(std::count_if(
                              text.begin(), text.end(), IsUtf8Continuation)));
}

std::string CleanUtf8(std::string_view text) {
  std::string clean;
  while (!text.empty()) {
    const std::size_t length = ValidUtf8Prefix(text);
    if (length == 0) {
      clean += kReplacement;
    } else if (IsControl(text[0])) {
      clean += ' ';
    } else {
      clean += text.substr(0, length);
    }
    text.remove_prefix(std::max<std::size_t>(length, 1));
  }
  return clean;
}

std::vector<std::string> WrapText(std::string_view text, int width) {
  std::vector<std::string> lines(1);
  while (!text.empty()) {
    const std::string_view word =
        text.substr(0, std::min(text.find_first_of(" \n\t"), text.size()));
    text.remove_prefix(std::min(word.size() + 1, text.size()));
    if (word.empty()) continue;
    std::string& line = lines.back();
    if (line.empty()) {
      line = word;
    } else if (Utf8Length(line) + 1 + Utf8Length(word) <= width) {
      line += ' ';
      line += word;
    } else {
      lines.emplace_back(word);
    }
  }
  return lines;
}

std::string Paragraph(std::string_view text, int indent) {
  const std::string margin(static_cast<std::size_t>(indent), ' ');
  std::string paragraph;
  for (const std::string& line : WrapText(text, kReportWidth - indent)) {
    paragraph += line.empty() ? "\n" : margin + line + "\n";
  }
  return paragraph;
}

std::string Heading(std::string_view title, char rule) {
  const auto length = static_cast<std::size_t>(Utf8Length(title));
  return std::string(title) + "\n" + std::string(length, rule) + "\n";
}

std::string Join(const std::vector<std::string>& parts,
                 std::string_view separator) {
  return fmt::to_string(fmt::join(parts, separator));
}

std::string AsSentence(std::string text) {
  const std::size_t word =
      text.find_first_not_of("abcdefghijklmnopqrstuvwxyz-");
  if (word > 0 && word < text.size() && text[word] == ' ') text[0] -= 'a' - 'A';
  if (!text.empty() && text.back() != '.') text += '.';
  return text;
}

std::string Count(std::int64_t number, std::string_view singular) {
  return fmt::format("{} {}{}", number, singular, number == 1 ? "" : "s");
}

std::string TextCell(const std::string& text) {
  std::string cell;
  AppendTextCell(text, &cell);
  return cell;
}

void AppendTextCell(const std::string& text, std::string* row) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) {
    *row += text;
    return;
  }
  *row += '"';
  for (const char c : text) {
    if (c == '"') *row += '"';
    *row += c == '\n' || c == '\r' ? ' ' : c;
  }
  *row += '"';
}

}  // namespace alidade::internal
