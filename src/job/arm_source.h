#ifndef ALIDADE_SRC_JOB_ARM_SOURCE_H_
#define ALIDADE_SRC_JOB_ARM_SOURCE_H_

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "alidade/accuracy.h"
#include "alidade/arm.h"
#include "src/job/calibrated_arm.h"

namespace alidade::internal {

/// An arm that a command works with: an arm file, or the arm.yaml of a result.
/// @throws InputError.
Arm LoadArmOrResult(const std::string& path);

/// A calibrated arm and what a correction needs beside it.
struct ArmSource {
  Arm real;
  Arm nominal;
  std::string nominal_path;
  /// Where a result states its uncertainty.
  std::optional<CalibratedArm> calibrated;
  /// Least and largest joint value of the training poses (n x 2); 0 x 0 where
  /// they are not known.
  Eigen::MatrixXd measured;
  /// Of a result: its errors at validation poses, and those of the nominal arm
  /// at training poses, base and tool fitted; n = 0 where it has none.
  Accuracy validation;
  Accuracy before;
  std::vector<std::string> inputs;  ///< files that were read
};

/// `path` is an arm file, which needs the nominal one beside it, or a result
/// directory. Of that the nominal arm is the first arm file among its inputs
/// that is still what it was, unless `nominal_path` says otherwise.
/// @throws InputError, also where both arms are not of the same joints.
ArmSource LoadArmSource(const std::string& path,
                        const std::string& nominal_path);

/// The arm that its controller is taken to compute with: "Universal Robots UR10
/// (robots/ur10)".
std::string NominalName(const ArmSource& source);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_JOB_ARM_SOURCE_H_
