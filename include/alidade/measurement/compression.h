#ifndef ALIDADE_MEASUREMENT_COMPRESSION_H_
#define ALIDADE_MEASUREMENT_COMPRESSION_H_

#include <Eigen/Core>
#include <vector>

#include "alidade/measurement/dataset.h"
#include "alidade/measurement/measurement_model.h"
#include "alidade/measurement/robust_loss.h"

namespace alidade {

/// The triangular factor R (columns x columns) of the whitened Jacobian J over
/// a whole data set, R^T R = J^T J, by Householder transformations of blocks
/// that are merged in a fixed order: the bits do not depend on the number of
/// threads. R stands for J in every question about its columns: norms,
/// singular values, dependencies, covariance; a selection of R's columns is a
/// factor of the selection of J's. O(N columns^2) time, O(columns^2) memory
/// beyond the data.
Eigen::MatrixXd JacobianFactor(const MeasurementModel& model,
                               const Eigen::VectorXd& values,
                               const Dataset& data,
                               const std::vector<int>& columns);

/// The sum of rho(|r_i|^2) over the observations, from the stacked errors of a
/// model; `losses` of 1, 2 ... rows, empty for chi-square.
double RobustChiSquare(const Eigen::VectorXd& errors, const Dataset& data,
                       const std::vector<RobustLoss>& losses);

/// A least-squares problem in few rows that has the cost, the gradient and the
/// Gauss-Newton matrix of a whole data set.
struct CompressedProblem {
  Eigen::MatrixXd factor;     ///< R of J, columns x columns
  Eigen::VectorXd projected;  ///< Q^T r, columns
  double cost = 0.0;          ///< chi-square, or sum of rho(|r_i|^2)
};

/// Compresses [J r], the rows of each observation scaled by sqrt(rho'(|r|^2))
/// of the loss for the observation's dimension (`losses`, of 1, 2 ... rows;
/// empty for least squares), so that R^T R = sum rho' J^T J and
/// R^T projected = sum rho' J^T r, half the gradient of the cost. Losses have
/// rho'' <= 0 (Triggs et al. 2000, "Bundle adjustment", section 4.3, where the
/// second-order term is left out).
CompressedProblem Compress(const MeasurementModel& model,
                           const Eigen::VectorXd& values, const Dataset& data,
                           const std::vector<int>& columns,
                           const std::vector<RobustLoss>& losses);

}  // namespace alidade

#endif  // ALIDADE_MEASUREMENT_COMPRESSION_H_
