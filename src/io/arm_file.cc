#include "alidade/io/arm_file.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <sstream>

#include "alidade/base/error.h"
#include "alidade/base/units.h"
#include "alidade/model/rotation.h"
#include "src/io/config_file.h"
#include "src/io/names.h"
#include "src/io/numbers.h"
#include "src/io/yaml_reader.h"

namespace alidade {
namespace {

constexpr std::size_t kMaxJoints = 64;

// A joint's numbers: its key in files, what it measures and where it is kept.
struct JointField {
  const char* key;
  Dimension dimension;
  double Joint::*member;
};

constexpr std::array<JointField, 5> kJointFields = {{
    {"beta", Dimension::kAngle, &Joint::beta},
    {"alpha", Dimension::kAngle, &Joint::alpha},
    {"d", Dimension::kLength, &Joint::d},
    {"theta", Dimension::kAngle, &Joint::theta},
    {"r", Dimension::kLength, &Joint::r},
}};

Dimension DimensionOf(JointType type) {
  return type == JointType::kRevolute ? Dimension::kAngle : Dimension::kLength;
}

void ReadQuantity(const YamlMap& map, const std::string& key,
                  Dimension dimension, const Units& units, double* value) {
  const std::optional<YamlValue> found = map.Optional(key);
  if (found) *value = found->Quantity(dimension, units);
}

void ReadLimits(const YamlValue& value, const Units& units, Joint* joint) {
  const std::vector<YamlValue> limits = value.List(2, "lower, upper");
  const Dimension dimension = DimensionOf(joint->type);
  joint->lower = limits[0].Limit(dimension, units);
  joint->upper = limits[1].Limit(dimension, units);
  if (joint->upper < joint->lower) {
    value.Fail("the upper limit " + limits[1].Text() +
               " is below the lower one " + limits[0].Text() +
               ", expected [lower, upper]");
  }
}

Joint ReadJoint(const YamlValue& value, const Units& units) {
  const YamlMap map =
      value.Map({"type", "beta", "alpha", "d", "theta", "r", "limits"});
  Joint joint;
  const std::string type =
      map.Required("type").Choice("joint type", {"revolute", "prismatic"});
  joint.type =
      type == "revolute" ? JointType::kRevolute : JointType::kPrismatic;
  for (const JointField& field : kJointFields) {
    ReadQuantity(map, field.key, field.dimension, units,
                 &(joint.*field.member));
  }
  const std::optional<YamlValue> limits = map.Optional("limits");
  if (limits) ReadLimits(*limits, units, &joint);
  return joint;
}

std::vector<Joint> ReadJoints(const YamlValue& value, const Units& units) {
  const std::vector<YamlValue> items = value.List();
  if (items.empty() || items.size() > kMaxJoints) {
    value.Fail("expected 1 to " + std::to_string(kMaxJoints) +
               " joints, found " + std::to_string(items.size()));
  }
  std::vector<Joint> joints;
  for (const YamlValue& item : items) joints.push_back(ReadJoint(item, units));
  return joints;
}

Eigen::Isometry3d ReadFrame(const YamlMap& file, const std::string& key,
                            const Units& units) {
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  const std::optional<YamlValue> value = file.Optional(key);
  if (!value) return frame;
  const YamlMap map = value->Map({"x", "y", "z", "rx", "ry", "rz"});
  Eigen::Vector3d rotation = Eigen::Vector3d::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    const std::string name = std::string(1, "xyz"[axis]);
    ReadQuantity(map, name, Dimension::kLength, units,
                 &frame.translation()[axis]);
    ReadQuantity(map, "r" + name, Dimension::kAngle, units, &rotation[axis]);
  }
  frame.linear() = RotationFromVector<double>(rotation);
  return frame;
}

// "90 deg", for people.
std::string Readable(double value, Dimension dimension) {
  const bool is_angle = dimension == Dimension::kAngle;
  std::array<char, 64> text;
  std::snprintf(text.data(), text.size(), "%.6g %s",
                value / (is_angle ? kDegree : kMillimetre),
                is_angle ? "deg" : "mm");
  return text.data();
}

std::string FormatLimit(double limit) {
  if (std::isinf(limit)) return limit < 0.0 ? "-.inf" : ".inf";
  return FormatShortest(limit);
}

std::string QuoteYaml(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      std::array<char, 8> escape;
      std::snprintf(escape.data(), escape.size(), "\\x%02x",
                    static_cast<unsigned>(c));
      quoted += escape.data();
    } else {
      if (c == '"' || c == '\\') quoted += '\\';
      quoted += c;
    }
  }
  return quoted + "\"";
}

