#include "src/report/rows.h"

#include <cstddef>
#include <utility>

namespace alidade::internal {
namespace {

constexpr std::size_t kPieceSize = std::size_t{1} << 18;

}  // namespace

TextSource MakeRows(std::string header, std::int64_t num_rows,
                    RowAppender append_row) {
  return [header = std::move(header), num_rows,
          append_row = std::move(append_row)](const TextSink& sink) {
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
