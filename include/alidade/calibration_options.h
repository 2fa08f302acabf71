#ifndef ALIDADE_CALIBRATION_OPTIONS_H_
#define ALIDADE_CALIBRATION_OPTIONS_H_

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "alidade/dataset.h"
#include "alidade/error_terms.h"
#include "alidade/identifiability.h"
#include "alidade/references.h"
#include "alidade/robust_loss.h"
#include "alidade/solver.h"
#include "alidade/uncertainty.h"

namespace alidade {

/// What was measured, and against what.
struct CalibrationData {
  CalibrationData() = default;
  /// Measurements to fit, and nothing else.
  CalibrationData(Dataset measured)  // NOLINT: what most calibrations have
      : training(std::move(measured)) {}

  Dataset training;
  /// Points and planes that observations name; empty for positions and poses.
  References references;
  /// Measurements that the fit does not use: the error there is the accuracy
  /// that can be expected elsewhere.
  std::optional<Dataset> validation;
};

enum class SolverName { kCeres, kPseudoInverse };

/// Where the size of the joints' priors comes from.
enum class PriorScale {
  kGiven,      ///< PriorTolerances
  kEstimated,  ///< one factor for angles and one for lengths, from the data
};

/// Which errors that are not rigid geometry (error_terms.h) are estimated.
enum class ErrorTermSelection {
  kNone,    ///< none; those of the arm stay as they are
  kAuto,    ///< what the measurements have evidence for
  kStated,  ///< those of ErrorTermOptions
};

/// Error terms to estimate, instead of those that the arm has.
struct ErrorTermOptions {
  ErrorTermSelection selection = ErrorTermSelection::kNone;
  /// The terms of kStated, each of all joints.
  bool elasticity = false;
  /// Length of the joint functions' prior (rad): how far values of a function
  /// resemble each other; 0 = no functions.
  double function_length = 0.0;
  std::vector<double> harmonics;  ///< cycles per turn of the joint
  bool scale = false;             ///< of joint values
  bool backlash = false;
  /// Effects of all covariates of the data.
  bool covariates = false;
  /// Joints (from 0) that move with the values of others: {joint, other}.
  std::vector<std::pair<int, int>> coupling;
  /// What covariates may do, with any selection but kNone; those that are not
  /// here move the base.
  std::vector<CovariateUse> uses;
};

/// How poses that the fit does not use are drawn.
enum class HoldOutBy {
  kPose,    ///< one by one
  kBlock,   ///< runs of consecutive ones, of which twenty are all data
  kRegion,  ///< those near to each other in joint space
};

/// Poses that the fit does not use, drawn from the training data by
/// configuration, so that repeats of a pose stay together. Errors that are
/// alike at neighbouring poses are seen where neighbours are held out together.
struct HoldOutOptions {
  HoldOutBy by = HoldOutBy::kPose;
  double fraction = 0.3;  ///< of the configurations; in (0, 1)
  std::uint64_t seed = 1;
};

/// Cross-validation: the fit is repeated for every fold, and the errors of the
/// poses left out of each are pooled. The result itself is of the fit to all
/// poses.
struct FoldsOptions {
  int folds = 5;  ///< >= 2
  std::uint64_t seed = 1;
};

/// Limits of a parameter in the solve (rad, m; absolute values).
struct ParameterBounds {
  std::string parameter;  ///< its name: "d3"
  double lower = 0.0;
  double upper = 0.0;
};

/// Acceptance limits (m); absent = not asked for.
struct AcceptanceLimits {
  std::optional<double> train_rms;
  std::optional<double> train_max;
  std::optional<double> validation_rms;
  std::optional<double> validation_max;
  /// Of orientations (rad).
  std::optional<double> train_rotation_rms;
  std::optional<double> train_rotation_max;
  std::optional<double> validation_rotation_rms;
  std::optional<double> validation_rotation_max;
};

/// How an arm is calibrated. The defaults suit an industrial arm whose base and
/// tool are known and whose measurements have the sigmas that the data state.
struct CalibrationOptions {
  /// Which parameters are candidates, and what is done with those that the
  /// measurements cannot determine. `identifiability.candidates.base` and
  /// `.tool` add the two frames to the joints.
  IdentifiabilityOptions identifiability;
  PriorScale prior_scale = PriorScale::kGiven;
  ErrorTermOptions errors;
  SolverName solver = SolverName::kCeres;
  SolverOptions solver_options;
  /// Against outliers; SolverName::kCeres only.
  LossKind loss = LossKind::kNone;
  /// The sigmas of lengths and of orientations are estimated from the
  /// residuals; those of the data are a first guess.
  bool estimate_sigma = false;
  /// Where sigma is estimated: those of the data are not only a guess, but what
  /// is known of the instrument. What the estimate has beyond them, the model
  /// lacks.
  bool sigmas_are_stated = false;
  std::vector<ParameterBounds> bounds;  ///< SolverName::kCeres only
  /// Splits the training data where there are no validation data.
  std::optional<HoldOutOptions> holdout;
  std::optional<FoldsOptions> folds;
  UncertaintyOptions uncertainty;
  AcceptanceLimits acceptance;
  /// Further solvers to run on the same data, for comparison.
  std::vector<SolverName> compare_with;
  /// Values of the real arm, one per column of the layout, where it is known
  /// (a simulation): results then state the true error.
  std::optional<Eigen::VectorXd> true_values;
  /// Results do not depend on it. >= 1.
  int num_threads = 1;

  /// False with a message that names the field, its value and the constraint.
  bool IsValid(std::string* error) const;
};

}  // namespace alidade

#endif  // ALIDADE_CALIBRATION_OPTIONS_H_
