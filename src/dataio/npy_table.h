#ifndef ALIDADE_SRC_DATAIO_NPY_TABLE_H_
#define ALIDADE_SRC_DATAIO_NPY_TABLE_H_

#include <cstddef>
#include <memory>
#include <optional>
#include <string>

#include "alidade/shared_matrix.h"
#include "src/common/mapped_file.h"
#include "src/dataio/data_table.h"
#include "src/dataio/npy_header.h"
#include "src/dataio/read_options.h"

namespace alidade::internal {

/// The table of a NumPy array (docs/files.md, "Data set (NPY)"). Its numbers
/// are those of a CSV with the same header and the shortest digits of each, to
/// the same bits. Lines, in sources and messages, are rows from 1.
class NpyTable final : public DataTable {
 public:
  /// @throws InputError, also where the content asks for texts.
  NpyTable(MappedFile file, TableContent content, const ReadOptions& options);

  const TableHeader& header() const override { return *header_; }
  std::int64_t num_rows() const override { return array_.num_rows; }

  std::optional<SharedMatrix> InPlace(int spec, int count) const override;

 protected:
  std::int64_t num_chunks() const override;
  void VisitChunk(std::int64_t chunk, const Visit& visit) const override;
  int num_lines() const override { return static_cast<int>(num_rows()); }

 private:
  void RefuseTexts() const;

  const std::shared_ptr<const MappedFile> file_;
  const TableContent content_;
  const NpyHeader array_;
  std::optional<TableHeader> header_;
  const std::int64_t rows_per_chunk_;
  const bool may_be_in_place_;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATAIO_NPY_TABLE_H_
