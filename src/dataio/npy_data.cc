#include "src/dataio/npy_data.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "alidade/error.h"
#include "src/common/mapped_file.h"
#include "src/common/numbers.h"
#include "src/common/parallel.h"
#include "src/common/text.h"
#include "src/dataio/dataset_reader.h"
#include "src/dataio/npy_header.h"
#include "src/dataio/plain_layout.h"
#include "src/dataio/plain_rows.h"

namespace alidade::internal {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

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

// The shortest decimal text of `number` times 10^exponent. Where number is an
// integer w of at most 15 digits times 1e-6, to the nearest double, that text
// is w * 1e-6 (no other decimal of so few digits has the same double), and w /
// 1e9, of thousandths, is rounded once, as ParseNumber's result is.
double Shifted(double number, int exponent) {
  constexpr double kMaxInteger = 1e15;
  const double integer = std::nearbyint(number * 1e6);
  if (exponent == -3 && std::abs(integer) < kMaxInteger &&
      integer / 1e6 == number) {
    return integer / 1e9;
  }
  return ParseNumber(ShortestNumber(number), exponent).value_or(kNan);
}

double InSi(double number, const Unit& unit) {
  if (unit.exponent == 0) return number * unit.factor;
  return Shifted(number, unit.exponent) * unit.factor;
}

// A number of a plain data set must be finite, or NaN where that is allowed.
bool IsPlain(double number, CellRule rule) {
  if (std::isnan(number)) return rule != CellRule::kRequired;
  return std::isfinite(number) && (rule != CellRule::kPositive || number > 0.0);
}

// The array, as its header says it is.
class Records {
 public:
  Records(const std::string& path, std::string_view bytes)
      : header_(ReadNpyHeader(path, bytes)),
        data_(bytes.data() + header_.data_offset) {}

  std::int64_t num_rows() const { return header_.num_rows; }
  std::size_t record_bytes() const { return header_.record_bytes(); }
  const char* first() const { return data_; }
  double Number(std::int64_t row, std::size_t column) const {
    return LoadDouble(data_ + static_cast<std::size_t>(row) * record_bytes() +
                      8 * column);
  }

  // The header of a CSV with the same columns.
  std::string HeaderLine() const {
    std::string line;
    for (const std::string& name : header_.names) {
      line += (line.empty() ? "" : ",") + name;
    }
    return line + "\n";
  }

  std::string AsCsv() const {
    std::string text = HeaderLine();
    for (std::int64_t row = 0; row < num_rows(); ++row) {
      for (std::size_t column = 0; column < header_.names.size(); ++column) {
        const double number = Number(row, column);
        if (column > 0) text += ',';
        // NaNs may have a sign, which is no matter here.
        text += std::isnan(number) ? "nan" : ShortestNumber(number);
      }
      text += '\n';
    }
    return text;
  }

 private:
  const NpyHeader header_;
  const char* const data_;
};

// The fast path: one pass over the records.
class PlainRecords {
 public:
  PlainRecords(const Records& records, const PlainLayout& layout,
               const ReadOptions& options)
      : records_(records),
        layout_(layout),
        numbers_(NumbersOf(layout)),
        num_threads_(options.num_threads),
        block_(std::max<std::int64_t>(
            1, options.chunk_bytes /
                   static_cast<std::int64_t>(records.record_bytes()))),
        rows_(layout, records.num_rows()),
        nothing_(static_cast<std::size_t>((records.num_rows() + block_ - 1) /
                                          block_)) {}

  // Nothing where a row is in doubt, or none is kept.
  std::optional<LoadedData> Read(const std::string& path, const Arm& arm) {
    ParallelFor(num_threads_, records_.num_rows(), block_,
                [&](std::int64_t begin, std::int64_t end) {
                  if (!is_suspect_ && !ReadBlock(begin, end)) {
                    is_suspect_ = true;
                  }
                });
    std::vector<Eigen::Index> nothing;
    for (const std::vector<Eigen::Index>& part : nothing_) {
      nothing.insert(nothing.end(), part.begin(), part.end());
    }
    if (is_suspect_ ||
        static_cast<std::int64_t>(nothing.size()) == records_.num_rows()) {
      return std::nullopt;
    }
    return rows_.Finish(path, arm, nothing);
  }

