#ifndef ALIDADE_SRC_COMMON_TEXT_H_
#define ALIDADE_SRC_COMMON_TEXT_H_

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "src/common/number_text.h"

namespace alidade::internal {

/// Columns of a report for people; no line is longer unless a single word is.
inline constexpr int kReportWidth = 100;

/// Number of UTF-8 characters; a byte that cannot begin one counts as part of
/// the character before it.
int Utf8Length(std::string_view text);

/// `text` as valid UTF-8 for a document: what is no UTF-8 becomes U+FFFD,
/// control characters become spaces.
std::string CleanUtf8(std::string_view text);

/// Lines of at most `width` characters, broken at spaces. A longer word has a
/// line of its own, unbroken, so that paths and hashes can be copied. Never
/// empty: an empty text is one empty line.
std::vector<std::string> WrapText(std::string_view text, int width);

/// WrapText with every line after `indent` spaces, the whole within
/// kReportWidth, each line ending in a newline.
std::string Paragraph(std::string_view text, int indent = 0);

/// `title` underlined with `rule`.
std::string Heading(std::string_view title, char rule = '-');

std::string Join(const std::vector<std::string>& parts,
                 std::string_view separator);

/// A cell of a CSV: texts come from users, so quoted where one needs it.
std::string TextCell(const std::string& text);
/// The same at the end of `row`.
void AppendTextCell(const std::string& text, std::string* row);

/// `text` with a capital letter, where it begins with a word of small letters,
/// and a full stop, where it has none: "tracker.csv:5: lost" keeps its "t".
std::string AsSentence(std::string text);

/// "1 pose", "56 poses".
std::string Count(std::int64_t number, std::string_view singular);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_COMMON_TEXT_H_
