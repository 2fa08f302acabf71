#include "src/kernel/kernel_constants.h"

#include <cmath>

#include "alidade/rotation.h"
#include "src/data/tilted_normal.h"

namespace alidade::internal::kernel {
namespace {

JointConstants ConstantsOf(const Joint& joint) {
  JointConstants constants;
  constants.is_revolute = joint.type == JointType::kRevolute;
  constants.sin_beta = std::sin(joint.beta);
  constants.cos_beta = std::cos(joint.beta);
  constants.sin_alpha = std::sin(joint.alpha);
  constants.cos_alpha = std::cos(joint.alpha);
  constants.sin_theta = std::sin(joint.theta);
  constants.cos_theta = std::cos(joint.theta);
  constants.d = joint.d;
  constants.r = joint.r;
  return constants;
}

// With l = |n0 + u t1 + v t2|: dn/du = (t1 - n (n . t1)) / l.
PlaneConstants ConstantsOf(const ReferencePlane& nominal, const double* uvc) {
  PlaneConstants constants;
  constants.normal = TiltedNormal<double>(nominal.normal, uvc);
  constants.offset = uvc[2];
  std::array<Eigen::Vector3d, 2> tangents;
  TangentBasis(nominal.normal, &tangents[0], &tangents[1]);
  const double length = std::sqrt(1.0 + uvc[0] * uvc[0] + uvc[1] * uvc[1]);
  const Eigen::Vector3d& n = constants.normal;
  for (int k = 0; k < 2; ++k) {
    constants.normal_by_tilt[k] =
        (tangents[k] - n * n.dot(tangents[k])) / length;
  }
  return constants;
}

int* EntryOf(ParameterKind kind, Columns::OfJoint* joint) {
  switch (kind) {
    case ParameterKind::kBeta:
      return &joint->beta;
    case ParameterKind::kAlpha:
      return &joint->alpha;
    case ParameterKind::kD:
      return &joint->d;
    case ParameterKind::kTheta:
      return &joint->theta;
    default:
      return &joint->r;
  }
}

}  // namespace

void ComputeConstants(const Arm& nominal, const References& references,
                      const ParameterLayout& layout,
                      const Eigen::VectorXd& values, Constants* constants) {
  const auto vector = [&](ParameterKind kind, int object) {
    return Eigen::Vector3d(values.segment<3>(layout.Column(kind, 0, object)));
  };
  constants->base_translation = vector(ParameterKind::kBaseTranslation, 0);
  const Eigen::Vector3d base_turn = vector(ParameterKind::kBaseRotation, 0);
  constants->base_rotation = RotationFromVector<double>(base_turn) *
                             nominal.instrument_from_base.linear();
  constants->base_axes = LeftJacobianOfRotation(base_turn);
  constants->joints.resize(nominal.num_joints());
  for (int j = 0; j < nominal.num_joints(); ++j) {
    const auto value = [&](ParameterKind kind) {
      return values[layout.Column(kind, j)];
    };
    Joint joint;
    joint.type = nominal.joints[j].type;
    joint.beta = value(ParameterKind::kBeta);
    joint.alpha = value(ParameterKind::kAlpha);
    joint.d = value(ParameterKind::kD);
    joint.theta = value(ParameterKind::kTheta);
    joint.r = value(ParameterKind::kR);
    constants->joints[j] = ConstantsOf(joint);
  }
  constants->targets.resize(nominal.num_targets());
  for (int k = 0; k < nominal.num_targets(); ++k) {
    TargetConstants& target = constants->targets[k];
    const Eigen::Vector3d turn = vector(ParameterKind::kToolRotation, k);
    target.translation = vector(ParameterKind::kToolTranslation, k);
    target.rotation =
        RotationFromVector<double>(turn) * nominal.last_from_target(k).linear();
    target.axes = LeftJacobianOfRotation(turn);
  }
  constants->points.resize(references.num_points());
  for (int k = 0; k < references.num_points(); ++k) {
    constants->points[k] = vector(ParameterKind::kPoint, k);
  }
  constants->planes.resize(references.num_planes());
  for (int k = 0; k < references.num_planes(); ++k) {
    const Eigen::Vector3d uvc = vector(ParameterKind::kPlaneTilt, k);
    constants->planes[k] = ConstantsOf(references.planes[k], uvc.data());
  }
}

Columns::Columns(const ParameterLayout& layout, const std::vector<int>& columns)
    : num_derivatives_(static_cast<int>(columns.size())),
      joints_(layout.num_joints()),
      tool_translations_(layout.shape().num_targets, kNone),
      tool_rotations_(layout.shape().num_targets, kNone),
      points_(layout.shape().num_points, kNone),
      planes_(layout.shape().num_planes, kNone) {
  for (int k = 0; k < num_derivatives_; ++k) {
    const Parameter& parameter = layout.parameter(columns[k]);
    const int index = parameter.index;
    const int object = parameter.object;
    if (ParameterLayout::IsJointKind(parameter.kind)) {
      *EntryOf(parameter.kind, &joints_[index]) = k;
      has_arm_ = true;
      continue;
    }
    switch (parameter.kind) {
      case ParameterKind::kBaseTranslation:
        base_translation_[index] = k;
        has_arm_ = true;
        continue;
      case ParameterKind::kBaseRotation:
        base_rotation_[index] = k;
        has_arm_ = true;
        continue;
      case ParameterKind::kToolTranslation:
        tool_translations_[object][index] = k;
        break;
      case ParameterKind::kToolRotation:
        tool_rotations_[object][index] = k;
        break;
      case ParameterKind::kPoint:
        points_[object][index] = k;
        break;
      case ParameterKind::kPlaneTilt:
        planes_[object][index] = k;
        break;
      default:
        planes_[object][2] = k;
        break;
    }
    object_columns_.push_back(k);
  }
}

}  // namespace alidade::internal::kernel
