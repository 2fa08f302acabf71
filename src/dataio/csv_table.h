#ifndef ALIDADE_SRC_DATAIO_CSV_TABLE_H_
#define ALIDADE_SRC_DATAIO_CSV_TABLE_H_

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "src/dataio/csv_layout.h"
#include "src/dataio/data_table.h"
#include "src/dataio/read_options.h"
#include "src/dataio/text_encoding.h"

namespace alidade::internal {

/// The table of a text file, in any encoding (text_encoding.h) and dialect
/// (csv_layout.h) that is certain or stated. Blank lines and comments are
/// passed over. The file is cut at line ends; where,
/// does not depend on the number of threads.
class CsvTable final : public DataTable {
 public:
  /// Reads the header and counts the rows. @throws InputError.
  CsvTable(MappedFile file, TableContent content, const ReadOptions& options);

  const TableHeader& header() const override { return *header_; }
  std::int64_t num_rows() const override { return num_rows_; }
  std::string Notes() const override;

 protected:
  std::int64_t num_chunks() const override {
    return static_cast<std::int64_t>(chunks_.size());
  }
  void VisitChunk(std::int64_t chunk, const Visit& visit) const override;
  int num_lines() const override { return num_lines_; }

 private:
  // Whole lines of the text.
  struct Chunk {
    std::string_view text;
    std::int64_t num_rows = 0;
    int num_lines = 0;
    std::int64_t first_row = 0;
    int lines_before = 0;
  };

  void ReadHeader(std::string_view text);
  void RequireMapping(std::string_view rows) const;
  void Cut(std::string_view rows, const ReadOptions& options);

  const std::string& path() const { return text_.file.path(); }

  const TextFile text_;
  const TableContent content_;
  CsvLayout layout_;
  std::optional<TableHeader> header_;
  std::vector<Chunk> chunks_;
  std::int64_t num_rows_ = 0;
  int num_lines_ = 0;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATAIO_CSV_TABLE_H_
