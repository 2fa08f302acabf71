// Writes the rows of a vector of observations, compiled once for each
// instruction set: include after foreach_target.h, between no namespaces.
#if defined(ALIDADE_SRC_MEASUREMENT_ROWS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ALIDADE_SRC_MEASUREMENT_ROWS_INL_H_
#undef ALIDADE_SRC_MEASUREMENT_ROWS_INL_H_
#else
#define ALIDADE_SRC_MEASUREMENT_ROWS_INL_H_
#endif

#include <Eigen/Core>
#include <cstddef>

#include "alidade/dataset.h"
#include "src/kernel/aligned.h"
#include "src/kernel/chain-inl.h"
#include "src/kernel/kernel_constants.h"

HWY_BEFORE_NAMESPACE();
namespace alidade::internal::kernel::HWY_NAMESPACE {
// Each source has its own of each instruction set.
namespace {  // NOLINT(google-build-namespaces)

// Where the rows of an orientation begin, after those of its position.
constexpr std::ptrdiff_t kTurnRows = std::ptrdiff_t{3} * kTile;

// Writes the rows of one vector of observations.
template <MeasurementKind kKind>
struct Writer {
  static constexpr bool kIsLength = kKind == MeasurementKind::kDistance ||
                                    kKind == MeasurementKind::kPlane ||
                                    kKind == MeasurementKind::kPointDistance;
  static constexpr bool kHasTurn = kKind == MeasurementKind::kPose;
  static constexpr std::size_t kRows = kIsLength ? 1 : (kHasTurn ? 6 : 3);

  double* rows;       // of this vector's first lane
  V3 weights;         // of the rows in lengths; x alone where there is one
  V3 turn_weights;    // of an orientation's
  V3 direction;       // in which a length grows
  V3 log_by_turn[3];  // rows of the derivative of the logarithm
  bool subtracts = false;
  bool is_tilted = false;

  HWY_INLINE double* At(int column) const {
    return rows + static_cast<std::size_t>(column) * kRows * kTile;
  }

  // The target moves by dp.
  HWY_INLINE void Move(int column, const V3& dp) const {
    double* const to = At(column);
    if constexpr (kIsLength) {
      hn::Store(hn::Mul(weights.x, Dot(direction, dp)), kTag, to);
    } else {
      V3 row = {hn::Mul(weights.x, dp.x), hn::Mul(weights.y, dp.y),
                hn::Mul(weights.z, dp.z)};
      if constexpr (kKind == MeasurementKind::kDifference) {
        if (subtracts) row = Load3(to, kTile) - row;
      }
      Store3(row, to, kTile);
    }
    if constexpr (kHasTurn) {
      const V zero = hn::Zero(kTag);
      Store3({zero, zero, zero}, to + kTurnRows, kTile);
    }
  }

  // The target turns about `axis` (rad) besides.
  HWY_INLINE void Turn(int column, const V3& dp, const V3& axis) const {
    Move(column, dp);
    if constexpr (kHasTurn) {
      const V3 log = {Dot(log_by_turn[0], axis), Dot(log_by_turn[1], axis),
                      Dot(log_by_turn[2], axis)};
      Store3({hn::Mul(turn_weights.x, log.x), hn::Mul(turn_weights.y, log.y),
              hn::Mul(turn_weights.z, log.z)},
             At(column) + kTurnRows, kTile);
    }
  }

  // The columns of joints and base; p is where the target is.
  HWY_INLINE void WriteArm(const Constants& constants, const Columns& columns,
                           const V3& p, double* scratch) const {
    if (!columns.HasArm()) return;
    const std::size_t lanes = hn::Lanes(kTag);
    for (int j = 0; j < columns.num_joints(); ++j) {
      const Columns::OfJoint& column = columns.joint(j);
      const JointLines lines = LinesOf(scratch, j, is_tilted);
      if (column.HasTurnBefore()) {
        const V3 arm = p - Load3(lines.origin_before, lanes);
        if (column.beta >= 0) {
          const V3 axis = Load3(lines.beta_axis, lanes);
          Turn(column.beta, Cross(axis, arm), axis);
        }
        if (column.alpha >= 0) {
          const V3 axis = Load3(lines.alpha_axis, lanes);
          Turn(column.alpha, Cross(axis, arm), axis);
        }
      }
      if (column.d >= 0) Move(column.d, Load3(lines.alpha_axis, lanes));
      if (!column.HasJointAxis()) continue;
      const V3 axis = Load3(lines.joint_axis, lanes);
      if (column.r >= 0) Move(column.r, Load3(lines.slide_axis, lanes));
      if (column.theta >= 0) {
        const V3 arm = p - Load3(lines.origin_on_axis, lanes);
        Turn(column.theta, Cross(axis, arm), axis);
      }
    }
    const V3 arm = p - Broadcast(constants.base_translation);
    for (int k = 0; k < 3; ++k) {
      const int move = columns.base_translation()[k];
      const int turn = columns.base_rotation()[k];
      if (move >= 0) {
        Move(move, Broadcast(Eigen::Vector3d(Eigen::Vector3d::Unit(k))));
      }
      if (turn >= 0) {
        const V3 axis = Broadcast(Eigen::Vector3d(constants.base_axes.col(k)));
        Turn(turn, Cross(axis, arm), axis);
      }
    }
  }

  HWY_INLINE void WriteTool(const Constants& constants, const Columns& columns,
                            int target, const Frame& last) const {
    const V zero = hn::Zero(kTag);
    for (int k = 0; k < 3; ++k) {
      const int move = columns.tool_translation(target)[k];
      const int turn = columns.tool_rotation(target)[k];
      if (move >= 0) Move(move, k == 0 ? last.x : (k == 1 ? last.y : last.z));
      if (turn >= 0) {
        Turn(turn, {zero, zero, zero},
             Combine(last, constants.targets[target].axes.col(k)));
      }
    }
  }

  // The columns of a point that moves the residual by `sign` times its own
  // move.
  HWY_INLINE void WritePoint(const Columns::Triple& point, double sign) const {
    for (int k = 0; k < 3; ++k) {
      if (point[k] < 0) continue;
      Move(point[k],
           Broadcast(Eigen::Vector3d(sign * Eigen::Vector3d::Unit(k))));
    }
  }

  HWY_INLINE void WritePlane(const Columns::Triple& plane,
                             const PlaneConstants& constants,
                             const V3& p) const {
    for (int k = 0; k < 2; ++k) {
      if (plane[k] < 0) continue;
      const V3 tilt = Broadcast(constants.normal_by_tilt[k]);
      hn::Store(hn::Mul(weights.x, Dot(tilt, p)), kTag, At(plane[k]));
    }
    if (plane[2] >= 0) hn::Store(hn::Neg(weights.x), kTag, At(plane[2]));
  }
};

}  // namespace
}  // namespace alidade::internal::kernel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // include guard of each instruction set
