#include "alidade/forward_kinematics.h"

namespace alidade {
namespace {

// The geometry of an arm as the template takes it.
class Geometry {
 public:
  Geometry(const Arm& arm, int target) : values_(arm.num_joints(), 5) {
    for (int j = 0; j < arm.num_joints(); ++j) {
      const Joint& joint = arm.joints[j];
      values_.row(j) << joint.beta, joint.alpha, joint.d, joint.theta, joint.r;
    }
    view_ = {values_.col(0).data(),
             values_.col(1).data(),
             values_.col(2).data(),
             values_.col(3).data(),
             values_.col(4).data(),
             nullptr,
             nullptr,
             target};
  }
  Geometry(const Geometry&) = delete;
  Geometry& operator=(const Geometry&) = delete;

  const GeometryView<double>& view() const { return view_; }

 private:
  Eigen::MatrixXd values_;
  GeometryView<double> view_;
};

}  // namespace

Eigen::Isometry3d TargetPose(const Arm& arm,
                             const Eigen::VectorXd& joint_values, int target) {
  const Geometry geometry(arm, target);
  Eigen::Matrix3d rotation;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() =
      TargetPose<double>(arm, geometry.view(), joint_values.data(), &rotation);
  pose.linear() = rotation;
  return pose;
}

Eigen::Matrix3Xd TargetPositions(const Arm& arm,
                                 const Eigen::MatrixXd& joint_values,
                                 int target) {
  const Geometry geometry(arm, target);
  Eigen::Matrix3Xd positions(3, joint_values.cols());
  for (Eigen::Index i = 0; i < joint_values.cols(); ++i) {
    positions.col(i) = TargetPosition<double>(arm, geometry.view(),
                                              joint_values.col(i).data());
  }
  return positions;
}

}  // namespace alidade
