#ifndef ALIDADE_ERROR_TERMS_H_
#define ALIDADE_ERROR_TERMS_H_

#include <Eigen/Core>
#include <string>
#include <vector>

namespace alidade {

struct Arm;

/// A function of a joint's value: linear between equidistant knots, zero beyond
/// the first and the last of them; or of its value modulo a turn.
struct JointFunction {
  double first = 0.0;      ///< joint value of the first knot (rad, m)
  double spacing = 0.0;    ///< between knots (rad, m), > 0 where there are any
  Eigen::VectorXd values;  ///< at the knots (rad, m)
  Eigen::VectorXd deviations;  ///< std of values less their mean, or empty
  /// The knot after the last one is the first: as many spacings as there are
  /// values make a turn (rad).
  bool is_periodic = false;

  bool empty() const { return values.size() == 0; }
  double At(double joint_value) const;
  /// Standard deviation there, by linear interpolation; 0 where not known.
  double DeviationAt(double joint_value) const;
  double last() const {
    return first + spacing * static_cast<double>(values.size() - 1);
  }
};

/// cosine cos(cycles q) + sine sin(cycles q), in rad of a revolute joint.
struct Harmonic {
  double cycles = 1.0;  ///< per turn; that of a gear may be no whole number
  double cosine = 0.0;
  double sine = 0.0;
};

/// Errors of one joint that are not rigid geometry.
struct JointErrors {
  /// What a moment in the axes of the joint's frame turns all behind it by
  /// (rad / (N m)); of a prismatic joint z is not used.
  Eigen::Vector3d compliance = Eigen::Vector3d::Zero();
  JointFunction function;
  std::vector<Harmonic> harmonics;
  /// Half of the step that the joint makes when the moment about its axis
  /// changes its sign (rad); smoothed over kBacklashMoment.
  double backlash = 0.0;
};

/// What a column of the data (temperature, tilt, torque, a station) does, per
/// unit of it.
struct CovariateEffect {
  std::string name;        ///< of the column
  double reference = 0.0;  ///< its value without effect
  /// Moves the base in its own axes (m), then turns it about x, y, z (rad).
  Eigen::Matrix<double, 6, 1> base = Eigen::Matrix<double, 6, 1>::Zero();
  /// Added to the joint values (rad, m); n, or empty.
  Eigen::VectorXd joints = {};
  /// Moves the targets in the axes of the last frame (m), then turns them about
  /// its x, y, z (rad).
  Eigen::Matrix<double, 6, 1> target = Eigen::Matrix<double, 6, 1>::Zero();
  /// Added to the mass of the payload (kg).
  double payload = 0.0;

