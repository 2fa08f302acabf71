#include "src/dataio/npy_table.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <utility>

#include "src/common/constants.h"
#include "src/common/numbers.h"
#include "src/common/text.h"
#include "src/dataio/csv_lines.h"

namespace alidade::internal {
namespace {

// Little endian, at any address; compilers make one instruction of it.
double LoadDouble(const char* bytes) {
  std::uint64_t bits = 0;
  for (int i = 7; i >= 0; --i) {
    bits = bits << 8 | static_cast<unsigned char>(bytes[i]);
  }
  double value = 0.0;
  std::memcpy(&value, &bits, sizeof(value));
  return value;
}

// The shortest decimal text of `number` times 10^exponent.
double Shifted(double number, int exponent) {
  if (exponent == 0) return number;
  const double shifted = ShiftShort(number, exponent);
  if (!std::isnan(shifted)) return shifted;
  return ParseNumber(ShortestNumber(number), exponent).value_or(kNan);
}

class NpyRow final : public TableRow {
 public:
  explicit NpyRow(const TableHeader& header) : TableRow(header) {}

  void Read(const char* record, std::int64_t index) {
    record_ = record;
    MoveTo(index, static_cast<int>(index) + 1);
    for (const NumberColumn& column : number_columns()) {
      const double number = Stored(column.column);
      const double value =
          Shifted(number, column.unit.exponent) * column.unit.factor;
      const bool is_allowed =
          std::isfinite(value) ||
          (std::isnan(number) && column.rule != CellRule::kRequired);
      if (!is_allowed) FailNumber(column);
      SetNumber(column, value);
    }
  }

  std::string_view Text(int spec) const override {
    text_ = header().Has(spec) ? ShortestNumber(Stored(header().ColumnOf(spec)))
                               : "";
    return text_;
  }

  SourceLocation Location(int spec) const override {
    return {header().path(), line(), 0, header().NameOf(spec)};
  }

 private:
  double Stored(int column) const {
    return LoadDouble(record_ + std::size_t{8} * column);
  }

  const char* record_ = nullptr;
  mutable std::string text_;
};

}  // namespace

NpyTable::NpyTable(MappedFile file, TableContent content,
                   const ReadOptions& options)
    : file_(std::make_shared<const MappedFile>(std::move(file))),
      content_(std::move(content)),
      array_(ReadNpyHeader(file_->path(), file_->text())),
      rows_per_chunk_(std::max<std::int64_t>(
          1, options.chunk_bytes /
                 static_cast<std::int64_t>(array_.record_bytes()))),
      may_be_in_place_(static_cast<std::int64_t>(file_->text().size()) >=
                       options.fewest_bytes_in_place) {
  RequireFewRows(file_->path(), num_rows());
  const std::string names = Join(array_.names, ",");
  header_.emplace(CsvLine{file_->path(), names, 0}, content_);
  RefuseTexts();
}

void NpyTable::RefuseTexts() const {
  if (header_->has_conditions()) {
    header_->Fail(
        "`where` and `exclude` choose rows by text, which NumPy arrays of "
        "numbers do not have: expected a CSV, or numbers of rows");
  }
  const StatedDialect& dialect = content_.dialect;
  if (dialect.separator || dialect.decimal || dialect.thousands ||
      dialect.header || !dialect.missing.empty()) {
    header_->Fail(
        "`separator`, `decimal`, `thousands`, `header` and `missing` say how "
        "texts are written, which NumPy arrays are not");
  }
  for (const TableHeader::Column& column : header_->columns()) {
    if (column.spec < 0 ||
        content_.specs[column.spec].type != ColumnType::kText) {
      continue;
    }
    header_->Fail(
        "the column holds text, but the array numbers: expected a CSV, "
        "or `target`, `point` or `plane` of all rows in the job's `data`",
        column.name);
  }
}

std::int64_t NpyTable::num_chunks() const {
  return (num_rows() + rows_per_chunk_ - 1) / rows_per_chunk_;
}

void NpyTable::VisitChunk(std::int64_t chunk, const Visit& visit) const {
  NpyRow row(*header_);
  const char* const first = file_->text().data() + array_.data_offset;
  const std::int64_t begin = chunk * rows_per_chunk_;
  const std::int64_t end = std::min(num_rows(), begin + rows_per_chunk_);
  for (std::int64_t i = begin; i < end; ++i) {
    if (content_.dialect.IsExcluded(static_cast<int>(i) + 1)) continue;
    row.Read(first + static_cast<std::size_t>(i) * array_.record_bytes(), i);
    visit(row);
  }
}

std::optional<SharedMatrix> NpyTable::InPlace(int spec, int count) const {
  constexpr double kNumber = 1.2345;
  const char* const bytes = file_->text().data() + array_.data_offset;
  if (!may_be_in_place_ || !content_.dialect.excluded_lines.empty() ||
      reinterpret_cast<std::uintptr_t>(bytes) % alignof(double) != 0 ||
      LoadDouble(reinterpret_cast<const char*>(&kNumber)) != kNumber) {
    return std::nullopt;
  }
  const int first = header_->ColumnOf(spec);
  for (int k = 0; k < count; ++k) {
    const int column = header_->ColumnOf(spec + k);
    if (column < 0 || column != first + k) return std::nullopt;
    const Unit* const unit = header_->columns()[column].unit;
    if (unit->exponent != 0 || unit->factor != 1.0) return std::nullopt;
  }
  const auto* const numbers = reinterpret_cast<const double*>(bytes) + first;
  return SharedMatrix(std::shared_ptr<const double>(file_, numbers), count,
                      num_rows(),
                      static_cast<Eigen::Index>(array_.names.size()));
}

}  // namespace alidade::internal
