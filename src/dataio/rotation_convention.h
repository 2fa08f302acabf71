#ifndef ALIDADE_SRC_DATAIO_ROTATION_CONVENTION_H_
#define ALIDADE_SRC_DATAIO_ROTATION_CONVENTION_H_

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace alidade::internal {

/// How three numbers rx, ry, rz (rad) state an orientation R.
///
/// Euler angles a, b, c in a sequence of axes, "xyz" or any other:
///
///   intrinsic_xyz   R = Rot(x, a) Rot(y, b) Rot(z, c)   about the axes that
///                                                       turn along
///   extrinsic_xyz   R = Rot(z, c) Rot(y, b) Rot(x, a)   about fixed axes
///
/// Where the three axes differ, rx is the angle about x, ry that about y and rz
/// that about z, whatever the order. In sequences such as "zyz", rx, ry, rz are
/// the first, the second and the third angle.
///
/// rotation_vector: axis times angle.
struct RotationConvention {
  bool is_vector = false;
  bool is_intrinsic = true;
  std::array<int, 3> axes = {0, 1, 2};  ///< first to third; 0 = x, 1 = y, 2 = z
};

/// "intrinsic_xyz" ... all 24 of Euler angles, and "rotation_vector".
const std::vector<std::string>& RotationConventionNames();

/// The convention of a name, or nothing where no convention has it.
std::optional<RotationConvention> FindRotationConvention(std::string_view name);

/// R of (rx, ry, rz).
Eigen::Matrix3d RotationOf(const RotationConvention& convention,
                           const Eigen::Vector3d& numbers);

/// The rotation nearest to a rounded one; nothing where it is none to within
/// 0.001.
std::optional<Eigen::Matrix3d> RotationOfMatrix(const Eigen::Matrix3d& matrix);

/// R of a quaternion w, x, y, z; nothing where its norm is not 1 to within
/// 0.001.
std::optional<Eigen::Matrix3d> RotationOfQuaternion(
    const Eigen::Vector4d& numbers);

/// The numbers of R: of the many that state it, angles nearest to `near`; in
/// gimbal lock the first angle is that of `near`. A rotation vector is the one
/// of at most half a turn, or, where `near` is longer, with whole turns added.
Eigen::Vector3d NumbersOf(const RotationConvention& convention,
                          const Eigen::Matrix3d& rotation,
                          const Eigen::Vector3d& near);

/// The axes that R turns about, on the left, as its numbers grow: with B what
/// is returned, R(numbers + e) = Exp(B e) R(numbers) to first order. Singular
/// in gimbal lock.
Eigen::Matrix3d TurningAxes(const RotationConvention& convention,
                            const Eigen::Vector3d& numbers);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATAIO_ROTATION_CONVENTION_H_
