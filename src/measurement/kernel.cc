#include "kernel_targets.h"
//
#include <algorithm>
#include <cmath>

#include "alidade/model/rotation.h"
#include "kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/measurement/kernel.cc"
#include <hwy/foreach_target.h>
//
#include <hwy/cache_control.h>

#include "vectors-inl.h"

// Compiled once, before the sources of the instruction sets.
#ifndef ALIDADE_SRC_MEASUREMENT_KERNEL_CC_ONCE
#define ALIDADE_SRC_MEASUREMENT_KERNEL_CC_ONCE
namespace alidade::kernel {
namespace {

// Arrays of a joint in the scratch: the axes of beta, alpha and the joint, the
// origins before the joint and on its axis; three numbers each.
constexpr std::size_t kArraysPerJoint = 15;

// Orientations of a vector's length, an array for each entry.
struct Turns {
  alignas(64) double matrix[9][kMostLanes];
  alignas(64) double log[3][kMostLanes];
  /// The inverse left Jacobian of the logarithm.
  alignas(64) double derivative[9][kMostLanes];
};

void TakeLogarithms(std::size_t lanes, Turns* turns) {
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    Eigen::Matrix3d matrix;
    for (int k = 0; k < 9; ++k) matrix(k / 3, k % 3) = turns->matrix[k][lane];
    const Eigen::Vector3d log = VectorFromRotation(matrix);
    const Eigen::Matrix3d derivative = InverseLeftJacobianOfRotation(log);
    for (int k = 0; k < 3; ++k) turns->log[k][lane] = log[k];
    for (int k = 0; k < 9; ++k) {
      turns->derivative[k][lane] = derivative(k / 3, k % 3);
    }
  }
}

}  // namespace
}  // namespace alidade::kernel
#endif

