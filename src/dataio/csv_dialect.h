#ifndef ALIDADE_SRC_DATAIO_CSV_DIALECT_H_
#define ALIDADE_SRC_DATAIO_CSV_DIALECT_H_

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace alidade::internal {

/// How the cells of a text file are written. The default is that of Alidade's
/// own files.
struct CsvDialect {
  char separator = ',';   ///< ' ': any number of blanks and tabs
  char decimal = '.';     ///< or ','
  char thousands = '\0';  ///< '.', ',', '\'' or ' '; '\0' = none
  /// Texts of cells that were not measured, besides the usual ones. Numbers
  /// stand for all that have their value.
  std::vector<std::string> missing = {};

  bool has_plain_numbers() const { return decimal == '.' && thousands == '\0'; }
};

/// Lines of a file, as parts from a first to a last one.
class LineRanges {
 public:
  void Add(int first, int last);
  void Add(const std::pair<int, int>& lines) { Add(lines.first, lines.second); }
  bool empty() const { return ranges_.empty(); }
  /// Ascending, and apart.
  const std::vector<std::pair<int, int>>& ranges() const { return ranges_; }
  /// O(log parts): it is asked of every row.
  bool Contains(int line) const;

 private:
  std::vector<std::pair<int, int>> ranges_;
};

/// What a job says of a text file, in place of what is found in it.
struct StatedDialect {
  std::optional<char> separator;
  std::optional<char> decimal;
  std::optional<char> thousands;  ///< '\0' = none
  std::optional<int> header;      ///< its line, from 1; 0 = none
  std::vector<std::string> missing;
  LineRanges excluded_lines;  ///< what is left out

  bool IsExcluded(int line) const { return excluded_lines.Contains(line); }
};

/// What the marks in a text say of how numbers are written.
enum class NumberShape {
  kNone,       ///< no number in any dialect
  kInteger,    ///< digits alone
  kDecimal,    ///< one mark, which can only be the decimal one
  kAmbiguous,  ///< "1,234": the decimal mark, or that of thousands
  kThousands,  ///< marks of thousands alone
  kBoth,       ///< marks of both kinds
};

struct NumberMarks {
  NumberShape shape = NumberShape::kNone;
  char decimal = '\0';    ///< of kDecimal and kBoth
  char thousands = '\0';  ///< of kThousands and kBoth
  char ambiguous = '\0';  ///< of kAmbiguous
  int digits_before = 0;  ///< the mark, of kAmbiguous
};

/// How a cell is written, where it is a number in some dialect.
NumberMarks MarksOf(std::string_view cell);

/// A cell as digits with a decimal point, for ParseNumber, in a buffer of its
/// own: without plus sign and marks of thousands. Empty where it is no number
/// of the dialect; marks of thousands must have three digits between them.
class PlainNumber {
 public:
  PlainNumber(std::string_view cell, const CsvDialect& dialect);
  std::string_view text() const { return {buffer_.data(), size_}; }

 private:
  std::array<char, 64> buffer_;
  std::size_t size_ = 0;
};

/// Whether a cell says that nothing was measured: it is empty or one of the
/// words that instruments and spreadsheets write ("nan", "#N/A", "null",
/// "---").
bool IsNotMeasured(std::string_view cell);

/// Whether it is one of the dialect's own words for that.
bool IsStatedMissing(std::string_view cell, const CsvDialect& dialect);

/// "semicolons"
const char* SeparatorName(char separator);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATAIO_CSV_DIALECT_H_
