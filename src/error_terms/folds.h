#ifndef ALIDADE_SRC_ERROR_TERMS_FOLDS_H_
#define ALIDADE_SRC_ERROR_TERMS_FOLDS_H_

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "alidade/dataset.h"

namespace alidade::internal {

/// Poses within a region of joint space, one entry per pose: the nearest
/// neighbours of poses drawn at random, each time a twentieth of all, until
/// `fraction` of them is met. Distances are of joint values over their standard
/// deviation; repeats of a configuration stay together.
std::vector<bool> RegionOf(const Dataset& data, double fraction,
                           std::uint64_t seed);

/// Poses of runs of consecutive configurations, of which twenty are all, drawn
/// at random until `fraction` of them is met, but not all.
std::vector<bool> BlocksOf(const Dataset& data, double fraction,
                           std::uint64_t seed);

/// What cross-validation within training data leaves out, by poses.
struct TrainingFolds {
  static constexpr int kRegions = 8;
  static constexpr int kRandom = 5;

  /// Regions of a quarter first, then random ones that cover all.
  std::vector<std::vector<bool>> left_out;
};

TrainingFolds MakeTrainingFolds(const Dataset& data);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_ERROR_TERMS_FOLDS_H_
