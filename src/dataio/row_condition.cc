#include "src/dataio/row_condition.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "src/common/numbers.h"

namespace alidade::internal {
namespace {

using Comparison = RowCondition::Comparison;

std::string_view Trimmed(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

std::optional<double> NumberOf(std::string_view cell,
                               const CsvDialect& dialect) {
  return ParseNumber(PlainNumber(cell, dialect).text());
}

bool Compare(double a, Comparison comparison, double b) {
  switch (comparison) {
    case Comparison::kEqual:
      return a == b;
    case Comparison::kUnequal:
      return a != b;
    case Comparison::kLess:
      return a < b;
    case Comparison::kLessOrEqual:
      return a <= b;
    case Comparison::kMore:
      return a > b;
    default:
      return a >= b;
  }
}

}  // namespace

bool RowCondition::IsMet(std::string_view cell,
                         const CsvDialect& dialect) const {
  const std::optional<double> own = ParseNumber(text);
  const std::optional<double> number = NumberOf(cell, dialect);
  if (own && number) return Compare(*number, comparison, *own);
  if (comparison == Comparison::kEqual) return cell == text;
  return comparison == Comparison::kUnequal && cell != text;
}

std::optional<RowCondition> ParseRowCondition(std::string_view text) {
  const std::size_t at = text.find_first_of("=!<>");
  if (at == std::string_view::npos || at == 0) return std::nullopt;
  const bool is_two = at + 1 < text.size() && text[at + 1] == '=';
  if (text[at] == '!' && !is_two) return std::nullopt;
  RowCondition condition;
  condition.column = Trimmed(text.substr(0, at));
  condition.text = Trimmed(text.substr(at + (is_two ? 2 : 1)));
  switch (text[at]) {
    case '!':
      condition.comparison = Comparison::kUnequal;
      break;
    case '<':
      condition.comparison =
          is_two ? Comparison::kLessOrEqual : Comparison::kLess;
      break;
    case '>':
      condition.comparison =
          is_two ? Comparison::kMoreOrEqual : Comparison::kMore;
      break;
    default:
      break;
  }
  if (condition.column.empty()) return std::nullopt;
  return condition;
}

std::optional<std::pair<int, int>> ParseLines(std::string_view text) {
  const std::size_t dash = text.find('-');
  const auto first = ParseWhole<int>(text.substr(0, dash));
  auto last = first;
  if (dash != std::string_view::npos) {
    const std::string_view rest = text.substr(dash + 1);
    last =
        rest.empty() ? std::numeric_limits<int>::max() : ParseWhole<int>(rest);
  }
  if (!first || !last || *first < 1 || *first > *last) return std::nullopt;
  return std::pair{*first, *last};
}

std::string HowToExclude(int line) {
  const std::string number = std::to_string(line);
  return "`exclude: [" + number +
         "]` in the job's `data`, or --exclude=" + number +
         " of `import`, leaves the row out";
}

}  // namespace alidade::internal
