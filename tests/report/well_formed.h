#ifndef ALIDADE_TESTS_REPORT_WELL_FORMED_H_
#define ALIDADE_TESTS_REPORT_WELL_FORMED_H_

#include <string>
#include <string_view>
#include <vector>

namespace alidade::internal {

/// A small check of XML that knows elements, attributes in double quotes and
/// the five named entities: all that an SVG document of ours may use.

/// True where every & begins an entity and no markup character stands bare.
inline bool IsCharacterData(std::string_view text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    if (text[i] == '<' || text[i] == '>' || text[i] == '"') return false;
    if (byte < 0x20U && text[i] != '\n') return false;
    if (text[i] != '&') continue;
    bool known = false;
    for (const std::string_view entity :
         {"&amp;", "&lt;", "&gt;", "&quot;", "&#39;"}) {
      known |= text.substr(i, entity.size()) == entity;
    }
    if (!known) return false;
  }
  return true;
}

/// True where `tag`, without its brackets, is a name and name="value" pairs.
inline bool AreAttributes(std::string_view tag) {
  while (!tag.empty()) {
    if (tag.front() != ' ') return false;
    const std::size_t open = tag.find("=\"");
    if (open == std::string_view::npos) return false;
    const std::size_t close = tag.find('"', open + 2);
    if (close == std::string_view::npos) return false;
    if (!IsCharacterData(tag.substr(open + 2, close - open - 2))) return false;
    tag.remove_prefix(close + 1);
  }
  return true;
}

/// Empty for a well-formed document, else what is wrong with it.
inline std::string WhatIsMalformed(std::string_view xml) {
  std::vector<std::string> open;
  bool has_root = false;
  while (!xml.empty()) {
    const std::size_t begin = xml.find('<');
    if (!IsCharacterData(xml.substr(0, begin))) return "bare markup in text";
    if (begin == std::string_view::npos) break;
    const std::size_t end = xml.find('>', begin);
    if (end == std::string_view::npos) return "a tag does not end";
    std::string_view tag = xml.substr(begin + 1, end - begin - 1);
    xml.remove_prefix(end + 1);
    if (tag.substr(0, 1) == "/") {
      if (open.empty() || open.back() != tag.substr(1)) return "unbalanced";
      open.pop_back();
      continue;
    }
    if (open.empty() && has_root) return "more than one root";
    has_root = true;
    const bool closed = !tag.empty() && tag.back() == '/';
    if (closed) tag.remove_suffix(1);
    const std::size_t name_end = tag.find(' ');
    const std::string name(tag.substr(0, name_end));
    if (name_end != std::string_view::npos &&
        !AreAttributes(tag.substr(name_end))) {
      return "attributes of " + name;
    }
    if (!closed) open.push_back(name);
  }
  if (!open.empty()) return open.back() + " is not closed";
  return has_root ? "" : "no root element";
}

}  // namespace alidade::internal

#endif  // ALIDADE_TESTS_REPORT_WELL_FORMED_H_
