#include "src/serialization/arm_json.h"

#include <cstddef>
#include <nlohmann/json.hpp>

#include "alidade/arm_file.h"
#include "src/common/numbers.h"
#include "src/serialization/yaml_tree.h"

namespace alidade::internal {
namespace {

using Json = nlohmann::ordered_json;

Json JsonOf(const YamlNode& node) {
  Json json;
  switch (node.kind) {
    case YamlNode::Kind::kEmpty:
      break;
    case YamlNode::Kind::kScalar:
      if (const auto number = ParseNumber(node.text); number && !node.quoted) {
        return *number;
      }
      return node.text;
    case YamlNode::Kind::kList:
      json = Json::array();
      for (const YamlNode& item : node.items) json.push_back(JsonOf(item));
      break;
    case YamlNode::Kind::kMap:
      json = Json::object();
      for (std::size_t i = 0; i < node.items.size(); ++i) {
        json[node.keys[i]] = JsonOf(node.items[i]);
      }
      break;
  }
  return json;
}

}  // namespace

std::string FormatArmJson(const Arm& arm) {
  return JsonOf(ParseYamlDocument(FormatArm(arm, ""), "arm").root).dump(2) +
         "\n";
}

}  // namespace alidade::internal