std::string FormatComment(const std::string& comment) {
  std::string text;
  std::istringstream lines(comment);
  for (std::string line; std::getline(lines, line);) {
    text += line.empty() ? "#\n" : "# " + OneLine(line) + "\n";
  }
  return text;
}

std::string FormatJoint(const Joint& joint, int number) {
  const bool is_revolute = joint.type == JointType::kRevolute;
  std::string text = "  - type: ";
  text += is_revolute ? "revolute" : "prismatic";
  text += "  # joint " + std::to_string(number) + "\n";
  for (const JointField& field : kJointFields) {
    const double value = joint.*field.member;
    text += std::string("    ") + field.key + ": " + FormatShortest(value);
    text += "  # " + Readable(value, field.dimension) + "\n";
  }
  if (std::isinf(joint.lower) && std::isinf(joint.upper)) return text;
  const Dimension dimension = DimensionOf(joint.type);
  return text + "    limits: [" + FormatLimit(joint.lower) + ", " +
         FormatLimit(joint.upper) + "]  # " + Readable(joint.lower, dimension) +
         " to " + Readable(joint.upper, dimension) + "\n";
}

std::string FormatFrame(const std::string& key,
                        const Eigen::Isometry3d& frame) {
  if (frame.matrix() == Eigen::Matrix4d::Identity()) return "";
  std::string text = key + ":\n";
  const Eigen::Vector3d rotation = VectorFromRotation(frame.linear());
  for (int axis = 0; axis < 3; ++axis) {
    const double value = frame.translation()[axis];
    text += std::string("  ") + "xyz"[axis] + ": " + FormatShortest(value) +
            "  # " + Readable(value, Dimension::kLength) + "\n";
  }
  for (int axis = 0; axis < 3; ++axis) {
    text += std::string("  r") + "xyz"[axis] + ": " +
            FormatShortest(rotation[axis]) + "  # " +
            Readable(rotation[axis], Dimension::kAngle) + "\n";
  }
  return text;
}

}  // namespace

Arm LoadArm(const std::string& path) {
  const YamlMap map =
      ReadConfigFile(path, FileFormat::kArm)
          .Map({"format", "name", "units", "joints", "base", "tool"});
  const Units units(map);
  Arm arm;
  arm.name = map.Required("name").Text();
  arm.joints = ReadJoints(map.Required("joints"), units);
  arm.instrument_from_base = ReadFrame(map, "base", units);
  arm.last_from_target = ReadFrame(map, "tool", units);
  return arm;
}

std::string FormatArm(const Arm& arm, const std::string& comment) {
  std::string text = FormatComment(comment) +
                     "format: alidade-arm-1\n"
                     "name: " +
                     QuoteYaml(arm.name) +
                     "\n"
                     "units: {length: m, angle: rad}\n"
                     "joints:\n";
  int number = 0;
  for (const Joint& joint : arm.joints) text += FormatJoint(joint, ++number);
  return text + FormatFrame("base", arm.instrument_from_base) +
         FormatFrame("tool", arm.last_from_target);
}

Eigen::VectorXd LoadDeviations(const std::string& path, const Arm& arm) {
  const YamlMap map = ReadConfigFile(path, FileFormat::kDeviations)
                          .Map({"format", "units", "deviations"});
  return ReadDeviations(map.Required("deviations"), Units(map), arm);
}

}  // namespace alidade
