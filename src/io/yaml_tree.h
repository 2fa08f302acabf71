#ifndef ALIDADE_SRC_IO_YAML_TREE_H_
#define ALIDADE_SRC_IO_YAML_TREE_H_

#include <string>
#include <vector>

namespace alidade {

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
  YamlPlace place;      ///< an empty value in a map stands at its key
  YamlPlace key_place;  ///< of a value in a map
  bool quoted = false;
  std::string text;               ///< of a scalar
  std::vector<std::string> keys;  ///< of a map, one per item
  std::vector<YamlNode> items;    ///< of a list or a map
};

struct YamlDocument {
  std::string file;
  YamlNode root;
};

/// Parses one document. @throws InputError for what yaml_reader.h lists.
YamlDocument ParseYamlDocument(const std::string& text,
                               const std::string& file);

}  // namespace alidade

#endif  // ALIDADE_SRC_IO_YAML_TREE_H_
