#ifndef ALIDADE_SRC_KERNEL_SIGMA_TOTALS_H_
#define ALIDADE_SRC_KERNEL_SIGMA_TOTALS_H_

#include <cstdint>

#include "alidade/communicator.h"
#include "alidade/dataset.h"

namespace alidade::internal {

/// What a data set's sigmas come to, rows that were not measured left out.
struct SigmaTotals {
  bool are_positive = true;           ///< all of them
  std::int64_t equations = 0;         ///< rows that were measured
  double length_information = 0.0;    ///< sum of 1 / sigma^2 of lengths (1/m^2)
  double rotation_information = 0.0;  ///< of orientations (1/rad^2)
};

/// One pass over the sigmas of the global data set (partition.h), in fixed
/// blocks, so that bits do not depend on the execution. O(N).
SigmaTotals SumSigmas(const Dataset& data, const Execution& execution);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_KERNEL_SIGMA_TOTALS_H_
