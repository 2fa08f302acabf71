#include "src/dataio/plain_csv.h"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <string_view>
#include <vector>

#include "src/common/parallel.h"
#include "src/common/plain_number.h"
#include "src/dataio/csv_lines.h"
#include "src/dataio/plain_rows.h"

namespace alidade::internal {
namespace {

constexpr std::string_view kSpaces = " \t";

// Whole lines of the text.
struct Chunk {
  std::string_view text;
  Eigen::Index num_rows = 0;
  int num_lines = 0;
  Eigen::Index first_row = 0;
  int lines_before = 0;
};

// The first line that begins at `offset` or after it.
std::size_t LineStart(std::string_view text, std::size_t offset) {
  if (offset == 0) return 0;
  const std::size_t end = text.find('\n', offset - 1);
  return end == std::string_view::npos ? text.size() : end + 1;
}

// Where chunks begin does not depend on the number of threads.
std::vector<Chunk> Cut(std::string_view text, std::size_t chunk_bytes) {
  std::vector<Chunk> chunks;
  std::size_t begin = 0;
  while (begin < text.size()) {
    const std::size_t wanted = std::min(text.size(), begin + chunk_bytes);
    const std::size_t end = LineStart(text, wanted);
    chunks.push_back({text.substr(begin, end - begin)});
    begin = end;
  }
  return chunks;
}

void Count(Chunk* chunk) {
  std::string_view rest = chunk->text;
  while (!rest.empty()) {
    if (!IsPassedOver(TakeLine(&rest))) ++chunk->num_rows;
    ++chunk->num_lines;
  }
}

// A text cell without the spaces around it.
std::string_view Trim(const char* begin, const char* end) {
  std::string_view text(begin, static_cast<std::size_t>(end - begin));
  const std::size_t first = text.find_first_not_of(kSpaces);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kSpaces) - first + 1);
}

// Reads the lines of one chunk.
class ChunkReader {
 public:
  ChunkReader(const PlainLayout& layout, PlainRows* rows)
      : layout_(layout), rows_(*rows), row_(layout.defaults) {}

  // False where a line is in doubt.
  bool Read(const Chunk& chunk) {
    std::string_view rest = chunk.text;
    Eigen::Index i = chunk.first_row;
    for (int line = chunk.lines_before + 1; !rest.empty(); ++line) {
      const std::string_view text = TakeLine(&rest);
      if (IsPassedOver(text)) continue;
      if (!ReadLine(text, i)) return false;
      rows_.SetLine(i++, line);
    }
    return true;
  }

 private:
  bool ReadLine(std::string_view line, Eigen::Index i) {
    const char* p = line.data();
    const char* const end = p + line.size();
    bool is_first = true;
    for (const PlainColumn& column : layout_.columns) {
      if (!is_first) {
        if (p == end) return false;
        ++p;  // a comma
      }
      is_first = false;
      p = column.use == PlainColumn::Use::kNumber ? ReadNumber(column, p, end)
                                                  : ReadText(column, p, end, i);
      if (p == nullptr) return false;
    }
    return p == end && rows_.Set(i, row_.data()) == PlainRows::State::kKept;
  }

  const char* ReadNumber(const PlainColumn& column, const char* p,
                         const char* end) {
    double& number = row_[static_cast<std::size_t>(column.slot)];
    p = ParsePlainCell(p, end, column.unit, &number);
    const bool is_refused =
        column.rule == CellRule::kPositive && !(number > 0.0);
    return is_refused ? nullptr : p;
  }

  const char* ReadText(const PlainColumn& column, const char* p,
                       const char* end, Eigen::Index i) {
    const char* const comma = std::find(p, end, ',');
    if (std::find(p, comma, '"') != comma) return nullptr;
    if (column.use == PlainColumn::Use::kSet) rows_.SetSet(i, Trim(p, comma));
    if (column.use != PlainColumn::Use::kTarget) return comma;
    const std::string_view name = Trim(p, comma);
    const auto& names = layout_.target_names;
    const auto found = std::find(names.begin(), names.end(), name);
    if (name.empty() || found == names.end()) return nullptr;
    rows_.SetTarget(i, static_cast<int>(found - names.begin()));
    return comma;
  }

  const PlainLayout& layout_;
  PlainRows& rows_;
  std::vector<double> row_;  // by slot
};

}  // namespace

std::optional<LoadedData> ReadPlainCsv(const RowReader& rows,
                                       const PlainLayout& layout,
                                       const Arm& arm,
                                       const ReadOptions& options) {
  std::vector<Chunk> chunks =
      Cut(rows.rest(), static_cast<std::size_t>(options.chunk_bytes));
  const auto num_chunks = static_cast<std::int64_t>(chunks.size());
  ParallelFor(options.num_threads, num_chunks, 1,
              [&](std::int64_t c, std::int64_t) { Count(&chunks[c]); });
  Eigen::Index num_rows = 0;
  int num_lines = rows.line();
  for (Chunk& chunk : chunks) {
    chunk.first_row = num_rows;
    chunk.lines_before = num_lines;
    num_rows += chunk.num_rows;
    num_lines += chunk.num_lines;
  }
  if (num_rows == 0) return std::nullopt;
  RequireFewRows(rows.path(), num_rows);
  PlainRows plain(layout, num_rows);
  plain.KeepLines();
  std::atomic<bool> is_suspect{false};
  ParallelFor(options.num_threads, num_chunks, 1,
              [&](std::int64_t c, std::int64_t) {
                if (is_suspect) return;
                ChunkReader reader(layout, &plain);
                if (!reader.Read(chunks[c])) is_suspect = true;
              });
  if (is_suspect) return std::nullopt;
  return plain.Finish(rows.path(), arm, {});
}

}  // namespace alidade::internal
