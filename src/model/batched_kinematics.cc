#include "alidade/batched_kinematics.h"

#include <Eigen/Geometry>
#include <cmath>
#include <utility>
#include <vector>

#include "alidade/forward_kinematics.h"
#include "alidade/parameter_layout.h"
#include "src/common/parallel.h"
#include "src/model/chain_axes.h"

namespace alidade {
namespace {

// Configurations that a thread takes at a time.
constexpr Eigen::Index kBlock = 256;

// Parameters of an arm as the model takes them; base and target are the arm's.
class ArmGeometry {
 public:
  ArmGeometry(const Arm& arm, int target)
      : layout_(arm), values_(layout_.Values(arm)) {
    view_ = ViewOf(layout_, values_.data(), target);
    view_.base = nullptr;
    view_.tool = nullptr;
  }
  const GeometryView<double>& view() const { return view_; }

 private:
  const ParameterLayout layout_;
  const Eigen::VectorXd values_;
  GeometryView<double> view_;
};

// The model (forward_kinematics.h) of an arm without error terms, operation by
// operation, so with its bits; but sines and cosines of what is the same at all
// poses are taken once.
class RigidChain {
 public:
  RigidChain(const Arm& arm, int target)
      : arm_(arm), tool_(arm.last_from_target(target)) {
    for (const Joint& joint : arm.joints) {
      turns_.push_back({std::sin(joint.alpha), std::cos(joint.alpha),
                        std::sin(joint.beta), std::cos(joint.beta)});
    }
  }

  // Position, and the columns of `axes` where that is not null.
  Eigen::Vector3d Carry(const double* q, Eigen::Matrix3d* axes) const {
    Eigen::Vector3d p = tool_.translation();
    if (axes != nullptr) *axes = tool_.linear();
    for (int j = arm_.num_joints() - 1; j >= 0; --j) {
      const Joint& joint = arm_.joints[j];
      const bool turns = joint.type == JointType::kRevolute;
      const double theta = turns ? joint.theta + q[j] : joint.theta;
      const double sine = std::sin(theta), cosine = std::cos(theta);
      p.z() += turns ? joint.r : joint.r + q[j];
      RotatePlane(sine, cosine, &p.x(), &p.y());
      p.x() += joint.d;
      Turn(turns_[j], p.data());
      for (int k = 0; axes != nullptr && k < 3; ++k) {
        double* const axis = axes->col(k).data();
        RotatePlane(sine, cosine, axis, axis + 1);
        Turn(turns_[j], axis);
      }
    }
    const Eigen::Isometry3d& base = arm_.instrument_from_base;
    if (axes != nullptr) *axes = base.linear() * *axes;
    return base.linear() * p + base.translation();
  }

 private:
  struct Turns {
    double sin_alpha, cos_alpha, sin_beta, cos_beta;
  };

  static void Turn(const Turns& turns, double* v) {
    RotatePlane(turns.sin_alpha, turns.cos_alpha, v + 1, v + 2);
    RotatePlane(turns.sin_beta, turns.cos_beta, v + 2, v);
  }

