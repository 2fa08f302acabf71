#include "alidade/error.h"

#include "src/common/utf8.h"

namespace alidade {
namespace {

std::string FormatMessage(const SourceLocation& location,
                          const std::string& message) {
  std::string text = location.file;
  if (location.line > 0) {
    text += ":" + std::to_string(location.line);
    if (location.column > 0) text += ":" + std::to_string(location.column);
  }
  if (!text.empty()) text += ": ";
  if (!location.key.empty()) text += location.key + ": ";
  return internal::OnOneLine(text + message);
}

}  // namespace

InputError::InputError(const SourceLocation& location,
                       const std::string& message)
    : std::runtime_error(FormatMessage(location, message)),
      location_(location),
      message_(internal::OnOneLine(message)) {}

}  // namespace alidade
