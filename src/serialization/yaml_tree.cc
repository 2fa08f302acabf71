#include "src/serialization/yaml_tree.h"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <sstream>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "src/common/files.h"
#include "src/common/names.h"
#include "src/common/utf8.h"

namespace alidade::internal {
namespace {

using Kind = YamlNode::Kind;

// Far more than any file needs, and within what yaml-cpp takes (500).
constexpr std::size_t kMaxDepth = 100;

YamlPlace PlaceOf(const YAML::Mark& mark) {
  return {mark.line + 1, mark.column + 1};
}

SourceLocation LocationOf(const std::string& file, const YAML::Mark& mark) {
  if (mark.is_null()) return {file, 0, 0, ""};
  return {file, PlaceOf(mark).line, PlaceOf(mark).column, ""};
}

// The lines of a text, found once.
class Lines {
 public:
  explicit Lines(const std::string& text) : text_(text) {
    for (std::size_t begin = 0; begin <= text.size();) {
      begins_.push_back(begin);
      const std::size_t end = text.find('\n', begin);
      if (end == std::string::npos) break;
      begin = end + 1;
    }
  }

  /// Line `number` from 0; empty behind the last.
  std::string_view operator[](int number) const {
    const auto k = static_cast<std::size_t>(number);
    if (k >= begins_.size()) return {};
    const std::size_t end =
        k + 1 < begins_.size() ? begins_[k + 1] - 1 : text_.size();
    return text_.substr(begins_[k], end - begins_[k]);
  }

 private:
  const std::string_view text_;
  std::vector<std::size_t> begins_;
};

// yaml-cpp puts an empty value where the next token is, but one that says null
// where it stands.
bool SaysNull(const Lines& lines, const YAML::Mark& mark) {
  const std::string_view line = lines[mark.line];
  const std::size_t column = static_cast<std::size_t>(mark.column);
  if (column >= line.size()) return false;
  const std::string_view rest = line.substr(column);
  const std::string_view word = rest.substr(0, rest.find_first_of(" \t\r,]}#"));
  return word == "~" || word == "null" || word == "Null" || word == "NULL";
}

// The dash of an empty item begins the nearest line above that begins with one.
YamlPlace PlaceOfEmptyItem(const Lines& lines, const YAML::Mark& mark) {
  for (int number = mark.line - 1; number >= 0; --number) {
    const std::string_view line = lines[number];
    const std::size_t first = line.find_first_not_of(' ');
    if (first != std::string_view::npos && line[first] == '-') {
      return {number + 1, static_cast<int>(first) + 1};
    }
  }
  return PlaceOf(mark);
}

// yaml-cpp overlooks a missing closing quote where the text ends in a line
// break; a comment after it brings the error out.
std::string WithEndMark(const std::string& text) {
  const std::size_t last = text.find_last_not_of(" \t");
  if (last == std::string::npos || text[last] != '\n') return text;
  return text.substr(0, last + 1) + "#";
}

// A character that no text has, of those that a byte tells.
bool IsForbidden(char c) {
  const unsigned char byte = static_cast<unsigned char>(c);
  return (byte < 0x20 && c != '\n' && c != '\r' && c != '\t') || byte == 0x7f;
}

// Builds the tree. A value is built in its parent's place, so pointers in
// `open_` stay valid: only the innermost open node grows.
class TreeBuilder : public YAML::EventHandler {
 public:
  TreeBuilder(const std::string& text, YamlDocument* document)
      : lines_(text), document_(*document) {}

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (started_) {
      Fail(mark,
           "a second document begins here, expected one per file; or this "
           "key begins in another column than the first");
    }
    started_ = true;
  }
  void OnDocumentEnd() override {}

