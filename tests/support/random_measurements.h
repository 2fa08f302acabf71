#ifndef ALIDADE_TESTS_SUPPORT_RANDOM_MEASUREMENTS_H_
#define ALIDADE_TESTS_SUPPORT_RANDOM_MEASUREMENTS_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <limits>
#include <utility>
#include <vector>

#include "alidade/arm.h"
#include "alidade/dataset.h"
#include "alidade/parameter_layout.h"
#include "alidade/references.h"
#include "src/common/random.h"
#include "tests/support/edit.h"
#include "tests/support/measurement_oracle.h"
#include "tests/support/random_arms.h"
#include "tests/support/random_datasets.h"
#include "tests/support/random_errors.h"

namespace alidade::internal::testing {

/// Poses and observations of what RandomMeasurements makes. Observation i of a
/// block is of pose i and of target i modulo the number of targets.
inline constexpr int kMeasuredPoses = 6;
inline constexpr int kMeasuredTargets = 2;
/// The first three points are where a target really is, the others are far
/// from all.
inline constexpr int kContactPoints = 3;
inline constexpr int kMeasuredPoints = 5;
inline constexpr int kMeasuredPlanes = 2;

/// How rows are weighted.
enum class Weighting {
  kSigmas,  ///< each row its own
  kMasked,  ///< and some rows not measured
  kFull,    ///< whiteners, full or none, some rows not measured
};

/// Places the first points and the planes where targets are, so that sockets
/// and planes really are touched, and the other points 2 m and more from them.
void PlaceReferences(MeasuredArm* measured, Random* random);

/// A block of one kind without measured values, unit sigmas.
ObservationBlock MakeBlock(MeasurementKind kind, int count);

/// What the values really give, rounded to double.
void Measure(const MeasuredArm& measured, ObservationBlock* block);

/// Sigmas of 0.01 to 1 mm or mrad; of the second observation of three, one row
/// not measured; whiteners for two of three.
void WeightRows(Weighting weighting, ObservationBlock* block, Random* random);

inline const std::vector<MeasurementKind>& AllKinds() {
  static const std::vector<MeasurementKind> kinds = {
      MeasurementKind::kPosition,     MeasurementKind::kPose,
      MeasurementKind::kDistance,     MeasurementKind::kFixedPoint,
      MeasurementKind::kPlane,        MeasurementKind::kDifference,
      MeasurementKind::kPointDistance};
  return kinds;
}

/// Columns of the data in another order than the arm's effects, of which one is
/// of no column.
void AddCovariates(MeasuredArm* measured, Random* random);

/// A random arm of two targets with rotated frames, five points and two planes,
/// and one block of exact measurements of every kind. A flexible arm has all
/// error terms.
MeasuredArm RandomMeasurements(int num_joints, Weighting weighting,
                               Random* random, double prismatic_fraction = 0.3,
                               bool is_flexible = false);

}  // namespace alidade::internal::testing

#endif  // ALIDADE_TESTS_SUPPORT_RANDOM_MEASUREMENTS_H_
