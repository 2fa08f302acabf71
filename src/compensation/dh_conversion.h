#ifndef ALIDADE_SRC_COMPENSATION_DH_CONVERSION_H_
#define ALIDADE_SRC_COMPENSATION_DH_CONVERSION_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <limits>
#include <vector>

#include "alidade/arm.h"
#include "alidade/units.h"

namespace alidade::internal {

/// Other descriptions of a chain, converted into the convention of
/// docs/conventions.md. Each conversion is exact up to rounding: position and
/// rotation of the target are the same function of the joint values.

/// One row of a Denavit-Hartenberg table. q is added to theta (revolute, rad)
/// or d (prismatic, m). Angles in rad, lengths in m.
struct DhRow {
  JointType type = JointType::kRevolute;
  double theta = 0.0;
  double d = 0.0;
  double a = 0.0;
  double alpha = 0.0;
  /// Limits of q.
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
};

/// Standard (distal) convention, row i = 1..n:
///
///   T(i-1, i) = Rot(z, theta_i) Trans(z, d_i) Trans(x, a_i) Rot(x, alpha_i)
///
/// alpha_i and a_i become alpha and d of joint i + 1, those of the last row
/// the tool. The base is the identity.
Arm ArmFromStandardDh(const std::vector<DhRow>& rows);

/// Craig's (proximal, modified) convention, row i = 1..n, with alpha and a of
/// the link before the joint in the joint's own row:
///
///   T(i-1, i) = Rot(x, alpha) Trans(x, a) Rot(z, theta_i) Trans(z, d_i)
///
/// which is Khalil's with a for d and d for r. Base and tool are identities.
Arm ArmFromCraigDh(const std::vector<DhRow>& rows);

/// One joint of a chain as URDF has them:
///
///   T = parent_from_joint * Rot(axis, q)     (kRevolute)
///       parent_from_joint * Trans(axis q)    (kPrismatic)
///       parent_from_joint                    (kFixed)
struct ChainJoint {
  enum class Type { kRevolute, kPrismatic, kFixed };
  Type type = Type::kRevolute;
  Eigen::Isometry3d parent_from_joint = Eigen::Isometry3d::Identity();
  /// In the joint's frame, of any length but zero; ignored where fixed.
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();
  /// Limits of q.
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
};

/// Axes whose lines include less than this angle (rad) count as nearly
/// parallel. The feet of the common normal of two axes lie up to (distance of
/// their origins) / sin(angle) away from these, 11.5 times as far at 5 degrees
/// and without bound at 0. Below, beta takes over, whose d is at most that
/// distance at any angle. 5 degrees is far above the errors of real arms and
/// below every angle that a designer means.
inline constexpr double kNearlyParallel = 5.0 * kDegree;

/// Converts a chain. `chain` runs from the base to the tip, whose frame is
/// that of the last entry (append a fixed one for a tool).
///
/// Consecutive axes are joined
/// - by their common normal (beta = 0, d its length, 0 where they intersect),
/// - where nearly parallel or antiparallel, by the perpendicular from the
///   origin of the former axis onto the latter, with the beta and alpha that
///   then turn z onto the latter's direction. r of the former joint is not
///   moved by this.
///
/// theta stays within 90 degrees of the description's where this leaves a
/// choice, so that alpha and d may be negative. A prismatic joint carries only
/// a direction: its line passes through the origin before it. The first axis
/// is reached by beta, alpha, d, r and, along the y axis that these leave out,
/// a translation of `instrument_from_base`. What follows the last axis is
/// `last_from_target`. Values below 1e-15 (rad, m) are set to zero.
///
/// @pre at least one joint moves, no axis of a moving joint is zero, all
/// numbers are finite.
Arm ArmFromChain(const std::vector<ChainJoint>& chain);

/// Whether consecutive axes of the arm are nearly parallel without a beta, and
/// their common normal is so far away (more than 10 m) that the table says
/// nothing of the arm's size: what some controllers hold of a calibrated arm.
bool HasFarNormals(const Arm& arm);

/// The same arm with such axes joined by beta, as ArmFromChain joins them: the
/// same poses at all joint values, but for rounding, with lengths of the arm's
/// own size. Motors, limits and targets are kept.
Arm WithoutFarNormals(const Arm& arm);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_COMPENSATION_DH_CONVERSION_H_
