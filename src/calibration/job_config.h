#ifndef ALIDADE_SRC_CALIBRATION_JOB_CONFIG_H_
#define ALIDADE_SRC_CALIBRATION_JOB_CONFIG_H_

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "alidade/arm.h"
#include "alidade/calibration_result.h"
#include "alidade/dataset.h"
#include "alidade/identifiability_options.h"
#include "alidade/references.h"
#include "alidade/robust_loss.h"
#include "alidade/solver_options.h"
#include "alidade/uncertainty_options.h"

namespace alidade::internal {

enum class SolverName { kCeres, kPseudoInverse };

/// What a result directory holds: all there is, or for fleets of thousands only
/// what machines read, arm.yaml and result.json.
enum class JobOutputs { kFull, kMinimal };

/// One quantity of a study that the report prints beside ours.
struct PublishedFigure {
  std::string quantity;   ///< one of PublishedQuantityNames()
  std::string published;  ///< as the study words it
};

/// What a published study says of the same calibration.
struct PublishedStudy {
  std::string source;
  /// Deviations as its table prints them, one per column of the layout.
  Eigen::VectorXd deviations;
  int angle_decimals = 4;   ///< of rad
  int length_decimals = 1;  ///< of mm
  int baseline_iterations = 100;
  double baseline_time_s = 0.0;
  std::vector<PublishedFigure> figures;
};

/// The quantities a `published: figures:` entry may name.
const std::vector<std::string>& PublishedQuantityNames();

/// Acceptance limits (m); absent = not asked for.
struct AcceptanceLimits {
  std::optional<double> train_rms;
  std::optional<double> train_max;
  std::optional<double> heldout_rms;
  std::optional<double> heldout_max;
  /// Of orientations (rad).
  std::optional<double> train_rotation_rms;
  std::optional<double> train_rotation_max;
  std::optional<double> heldout_rotation_rms;
  std::optional<double> heldout_rotation_max;
};

/// Poses that the fit does not use, drawn from the job's own data set
/// (holdout.h).
struct HoldOutConfig {
  double fraction = 0.3;  ///< of the configurations
  std::uint64_t seed = 1;
};

/// Cross-validation: the fit is repeated for every fold (holdout.h), and the
/// errors of the poses held out of each are pooled. The result itself is of the
/// fit to all poses.
struct FoldsConfig {
  int folds = 5;
  std::uint64_t seed = 1;
};

/// Limits of a parameter in the solve (rad, m; absolute values).
struct ParameterBounds {
  int column = 0;  ///< of the layout
  double lower = 0.0;
  double upper = 0.0;
};

/// Many calibrations of the same poses with fresh noise, where the real arm is
/// known: how a method fares that is not helped by exact data.
struct NoiseStudyConfig {
  int trials = 1000;
  int workspace_poses = 2000;  ///< drawn within the limits
  std::uint64_t seed = 1;
};

/// What simulated calibrations take for the real arm.
enum class SimulatedTruth {
  kGiven,       ///< the job's `truth`
  kIdentified,  ///< the job's own result: a parametric bootstrap
  kPriors,      ///< joints drawn from their priors, anew for every trial
};

/// Many simulated calibrations of the job's arm, poses and sigmas.
struct MonteCarloConfig {
  int trials = 1000;  ///< at most
  std::uint64_t seed = 1;
  SimulatedTruth truth = SimulatedTruth::kIdentified;
  /// So many of the observations are off by a Gaussian error of this size (m in
  /// every coordinate; rad of orientations divided by the reach).
  double outlier_fraction = 0.0;
  double outlier_size = 0.0;
  /// Standard deviations with which joints miss their values (rad, m).
  double joint_angle_sigma = 0.0;
  double joint_length_sigma = 0.0;
  int workspace_poses = 200;  ///< drawn within the limits, for the true error
  /// Stop where the mean error over the workspace is known to this part of
  /// itself (half of its 95 % interval); 0 = all trials.
  double precision = 0.0;
};

/// A calibration job, its files loaded and checked against each other. Ranks
/// of a communicator have a part of `data` and `validation` each
/// (partition.h), and all else alike.
struct JobConfig {
  std::string path;
  std::string title;
  Arm arm;
  /// Points and planes that the data are measured against.
  References references;
  Dataset data;
  /// Poses not used for the fit: of a file of their own, or held out of the
  /// data's (then they are no longer in `data`).
  std::optional<Dataset> validation;
  std::optional<HoldOutConfig> holdout;
  std::optional<FoldsConfig> folds;
  /// Of the data's files, in the order of reading.
  std::vector<RejectedRow> rejected;
  std::vector<ParameterBounds> bounds;
  /// The sigmas of lengths and of orientations are estimated from the
  /// residuals; the sigmas of the data are a first guess.
  bool estimate_sigma = false;
  /// Values of the real arm, one per column of the layout, where it is known.
  std::optional<Eigen::VectorXd> truth;
  IdentifiabilityOptions identifiability;
  SolverName solver = SolverName::kCeres;
  SolverOptions solver_options;
  LossKind loss = LossKind::kNone;
  /// Further solvers to run on the same data.
  std::vector<SolverName> compare_with;
  AcceptanceLimits acceptance;
  JobOutputs outputs = JobOutputs::kFull;
  std::optional<PublishedStudy> published;
  /// How far the result is to be trusted.
  UncertaintyOptions uncertainty;
  /// What `montecarlo` simulates.
  MonteCarloConfig montecarlo;
  /// What `compare` runs besides, with the sigmas of the data set.
  std::optional<NoiseStudyConfig> noise_study;
  /// Every file read for this job, the job file first.
  std::vector<std::string> input_files;
  /// The rank that has read each of them; empty: there is one.
  std::vector<int> readers;
};

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
  /// data set states them exactly.
  int joint_decimals = 4;
  std::string output;  ///< path of the data set
  std::vector<std::string> input_files;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_JOB_CONFIG_H_
