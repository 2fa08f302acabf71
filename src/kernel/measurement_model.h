#ifndef ALIDADE_SRC_KERNEL_MEASUREMENT_MODEL_H_
#define ALIDADE_SRC_KERNEL_MEASUREMENT_MODEL_H_

#include <Eigen/Core>
#include <functional>
#include <utility>
#include <vector>

#include "alidade/arm.h"
#include "alidade/communicator.h"
#include "alidade/dataset.h"
#include "alidade/parameter_layout.h"
#include "alidade/references.h"

namespace alidade::internal {

/// Whitened residuals and their derivatives, stacked as Dataset says:
///
///   residuals = (predicted - measured) / sigma          (rows)
///   jacobian  = d residuals / d parameters              (rows x columns)
///
/// The sum of squared residuals is chi-square.
struct Linearization {
  Eigen::VectorXd residuals;
  Eigen::MatrixXd jacobian;
};

/// What the residuals of a whole data set come to.
struct ResidualSummary {
  double cost = 0.0;       ///< chi-square, or sum of rho(|r_i|^2)
  double max_error = 0.0;  ///< the largest error in lengths (m)
  double rms_error = 0.0;  ///< over the observations (m)
};

/// An arm, and what it is measured against, whose parameters vary: what it
/// predicts of every kind of measurement (dataset.h). Residuals come from the
/// forward kinematics that the autodiff residual of one observation
/// (observation_cost.h) uses too, Jacobians from the batched kernel
/// (docs/kernel.md).
///
/// `values` have one entry per column of the layout. Results do not depend on
/// the execution. Const methods may be called from several threads.
class MeasurementModel {
 public:
  /// @pre nominal has a joint and a target.
  explicit MeasurementModel(Arm nominal, const Execution& execution = {})
      : MeasurementModel(std::move(nominal), References(), execution) {}
  MeasurementModel(Arm nominal, References references,
                   const Execution& execution);

  const Arm& nominal() const { return nominal_; }
  const References& references() const { return references_; }
  const ParameterLayout& layout() const { return layout_; }
  /// Who reduces sums over data sets (partition.h), and by how many threads.
  const Execution& execution() const { return execution_; }
  int num_threads() const { return execution_.num_threads; }
  Communicator* communicator() const { return execution_.communicator; }

  /// Values of the nominal arm and references.
  Eigen::VectorXd NominalValues() const;
  /// The references with these values.
  References ReferencesAt(const Eigen::VectorXd& values) const;

  /// Predicted positions of a target (3 x N, m) at joint values (n x N).
  Eigen::Matrix3Xd Predict(const Eigen::VectorXd& values,
                           const SharedMatrix& joint_values,
                           int target = 0) const;

  /// Predicted minus measured, stacked, not whitened (m, rad). Zero in rows
  /// that were not measured.
  SharedVector Errors(const Eigen::VectorXd& values, const Dataset& data) const;

  /// Residuals, and the Jacobian's columns `columns` in that order, without
  /// repeats. O(N n) time.
  void Linearize(const Eigen::VectorXd& values, const Dataset& data,
                 const std::vector<int>& columns, Linearization* out) const;

  /// The size of a predicted coordinate's rounding error (m): the unit in the
  /// last place of the arm's reach. Single coordinates may be off by twice it.
  double RoundingError() const;

 private:
  Arm nominal_;
  References references_;
  ParameterLayout layout_;
  Execution execution_;
};

/// Squared norm of each observation's whitened residual, from the stacked
/// errors of a model.
SharedVector SquaredNorms(const SharedVector& errors, const Dataset& data);

/// Chi-square of stacked errors: the sum of squared whitened residuals.
double ChiSquare(const SharedVector& errors, const Dataset& data);

/// Norm of each observation's error in lengths (m): of the position rows.
SharedVector LengthErrors(const SharedVector& errors, const Dataset& data);

/// Norm of the rotation vector of each measured orientation (rad), in the
/// order of observations; none for data sets without poses.
SharedVector RotationErrors(const SharedVector& errors, const Dataset& data);

/// Degrees of freedom of each observation: the rows that were measured.
Eigen::VectorXi Dimensions(const Dataset& data);

/// Parts that ForEachObservation cuts a data set into at most.
constexpr int kRowParts = 64;

/// Called with the number of a part, below kRowParts, the number of an
/// observation (counted block after block) and its whitened rows: one column
/// per derivative, the residual last. Rows that were not measured are zero.
using VisitRows =
    std::function<void(int part, Eigen::Index observation,
                       const Eigen::Ref<const Eigen::MatrixXd>& rows)>;

/// Calls `visit` once for every observation. Parts do not depend on the number
/// of threads, and neither does the order of the observations in one of them;
/// different parts are visited at the same time. So whoever keeps a sum for
/// each part and adds these up in order gets the same bits with any number of
/// threads. O(N columns) time, O(columns) memory beyond the data.
void ForEachObservation(const MeasurementModel& model,
                        const Eigen::VectorXd& values, const Dataset& data,
                        const std::vector<int>& columns,
                        const VisitRows& visit);

/// Number of the first observation of each block, and that after the last.
std::vector<Eigen::Index> FirstObservations(const Dataset& data);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_KERNEL_MEASUREMENT_MODEL_H_