  const Arm& arm_;
  const Eigen::Isometry3d tool_;
  std::vector<Turns> turns_;
};

template <typename Work>
void ForEachColumn(Eigen::Index count, int num_threads, const Work& work) {
  internal::ParallelFor(num_threads, count, kBlock,
                        [&](std::int64_t begin, std::int64_t end) {
                          for (Eigen::Index i = begin; i < end; ++i) work(i);
                        });
}

using Twist = Eigen::Matrix<double, 6, 1>;

// Of a point that turns about an axis through `origin`.
Twist Turn(const Eigen::Vector3d& axis, const Eigen::Vector3d& origin,
           const Eigen::Vector3d& point) {
  Twist twist;
  twist << axis.cross(point - origin), axis;
  return twist;
}

Twist Slide(const Eigen::Vector3d& axis) {
  Twist twist;
  twist << axis, Eigen::Vector3d::Zero();
  return twist;
}

// What parameters of the arm do to the target, by kind.
Twist TwistOf(const Parameter& parameter, const Arm& arm,
              const internal::ChainAxes& axes, int target) {
  const int k = parameter.index;
  const Eigen::Isometry3d& tip = axes.instrument_from_target;
  const Eigen::Vector3d point = tip.translation();
  switch (parameter.kind) {
    case ParameterKind::kBeta:
      return Turn(axes.beta_axis.col(k), axes.origin_before.col(k), point);
    case ParameterKind::kAlpha:
      return Turn(axes.alpha_axis.col(k), axes.origin_before.col(k), point);
    case ParameterKind::kD:
      return Slide(axes.alpha_axis.col(k));
    case ParameterKind::kTheta:
      return Turn(axes.joint_axis.col(k), axes.origin_on_axis.col(k), point);
    case ParameterKind::kR:
      return Slide(axes.joint_axis.col(k));
    case ParameterKind::kBaseTranslation:
      return Slide(Eigen::Vector3d::Unit(k));
    case ParameterKind::kBaseRotation:
      return Turn(Eigen::Vector3d::Unit(k),
                  arm.instrument_from_base.translation(), point);
    case ParameterKind::kToolTranslation:
      if (parameter.object != target) break;
      return Slide(axes.instrument_from_last.linear().col(k));
    case ParameterKind::kToolRotation:
      if (parameter.object != target) break;
      return Turn(axes.instrument_from_last.linear().col(k), point, point);
    default:
      break;
  }
  return Twist::Zero();
}

// With the target that is asked for as the first, which the axes are of.
Arm WithFirstTarget(Arm arm, int target) {
  std::swap(arm.targets[0], arm.targets[target]);
  return arm;
}

}  // namespace

Eigen::Matrix3Xd BatchedPositions(const Arm& arm, const JointValues& joints,
                                  int target, int num_threads) {
  const ArmGeometry geometry(arm, target);
  const RigidChain chain(arm, target);
  const bool is_rigid = arm.errors.empty();
  Eigen::Matrix3Xd positions(3, joints.cols());
  ForEachColumn(joints.cols(), num_threads, [&](Eigen::Index i) {
    const double* const q = joints.col(i).data();
    positions.col(i) = is_rigid ? chain.Carry(q, nullptr)
                                : TargetPosition(arm, geometry.view(), q);
  });
  return positions;
}

Eigen::MatrixXd BatchedTransforms(const Arm& arm, const JointValues& joints,
                                  int target, int num_threads) {
  const ArmGeometry geometry(arm, target);
  const RigidChain chain(arm, target);
  const bool is_rigid = arm.errors.empty();
  Eigen::MatrixXd transforms(16, joints.cols());
  ForEachColumn(joints.cols(), num_threads, [&](Eigen::Index i) {
    Eigen::Map<Eigen::Matrix<double, 4, 4, Eigen::RowMajor>> transform(
        transforms.col(i).data());
    Eigen::Matrix3d rotation;
    transform.setIdentity();
    const double* const q = joints.col(i).data();
    transform.topRightCorner<3, 1>() =
        is_rigid ? chain.Carry(q, &rotation)
                 : TargetPose(arm, geometry.view(), q, &rotation);
    transform.topLeftCorner<3, 3>() = rotation;
  });
  return transforms;
}

Eigen::MatrixXd BatchedJointJacobians(const Arm& arm, const JointValues& joints,
                                      int target, int num_threads) {
  const Arm seen = WithFirstTarget(arm, target);
  const Eigen::Index n = arm.num_joints();
  Eigen::MatrixXd jacobians(6 * n, joints.cols());
  internal::ParallelFor(
      num_threads, joints.cols(), kBlock,
      [&](std::int64_t begin, std::int64_t end) {
        internal::ChainAxes axes;
        for (Eigen::Index i = begin; i < end; ++i) {
          internal::ComputeChainAxes(seen, joints.col(i).data(), &axes);
          const Eigen::Vector3d point =
              axes.instrument_from_target.translation();
          for (Eigen::Index j = 0; j < n; ++j) {
            const bool turns = arm.joints[j].type == JointType::kRevolute;
            jacobians.block<6, 1>(6 * j, i) =
                turns ? Turn(axes.joint_axis.col(j), axes.origin_on_axis.col(j),
                             point)
                      : Slide(axes.joint_axis.col(j));
          }
        }
      });
  return jacobians;
}

Eigen::MatrixXd BatchedParameterJacobians(const Arm& arm,
                                          const JointValues& joints, int target,
                                          int num_threads) {
  const Arm seen = WithFirstTarget(arm, target);
  const ParameterLayout layout(arm);
  Eigen::MatrixXd jacobians(6 * layout.size(), joints.cols());
  internal::ParallelFor(
      num_threads, joints.cols(), kBlock,
      [&](std::int64_t begin, std::int64_t end) {
        internal::ChainAxes axes;
        for (Eigen::Index i = begin; i < end; ++i) {
          internal::ComputeChainAxes(seen, joints.col(i).data(), &axes);
          for (int c = 0; c < layout.size(); ++c) {
            jacobians.block<6, 1>(Eigen::Index{6} * c, i) =
                TwistOf(layout.parameter(c), arm, axes, target);
          }
        }
      });
  return jacobians;
}

}  // namespace alidade
