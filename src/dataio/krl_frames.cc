#include "src/dataio/krl_frames.h"

#include <algorithm>
#include <iterator>

namespace alidade::internal {
namespace {

Eigen::Isometry3d FrameOf(const KrlAggregate& aggregate) {
  ProgramTarget frame;
  frame.numbers = aggregate.Of(KrlPoseNames());
  return PoseOf(ProgramLanguage::kKrl, frame);
}

}  // namespace

bool KrlAggregate::HasAll(const std::vector<std::string>& names) const {
  return std::all_of(names.begin(), names.end(),
                     [&](const auto& name) { return numbers.count(name) > 0; });
}

bool KrlAggregate::HasAny(const std::vector<std::string>& names) const {
  return std::any_of(names.begin(), names.end(),
                     [&](const auto& name) { return numbers.count(name) > 0; });
}

std::vector<NumberSpan> KrlAggregate::Of(
    const std::vector<std::string>& names) const {
  std::vector<NumberSpan> spans;
  for (const std::string& name : names) spans.push_back(numbers.at(name));
  return spans;
}

KrlAggregate ParseKrlAggregate(const ProgramText& text, std::size_t at) {
  KrlAggregate aggregate;
  aggregate.begin = at;
  std::size_t next = text.SkipSpaces(at + 1);
  // {FRAME: X 1, ...}
  const std::string type = text.WordAt(next);
  if (text.at(text.SkipSpaces(next + type.size())) == ':') {
    next = text.SkipSpaces(text.SkipSpaces(next + type.size()) + 1);
  }
  while (text.at(next) != '}') {
    const std::string name = text.WordAt(next);
    const std::size_t value = text.SkipSpaces(next + name.size());
    const auto number = text.NumberAt(value);
    if (name.empty() || !number) {
      aggregate.only_numbers = false;
    } else {
      aggregate.numbers[name] = *number;
    }
    const std::size_t end =
        std::min(text.text().find_first_of(",}\n", value), text.size());
    if (text.at(end) != ',') break;
    next = text.SkipSpaces(end + 1);
  }
  return aggregate;
}

std::vector<std::string> KrlPoseNames() {
  return {"X", "Y", "Z", "A", "B", "C"};
}

std::string KrlFrameName(const char* kind, int index) {
  return index == 0 ? "" : std::string(kind) + " " + std::to_string(index);
}

KrlFrameReader::KrlFrameReader(const ProgramText& text, RobotProgram* program)
    : text_(text), program_(program) {
  ReadNumberedFrames();
  ReadFrameChanges();
}

void KrlFrameReader::Refuse(std::size_t at, const std::string& why) {
  program_->refused.push_back({text_.LineOf(at), why});
}

// "TOOL 1": the number in brackets or behind a comma at `at`.
std::optional<int> KrlFrameReader::Index(std::size_t at) const {
  const auto number = text_.NumberAt(text_.SkipSpaces(at));
  if (!number || number->decimals > 0) return std::nullopt;
  return number->Whole();
}

// TOOL_DATA[1]={...} and BASE_DATA[2]={...}.
void KrlFrameReader::ReadNumberedFrames() {
  for (const auto& [word, kind] :
       {std::pair<std::string, const char*>{"TOOL_DATA", "tool"},
        {"BASE_DATA", "base"}}) {
    for (std::size_t at = 0; (at = text_.FindWord(word, at)) != kNowhere;
         at += word.size()) {
      const auto index = Index(at + word.size() + 1);
      const std::size_t close = text_.text().find(']', at);
      if (!index || close == kNowhere) continue;
      const std::size_t equals = text_.SkipSpaces(close + 1);
      const std::size_t brace = text_.SkipSpaces(equals + 1);
      if (text_.at(equals) == '.' && IsAssigned(equals)) {
        Refuse(at, KrlFrameName(kind, *index) + " is changed in parts");
      }
      if (text_.at(equals) != '=' || text_.at(brace) != '{') continue;
      const KrlAggregate value = ParseKrlAggregate(text_, brace);
      if (!value.HasAll(KrlPoseNames())) continue;
      StateFrame(KrlFrameName(kind, *index), FrameOf(value), at);
    }
  }
}

void KrlFrameReader::StateFrame(const std::string& name,
                                const Eigen::Isometry3d& frame,
                                std::size_t at) {
  const auto [stated, is_new] = stated_frames_.try_emplace(name, frame);
  if (!is_new && !stated->second.isApprox(frame, 1e-15)) {
    Refuse(at, name + " is stated once more, with other numbers");
  }
  program_->frames[name] = frame;
}

// Whether the line that goes on at `at` gives a value to what stands there.
bool KrlFrameReader::IsAssigned(std::size_t at) const {
  const std::size_t equals = text_.text().find('=', at);
  return equals < text_.LineEnd(at) && text_.at(equals + 1) != '=';
}

// Whether nothing follows in the line: "BASE_DATA[1]:{X 0, ...}" is no
// BASE_DATA[1].
bool KrlFrameReader::EndsLine(std::size_t at) const {
  return text_.SkipSpaces(at) >= text_.LineEnd(at);
}

// What $TOOL or $BASE is set to by the text from `at` on.
std::string KrlFrameReader::AssignedFrame(std::size_t at,
                                          const std::string& word,
                                          const char* kind) {
  const std::string value = text_.WordAt(at);
  if (value == "$NULLFRAME" || value == "$WORLD" || value == "$ROBROOT") {
    return EndsLine(at + value.size()) ? "" : "?";
  }
  if (value == word + "_DATA") {
    const auto index = Index(at + value.size() + 1);
    const std::size_t close = text_.text().find(']', at);
    return index && close != kNowhere && EndsLine(close + 1)
               ? KrlFrameName(kind, *index)
               : "?";
  }
  if (text_.at(at) != '{') return "?";
  const KrlAggregate aggregate = ParseKrlAggregate(text_, at);
  const std::size_t close = text_.text().find('}', at);
  if (!aggregate.HasAll(KrlPoseNames()) || !aggregate.only_numbers ||
      close == kNowhere || !EndsLine(close + 1)) {
    return "?";
  }
  std::string name =
      std::string("$") + word + " in line " + std::to_string(text_.LineOf(at));
  program_->frames[name] = FrameOf(aggregate);
  return name;
}

// $TOOL = ..., BAS(#TOOL, 1): of the motions that follow in the text.
void KrlFrameReader::ReadFrameChanges() {
  for (std::size_t start = 0; start < text_.size();
       start = text_.LineEnd(start) + 1) {
    const std::size_t at = text_.SkipSpaces(start);
    const std::string word = text_.WordAt(at);
    if (word == "$TOOL" || word == "$BASE") {
      const std::size_t equals = text_.SkipSpaces(at + word.size());
      const bool is_tool = word == "$TOOL";
      if (text_.at(equals) == '.' && IsAssigned(equals)) {
        Change(at, is_tool, "?");
      }
      if (text_.at(equals) != '=') continue;
      Change(at, is_tool,
             AssignedFrame(text_.SkipSpaces(equals + 1), word.substr(1),
                           is_tool ? "tool" : "base"));
    } else if (word == "BAS") {
      const std::size_t hash = text_.text().find('#', at);
      if (hash >= text_.LineEnd(at)) continue;
      const std::string what = text_.WordAt(hash + 1);
      if (what != "TOOL" && what != "BASE") continue;
      const std::size_t comma = text_.text().find(',', hash);
      const auto index =
          comma < text_.LineEnd(at) ? Index(comma + 1) : std::optional<int>();
      const bool is_tool = what == "TOOL";
      Change(at, is_tool,
             index ? KrlFrameName(is_tool ? "tool" : "base", *index) : "?");
    }
  }
}

void KrlFrameReader::Change(std::size_t at, bool is_tool,
                            const std::string& name) {
  KrlFrames frames = changes_.empty() ? KrlFrames() : changes_.back().second;
  (is_tool ? frames.tool : frames.base) = name;
  changes_.emplace_back(at, frames);
  settings_.push_back(
      {text_.LineOf(at), is_tool ? kUnstatedTool : kUnstatedBase, name});
}

KrlFrames KrlFrameReader::At(std::size_t at) const {
  const auto after =
      std::lower_bound(changes_.begin(), changes_.end(), at,
                       [](const auto& change, std::size_t place) {
                         return change.first < place;
                       });
  return after == changes_.begin() ? KrlFrames() : std::prev(after)->second;
}

}  // namespace alidade::internal
