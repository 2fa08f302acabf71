#ifndef ALIDADE_MEASUREMENT_HOLDOUT_H_
#define ALIDADE_MEASUREMENT_HOLDOUT_H_

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "alidade/measurement/dataset.h"

namespace alidade {

/// The configuration that each row of a data set belongs to, numbered from 0 in
/// the order of their first rows. Rows with the same joint values to the bit
/// are repeats of one configuration: what is fitted to one of them has seen
/// the others. O(N log N).
std::vector<int> GroupByConfiguration(const Dataset& data);

/// The rows of `data` at `rows`, in that order.
Dataset SelectRows(const Dataset& data, const std::vector<Eigen::Index>& rows);

/// A data set cut in two: what is fitted, and what the fit must not see.
struct HoldOut {
  Dataset train;
  Dataset heldout;
};

/// Holds out `fraction` of the configurations, rounded to the nearest count and
/// drawn without replacement by the seed; repeats of a configuration stay
/// together. Both parts keep the order of the rows. The split depends on the
/// number and order of configurations and on the seed alone.
/// @pre 0 < fraction < 1. Where so few configurations are there that one part
/// would be empty, it stays empty: the caller decides what that means.
HoldOut HoldOutFraction(const Dataset& data, double fraction,
                        std::uint64_t seed);

/// Fold k of `folds`: the configurations are shuffled by the seed and dealt
/// out in turn, so that every one is held out in exactly one fold and the folds
/// differ by at most one configuration.
/// @pre folds >= 2, 0 <= k < folds.
HoldOut HoldOutFold(const Dataset& data, int folds, int k, std::uint64_t seed);

}  // namespace alidade

#endif  // ALIDADE_MEASUREMENT_HOLDOUT_H_
