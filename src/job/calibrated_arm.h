#ifndef ALIDADE_SRC_JOB_CALIBRATED_ARM_H_
#define ALIDADE_SRC_JOB_CALIBRATED_ARM_H_

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "alidade/arm.h"
#include "alidade/calibration_result.h"
#include "alidade/dataset.h"
#include "alidade/uncertainty.h"
#include "src/uncertainty/covariance.h"

namespace alidade::internal {

/// An arm as a result directory holds it, and how far it is to be trusted.
struct CalibratedArm {
  Arm arm;
  ParameterCovariance covariance;  ///< of the arm's own free parameters
  double confidence = 0.95;
  double sigma = 0.0;  ///< that the fit took of a coordinate (m)
  /// What the result's job has read, but for its validation data.
  std::vector<InputFile> inputs;
};

/// Whether `path` is a result: a directory with a result.json, or a JSON file
/// that is no arm.
bool IsResult(const std::string& path);

/// Reads arm.yaml and result.json of a result directory; `path` names it or its
/// result.json. Nothing where the result says nothing of its uncertainty.
/// @throws InputError.
std::optional<CalibratedArm> LoadCalibratedArm(const std::string& path);

/// Its predictions against validation data. `data`'s sigmas are
/// those of the measurement.
PredictionCheck CheckAgainst(const CalibratedArm& calibrated,
                             const Dataset& data, int num_threads);

/// Its predictions over the workspace, and against another arm that counts as
/// the true one.
struct ArmCheck {
  PredictedMap map;  ///< with true_error
  PredictionCheck check;
};
ArmCheck CheckAgainst(const CalibratedArm& calibrated, const Arm& truth,
                      int count, std::uint64_t seed);

/// The predicted map alone.
PredictedMap MapOf(const CalibratedArm& calibrated, int count,
                   std::uint64_t seed);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_JOB_CALIBRATED_ARM_H_
