#include "alidade/arm_file.h"

#include <glog/logging.h>

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <initializer_list>
#include <optional>
#include <utility>

#include "src/common/names.h"
#include "src/compensation/dh_conversion.h"
#include "src/dataio/urdf_file.h"
#include "src/model/motors.h"
#include "src/serialization/arm_errors.h"
#include "src/serialization/arm_fields.h"
#include "src/serialization/config_file.h"
#include "src/serialization/robot_files.h"
#include "src/serialization/ur_kinematics.h"

namespace alidade {
namespace internal {

enum class Convention { kKhalil, kCraig, kStandard };

template <>
inline constexpr std::array kWords<Convention> = {
    std::pair{Convention::kKhalil, "khalil"},
    std::pair{Convention::kCraig, "craig"},
    std::pair{Convention::kStandard, "standard"},
};

namespace {

// A joint as its convention's row, with its own part of the motor map.
struct JointEntry {
  Joint joint;
  double sign = 1.0;
  double offset = 0.0;
};

struct TargetEntry {
  std::string name;
  FrameNumbers frame;
};

struct UrdfEntry {
  std::optional<YamlValue> file;
  std::string base_link;
  std::string tip_link;
};

// An arm while it is read.
struct ArmReading {
  NamedFiles* files = nullptr;
  Arm arm = {};
  Convention convention = Convention::kKhalil;
  std::vector<JointEntry> joints = {};
  UrdfEntry urdf = {};
  FrameNumbers base = {};
  FrameNumbers tool = {};
  std::vector<TargetEntry> targets = {};
};

double ReadSign(const YamlValue& value) {
  const double sign = value.Number();
  if (std::abs(sign) != 1.0) {
    value.Fail("expected 1 or -1, found " + value.Text());
  }
  return sign;
}

void ReadLimits(const YamlValue& value, const Units& units, Joint* joint) {
  const std::vector<YamlValue> limits = value.List(2, "lower, upper");
  joint->lower = limits[0].Limit(joint->dimension(), units);
  joint->upper = limits[1].Limit(joint->dimension(), units);
  if (joint->upper < joint->lower) {
    value.Fail("the upper limit " + limits[1].Text() +
               " is below the lower one " + limits[0].Text() +
               ", expected [lower, upper]");
  }
}

// As many columns as the first row has numbers.
void ReadMotorMatrix(const YamlValue& value, const Units& units, Arm* arm) {
  const int n = arm->num_joints();
  const std::vector<YamlValue> rows = value.List(n, "one row per joint");
  const auto m = static_cast<int>(rows[0].List().size());
  if (m < 1 || m > n) {
    rows[0].Fail("expected one number per motor, 1 to " + std::to_string(n) +
                 ", found " + std::to_string(m));
  }
  arm->joints_from_motors.resize(n, m);
  for (int i = 0; i < n; ++i) {
    const std::vector<YamlValue> row = rows[i].List(m, "one entry per motor");
    for (int j = 0; j < m; ++j) {
      arm->joints_from_motors(i, j) = row[j].Number();
    }
  }
  const std::vector<Dimension> motors = MotorDimensions(*arm);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < m; ++j) {
      const Dimension to = arm->joints[i].dimension();
      if (to == motors[j]) continue;
      arm->joints_from_motors(i, j) *=
          units.Of(to).InSi() / units.Of(motors[j]).InSi();
    }
  }
  if (Eigen::FullPivLU<Eigen::MatrixXd>(arm->joints_from_motors).rank() < m) {
    value.Fail(
        "the matrix is singular, expected one whose motors move joints "
        "independently of each other");
  }
}

void RefuseBeside(const YamlMap& map, const char* key,
                  std::initializer_list<const char*> others) {
  const std::optional<YamlValue> value = map.Optional(key);
  for (const char* other : others) {
    if (!value || !map.Optional(other)) continue;
    value->Fail("found beside " + Quote(other) + ", expected one of both");
  }
}

// Of a list that is there.
void CheckCount(const YamlMap& map, const char* key) {
  constexpr std::size_t kMost = kMostJoints;
  const std::optional<YamlValue> list = map.Optional(key);
  const std::size_t count = list ? list->List().size() : 1;
  if (count > 0 && count <= kMost) return;
  list->Fail("expected 1 to " + std::to_string(kMost) + " " + key + ", found " +
             std::to_string(count));
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
  if ((signs.array() != 1.0).any()) {
    arm->joints_from_motors = signs.asDiagonal();
  }
  if ((offsets.array() != 0.0).any()) arm->motor_offsets = offsets;
}

Arm ArmFromRows(const std::vector<JointEntry>& entries, Convention convention) {
  Arm arm;
  std::vector<DhRow> rows;
  for (const auto& [joint, sign, offset] : entries) {
    arm.joints.push_back(joint);
    rows.push_back({joint.type, joint.theta, joint.r, joint.d, joint.alpha,
                    joint.lower, joint.upper});
  }
  if (convention == Convention::kStandard) arm = ArmFromStandardDh(rows);
  SetMotorMap(entries, &arm);
  return arm;
}

Arm ReadChain(const YamlMap& map, const ArmReading& reading) {
  const UrdfEntry& urdf = reading.urdf;
  if (!urdf.file) {
    map.Required("joints");
    CheckCount(map, "joints");
    return ArmFromRows(reading.joints, reading.convention);
  }
  RefuseBeside(map, "urdf", {"joints", "convention"});
  return reading.files->Read(*urdf.file, [&urdf](const std::string& path) {
    return LoadUrdfArm(path, urdf.base_link, urdf.tip_link);
  });
}

void RefuseBothMotorMaps(const YamlMap& map, const Arm& arm) {
  const std::optional<YamlValue> motors = map.Optional("motors");
  if (!motors || !HasMotorMap(arm)) return;
  motors->Fail(
      "expected either this or \"sign\" and \"offset\" of joints, found both");
}

// `tool` is one target without a name. Targets stand after what the standard
// convention leaves after the last joint.
void SetFrames(const YamlMap& map, ArmReading* reading) {
  Arm& arm = reading->arm;
  RefuseBeside(map, "targets", {"tool"});
  CheckCount(map, "targets");
  if (reading->targets.empty()) reading->targets = {{"", reading->tool}};
  arm.instrument_from_base = reading->base.Frame() * arm.instrument_from_base;
  const Eigen::Isometry3d last_from_end = arm.last_from_target();
  arm.targets.clear();
  for (const auto& [name, frame] : reading->targets) {
    arm.targets.push_back({name, last_from_end * frame.Frame()});
  }
}

template <typename Visitor>
void VisitCraig(Visitor& v, Joint& joint) {
  v.Field(AngleKey("theta"), joint.theta, "");
  v.Field(LengthKey("d"), joint.r, "");
  v.Field(LengthKey("a"), joint.d,
          "along x; `craig` and `standard` alone, Khalil's d");
  v.Field(AngleKey("alpha"), joint.alpha, "");
}

template <typename Visitor>
void VisitJoint(Visitor& v, Convention convention, JointEntry& entry) {
  static constexpr char kAsVariable[] =
      "angle (revolute) or length (prismatic)";
  Joint& joint = entry.joint;
  v.Field(Key("type").Named("joint type").Required(), joint.type,
          "`revolute` (turns) or `prismatic` (slides)");
  if (convention != Convention::kKhalil) {
    VisitCraig(v, joint);
  } else {
    VisitKhalil(v, joint);
    if (!Visitor::kReads) {
      v.Field(LengthKey("a"), joint.d,
              "along x; `craig` and `standard` alone, Khalil's d");
    }
  }
  v.Custom(Key("sign").Default("1").Schema(R"({"enum": [1, -1]})"),
           "1 or -1: q = sign * motor + offset",
           [&](const YamlValue& value) { entry.sign = ReadSign(value); });
  v.Custom(Key("offset").In(kAsVariable).Default("0").Schema(kNumberSchema),
           "of the joint value from the motor's",
           [&](const YamlValue& value, const Units& units) {
             entry.offset = value.Quantity(joint.dimension(), units);
           });
  v.Custom(Key("limits").In(kAsVariable).Default("none").Schema(kLimitsSchema),
           "`[lower, upper]` of the joint value; `-.inf` or `.inf` leaves one "
           "end open",
           [&](const YamlValue& value, const Units& units) {
             ReadLimits(value, units, &joint);
           });
}

template <typename Visitor>
void VisitChain(Visitor& v, ArmReading* reading) {
  v.Field(Key("convention"), reading->convention,
          "of the joints: `khalil`, `craig` or `standard`");
  v.Items(Key("joints").Default("required without `urdf`"),
          "1 to 64, from the base to the tool", reading->joints,
          [reading](auto& item, JointEntry& entry) {
            VisitJoint(item, reading->convention, entry);
          });
  v.Section(Key("urdf"),
            "in place of `convention` and `joints`; `base` stands before "
            "`base_link`, `tool` after `tip_link`",
            [reading](auto& section) {
              UrdfEntry& urdf = reading->urdf;
              section.Field(Key("base_link").Required(), urdf.base_link,
                            "where the chain begins");
              section.Field(Key("tip_link").Required(), urdf.tip_link,
                            "where it ends");
              section.Field(Key("file").In("path").Required(), urdf.file,
                            "the URDF");
            });
  v.Check([reading](const YamlMap& map) {
    const std::string name = reading->arm.name;
    reading->arm = ReadChain(map, *reading);
    reading->arm.name = name;
    RefuseBothMotorMaps(map, reading->arm);
  });
}

template <typename Visitor>
void VisitMotors(Visitor& v, Arm* arm) {
  v.Custom(Key("matrix")
               .In("the row's joint's per the column's")
               .Default("identity")
               .Schema(R"({"type": "array", "items": {"type": "array"}})"),
           "n rows of n numbers, not singular; or of fewer, where there are "
           "fewer motors than joints",
           [arm](const YamlValue& value, const Units& units) {
             ReadMotorMatrix(value, units, arm);
           });
  v.Custom(
      Key("offset").In("as the joints").Default("0").Schema(kNumbersSchema),
      "n numbers", [arm](const YamlValue& value, const Units& units) {
        arm->motor_offsets =
            ReadJointQuantities(value, units, *arm, "one per joint");
      });
}

template <typename Visitor>
void VisitArm(Visitor& v, ArmReading* reading) {
  VisitHead(v, FileFormat::kArm);
  v.Field(Key("name").Required(), reading->arm.name, "for people");
  VisitChain(v, reading);
  v.Section(Key("motors"),
            "coupled joints, in place of `sign` and `offset`: q = matrix * "
            "motors + offset",
            [&](auto& section) { VisitMotors(section, &reading->arm); });
  v.Section(Key("errors"),
            "what is not rigid geometry ([error_terms.md](error_terms.md))",
            [&](auto& section) { VisitErrors(section, &reading->arm); });
  v.Section(Key("base"), "the arm's base frame in the instrument's frame",
            [&](auto& section) { VisitFrame(section, reading->base); });
  v.Section(Key("tool"), "the target in the last joint's frame",
            [&](auto& section) { VisitFrame(section, reading->tool); });
  v.Items(Key("targets"),
          "in place of `tool`, where there are several targets or data sets "
          "name one: 1 to 64, in the last joint's frame",
          reading->targets, [reading](auto& item, TargetEntry& target) {
            item.Field(Key("name").Required(), target.name,
                       "as data sets call it; each once");
            VisitFrame(item, target.frame);
            item.Check([&](const YamlMap& map) {
              RefuseRepeatedName(map, target, reading->targets);
            });
          });
  v.Check([reading](const YamlMap& map) { SetFrames(map, reading); });
}

template <typename Visitor>
void VisitDeviations(Visitor& v, const Arm& arm, Eigen::VectorXd* deviations) {
  VisitHead(v, FileFormat::kDeviations);
  v.Custom(
      Key("deviations")
          .In("the parameter's")
          .Required()
          .Schema(
              R"({"type": "object", "additionalProperties": {"type": "number"}})"),
      "map from names of parameters to real value minus nominal value, 0 where "
      "left out: `beta1`, `alpha2`, `d3`, `theta4`, `r5` with the joint's "
      "number; `base_x`, `base_y`, `base_z`, `base_rx`, `base_ry`, `base_rz`; "
      "`tool_...` likewise, and `tool2_...` of the second target",
      [&arm, deviations](const YamlValue& value, const Units& units) {
        *deviations = ReadDeviations(value, units, arm);
      });
}

}  // namespace

