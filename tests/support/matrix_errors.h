#ifndef ALIDADE_TESTS_SUPPORT_MATRIX_ERRORS_H_
#define ALIDADE_TESTS_SUPPORT_MATRIX_ERRORS_H_

#include <Eigen/Core>
#include <cmath>
#include <vector>

#include "alidade/arm.h"
#include "tests/support/matrix_basics.h"

namespace alidade::internal::testing {

/// The equations of error_terms.h in long double, over products of 4 x 4
/// matrices and with the moments as plain sums over all loads. They share
/// nothing with the library but its structs.

/// What the error terms do to one joint.
struct MatrixJointError {
  long double shift = 0.0L;  ///< of the joint value
  long double tilt_x = 0.0L;
  long double tilt_y = 0.0L;
};

/// The function between knots, which falls to zero within one spacing beyond
/// the first and the last; or goes on after a turn.
long double MatrixFunction(const JointFunction& function, long double q);

/// Base to the point of a joint's axis before r, and base to its frame, of the
/// arm that moments are taken of.
struct RigidFrames {
  std::vector<Matrix4l> on_axis;
  std::vector<Matrix4l> after;
};

RigidFrames RigidFramesOf(const Arm& arm, const double* q);

/// The moment of all loads from joint j on about its axis' point, in the axes
/// of its frame. `more`: mass beside that of the payload.
Vector3l MatrixMoment(const Arm& arm, const RigidFrames& frames, int j,
                      long double more = 0.0L);

/// `covariates`: one for each of the arm's, or null.
std::vector<MatrixJointError> MatrixErrors(const Arm& arm, const double* q,
                                           const double* covariates = nullptr);

/// How covariates move the base, or the targets in the last frame.
Matrix4l MotionBy(const Arm& arm, const double* covariates, bool of_base);

/// Rot(x, t_x) Rot(y, t_y), by 2 atan(t / 2).
Matrix4l TiltMatrix(const MatrixJointError& error);

}  // namespace alidade::internal::testing

#endif  // ALIDADE_TESTS_SUPPORT_MATRIX_ERRORS_H_
