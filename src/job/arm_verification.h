#ifndef ALIDADE_SRC_JOB_ARM_VERIFICATION_H_
#define ALIDADE_SRC_JOB_ARM_VERIFICATION_H_

#include <cstdint>
#include <string>
#include <vector>

#include "src/job/arm_source.h"
#include "src/uncertainty/arm_check.h"

namespace alidade::internal {

/// How a calibrated arm is checked at the robot.
struct VerificationOptions {
  /// What is found from the check: the instrument or the target was set up
  /// anew.
  bool refit_base = false;
  bool refit_tool = false;
  /// The joint values of the data are those asked for, and the robot was given
  /// what `correct` makes of them.
  bool corrected = false;
  int num_threads = 1;
};

/// Checks the arm of a result by the measurements of a file.
/// @throws InputError, also where the result states no uncertainty and where
/// the measurements are too few or too many.
ArmCheckResult VerifyArm(const ArmSource& source, const std::string& data,
                         const VerificationOptions& options);

/// Poses for such a check, with what they will show.
struct VerificationPlan {
  std::string text;  ///< a data set to be filled in
  std::vector<ArmCheckResult>
      by_number;           ///< of fewer and more poses, ascending
  ArmCheckResult planned;  ///< of as many as asked for
};

/// `num_poses` (3 to 50) within what the calibration has measured.
/// @throws InputError.
VerificationPlan PlanVerification(const ArmSource& source, int num_poses,
                                  std::uint64_t seed,
                                  const VerificationOptions& options);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_JOB_ARM_VERIFICATION_H_
