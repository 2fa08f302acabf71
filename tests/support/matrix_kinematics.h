#ifndef ALIDADE_TESTS_SUPPORT_MATRIX_KINEMATICS_H_
#define ALIDADE_TESTS_SUPPORT_MATRIX_KINEMATICS_H_

#include <Eigen/Core>
#include <cmath>
#include <vector>

#include "alidade/arm.h"
#include "alidade/parameter_layout.h"
#include "tests/support/matrix_basics.h"
#include "tests/support/matrix_errors.h"

namespace alidade::internal::testing {

/// An independent forward kinematics: the convention of docs/conventions.md
/// written out as products of 4 x 4 matrices (matrix_basics.h), with the error
/// terms of the arm (matrix_errors.h), and its derivatives by differences. It
/// shares nothing with the library but the structs Arm and ParameterLayout.

/// The rotation matrix of a rotation vector, by way of its unit quaternion.
Matrix3l MatrixFromVector(const Vector3l& w);

/// The values of an arm, one per column of its layout without references;
/// rotations of base and tools are zero (they act on the arm's own).
VectorXl MatrixValues(const Arm& arm);

/// T(j, j + 1) of the joint with index `j` from 0.
Matrix4l JointMatrix(const Arm& nominal, const ParameterLayout& layout,
                     const VectorXl& values, int j, double q,
                     const MatrixJointError& error = {});

/// Base or tool with its translation and small rotation taken from `values`.
Matrix4l FrameMatrix(const Eigen::Isometry3d& nominal, const VectorXl& values,
                     int translation_column, int rotation_column);

/// instrument_from_target of `nominal` with its parameters replaced by
/// `values`, at `joint_values` (n values). `layout` is the arm's, with any
/// references. Error terms are those of `nominal`, whose geometry moments are
/// taken of.
Matrix4l MatrixTargetFrame(const Arm& nominal, const ParameterLayout& layout,
                           const VectorXl& values, const double* joint_values,
                           int target = 0, const double* covariates = nullptr);

Matrix4l MatrixTargetFrame(const Arm& nominal, const VectorXl& values,
                           const double* joint_values, int target = 0);

/// instrument_from_target of an arm as it is.
Matrix4l MatrixTargetFrame(const Arm& arm, const double* joint_values);

/// The target's position (m).
Vector3l MatrixPosition(const Arm& nominal, const VectorXl& values,
                        const double* joint_values, int target = 0);

Vector3l MatrixPosition(const Arm& arm, const double* joint_values);

/// d position / d parameters, 3 x (columns of the layout), by central
/// differences over h, h / 2 and h / 4 with two Richardson extrapolations.
///
/// With h = 2^-9 = 2e-3 the truncation is of order h^6 / (64 * 5040), about
/// 2e-22; a few dozen roundings of 5e-20 divided by h / 4 make about 1e-14.
/// Both are in units of the reach for derivatives by angles, of one for those
/// by lengths.
Matrix3Xl MatrixJacobian(const Arm& nominal, const VectorXl& values,
                         const double* joint_values);

}  // namespace alidade::internal::testing

#endif  // ALIDADE_TESTS_SUPPORT_MATRIX_KINEMATICS_H_
