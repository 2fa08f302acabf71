#ifndef ALIDADE_SRC_SIMULATION_SIMULATED_DATA_H_
#define ALIDADE_SRC_SIMULATION_SIMULATED_DATA_H_

#include <Eigen/Core>

#include "alidade/dataset.h"
#include "alidade/monte_carlo.h"
#include "src/common/random.h"
#include "src/kernel/measurement_model.h"

namespace alidade::internal {

/// Sets what `data` says was measured to what the arm with these values would
/// show at `joint_values`, without noise. @pre no contacts (kFixedPoint,
/// kPlane), whose measured values are zero by definition.
void MeasureExactly(const MeasurementModel& model,
                    const Eigen::VectorXd& values,
                    const SharedMatrix& joint_values, Dataset* data);

/// Adds Gaussian noise of the data's own sigmas (or covariances) to every
/// measured row, and gross errors to some observations.
void AddNoise(const MonteCarloOptions& config, double reach, Random* random,
              Dataset* data);

/// Joint values that the arm really takes: off by its repeatability.
Eigen::MatrixXd MissedJointValues(const MonteCarloOptions& config,
                                  const Arm& arm,
                                  const SharedMatrix& joint_values,
                                  Random* random);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SIMULATION_SIMULATED_DATA_H_
