#ifndef ALIDADE_SRC_COMMON_CHARACTERS_H_
#define ALIDADE_SRC_COMMON_CHARACTERS_H_

#include <string>

namespace alidade::internal {

// Characters of ASCII; those of <cctype> depend on the locale.

inline bool IsDigit(char c) { return c >= '0' && c <= '9'; }

inline bool IsControl(char c) {
  return static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
}

inline char LowerCase(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

/// `text` with its letters of ASCII in lower case.
inline std::string LowerCase(std::string text) {
  for (char& c : text) c = LowerCase(c);
  return text;
}

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_COMMON_CHARACTERS_H_
