#ifndef ALIDADE_SRC_CALIBRATION_IDENTIFIABILITY_CACHE_H_
#define ALIDADE_SRC_CALIBRATION_IDENTIFIABILITY_CACHE_H_

#include <cstddef>
#include <deque>
#include <mutex>
#include <string>
#include <utility>

#include "alidade/identifiability.h"
#include "src/kernel/measurement_model.h"

namespace alidade::internal {

/// The identifiability pass of jobs that ask the same question. It looks at the
/// nominal arm, the poses and the sigmas, and at no measured position: so the
/// jobs of one arm and one set of poses share it, whatever the noise. Safe to
/// use from several threads.
class IdentifiabilityCache {
 public:
  /// As AnalyzeIdentifiability, bit by bit: an earlier result where all that it
  /// depends on has the same bytes.
  IdentifiabilityResult Analyze(const MeasurementModel& model,
                                const Dataset& data,
                                const IdentifiabilityOptions& options);

  /// How often the pass was made.
  std::size_t num_made() const;

 private:
  mutable std::mutex mutex_;
  std::deque<std::pair<std::string, IdentifiabilityResult>> known_;
  std::size_t num_made_ = 0;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_IDENTIFIABILITY_CACHE_H_
