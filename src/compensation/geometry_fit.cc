#include "src/compensation/geometry_fit.h"

#include <array>
#include <cmath>
#include <utility>

#include "alidade/forward_kinematics.h"
#include "alidade/rotation.h"
#include "src/common/svd.h"
#include "src/model/chain_axes.h"
#include "src/model/joint_draw.h"

namespace alidade::internal {
namespace {

constexpr int kFitPoses = 300;
constexpr int kCheckPoses = 5000;
constexpr std::uint64_t kFitSeed = 1;
constexpr std::uint64_t kCheckSeed = 2;
constexpr int kIterations = 8;
// Directions that poses distinguish by less than this part of the best are
// left as they are: among them those by which the table of nearly parallel axes
// without beta would run away to normals hundreds of metres off.
constexpr double kRank = 1e-2;

std::array<double*, 5> NumbersOf(Joint* joint) {
  return {&joint->beta, &joint->alpha, &joint->d, &joint->theta, &joint->r};
}

// Six rows of one pose: residual, and its derivative by all 5 n numbers.
class PoseRows {
 public:
  PoseRows(const Arm& arm, double lever) : arm_(arm), lever_(lever) {}

  void Fill(const Eigen::VectorXd& q, const Eigen::Isometry3d& wanted,
            Eigen::Ref<Eigen::MatrixXd> jacobian,
            Eigen::Ref<Eigen::VectorXd> residual) {
    ComputeChainAxes(arm_, q.data(), &axes_);
    const Eigen::Vector3d p = axes_.instrument_from_target.translation();
    residual.head<3>() = wanted.translation() - p;
    const Eigen::Matrix3d turn =
        wanted.linear() * axes_.instrument_from_target.linear().transpose();
    residual.tail<3>() = lever_ * VectorFromRotation(turn);
    for (int j = 0; j < arm_.num_joints(); ++j) {
      const Eigen::Vector3d alpha = axes_.alpha_axis.col(j);
      const Eigen::Vector3d z = axes_.joint_axis.col(j);
      auto columns = jacobian.middleCols<5>(Eigen::Index{5} * j);
      columns.col(0) =
          Turn(axes_.beta_axis.col(j), p - axes_.origin_before.col(j));
      columns.col(1) = Turn(alpha, p - axes_.origin_before.col(j));
      columns.col(2) << alpha, Eigen::Vector3d::Zero();
      columns.col(3) = Turn(z, p - axes_.origin_on_axis.col(j));
      columns.col(4) << z, Eigen::Vector3d::Zero();
    }
  }

 private:
  Eigen::Matrix<double, 6, 1> Turn(const Eigen::Vector3d& axis,
                                   const Eigen::Vector3d& arm) const {
    Eigen::Matrix<double, 6, 1> column;
    column << axis.cross(arm), lever_ * axis;
    return column;
  }

  const Arm& arm_;
  const double lever_;
  ChainAxes axes_;
};

std::vector<int> Columns(const FreeGeometry& free) {
  std::vector<int> columns;
  for (int k = 0; k < free.size(); ++k) {
    if (free(k % 5, k / 5)) columns.push_back(k);
  }
  return columns;
}

}  // namespace

Arm FitGeometry(const Arm& real, const Arm& start, const FreeGeometry& free) {
  Arm fitted = start;
  const double reach = ArmReach(real);
  const Eigen::MatrixXd poses = DrawJointValues(real, kFitPoses, kFitSeed);
  std::vector<Eigen::Isometry3d> wanted;
  for (const auto& q : poses.colwise()) wanted.push_back(TargetPose(real, q));
  const std::vector<int> columns = Columns(free);
  if (columns.empty()) return fitted;
  Eigen::MatrixXd jacobian(6 * kFitPoses, 5 * start.num_joints());
  Eigen::VectorXd residual(6 * kFitPoses);
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    PoseRows rows(fitted, 0.1 * reach);
    for (int i = 0; i < kFitPoses; ++i) {
      rows.Fill(poses.col(i), wanted[i],
                jacobian.middleRows<6>(Eigen::Index{6} * i),
                residual.segment<6>(Eigen::Index{6} * i));
    }
    Eigen::MatrixXd kept = jacobian(Eigen::all, columns);
    // Lengths in parts of the reach, so that columns are of one size.
    for (std::size_t k = 0; k < columns.size(); ++k) {
      if (columns[k] % 5 == 2 || columns[k] % 5 == 4) {
        kept.col(static_cast<Eigen::Index>(k)) *= reach;
      }
    }
    const Eigen::VectorXd step = SolveByMinimumNorm(kept, residual, kRank);
    for (std::size_t k = 0; k < columns.size(); ++k) {
      const bool is_length = columns[k] % 5 == 2 || columns[k] % 5 == 4;
      Joint& joint = fitted.joints[columns[k] / 5];
      *NumbersOf(&joint)[columns[k] % 5] +=
          step[static_cast<Eigen::Index>(k)] * (is_length ? reach : 1.0);
    }
    if (step.norm() < 1e-14) break;
  }
  return fitted;
}

Accuracy DistanceOver(const Arm& real, const Arm& other) {
  const Eigen::MatrixXd poses = DrawJointValues(real, kCheckPoses, kCheckSeed);
  const Eigen::Matrix3Xd difference =
      TargetPositions(real, poses) - TargetPositions(other, poses);
  return SummarizeErrors(difference.colwise().norm().transpose());
}

Arm WithoutErrorTerms(Arm arm) {
  arm.errors = {};
  return arm;
}

std::vector<Eigen::Isometry3d> JointOrigins(const Arm& arm) {
  std::vector<Eigen::Isometry3d> origins;
  Eigen::Isometry3d before = arm.instrument_from_base;
  for (const Joint& joint : arm.joints) {
    Eigen::Isometry3d origin = before;
    origin.rotate(Eigen::AngleAxisd(joint.beta, Eigen::Vector3d::UnitY()));
    origin.rotate(Eigen::AngleAxisd(joint.alpha, Eigen::Vector3d::UnitX()));
    origin.translate(Eigen::Vector3d(joint.d, 0.0, 0.0));
    origin.rotate(Eigen::AngleAxisd(joint.theta, Eigen::Vector3d::UnitZ()));
    origin.translate(Eigen::Vector3d(0.0, 0.0, joint.r));
    origins.push_back(origin);
    before.setIdentity();
  }
  return origins;
}

}  // namespace alidade::internal
