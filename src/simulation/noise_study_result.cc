#include "src/simulation/noise_study_result.h"

#include <algorithm>

#include "alidade/accuracy.h"

namespace alidade::internal {

double NoiseStudyMethod::Percentile(const Eigen::VectorXd& values,
                                    double fraction) {
  if (values.size() == 0) return 0.0;
  Eigen::VectorXd sorted = values;
  std::sort(sorted.data(), sorted.data() + sorted.size());
  return SortedPercentile(sorted, fraction);
}

}  // namespace alidade::internal
