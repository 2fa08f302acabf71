#ifndef ALIDADE_STATED_POSES_H_
#define ALIDADE_STATED_POSES_H_

#include <Eigen/Core>
#include <string>

#include "alidade/dataset.h"

namespace alidade {

/// Positions and orientations in the forms that instruments state them in, M of
/// them: what the columns of a data set's file may hold (docs/files.md), for
/// those who have them in memory. A matrix of one column holds for all.
struct StatedPoses {
  Eigen::MatrixXd positions = {};  ///< 3 x M (m)
  /// Numbers of each orientation, k x M (rad), or empty: positions alone.
  Eigen::MatrixXd orientations = {};
  /// What they are: "rotation_vector" (k = 3), "quaternion" (w, x, y, z),
  /// "matrix" (9, row by row), or Euler angles rx, ry, rz by one of the 24
  /// conventions of files ("intrinsic_zyx" ...).
  std::string convention = "rotation_vector";
  /// Standard deviations of positions, 3 x M (m); infinite where a coordinate
  /// was not measured.
  Eigen::MatrixXd sigmas = {};
  /// Of small turns about the instrument's axes, 3 x M (rad) ...
  Eigen::MatrixXd rotation_sigmas = {};
  /// ... or of rx, ry, rz themselves, 3 x M (rad), in place of these.
  Eigen::MatrixXd angle_sigmas = {};
  /// Covariances of positions, 9 x M (m^2), or of positions and turns, 36 x M,
  /// in place of these standard deviations. Rows and columns of a coordinate
  /// whose variance is infinite are not measured.
  Eigen::MatrixXd covariances = {};
  /// Poses are those of a fixed target in the frame of a camera on the arm.
  bool is_inverse = false;
};

/// Observations of poses 0, 1 ..., of the kind kPose, or kPosition without
/// orientations: the same bits as a file with these numbers. O(M).
/// @throws InputError whose key is the member that is wrong ("orientations"),
/// and whose message names the observation, from 0.
ObservationBlock MakeObservations(const StatedPoses& stated);

}  // namespace alidade

#endif  // ALIDADE_STATED_POSES_H_
