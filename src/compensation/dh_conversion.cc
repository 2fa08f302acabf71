#include "src/compensation/dh_conversion.h"

#include <glog/logging.h>

#include <cmath>

#include "alidade/units.h"

namespace alidade::internal {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;

using Eigen::Vector3d;

// Below what a double resolves of an angle or a length of size one or so.
constexpr double kNegligible = 1e-15;

double Snap(double value) {
  return std::abs(value) < kNegligible ? 0.0 : value;
}

// An axis as a line: a point on it and its unit direction.
struct Line {
  Vector3d point;
  Vector3d direction;
};

// Builds an arm from the base to the tool. Angles are rounded before frames
// are made of them, so that frames carry what rounding leaves over on to the
// next joint, and errors do not add up.
class ChainConverter {
 public:
  void Append(const ChainJoint& joint) {
    last_from_link_ = last_from_link_ * joint.parent_from_joint;
    if (joint.type == ChainJoint::Type::kFixed) return;
    CHECK_GT(joint.axis.norm(), 0.0) << "axis of a moving joint";
    const bool is_revolute = joint.type == ChainJoint::Type::kRevolute;
    next_ = Joint();
    next_.type = is_revolute ? JointType::kRevolute : JointType::kPrismatic;
    next_.lower = joint.lower;
    next_.upper = joint.upper;
    Join(joint.axis.normalized(), is_revolute);
    arm_.joints.push_back(next_);
  }

  Arm Finish() {
    CHECK(!arm_.joints.empty()) << "no joint moves";
    arm_.last_from_target() = last_from_link_;
    return arm_;
  }

 private:
  // The axis in the frame of the last joint. A direction alone may pass
  // through its origin.
  Line AxisInLast(const Vector3d& axis, bool has_position) const {
    Line line{Vector3d::Zero(), last_from_link_.linear() * axis};
    if (has_position) line.point = last_from_link_.translation();
    return line;
  }

  void Join(const Vector3d& axis, bool has_position) {
    const Line line = AxisInLast(axis, has_position);
    if (arm_.joints.empty()) {
      JoinFirst(line);
      return;
    }
    const double sine = line.direction.head<2>().norm();
    if (sine < std::sin(kNearlyParallel)) {
      JoinParallel(axis, has_position);
    } else {
      JoinByNormal(axis, has_position);
    }
  }

  // R = Rot(y, beta) Rot(x, alpha) turns z onto the axis; a point of it is
  // R (d, y, r), and y is what the joint cannot do.
  void JoinFirst(const Line& line) {
    SetAngles(line.direction);
    const Eigen::Matrix3d rotation = NextRotation();
    const Vector3d point = rotation.transpose() * line.point;
    next_.d = Snap(point.x());
    next_.r = Snap(point.z());
    const Vector3d rest(0.0, Snap(point.y()), 0.0);
    arm_.instrument_from_base.translation() = rotation * rest;
    last_from_link_.translation() -= arm_.instrument_from_base.translation();
    Advance();
  }

  void JoinParallel(const Vector3d& axis, bool has_position) {
    const Line line = AxisInLast(axis, has_position);
    const Vector3d foot =
        line.point - line.point.dot(line.direction) * line.direction;
    if (foot.norm() >= kNegligible) TurnLast(foot);
    const Line turned = AxisInLast(axis, has_position);
    SetAngles(turned.direction);
    next_.d = Snap((NextRotation().transpose() * turned.point).x());
    Advance();
  }

  void JoinByNormal(const Vector3d& axis, bool has_position) {
    const Line line = AxisInLast(axis, has_position);
    TurnLast(Vector3d::UnitZ().cross(line.direction));
    const Line turned = AxisInLast(axis, has_position);
    const double sine = -turned.direction.y();
    const double cosine = turned.direction.z();
    next_.alpha = Snap(std::atan2(sine, cosine));
    next_.d = Snap(turned.point.x());
    // Along the axis to where it crosses y = 0, the plane of z and normal.
    SlideLast(turned.point.z() + turned.point.y() * cosine / sine);
    Advance();
  }

  // beta and alpha with Rot(y, beta) Rot(x, alpha) e_z = direction. beta
  // stays small where the direction is near -z: alpha does the half turn.
  void SetAngles(const Vector3d& direction) {
    const double sign = direction.z() < 0.0 ? -1.0 : 1.0;
    const double cosine = sign * std::hypot(direction.x(), direction.z());
    next_.alpha = Snap(std::atan2(-direction.y(), cosine));
    next_.beta = Snap(std::atan2(sign * direction.x(), sign * direction.z()));
  }

  Eigen::Matrix3d NextRotation() const {
    return (AngleAxisd(next_.beta, Vector3d::UnitY()) *
            AngleAxisd(next_.alpha, Vector3d::UnitX()))
        .toRotationMatrix();
  }

