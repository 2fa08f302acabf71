#include "src/job/join_tables.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string_view>

#include "alidade/error.h"
#include "src/common/names.h"
#include "src/common/text.h"
#include "src/dataio/csv_columns.h"
#include "src/dataio/csv_lines.h"
#include "src/job/import_text.h"

namespace alidade::internal {
namespace {

// What of a point's name counts: all of it, or "P001" of "A::Cell7::P001".
enum class NamePart { kAll, kLast };

std::string PartOf(const std::string& name, NamePart part) {
  const std::size_t colons = name.rfind("::");
  return part == NamePart::kAll || colons == std::string::npos
             ? name
             : name.substr(colons + 2);
}

StatedDialect DialectOf(const TableToJoin& table) {
  StatedDialect dialect;
  dialect.excluded_lines = table.excluded_lines;
  return dialect;
}

class NamedRows {
 public:
  struct Row {
    ImportText::Cells cells;
    int line = 0;
  };
  using ByPoint = std::map<std::string, const Row*>;

  explicit NamedRows(const TableToJoin& table)
      : path_(table.path), text_(path_, DialectOf(table), table.exclude) {
    RefuseNumbersAsNames();
    text_.RefuseBadRows(std::filesystem::path(path_).filename().string() + ":");
    text_.VisitRows([&](const ImportText::Cells& cells, int line) {
      rows_.push_back({cells, line});
      rows_.back().cells.resize(columns().size());
    });
  }

  const std::string& path() const { return path_; }
  const std::vector<std::string>& columns() const { return text_.names(); }
  const std::vector<Row>& rows() const { return rows_; }
  const ImportText& text() const { return text_; }

  std::optional<std::size_t> Find(const std::string& column) const {
    const auto found = std::find(columns().begin(), columns().end(), column);
    if (found == columns().end()) return std::nullopt;
    return static_cast<std::size_t>(found - columns().begin());
  }

  // A name is a text, whatever marks the numbers of the file have.
  static std::string PointOf(const Row& row, std::size_t column,
                             NamePart part) {
    return PartOf(TextOf(row.cells[column]), part);
  }

  std::set<std::string> PointsOf(std::size_t column, NamePart part) const {
    std::set<std::string> points;
    for (const Row& row : rows_) points.insert(PointOf(row, column, part));
    points.erase("");
    return points;
  }

