#include "src/kernel/kernel_targets.h"
//
#include <algorithm>
#include <cmath>

#include "alidade/rotation.h"
#include "src/kernel/kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/kernel/kernel.cc"
#include <hwy/foreach_target.h>
//
#include <hwy/cache_control.h>

#include "src/kernel/rows-inl.h"

// Compiled once, before the sources of the instruction sets.
#ifndef ALIDADE_SRC_MEASUREMENT_KERNEL_CC_ONCE
#define ALIDADE_SRC_MEASUREMENT_KERNEL_CC_ONCE
namespace alidade::internal::kernel {
namespace {

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
}  // namespace alidade::internal::kernel
#endif

HWY_BEFORE_NAMESPACE();
namespace alidade::internal::kernel::HWY_NAMESPACE {
namespace {

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
  const double* const measured = job.tile.measured + kTurnRows + t;
  for (int k = 0; k < 3; ++k) {
    // Column k of [x y z] R_m^T.
    const V3 row = Load3(measured + std::ptrdiff_t{k} * kTurnRows, kTile);
    const V3 column = AddScaled(row.z, z, AddScaled(row.y, y, Scale(row.x, x)));
    hn::Store(column.x, kTag, turns.matrix[k]);
    hn::Store(column.y, kTag, turns.matrix[3 + k]);
    hn::Store(column.z, kTag, turns.matrix[6 + k]);
  }
  TakeLogarithms(hn::Lanes(kTag), &turns);
  for (int k = 0; k < 3; ++k) {
    writer->log_by_turn[k] =
        Load3(turns.derivative[std::ptrdiff_t{3} * k], kMostLanes);
  }
  writer->turn_weights = Load3(job.tile.inverse_sigmas + kTurnRows + t, kTile);
  const V3 log = Load3(turns.log[0], kMostLanes);
  Store3({hn::Mul(writer->turn_weights.x, log.x),
          hn::Mul(writer->turn_weights.y, log.y),
          hn::Mul(writer->turn_weights.z, log.z)},
         writer->At(job.columns.num_derivatives()) + kTurnRows, kTile);
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

// An array from a lane on; null stays null.
HWY_INLINE const double* At(const double* array, int lane) {
  return array == nullptr ? nullptr : array + lane;
}

template <MeasurementKind kKind>
HWY_INLINE void EvaluateVector(const Job& job, int t) {
  const Tile& tile = job.tile;
  Writer<kKind> writer;
  writer.rows = job.rows + t;
  writer.is_tilted = tile.tilts != nullptr;
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
      WalkChain(job.constants, job.columns, tile.joints + t, At(tile.tilts, t),
                At(tile.motions, t), job.scratch);
  const Eigen::Vector3d& tool = job.constants.targets[tile.target].translation;
  const V3 p = PointOf(last, tool);
  WriteMeasured<kKind>(job, t, p, &writer);
  if constexpr (kKind == MeasurementKind::kPose) {
    WriteOrientation(job, last, t, &writer);
  }
  writer.WriteArm(job.constants, job.columns, p, job.scratch);
  writer.WriteTool(job.constants, job.columns, tile.target, last);
  if constexpr (kKind == MeasurementKind::kDifference) {
    const Frame other = WalkChain(
        job.constants, job.columns, tile.second_joints + t,
        At(tile.second_tilts, t), At(tile.second_motions, t), job.scratch);
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
}  // namespace alidade::internal::kernel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace alidade::internal::kernel {

HWY_EXPORT(EvaluateTile);
HWY_EXPORT(SumTile);

std::size_t ScratchSize(int num_joints) {
  return static_cast<std::size_t>(num_joints) * HWY_NAMESPACE::kArraysPerJoint *
         kMostLanes;
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

}  // namespace alidade::internal::kernel
#endif  // HWY_ONCE
