#ifndef ALIDADE_SRC_CALIBRATION_EVALUATE_H_
#define ALIDADE_SRC_CALIBRATION_EVALUATE_H_

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "alidade/calibration_result.h"
#include "src/kernel/measurement_model.h"

namespace alidade::internal {

/// What observation i of a block of `data` is of. @pre the arm has its targets.
ObservationLabel LabelOf(const Arm& arm, const Dataset& data, std::size_t block,
                         Eigen::Index i);

/// The same of each observation.
std::vector<ObservationLabel> LabelsOf(const Arm& arm, const Dataset& data);

/// Errors of two sets of values, before and after, at the poses of `data`. Of
/// a part (partition.h) the global data set is evaluated; what has an entry for
/// each pose or observation is then on the root alone. `kept`: null, or the
/// data without those that were rejected, whose number `num_rejected` of the
/// result's `kept` the caller fills in. This and all below that take a data set
/// are collective.
/// Before and after each has its model, which are of one layout.
EvaluatedSet EvaluateSet(const MeasurementModel& model_before,
                         const Eigen::VectorXd& before,
                         const MeasurementModel& model,
                         const Eigen::VectorXd& after, const Dataset& data,
                         const Dataset* kept = nullptr);

/// The norms of lengths that an accuracy is made of, block by block, from the
/// stacked errors of a model: without point distances and observations of
/// orientation alone. Of a part its own.
std::vector<std::vector<double>> CountedLengths(const SharedVector& errors,
                                                const Dataset& data);

/// Accuracy of one set of values over all observations of `data`, as lengths
/// (m): of positions and differences their distance, of lengths to points and
/// planes the error of the length. Distances of reference points do not count.
Accuracy EvaluateAccuracy(const MeasurementModel& model, const Dataset& data,
                          const Eigen::VectorXd& values);

/// The same of measured orientations (rad); n = 0 where there are none.
Accuracy EvaluateRotations(const MeasurementModel& model, const Dataset& data,
                           const Eigen::VectorXd& values);

/// What measurements of one configuration, target, station and kind differ by,
/// pooled over all configurations measured more than once: the square root of
/// the sum of squares about their means over the degrees of freedom.
/// Orientations about the first of each. Positions and poses only. `covariates`
/// say which columns are stations.
RepeatSpread MeasureRepeats(const Dataset& data,
                            Communicator* communicator = SingleProcess(),
                            const std::vector<CovariateUse>& covariates = {});

/// Distance between the targets of two arms with the same joint types, both
/// given the same commands (motors' values), at `count` joint values drawn
/// uniformly within the limits of the first (revolute joints without limits: a
/// full turn). Pose k draws from stream k of the seed. @throws InputError where
/// the arms differ in their joints, or a prismatic joint has no limits.
Accuracy CompareArms(const Arm& arm, const Arm& reference, int count,
                     std::uint64_t seed);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_EVALUATE_H_
