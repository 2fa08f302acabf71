#ifndef ALIDADE_TESTS_SUPPORT_MATRIX_BASICS_H_
#define ALIDADE_TESTS_SUPPORT_MATRIX_BASICS_H_

#include <Eigen/Core>
#include <cmath>

namespace alidade::internal::testing {

/// Rotations and translations as 4 x 4 matrices in long double (64 bits of
/// mantissa on x86).
using VectorXl = Eigen::Matrix<long double, Eigen::Dynamic, 1>;
using Vector3l = Eigen::Matrix<long double, 3, 1>;
using Matrix3l = Eigen::Matrix<long double, 3, 3>;
using Matrix4l = Eigen::Matrix<long double, 4, 4>;
using MatrixXl = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
using Matrix3Xl = Eigen::Matrix<long double, 3, Eigen::Dynamic>;

Matrix4l RotationX(long double angle);

Matrix4l RotationY(long double angle);

Matrix4l RotationZ(long double angle);

Matrix4l Translation(const Vector3l& offset);

}  // namespace alidade::internal::testing

#endif  // ALIDADE_TESTS_SUPPORT_MATRIX_BASICS_H_
