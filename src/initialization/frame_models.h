#ifndef ALIDADE_SRC_INITIALIZATION_FRAME_MODELS_H_
#define ALIDADE_SRC_INITIALIZATION_FRAME_MODELS_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "alidade/rotation.h"
#include "src/kernel/robust_fit.h"

namespace alidade::internal {

/// The models of frame_start.h, in the form that robust_fit.h asks for. What
/// they point at must outlive them.

using Poses = std::vector<Eigen::Isometry3d>;

/// What a radian counts in the fit of poses (m).
constexpr double kMetresPerRadian = 0.2;

inline Eigen::Matrix3d Skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d skew;
  skew << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return skew;
}

/// Rotations built up from small ones drift off SO(3) by rounding.
inline Eigen::Matrix3d Turned(const Eigen::Vector3d& turn,
                              const Eigen::Matrix3d& rotation) {
  const Eigen::Matrix3d turned = RotationFromVector(turn) * rotation;
  return Eigen::Quaterniond(turned).normalized().toRotationMatrix();
}

/// x_i of one target.
inline Eigen::Matrix3Xd TargetsInBase(const Poses& base_from_last,
                                      const Eigen::Vector3d& target) {
  Eigen::Matrix3Xd points(3, static_cast<Eigen::Index>(base_from_last.size()));
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    points.col(i) = base_from_last[i] * target;
  }
  return points;
}

inline void SetZeroRows(Eigen::Index num_rows, Eigen::Index num_columns,
                        FitRows* rows) {
  rows->residuals.setZero(num_rows);
  rows->jacobian.setZero(num_rows, num_columns);
}

/// instrument_from_base x_i - p_i. Unknowns: the base's turn on the left and
/// translation, then the targets.
struct PositionStartModel {
  static constexpr int kBlockSize = 3;
  static constexpr int kTargetColumn = 6;

  const Poses* base_from_last;
  const Eigen::Matrix3Xd* measured;
  const std::vector<int>* target_of_observation;
  Eigen::Isometry3d instrument_from_base;
  Eigen::Matrix3Xd targets;

  Eigen::Matrix3Xd PointsInBase() const {
    Eigen::Matrix3Xd points(3, measured->cols());
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
      const int k = (*target_of_observation)[i];
      points.col(i) = (*base_from_last)[i] * targets.col(k);
    }
    return points;
  }

  void Linearize(FitRows* rows) const {
    SetZeroRows(measured->size(), kTargetColumn + targets.size(), rows);
    const Eigen::Matrix3Xd points = PointsInBase();
    const Eigen::Matrix3d rotation = instrument_from_base.linear();
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
      const int k = (*target_of_observation)[i];
      rows->residuals.segment<3>(3 * i) =
          instrument_from_base * points.col(i) - measured->col(i);
      auto block = rows->jacobian.middleRows<3>(3 * i);
      block.leftCols<3>() = -Skew(rotation * points.col(i));
      block.middleCols<3>(3).setIdentity();
      block.middleCols<3>(kTargetColumn + 3 * k) =
          rotation * (*base_from_last)[i].linear();
    }
  }

  void Move(const Eigen::VectorXd& step) {
    instrument_from_base.linear() =
        Turned(step.head<3>(), instrument_from_base.linear());
    instrument_from_base.translation() += step.segment<3>(3);
    targets.reshaped() += step.tail(targets.size());
  }
};

/// Positions as above, and kMetresPerRadian times the rotation vector that
/// turns the measured orientation into the modelled one. Unknowns: the base's
/// turn and translation, the target's place and turn on the left.
struct PoseStartModel {
  static constexpr int kBlockSize = 6;
  static constexpr int kTargetColumn = 6;

  const Poses* base_from_last;
  const Poses* measured;
  Eigen::Isometry3d instrument_from_base;
  Eigen::Matrix3Xd targets;
  Eigen::Matrix3d last_from_target;

  void Linearize(FitRows* rows) const {
    const auto num_poses = static_cast<Eigen::Index>(measured->size());
    SetZeroRows(kBlockSize * num_poses, 12, rows);
    for (Eigen::Index i = 0; i < num_poses; ++i) {
      const Eigen::Isometry3d& measured_pose = (*measured)[i];
      const Eigen::Vector3d point = (*base_from_last)[i] * targets.col(0);
      const Eigen::Matrix3d base = instrument_from_base.linear();
      const Eigen::Matrix3d last = base * (*base_from_last)[i].linear();
      rows->residuals.segment<3>(6 * i) =
          instrument_from_base * point - measured_pose.translation();
      rows->residuals.segment<3>(6 * i + 3) =
          kMetresPerRadian *
          VectorFromRotation(last * last_from_target *
                             measured_pose.linear().transpose());
      auto block = rows->jacobian.middleRows<6>(6 * i);
      block.block<3, 3>(0, 0) = -Skew(base * point);
      block.block<3, 3>(0, 3).setIdentity();
      block.block<3, 3>(0, 6) = last;
      // Of first order in the residual.
      block.block<3, 3>(3, 0).diagonal().setConstant(kMetresPerRadian);
      block.block<3, 3>(3, 9) = kMetresPerRadian * last;
    }
  }

