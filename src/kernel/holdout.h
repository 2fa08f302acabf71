#ifndef ALIDADE_SRC_KERNEL_HOLDOUT_H_
#define ALIDADE_SRC_KERNEL_HOLDOUT_H_

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "alidade/communicator.h"
#include "alidade/dataset.h"

namespace alidade::internal {

/// Numbers the poses so that those with the same joint values to the bit have
/// the same number, from 0 in the order of their first poses. O(N log N).
std::vector<int> GroupByJointValues(const Dataset& data);

/// The configuration that each pose of a data set belongs to, numbered from 0
/// in the order of their first poses. Poses with the same joint values to the
/// bit are repeats of one configuration: what is fitted to one of them has seen
/// the others. So has what is fitted to a difference of two poses: they count
/// as one configuration too. O(N log N).
std::vector<int> GroupByConfiguration(const Dataset& data);

/// The observations at `indices`, in that order; poses keep their numbers.
ObservationBlock TakeObservations(const ObservationBlock& block,
                                  const std::vector<Eigen::Index>& indices);

/// The poses of `data` at `poses`, in that order and without repeats, with
/// all that was observed at them (of a difference: at both); distances of
/// reference points belong to no pose and stay.
Dataset SelectPoses(const Dataset& data,
                    const std::vector<Eigen::Index>& poses);

/// A data set cut in two: what is fitted, and what the fit must not see.
/// Distances of reference points go to `train` alone.
struct HoldOut {
  Dataset train;
  Dataset validation;
};

/// Holds out `fraction` of the configurations, rounded to the nearest count and
/// drawn without replacement by the seed; repeats of a configuration stay
/// together. Both parts keep the order of the poses. The split depends on the
/// number and order of configurations and on the seed alone.
/// @pre 0 < fraction < 1. Where so few configurations are there that one part
/// would be empty, it stays empty: the caller decides what that means.
HoldOut HoldOutFraction(const Dataset& data, double fraction,
                        std::uint64_t seed,
                        Communicator* communicator = SingleProcess());
/// Which poses (of this part) that holds out.
std::vector<char> DrawHeldOut(const Dataset& data, double fraction,
                              std::uint64_t seed, Communicator* communicator);

/// Holds out the poses that `is_validation` is true for, one entry per pose.
/// Collective for a part (partition.h), as HoldOutFraction.
HoldOut HoldOutPoses(const Dataset& data,
                     const std::vector<bool>& is_validation,
                     Communicator* communicator = SingleProcess());

/// Fold k of `folds`: the configurations are shuffled by the seed and dealt
/// out in turn, so that every one is held out in exactly one fold and the folds
/// differ by at most one configuration.
/// @pre folds >= 2, 0 <= k < folds.
HoldOut HoldOutFold(const Dataset& data, int folds, int k, std::uint64_t seed);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_KERNEL_HOLDOUT_H_
