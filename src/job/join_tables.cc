#include "src/job/join_tables.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "alidade/error.h"
#include "src/common/names.h"
#include "src/common/text.h"
#include "src/job/import_text.h"

namespace alidade::internal {
namespace {

// Of a point, "P001" of "A::Cell7::P001".
std::string LastPart(const std::string& name) {
  const std::size_t colons = name.rfind("::");
  return colons == std::string::npos ? name : name.substr(colons + 2);
}

class NamedRows {
 public:
  struct Row {
    std::vector<std::string> cells;
    int line = 0;
  };

  explicit NamedRows(const std::string& path)
      : path_(path), text_(path, StatedDialect()) {
    text_.VisitRows([&](const ImportText::Cells& cells, int line) {
      Row row;
      row.line = line;
      for (const std::string_view cell : cells) {
        row.cells.push_back(text_.PlainCell(cell));
      }
      row.cells.resize(columns().size());
      rows_.push_back(std::move(row));
    });
  }

  const std::string& path() const { return path_; }
  const std::vector<std::string>& columns() const { return text_.names(); }
  const std::vector<Row>& rows() const { return rows_; }

  std::optional<std::size_t> Find(const std::string& column) const {
    const auto found = std::find(columns().begin(), columns().end(), column);
    if (found == columns().end()) return std::nullopt;
    return static_cast<std::size_t>(found - columns().begin());
  }

  // Where most of the points are named.
  std::size_t FindPoints(const std::set<std::string>& points) const {
    std::size_t best = 0;
    std::ptrdiff_t most = -1;
    for (std::size_t k = 0; k < columns().size(); ++k) {
      const auto count =
          std::count_if(rows_.begin(), rows_.end(), [&](const Row& row) {
            return points.count(LastPart(row.cells[k])) > 0;
          });
      if (count > most) best = k;
      most = std::max(most, count);
    }
    return best;
  }

  // Rows by their points. @throws InputError where one is there twice.
  std::map<std::string, const Row*> ByPoint(std::size_t column) const {
    std::map<std::string, const Row*> points;
    for (const Row& row : rows_) {
      const std::string name = LastPart(row.cells[column]);
      if (name.empty()) continue;
      const auto [at, is_new] = points.emplace(name, &row);
      if (is_new) continue;
      throw InputError({path_, row.line, 0, columns()[column]},
                       "point " + Quote(name) + " is in line " +
                           std::to_string(at->second->line) +
                           " already, expected each once: rows are put "
                           "together by it");
    }
    return points;
  }

 private:
  const std::string path_;
  const ImportText text_;
  std::vector<Row> rows_;
};

std::set<std::string> PointsOf(const NamedRows& rows, std::size_t column) {
  std::set<std::string> points;
  for (const NamedRows::Row& row : rows.rows()) {
    points.insert(LastPart(row.cells[column]));
  }
  return points;
}

using RowsByPoint = std::map<std::string, const NamedRows::Row*>;

std::string ExampleOf(const RowsByPoint& rows) {
  return rows.empty() ? "no rows" : rows.begin()->first + " ...";
}

void AppendCells(const std::vector<std::string>& cells, std::size_t without,
                 std::string* text) {
  for (std::size_t k = 0; k < cells.size(); ++k) {
    if (k == without) continue;
    *text += ',';
    AppendTextCell(cells[k], text);
  }
}

void NoteMissing(const NamedRows& rows, std::size_t column,
                 const RowsByPoint& other, std::vector<std::string>* notes) {
  std::vector<std::string> names;
  for (const NamedRows::Row& row : rows.rows()) {
    const std::string name = LastPart(row.cells[column]);
    if (!name.empty() && other.count(name) == 0) names.push_back(name);
  }
  if (names.empty()) return;
  notes->push_back("in " + rows.path() +
                   " alone, and left out: " + JoinNames(names));
}

}  // namespace

JoinedTables JoinTables(const std::string& first, const std::string& second,
                        const std::string& column) {
  const NamedRows a(first);
  const NamedRows b(second);
  std::optional<std::size_t> in_a = a.Find(column);
  std::optional<std::size_t> in_b = b.Find(column);
  if (!in_a && !in_b) {
    std::vector<std::string> names = a.columns();
    names.insert(names.end(), b.columns().begin(), b.columns().end());
    throw InputError({}, "--match: " + UnknownName("column", column, names));
  }
  if (!in_a) in_a = a.FindPoints(PointsOf(b, *in_b));
  if (!in_b) in_b = b.FindPoints(PointsOf(a, *in_a));
  const auto rows_a = a.ByPoint(*in_a);
  const auto rows_b = b.ByPoint(*in_b);
  JoinedTables joined;
  joined.text = column;
  AppendCells(a.columns(), *in_a, &joined.text);
  AppendCells(b.columns(), *in_b, &joined.text);
  joined.text += '\n';
  for (const NamedRows::Row& row : a.rows()) {
    const std::string name = LastPart(row.cells[*in_a]);
    const auto found = rows_b.find(name);
    if (found == rows_b.end()) continue;
    AppendTextCell(name, &joined.text);
    AppendCells(row.cells, *in_a, &joined.text);
    AppendCells(found->second->cells, *in_b, &joined.text);
    joined.text += '\n';
    ++joined.num_rows;
  }
  if (joined.num_rows == 0) {
    throw InputError({second, 0, 0, b.columns()[*in_b]},
                     "none of its points (" + ExampleOf(rows_b) + ") is in " +
                         first + " (" + ExampleOf(rows_a) +
                         "): expected the same names in both, or what "
                         "follows the last \"::\"");
  }
  joined.notes.push_back(
      std::to_string(joined.num_rows) + " points are in both files, by " +
      Quote(a.columns()[*in_a]) + " and " + Quote(b.columns()[*in_b]));
  NoteMissing(a, *in_a, rows_b, &joined.notes);
  NoteMissing(b, *in_b, rows_a, &joined.notes);
  return joined;
}

}  // namespace alidade::internal
