#ifndef ALIDADE_SRC_IDENTIFIABILITY_OBSERVABILITY_H_
#define ALIDADE_SRC_IDENTIFIABILITY_OBSERVABILITY_H_

#include <Eigen/Core>

#include "alidade/identifiability.h"

namespace alidade::internal {

/// The observability indices of a pose set, each by its original definition on
/// the m singular values s_1 >= ... >= s_m of the Jacobian J of N poses (not of
/// J^T J):
///
///   O1 = (s_1 ... s_m)^(1/m) / sqrt(N)    Borm and Menq 1989, 1991
///   O2 = s_m / s_1                        Driels and Pathre 1990
///   O3 = s_m                              Nahvi, Hollerbach, Hayward 1994
///   O4 = s_m^2 / s_1                      Nahvi and Hollerbach 1996
///   O5 = 1 / (1/s_1 + ... + 1/s_m)        Sun and Hollerbach 2008
///
/// and the condition number s_1 / s_m. All are zero (the condition number
/// infinite) where J has no full column rank. `factor`: JacobianFactor of the
/// free columns, unwhitened or scaled as the caller wishes.
ObservabilityIndices ComputeObservability(const Eigen::MatrixXd& factor,
                                          Eigen::Index num_poses);

/// Standard deviations of parameters from a whitened factor R and prior
/// standard deviations (infinite = none): the square roots of the diagonal of
/// (R^T R + diag(1 / prior^2))^-1. A parameter that neither determines is
/// infinite. By singular values of the two stacked, columns brought to unit
/// norm; directions below 1e-12 of the largest count as not identifiable.
Eigen::VectorXd PredictDeviations(const Eigen::MatrixXd& whitened_factor,
                                  const Eigen::VectorXd& prior);

/// Root of the trace of the predicted variance, summed over the rows of
/// another Jacobian W of the same columns (any factor of it):
/// sqrt(trace(W (R^T R + diag(1 / prior^2))^-1 W^T)). With the Jacobian of N
/// positions in m, this over sqrt(N) is the root mean square of the position
/// error that a calibration leaves there. Infinite where neither data nor
/// priors determine a direction that W sees.
double PredictTotal(const Eigen::MatrixXd& whitened_factor,
                    const Eigen::VectorXd& prior, const Eigen::MatrixXd& other);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_IDENTIFIABILITY_OBSERVABILITY_H_
