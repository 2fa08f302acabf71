#include "alidade/arm_file.h"

#include <glog/logging.h>

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <cstdio>
#include <sstream>
#include <utility>

#include "alidade/error.h"
#include "alidade/rotation.h"
#include "alidade/units.h"
#include "src/common/files.h"
#include "src/common/names.h"
#include "src/common/numbers.h"
#include "src/common/text.h"
#include "src/compensation/dh_conversion.h"
#include "src/dataio/urdf_file.h"
#include "src/serialization/config_file.h"
#include "src/serialization/yaml_reader.h"

namespace alidade {

using internal::ArmFromChain;
using internal::ArmFromStandardDh;
using internal::DhRow;
using internal::FileFormat;
using internal::LoadUrdfChain;
using internal::NamedFiles;
using internal::OneLine;
using internal::Quote;
using internal::ReadConfigFile;
using internal::ReadDeviations;
using internal::ReadJointQuantities;
using internal::ShortestNumber;
using internal::Unit;
using internal::Units;
using internal::YamlMap;
using internal::YamlValue;

namespace {

constexpr std::size_t kMaxJoints = 64;
constexpr std::size_t kMaxTargets = 64;

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

void ReadQuantity(const YamlMap& map, const std::string& key,
                  Dimension dimension, const Units& units, double* value) {
  const std::optional<YamlValue> found = map.Optional(key);
  if (found) *value = found->Quantity(dimension, units);
}

void ReadLimits(const YamlValue& value, const Units& units, Joint* joint) {
  const std::vector<YamlValue> limits = value.List(2, "lower, upper");
  const Dimension dimension = joint->dimension();
  joint->lower = limits[0].Limit(dimension, units);
  joint->upper = limits[1].Limit(dimension, units);
  if (joint->upper < joint->lower) {
    value.Fail("the upper limit " + limits[1].Text() +
               " is below the lower one " + limits[0].Text() +
               ", expected [lower, upper]");
  }
}

// The keys of a joint's numbers in a convention. Craig and the standard one
// call Khalil's d "a" and his r "d".
std::vector<JointField> FieldsOf(const std::string& convention) {
  if (convention == "khalil") return {kJointFields.begin(), kJointFields.end()};
  return {{"theta", Dimension::kAngle, &Joint::theta},
          {"d", Dimension::kLength, &Joint::r},
          {"a", Dimension::kLength, &Joint::d},
          {"alpha", Dimension::kAngle, &Joint::alpha}};
}

double ReadSign(const YamlValue& value) {
  const double sign = value.Number();
  if (std::abs(sign) != 1.0) {
    value.Fail("expected 1 or -1, found " + value.Text());
  }
  return sign;
}

// A joint as its convention's row, with its own part of the motor map.
struct JointEntry {
  Joint joint;
  double sign = 1.0;
  double offset = 0.0;
};

JointEntry ReadJoint(const YamlValue& value, const std::string& convention,
                     const Units& units) {
  const std::vector<JointField> fields = FieldsOf(convention);
  std::vector<std::string> keys = {"type"};
  for (const JointField& field : fields) keys.emplace_back(field.key);
  keys.insert(keys.end(), {"sign", "offset", "limits"});
  const YamlMap map = value.Map(keys);
  JointEntry entry;
  Joint& joint = entry.joint;
  const std::string type =
      map.Required("type").Choice("joint type", {"revolute", "prismatic"});
  joint.type =
      type == "revolute" ? JointType::kRevolute : JointType::kPrismatic;
  for (const JointField& field : fields) {
    ReadQuantity(map, field.key, field.dimension, units,
                 &(joint.*field.member));
  }
  const std::optional<YamlValue> sign = map.Optional("sign");
  if (sign) entry.sign = ReadSign(*sign);
  ReadQuantity(map, "offset", joint.dimension(), units, &entry.offset);
  const std::optional<YamlValue> limits = map.Optional("limits");
  if (limits) ReadLimits(*limits, units, &joint);
  return entry;
}

std::vector<JointEntry> ReadJoints(const YamlValue& value,
                                   const std::string& convention,
                                   const Units& units) {
  const std::vector<YamlValue> items = value.List();
  if (items.empty() || items.size() > kMaxJoints) {
    value.Fail("expected 1 to " + std::to_string(kMaxJoints) +
               " joints, found " + std::to_string(items.size()));
  }
  std::vector<JointEntry> entries;
  for (const YamlValue& item : items) {
    entries.push_back(ReadJoint(item, convention, units));
  }
  return entries;
}

Arm ArmFromEntries(const std::vector<JointEntry>& entries,
                   const std::string& convention) {
  Arm arm;
  if (convention != "standard") {
    for (const JointEntry& entry : entries) arm.joints.push_back(entry.joint);
    return arm;
  }
  std::vector<DhRow> rows;
  for (const auto& [joint, sign, offset] : entries) {
    rows.push_back({joint.type, joint.theta, joint.r, joint.d, joint.alpha,
                    joint.lower, joint.upper});
  }
  return ArmFromStandardDh(rows);
}

// The map stays empty where no joint has a sign or an offset.
void SetMotorMap(const std::vector<JointEntry>& entries, Arm* arm) {
  const int n = arm->num_joints();
  Eigen::VectorXd signs(n);
  Eigen::VectorXd offsets(n);
  for (int j = 0; j < n; ++j) {
    signs[j] = entries[j].sign;
    offsets[j] = entries[j].offset;
  }
  if ((signs.array() != 1.0).any())
    arm->joints_from_motors = signs.asDiagonal();
  if ((offsets.array() != 0.0).any()) arm->motor_offsets = offsets;
}

void ReadMotorMatrix(const YamlValue& value, const Units& units, Arm* arm) {
  const int n = arm->num_joints();
  arm->joints_from_motors.resize(n, n);
  const std::vector<YamlValue> rows = value.List(n, "one row per joint");
  for (int i = 0; i < n; ++i) {
    const std::vector<YamlValue> row = rows[i].List(n, "one entry per motor");
    for (int j = 0; j < n; ++j) {
      const Dimension to = arm->joints[i].dimension();
      const Dimension from = arm->joints[j].dimension();
      double entry = row[j].Number();
      if (to != from) entry *= units.Of(to).InSi() / units.Of(from).InSi();
      arm->joints_from_motors(i, j) = entry;
    }
  }
  if (!Eigen::FullPivLU<Eigen::MatrixXd>(arm->joints_from_motors)
           .isInvertible()) {
    value.Fail(
        "the matrix is singular, expected one by which every joint can be "
        "moved alone");
  }
}

void ReadMotors(const YamlValue& value, const Units& units, Arm* arm) {
  if (arm->joints_from_motors.size() > 0 || arm->motor_offsets.size() > 0) {
    value.Fail(
        "expected either this or \"sign\" and \"offset\" of joints, found "
        "both");
  }
  const YamlMap map = value.Map({"matrix", "offset"});
  const std::optional<YamlValue> matrix = map.Optional("matrix");
  if (matrix) ReadMotorMatrix(*matrix, units, arm);
  const std::optional<YamlValue> offset = map.Optional("offset");
  if (!offset) return;
  arm->motor_offsets =
      ReadJointQuantities(*offset, units, *arm, "one per joint");
}

Eigen::Isometry3d FrameOf(const YamlMap& map, const Units& units) {
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
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

Eigen::Isometry3d ReadFrame(const YamlMap& file, const std::string& key,
                            const Units& units) {
  const std::optional<YamlValue> value = file.Optional(key);
  if (!value) return Eigen::Isometry3d::Identity();
  return FrameOf(value->Map({"x", "y", "z", "rx", "ry", "rz"}), units);
}

std::vector<Target> ReadTargetList(const YamlValue& value, const Units& units) {
  std::vector<Target> targets;
  for (const YamlValue& item : value.List()) {
    const YamlMap map = item.Map({"name", "x", "y", "z", "rx", "ry", "rz"});
    const YamlValue name = map.Required("name");
    Target target{name.Text(), FrameOf(map, units)};
    for (const Target& other : targets) {
      if (other.name != target.name) continue;
      name.Fail(Quote(target.name) +
                " is repeated, expected another name for each target");
    }
    targets.push_back(std::move(target));
  }
  if (targets.empty() || targets.size() > kMaxTargets) {
    value.Fail("expected 1 to " + std::to_string(kMaxTargets) +
               " targets, found " + std::to_string(targets.size()));
  }
  return targets;
}

// `tool` is one target without a name.
std::vector<Target> ReadTargets(const YamlMap& file, const Units& units) {
  const std::optional<YamlValue> list = file.Optional("targets");
  if (!list) return {{"", ReadFrame(file, "tool", units)}};
  if (file.Optional("tool")) {
    list->Fail("found beside \"tool\", expected one of both");
  }
  return ReadTargetList(*list, units);
}

Arm ReadRows(const YamlMap& map, const Units& units) {
  std::string convention = "khalil";
  const std::optional<YamlValue> named = map.Optional("convention");
  if (named) {
    convention = named->Choice("convention", {"khalil", "craig", "standard"});
  }
  const std::vector<JointEntry> entries =
      ReadJoints(map.Required("joints"), convention, units);
  Arm arm = ArmFromEntries(entries, convention);
  SetMotorMap(entries, &arm);
  return arm;
}

Arm ReadUrdf(const YamlValue& value, const YamlMap& file, NamedFiles* files) {
  for (const char* key : {"joints", "convention"}) {
    if (file.Optional(key)) {
      value.Fail(std::string("found beside \"") + key +
                 "\", expected one of both");
    }
  }
  const YamlMap map = value.Map({"file", "base_link", "tip_link"});
  const std::string base_link = map.Required("base_link").Text();
  const std::string tip_link = map.Required("tip_link").Text();
  return files->Read(map.Required("file"), [&](const std::string& path) {
    return ArmFromChain(LoadUrdfChain(path, base_link, tip_link));
  });
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
  return ShortestNumber(limit);
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
    text += std::string("    ") + field.key + ": " + ShortestNumber(value);
    text += "  # " + Readable(value, field.dimension) + "\n";
  }
  if (std::isinf(joint.lower) && std::isinf(joint.upper)) return text;
  const Dimension dimension = joint.dimension();
  return text + "    limits: [" + FormatLimit(joint.lower) + ", " +
         FormatLimit(joint.upper) + "]  # " + Readable(joint.lower, dimension) +
         " to " + Readable(joint.upper, dimension) + "\n";
}

std::string FormatRow(const Eigen::VectorXd& values) {
  std::string text;
  for (const double value : values) {
    text += (text.empty() ? "[" : ", ") + ShortestNumber(value);
  }
  return text + "]";
}

std::string FormatMotors(const Arm& arm) {
  std::string text;
  if (arm.joints_from_motors.size() > 0) {
    text += "  matrix:\n";
    for (const auto& row : arm.joints_from_motors.rowwise()) {
      text += "    - " + FormatRow(row.transpose()) + "\n";
    }
  }
  if (arm.motor_offsets.size() > 0) {
    text += "  offset: " + FormatRow(arm.motor_offsets) + "\n";
  }
  return text.empty() ? text : "motors:\n" + text;
}

// A frame's numbers, each line after `indent`.
std::string FormatFrameNumbers(const std::string& indent,
                               const Eigen::Isometry3d& frame) {
  std::string text;
  const Eigen::Vector3d rotation = VectorFromRotation(frame.linear());
  for (int axis = 0; axis < 3; ++axis) {
    const double value = frame.translation()[axis];
    text += indent + "xyz"[axis] + ": " + ShortestNumber(value) + "  # " +
            Readable(value, Dimension::kLength) + "\n";
  }
  for (int axis = 0; axis < 3; ++axis) {
    text += indent + "r" + "xyz"[axis] + ": " + ShortestNumber(rotation[axis]) +
            "  # " + Readable(rotation[axis], Dimension::kAngle) + "\n";
  }
  return text;
}

std::string FormatFrame(const std::string& key,
                        const Eigen::Isometry3d& frame) {
  if (frame.matrix() == Eigen::Matrix4d::Identity()) return "";
  return key + ":\n" + FormatFrameNumbers("  ", frame);
}

std::string FormatTargets(const Arm& arm) {
  if (arm.num_targets() == 1 && arm.targets[0].name.empty()) {
    return FormatFrame("tool", arm.last_from_target());
  }
  std::string text = "targets:\n";
  for (const Target& target : arm.targets) {
    text += "  - name: " + QuoteYaml(target.name) + "\n" +
            FormatFrameNumbers("    ", target.last_from_target);
  }
  return text;
}

}  // namespace

Arm LoadArm(const std::string& path) {
  std::vector<std::string> input_files;
  return LoadArm(path, &input_files);
}

Arm LoadArm(const std::string& path, std::vector<std::string>* input_files) {
  const YamlMap map =
      ReadConfigFile(path, FileFormat::kArm)
          .Map({"format", "name", "units", "convention", "joints", "urdf",
                "motors", "base", "tool", "targets"});
  NamedFiles files(path);
  const Units units(map);
  const std::string name = map.Required("name").Text();
  const std::optional<YamlValue> urdf = map.Optional("urdf");
  Arm arm = urdf ? ReadUrdf(*urdf, map, &files) : ReadRows(map, units);
  arm.name = name;
  const std::optional<YamlValue> motors = map.Optional("motors");
  if (motors) ReadMotors(*motors, units, &arm);
  arm.instrument_from_base =
      ReadFrame(map, "base", units) * arm.instrument_from_base;
  // Behind what the standard convention leaves after the last joint.
  const Eigen::Isometry3d last_from_end = arm.last_from_target();
  arm.targets = ReadTargets(map, units);
  for (Target& target : arm.targets) {
    target.last_from_target = last_from_end * target.last_from_target;
  }
  input_files->insert(input_files->end(), files.paths().begin() + 1,
                      files.paths().end());
  if (!internal::HasFarNormals(arm)) return arm;
  LOG(WARNING) << "warning: " << path
               << ": axes are nearly parallel, and their common normals more "
                  "than 10 m away: they are joined by beta instead, which "
                  "gives the same poses; parameters are those of that table";
  return internal::WithoutFarNormals(arm);
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
  return text + FormatMotors(arm) +
         FormatFrame("base", arm.instrument_from_base) + FormatTargets(arm);
}

Eigen::VectorXd LoadDeviations(const std::string& path, const Arm& arm) {
  const YamlMap map = ReadConfigFile(path, FileFormat::kDeviations)
                          .Map({"format", "units", "deviations"});
  return ReadDeviations(map.Required("deviations"), Units(map), arm);
}

}  // namespace alidade
