#include "alidade/model/parameter_layout.h"

#include <array>
#include <utility>

#include "alidade/model/rotation.h"

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
constexpr int kNumJointFields = static_cast<int>(kJointFields.size());

struct FrameField {
  const char* name;
  ParameterKind translation;
  ParameterKind rotation;
};

constexpr std::array<FrameField, 2> kFrameFields = {{
    {"base", ParameterKind::kBaseTranslation, ParameterKind::kBaseRotation},
    {"tool", ParameterKind::kToolTranslation, ParameterKind::kToolRotation},
}};

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

ParameterLayout::ParameterLayout(int num_joints) : num_joints_(num_joints) {
  for (const JointField& field : kJointFields) {
    blocks_.push_back({field.name, size(), num_joints});
    for (int j = 0; j < num_joints; ++j) {
      parameters_.push_back(
          {field.name + std::to_string(j + 1), field.kind, j, field.dimension});
    }
  }
  const std::array<const char*, 3> axes = {"x", "y", "z"};
  for (const FrameField& field : kFrameFields) {
    blocks_.push_back({field.name, size(), kFrameSize});
    const std::string prefix = std::string(field.name) + "_";
    for (int axis = 0; axis < 3; ++axis) {
      parameters_.push_back(
          {prefix + axes[axis], field.translation, axis, Dimension::kLength});
    }
    for (int axis = 0; axis < 3; ++axis) {
      parameters_.push_back(
          {prefix + "r" + axes[axis], field.rotation, axis, Dimension::kAngle});
    }
  }
}

int ParameterLayout::Column(ParameterKind kind, int index) const {
  for (int f = 0; f < kNumJointFields; ++f) {
    if (kJointFields[f].kind == kind) return f * num_joints_ + index;
  }
  int first = kNumJointFields * num_joints_;
  for (const FrameField& field : kFrameFields) {
    if (field.translation == kind) return first + index;
    if (field.rotation == kind) return first + 3 + index;
    first += kFrameSize;
  }
  return -1;
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
  values.segment<3>(Column(ParameterKind::kToolTranslation, 0)) =
      arm.last_from_target.translation();
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
  arm.last_from_target = MoveFrame(
      nominal.last_from_target,
      values.segment<kFrameSize>(Column(ParameterKind::kToolTranslation, 0)));
  return arm;
}

}  // namespace alidade
