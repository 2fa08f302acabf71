#ifndef ALIDADE_SRC_DATAIO_ORIENTATION_CELLS_H_
#define ALIDADE_SRC_DATAIO_ORIENTATION_CELLS_H_

#include <Eigen/Core>
#include <optional>

namespace alidade::internal {

/// The rotation of a quaternion w, x, y, z as files state it; nothing where its
/// norm is not 1 to within 0.001.
std::optional<Eigen::Matrix3d> RotationOfQuaternion(
    const Eigen::Vector4d& wxyz);

/// The rotation of a rotation vector (rad) of any length.
Eigen::Matrix3d RotationOfVector(const Eigen::Vector3d& vector);

/// The rotation vector that an observation keeps, |w| <= pi (rad).
Eigen::Vector3d MeasuredVector(const Eigen::Matrix3d& rotation);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATAIO_ORIENTATION_CELLS_H_