  void Move(const Eigen::VectorXd& step) {
    instrument_from_base.linear() =
        Turned(step.head<3>(), instrument_from_base.linear());
    instrument_from_base.translation() += step.segment<3>(3);
    targets.col(0) += step.segment<3>(6);
    last_from_target = Turned(step.segment<3>(9), last_from_target);
  }
};

/// x_i - c_k, all in the base's frame. Unknowns: the target, then the points.
struct FixedPointStartModel {
  static constexpr int kBlockSize = 3;
  static constexpr int kTargetColumn = 0;

  const Poses* base_from_last;
  const std::vector<int>* point_of_observation;
  Eigen::Matrix3Xd targets;
  Eigen::Matrix3Xd points;

  void Linearize(FitRows* rows) const {
    const Eigen::Matrix3Xd x = TargetsInBase(*base_from_last, targets.col(0));
    SetZeroRows(x.size(), 3 + points.size(), rows);
    for (Eigen::Index i = 0; i < x.cols(); ++i) {
      const int k = (*point_of_observation)[i];
      rows->residuals.segment<3>(3 * i) = x.col(i) - points.col(k);
      auto block = rows->jacobian.middleRows<3>(3 * i);
      block.leftCols<3>() = (*base_from_last)[i].linear();
      block.middleCols<3>(3 + 3 * k).diagonal().setConstant(-1.0);
    }
  }

  void Move(const Eigen::VectorXd& step) {
    targets.col(0) += step.head<3>();
    points.reshaped() += step.tail(points.size());
  }
};

/// |x_i - a| - L_i, in the base's frame. Unknowns: the target, the anchor.
struct DistanceStartModel {
  static constexpr int kBlockSize = 1;
  static constexpr int kTargetColumn = 0;

  const Poses* base_from_last;
  const Eigen::VectorXd* lengths;
  Eigen::Matrix3Xd targets;
  Eigen::Vector3d anchor;

  void Linearize(FitRows* rows) const {
    const Eigen::Matrix3Xd x = TargetsInBase(*base_from_last, targets.col(0));
    SetZeroRows(x.cols(), 6, rows);
    for (Eigen::Index i = 0; i < x.cols(); ++i) {
      const Eigen::Vector3d arrow = x.col(i) - anchor;
      const Eigen::Vector3d direction = arrow.normalized();
      rows->residuals[i] = arrow.norm() - (*lengths)[i];
      rows->jacobian.row(i).head<3>() =
          direction.transpose() * (*base_from_last)[i].linear();
      rows->jacobian.row(i).tail<3>() = -direction.transpose();
    }
  }

  void Move(const Eigen::VectorXd& step) {
    targets.col(0) += step.head<3>();
    anchor += step.tail<3>();
  }
};

/// n . x_i - c, in the base's frame. Unknowns: the target, c, and the normal's
/// tilts along two directions in the plane.
struct PlaneStartModel {
  static constexpr int kBlockSize = 1;
  static constexpr int kTargetColumn = 0;

  const Poses* base_from_last;
  Eigen::Matrix3Xd targets;
  Eigen::Vector3d normal;
  double offset;

  Eigen::Matrix<double, 3, 2> Tangents() const {
    Eigen::Matrix<double, 3, 2> tangents;
    tangents.col(0) = normal.unitOrthogonal();
    tangents.col(1) = normal.cross(tangents.col(0));
    return tangents;
  }

  void Linearize(FitRows* rows) const {
    const Eigen::Matrix3Xd x = TargetsInBase(*base_from_last, targets.col(0));
    SetZeroRows(x.cols(), 6, rows);
    const Eigen::Matrix<double, 3, 2> tangents = Tangents();
    for (Eigen::Index i = 0; i < x.cols(); ++i) {
      rows->residuals[i] = normal.dot(x.col(i)) - offset;
      rows->jacobian.row(i).head<3>() =
          normal.transpose() * (*base_from_last)[i].linear();
      rows->jacobian(i, 3) = -1.0;
      rows->jacobian.row(i).tail<2>() = x.col(i).transpose() * tangents;
    }
  }

  void Move(const Eigen::VectorXd& step) {
    const Eigen::Vector3d tilted = normal + Tangents() * step.tail<2>();
    targets.col(0) += step.head<3>();
    offset += step[3];
    normal = tilted.normalized();
  }
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_INITIALIZATION_FRAME_MODELS_H_
