#ifndef ALIDADE_SRC_DATAIO_COVARIANCE_H_
#define ALIDADE_SRC_DATAIO_COVARIANCE_H_

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace alidade::internal {

/// The noise of an observation: standard deviations (infinite where a row was
/// not measured) and, where rows are correlated, the whitener W with W^T W the
/// inverse of the covariance (zero in rows and columns not measured).
struct Noise {
  Eigen::VectorXd sigmas;
  Eigen::MatrixXd whitener;  ///< empty: the sigmas say it all
};

/// Of independent rows.
Noise IndependentNoise(const Eigen::VectorXd& sigmas);

/// Of rows with a covariance, those not measured left out; nothing where that
/// of the others is not positive definite. By Cholesky's factors: C = L L^T,
/// W = L^-1.
std::optional<Noise> CorrelatedNoise(const Eigen::MatrixXd& covariance,
                                     const std::vector<bool>& is_measured);

/// Of one observation's rows after another's, independent of each other.
Noise StackNoise(const Noise& top, const Noise& bottom);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATAIO_COVARIANCE_H_
