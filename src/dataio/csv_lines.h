#ifndef ALIDADE_SRC_DATAIO_CSV_LINES_H_
#define ALIDADE_SRC_DATAIO_CSV_LINES_H_

#include <string>
#include <string_view>
#include <vector>

namespace alidade::internal {

/// Takes the first line off `text` and returns it without its end: '\n', and
/// one '\r' before it.
std::string_view TakeLine(std::string_view* text);

/// Whether the line is blank or begins with '#', so that it holds nothing.
bool IsPassedOver(std::string_view line);

/// Goes through the lines of a CSV text and splits them into cells. Blank lines
/// and lines that begin with '#' are passed over; a byte-order mark and the
/// carriage returns of Windows are accepted. Nothing is copied: `path` and
/// `text` must outlive the reader and the cells.
class CsvLines {
 public:
  CsvLines(const std::string& path, std::string_view text);

  /// False at the end of the text.
  bool Next();

  std::string_view line() const { return line_; }
  int line_number() const { return line_number_; }  ///< from 1
  /// The text after the line.
  std::string_view rest() const { return rest_; }

  /// The cells of the line, without the spaces and the double quotes around
  /// them. @throws InputError where a quote is not closed.
  void Split(std::vector<std::string_view>* cells) const;

  /// The column (from 1) that a part of the line begins at.
  int ColumnOf(const char* cell) const {
    return static_cast<int>(cell - line_.data()) + 1;
  }

  /// @throws InputError at the line that was read last. `cell` is a part of
  /// that line, or null; `column` is its name.
  [[noreturn]] void Fail(const std::string& message, const char* cell = nullptr,
                         const std::string& column = "") const;

 private:
  std::size_t CellEnd(std::string_view text) const;

  const std::string& path_;
  std::string_view rest_;
  std::string_view line_;
  int line_number_ = 0;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATAIO_CSV_LINES_H_
