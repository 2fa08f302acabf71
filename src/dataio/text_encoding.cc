#include "src/dataio/text_encoding.h"

#include <algorithm>
#include <cstdint>
#include <string_view>
#include <utility>

#include "alidade/error.h"

namespace alidade::internal {
namespace {

constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
// Headers are longer nowhere.
constexpr std::size_t kFirstBytes = 1 << 16;

void AppendUtf8(std::uint32_t code, std::string* text) {
  const auto add = [text](std::uint32_t byte) {
    *text += static_cast<char>(byte);
  };
  if (code < 0x80) {
    add(code);
  } else if (code < 0x800) {
    add(0xc0 | (code >> 6));
    add(0x80 | (code & 0x3f));
  } else if (code < 0x10000) {
    add(0xe0 | (code >> 12));
    add(0x80 | ((code >> 6) & 0x3f));
    add(0x80 | (code & 0x3f));
  } else {
    add(0xf0 | (code >> 18));
    add(0x80 | ((code >> 12) & 0x3f));
    add(0x80 | ((code >> 6) & 0x3f));
    add(0x80 | (code & 0x3f));
  }
}

std::string FromUtf16(std::string_view bytes, bool is_big_endian) {
  std::string text;
  text.reserve(bytes.size() / 2);
  const auto unit = [&](std::size_t at) {
    const auto first = static_cast<unsigned char>(bytes[at]);
    const auto second = static_cast<unsigned char>(bytes[at + 1]);
    return static_cast<std::uint32_t>(is_big_endian ? first << 8 | second
                                                    : second << 8 | first);
  };
  for (std::size_t at = 0; at + 1 < bytes.size(); at += 2) {
    std::uint32_t code = unit(at);
    const bool is_pair =
        code >= 0xd800 && code < 0xdc00 && at + 3 < bytes.size();
    if (is_pair) {
      at += 2;
      code = 0x10000 + ((code - 0xd800) << 10) + (unit(at) - 0xdc00);
    }
    AppendUtf8(code, &text);
  }
  return text;
}

std::string FromWindows1252(std::string_view bytes) {
  // 0x80 to 0x9f; the others are those of Unicode.
  static constexpr std::uint16_t kCodes[32] = {
      0x20ac, 0x81,   0x201a, 0x192,  0x201e, 0x2026, 0x2020, 0x2021,
      0x2c6,  0x2030, 0x160,  0x2039, 0x152,  0x8d,   0x17d,  0x8f,
      0x90,   0x2018, 0x2019, 0x201c, 0x201d, 0x2022, 0x2013, 0x2014,
      0x2dc,  0x2122, 0x161,  0x203a, 0x153,  0x9d,   0x17e,  0x178};
  std::string text;
  text.reserve(bytes.size() + bytes.size() / 8);
  for (const char c : bytes) {
    const auto byte = static_cast<unsigned char>(c);
    AppendUtf8(byte >= 0x80 && byte < 0xa0 ? kCodes[byte - 0x80] : byte, &text);
  }
  return text;
}

// The start of a text may end within a character.
bool IsUtf8(std::string_view text) {
  for (std::size_t at = 0; at < text.size();) {
    const auto byte = static_cast<unsigned char>(text[at]);
    const std::size_t more = byte < 0x80           ? 0
                             : (byte >> 5) == 0x06 ? 1
                             : (byte >> 4) == 0x0e ? 2
                             : (byte >> 3) == 0x1e ? 3
                                                   : 4;
    if (more == 4) return false;
    for (std::size_t k = 1; k <= more && at + k < text.size(); ++k) {
      if ((static_cast<unsigned char>(text[at + k]) >> 6) != 2) return false;
    }
    at += more + 1;
  }
  return true;
}

// Of text in Latin letters every other byte is zero in UTF-16.
bool HasZerosAt(std::string_view text, std::size_t first) {
  if (text.size() < 4) return false;
  std::size_t zeros = 0;
  for (std::size_t at = first; at < text.size(); at += 2) {
    if (text[at] == '\0') ++zeros;
  }
  return zeros * 2 > text.size() * 9 / 10;
}

[[noreturn]] void Fail(const std::string& path, const std::string& message) {
  throw InputError({path, 0, 0, ""}, message);
}

void RefuseWorkbooks(const std::string& path, std::string_view text) {
  const std::string_view mark = text.substr(0, 4);
  if (mark == "PK\x03\x04" || mark == "\xd0\xcf\x11\xe0") {
    Fail(path,
         "a workbook or an archive and not a text file: save the sheet as CSV");
  }
}

// What the text was converted from, and the text; empty where it stays.
std::pair<std::string, std::string> Convert(const std::string& path,
                                            std::string_view text) {
  const std::string_view mark = text.substr(0, 2);
  const std::string_view start = text.substr(0, kFirstBytes);
  if (mark == "\xff\xfe") return {"UTF-16", FromUtf16(text.substr(2), false)};
  if (mark == "\xfe\xff") return {"UTF-16", FromUtf16(text.substr(2), true)};
  const bool low_first = HasZerosAt(start, 1);
  // Nothing but zeros is no text.
  if (low_first != HasZerosAt(start, 0)) {
    return {"UTF-16", FromUtf16(text, !low_first)};
  }
  if (text.find('\0') != std::string_view::npos) {
    Fail(path, "not a text file, expected comma-separated values");
  }
  if (!IsUtf8(start)) return {"Windows-1252", FromWindows1252(text)};
  return {};
}

}  // namespace

TextFile OpenText(MappedFile file) {
  const std::string path = file.path();
  RefuseWorkbooks(path, file.text());
  auto [encoding, text] = Convert(path, file.text());
  const std::string_view now = encoding.empty() ? file.text() : text;
  const bool has_old_ends = now.find('\n') == std::string_view::npos &&
                            now.find('\r') != std::string_view::npos;
  if (has_old_ends) {
    if (encoding.empty()) text = std::string(now);
    std::replace(text.begin(), text.end(), '\r', '\n');
  }
  const bool is_new = has_old_ends || !encoding.empty();
  MappedFile result =
      is_new ? MappedFile(path, std::move(text)) : std::move(file);
  const bool has_mark =
      result.text().substr(0, kByteOrderMark.size()) == kByteOrderMark;
  return {std::move(result), has_mark ? kByteOrderMark.size() : 0, encoding};
}

}  // namespace alidade::internal
