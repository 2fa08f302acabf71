#ifndef ALIDADE_MEASUREMENT_DATASET_H_
#define ALIDADE_MEASUREMENT_DATASET_H_

#include <Eigen/Core>
#include <string>

namespace alidade {

/// Measured positions of the target at known joint values. Column i of every
/// matrix belongs to pose i.
struct Dataset {
  std::string name;  ///< file it came from, for messages
  /// Joint values, num_joints x N (rad for revolute, m for prismatic).
  Eigen::MatrixXd joint_values;
  /// Measured points in the instrument's frame, 3 x N (m).
  Eigen::Matrix3Xd positions;
  /// Standard deviation of each coordinate, 3 x N (m), all positive.
  Eigen::Matrix3Xd sigmas;

  int num_joints() const { return static_cast<int>(joint_values.rows()); }
  Eigen::Index num_poses() const { return joint_values.cols(); }
  /// Number of scalar measurements.
  Eigen::Index num_rows() const { return 3 * num_poses(); }
};

}  // namespace alidade

#endif  // ALIDADE_MEASUREMENT_DATASET_H_
