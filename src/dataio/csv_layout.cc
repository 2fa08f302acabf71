#include "src/dataio/csv_layout.h"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "alidade/error.h"
#include "src/common/names.h"
#include "src/common/numbers.h"
#include "src/dataio/csv_columns.h"
#include "src/dataio/csv_lines.h"
#include "src/dataio/number_evidence.h"

namespace alidade::internal {
namespace {

using Cells = std::vector<std::string_view>;

// What is looked at to find the separator and the header, and to find how
// numbers are written where the text is not Alidade's own form.
constexpr std::size_t kFirstBytes = 1 << 16;
constexpr std::size_t kMostBytes = 1 << 22;

struct Line {
  std::string_view text;
  int number = 0;
  std::size_t end = 0;  // where the next one begins
};

// How a separator cuts the lines.
struct Candidate {
  char separator = ',';
  std::size_t num_cells = 0;  // of rows
  std::size_t width = 0;      // without cells at the end that are always empty
  std::size_t first_row = 0;  // among the lines
  double score = 0.0;         // numbers less texts, in rows
};

std::size_t WidthOf(const Cells& cells) {
  std::size_t width = cells.size();
  while (width > 0 && cells[width - 1].empty()) --width;
  return width;
}

bool IsNumber(std::string_view cell, char separator) {
  const NumberMarks marks = MarksOf(cell);
  // Nobody groups digits by blanks and separates cells by commas.
  if (separator == ',' && marks.thousands == ' ') return false;
  return marks.shape != NumberShape::kNone;
}

struct CellCounts {
  std::size_t numbers = 0;
  std::size_t texts = 0;
};

CellCounts CountCells(const Cells& cells, char separator) {
  CellCounts counts;
  for (const std::string_view cell : cells) {
    if (IsNumber(cell, separator)) {
      ++counts.numbers;
    } else if (!IsNotMeasured(cell)) {
      ++counts.texts;
    }
  }
  return counts;
}

bool IsRow(const CellCounts& counts) {
  return counts.numbers >= 2 && counts.texts <= counts.numbers;
}

// Whether some name is that of a joint in Alidade's own files.
template <typename Names>
bool HasJoint(const Names& names) {
  return std::any_of(names.begin(), names.end(), [](std::string_view name) {
    return JointNumber(name).has_value();
  });
}

// A line "sep=;", which Excel reads.
std::optional<char> SeparatorLine(std::string_view line) {
  std::string text(line);
  text.erase(std::remove(text.begin(), text.end(), '"'), text.end());
  if (text.size() != 5) return std::nullopt;
  for (char& c : text) c = static_cast<char>(c >= 'A' && c <= 'Z' ? c | 32 : c);
  if (text.substr(0, 4) != "sep=") return std::nullopt;
  return text[4];
}

class LayoutFinder {
 public:
  LayoutFinder(const std::string& path, std::string_view text,
               const StatedDialect& stated)
      : path_(path), text_(text), stated_(stated) {
    layout_.dialect.missing = stated.missing;
  }

  CsvLayout Find() {
    TakeLines();
    ChooseSeparator();
    FindHeader();
    FindNumbers();
    Describe();
    return layout_;
  }

 private:
  char separator() const { return layout_.dialect.separator; }

  // Lines that hold something, excluded ones left out.
  void TakeLines() {
    std::string_view rest = text_;
    int number = 0;
    while (!rest.empty() && text_.size() - rest.size() < kFirstBytes) {
      const std::string_view line = TakeLine(&rest);
      ++number;
      const std::size_t end = text_.size() - rest.size();
      if (number == 1 && SeparatorLine(line)) {
        said_separator_ = SeparatorLine(line);
        layout_.rows = end;
        layout_.lines_before_rows = number;
        continue;
      }
      if (stated_.IsExcluded(number)) continue;
      lines_.push_back({line, number, end});
    }
  }

