#ifndef ALIDADE_SRC_DATAIO_CSV_TABLE_H_
#define ALIDADE_SRC_DATAIO_CSV_TABLE_H_

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "src/common/mapped_file.h"
#include "src/dataio/data_table.h"
#include "src/dataio/read_options.h"

namespace alidade::internal {

/// The table of a CSV file. Blank lines and lines that begin with '#' are
/// passed over; a byte-order mark and the carriage returns of Windows are
/// accepted. The file is mapped into memory and cut at line ends; where, does
/// not depend on the number of threads.
class CsvTable final : public DataTable {
 public:
  /// Reads the header and counts the rows. @throws InputError.
  CsvTable(const std::string& path, TableContent content,
           const ReadOptions& options);

  const TableHeader& header() const override { return *header_; }
  std::int64_t num_rows() const override { return num_rows_; }

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

  void RefuseOtherEncodings() const;
  void ReadHeader(std::string_view* rest);
  void Cut(std::string_view rows, const ReadOptions& options);

  const MappedFile file_;
  const TableContent content_;
  std::optional<TableHeader> header_;
  std::vector<Chunk> chunks_;
  std::int64_t num_rows_ = 0;
  int num_lines_ = 0;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATAIO_CSV_TABLE_H_
