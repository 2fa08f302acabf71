#ifndef ALIDADE_SRC_SERIALIZATION_YAML_TREE_H_
#define ALIDADE_SRC_SERIALIZATION_YAML_TREE_H_

#include <string>
#include <vector>

#include "alidade/error.h"

namespace alidade::internal {

/// Line and column, 1-based; the column counts bytes.
struct YamlPlace {
  int line = 0;
  int column = 0;
};

/// A tree of our own instead of YAML::Node, which keeps only one of two
/// repeated keys within reach and loses the places of keys and empty values.
struct YamlNode {
  enum class Kind { kEmpty, kScalar, kList, kMap };

  Kind kind = Kind::kEmpty;
  int file = 0;         ///< that states it, in YamlDocument::files
  YamlPlace place;      ///< an empty value in a map stands at its key
  YamlPlace key_place;  ///< of a value in a map
  bool quoted = false;
  bool says_null = false;         ///< empty, and written as "~" or "null"
  std::string text;               ///< of a scalar
  std::vector<std::string> keys;  ///< of a map, one per item
  std::vector<YamlNode> items;    ///< of a list or a map

  /// The value of a map's key; nullptr where there is none.
  const YamlNode* Find(const std::string& key) const;
  YamlNode* Find(const std::string& key);
};

/// What a file says, and the files that it inherits from (job_tree.h).
struct YamlDocument {
  std::vector<std::string> files;  ///< the first is the document's own
  YamlNode root;
};

/// The place of a node, and its dotted path, for a message.
SourceLocation LocationOf(const YamlDocument& document, const YamlNode& node,
                          const std::string& path);

/// Parses one document. @throws InputError for what yaml_reader.h lists.
YamlDocument ParseYamlDocument(const std::string& text,
                               const std::string& file);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_YAML_TREE_H_
