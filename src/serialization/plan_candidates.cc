#include "src/serialization/plan_candidates.h"

#include "src/dataio/dataset_csv.h"

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

Eigen::MatrixXd ReadJointValues(const YamlValue& value, const Arm& arm,
                                NamedFiles* files) {
  return files->Read(value, [&](const std::string& path) {
    return LoadJointValues(path, arm);
  });
}

std::vector<std::pair<double, double>> ReadJointLimits(const YamlValue& value,
                                                       const Units& units,
                                                       const Arm& arm) {
  const std::vector<YamlValue> items =
      value.List(arm.joints.size(), "[lower, upper] of every joint");
  std::vector<std::pair<double, double>> limits;
  for (int j = 0; j < arm.num_joints(); ++j) {
    const bool turns = arm.joints[j].type == JointType::kRevolute;
    limits.push_back(ReadInterval(
        items[j], turns ? Dimension::kAngle : Dimension::kLength, units));
  }
  return limits;
}

}  // namespace alidade::internal
