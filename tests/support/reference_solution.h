#ifndef ALIDADE_TESTS_SUPPORT_REFERENCE_SOLUTION_H_
#define ALIDADE_TESTS_SUPPORT_REFERENCE_SOLUTION_H_

#include <Eigen/Core>
#include <vector>

#include "alidade/arm.h"
#include "alidade/dataset.h"
#include "alidade/parameter_layout.h"
#include "tests/support/matrix_kinematics.h"

namespace alidade::internal::testing {

/// An independent solution of the calibration: Gauss-Newton in long double
/// over products of 4 x 4 matrices and their exact derivatives. It shares
/// nothing with the library but Arm, Dataset and ParameterLayout. Base and
/// tool are the arm's own. Compiled once, since long double decompositions take
/// compilers a minute each.
using Vector4l = Eigen::Matrix<long double, 4, 1>;

struct ReferencePose {
  Vector3l position;
  /// d position / d parameter, 3 x (columns of the layout); the columns of base
  /// and tool are zero.
  Matrix3Xl jacobian;
};

ReferencePose EvaluateReference(const Arm& arm, const ParameterLayout& layout,
                                const VectorXl& values,
                                const double* joint_values);

struct ReferenceLinearization {
  VectorXl residuals;  ///< whitened, x y z of pose after pose
  MatrixXl jacobian;   ///< their derivatives by the chosen columns
};

/// @pre `columns` belong to joints.
ReferenceLinearization LinearizeReference(const Arm& arm,
                                          const VectorXl& values,
                                          const Dataset& data,
                                          const std::vector<int>& columns);

/// The same whitened Jacobian by another way, central differences of
/// MatrixPosition, angle columns divided by ArmReach. Its relative
/// error is some 1e-12: the truncation of the step squared, and 5e-20 of
/// rounding divided by the step.
MatrixXl ScaledDifferences(const Arm& arm, const VectorXl& values,
                           const Dataset& data,
                           const std::vector<int>& columns);

/// Singular values relative to the largest, descending.
VectorXl RelativeSingularValues(const MatrixXl& matrix);

/// Joint columns, in order, each of which has a part of `fraction` of its norm
/// or more that is orthogonal to those before: what a solver can distinguish
/// well.
std::vector<int> IndependentColumns(const Arm& arm, const VectorXl& values,
                                    const Dataset& data, long double fraction);

/// The farthest that `values` are from the measured positions at any pose (m).
double LargestError(const Arm& arm, const Eigen::VectorXd& values,
                    const Dataset& data);

/// (J^T J + diag(1 / prior^2))^-1, columns scaled to norm 1 before the inverse
/// is taken.
MatrixXl ReferenceCovariance(const MatrixXl& jacobian, const VectorXl& prior);

struct ReferenceSolution {
  VectorXl values;
  long double cost = 0.0L;  ///< chi-square at the values
  /// Standard deviations of the chosen columns, for sigmas that are those of
  /// the noise.
  VectorXl stddevs;
  bool converged = false;
};

/// The minimum of chi-square over `columns`, from `start`; the other values
/// stay. @pre the Jacobian has full rank there.
ReferenceSolution SolveReference(const Arm& arm, const VectorXl& start,
                                 const Dataset& data,
                                 const std::vector<int>& columns);

}  // namespace alidade::internal::testing

#endif  // ALIDADE_TESTS_SUPPORT_REFERENCE_SOLUTION_H_
