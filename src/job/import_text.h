#ifndef ALIDADE_SRC_JOB_IMPORT_TEXT_H_
#define ALIDADE_SRC_JOB_IMPORT_TEXT_H_

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "src/dataio/csv_dialect.h"
#include "src/dataio/csv_layout.h"
#include "src/dataio/row_condition.h"
#include "src/dataio/text_encoding.h"

namespace alidade::internal {

/// The table in a text that another program wrote, as its cells stand there.
class ImportText {
 public:
  using Cells = std::vector<std::string_view>;
  /// `line` is that of the file, from 1.
  using Visit = std::function<void(const Cells& cells, int line)>;

  /// @throws InputError where the file holds no table, or none that is certain.
  ImportText(const std::string& path, const StatedDialect& stated,
             std::vector<RowCondition> exclude = {});

  const std::vector<std::string>& names() const { return layout_.names; }
  const CsvDialect& dialect() const { return layout_.dialect; }
  /// How it is written, where that is not Alidade's own form.
  std::vector<std::string> Notes() const;

  /// All rows that are not excluded, whatever their number of cells.
  void VisitRows(const Visit& visit) const;

  /// Refuses a table in which several rows have fewer cells than the header,
  /// and names all of them. `file`: what stands before lines in --exclude.
  /// @throws InputError.
  void RefuseShortRows(const std::string& file = "") const;

  /// Refuses whatever rows have other cells than the header, or a quote that is
  /// not closed. @throws InputError.
  void RefuseBadRows(const std::string& file) const;

  /// Lines of the last rows, as far as all these columns (from 1) are empty
  /// there.
  std::vector<int> EmptyAtEnd(const std::vector<int>& columns) const;

  /// Refuses a table whose last rows, several of them, have no joint values.
  /// @throws InputError.
  void RefuseEmptyAtEnd(const std::vector<int>& joints) const;

  /// A cell with its numbers as Alidade writes them: "1234.5" of "1.234,5".
  std::string PlainCell(std::string_view cell) const;

  /// The largest number of the columns (from 1) without its sign, in lines that
  /// `stated` does not exclude.
  double LargestOf(const std::vector<int>& columns,
                   const StatedDialect& stated) const;

 private:
  std::string_view text() const {
    return std::string_view(text_.file.text()).substr(text_.begin);
  }

  [[noreturn]] void FailSlipped(const std::string& what,
                                const std::vector<int>& lines, bool are_last,
                                const std::string& file = "") const;

  // Whatever their quotes.
  template <typename Use>
  void VisitLines(const Use& use) const;
  bool IsExcluded(const Cells& cells) const;

  const std::string path_;
  const StatedDialect stated_;
  const std::vector<RowCondition> exclude_;
  TextFile text_;
  CsvLayout layout_;
};

/// "4, 6-8" of ascending numbers.
std::string LinesText(const std::vector<int>& lines);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_JOB_IMPORT_TEXT_H_
