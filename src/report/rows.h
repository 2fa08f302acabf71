#ifndef ALIDADE_SRC_REPORT_ROWS_H_
#define ALIDADE_SRC_REPORT_ROWS_H_

#include <cstdint>
#include <functional>
#include <string>

#include "src/common/text_pieces.h"

namespace alidade::internal {

/// Appends a row of a table, its newline too. @pre 0 <= row < number of rows.
using RowAppender = std::function<void(std::int64_t row, std::string* text)>;

/// A table as text, made in pieces of some 256 KiB: `header`, which ends in a
/// newline, and the rows in their order. Memory does not grow with them.
TextSource MakeRows(std::string header, std::int64_t num_rows,
                    RowAppender append_row);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_REPORT_ROWS_H_
