#ifndef ALIDADE_IDENTIFIABILITY_FACTOR_H_
#define ALIDADE_IDENTIFIABILITY_FACTOR_H_

#include <Eigen/Core>
#include <vector>

#include "alidade/measurement/geometric_jacobian.h"
#include "alidade/measurement/position_model.h"

namespace alidade {

/// Poses an analysis looks at. `sigmas` (3 x N, m) whitens the rows of
/// positions; null leaves them in metres, and puts the rows of orientations in
/// metres at the end of the reach.
struct PoseSet {
  const Eigen::MatrixXd& joint_values;
  MeasurementKind kind = MeasurementKind::kPosition;
  const Eigen::Matrix3Xd* sigmas = nullptr;
};

/// The triangular factor R (columns x columns) of the Jacobian J over all
/// poses, R^T R = J^T J, by Householder transformations of blocks that are
/// merged in a fixed order: the bits do not depend on the number of threads. R
/// stands for J in every question about its columns: norms, singular values,
/// dependencies, covariance; a selection of R's columns is a factor of the
/// selection of J's. O(N columns^2) time, O(columns^2) memory beyond the data.
Eigen::MatrixXd JacobianFactor(const PositionModel& model,
                               const Eigen::VectorXd& values,
                               const PoseSet& poses,
                               const std::vector<int>& columns);

/// What a unit of the parameter moves a point at the end of the reach by: the
/// reach for angles, 1 for lengths. Columns divided by it compare in metres.
double ColumnScale(const PositionModel& model, int column);

/// The factor with every column divided by its scale.
Eigen::MatrixXd ScaleColumns(const PositionModel& model,
                             const std::vector<int>& columns,
                             Eigen::MatrixXd factor);

/// The columns of a matrix at `indices`, in that order.
Eigen::MatrixXd SelectColumns(const Eigen::MatrixXd& matrix,
                              const std::vector<int>& indices);

}  // namespace alidade

#endif  // ALIDADE_IDENTIFIABILITY_FACTOR_H_
