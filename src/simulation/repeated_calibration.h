#ifndef ALIDADE_SRC_SIMULATION_REPEATED_CALIBRATION_H_
#define ALIDADE_SRC_SIMULATION_REPEATED_CALIBRATION_H_

#include <Eigen/Core>
#include <vector>

#include "alidade/dataset.h"
#include "alidade/identifiability.h"
#include "alidade/robust_loss.h"
#include "src/kernel/measurement_model.h"
#include "src/solve/solve.h"
#include "src/uncertainty/covariance.h"

namespace alidade::internal {

/// What does not change when an arm is calibrated again and again with the same
/// poses and sigmas: which parameters can be distinguished depends on these
/// alone, not on what is measured, so that the identifiability pass is made
/// once and each calibration is a solve and a covariance.
class RepeatedCalibration {
 public:
  struct Options {
    LossKind loss = LossKind::kNone;
    /// Sigma is taken from the residuals of each calibration: one factor for
    /// all sigmas.
    bool estimate_sigma = false;
    SolverOptions solver;
  };

  struct Outcome {
    bool is_usable = false;
    Eigen::VectorXd values;
    double cost = 0.0;  ///< with priors, as the solver counts
    double reduced_chi_square = 0.0;
    ParameterCovariance covariance;
    /// What the sigmas of the data were multiplied by.
    double sigma_factor = 1.0;
  };

  /// `pass`: of this model and of poses and sigmas like those to come. The
  /// model outlives the object.
  RepeatedCalibration(const MeasurementModel& model,
                      const IdentifiabilityResult& pass, Options options);

  const std::vector<int>& free_columns() const { return free_columns_; }
  const Eigen::VectorXd& priors() const { return priors_; }
  const std::vector<RobustLoss>& losses() const { return losses_; }

  /// From the nominal values. Safe to call from several threads; where sigma is
  /// estimated beside priors, `data` is scaled and solved once more.
  Outcome Run(const Dataset& data) const;

  /// The problem of one data set, for profiles of it.
  CalibrationProblem ProblemOf(const Dataset& data) const;

 private:
  void Assess(const Dataset& data, Outcome* outcome) const;

  const MeasurementModel& model_;
  const std::vector<int> free_columns_;
  const RankReport start_rank_;
  const Eigen::VectorXd priors_;
  const Options options_;
  const std::vector<RobustLoss> losses_;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SIMULATION_REPEATED_CALIBRATION_H_