  void OnNull(const YAML::Mark& mark, YAML::anchor_t) override {
    if (ExpectsKey()) Fail(mark, "expected a key before \":\", found nothing");
    YamlNode* const node = Add(mark, Kind::kEmpty);
    node->says_null = SaysNull(lines_, mark);
    if (open_.empty()) return;
    if (open_.back()->kind == Kind::kMap) {
      node->place = key_place_;
    } else if (!node->says_null) {
      node->place = PlaceOfEmptyItem(lines_, mark);
    }
  }

  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override {
    Fail(mark, "aliases (*name) are not read here: write the value out");
  }

  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t,
                const std::string& value) override {
    RefuseTag(mark, tag);
    RefuseControls(mark, value);
    if (ExpectsKey()) {
      AddKey(mark, value);
      return;
    }
    YamlNode* const node = Add(mark, Kind::kScalar);
    node->text = value;
    node->quoted = tag == "!";
  }

  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag,
                       YAML::anchor_t, YAML::EmitterStyle::value) override {
    RefuseTag(mark, tag);
    if (ExpectsKey()) Fail(mark, "expected a key that is text, found a list");
    Open(mark, Kind::kList);
  }
  void OnSequenceEnd() override { Close(); }

  void OnMapStart(const YAML::Mark& mark, const std::string& tag,
                  YAML::anchor_t, YAML::EmitterStyle::value) override {
    RefuseTag(mark, tag);
    if (ExpectsKey()) Fail(mark, "expected a key that is text, found a map");
    Open(mark, Kind::kMap);
  }
  void OnMapEnd() override { Close(); }

 private:
  [[noreturn]] void Fail(const YAML::Mark& mark,
                         const std::string& message) const {
    throw InputError(LocationOf(document_.files.front(), mark), message);
  }

  // Escapes of YAML can say what its bytes may not.
  void RefuseControls(const YAML::Mark& mark, const std::string& text) const {
    const auto found = std::find_if(text.begin(), text.end(), IsForbidden);
    if (found == text.end()) return;
    Fail(mark, "found a control character (" + std::to_string(*found) +
                   ") in " + Quote(text) + ", expected text");
  }

  void RefuseTag(const YAML::Mark& mark, const std::string& tag) const {
    // yaml-cpp marks plain values "?" and quoted ones "!".
    if (tag.empty() || tag == "?" || tag == "!") return;
    Fail(mark, "tags (" + tag + ") are not read here: leave it out");
  }

  bool ExpectsKey() const {
    return !open_.empty() && open_.back()->kind == Kind::kMap &&
           open_.back()->keys.size() == open_.back()->items.size();
  }

  void AddKey(const YAML::Mark& mark, const std::string& key) {
    YamlNode* const map = open_.back();
    const auto [first, is_new] =
        lines_of_keys_.back().emplace(key, PlaceOf(mark).line);
    if (!is_new) {
      Fail(mark, "key " + Quote(key) +
                     " is repeated, expected once (it is in line " +
                     std::to_string(first->second) + " already)");
    }
    map->keys.push_back(key);
    key_place_ = PlaceOf(mark);
  }

  void Open(const YAML::Mark& mark, Kind kind) {
    if (open_.size() >= kMaxDepth) {
      Fail(mark, "nested deeper than " + std::to_string(kMaxDepth) +
                     " levels, expected fewer");
    }
    open_.push_back(Add(mark, kind));
    lines_of_keys_.emplace_back();
  }

  void Close() {
    open_.pop_back();
    lines_of_keys_.pop_back();
  }

  YamlNode* Add(const YAML::Mark& mark, Kind kind) {
    YamlNode* node = &document_.root;
    const bool in_map = !open_.empty() && open_.back()->kind == Kind::kMap;
    if (!open_.empty()) node = &open_.back()->items.emplace_back();
    node->kind = kind;
    node->place = PlaceOf(mark);
    if (in_map) node->key_place = key_place_;
    return node;
  }

  const Lines lines_;
  YamlDocument& document_;
  bool started_ = false;
  YamlPlace key_place_;
  std::vector<YamlNode*> open_;
  // One for each of these.
  std::vector<std::unordered_map<std::string, int>> lines_of_keys_;
};

// yaml-cpp ends a file silently at a byte 4, and reads other control characters
// and what is no UTF-8 as text.
void RefuseBinary(const std::string& text, const std::string& file) {
  std::string_view rest = text;
  while (!rest.empty()) {
    const std::size_t length = ValidUtf8Prefix(rest);
    if (length == 0 || IsForbidden(rest[0])) {
      const int byte = static_cast<unsigned char>(rest[0]);
      throw InputError(
          LocationOfByte(file, text, text.size() - rest.size()),
          (length == 0 ? "not UTF-8: found a byte of value "
                       : "not a text file: found a byte of value ") +
              std::to_string(byte) +
              (length == 0 ? ", as other encodings have it for a letter; "
                             "expected YAML, save it as UTF-8"
                           : ", expected YAML in UTF-8"));
    }
    rest.remove_prefix(length);
  }
}

