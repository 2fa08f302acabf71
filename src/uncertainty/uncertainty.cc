#include "alidade/uncertainty.h"

#include <algorithm>
#include <cmath>

namespace alidade {

Histogram CountStandardised(const Eigen::VectorXd& values) {
  constexpr int kBins = 32;
  Histogram histogram;
  histogram.counts.assign(kBins, 0);
  for (const double value : values) {
    if (std::isnan(value)) continue;
    const double bin = std::floor((value - histogram.lower) / histogram.width);
    const double kept = std::clamp(bin, 0.0, static_cast<double>(kBins - 1));
    ++histogram.counts[static_cast<std::size_t>(kept)];
  }
  return histogram;
}

}  // namespace alidade
