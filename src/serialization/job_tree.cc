#include "src/serialization/job_tree.h"

#include <algorithm>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>

#include "src/common/names.h"
#include "src/serialization/config_file.h"
#include "src/serialization/yaml_reader.h"

namespace alidade::internal {

namespace {

// The same file whatever it is called.
std::string Canonical(const std::string& path) {
  std::error_code error;
  const auto canonical = std::filesystem::weakly_canonical(path, error);
  return error ? path : canonical.string();
}

void CheckUnits(const YamlDocument& document, const YamlDocument& base) {
  const YamlNode* const own = document.root.Find("units");
  const YamlNode* const inherited = base.root.Find("units");
  if (own == nullptr || inherited == nullptr) return;
  for (const char* key : {"length", "angle"}) {
    const YamlNode* const a = own->Find(key);
    const YamlNode* const b = inherited->Find(key);
    if (a == nullptr || b == nullptr || a->text == b->text) continue;
    throw InputError(LocationOf(document, *a, std::string("units.") + key),
                     "found " + Quote(a->text) + ", but the numbers of " +
                         base.files.front() + " are in " + Quote(b->text) +
                         ": expected the same units");
  }
}

// Of files that extend each other: more are no arrangement that anyone reads.
constexpr std::size_t kMostFiles = 32;

class TreeReader {
 public:
  YamlDocument Read(const YamlValue& root) {
    YamlDocument document = root.document();
    const std::optional<YamlValue> extends = root.Find("extends");
    if (!extends) return document;
    const std::string path = document.files.front();
    chain_.push_back(path);
    NamedFiles files(path);
    const std::string base_path = files.Resolve(*extends);
    RefuseCircle(*extends, base_path);
    if (chain_.size() >= kMostFiles) {
      extends->Fail("more than " + std::to_string(kMostFiles) +
                    " files extend each other, expected fewer");
    }
    YamlDocument base = files.Read(*extends, [this](const std::string& named) {
      return Read(ReadConfigFile(named, FileFormat::kJob));
    });
    CheckUnits(document, base);
    RemoveKey("extends", &document.root);
    Inherit(std::move(base), &document);
    return document;
  }

 private:
  void RefuseCircle(const YamlValue& extends, const std::string& base) const {
    const auto same = std::find_if(chain_.begin(), chain_.end(),
                                   [&](const std::string& path) {
                                     return Canonical(path) == Canonical(base);
                                   });
    if (same == chain_.end()) return;
    std::string circle;
    for (auto link = same; link != chain_.end(); ++link) {
      circle += *link + " -> ";
    }
    extends.Fail("files extend each other in a circle: " + circle + base +
                 "; expected one that extends none");
  }

  std::vector<std::string> chain_;
};

}  // namespace

YamlDocument ReadJobTree(const YamlValue& root) {
  return TreeReader().Read(root);
}

namespace {

using Kind = YamlNode::Kind;

YamlNode* AddChild(const std::string& key, YamlNode value, YamlNode* map) {
  map->keys.push_back(key);
  map->items.push_back(std::move(value));
  return &map->items.back();
}

void TakeAway(const YamlDocument& document, const std::string& path,
              const std::string& key, const YamlNode& null, YamlNode* map) {
  if (map->Find(key) == nullptr) {
    throw InputError(
        LocationOf(document, null, path),
        "null takes an inherited key away, and there is none of this name");
  }
  RemoveKey(key, map);
}

void MoveToFile(int offset, YamlNode* node) {
  node->file += offset;
  for (YamlNode& item : node->items) MoveToFile(offset, &item);
}

// Lengths in front of texts keep different trees apart whatever texts hold.
void AppendText(const std::string& text, std::string* out) {
  *out += std::to_string(text.size()) + ":" + text;
}

void AppendCanonical(const YamlNode& node, std::string* out) {
  switch (node.kind) {
    case Kind::kEmpty:
      *out += "~";
      return;
    case Kind::kScalar:
      *out += node.quoted ? "'" : "";
      AppendText(node.text, out);
      return;
    case Kind::kList:
      *out += "[";
      for (const YamlNode& item : node.items) AppendCanonical(item, out);
      *out += "]";
      return;
    case Kind::kMap:
      *out += "{";
      for (std::size_t i = 0; i < node.items.size(); ++i) {
        AppendText(node.keys[i], out);
        AppendCanonical(node.items[i], out);
      }
      *out += "}";
      return;
  }
}

}  // namespace

void RemoveKey(const std::string& key, YamlNode* map) {
  const auto found = std::find(map->keys.begin(), map->keys.end(), key);
  if (found == map->keys.end()) return;
  map->items.erase(map->items.begin() + (found - map->keys.begin()));
  map->keys.erase(found);
}

void Overlay(const YamlDocument& document, const std::string& path,
             const YamlNode& over, YamlNode* under) {
  if (over.kind != Kind::kMap || under->kind != Kind::kMap) {
    *under = over;
    return;
  }
  under->file = over.file;
  under->place = over.place;
  under->key_place = over.key_place;
  for (std::size_t i = 0; i < over.items.size(); ++i) {
    const std::string& key = over.keys[i];
    const YamlNode& value = over.items[i];
    const std::string child_path = path.empty() ? key : path + "." + key;
    YamlNode* const child = under->Find(key);
    if (value.says_null) {
      TakeAway(document, child_path, key, value, under);
    } else if (child == nullptr) {
      AddChild(key, value, under);
    } else {
      Overlay(document, child_path, value, child);
    }
  }
}

void SetAt(const std::string& path, const YamlNode& value, YamlNode* root) {
  YamlNode* node = root;
  std::size_t begin = 0;
  while (begin <= path.size()) {
    const std::size_t end = std::min(path.find('.', begin), path.size());
    const std::string key = path.substr(begin, end - begin);
    if (node->kind != Kind::kMap) {
      YamlNode map;
      map.kind = Kind::kMap;
      map.file = value.file;
      map.place = value.place;
      map.key_place = value.key_place;
      *node = std::move(map);
    }
    YamlNode* const child = node->Find(key);
    node = child != nullptr ? child : AddChild(key, YamlNode(), node);
    begin = end + 1;
  }
  *node = value;
}

void Inherit(YamlDocument base, YamlDocument* document) {
  const auto offset = static_cast<int>(document->files.size());
  document->files.insert(document->files.end(), base.files.begin(),
                         base.files.end());
  MoveToFile(offset, &base.root);
  Overlay(*document, "", document->root, &base.root);
  document->root = std::move(base.root);
}

std::string CanonicalText(const YamlNode& node) {
  std::string text;
  AppendCanonical(node, &text);
  return text;
}

}  // namespace alidade::internal