  // @throws InputError where one is there twice.
  ByPoint RowsByPoint(std::size_t column, NamePart part) const {
    ByPoint points;
    for (const Row& row : rows_) {
      const std::string name = PointOf(row, column, part);
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
  // Which column is which then shows in no name, and beside the other file's
  // columns their order says nothing either.
  void RefuseNumbersAsNames() const {
    if (WithoutUnit(columns().front()) != "1" ||
        WithoutUnit(columns().back()) != std::to_string(columns().size())) {
      return;
    }
    throw InputError({path_, 1, 0, ""},
                     "no line names the columns, expected one above the rows "
                     "(\"Name, X, Y, Z\"): two files are put together by the "
                     "names of their columns");
  }

  const std::string path_;
  const ImportText text_;
  std::vector<Row> rows_;
};

std::size_t NumCommon(const std::set<std::string>& a,
                      const std::set<std::string>& b) {
  return static_cast<std::size_t>(std::count_if(
      a.begin(), a.end(),
      [&](const std::string& name) { return b.count(name) > 0; }));
}

// Where the points are named in both files.
struct Match {
  std::size_t first = 0;
  std::size_t second = 0;
  NamePart part = NamePart::kLast;
};

class Matcher {
 public:
  Matcher(const NamedRows& a, const NamedRows& b, const std::string& match)
      : a_(a), b_(b), match_(match) {
    FindStated();
  }

  Match Find() const {
    for (const NamePart part : {NamePart::kAll, NamePart::kLast}) {
      std::optional<std::size_t> first = first_;
      std::optional<std::size_t> second = second_;
      if (!first) first = Guess(a_, b_.PointsOf(*second, part), part);
      if (!second) second = Guess(b_, a_.PointsOf(*first, part), part);
      if (!first || !second) continue;
      const auto points = a_.PointsOf(*first, part);
      if (NumCommon(points, b_.PointsOf(*second, part)) == 0) continue;
      return {*first, *second, part};
    }
    return {first_.value_or(0), second_.value_or(0), NamePart::kLast};
  }

 private:
  void FindStated() {
    first_ = a_.Find(match_);
    second_ = b_.Find(match_);
    if (first_ || second_) return;
    for (std::size_t comma = match_.find(','); comma != std::string::npos;
         comma = match_.find(',', comma + 1)) {
      const std::size_t behind = match_.find_first_not_of(' ', comma + 1);
      if (behind == std::string::npos) break;
      first_ = a_.Find(match_.substr(0, comma));
      second_ = b_.Find(match_.substr(behind));
      if (first_ && second_) return;
      if (first_ || second_) {
        const NamedRows& without = first_ ? b_ : a_;
        throw InputError(
            {without.path(), 0, 0, ""},
            "--match: " + UnknownName("column",
                                      first_ ? match_.substr(behind)
                                             : match_.substr(0, comma),
                                      without.columns()));
      }
    }
    std::vector<std::string> names = a_.columns();
    names.insert(names.end(), b_.columns().begin(), b_.columns().end());
    throw InputError({}, "--match: " + UnknownName("column", match_, names));
  }

  // The column with by far the most of the points; nothing where none has any.
  std::optional<std::size_t> Guess(const NamedRows& rows,
                                   const std::set<std::string>& points,
                                   NamePart part) const {
    std::optional<std::size_t> best;
    std::optional<std::size_t> next;
    std::size_t most = 0;
    std::size_t second = 0;
    for (std::size_t k = 0; k < rows.columns().size(); ++k) {
      const std::size_t count = NumCommon(rows.PointsOf(k, part), points);
      if (count > most) {
        next = std::exchange(best, k);
        second = std::exchange(most, count);
      } else if (count > second) {
        next = k;
        second = count;
      }
    }
    // A counter has many of the names that are numbers.
    if (next && 2 * second > most) {
      const std::size_t left = std::min(*best, *next);
      const std::size_t right = std::max(*best, *next);
      throw InputError({rows.path(), 0, 0, ""},
                       "columns " + Quote(rows.columns()[left]) + " and " +
                           Quote(rows.columns()[right]) +
                           " both hold names of points of the other file: "
                           "expected " +
                           FlagOf(rows, left) + " or " + FlagOf(rows, right));
    }
    return best;
  }

  std::string FlagOf(const NamedRows& rows, std::size_t column) const {
    const std::string& name = rows.columns()[column];
    return "--match=\"" +
           (&rows == &a_ ? name + "," + match_ : match_ + "," + name) + "\"";
  }

  const NamedRows& a_;
  const NamedRows& b_;
  const std::string& match_;
  std::optional<std::size_t> first_;
  std::optional<std::size_t> second_;
};

std::string ExampleOf(const NamedRows::ByPoint& rows) {
  return rows.empty() ? "no rows" : rows.begin()->first + " ...";
}

// In quotes where a line that begins so would be passed over as a comment.
void AppendFirstCell(const std::string& text, std::string* row) {
  if (CommentOf(text).data() == nullptr) return AppendTextCell(text, row);
  std::string cell = TextCell(text);
  *row += cell.front() == '"' ? cell : '"' + cell + '"';
}

void NoteMissing(const NamedRows& rows, std::size_t column, NamePart part,
                 const NamedRows::ByPoint& other,
                 std::vector<std::string>* notes) {
  std::vector<std::string> names;
  std::vector<int> without;
  for (const NamedRows::Row& row : rows.rows()) {
    const std::string name = NamedRows::PointOf(row, column, part);
    if (name.empty()) without.push_back(row.line);
    if (!name.empty() && other.count(name) == 0) names.push_back(name);
  }
  if (!names.empty()) {
    notes->push_back("in " + rows.path() +
                     " alone, and left out: " + JoinNames(names));
  }
  if (!without.empty()) {
    notes->push_back("in " + rows.path() + " without a name in " +
                     Quote(rows.columns()[column]) + ", and left out: line " +
                     LinesText(without));
  }
}

void RefuseUnknownConditions(const TableToJoin& table, const NamedRows& a,
                             const NamedRows& b) {
  for (const RowCondition& condition : table.exclude) {
    if (a.Find(condition.column) || b.Find(condition.column)) continue;
    std::vector<std::string> names = a.columns();
    names.insert(names.end(), b.columns().begin(), b.columns().end());
    throw InputError(
        {}, "--exclude: " + UnknownName("column", condition.column, names));
  }
}

void AppendColumns(const NamedRows& rows, std::size_t without,
                   std::string* text) {
  for (std::size_t k = 0; k < rows.columns().size(); ++k) {
    if (k == without) continue;
    *text += ',';
    AppendTextCell(rows.columns()[k], text);
  }
}

void AppendCells(const NamedRows& rows, const NamedRows::Row& row,
                 std::size_t without, std::string* text) {
  for (std::size_t k = 0; k < row.cells.size(); ++k) {
    if (k == without) continue;
    *text += ',';
    AppendTextCell(rows.text().PlainCell(row.cells[k]), text);
  }
}

}  // namespace

JoinedTables JoinTables(const TableToJoin& first, const TableToJoin& second,
                        const std::string& match) {
  const NamedRows a(first);
  const NamedRows b(second);
  RefuseUnknownConditions(first, a, b);
  const auto [in_a, in_b, part] = Matcher(a, b, match).Find();
  const NamedRows::ByPoint rows_a = a.RowsByPoint(in_a, part);
  const NamedRows::ByPoint rows_b = b.RowsByPoint(in_b, part);
  JoinedTables joined;
  AppendFirstCell(a.columns()[in_a], &joined.text);
  AppendColumns(a, in_a, &joined.text);
  AppendColumns(b, in_b, &joined.text);
  joined.text += '\n';
  for (const NamedRows::Row& row : a.rows()) {
    const std::string name = NamedRows::PointOf(row, in_a, part);
    const auto found = rows_b.find(name);
    if (found == rows_b.end()) continue;
    AppendFirstCell(name, &joined.text);
    AppendCells(a, row, in_a, &joined.text);
    AppendCells(b, *found->second, in_b, &joined.text);
    joined.text += '\n';
    ++joined.num_rows;
  }
  if (joined.num_rows == 0) {
    throw InputError({b.path(), 0, 0, b.columns()[in_b]},
                     "none of its points (" + ExampleOf(rows_b) + ") is in " +
                         a.path() + " (" + ExampleOf(rows_a) +
                         "): expected the same names in both, or what "
                         "follows the last \"::\"");
  }
  for (const NamedRows* const rows : {&a, &b}) {
    for (const std::string& note : rows->text().Notes()) {
      joined.notes.push_back(rows->path() + ": " + note);
    }
  }
  joined.notes.push_back(
      std::to_string(joined.num_rows) + " points are in both files, by " +
      Quote(a.columns()[in_a]) + " and " + Quote(b.columns()[in_b]));
  NoteMissing(a, in_a, part, rows_b, &joined.notes);
  NoteMissing(b, in_b, part, rows_a, &joined.notes);
  return joined;
}

}  // namespace alidade::internal