 private:
  // A column of numbers. Without a branch where it matters: all cells of nearly
  // all rows are above `lowest` and finite.
  struct Number {
    std::size_t column;
    std::size_t slot;
    Unit unit;
    CellRule rule;
    double lowest;
  };

  static std::vector<Number> NumbersOf(const PlainLayout& layout) {
    std::vector<Number> numbers;
    for (std::size_t c = 0; c < layout.columns.size(); ++c) {
      const PlainColumn& column = layout.columns[c];
      if (column.use != PlainColumn::Use::kNumber) continue;
      numbers.push_back(
          {c, static_cast<std::size_t>(column.slot), column.unit, column.rule,
           column.rule == CellRule::kPositive ? 0.0 : -kInfinity});
    }
    return numbers;
  }

  bool ReadBlock(std::int64_t begin, std::int64_t end) {
    std::vector<double> row = layout_.defaults;
    for (std::int64_t i = begin; i < end; ++i) {
      bool is_measured = true;
      for (const Number& number : numbers_) {
        const double value =
            InSi(records_.Number(i, number.column), number.unit);
        is_measured &= value > number.lowest && value < kInfinity;
        row[number.slot] = value;
      }
      if (!is_measured && !MayStay(i, row)) return false;
      const PlainRows::State state = rows_.Set(i, row.data());
      if (state == PlainRows::State::kSuspect) return false;
      if (state == PlainRows::State::kNothing) {
        nothing_[static_cast<std::size_t>(begin / block_)].push_back(i);
      }
    }
    return true;
  }

  // Of a row some of whose cells are NaN, or wrong.
  bool MayStay(std::int64_t i, const std::vector<double>& row) const {
    return std::all_of(
        numbers_.begin(), numbers_.end(), [&](const Number& number) {
          const double value = row[number.slot];
          const bool was_nan = std::isnan(records_.Number(i, number.column));
          return IsPlain(value, number.rule) && std::isnan(value) == was_nan;
        });
  }

  const Records& records_;
  const PlainLayout& layout_;
  const std::vector<Number> numbers_;
  const int num_threads_;
  const std::int64_t block_;
  PlainRows rows_;
  std::vector<std::vector<Eigen::Index>> nothing_;  // by block
  std::atomic<bool> is_suspect_{false};
};

// Data whose numbers stand in the array as they stand in memory: in SI, joints,
// axes and sigmas each side by side in their order, all finite. Nothing where
// they do not.
class RecordsInPlace {
 public:
  RecordsInPlace(std::shared_ptr<const MappedFile> file, const Records& records,
                 const PlainLayout& layout)
      : file_(std::move(file)), records_(records), layout_(layout) {}

  std::optional<LoadedData> Read(const Arm& arm, const ReadOptions& options) {
    const RowSlots& slots = layout_.slots;
    const int n = layout_.num_joints();
    const std::optional<SharedMatrix> joints = Columns(0, n);
    const std::optional<SharedMatrix> positions = Columns(slots.position, 3);
    const std::optional<SharedMatrix> stated =
        layout_.states_sigmas ? Columns(slots.position_sigma, 3)
                              : SharedMatrix();
    const bool is_as_it_stands =
        IsAligned() && layout_.kind() == MeasurementKind::kPosition &&
        !layout_.has_target && layout_.target == 0 && !layout_.has_set &&
        !HasMotorMap(arm) && joints && positions && stated;
    if (!is_as_it_stands) return std::nullopt;
    const SharedMatrix sigmas =
        layout_.states_sigmas ? *stated
                              : SharedMatrix::Repeated(layout_.DefaultSigmas(),
                                                       records_.num_rows());
    std::atomic<bool> is_suspect{false};
    ParallelFor(
        options.num_threads, records_.num_rows(), kRowsAtOnce,
        [&](std::int64_t begin, std::int64_t end) {
          const auto rows = [&](const SharedMatrix& all) {
            return all.map().middleCols(begin, end - begin).array();
          };
          if (!(rows(*joints).isFinite().all() &&
                rows(*positions).isFinite().all() &&
                rows(sigmas).isFinite().all() && (rows(sigmas) > 0.0).all())) {
            is_suspect = true;
          }
        });
    if (is_suspect) return std::nullopt;
    LoadedData loaded;
    loaded.data = MakePositions(*joints, *positions, sigmas);
    loaded.data.name = file_->path();
    loaded.data.files = {file_->path()};
    loaded.data.sources.Append({0, 1},
                               static_cast<std::size_t>(records_.num_rows()));
    return loaded;
  }

