#ifndef ALIDADE_ARM_H_
#define ALIDADE_ARM_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <limits>
#include <string>
#include <vector>

#include "alidade/error_terms.h"
#include "alidade/shared_matrix.h"
#include "alidade/units.h"

namespace alidade {

enum class JointType { kRevolute, kPrismatic };

/// One joint in the convention of docs/conventions.md (Khalil-Kleinfinger
/// modified Denavit-Hartenberg with Hayati's beta):
///
///   T(j-1, j) = Rot(y, beta) Rot(x, alpha) Trans(x, d)
///               Rot(z, theta) Trans(z, r)
///
/// The joint variable q is added to theta (revolute, rad) or r (prismatic,
/// m). Angles in rad, lengths in m.
struct Joint {
  JointType type = JointType::kRevolute;
  double beta = 0.0;
  double alpha = 0.0;
  double d = 0.0;
  double theta = 0.0;
  double r = 0.0;
  /// Limits of q; infinite where the arm file gives none.
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();

  /// Of q.
  Dimension dimension() const {
    return type == JointType::kRevolute ? Dimension::kAngle
                                        : Dimension::kLength;
  }
};

/// What is measured at the end of the arm: a reflector, a ball, a probe.
struct Target {
  std::string name;  ///< as data sets call it; empty where there is only one
  Eigen::Isometry3d last_from_target = Eigen::Isometry3d::Identity();
};

/// An open chain. A point of the target in the instrument's frame is
///
///   p_in_instrument = instrument_from_base * T(0,1) ... T(n-1,n)
///                     * last_from_target * p_in_target
///
/// `instrument_from_base` is "base" in files and parameter names,
/// `last_from_target` is "tool" (of the second target "tool2", and so on).
struct Arm {
  std::string name;
  std::vector<Joint> joints;
  Eigen::Isometry3d instrument_from_base = Eigen::Isometry3d::Identity();
  std::vector<Target> targets = {{}};  ///< never empty

  /// Motors (or encoders) to joints, where joints are coupled, count backwards
  /// or have another zero: q = joints_from_motors * motors + motor_offsets.
  /// n x n and n, in SI; empty = identity and zero. The unit of motor j is that
  /// of joint j.
  Eigen::MatrixXd joints_from_motors;
  Eigen::VectorXd motor_offsets;
  /// What is not rigid geometry: elasticity, errors of gears.
  ErrorTerms errors;

  int num_joints() const { return static_cast<int>(joints.size()); }
  int num_targets() const { return static_cast<int>(targets.size()); }
  /// Of the joints' variables, in their order.
  std::vector<Dimension> JointDimensions() const;

  const Eigen::Isometry3d& last_from_target(int target = 0) const {
    return targets[target].last_from_target;
  }
  Eigen::Isometry3d& last_from_target(int target = 0) {
    return targets[target].last_from_target;
  }
};

/// Whether the joint has limits on both sides that mean something. Limits that
/// are the same on both sides, which programs write that know none (0 to 0),
/// and those of a revolute joint that span more than twenty turns are as good
/// as none.
bool HasLimits(const Joint& joint);

/// An upper bound of the distance between the base and the target (m): the
/// sum of all lengths of the chain, prismatic travel (where limited) and the
/// farthest target included. It turns small angles of joints and targets into
/// lengths where columns of different units are compared. Never zero: 1 m for
/// an arm without any length.
double ArmReach(const Arm& arm);

/// An upper bound of the distance between the instrument and the target (m):
/// the length that the model's rounding errors scale with. Never zero.
double Reach(const Arm& arm);

/// Whether joint values are other than the motors' (below).
bool HasMotorMap(const Arm& arm);

/// q = joints_from_motors * motors + motor_offsets, column by column: n x poses
/// (rad or m). @pre sizes agree.
Eigen::MatrixXd JointsFromMotors(const Arm& arm, const Eigen::MatrixXd& motors);

/// The inverse. @pre sizes agree, joints_from_motors is regular.
Eigen::MatrixXd MotorsFromJoints(const Arm& arm, const Eigen::MatrixXd& joints);

/// Both of many columns; not copied where motors turn the joints as they are.
template <typename Plain>
BasicSharedMatrix<Plain> JointsFromMotors(
    const Arm& arm, const BasicSharedMatrix<Plain>& motors) {
  if (!HasMotorMap(arm)) return motors;
  return JointsFromMotors(arm, motors.map().eval());
}
template <typename Plain>
BasicSharedMatrix<Plain> MotorsFromJoints(
    const Arm& arm, const BasicSharedMatrix<Plain>& joints) {
  if (!HasMotorMap(arm)) return joints;
  return MotorsFromJoints(arm, joints.map().eval());
}

}  // namespace alidade

#endif  // ALIDADE_ARM_H_
