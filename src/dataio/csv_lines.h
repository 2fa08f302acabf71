#ifndef ALIDADE_SRC_DATAIO_CSV_LINES_H_
#define ALIDADE_SRC_DATAIO_CSV_LINES_H_

#include <string>
#include <string_view>
#include <vector>

#include "alidade/error.h"

namespace alidade::internal {

/// Takes the first line off `text` and returns it without its end: '\n', and
/// one '\r' before it.
std::string_view TakeLine(std::string_view* text);

/// Whether the line holds nothing: it is blank, has empty cells alone, or is a
/// comment, which begins with '#', '//' or '%'.
bool IsPassedOver(std::string_view line, char separator = ',');

/// What stands behind the mark of a comment; empty where the line is none.
std::string_view CommentOf(std::string_view line);

/// The cells of a line, without the spaces and the double quotes around them,
/// for TextOf where they are texts. Null, or where a quote is not closed or
/// followed by something else than a separator.
const char* SplitCells(std::string_view line, char separator,
                       std::vector<std::string_view>* cells);

/// What a cell says: in quotes, two of them are one of the text.
std::string TextOf(std::string_view cell);

/// A line of a CSV file. Nothing is copied: the path and the text must outlive
/// it and its cells.
struct CsvLine {
  const std::string& path;
  std::string_view text;
  int number = 0;        ///< from 1; 0: it is in no file
  char separator = ',';  ///< ' ': any number of blanks and tabs

  /// SplitCells. @throws InputError where a quote is not closed.
  void Split(std::vector<std::string_view>* cells) const;

  /// Of `cell`, a part of the line (other texts have no place in it), or null.
  /// `column` is its name.
  SourceLocation Location(const char* cell = nullptr,
                          const std::string& column = "") const;

  /// @throws InputError there.
  [[noreturn]] void Fail(const std::string& message, const char* cell = nullptr,
                         const std::string& column = "") const {
    throw InputError(Location(cell, column), message);
  }
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATAIO_CSV_LINES_H_
