#ifndef ALIDADE_SRC_KERNEL_REDUCTION_H_
#define ALIDADE_SRC_KERNEL_REDUCTION_H_

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "alidade/dataset.h"
#include "alidade/robust_loss.h"
#include "src/common/memory.h"
#include "src/kernel/measurement_model.h"

namespace alidade::internal {

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

/// The instruction set that vector code uses on this machine ("AVX2"). Machines
/// with the same one give the same bits.
std::string VectorInstructions();

/// The sum of rho(|r_i|^2) over the observations, from the stacked errors of a
/// model; `losses` of 1, 2 ... rows, empty for chi-square.
double RobustChiSquare(const SharedVector& errors, const Dataset& data,
                       const std::vector<RobustLoss>& losses);

/// A least-squares problem in few rows that has the cost, the gradient and the
/// Gauss-Newton matrix of a whole data set, priors included.
struct ReducedLeastSquares {
  Eigen::MatrixXd factor;     ///< R of J, columns x columns
  Eigen::VectorXd projected;  ///< Q^T r, columns
  double cost = 0.0;          ///< chi-square, or sum of rho(|r_i|^2)
};

/// How the rows of a data set are brought down to a triangle.
enum class Factorization {
  /// Products where they are good enough, Householder's transformations where
  /// not. Products are where |S| |S^-1| <= 1e4 in Frobenius' norm, S being
  /// their
  /// R with columns of norm 1: they lose some 1e8 eps of a step's length then,
  /// which the next step mends, and at that condition Cholesky's R gives it to
  /// as many digits. Behind a failure transformations, until their R shows that
  /// products do again.
  kAutomatic,
  kOrthogonal,  ///< Householder's transformations always: backward stable
  kGram,        ///< products [J r]^T [J r] and Cholesky: for comparisons
};

struct ReducerOptions {
  Factorization factorization = Factorization::kAutomatic;
  /// What is kept of sines, cosines, measured values and sigmas in the order of
  /// the kernel (bytes). Of what does not fit they are taken anew at every
  /// evaluation. By default half of MemoryLimit(), at most 2 GiB.
  std::size_t cache_bytes = std::min(std::size_t{1} << 31, MemoryLimit() / 2);
  /// Gaussian priors, each of which is an observation besides those of the
  /// data: standard deviations about the model's nominal values, one entry per
  /// column of the layout, NaN or infinite where there is none; or empty.
  Eigen::VectorXd priors = {};
};

/// Reduces one data set again and again, at changing parameter values.
/// Nothing is allocated after the first evaluation but threads, where there are
/// several. Work is done by as many
/// threads as the model has; parts and the order in which they are merged are
/// fixed, so that bits do not depend on it.
class Reducer {
 public:
  /// `losses`: of 1, 2 ... rows; empty for least squares. The model and the
  /// data outlive the object and do not change. Takes O(N) time for sines and
  /// cosines.
  Reducer(const MeasurementModel& model, const Dataset& data,
          const std::vector<int>& columns,
          const std::vector<RobustLoss>& losses = {},
          const ReducerOptions& options = {});
  ~Reducer();
  Reducer(const Reducer&) = delete;
  Reducer& operator=(const Reducer&) = delete;

  /// [J r], the rows of each observation scaled by sqrt(rho'(|r|^2)) of the
  /// loss for the observation's dimension, so that R^T R = sum rho' J^T J and
  /// R^T projected = sum rho' J^T r, half the gradient of the cost. Losses have
  /// rho'' <= 0 (Triggs et al. 2000, "Bundle adjustment", section 4.3, where
  /// the second-order term is left out). O(N columns^2).
  void Reduce(const Eigen::VectorXd& values, ReducedLeastSquares* problem);

  /// The cost alone, O(N). Known without work where `values` are those of the
  /// last evaluation of either kind.
  const ResidualSummary& Summarize(const Eigen::VectorXd& values);

  /// Whether the last call of Reduce used products.
  bool used_gram() const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_KERNEL_REDUCTION_H_