// "title" of a line "  - title: UR10"; empty where it begins with no key.
std::string_view KeyOf(std::string_view line) {
  const std::size_t first = line.find_first_not_of(" -");
  if (first == std::string_view::npos) return {};
  line = line.substr(first);
  const std::size_t end = line.find_first_not_of(
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_");
  const bool is_key = end != std::string_view::npos && end > 0;
  return is_key && line[end] == ':' ? line.substr(0, end) : std::string_view();
}

// What follows the key and its colon, without a comment.
std::string_view RestOf(std::string_view line) {
  line = line.substr(line.find(':') + 1);
  line = line.substr(0, line.find(" #"));
  while (!line.empty() && (line.back() == ' ' || line.back() == '\r')) {
    line.remove_suffix(1);
  }
  return line;
}

std::size_t IndentOf(std::string_view line) {
  return std::min(line.find_first_not_of(' '), line.size());
}

// The line of a mistake that people make, from 0, of those that come to an
// error at line `number`: it or the last one above that holds something.
class MistakeFinder {
 public:
  MistakeFinder(const Lines& lines, int number) : lines_(lines) {
    Add(number);
    for (int k = number - 1; k >= 0 && places_.size() < 2; --k) {
      const std::string_view line = lines[k];
      const std::size_t first = line.find_first_not_of(" \t\r");
      if (first != std::string_view::npos && line[first] != '#') Add(k);
    }
  }

  std::string Describe() const {
    if (places_.size() > 1 && !IsInBlock(places_[0]) && HasOddIndent()) {
      return DescribeIndents();
    }
    for (const int k : places_) {
      if (IsInBlock(k)) continue;
      const std::string mistake = MistakeIn(lines_[k]);
      if (!mistake.empty()) return ". Line " + std::to_string(k + 1) + mistake;
    }
    const bool has_indents =
        places_.size() > 1 && !IsInBlock(places_[0]) && AreKeys() &&
        IndentOf(lines_[places_[0]]) != IndentOf(lines_[places_[1]]);
    return has_indents ? DescribeIndents() : "";
  }

 private:
  void Add(int number) { places_.push_back(number); }

  bool AreKeys() const {
    return !KeyOf(lines_[places_[0]]).empty() &&
           !KeyOf(lines_[places_[1]]).empty();
  }

  // A key below one that has a value, and farther to the right.
  bool HasOddIndent() const {
    const std::string_view line = lines_[places_[0]];
    const std::string_view above = lines_[places_[1]];
    return AreKeys() && !RestOf(above).empty() &&
           IndentOf(line) > IndentOf(above);
  }

  // Whether it is a line of a text below "key: |", where nothing is a key.
  bool IsInBlock(int number) const {
    std::size_t indent = IndentOf(lines_[number]);
    for (int k = number - 1; k >= 0 && indent > 0; --k) {
      const std::string_view line = lines_[k];
      if (line.find_first_not_of(" \t\r") == std::string_view::npos) continue;
      if (IndentOf(line) >= indent) continue;
      indent = IndentOf(line);
      if (KeyOf(line).empty()) continue;
      std::string_view rest = RestOf(line);
      while (!rest.empty() && rest.front() == ' ') rest.remove_prefix(1);
      if (!rest.empty() && (rest.front() == '|' || rest.front() == '>')) {
        return true;
      }
    }
    return false;
  }

  std::string DescribeIndents() const {
    const std::string_view line = lines_[places_[0]];
    const std::string_view above = lines_[places_[1]];
    return ". Line " + std::to_string(places_[0] + 1) + " begins " +
           std::to_string(IndentOf(line)) + " blanks from the left, line " +
           std::to_string(places_[1] + 1) + " " +
           std::to_string(IndentOf(above)) +
           ": keys of one map stand below each other";
  }

  static std::string MistakeIn(std::string_view line) {
    const std::size_t text = line.find_first_not_of(" \t");
    if (text != std::string_view::npos &&
        line.substr(0, text).find('\t') != std::string_view::npos) {
      return " begins with a tab: YAML takes blanks";
    }
    const std::string key(KeyOf(line));
    const std::string_view rest = RestOf(line);
    if (key.empty() || rest.empty()) return "";
    if (rest.front() != ' ') {
      return " has no blank after the colon: write \"" + key + ": " +
             std::string(rest) + "\"";
    }
    const std::size_t first = rest.find_first_not_of(' ');
    const std::string value(rest.substr(first));
    const bool is_plain = std::string_view("[{\"'|>#").find(value.front()) ==
                          std::string_view::npos;
    if (!is_plain || value.find(": ") == std::string::npos) return "";
    return " has a colon in its text: quote that, \"" + key + ": '" + value +
           "'\"";
  }

  const Lines& lines_;
  std::vector<int> places_;
};

void BuildTree(const std::string& text, YamlDocument* document) {
  TreeBuilder builder(text, document);
  try {
    std::istringstream stream(WithEndMark(text));
    YAML::Parser parser(stream);
    while (parser.HandleNextDocument(builder)) {
    }
  } catch (const YAML::Exception& e) {
    const std::string mistake =
        e.mark.is_null() ? ""
                         : MistakeFinder(Lines(text), e.mark.line).Describe();
    throw InputError(LocationOf(document->files.front(), e.mark),
                     "not valid YAML: " + e.msg + mistake);
  }
}

}  // namespace

const YamlNode* YamlNode::Find(const std::string& key) const {
  const auto found = std::find(keys.begin(), keys.end(), key);
  return found == keys.end() ? nullptr : &items[found - keys.begin()];
}

YamlNode* YamlNode::Find(const std::string& key) {
  const auto found = std::find(keys.begin(), keys.end(), key);
  return found == keys.end() ? nullptr : &items[found - keys.begin()];
}

SourceLocation LocationOf(const YamlDocument& document, const YamlNode& node,
                          const std::string& path) {
  return {document.files[node.file], node.place.line, node.place.column, path};
}

YamlDocument ParseYamlDocument(const std::string& text,
                               const std::string& file) {
  YamlDocument document;
  document.files = {file};
  RefuseBinary(text, file);
  BuildTree(text, &document);
  if (document.root.kind == Kind::kEmpty) {
    throw InputError({file, 0, 0, ""},
                     "the file is empty, expected keys and values in YAML");
  }
  return document;
}

}  // namespace alidade::internal
