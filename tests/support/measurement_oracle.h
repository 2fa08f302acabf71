#ifndef ALIDADE_TESTS_SUPPORT_MEASUREMENT_ORACLE_H_
#define ALIDADE_TESTS_SUPPORT_MEASUREMENT_ORACLE_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "alidade/arm.h"
#include "alidade/dataset.h"
#include "alidade/parameter_layout.h"
#include "alidade/references.h"
#include "tests/support/matrix_kinematics.h"

namespace alidade::internal::testing {

/// An arm and its references, the values that they really have, and what was
/// measured: what the functions below predict of every kind of measurement, by
/// the table of dataset.h in long double, over products of 4 x 4 matrices, and
/// its derivatives by differences. They share nothing with the library but its
/// structs.
struct MeasuredArm {
  Arm arm;
  References references;
  ParameterLayout layout;
  Eigen::VectorXd values;
  Dataset data;
};

/// The rotation vector of a rotation matrix that is the nearest to `near`: the
/// shortest for zero. By the angle and the axis, the axis from the odd part of
/// the matrix for turns below 120 degrees and from the even part beyond.
Vector3l LogOfMatrix(const Matrix3l& matrix,
                     const Vector3l& near = Vector3l::Zero());

/// The tangents t1, t2 of a normal n as x and y (n_z > 0) or x and -y of the
/// frame that the smallest rotation from z or -z to n makes of the axes.
void TangentsOf(const Vector3l& n, Vector3l* t1, Vector3l* t2);

/// The normal of the plane number `plane` with its tilts among `values`.
Vector3l OracleNormal(const MeasuredArm& measured, const VectorXl& values,
                      int plane);

Vector3l OraclePoint(const MeasuredArm& measured, const VectorXl& values,
                     int point);

/// Of a target at a pose of the data set, instrument from target.
Matrix4l OracleFrame(const MeasuredArm& measured, const VectorXl& values,
                     int pose, int target);

Vector3l OraclePosition(const MeasuredArm& measured, const VectorXl& values,
                        int pose, int target);

/// The residual of observation i of a block, not whitened; an orientation's
/// rotation vector is the one nearest to `near`.
VectorXl OracleResidual(const MeasuredArm& measured, const VectorXl& values,
                        const ObservationBlock& block, Eigen::Index i,
                        const Vector3l& near = Vector3l::Zero());

/// The matrix that whitens observation i: the whitener, or one over the sigmas
/// and zero where nothing was measured.
MatrixXl OracleWhitener(const ObservationBlock& block, Eigen::Index i);

/// d residual / d parameters of observation i, not whitened, by differences as
/// MatrixJacobian takes them: their error is some 1e-14 in units of the reach
/// where the residual is as smooth as positions are. `near` as above.
MatrixXl OracleJacobian(const MeasuredArm& measured, const VectorXl& values,
                        const ObservationBlock& block, Eigen::Index i,
                        const Vector3l& near = Vector3l::Zero());

}  // namespace alidade::internal::testing

#endif  // ALIDADE_TESTS_SUPPORT_MEASUREMENT_ORACLE_H_