  /// Whether it changes nothing, as one that the data have no evidence for.
  bool is_zero() const {
    return payload == 0.0 && base.isZero(0.0) && target.isZero(0.0) &&
           (joints.size() == 0 || joints.isZero(0.0));
  }
};

/// What a column of the data may do, which is then estimated.
struct CovariateUse {
  std::string name;  ///< of the column
  bool moves_base = true;
  bool moves_target = false;
  std::vector<int> joints = {};  ///< from 0; those whose values it changes
  /// Its numbers are the directions, -1 or 1, from which `joints` came: each
  /// makes half a step of backlash so. No effect at 0.
  bool is_approach = false;
  /// Its numbers are masses at the target (kg), which change the moments that
  /// joints bend under. Nothing else is estimated of it.
  bool is_payload = false;
  /// Its numbers are 1 where the arm or the instrument stood elsewhere, else 0.
  /// Base and instrument are those at 0; a base of its own at 1 is estimated
  /// with every set of terms, geometry alone too.
  bool is_station = false;
};

/// A mass at a point of a frame.
struct Load {
  double mass = 1.0;                                 ///< kg
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< m
};

/// Errors of an arm that are not rigid geometry. With them
///
///   T(j-1, j) = Rot(y, beta) Rot(x, alpha) Trans(x, d) Rot(z, theta + q + e)
///               Rot(x, t_x) Rot(y, t_y) Trans(z, r)
///   e = e_j(q_j) + sum_k coupling(j, k) q_k + sum_i harmonic_i(q_j)
///       + backlash s(m_z) + compliance_z m_z
///   t = (compliance_x m_x, compliance_y m_y)
///
/// (of a prismatic joint e is added to r, and has no part in m_z). m_j is the
/// moment of the loads about the point a_j of the joint's axis before r,
///
///   m_j = sum_k>=j (c_k - a_j) x mass_k g,     |g| = 9.80665 m/s^2
///
/// in the axes of frame j of the arm without these terms; s(m) = m / sqrt(m^2
/// + kBacklashMoment^2). Elasticity so is that of virtual joints (Pashkevich,
/// Klimchik and Chablat 2011, "Enhanced stiffness modeling of manipulators with
/// passive joints"), deflections being small. Rotations t are by
/// 2 atan(t / 2), which is t but for t^3 / 12. Where measurements have
/// covariates c, their effects are
///
///   base * Trans(u_1, u_2, u_3) Rot(x, u_4) Rot(y, u_5) Rot(z, u_6) * T(0, 1)
///   .. T(n-1, n) * Trans(v_1, v_2, v_3) Rot(x, v_4) Rot(y, v_5) Rot(z, v_6) *
///   target
///
/// with u and v the sums of effects times c - reference; poses of no
/// measurement have c = reference.
struct ErrorTerms {
  std::vector<JointErrors> joints;  ///< one per joint; empty: none of them
  /// What each joint (row) moves with the values of all joints (columns), on
  /// the diagonal its own scale; n x n, in SI; or empty.
  Eigen::MatrixXd coupling;
  std::vector<CovariateEffect> covariates;
  /// The direction in which things fall, in the base frame; of length 1.
  Eigen::Vector3d gravity = -Eigen::Vector3d::UnitZ();
  /// One per joint, in the joint's frame; empty: 1 kg at the origin of each.
  std::vector<Load> links;
  /// In the last frame, about the mean of the targets.
  Load payload;
  /// The geometry that moments are taken of: beta, alpha, d, theta, r of each
  /// joint (5 x n), and the mean target. Empty: the arm's own. It keeps moments
  /// as they are while the geometry is fitted.
  Eigen::MatrixXd load_geometry;
  Eigen::Vector3d load_target = Eigen::Vector3d::Zero();

  bool empty() const {
    return joints.empty() && coupling.size() == 0 && covariates.empty();
  }
  /// Leaves loads and gravity alone.
  void Clear() {
    joints.clear();
    coupling.resize(0, 0);
    covariates.clear();
  }
};

constexpr double kStandardGravity = 9.80665;  // m/s^2
constexpr double kBacklashMoment = 0.5;       // N m

/// s of the equation above.
double SmoothSign(double moment);

/// The mean of the targets' origins in the last frame (m).
Eigen::Vector3d MeanTargetOf(const Arm& arm);

/// What the terms do at one pose.
struct PoseErrors {
  Eigen::VectorXd shifts;  ///< added to the joint values (rad, m)
  Eigen::Matrix2Xd tilts;  ///< t_x and t_y of each joint (rad)
  /// u of the base (m, rad).
  Eigen::Matrix<double, 6, 1> base = Eigen::Matrix<double, 6, 1>::Zero();
  /// v of the target (m, rad).
  Eigen::Matrix<double, 6, 1> target = Eigen::Matrix<double, 6, 1>::Zero();
};

/// The terms of an arm at joint values (n values, rad or m). `covariates`: one
/// for each of the arm's, or null: those of reference.
PoseErrors ErrorsAt(const Arm& arm, const double* joint_values,
                    const double* covariates = nullptr);

/// The moments of the loads about each joint's axis point, in the axes of its
/// frame (3 x n, N m). `covariates` as above.
Eigen::Matrix3Xd LoadMoments(const Arm& arm, const double* joint_values,
                             const double* covariates = nullptr);

}  // namespace alidade

#endif  // ALIDADE_ERROR_TERMS_H_