std::vector<FieldRecord> ArmFields() {
  ArmReading reading;
  return CollectFields([&](auto& v) { VisitArm(v, &reading); });
}

std::vector<FieldRecord> DeviationsFields() {
  return CollectFields([](auto& v) { VisitDeviations(v, Arm(), nullptr); });
}

namespace {

Arm ReadArm(const YamlValue& root, const std::string& path,
            std::vector<std::string>* input_files) {
  NamedFiles files(path);
  ArmReading reading;
  reading.files = &files;
  const auto visit = [&](auto& v) { VisitArm(v, &reading); };
  ReadFields(root, Units(MapOf(root, visit)), visit);
  input_files->insert(input_files->end(), files.paths().begin() + 1,
                      files.paths().end());
  if (!HasFarNormals(reading.arm)) return std::move(reading.arm);
  LOG(WARNING) << "warning: " << path
               << ": axes are nearly parallel, and their common normals more "
                  "than 10 m away: they are joined by beta instead, which "
                  "gives the same poses; parameters are those of that table";
  return WithoutFarNormals(reading.arm);
}

}  // namespace
}  // namespace internal

namespace {

Arm ParseArm(const std::string& text, const std::string& path,
             std::vector<std::string>* input_files) {
  const internal::YamlValue root = internal::ParseYaml(text, path);
  if (internal::IsUrKinematics(root)) {
    return internal::ReadUrKinematics(root, path);
  }
  internal::RequireFormat(root, internal::FileFormat::kArm);
  return internal::ReadArm(root, path, input_files);
}

}  // namespace

Arm LoadArm(const std::string& file) {
  std::vector<std::string> input_files;
  return LoadArm(file, &input_files);
}

Arm LoadArm(const std::string& file, std::vector<std::string>* input_files) {
  internal::RefuseBareName(file, file, {});
  const std::string path = internal::ArmPath(file, file, {});
  return ParseArm(internal::ReadFile(path), path, input_files);
}

Arm ParseArm(const std::string& text, const std::string& name) {
  std::vector<std::string> input_files;
  return ParseArm(text, name, &input_files);
}

Eigen::VectorXd LoadDeviations(const std::string& path, const Arm& arm) {
  return ParseDeviations(internal::ReadFile(path), path, arm);
}

Eigen::VectorXd ParseDeviations(const std::string& text,
                                const std::string& name, const Arm& arm) {
  Eigen::VectorXd deviations;
  internal::ReadConfig(
      internal::ParseConfig(text, name, internal::FileFormat::kDeviations),
      [&](auto& v) { internal::VisitDeviations(v, arm, &deviations); });
  return deviations;
}

}  // namespace alidade
