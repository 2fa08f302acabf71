#ifndef ALIDADE_SRC_SIMULATION_SIMULATION_H_
#define ALIDADE_SRC_SIMULATION_SIMULATION_H_

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "alidade/arm.h"
#include "alidade/dataset.h"

namespace alidade::internal {

/// count values from `from` to `to`, both included.
struct Range {
  double from = 0.0;
  double to = 0.0;
  int count = 1;
};

/// Targets on cylinders about the base's z axis: every azimuth with every
/// radius at one height, found by inverse kinematics of the nominal arm. The
/// elevation of the last joint's z axis above the horizontal is drawn for each
/// pose; it is drawn again where no joint values within the limits reach it.
struct CylinderGrid {
  Range azimuth;                ///< rad
  Range radius;                 ///< m
  double height = 0.0;          ///< m
  double elevation_from = 0.0;  ///< rad
  double elevation_to = 0.0;
  /// Joint values the inverse kinematics starts from: chooses the posture.
  Eigen::VectorXd start;
};

/// Joint values drawn uniformly within the limits.
struct RandomPoses {
  int count = 0;
};

/// The joint values of another data set.
struct PosesFromFile {
  std::string path;
  Eigen::MatrixXd joint_values;
};

/// What `simulate` needs: a nominal arm that poses are planned with, the
/// values of the real one, and how it is measured.
struct SimulationConfig {
  std::string path;
  std::string title;
  Arm arm;
  Eigen::VectorXd true_values;  ///< one per column of the layout
  std::variant<CylinderGrid, RandomPoses, PosesFromFile> poses;
  double noise_sigma = 0.0;  ///< of each coordinate (m); 0 = exact
  std::uint64_t seed = 1;
  /// Decimals (of deg or mm) that joint values are rounded to, so that the
  /// data set states them exactly; below 0: not rounded.
  int joint_decimals = 4;
  std::string output;  ///< path of the data set
  std::vector<std::string> input_files;
};

/// Measures the real arm of a simulation: plans the poses with the nominal arm
/// (inverse kinematics, random draws or a file), rounds the joint values to the
/// decimals that the data set states, evaluates the real arm there in extended
/// precision, and adds Gaussian noise. Extended precision makes the positions
/// correctly rounded, so that the same seed gives the same bytes on machines
/// whose sine differs in the last digit.
///
/// Pose k draws from stream k of the seed: it does not depend on the poses
/// before it. `sigmas` of the result hold the noise (1 m where it is zero).
///
/// @throws InputError where no joint values within the limits reach a target.
Dataset Simulate(const SimulationConfig& config);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SIMULATION_SIMULATION_H_