  std::optional<Candidate> Try(char separator) const {
    Candidate found;
    found.separator = separator;
    std::map<std::size_t, std::pair<std::size_t, std::size_t>> sizes;
    std::vector<CellCounts> counts(lines_.size());
    std::vector<std::size_t> widths(lines_.size());
    std::vector<std::size_t> num_cells(lines_.size());
    Cells cells;
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      if (IsPassedOver(lines_[i].text, separator)) continue;
      if (SplitCells(lines_[i].text, separator, &cells) != nullptr) continue;
      counts[i] = CountCells(cells, separator);
      if (!IsRow(counts[i])) continue;
      num_cells[i] = cells.size();
      widths[i] = WidthOf(cells);
      auto& [first, count] = sizes[cells.size()];
      if (count++ == 0) first = i;
    }
    if (sizes.empty()) return std::nullopt;
    const auto most = std::max_element(
        sizes.begin(), sizes.end(), [](const auto& a, const auto& b) {
          return a.second.second < b.second.second;
        });
    found.num_cells = most->first;
    found.first_row = most->second.first;
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      if (num_cells[i] != found.num_cells) continue;
      found.width = std::max(found.width, widths[i]);
      found.score += static_cast<double>(counts[i].numbers) -
                     static_cast<double>(counts[i].texts);
    }
    return found;
  }

  void ChooseSeparator() {
    const std::optional<char> said =
        stated_.separator ? stated_.separator : said_separator_;
    if (said) {
      layout_.dialect.separator = *said;
      best_ = Try(*said);
      return;
    }
    for (const char separator : {';', '\t', '|', ',', ' '}) {
      if (separator != ',' && HasOwnNames()) continue;
      const std::optional<Candidate> candidate = Try(separator);
      if (!candidate || (best_ && candidate->score <= best_->score)) continue;
      best_ = candidate;
    }
    if (best_) {
      layout_.dialect.separator = best_->separator;
      return;
    }
    // Without rows of numbers the header has the separator.
    const Line* const first = FirstLine(',');
    if (first == nullptr || first->text.find(',') != std::string_view::npos) {
      return;
    }
    for (const char separator : {';', '\t', '|'}) {
      if (first->text.find(separator) == std::string_view::npos) continue;
      layout_.dialect.separator = separator;
    }
  }

  // Whether the first line names joints between commas as our own files do.
  bool HasOwnNames() const {
    const Line* const first = FirstLine(',');
    Cells cells;
    return first != nullptr &&
           first->text.find_first_of(";\t|") == std::string_view::npos &&
           SplitCells(first->text, ',', &cells) == nullptr &&
           cells.size() > 1 && HasJoint(cells);
  }

  const Line* FirstLine(char separator) const {
    for (const Line& line : lines_) {
      if (!IsPassedOver(line.text, separator)) return &line;
    }
    return nullptr;
  }

  Cells Split(std::string_view text) const {
    Cells cells;
    if (SplitCells(text, separator(), &cells) != nullptr) cells.clear();
    return cells;
  }

  // Whether as many columns are named as rows have.
  bool FitsRows(const Cells& cells) const {
    const std::size_t width = WidthOf(cells);
    return cells.size() == best_->num_cells ||
           (width >= best_->width && width <= best_->num_cells && width > 0);
  }

  // A row in which nothing was measured has no numbers either, and a name at
  // most.
  bool IsHeader(const Cells& cells) const {
    if (cells.empty() || !FitsRows(cells)) return false;
    const CellCounts counts = CountCells(cells, separator());
    return counts.numbers == 0 &&
           (2 * counts.texts >= best_->width || AreUnits(cells));
  }

  // The last line before `end` that may be a header and satisfies
  // `is_wanted`.
  template <typename Test>
  std::optional<std::size_t> LastHeader(std::size_t end,
                                        const Test& is_wanted) const {
    for (std::size_t i = end; i-- > 0;) {
      if (IsPassedOver(lines_[i].text, separator())) continue;
      const Cells cells = Split(lines_[i].text);
      if (IsHeader(cells) && is_wanted(cells)) return i;
    }
    return std::nullopt;
  }

  void FindHeader() {
    if (stated_.header) return TakeStatedHeader();
    if (!best_) {
      const Line* const first = FirstLine(separator());
      if (first != nullptr) TakeHeader(first - lines_.data(), std::nullopt);
      return;
    }
    const auto any = [](const Cells& /*cells*/) { return true; };
    const auto no_units = [](const Cells& cells) { return !AreUnits(cells); };
    std::optional<std::size_t> header = LastHeader(best_->first_row, any);
    std::optional<std::size_t> units;
    if (header && AreUnits(Split(lines_[*header].text))) {
      units = std::exchange(header, LastHeader(*header, no_units));
    }
    if (header) return TakeHeader(*header, units);
    if (units) return TakeCommentOrNumbers(units);
    // A header of another size: rows are counted against it.
    for (std::size_t i = 0; i < best_->first_row; ++i) {
      const Cells cells = Split(lines_[i].text);
      if (IsPassedOver(lines_[i].text, separator())) continue;
      if (SeemsHeader(cells)) return TakeHeader(i, std::nullopt);
    }
    TakeCommentOrNumbers(std::nullopt);
  }

