#include "src/dataio/data_table.h"

#include <atomic>
#include <exception>
#include <limits>
#include <mutex>
#include <string>

#include "src/common/names.h"
#include "src/common/numbers.h"
#include "src/common/parallel.h"

namespace alidade::internal {

TableRow::TableRow(const TableHeader& header)
    : header_(header),
      numbers_(header.specs().size(),
               std::numeric_limits<double>::quiet_NaN()) {
  for (std::size_t i = 0; i < header.specs().size(); ++i) {
    const auto index = static_cast<int>(i);
    const ColumnSpec& spec = header.specs()[i];
    if (!header.Has(index) || spec.type == ColumnType::kText) continue;
    const int column = header.ColumnOf(index);
    const Unit* unit = header.columns()[column].unit;
    columns_.push_back(
        {column, index, unit != nullptr ? *unit : *FindUnit("rad"), spec.rule});
  }
}

void TableRow::Fail(int spec, const std::string& message) const {
  throw InputError(Location(spec), message);
}

void TableRow::FailNumber(const NumberColumn& column) const {
  const std::string text(Text(column.spec));
  std::string message =
      DescribeBadNumber(text, "state its unit in the column's name");
  const bool is_word =
      !text.empty() && text.find_first_of("0123456789") == std::string::npos;
  if (is_word && column.rule != CellRule::kRequired) {
    message += ". Where that says that nothing was measured: `missing: [" +
               OneLine(text) + "]` in the job's `data`; " +
               HowToExclude(line());
  } else if (column.rule == CellRule::kRequired && (is_word || text.empty())) {
    message +=
        ". Where the line holds no measurement, as a mean below the "
        "table: " +
        HowToExclude(line());
  }
  Fail(column.spec, message);
}

void TableRow::FailPositive(int spec) const {
  const bool is_sigma = header_.specs()[spec].base.rfind("std_", 0) == 0;
  Fail(spec, std::string("expected a ") +
                 (is_sigma ? "standard deviation" : "number") +
                 " above zero, found " + std::string(Text(spec)));
}

void DataTable::VisitRows(int num_threads, const Visit& visit) const {
  std::atomic<std::int64_t> first_failed{num_chunks()};
  std::exception_ptr failure;
  std::mutex failure_mutex;
  // Chunks are taken in their order, so that all before the first that fails
  // have been visited.
  ParallelFor(num_threads, num_chunks(), 1,
              [&](std::int64_t chunk, std::int64_t) {
                if (chunk > first_failed) return;
                try {
                  VisitChunk(chunk, visit);
                } catch (const InputError&) {
                  const std::lock_guard<std::mutex> lock(failure_mutex);
                  if (chunk > first_failed) return;
                  first_failed = chunk;
                  failure = std::current_exception();
                }
              });
  if (failure) std::rethrow_exception(failure);
}

std::optional<SharedMatrix> DataTable::InPlace(int, int) const {
  return std::nullopt;
}

void DataTable::FailAtEnd(const std::string& message) const {
  throw InputError({header().path(), num_lines(), 0, ""}, message);
}

}  // namespace alidade::internal
