#ifndef ALIDADE_SRC_INITIALIZATION_FRAME_START_H_
#define ALIDADE_SRC_INITIALIZATION_FRAME_START_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <vector>

namespace alidade::internal {

/// Starting values of the frames that a calibration cannot know beforehand,
/// found from the nominal arm's flange poses and what was measured:
///
///   base_from_last_i = (R_i, d_i)   frame of the last joint, by the nominal
///   arm t_k                             target k in the frame of the last
///   joint (m) x_i = R_i t_k + d_i             target in the frame of the base
///   (m)
///
/// Each function states its equation in x_i and fits it from several starts by
/// Gauss-Newton steps, damped where they would raise the residual (More 1978,
/// "The Levenberg-Marquardt algorithm"). Weights follow the median residual,
/// Huber's among the starts and Tukey's for the best of them, so that some 10 %
/// of gross outliers do no harm (Huber, Ronchetti 2009, "Robust Statistics",
/// chapter 7).
///
/// What the data do not fix: a weak prior holds targets at 0 +- 0.5 m, weighed
/// against the residual found. It moves an observable target by far less than
/// the noise does, and takes an unobservable one to the smallest that fits:
/// with all flange orientations equal, to 0. What else stays undetermined has a
/// step of minimum norm (complete orthogonal decomposition).
///
/// Every function returns nothing where there are fewer equations than unknown
/// numbers, a target or point without observations, a size or index that does
/// not match, or a number that is not finite. They throw nothing, draw no
/// random numbers and are safe to call from several threads. Cost: some tens of
/// QR decompositions of the observations' Jacobian from each start.

/// How well the starting values fit.
struct StartMisfit {
  double rms = 0.0;      ///< (m) of all observations, outliers too
  double median = 0.0;   ///< (m) of the observations' residuals
  int num_outliers = 0;  ///< observations that had no say in the fit
};

/// The result of FitRigid.
struct RigidFit {
  Eigen::Isometry3d b_from_a = Eigen::Isometry3d::Identity();
  /// What lengths in a have to be multiplied by to fit best those in b: 1e3
  /// where b was written in mm. b_from_a does not contain it. 0 where all
  /// points of a coincide.
  double scale = 1.0;
  double rms = 0.0;  ///< (m) of |b_from_a p_a - p_b|, without scale
  /// False where the points lie on a line or coincide: the rotation is then
  /// the smallest of those that fit.
  bool is_unique = true;
};

/// The rotation and translation that minimise the sum of
/// |b_from_a p_a - p_b|^2, never a reflection. Umeyama 1991, "Least-squares
/// estimation of transformation parameters between two point patterns", eq. 40
/// to 43. Not robust. Points are columns (m); nothing for fewer than three.
std::optional<RigidFit> FitRigid(const Eigen::Matrix3Xd& points_in_a,
                                 const Eigen::Matrix3Xd& points_in_b);

/// The result of StartFromPositions.
struct PositionStart {
  Eigen::Isometry3d instrument_from_base = Eigen::Isometry3d::Identity();
  Eigen::Matrix3Xd targets;  ///< (m) column k: t_k
  StartMisfit misfit;        ///< of positions
};

/// Base and targets from positions p_i = instrument_from_base x_i, whatever the
/// base's rotation and distance. Each start has all targets at 0 or 0.3 m along
/// an axis, and the base by FitRigid.
///
/// measured_positions: (m) column i; target_of_observation: k of column i.
std::optional<PositionStart> StartFromPositions(
    const std::vector<Eigen::Isometry3d>& base_from_last,
    const Eigen::Matrix3Xd& measured_positions,
    const std::vector<int>& target_of_observation, int num_targets);

/// The result of StartFromPoses.
struct PoseStart {
  Eigen::Isometry3d instrument_from_base = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d last_from_target = Eigen::Isometry3d::Identity();
  StartMisfit misfit;         ///< of positions; an outlier by either part
  double rms_rotation = 0.0;  ///< (rad) of all observations' residuals
};

/// Base and target frame from poses, instrument_from_target_i =
/// instrument_from_base base_from_last_i last_from_target (robot-world and
/// hand-eye calibration, AX = ZB). Starts: the rotations by the largest
/// singular value of the sum of Kronecker products (Shah 2013, "Solving the
/// robot-world/hand-eye calibration problem using the Kronecker product"),
/// by the positions with the target at the last joint, and with a target frame
/// parallel to the last joint's, kept where the poses do not determine better;
/// the translations by linear least squares. In the fit, 1 rad counts as 0.2 m.
/// Nothing for fewer than three poses.
std::optional<PoseStart> StartFromPoses(
    const std::vector<Eigen::Isometry3d>& base_from_last,
    const std::vector<Eigen::Isometry3d>& measured_poses);

/// The result of StartFromFixedPoints.
struct FixedPointStart {
  Eigen::Vector3d target = Eigen::Vector3d::Zero();  ///< (m) t
  Eigen::Matrix3Xd points;  ///< (m) column k: point k in the instrument's frame
  StartMisfit misfit;
};

/// Target and points from contacts with fixed points whose places are unknown
/// (ball in socket), instrument_from_base x_i = c_k, linear in the target and
/// the points. The base is as given.
std::optional<FixedPointStart> StartFromFixedPoints(
    const Eigen::Isometry3d& instrument_from_base,
    const std::vector<Eigen::Isometry3d>& base_from_last,
    const std::vector<int>& point_of_observation, int num_points);

/// The result of StartFromDistances.
struct DistanceStart {
  Eigen::Vector3d anchor = Eigen::Vector3d::Zero();  ///< (m) instrument's frame
  Eigen::Vector3d target = Eigen::Vector3d::Zero();  ///< (m) t
  StartMisfit misfit;
};

/// Anchor a and target from lengths L_i = |instrument_from_base x_i - a| (m),
/// as of a cable or a ball bar. The base is as given. Starts: the target as in
/// StartFromPositions, the anchor by linear trilateration,
/// |x|^2 - 2 x.a + |a|^2 = L^2, and on either side of the plane that the x lie
/// near. Of two anchors that mirror each other and fit alike, either.
std::optional<DistanceStart> StartFromDistances(
    const Eigen::Isometry3d& instrument_from_base,
    const std::vector<Eigen::Isometry3d>& base_from_last,
    const Eigen::VectorXd& lengths);

/// The result of StartFromPlane: points p of the plane have
/// normal . p = offset, in the instrument's frame.
struct PlaneStart {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< norm 1
  double offset = 0.0;                                ///< (m) >= 0
  Eigen::Vector3d target = Eigen::Vector3d::Zero();   ///< (m) t
  StartMisfit misfit;                                 ///< along the normal
};

/// Plane and target from contacts with one plane, n . (instrument_from_base
/// x_i) = c. The base is as given. Starts: the target as in StartFromPositions,
/// the normal along each principal axis of the x.
std::optional<PlaneStart> StartFromPlane(
    const Eigen::Isometry3d& instrument_from_base,
    const std::vector<Eigen::Isometry3d>& base_from_last);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_INITIALIZATION_FRAME_START_H_
