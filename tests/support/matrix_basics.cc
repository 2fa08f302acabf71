#include "tests/support/matrix_basics.h"

namespace alidade::internal::testing {

Matrix4l RotationX(long double angle) {
  const long double c = std::cos(angle);
  const long double s = std::sin(angle);
  Matrix4l matrix;
  matrix << 1, 0, 0, 0, 0, c, -s, 0, 0, s, c, 0, 0, 0, 0, 1;
  return matrix;
}

Matrix4l RotationY(long double angle) {
  const long double c = std::cos(angle);
  const long double s = std::sin(angle);
  Matrix4l matrix;
  matrix << c, 0, s, 0, 0, 1, 0, 0, -s, 0, c, 0, 0, 0, 0, 1;
  return matrix;
}

Matrix4l RotationZ(long double angle) {
  const long double c = std::cos(angle);
  const long double s = std::sin(angle);
  Matrix4l matrix;
  matrix << c, -s, 0, 0, s, c, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1;
  return matrix;
}

Matrix4l Translation(const Vector3l& offset) {
  Matrix4l matrix = Matrix4l::Identity();
  matrix.topRightCorner<3, 1>() = offset;
  return matrix;
}

}  // namespace alidade::internal::testing
