#include "src/serialization/plan_candidates.h"

#include <cmath>
#include <limits>
#include <string>

#include "src/dataio/dataset_csv.h"
#include "src/serialization/yaml_reader.h"

namespace alidade::internal {
namespace {

constexpr std::int64_t kMaxCandidates = 1000000;
constexpr std::int64_t kMaxRegion = 10000;
constexpr int kMaxJointDecimals = 12;

Eigen::Vector3d ReadPoint(const YamlValue& value, const Units& units) {
  const std::vector<YamlValue> items = value.List(3, "x, y, z");
  Eigen::Vector3d point;
  for (int axis = 0; axis < 3; ++axis) {
    point[axis] = items[axis].Quantity(Dimension::kLength, units);
  }
  return point;
}

Eigen::Vector3d ReadDirection(const YamlValue& value) {
  const std::vector<YamlValue> items = value.List(3, "x, y, z of a direction");
  Eigen::Vector3d direction;
  for (int axis = 0; axis < 3; ++axis) direction[axis] = items[axis].Number();
  if (!(direction.norm() > 0.0)) {
    value.Fail("expected a direction other than [0, 0, 0]");
  }
  return direction.normalized();
}

std::pair<double, double> ReadInterval(const YamlValue& value,
                                       Dimension dimension,
                                       const Units& units) {
  const std::vector<YamlValue> ends = value.List(2, "lower, upper");
  const double lower = ends[0].Quantity(dimension, units);
  const double upper = ends[1].Quantity(dimension, units);
  if (lower > upper) {
    value.Fail("expected [lower, upper] with lower not above upper, found [" +
               ends[0].Text() + ", " + ends[1].Text() + "]");
  }
  return {lower, upper};
}

std::vector<WorkspaceBox> ReadBoxes(const YamlMap& map, const Units& units) {
  std::vector<WorkspaceBox> boxes;
  const std::optional<YamlValue> value = map.Optional("boxes");
  if (!value) return boxes;
  for (const YamlValue& item : value->List()) {
    const YamlMap sides = item.Map({"x", "y", "z"});
    WorkspaceBox box;
    int axis = 0;
    for (const char* key : {"x", "y", "z"}) {
      const auto [lower, upper] =
          ReadInterval(sides.Required(key), Dimension::kLength, units);
      box.lower[axis] = lower;
      box.upper[axis++] = upper;
    }
    boxes.push_back(box);
  }
  if (boxes.empty()) value->Fail("the list is empty, expected boxes");
  return boxes;
}

double ReadMargin(const YamlMap& map, const Units& units) {
  const std::optional<YamlValue> margin = map.Optional("margin");
  if (!margin) return 0.0;
  const double length = margin->Quantity(Dimension::kLength, units);
  if (length < 0.0) {
    margin->Fail("expected a length not below zero, found " + margin->Text());
  }
  return length;
}

void ReadHalfSpaces(const YamlMap& map, const Units& units,
                    PoseConstraints* constraints) {
  if (const auto floor = map.Optional("floor")) {
    const YamlMap entry = floor->Map({"height", "margin"});
    HalfSpace half_space;
    half_space.offset =
        entry.Required("height").Quantity(Dimension::kLength, units);
    half_space.margin = ReadMargin(entry, units);
    constraints->half_spaces.push_back(half_space);
  }
  const std::optional<YamlValue> walls = map.Optional("walls");
  if (!walls) return;
  for (const YamlValue& item : walls->List()) {
    const YamlMap entry = item.Map({"normal", "point", "margin"});
    HalfSpace half_space;
    half_space.normal = ReadDirection(entry.Required("normal"));
    half_space.offset =
        half_space.normal.dot(ReadPoint(entry.Required("point"), units));
    half_space.margin = ReadMargin(entry, units);
    constraints->half_spaces.push_back(half_space);
  }
}

void ReadVisibility(const YamlMap& map, const Units& units,
                    PoseConstraints* constraints) {
  const std::optional<YamlValue> value = map.Optional("visibility");
  if (!value) return;
  const YamlMap entry = value->Map({"instrument", "axis", "angle"});
  Visibility visibility;
  visibility.instrument = ReadPoint(entry.Required("instrument"), units);
  if (const auto axis = entry.Optional("axis")) {
    visibility.axis = ReadDirection(*axis);
  }
  const YamlValue angle = entry.Required("angle");
  visibility.angle = PositiveAngle(angle, units);
  if (visibility.angle > kPi) {
    angle.Fail("expected an angle of at most 180 degrees, found " +
               angle.Text());
  }
  constraints->visibility = visibility;
}

void ReadDrawing(const YamlMap& map, PlanConfig* plan) {
  CandidateOptions& options = plan->candidates;
  if (const auto count = map.Optional("count")) {
    options.count = static_cast<int>(count->Integer(1, kMaxCandidates));
  }
  map.ReadBoolean("limit_faces", &options.limit_faces);
  if (const auto decimals = map.Optional("joint_decimals")) {
    options.joint_decimals =
        static_cast<int>(decimals->Integer(0, kMaxJointDecimals));
  }
}

void ReadGiven(const YamlValue& file, const YamlMap& map, JobContext* context,
               PlanConfig* plan) {
  for (const char* key : {"count", "limit_faces", "joint_decimals"}) {
    if (const auto other = map.Optional(key)) {
      other->Fail("found beside \"file\", expected candidates drawn or read");
    }
  }
  plan->given_candidates =
      context->files.Read(file, [&](const std::string& path) {
        return LoadJointValues(path, plan->job.arm);
      });
}

}  // namespace

void ReadPlanCandidates(JobContext* context, PlanConfig* plan) {
  const std::optional<YamlValue> value = context->file.Optional("candidates");
  if (!value) return;
  const YamlMap map =
      value->Map({"count", "limit_faces", "joint_decimals", "file", "boxes",
                  "floor", "walls", "visibility"});
  if (const auto file = map.Optional("file")) {
    ReadGiven(*file, map, context, plan);
  } else {
    ReadDrawing(map, plan);
  }
  plan->constraints.boxes = ReadBoxes(map, context->units);
  ReadHalfSpaces(map, context->units, &plan->constraints);
  ReadVisibility(map, context->units, &plan->constraints);
}

void ReadPlanRegion(const JobContext& context, PlanConfig* plan) {
  const std::optional<YamlValue> value = context.file.Optional("region");
  if (!value) return;
  const YamlMap map = value->Map({"joints", "boxes", "count"});
  const Arm& arm = plan->job.arm;
  if (const auto joints = map.Optional("joints")) {
    const std::vector<YamlValue> items =
        joints->List(arm.joints.size(), "[lower, upper] of every joint");
    for (int j = 0; j < arm.num_joints(); ++j) {
      const bool turns = arm.joints[j].type == JointType::kRevolute;
      plan->region.joint_limits.push_back(
          ReadInterval(items[j], turns ? Dimension::kAngle : Dimension::kLength,
                       context.units));
    }
  }
  plan->region.boxes = ReadBoxes(map, context.units);
  if (const auto count = map.Optional("count")) {
    plan->region.count = static_cast<int>(count->Integer(1, kMaxRegion));
  }
}

}  // namespace alidade::internal