  // Names as in Alidade's own files, or half as many as rows have cells.
  bool SeemsHeader(const Cells& cells) const {
    const std::size_t width = WidthOf(cells);
    return HasJoint(cells) || (CountCells(cells, separator()).numbers == 0 &&
                               width > 2 && 2 * width >= best_->width);
  }

  void TakeStatedHeader() {
    if (*stated_.header == 0) return TakeNumbers(std::nullopt);
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      if (lines_[i].number != *stated_.header) continue;
      std::optional<std::size_t> units;
      if (i + 1 < lines_.size() && AreUnits(Split(lines_[i + 1].text))) {
        units = i + 1;
      }
      return TakeHeader(i, units);
    }
    throw InputError({path_, *stated_.header, 0, ""},
                     "`header` names this line, which is not among the first "
                     "lines of the file");
  }

  void TakeHeader(std::size_t header, std::optional<std::size_t> units) {
    const Line& line = lines_[header];
    layout_.header_line = line.number;
    std::string_view text = line.text;
    if (stated_.header && CommentOf(text).data() != nullptr) {
      text = CommentOf(text);
    }
    const Cells cells = Split(text);
    if (cells.empty()) {
      // Says what is wrong with it.
      Cells unread;
      CsvLine{path_, text, line.number, separator()}.Split(&unread);
    }
    SetNames(cells);
    AddNamesAbove(header);
    if (units) AddUnits(*units);
    BeginRows(lines_[units.value_or(header)]);
  }

  void SetNames(const Cells& cells) {
    const std::size_t width = WidthOf(cells);
    const std::size_t needed = best_ ? best_->width : width;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (i >= std::max(width, needed)) break;
      layout_.names.push_back(TextOf(cells[i]));
    }
    if (layout_.names.size() < cells.size()) {
      layout_.notes.emplace_back(
          "the separators at the ends of lines say "
          "nothing");
    }
  }

  bool HasRepeatedNames() const {
    std::vector<std::string> names;
    for (const std::string& name : layout_.names) {
      if (!name.empty()) names.push_back(name);
    }
    std::sort(names.begin(), names.end());
    return std::adjacent_find(names.begin(), names.end()) != names.end();
  }

  // "Nominal X" and "Measured X", where a line above has the first words; it
  // may name the first of several columns alone.
  void AddNamesAbove(std::size_t header) {
    if (!best_ || !HasRepeatedNames()) return;
    for (std::size_t i = header; i-- > 0;) {
      if (IsPassedOver(lines_[i].text, separator())) continue;
      const Cells above = Split(lines_[i].text);
      if (!IsHeader(above) && WidthOf(above) < 2) return;
      if (above.size() > layout_.names.size() + 1) return;
      std::string group;
      for (std::size_t k = 0; k < layout_.names.size(); ++k) {
        if (k < above.size() && !above[k].empty()) group = TextOf(above[k]);
        if (!group.empty()) layout_.names[k].insert(0, group + " ");
      }
      layout_.notes.push_back(
          "names are those of lines " + std::to_string(lines_[i].number) +
          " and " + std::to_string(lines_[header].number) + " together");
      return;
    }
  }

  void AddUnits(std::size_t line) {
    const Cells units = Split(lines_[line].text);
    for (std::size_t i = 0; i < std::min(units.size(), layout_.names.size());
         ++i) {
      if (FindHeaderUnit(units[i]) == nullptr) continue;
      if (StatesUnit(layout_.names[i])) continue;
      std::string unit = TextOf(units[i]);
      if (unit.front() != '[' && unit.front() != '(') unit = "[" + unit + "]";
      layout_.names[i] += " " + unit;
    }
    layout_.notes.push_back("line " + std::to_string(lines_[line].number) +
                            " states units");
  }

  void BeginRows(const Line& line) {
    layout_.rows = line.end;
    layout_.lines_before_rows = line.number;
  }

  // No line before the rows names their columns, but a comment may.
  void TakeCommentOrNumbers(std::optional<std::size_t> units) {
    for (std::size_t i = units.value_or(best_->first_row); i-- > 0;) {
      const std::string_view comment = CommentOf(lines_[i].text);
      if (comment.data() == nullptr) continue;
      // A column may be called "#".
      const bool is_column = separator() != ' ' && !comment.empty() &&
                             comment.front() == separator();
      for (const std::string_view text : {comment, lines_[i].text}) {
        if (is_column && text.data() == comment.data()) continue;
        Cells cells = Split(text);
        // Names may have commas between them where numbers have blanks.
        Cells by_commas;
        SplitCells(text, ',', &by_commas);
        if (by_commas.size() == best_->num_cells) cells = by_commas;
        if (!IsHeader(cells) || cells.size() != best_->num_cells) continue;
        layout_.header_line = lines_[i].number;
        SetNames(cells);
        if (units) AddUnits(*units);
        BeginRows(lines_[units.value_or(i)]);
        layout_.notes.emplace_back("the header stands in a comment");
        return;
      }
    }
    TakeNumbers(units);
  }

  void TakeNumbers(std::optional<std::size_t> units) {
    if (!best_) return;
    const std::size_t first = best_->first_row;
    if (first > 0) BeginRows(lines_[first - 1]);
    for (std::size_t i = 1; i <= best_->width; ++i) {
      layout_.names.push_back(std::to_string(i));
    }
    if (units) AddUnits(*units);
    RefuseSplitDecimals();
    layout_.notes.emplace_back(
        "there is no header: columns go by their numbers");
  }

  // "1,5,2,5": four integers, or two numbers with decimal commas.
  void RefuseSplitDecimals() const {
    if (separator() != ',' || stated_.separator || said_separator_ ||
        stated_.decimal || best_->num_cells % 2 == 1) {
      return;
    }
    Cells cells;
    for (const Line& line : lines_) {
      for (const std::string_view cell : Split(line.text)) {
        if (MarksOf(cell).shape == NumberShape::kDecimal) return;
        if (MarksOf(cell).shape == NumberShape::kAmbiguous) return;
      }
    }
    throw InputError(
        {path_, lines_[best_->first_row].number, 0, ""},
        "commas stand between integers, or are decimal ones: expected "
        "`separator: \",\"` in the job's `data`, or another separator in the "
        "file");
  }

  // Commas between names of Alidade's own: points are decimal ones, and other
  // marks stand within quotes or are apostrophes.
  bool HasPlainNumbers() const {
    return separator() == ',' && !stated_.decimal && !stated_.thousands &&
           HasJoint(layout_.names);
  }

  void FindNumbers() {
    const bool has_marks =
        text_.substr(0, kFirstBytes).find_first_of("\"'\xe2") !=
        std::string_view::npos;
    if (HasPlainNumbers() && !has_marks) return;
    NumberEvidence evidence;
    evidence.AddRows(text_.substr(layout_.rows, kMostBytes),
                     layout_.lines_before_rows, stated_, layout_.dialect);
    if (HasPlainNumbers() && !evidence.HasOtherMarks()) return;
    evidence.Decide(path_, stated_, &layout_.dialect);
  }

  void Describe() {
    std::vector<std::string> notes;
    if (!stated_.separator && separator() != ',') {
      notes.push_back(std::string("cells are separated by ") +
                      SeparatorName(separator()));
    }
    if (!stated_.decimal && layout_.dialect.decimal == ',') {
      notes.emplace_back("decimal marks are commas");
    }
    const char thousands = layout_.dialect.thousands;
    if (!stated_.thousands && thousands != '\0') {
      notes.push_back(thousands == ' ' ? std::string("blanks group thousands")
                                       : "thousands are grouped by " +
                                             Quote(std::string(1, thousands)));
    }
    const Line* const first = FirstLine(separator());
    const bool is_first =
        first == nullptr || first->number == layout_.header_line;
    if (!stated_.header && !is_first && layout_.header_line > 0) {
      notes.push_back("the header is line " +
                      std::to_string(layout_.header_line));
    }
    layout_.notes.insert(layout_.notes.begin(), notes.begin(), notes.end());
  }

  const std::string& path_;
  const std::string_view text_;
  const StatedDialect& stated_;
  std::vector<Line> lines_;
  std::optional<char> said_separator_;
  std::optional<Candidate> best_;
  CsvLayout layout_;
};

}  // namespace

CsvLayout FindCsvLayout(const std::string& path, std::string_view text,
                        const StatedDialect& stated) {
  return LayoutFinder(path, text, stated).Find();
}

}  // namespace alidade::internal