HWY_BEFORE_NAMESPACE();
namespace alidade::kernel::HWY_NAMESPACE {
namespace {

// ---------------------------------------------------------------- vectors

struct V3 {
  V x, y, z;
};

HWY_INLINE V Broadcast(double value) { return hn::Set(kTag, value); }

HWY_INLINE V3 Broadcast(const Eigen::Vector3d& v) {
  return {Broadcast(v.x()), Broadcast(v.y()), Broadcast(v.z())};
}

HWY_INLINE V3 operator+(const V3& a, const V3& b) {
  return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}

HWY_INLINE V3 operator-(const V3& a, const V3& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}

HWY_INLINE V3 Scale(V s, const V3& a) {
  return {hn::Mul(s, a.x), hn::Mul(s, a.y), hn::Mul(s, a.z)};
}

// s a + b
HWY_INLINE V3 AddScaled(V s, const V3& a, const V3& b) {
  return {hn::MulAdd(s, a.x, b.x), hn::MulAdd(s, a.y, b.y),
          hn::MulAdd(s, a.z, b.z)};
}

HWY_INLINE V Dot(const V3& a, const V3& b) {
  return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}

HWY_INLINE V3 Cross(const V3& a, const V3& b) {
  return {hn::MulSub(a.y, b.z, hn::Mul(a.z, b.y)),
          hn::MulSub(a.z, b.x, hn::Mul(a.x, b.z)),
          hn::MulSub(a.x, b.y, hn::Mul(a.y, b.x))};
}

HWY_INLINE V3 Load3(const double* from, std::size_t stride) {
  return {hn::Load(kTag, from), hn::Load(kTag, from + stride),
          hn::Load(kTag, from + 2 * stride)};
}

HWY_INLINE void Store3(const V3& v, double* to, std::size_t stride) {
  hn::Store(v.x, kTag, to);
  hn::Store(v.y, kTag, to + stride);
  hn::Store(v.z, kTag, to + 2 * stride);
}

// ------------------------------------------------------------------ chain

// The axes x, y, z and the origin of a frame, in the instrument's frame.
struct Frame {
  V3 x, y, z, origin;
};

// Turns the axes a and b in their plane, from a towards b.
HWY_INLINE void Turn(V cosine, V sine, V3* a, V3* b) {
  const V3 before = *a;
  *a = AddScaled(sine, *b, Scale(cosine, before));
  *b = {hn::NegMulAdd(sine, before.x, hn::Mul(cosine, b->x)),
        hn::NegMulAdd(sine, before.y, hn::Mul(cosine, b->y)),
        hn::NegMulAdd(sine, before.z, hn::Mul(cosine, b->z))};
}

// The frame of a matrix whose columns are the axes.
HWY_INLINE Frame FrameOf(const Eigen::Matrix3d& axes,
                         const Eigen::Vector3d& origin) {
  return {Broadcast(Eigen::Vector3d(axes.col(0))),
          Broadcast(Eigen::Vector3d(axes.col(1))),
          Broadcast(Eigen::Vector3d(axes.col(2))), Broadcast(origin)};
}

// The lines of one joint, as ChainAxes has them. Of those that no column asks
// for nothing is kept.
struct JointLines {
  double* beta_axis;
  double* alpha_axis;
  double* joint_axis;
  double* origin_before;
  double* origin_on_axis;
};

HWY_INLINE JointLines LinesOf(double* scratch, int joint) {
  const std::size_t lanes = hn::Lanes(kTag);
  double* const first =
      scratch + static_cast<std::size_t>(joint) * kArraysPerJoint * lanes;
  return {first, first + 3 * lanes, first + 6 * lanes, first + 9 * lanes,
          first + 12 * lanes};
}

// Walks one vector of poses from the base to the last frame. `joints` are the
// tile's sines and cosines from the first lane of the vector on.
HWY_INLINE Frame WalkChain(const Constants& constants, const Columns& columns,
                           const double* joints, double* scratch) {
  const std::size_t lanes = hn::Lanes(kTag);
  Frame frame = FrameOf(constants.base_rotation, constants.base_translation);
  for (int j = 0; j < columns.num_joints(); ++j) {
    const JointConstants& joint = constants.joints[j];
    const Columns::OfJoint& wanted = columns.joint(j);
    const JointLines lines = LinesOf(scratch, j);
    if (wanted.HasTurnBefore()) {
      Store3(frame.origin, lines.origin_before, lanes);
    }
    if (wanted.beta >= 0) Store3(frame.y, lines.beta_axis, lanes);
    if (joint.sin_beta != 0.0 || joint.cos_beta != 1.0) {
      Turn(Broadcast(joint.cos_beta), Broadcast(joint.sin_beta), &frame.z,
           &frame.x);
    }
    if (wanted.HasAlphaAxis()) Store3(frame.x, lines.alpha_axis, lanes);
    if (joint.sin_alpha != 0.0 || joint.cos_alpha != 1.0) {
      Turn(Broadcast(joint.cos_alpha), Broadcast(joint.sin_alpha), &frame.y,
           &frame.z);
    }
    frame.origin = AddScaled(Broadcast(joint.d), frame.x, frame.origin);
    if (wanted.theta >= 0) Store3(frame.origin, lines.origin_on_axis, lanes);
    if (wanted.HasJointAxis()) Store3(frame.z, lines.joint_axis, lanes);
    const V first = hn::Load(kTag, joints + std::ptrdiff_t{2} * j * kTile);
    V cosine = Broadcast(joint.cos_theta);
    V sine = Broadcast(joint.sin_theta);
    V length = Broadcast(joint.r);
    if (joint.is_revolute) {
      // sin and cos of theta + q.
      const V second =
          hn::Load(kTag, joints + (std::ptrdiff_t{2} * j + 1) * kTile);
      const V turned = hn::MulAdd(cosine, first, hn::Mul(sine, second));
      cosine = hn::MulSub(cosine, second, hn::Mul(sine, first));
      sine = turned;
    } else {
      length = hn::Add(length, first);
    }
    Turn(cosine, sine, &frame.x, &frame.y);
    frame.origin = AddScaled(length, frame.z, frame.origin);
  }
  return frame;
}

// Where a target's point is.
HWY_INLINE V3 PointOf(const Frame& frame, const Eigen::Vector3d& point) {
  V3 p = frame.origin;
  if (point.isZero(0.0)) return p;
  p = AddScaled(Broadcast(point.x()), frame.x, p);
  p = AddScaled(Broadcast(point.y()), frame.y, p);
  return AddScaled(Broadcast(point.z()), frame.z, p);
}

// a x + b y + c z of a frame's axes.
HWY_INLINE V3 Combine(const Frame& frame, const Eigen::Vector3d& weights) {
  return AddScaled(Broadcast(weights.z()), frame.z,
                   AddScaled(Broadcast(weights.y()), frame.y,
                             Scale(Broadcast(weights.x()), frame.x)));
}

// ------------------------------------------------------------------- rows

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
      Store3({zero, zero, zero}, to + 3 * kTile, kTile);
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
             At(column) + 3 * kTile, kTile);
    }
  }

  // The columns of joints and base; p is where the target is.
  HWY_INLINE void WriteArm(const Constants& constants, const Columns& columns,
                           const V3& p, double* scratch) const {
    if (!columns.HasArm()) return;
    const std::size_t lanes = hn::Lanes(kTag);
    for (int j = 0; j < columns.num_joints(); ++j) {
      const Columns::OfJoint& column = columns.joint(j);
      const JointLines lines = LinesOf(scratch, j);
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
      if (column.r >= 0) Move(column.r, axis);
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

// What all of EvaluateTile needs, for one vector of its lanes.
struct Job {
  const Constants& constants;
  const Columns& columns;
  const Tile& tile;
  double* scratch;
  double* rows;
  double* lengths;
};

HWY_INLINE V OneWhereMeasured(V inverse_sigma) {
  return hn::IfThenElseZero(hn::Gt(inverse_sigma, hn::Zero(kTag)),
                            Broadcast(1.0));
}

// The residual of three rows in lengths.
HWY_INLINE void WriteError(const V3& error, const V3& weights, double* rows,
                           double* lengths) {
  Store3({hn::Mul(weights.x, error.x), hn::Mul(weights.y, error.y),
          hn::Mul(weights.z, error.z)},
         rows, kTile);
  const V3 measured = {hn::Mul(OneWhereMeasured(weights.x), error.x),
                       hn::Mul(OneWhereMeasured(weights.y), error.y),
                       hn::Mul(OneWhereMeasured(weights.z), error.z)};
  hn::Store(Dot(measured, measured), kTag, lengths);
}

HWY_INLINE void WriteError(V error, V weight, double* row, double* lengths) {
  hn::Store(hn::Mul(weight, error), kTag, row);
  const V measured = hn::Mul(OneWhereMeasured(weight), error);
  hn::Store(hn::Mul(measured, measured), kTag, lengths);
}

// error = |difference| - measured, and where it grows.
HWY_INLINE V LengthError(const V3& difference, V measured, V3* direction) {
  const V length = hn::Sqrt(Dot(difference, difference));
  const auto is_positive = hn::Gt(length, hn::Zero(kTag));
  const V inverse = hn::IfThenElseZero(
      is_positive, hn::Div(Broadcast(1.0), hn::IfThenElse(is_positive, length,
                                                          Broadcast(1.0))));
  *direction = Scale(inverse, difference);
  return hn::Sub(length, measured);
}

// The rotation from the measured orientation to that of the target, its
// logarithm and the derivative of that.
HWY_INLINE void WriteOrientation(const Job& job, const Frame& last, int t,
                                 Writer<MeasurementKind::kPose>* writer) {
  const Eigen::Matrix3d& tool = job.constants.targets[job.tile.target].rotation;
  const V3 x = Combine(last, tool.col(0));
  const V3 y = Combine(last, tool.col(1));
  const V3 z = Combine(last, tool.col(2));
  Turns turns;
  const double* const measured = job.tile.measured + 3 * kTile + t;
  for (int k = 0; k < 3; ++k) {
    // Column k of [x y z] R_m^T.
    const V3 row = Load3(measured + std::ptrdiff_t{3} * k * kTile, kTile);
    const V3 column = AddScaled(row.z, z, AddScaled(row.y, y, Scale(row.x, x)));
    hn::Store(column.x, kTag, turns.matrix[k]);
    hn::Store(column.y, kTag, turns.matrix[3 + k]);
    hn::Store(column.z, kTag, turns.matrix[6 + k]);
  }
  TakeLogarithms(hn::Lanes(kTag), &turns);
  for (int k = 0; k < 3; ++k) {
    writer->log_by_turn[k] = Load3(turns.derivative[3 * k], kMostLanes);
  }
  writer->turn_weights = Load3(job.tile.inverse_sigmas + 3 * kTile + t, kTile);
  const V3 log = Load3(turns.log[0], kMostLanes);
  Store3({hn::Mul(writer->turn_weights.x, log.x),
          hn::Mul(writer->turn_weights.y, log.y),
          hn::Mul(writer->turn_weights.z, log.z)},
         writer->At(job.columns.num_derivatives()) + 3 * kTile, kTile);
}

// Residual and columns of a distance between two reference points.
HWY_INLINE void EvaluatePointDistance(
    const Job& job, int t, Writer<MeasurementKind::kPointDistance>* writer) {
  const Tile& tile = job.tile;
  const std::vector<Eigen::Vector3d>& points = job.constants.points;
  const Eigen::Vector3d difference =
      points[tile.reference] - points[tile.second];
  const V error =
      LengthError(Broadcast(difference), hn::Load(kTag, tile.measured + t),
                  &writer->direction);
  WriteError(error, writer->weights.x,
             writer->At(job.columns.num_derivatives()), job.lengths + t);
  writer->WritePoint(job.columns.point(tile.reference), 1.0);
  writer->WritePoint(job.columns.point(tile.second), -1.0);
}

// The residual where the target is at p, and the columns of what it is measured
// against; of a difference nothing yet. The writer learns the direction of
// lengths.
template <MeasurementKind kKind>
HWY_INLINE void WriteMeasured(const Job& job, int t, const V3& p,
                              Writer<kKind>* writer) {
  const Tile& tile = job.tile;
  const Constants& constants = job.constants;
  double* const residual = writer->At(job.columns.num_derivatives());
  double* const lengths = job.lengths + t;
  if constexpr (kKind == MeasurementKind::kPosition ||
                kKind == MeasurementKind::kPose) {
    WriteError(p - Load3(tile.measured + t, kTile), writer->weights, residual,
               lengths);
  }
  if constexpr (kKind == MeasurementKind::kFixedPoint) {
    WriteError(p - Broadcast(constants.points[tile.reference]), writer->weights,
               residual, lengths);
    writer->WritePoint(job.columns.point(tile.reference), -1.0);
  }
  if constexpr (kKind == MeasurementKind::kDistance) {
    const V error =
        LengthError(p - Broadcast(constants.points[tile.reference]),
                    hn::Load(kTag, tile.measured + t), &writer->direction);
    WriteError(error, writer->weights.x, residual, lengths);
    writer->WritePoint(job.columns.point(tile.reference), -1.0);
  }
  if constexpr (kKind == MeasurementKind::kPlane) {
    const PlaneConstants& plane = constants.planes[tile.reference];
    writer->direction = Broadcast(plane.normal);
    const V error = hn::Sub(Dot(writer->direction, p), Broadcast(plane.offset));
    WriteError(error, writer->weights.x, residual, lengths);
    writer->WritePlane(job.columns.plane(tile.reference), plane, p);
  }
}

template <MeasurementKind kKind>
HWY_INLINE void EvaluateVector(const Job& job, int t) {
  const Tile& tile = job.tile;
  Writer<kKind> writer;
  writer.rows = job.rows + t;
  if constexpr (Writer<kKind>::kIsLength) {
    writer.weights.x = hn::Load(kTag, tile.inverse_sigmas + t);
  } else {
    writer.weights = Load3(tile.inverse_sigmas + t, kTile);
  }
  if constexpr (kKind == MeasurementKind::kPointDistance) {
    EvaluatePointDistance(job, t, &writer);
    return;
  }
  const Frame last =
      WalkChain(job.constants, job.columns, tile.joints + t, job.scratch);
  const Eigen::Vector3d& tool = job.constants.targets[tile.target].translation;
  const V3 p = PointOf(last, tool);
  WriteMeasured<kKind>(job, t, p, &writer);
  if constexpr (kKind == MeasurementKind::kPose) {
    WriteOrientation(job, last, t, &writer);
  }
  writer.WriteArm(job.constants, job.columns, p, job.scratch);
  writer.WriteTool(job.constants, job.columns, tile.target, last);
  if constexpr (kKind == MeasurementKind::kDifference) {
    const Frame other = WalkChain(job.constants, job.columns,
                                  tile.second_joints + t, job.scratch);
    const V3 q = PointOf(other, tool);
    WriteError((p - q) - Load3(tile.measured + t, kTile), writer.weights,
               writer.At(job.columns.num_derivatives()), job.lengths + t);
    writer.subtracts = true;
    writer.WriteArm(job.constants, job.columns, q, job.scratch);
    writer.WriteTool(job.constants, job.columns, tile.target, other);
  }
}

// Asks for the part of the next tile that belongs to these lanes. All of it at
// once would fill the queue to the memory and wait for it.
HWY_INLINE void PrefetchShare(const Tile& tile, int t, int lanes) {
  constexpr int kLine = 64 / sizeof(double);
  const double* const first = tile.next + std::ptrdiff_t{tile.next_arrays} * t;
  for (int k = 0; k < tile.next_arrays * lanes; k += kLine) {
    hwy::Prefetch(first + k);
  }
}

template <MeasurementKind kKind>
HWY_NOINLINE void EvaluateKind(const Job& job) {
  const int lanes = static_cast<int>(hn::Lanes(kTag));
  for (int t = 0; t < kTile; t += lanes) {
    PrefetchShare(job.tile, t, lanes);
    EvaluateVector<kKind>(job, t);
  }
}

void EvaluateTile(const Constants& constants, const Columns& columns,
                  const Tile& tile, double* scratch, double* rows,
                  double* lengths) {
  const Job job{constants, columns, tile, scratch, rows, lengths};
  switch (tile.kind) {
    case MeasurementKind::kPosition:
      return EvaluateKind<MeasurementKind::kPosition>(job);
    case MeasurementKind::kPose:
      return EvaluateKind<MeasurementKind::kPose>(job);
    case MeasurementKind::kDistance:
      return EvaluateKind<MeasurementKind::kDistance>(job);
    case MeasurementKind::kFixedPoint:
      return EvaluateKind<MeasurementKind::kFixedPoint>(job);
    case MeasurementKind::kPlane:
      return EvaluateKind<MeasurementKind::kPlane>(job);
    case MeasurementKind::kDifference:
      return EvaluateKind<MeasurementKind::kDifference>(job);
    case MeasurementKind::kPointDistance:
      return EvaluateKind<MeasurementKind::kPointDistance>(job);
  }
}

// -------------------------------------------------------------------- sums

TileSums SumTile(int height, const double* residual, const double* lengths,
                 double* norms) {
  V all = hn::Zero(kTag);
  V squares = all;
  V largest = all;
  for (int t = 0; t < kTile; t += static_cast<int>(hn::Lanes(kTag))) {
    V norm = hn::Zero(kTag);
    for (int row = 0; row < height; ++row) {
      const V r = hn::Load(kTag, residual + std::ptrdiff_t{row} * kTile + t);
      norm = hn::MulAdd(r, r, norm);
    }
    hn::Store(norm, kTag, norms + t);
    all = hn::Add(all, norm);
    const V length = hn::Load(kTag, lengths + t);
    squares = hn::Add(squares, length);
    largest = hn::Max(largest, length);
  }
  return {hn::GetLane(hn::SumOfLanes(kTag, all)),
          hn::GetLane(hn::SumOfLanes(kTag, squares)),
          hn::GetLane(hn::MaxOfLanes(kTag, largest))};
}

}  // namespace
}  // namespace alidade::kernel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace alidade::kernel {

HWY_EXPORT(EvaluateTile);
HWY_EXPORT(SumTile);

std::size_t ScratchSize(int num_joints) {
  return static_cast<std::size_t>(num_joints) * kArraysPerJoint * kMostLanes;
}

void EvaluateTile(const Constants& constants, const Columns& columns,
                  const Tile& tile, double* scratch, double* rows,
                  double* lengths) {
  const std::size_t height =
      static_cast<std::size_t>(RowsOf(tile.kind)) * kTile;
  for (const int column : columns.object_columns()) {
    std::fill_n(rows + static_cast<std::size_t>(column) * height, height, 0.0);
  }
  if (tile.kind == MeasurementKind::kPointDistance) {
    std::fill_n(rows,
                static_cast<std::size_t>(columns.num_derivatives()) * height,
                0.0);
  }
  HWY_DYNAMIC_DISPATCH(EvaluateTile)
  (constants, columns, tile, scratch, rows, lengths);
}

TileSums SumTile(int height, const double* residual, const double* lengths,
                 double* norms) {
  return HWY_DYNAMIC_DISPATCH(SumTile)(height, residual, lengths, norms);
}

}  // namespace alidade::kernel
#endif  // HWY_ONCE
