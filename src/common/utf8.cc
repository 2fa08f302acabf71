#include "src/common/utf8.h"

#include <algorithm>

namespace alidade::internal {
namespace {

int SequenceLength(unsigned char lead) {
  if (lead < 0x80U) return 1;
  if (lead >= 0xC2U && lead < 0xE0U) return 2;
  if (lead >= 0xE0U && lead < 0xF0U) return 3;
  if (lead >= 0xF0U && lead < 0xF5U) return 4;
  return 0;
}

// Overlong forms, surrogates, and what lies above U+10FFFF show in the second
// byte. U+FFFE and U+FFFF are no characters of XML.
bool IsForbidden(std::string_view sequence) {
  if (sequence.size() < 3) return false;
  const auto lead = static_cast<unsigned char>(sequence[0]);
  const auto second = static_cast<unsigned char>(sequence[1]);
  if (lead == 0xE0U && second < 0xA0U) return true;
  if (lead == 0xEDU && second >= 0xA0U) return true;
  if (lead == 0xF0U && second < 0x90U) return true;
  if (lead == 0xF4U && second >= 0x90U) return true;
  return sequence == "\xEF\xBF\xBE" || sequence == "\xEF\xBF\xBF";
}

}  // namespace

std::size_t ValidUtf8Prefix(std::string_view text) {
  const auto length = static_cast<std::size_t>(
      SequenceLength(static_cast<unsigned char>(text[0])));
  if (length == 0 || length > text.size()) return 0;
  const std::string_view sequence = text.substr(0, length);
  if (!std::all_of(sequence.begin() + 1, sequence.end(), IsUtf8Continuation)) {
    return 0;
  }
  return IsForbidden(sequence) ? 0 : length;
}

namespace {

// Above ASCII: controls of ISO 8859, ends of lines and paragraphs, and marks of
// the direction of writing, with which a name can show as another.
bool IsHidden(std::string_view character) {
  if (character.size() == 2 && character[0] == '\xC2') {
    return static_cast<unsigned char>(character[1]) < 0xA0U;
  }
  if (character.size() != 3 || character[0] != '\xE2') return false;
  const auto last = static_cast<unsigned char>(character[2]);
  if (character[1] == '\x80') return last >= 0xA8U && last <= 0xAEU;
  return character[1] == '\x81' && last >= 0xA6U && last <= 0xA9U;
}

void AppendEscape(char byte, std::string* text) {
  static constexpr std::string_view kDigits = "0123456789abcdef";
  const auto value = static_cast<unsigned char>(byte);
  if (byte == '\n') {
    *text += "\\n";
  } else {
    *text += {'\\', 'x', kDigits[value >> 4], kDigits[value & 0x0FU]};
  }
}

}  // namespace

std::string OnOneLine(std::string_view text) {
  std::string line;
  while (!text.empty()) {
    const std::size_t valid = ValidUtf8Prefix(text);
    const std::string_view character =
        text.substr(0, std::max<std::size_t>(valid, 1));
    const auto first = static_cast<unsigned char>(text[0]);
    if (valid == 0 || first < 0x20U || first == 0x7FU || IsHidden(character)) {
      for (const char byte : character) AppendEscape(byte, &line);
    } else {
      line += character;
    }
    text.remove_prefix(character.size());
  }
  return line;
}

}  // namespace alidade::internal
