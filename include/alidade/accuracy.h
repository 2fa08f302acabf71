#ifndef ALIDADE_ACCURACY_H_
#define ALIDADE_ACCURACY_H_

#include <Eigen/Core>
#include <cstdint>

namespace alidade {

/// How far predicted points are from where they should be: statistics of the
/// norms |p_predicted - p_reference| over n points, in m.
struct Accuracy {
  double mean = 0.0;
  double rms = 0.0;
  double stddev = 0.0;  ///< of the norms about their mean, with n - 1
  double median = 0.0;
  double p95 = 0.0;  ///< 95th percentile, linear between order statistics
  double min = 0.0;
  double max = 0.0;
  std::int64_t n = 0;  ///< 0 = nothing was evaluated; all else is zero
};

/// Percentile of values in ascending order, linear between order statistics.
/// @pre not empty; fraction in [0, 1].
double SortedPercentile(const Eigen::VectorXd& sorted, double fraction);

/// Statistics of `errors` (m, not negative). O(n).
Accuracy SummarizeErrors(const Eigen::Ref<const Eigen::VectorXd>& errors);

}  // namespace alidade

#endif  // ALIDADE_ACCURACY_H_
