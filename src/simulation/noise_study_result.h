#ifndef ALIDADE_SRC_SIMULATION_NOISE_STUDY_RESULT_H_
#define ALIDADE_SRC_SIMULATION_NOISE_STUDY_RESULT_H_

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

namespace alidade::internal {

/// One way to calibrate, over the trials of a noise study. Root mean squares of
/// the position error against the true arm (m), one entry per trial; a trial
/// whose solver failed counts as the uncalibrated arm.
struct NoiseStudyMethod {
  std::string name;
  Eigen::VectorXd data_rms;       ///< at the poses of the data set
  Eigen::VectorXd workspace_rms;  ///< over the whole workspace
  int failed = 0;

  /// Percentile of workspace_rms or data_rms, fraction in [0, 1].
  static double Percentile(const Eigen::VectorXd& values, double fraction);
};

/// The same poses calibrated many times with fresh noise.
struct NoiseStudyResult {
  int trials = 0;
  int workspace_poses = 0;
  double sigma = 0.0;  ///< of each coordinate (m)
  std::uint64_t seed = 0;
  double data_rms_before = 0.0;  ///< of the nominal arm (m)
  double workspace_rms_before = 0.0;
  std::vector<NoiseStudyMethod> methods;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SIMULATION_NOISE_STUDY_RESULT_H_
