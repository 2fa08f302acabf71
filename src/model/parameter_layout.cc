#include "alidade/parameter_layout.h"

#include <array>
#include <utility>

#include "alidade/rotation.h"

namespace alidade {
namespace {

struct JointField {
  ParameterKind kind;
  const char* name;
  Dimension dimension;
  double Joint::*member;
};

constexpr std::array<JointField, 5> kJointFields = {{
    {ParameterKind::kBeta, "beta", Dimension::kAngle, &Joint::beta},
    {ParameterKind::kAlpha, "alpha", Dimension::kAngle, &Joint::alpha},
    {ParameterKind::kD, "d", Dimension::kLength, &Joint::d},
    {ParameterKind::kTheta, "theta", Dimension::kAngle, &Joint::theta},
    {ParameterKind::kR, "r", Dimension::kLength, &Joint::r},
}};

constexpr int kFrameSize = 6;
constexpr int kPointSize = 3;
constexpr int kPlaneSize = 3;
constexpr int kNumJointFields = static_cast<int>(kJointFields.size());

constexpr std::array<const char*, 3> kAxes = {"x", "y", "z"};

// "tool", "tool2", "tool3".
std::string TargetBlock(int target) {
  return target == 0 ? "tool" : "tool" + std::to_string(target + 1);
}

Eigen::Isometry3d MoveFrame(const Eigen::Isometry3d& nominal,
                            const Eigen::Matrix<double, 6, 1>& values) {
  Eigen::Isometry3d moved = nominal;
  moved.translation() = values.head<3>();
  const Eigen::Vector3d rotation = values.tail<3>();
  if (!rotation.isZero(0.0)) {
    moved.linear() = RotationFromVector<double>(rotation) * nominal.linear();
  }
  return moved;
}

}  // namespace

ParameterLayout::ParameterLayout(const LayoutShape& shape) : shape_(shape) {
  for (const JointField& field : kJointFields) {
    blocks_.push_back({field.name, size(), shape.num_joints});
    for (int j = 0; j < shape.num_joints; ++j) {
      parameters_.push_back(
          {field.name + std::to_string(j + 1), field.kind, j, field.dimension});
    }
  }
  AddFrame("base", ParameterKind::kBaseTranslation,
           ParameterKind::kBaseRotation, 0);
  for (int target = 0; target < shape.num_targets; ++target) {
    AddFrame(TargetBlock(target), ParameterKind::kToolTranslation,
             ParameterKind::kToolRotation, target);
  }
  for (int point = 0; point < shape.num_points; ++point) AddPoint(point);
  for (int plane = 0; plane < shape.num_planes; ++plane) AddPlane(plane);
}

void ParameterLayout::AddFrame(const std::string& name,
                               ParameterKind translation,
                               ParameterKind rotation, int object) {
  blocks_.push_back({name, size(), kFrameSize});
  for (int axis = 0; axis < 3; ++axis) {
    parameters_.push_back({name + "_" + kAxes[axis], translation, axis,
                           Dimension::kLength, object});
  }
  for (int axis = 0; axis < 3; ++axis) {
    parameters_.push_back(
        {name + "_r" + kAxes[axis], rotation, axis, Dimension::kAngle, object});
  }
}

void ParameterLayout::AddPoint(int object) {
  const std::string name = "point" + std::to_string(object + 1);
  blocks_.push_back({name, size(), kPointSize});
  for (int axis = 0; axis < 3; ++axis) {
    parameters_.push_back({name + "_" + kAxes[axis], ParameterKind::kPoint,
                           axis, Dimension::kLength, object});
  }
}

void ParameterLayout::AddPlane(int object) {
  const std::string name = "plane" + std::to_string(object + 1);
  blocks_.push_back({name, size(), kPlaneSize});
  parameters_.push_back(
      {name + "_u", ParameterKind::kPlaneTilt, 0, Dimension::kAngle, object});
  parameters_.push_back(
      {name + "_v", ParameterKind::kPlaneTilt, 1, Dimension::kAngle, object});
  parameters_.push_back({name + "_c", ParameterKind::kPlaneOffset, 0,
                         Dimension::kLength, object});
}

int ParameterLayout::Column(ParameterKind kind, int index, int object) const {
  for (int f = 0; f < kNumJointFields; ++f) {
    if (kJointFields[f].kind == kind) return f * shape_.num_joints + index;
  }
  const int base = kNumJointFields * shape_.num_joints;
  const int tool = base + kFrameSize * (1 + object);
  const int points = base + kFrameSize * (1 + shape_.num_targets);
  const int plane =
      points + kPointSize * shape_.num_points + kPlaneSize * object;
  switch (kind) {
    case ParameterKind::kBaseTranslation:
      return base + index;
    case ParameterKind::kBaseRotation:
      return base + 3 + index;
    case ParameterKind::kToolTranslation:
      return tool + index;
    case ParameterKind::kToolRotation:
      return tool + 3 + index;
    case ParameterKind::kPoint:
      return points + kPointSize * object + index;
    case ParameterKind::kPlaneTilt:
      return plane + index;
    case ParameterKind::kPlaneOffset:
      return plane + 2;
    default:
      return -1;
  }
}

std::optional<int> ParameterLayout::Find(std::string_view name) const {
  for (int column = 0; column < size(); ++column) {
    if (parameters_[column].name == name) return column;
  }
  return std::nullopt;
}

bool ParameterLayout::IsJointKind(ParameterKind kind) {
  for (const JointField& field : kJointFields) {
    if (field.kind == kind) return true;
  }
  return false;
}

bool ParameterLayout::IsReferenceKind(ParameterKind kind) {
  return kind == ParameterKind::kPoint || kind == ParameterKind::kPlaneTilt ||
         kind == ParameterKind::kPlaneOffset;
}

Eigen::VectorXd ParameterLayout::Values(const Arm& arm) const {
  Eigen::VectorXd values = Eigen::VectorXd::Zero(size());
  int column = 0;
  for (const JointField& field : kJointFields) {
    for (const Joint& joint : arm.joints) {
      values[column++] = joint.*field.member;
    }
  }
  values.segment<3>(Column(ParameterKind::kBaseTranslation, 0)) =
      arm.instrument_from_base.translation();
  for (int target = 0; target < shape_.num_targets; ++target) {
    values.segment<3>(Column(ParameterKind::kToolTranslation, 0, target)) =
        arm.last_from_target(target).translation();
  }
  return values;
}

Arm ParameterLayout::WithValues(const Arm& nominal,
                                const Eigen::VectorXd& values) const {
  Arm arm = nominal;
  int column = 0;
  for (const JointField& field : kJointFields) {
    for (Joint& joint : arm.joints) joint.*field.member = values[column++];
  }
  arm.instrument_from_base = MoveFrame(
      nominal.instrument_from_base,
      values.segment<kFrameSize>(Column(ParameterKind::kBaseTranslation, 0)));
  for (int target = 0; target < shape_.num_targets; ++target) {
    arm.last_from_target(target) =
        MoveFrame(nominal.last_from_target(target),
                  values.segment<kFrameSize>(
                      Column(ParameterKind::kToolTranslation, 0, target)));
  }
  return arm;
}

}  // namespace alidade
