#ifndef ALIDADE_CORRECTION_H_
#define ALIDADE_CORRECTION_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "alidade/arm.h"
#include "alidade/inverse_kinematics.h"

namespace alidade {

/// The arm that a controller believes in and the one that it moves. Both have
/// the same base frame and tool, those of the controller.
struct CorrectionArms {
  Arm nominal;
  Arm real;
};

/// Where the tool of the real arm comes from.
enum class ToolSource {
  kNominal,  ///< the controller's: what was measured was another target
  /// The calibrated one: the tool was measured, and the controller's is wrong.
  kCalibrated,
};

/// Poses are those that the nominal arm gives: what the controller shows. A
/// calibration may have moved the base and the target (the instrument's frame
/// and the reflector); the controller knows neither, so both arms get the
/// nominal ones, the target by `tool`. Loads stay where they were measured.
/// `target`: number of the target of both arms, which then have no other.
/// @pre the arms have as many joints, of the same types.
CorrectionArms MakeCorrectionArms(const Arm& nominal, const Arm& real,
                                  int target = 0,
                                  ToolSource tool = ToolSource::kNominal);

struct CorrectionOptions {
  PoseSolverOptions solver;
  /// Undoes a correction: what comes in was corrected.
  bool inverse = false;
  /// Postures that are tried for poses without starts (FindPoses).
  int num_trials = 200;
  std::uint64_t seed = 1;
};

/// Targets as they were asked for, and what to command instead: one entry or
/// column each. Joint values are the motors'.
struct Correction {
  std::vector<Eigen::Isometry3d> targets;
  Eigen::MatrixXd asked_motors;  ///< with which the nominal arm reaches them
  /// Whether it does.
  std::vector<PoseStatus> asked_status;
  /// To command instead; of the inverse, what was asked for first.
  Eigen::MatrixXd motors;
  std::vector<Eigen::Isometry3d> poses;  ///< the same as poses
  /// What is left and why: of the real arm at the targets, of the inverse of
  /// the nominal arm at `poses`.
  PoseSolutions solutions;
  Eigen::VectorXd shift;  ///< between target and pose to command (m)
  Eigen::VectorXd turn;   ///< the same (rad)

  /// Whether target i is reached.
  bool IsReached(Eigen::Index i) const {
    return asked_status[i] == PoseStatus::kReached &&
           solutions.status[i] == PoseStatus::kReached;
  }
};

/// With N and R the poses of the nominal and the real arm, the target of joint
/// values q is N(q); to be commanded are q' with R(q') = N(q), or the pose
/// N(q'). The inverse takes q' or N(q') and gives q or N(q) = R(q').
Correction CorrectJoints(const CorrectionArms& arms,
                         const Eigen::MatrixXd& motors,
                         const CorrectionOptions& options = {});

/// The target is a pose P; q is the nominal arm's solution, started at column i
/// of `starts` (motors), or found where there are none (0 x 0).
Correction CorrectPoses(const CorrectionArms& arms,
                        const std::vector<Eigen::Isometry3d>& poses,
                        const Eigen::MatrixXd& starts = {},
                        const CorrectionOptions& options = {});

}  // namespace alidade

#endif  // ALIDADE_CORRECTION_H_
