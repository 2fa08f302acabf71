#include "src/dataio/program_text.h"

#include <algorithm>
#include <cctype>
#include <limits>
#include <map>

#include "src/common/numbers.h"

namespace alidade::internal {

bool MayBeName(const std::string& text) {
  return !text.empty() &&
         std::isdigit(static_cast<unsigned char>(text.front())) == 0;
}

bool IsName(const std::string& text) {
  return MayBeName(text) && std::all_of(text.begin(), text.end(), [](char c) {
           return IsWordCharacter(c) || c == '.';
         });
}

ProgramText::ProgramText(const std::string& text, std::string_view comment,
                         char quote, bool keep_case)
    : masked_(text) {
  bool in_string = false;
  bool in_comment = false;
  line_starts_.push_back(0);
  for (std::size_t i = 0; i < masked_.size(); ++i) {
    char& c = masked_[i];
    if (c == '\n') {
      in_string = in_comment = false;
      line_starts_.push_back(i + 1);
    } else if (in_comment || c == '\r') {
      c = ' ';
    } else if (in_string) {
      in_string = c != quote;
      if (in_string) c = ' ';
    } else if (c == quote) {
      in_string = true;
    } else if (std::string_view(text).substr(i, comment.size()) == comment) {
      in_comment = true;
      c = ' ';
    } else if (!keep_case) {
      c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    }
  }
  ListWords();
}

int ProgramText::LineOf(std::size_t place) const {
  const auto after =
      std::upper_bound(line_starts_.begin(), line_starts_.end(), place);
  return static_cast<int>(after - line_starts_.begin());
}

std::size_t ProgramText::LineStart(std::size_t place) const {
  return line_starts_[static_cast<std::size_t>(LineOf(place)) - 1];
}

std::size_t ProgramText::LineEnd(std::size_t place) const {
  return std::min(masked_.find('\n', place), masked_.size());
}

std::size_t ProgramText::SkipSpaces(std::size_t place) const {
  while (at(place) == ' ' || at(place) == '\t') ++place;
  return place;
}

std::size_t ProgramText::SkipSpacesBack(std::size_t place) const {
  while (place > 0 && (at(place - 1) == ' ' || at(place - 1) == '\t')) --place;
  return place;
}

std::optional<NumberSpan> ProgramText::NumberAt(std::size_t place) const {
  NumberSpan span;
  span.begin = place;
  std::size_t end = place;
  const auto digits = [&] {
    const std::size_t from = end;
    while (std::isdigit(static_cast<unsigned char>(at(end))) != 0) ++end;
    return static_cast<int>(end - from);
  };
  if (at(end) == '-' || at(end) == '+') ++end;
  int count = digits();
  if (at(end) == '.') {
    ++end;
    span.decimals = digits();
    count += span.decimals;
  }
  if (count == 0) return std::nullopt;
  if (at(end) == 'E' || at(end) == 'e') {
    std::size_t exponent = end + 1;
    const bool is_small = at(exponent) == '-';
    if (is_small || at(exponent) == '+') ++exponent;
    std::size_t after = exponent;
    while (std::isdigit(static_cast<unsigned char>(at(after))) != 0) ++after;
    if (after == exponent) return std::nullopt;
    const auto power = ParseWhole<int>(
        std::string_view(masked_).substr(exponent, after - exponent));
    // More decimals than any number is written with.
    constexpr int kMostDecimals = 1000;
    span.decimals +=
        is_small ? std::min(power.value_or(kMostDecimals), kMostDecimals) : 0;
    end = after;
  }
  if (IsWordCharacter(at(end)) || at(end) == '.') return std::nullopt;
  span.end = end;
  // A plus sign and a missing zero are not ParseNumber's.
  std::string text = masked_.substr(place, end - place);
  if (text.front() == '+') text.erase(0, 1);
  const std::size_t sign = text.front() == '-' ? 1 : 0;
  if (text[sign] == '.') text.insert(sign, "0");
  const auto value = ParseNumber(text);
  if (!value) return std::nullopt;
  span.value = *value;
  return span;
}

std::optional<std::vector<NumberSpan>> ProgramText::ListAt(
    std::size_t place, std::size_t* end) const {
  if (at(place) != '[') return std::nullopt;
  std::vector<NumberSpan> numbers;
  const auto skip = [this](std::size_t from) {
    while (std::isspace(static_cast<unsigned char>(at(from))) != 0 &&
           from < size()) {
      ++from;
    }
    return from;
  };
  for (std::size_t next = place;;) {
    const auto number = NumberAt(skip(next + 1));
    if (!number) return std::nullopt;
    numbers.push_back(*number);
    next = skip(number->end);
    if (at(next) == ']') {
      *end = next + 1;
      return numbers;
    }
    if (at(next) != ',') return std::nullopt;
  }
}

std::string ProgramText::WordBefore(std::size_t place) const {
  std::size_t begin = place;
  while (begin > 0 && IsWordCharacter(at(begin - 1))) --begin;
  return masked_.substr(begin, place - begin);
}

std::string ProgramText::WordAt(std::size_t place) const {
  std::size_t end = place;
  while (IsWordCharacter(at(end))) ++end;
  return masked_.substr(place, end - place);
}

void ProgramText::ListWords() {
  for (std::size_t at = 0; at < masked_.size(); ++at) {
    const std::string word = WordAt(at);
    if (word.empty()) continue;
    places_[word].push_back(at);
    at += word.size();
  }
}

std::size_t ProgramText::FindWord(const std::string& word,
                                  std::size_t from) const {
  if (std::all_of(word.begin(), word.end(), IsWordCharacter)) {
    const auto places = places_.find(word);
    if (places == places_.end()) return std::string::npos;
    const auto place =
        std::lower_bound(places->second.begin(), places->second.end(), from);
    return place == places->second.end() ? std::string::npos : *place;
  }
  // What is named by more than a word: "cell.home".
  for (std::size_t at_word = from;
       (at_word = masked_.find(word, at_word)) != std::string::npos;
       ++at_word) {
    const bool begins = at_word == 0 || !IsWordCharacter(masked_[at_word - 1]);
    if (begins && !IsWordCharacter(at(at_word + word.size()))) return at_word;
  }
  return std::string::npos;
}

std::string ProgramReader::FrameOrOwn(const std::string& name, std::size_t at) {
  const bool is_unstated = name == kUnstatedTool || name == kUnstatedBase;
  if (!is_unstated || program_->frames.count(name) > 0) return name;
  program_->unstated[name].push_back(text_.LineOf(at));
  return "";
}

void ProgramReader::ListStraight(
    const std::function<bool(const std::string&)>& is_straight) {
  for (std::size_t start = 0; start < text_.size();
       start = text_.LineEnd(start) + 1) {
    const std::size_t at = text_.SkipSpaces(start);
    if (is_straight(text_.WordAt(at))) AddStraight(at);
  }
}

std::vector<int> ProgramReader::UsesOf(const ProgramTarget& target,
                                       int end) const {
  std::vector<int> lines;
  if (!target.name.empty() && IsWordCharacter(target.name.back())) {
    const std::size_t begin = target.numbers.front().begin;
    for (std::size_t at = text_.FindWord(target.name, begin);
         at != std::string::npos; at = text_.FindWord(target.name, at + 1)) {
      const int line = text_.LineOf(at);
      if (line >= end) break;
      if (line > target.line) lines.push_back(line);
    }
  }
  return lines.empty() ? std::vector<int>{target.line} : lines;
}

void ProgramReader::SortTargets() {
  std::vector<ProgramTarget>& targets = program_->targets;
  std::stable_sort(targets.begin(), targets.end(),
                   [](const ProgramTarget& a, const ProgramTarget& b) {
                     return a.numbers.front().begin < b.numbers.front().begin;
                   });
  // Each is used until its variable is given another position.
  std::map<std::string, int> next;
  for (auto target = targets.rbegin(); target != targets.rend(); ++target) {
    const auto [given_again, is_last] = next.try_emplace(target->name);
    target->uses = UsesOf(*target, is_last ? std::numeric_limits<int>::max()
                                           : given_again->second);
    given_again->second = target->line;
  }
}

bool KnowsFrame(const std::string& name, int line, RobotProgram* program) {
  if (name.empty() || program->frames.count(name) > 0) return true;
  if (name == "?") {
    program->refused.push_back(
        {line, "its tool or base is set at run time to what is not stated"});
  } else {
    program->missing[name].push_back(line);
  }
  return false;
}

}  // namespace alidade::internal
