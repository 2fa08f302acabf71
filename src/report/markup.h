#ifndef ALIDADE_SRC_REPORT_MARKUP_H_
#define ALIDADE_SRC_REPORT_MARKUP_H_

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace alidade::internal {

/// All that it takes to write HTML and SVG. Text of a result only ever becomes
/// escaped text, so that no name of an arm or of a file can become markup.

/// `text` for character data and attributes of XML: markup characters
/// escaped, what is not valid in a document replaced.
std::string EscapeXml(std::string_view text);

/// Numbers as books print them: "2.3e-13" and "10^-13" with superscripts, "-5"
/// and "a1 - 2 mm * b1" with signs of minus and multiplication. For sentences
/// and numbers, not for names and paths; what stands in backticks is somebody's
/// file and stays as it is.
std::string Typeset(std::string_view text);

/// Sentences and numbers as character data: both of the above.
std::string Words(std::string_view text);

/// The same as markup, in which what stands in backticks is code.
std::string Sentences(std::string_view text);

/// Names and values, which are escaped; one without a value is left out.
using Attributes = std::vector<std::pair<std::string_view, std::string>>;

/// `content` is markup.
std::string Element(std::string_view tag, const Attributes& attributes,
                    std::string_view content);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_REPORT_MARKUP_H_
