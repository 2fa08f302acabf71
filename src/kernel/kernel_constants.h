#ifndef ALIDADE_SRC_KERNEL_KERNEL_CONSTANTS_H_
#define ALIDADE_SRC_KERNEL_KERNEL_CONSTANTS_H_

#include <Eigen/Core>
#include <array>
#include <vector>

#include "alidade/arm.h"
#include "alidade/parameter_layout.h"
#include "alidade/references.h"

namespace alidade::internal::kernel {

/// What an arm's joint contributes at one set of parameter values.
struct JointConstants {
  bool is_revolute = true;
  double sin_beta = 0.0, cos_beta = 1.0;
  double sin_alpha = 0.0, cos_alpha = 1.0;
  double sin_theta = 0.0, cos_theta = 1.0;
  double d = 0.0, r = 0.0;
};

/// A target in the last frame, and the axes that the components of its
/// rotation vector turn it about.
struct TargetConstants {
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
};

struct PlaneConstants {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double offset = 0.0;
  /// d normal / du and d normal / dv.
  std::array<Eigen::Vector3d, 2> normal_by_tilt;
};

/// All that does not depend on the pose.
struct Constants {
  Eigen::Vector3d base_translation = Eigen::Vector3d::Zero();
  Eigen::Matrix3d base_rotation = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d base_axes = Eigen::Matrix3d::Identity();
  std::vector<JointConstants> joints;
  std::vector<TargetConstants> targets;
  std::vector<Eigen::Vector3d> points;
  std::vector<PlaneConstants> planes;
};

/// Allocates only where `constants` has other sizes.
void ComputeConstants(const Arm& nominal, const References& references,
                      const ParameterLayout& layout,
                      const Eigen::VectorXd& values, Constants* constants);

/// Where the derivatives by each parameter go: a column of the output, or -1
/// where nobody asks.
class Columns {
 public:
  struct OfJoint {
    int beta = -1, alpha = -1, d = -1, theta = -1, r = -1;
    bool HasTurnBefore() const { return beta >= 0 || alpha >= 0; }
    bool HasAlphaAxis() const { return alpha >= 0 || d >= 0; }
    bool HasJointAxis() const { return theta >= 0 || r >= 0; }
  };
  using Triple = std::array<int, 3>;
  static constexpr Triple kNone = {-1, -1, -1};

  /// Output column k is that of layout column `columns[k]`; the residual comes
  /// last. @pre columns are in range, without repeats.
  Columns(const ParameterLayout& layout, const std::vector<int>& columns);

  int num_derivatives() const { return num_derivatives_; }
  int num_joints() const { return static_cast<int>(joints_.size()); }
  const OfJoint& joint(int j) const { return joints_[j]; }
  const Triple& base_translation() const { return base_translation_; }
  const Triple& base_rotation() const { return base_rotation_; }
  const Triple& tool_translation(int k) const { return tool_translations_[k]; }
  const Triple& tool_rotation(int k) const { return tool_rotations_[k]; }
  /// x y z of a point; none for -1.
  const Triple& point(int k) const { return k < 0 ? kNone : points_[k]; }
  /// u v c.
  const Triple& plane(int k) const { return planes_[k]; }
  /// Columns of targets and references, zero in the tiles of others.
  const std::vector<int>& object_columns() const { return object_columns_; }
  /// Whether a joint or the base has a column.
  bool HasArm() const { return has_arm_; }

 private:
  int num_derivatives_ = 0;
  bool has_arm_ = false;
  std::vector<OfJoint> joints_;
  Triple base_translation_ = kNone;
  Triple base_rotation_ = kNone;
  std::vector<Triple> tool_translations_;
  std::vector<Triple> tool_rotations_;
  std::vector<Triple> points_;
  std::vector<Triple> planes_;
  std::vector<int> object_columns_;
};

}  // namespace alidade::internal::kernel

#endif  // ALIDADE_SRC_KERNEL_KERNEL_CONSTANTS_H_
