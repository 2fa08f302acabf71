#ifndef ALIDADE_PLAN_OPTIONS_H_
#define ALIDADE_PLAN_OPTIONS_H_

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace alidade {

/// What a good plan is, in terms of the p eigenvalues l_1 >= ... >= l_p of the
/// information matrix M (the squares of the singular values s of the whitened,
/// scaled Jacobian):
///
///   kD    det M                    all parameters together; O1 is its root
///   kA    1 / trace M^-1           mean variance of the scaled parameters
///   kE    l_p                      the worst told combination
///   kG    1 / max_x trace W_x M^-1 W_x^T    worst predicted position variance
///   kI    1 / mean_x trace W_x M^-1 W_x^T   mean predicted position variance
///   kO2   s_p / s_1                condition number
///   kO3   s_p                      the plans of kE
///   kO4   s_p^2 / s_1
///   kO5   1 / sum 1 / s_i
///
/// all to be large. x are the poses of a region, W_x their position rows.
/// Sources of O1 to O5: identifiability/observability.h; of D, A, E, G, I:
/// Pukelsheim 1993, "Optimal design of experiments". D does not depend on the
/// units of the parameters, nor do G and I; the others do, and mean scaled ones
/// (pose_rows.h).
enum class DesignCriterion { kD, kA, kE, kG, kI, kO2, kO3, kO4, kO5 };

/// "D", "A", "E", "G", "I", "O2" ... "O5"; "O1" is read as D.
const std::vector<std::string>& DesignCriterionNames();
const char* NameOf(DesignCriterion criterion);
/// @pre the name is one of DesignCriterionNames().
DesignCriterion FindDesignCriterion(const std::string& name);

/// Whether the criterion looks at a region.
bool NeedsRegion(DesignCriterion criterion);

/// What is going to be measured at every planned pose.
struct PoseMeasurement {
  double sigma = 1e-3;  ///< of each coordinate (m)
  /// Orientations are measured too.
  bool orientation = false;
  double rotation_sigma = 1e-3;  ///< of each component of it (rad)
  std::vector<int> targets = {0};
  /// Coordinates x, y, z of the instrument's frame that are measured; an
  /// orientation is measured as a whole.
  std::array<bool, 3> axes = {true, true, true};

  /// Scalar measurements at a pose.
  int num_equations() const;
};

/// Where the target may be: a box in the base frame (m), limits included.
struct WorkspaceBox {
  Eigen::Vector3d lower = Eigen::Vector3d::Zero();
  Eigen::Vector3d upper = Eigen::Vector3d::Zero();
};

/// A floor or a wall in the base frame: the origins of all link frames beyond
/// the first joint's and all targets keep to n . p >= offset + margin (m). The
/// margin stands for the thickness of the links.
struct HalfSpace {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< norm 1
  double offset = 0.0;
  double margin = 0.0;
};

/// The instrument sees a target that looks at it: the angle between the
/// direction `axis` of the target's frame and the way from the target to the
/// instrument is at most `angle` (rad).
struct Visibility {
  Eigen::Vector3d instrument = Eigen::Vector3d::Zero();  ///< base frame (m)
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();       ///< norm 1
  double angle = 0.0;
};

/// What a pose must satisfy besides the joint limits. Nothing is demanded of
/// the way between two poses.
struct PoseConstraints {
  /// The targets that are measured, which boxes and visibility are about.
  std::vector<int> targets = {0};
  /// Each of the targets is in one of them; empty: anywhere.
  std::vector<WorkspaceBox> boxes;
  std::vector<HalfSpace> half_spaces;
  std::optional<Visibility> visibility;

  bool empty() const {
    return boxes.empty() && half_spaces.empty() && !visibility;
  }
};

struct CandidateOptions {
  int count = 10000;
  std::uint64_t seed = 1;
  /// Every other candidate has each joint at its lower limit, at its upper one
  /// or in between, a third of the joints each: information is largest at
  /// the limits more often than anywhere else.
  bool limit_faces = true;
  /// Decimals of deg or mm that the motors' values are rounded to, so that
  /// what is planned is what is commanded.
  int joint_decimals = 4;
  /// Draws for each candidate before the constraints count as impossible.
  int max_draws = 1000;
};

struct DesignOptions {
  DesignCriterion criterion = DesignCriterion::kD;
  int num_poses = 0;
  /// A pose may be chosen several times: measured again, it tells as much as a
  /// new one, and where theory puts the best plan there are often fewer
  /// different poses than are to be measured.
  bool allow_repeats = true;
  /// Starts of the exchange, the best counts. The first is greedy; others draw
  /// half of the poses and choose the rest greedily.
  int starts = 4;
  std::uint64_t seed = 1;
  /// Criteria without a cheap update (all but D) are evaluated for so many
  /// candidates at a time, those with the largest slope of the criterion.
  int shortlist = 24;
  /// Rounds over all poses of the plan in a start, at most.
  int max_passes = 60;
  int num_threads = 1;

  /// False with a message that names the field, its value and the constraint.
  bool IsValid(std::string* error) const;
};

}  // namespace alidade

#endif  // ALIDADE_PLAN_OPTIONS_H_
