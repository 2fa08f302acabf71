#include "alidade/error.h"

namespace alidade {
namespace {

// Names that files give may hold anything; messages are one line.
std::string OnOneLine(const std::string& name) {
  static constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x20 && byte != 0x7f) {
      text += c;
    } else if (c == '\n') {
      text += "\\n";
    } else {
      text += std::string("\\x") + kDigits[byte >> 4] + kDigits[byte & 0x0f];
    }
  }
  return text;
}

std::string FormatMessage(const SourceLocation& location,
                          const std::string& message) {
  std::string text = location.file;
  if (location.line > 0) {
    text += ":" + std::to_string(location.line);
    if (location.column > 0) text += ":" + std::to_string(location.column);
  }
  if (!text.empty()) text += ": ";
  if (!location.key.empty()) text += OnOneLine(location.key) + ": ";
  return text + message;
}

}  // namespace

InputError::InputError(const SourceLocation& location,
                       const std::string& message)
    : std::runtime_error(FormatMessage(location, message)),
      location_(location),
      message_(message) {}

}  // namespace alidade
