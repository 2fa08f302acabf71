#ifndef ALIDADE_RUN_FILE_H_
#define ALIDADE_RUN_FILE_H_

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "alidade/arm.h"
#include "alidade/dataset.h"
#include "alidade/monte_carlo.h"
#include "alidade/plan.h"

namespace alidade {

// What the program's commands do with files besides calibrations (job.h), and
// the same of arms and data that are there already. All throw InputError with
// file, line, column and key.

/// The plan of a plan file (docs/planning.md). Writes nothing.
PlanResult RunPlanFile(const std::string& path, int num_threads = 1);

/// The study of a job file's `montecarlo`. Writes nothing.
MonteCarloResult RunMonteCarloFile(const std::string& path, int num_threads = 1,
                                   const TrialProgress& progress = {});

/// What a simulation file (docs/files.md) gives.
struct SimulatedMeasurements {
  Arm arm;             ///< nominal
  Arm real;            ///< what was measured
  Dataset data;        ///< sigmas are those of the noise; 1 m without noise
  double sigma = 0.0;  ///< of each coordinate (m)
  std::uint64_t seed = 0;
  std::string output;  ///< path of the data set that the file names
};
SimulatedMeasurements RunSimulationFile(const std::string& path);

/// Positions of the real arm's first target at joint values (n x N; rad, m),
/// computed in extended precision, with Gaussian noise of standard deviation
/// `sigma` (m) in each coordinate; pose k draws from stream k of the seed.
/// @throws InputError where positions are not finite.
Dataset SimulatePositions(const Arm& real, const Eigen::MatrixXd& joint_values,
                          double sigma, std::uint64_t seed);

/// `count` configurations (n x count) drawn uniformly within the limits; a
/// joint without limits draws from a full turn, or the reach to both sides.
Eigen::MatrixXd DrawConfigurations(const Arm& arm, int count,
                                   std::uint64_t seed);

/// An arm as others write it.
struct ExportedArm {
  std::string text;
  std::vector<std::string> lost;  ///< what it cannot say, a sentence each
  Accuracy cost;  ///< what that moves targets by over the workspace (m)
};

/// `format`: "dh", "mdh", "offsets", "ur", "urdf" or "json" (docs/robot.md);
/// `table` of the first three: "csv", "yaml" or "latex". `nominal_path`: of
/// "urdf" the arm file that names the URDF, else it may be empty. Base and
/// tool are those of `nominal`.
ExportedArm ExportArm(const Arm& nominal, const Arm& real,
                      const std::string& format,
                      const std::string& table = "csv",
                      const std::string& nominal_path = "");

/// Writes a data set of positions or poses where LoadDataset reads it: CSV, or
/// where the name ends in ".npy" a NumPy array, joint values and positions to
/// the same bits.
void SaveDataset(const Dataset& data, const Arm& arm, const std::string& path);

}  // namespace alidade

#endif  // ALIDADE_RUN_FILE_H_
