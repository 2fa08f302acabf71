#include "src/serialization/plan_candidates.h"

namespace alidade::internal {

void RefuseEmptyList(const YamlMap& map, const std::string& key) {
  const std::optional<YamlValue> list = map.Optional(key);
  if (list && list->List().empty()) {
    list->Fail("the list is empty, expected " + key);
  }
}

void RefuseDrawing(const YamlMap& map) {
  if (!map.Optional("file")) return;
  for (const char* key : {"count", "limit_faces", "joint_decimals"}) {
    if (const auto other = map.Optional(key)) {
      other->Fail("found beside \"file\", expected candidates drawn or read");
    }
  }
}

std::vector<std::pair<double, double>> ReadJointLimits(const YamlValue& value,
                                                       const Units& units,
                                                       const Arm& arm) {
  const std::vector<YamlValue> items =
      value.List(arm.joints.size(), "[lower, upper] of every joint");
  std::vector<std::pair<double, double>> limits;
  for (int j = 0; j < arm.num_joints(); ++j) {
    limits.push_back(ReadInterval(items[j], arm.joints[j].dimension(), units));
  }
  return limits;
}

}  // namespace alidade::internal