  // Turns the last joint's frame about z until `x` has no y component.
  void TurnLast(const Vector3d& x) {
    double angle = std::atan2(x.y(), x.x());
    // Either direction of a normal will do.
    if (angle > 0.5 * kPi) angle -= kPi;
    if (angle <= -0.5 * kPi) angle += kPi;
    angle = Snap(angle);
    arm_.joints.back().theta = Snap(arm_.joints.back().theta + angle);
    last_from_link_ = AngleAxisd(-angle, Vector3d::UnitZ()) * last_from_link_;
  }

  void SlideLast(double distance) {
    distance = Snap(distance);
    arm_.joints.back().r = Snap(arm_.joints.back().r + distance);
    last_from_link_.pretranslate(Vector3d(0.0, 0.0, -distance));
  }

  // From the last joint's frame to the next one's.
  void Advance() {
    Isometry3d last_from_next = Isometry3d::Identity();
    last_from_next.linear() = NextRotation();
    last_from_next.translate(Vector3d(next_.d, 0.0, next_.r));
    last_from_link_ = last_from_next.inverse() * last_from_link_;
  }

  Arm arm_;
  Joint next_;
  Isometry3d last_from_link_ = Isometry3d::Identity();
};

Joint JointFromRow(const DhRow& row) {
  Joint joint;
  joint.type = row.type;
  joint.theta = row.theta;
  joint.r = row.d;
  joint.lower = row.lower;
  joint.upper = row.upper;
  return joint;
}

}  // namespace

Arm ArmFromStandardDh(const std::vector<DhRow>& rows) {
  Arm arm;
  DhRow before;
  for (const DhRow& row : rows) {
    Joint joint = JointFromRow(row);
    joint.alpha = before.alpha;
    joint.d = before.a;
    arm.joints.push_back(joint);
    before = row;
  }
  arm.last_from_target().translation().x() = before.a;
  arm.last_from_target().linear() =
      AngleAxisd(before.alpha, Vector3d::UnitX()).toRotationMatrix();
  return arm;
}

Arm ArmFromCraigDh(const std::vector<DhRow>& rows) {
  Arm arm;
  for (const DhRow& row : rows) {
    Joint joint = JointFromRow(row);
    joint.alpha = row.alpha;
    joint.d = row.a;
    arm.joints.push_back(joint);
  }
  return arm;
}

Arm ArmFromChain(const std::vector<ChainJoint>& chain) {
  ChainConverter converter;
  for (const ChainJoint& joint : chain) converter.Append(joint);
  return converter.Finish();
}

bool HasFarNormals(const Arm& arm) {
  constexpr double kFar = 10.0;  // m
  for (std::size_t j = 1; j < arm.joints.size(); ++j) {
    const Joint& joint = arm.joints[j];
    const double sine = std::abs(std::sin(joint.alpha));
    const bool is_nearly_parallel =
        joint.beta == 0.0 && sine > 0.0 && sine < std::sin(kNearlyParallel);
    if (is_nearly_parallel && std::abs(joint.r) > kFar) return true;
  }
  return false;
}

Arm WithoutFarNormals(const Arm& arm) {
  std::vector<ChainJoint> chain;
  Isometry3d last_from_link = Isometry3d::Identity();
  for (const Joint& joint : arm.joints) {
    ChainJoint link;
    link.type = joint.type == JointType::kRevolute
                    ? ChainJoint::Type::kRevolute
                    : ChainJoint::Type::kPrismatic;
    link.axis = Vector3d::UnitZ();
    link.lower = joint.lower;
    link.upper = joint.upper;
    Isometry3d frame = last_from_link;
    frame.rotate(AngleAxisd(joint.beta, Vector3d::UnitY()));
    frame.rotate(AngleAxisd(joint.alpha, Vector3d::UnitX()));
    frame.translate(Vector3d(joint.d, 0.0, 0.0));
    frame.rotate(AngleAxisd(joint.theta, Vector3d::UnitZ()));
    link.parent_from_joint = frame;
    chain.push_back(link);
    last_from_link = Isometry3d::Identity();
    last_from_link.translation().z() = joint.r;
  }
  ChainJoint end;
  end.type = ChainJoint::Type::kFixed;
  end.parent_from_joint = last_from_link;
  chain.push_back(end);
  const Arm converted = ArmFromChain(chain);
  Arm result = arm;
  result.joints = converted.joints;
  result.instrument_from_base =
      arm.instrument_from_base * converted.instrument_from_base;
  for (Target& target : result.targets) {
    target.last_from_target =
        converted.last_from_target() * target.last_from_target;
  }
  return result;
}

}  // namespace alidade::internal