 private:
  static constexpr std::int64_t kRowsAtOnce = 1 << 14;

  // As this machine's doubles, where these are little endian too.
  bool IsAligned() const {
    constexpr double kNumber = 1.2345;
    return reinterpret_cast<std::uintptr_t>(records_.first()) %
                   alignof(double) ==
               0 &&
           LoadDouble(reinterpret_cast<const char*>(&kNumber)) == kNumber;
  }

  // The columns of `count` slots from `slot` on.
  std::optional<SharedMatrix> Columns(int slot, int count) const {
    const auto first = std::find_if(
        layout_.columns.begin(), layout_.columns.end(),
        [&](const PlainColumn& column) {
          return column.use == PlainColumn::Use::kNumber && column.slot == slot;
        });
    if (layout_.columns.end() - first < count) return std::nullopt;
    for (int k = 0; k < count; ++k) {
      const PlainColumn& column = first[k];
      if (column.use != PlainColumn::Use::kNumber || column.slot != slot + k ||
          column.unit.exponent != 0 || column.unit.factor != 1.0) {
        return std::nullopt;
      }
    }
    const auto* const numbers =
        reinterpret_cast<const double*>(records_.first()) +
        (first - layout_.columns.begin());
    return SharedMatrix(std::shared_ptr<const double>(file_, numbers), count,
                        records_.num_rows(),
                        static_cast<Eigen::Index>(layout_.columns.size()));
  }

  const std::shared_ptr<const MappedFile> file_;
  const Records& records_;
  const PlainLayout& layout_;
};

void RefuseTexts(const RowReader& rows, const DataFile& file) {
  if (!file.format.where.empty()) {
    rows.Fail(
        "`where` chooses rows by text, which NumPy arrays of numbers do "
        "not have: expected a CSV");
  }
  const DatasetColumns columns = MakeDatasetColumns(file.arm, file.format);
  for (const RowReader::Column& column : rows.columns()) {
    if (column.spec < 0 ||
        columns.specs[column.spec].type != ColumnType::kText) {
      continue;
    }
    rows.Fail(
        "the column holds text, but the array numbers: expected a CSV, "
        "or `target`, `point` or `plane` of all rows in the job's `data`",
        column.name);
  }
}

LoadedData Read(const DataFile& file,
                const std::shared_ptr<const MappedFile>& mapped,
                References* references, const ReadOptions& options) {
  const Records records(file.path, mapped->text());
  RequireFewRows(file.path, records.num_rows());
  const DatasetReader header(MappedFile(file.path, records.HeaderLine()),
                             file.arm, file.format, references);
  RefuseTexts(header.rows(), file);
  const std::optional<PlainLayout> layout = header.Layout();
  const auto bytes = static_cast<std::int64_t>(mapped->text().size());
  if (layout && !options.is_careful && bytes >= options.fewest_bytes_in_place) {
    std::optional<LoadedData> loaded =
        RecordsInPlace(mapped, records, *layout).Read(file.arm, options);
    if (loaded) return *std::move(loaded);
  }
  if (layout && !options.is_careful) {
    std::optional<LoadedData> loaded =
        PlainRecords(records, *layout, options).Read(file.path, file.arm);
    if (loaded) return *std::move(loaded);
  }
  DatasetReader reader(MappedFile(file.path, records.AsCsv()), file.arm,
                       file.format, references);
  ReadOptions careful;
  careful.is_careful = true;
  LoadedData loaded = reader.Read(careful);
  loaded.data.sources.MoveLines(-1);
  for (RejectedRow& row : loaded.rejected) --row.line;
  return loaded;
}

}  // namespace

std::string NpyAsCsv(const std::string& path) {
  const MappedFile mapped(path);
  return Records(path, mapped.text()).AsCsv();
}

InputError InArray(const InputError& error) {
  SourceLocation location = error.location();
  location.line = std::max(0, location.line - 1);
  location.column = 0;
  return InputError(location, error.message());
}

LoadedData LoadNpy(const DataFile& file, References* references,
                   const ReadOptions& options) {
  const auto mapped = std::make_shared<const MappedFile>(file.path);
  try {
    return Read(file, mapped, references, options);
  } catch (const InputError& error) {
    throw InArray(error);
  }
}

}  // namespace alidade::internal
