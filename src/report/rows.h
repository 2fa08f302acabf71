#ifndef ALIDADE_SRC_REPORT_ROWS_H_
#define ALIDADE_SRC_REPORT_ROWS_H_

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <type_traits>
#include <utility>

#include "src/common/text.h"
#include "src/common/text_pieces.h"

namespace alidade::internal {

/// Appends a cell of a CSV: a number with the fewest digits that read back to
/// the same bits, nothing for NaN; a text, quoted where it needs it.
template <typename Value>
void AppendCsvCell(std::string* row, const Value& value) {
  if constexpr (std::is_same_v<Value, bool>) {
    *row += value ? "true" : "false";
  } else if constexpr (std::is_integral_v<Value>) {
    *row += std::to_string(value);
  } else if constexpr (std::is_floating_point_v<Value>) {
    if (!std::isnan(value)) AppendShortest(value, row);
  } else {
    AppendTextCell(value, row);
  }
}

/// Appends cells, each with the comma behind it.
template <typename... Values>
void AppendCsvCells(std::string* row, const Values&... values) {
  ((AppendCsvCell(row, values), *row += ','), ...);
}

/// Appends the last cell of a row.
template <typename Value>
void EndCsvRow(std::string* row, const Value& value) {
  AppendCsvCell(row, value);
  *row += '\n';
}

/// Appends a row of a table, its newline too. @pre 0 <= row < number of rows.
using RowAppender = std::function<void(std::int64_t row, std::string* text)>;

/// A table as text, made in pieces of some 256 KiB: `header`, which ends in a
/// newline, and the rows in their order. Memory does not grow with them.
inline TextSource MakeRows(std::string header, std::int64_t num_rows,
                           RowAppender append_row) {
  return [header = std::move(header), num_rows,
          append_row = std::move(append_row)](const TextSink& sink) {
    constexpr std::size_t kPieceSize = std::size_t{1} << 18;
    std::string piece = header;
    for (std::int64_t row = 0; row < num_rows; ++row) {
      append_row(row, &piece);
      if (piece.size() < kPieceSize) continue;
      sink(piece);
      piece.clear();
    }
    if (!piece.empty()) sink(piece);
  };
}

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_REPORT_ROWS_H_
