#ifndef ALIDADE_SRC_COMMON_UTF8_H_
#define ALIDADE_SRC_COMMON_UTF8_H_

#include <cstddef>
#include <string>
#include <string_view>

namespace alidade::internal {

/// Whether a byte goes on with a character that an earlier one began.
inline bool IsUtf8Continuation(char byte) {
  return (static_cast<unsigned char>(byte) & 0xC0U) == 0x80U;
}

/// Length of the valid character that `text`, which is not empty, begins with;
/// 0 where it is none.
std::size_t ValidUtf8Prefix(std::string_view text);

/// `text` as one line that a terminal shows as it is: control characters, marks
/// that turn the direction of writing or end a line, and bytes that are no
/// UTF-8 become escapes, "\n" or "\x1b". Messages hold names that come from
/// files, and those may hold anything.
std::string OnOneLine(std::string_view text);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_COMMON_UTF8_H_
