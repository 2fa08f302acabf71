#ifndef ALIDADE_SRC_CLI_VALIDATION_DATA_H_
#define ALIDADE_SRC_CLI_VALIDATION_DATA_H_

#include <cstdint>
#include <string>
#include <vector>

#include "alidade/accuracy.h"
#include "alidade/arm.h"
#include "alidade/calibration_options.h"

namespace alidade::internal {

/// What `validate --refit` finds anew, of each data set alone.
struct Refit {
  bool base = false;
  bool tool = false;
  bool references = false;

  bool any() const { return base || tool || references; }
  std::string Text() const;  ///< "base, tool"
};

/// "base,tool,references", any of them. @throws InputError.
Refit ReadRefit(const std::string& text);

/// Measurements that an arm is held against: a data set, or all of the `data`
/// of a job, whatever they are; the job's arm only says how its columns are
/// read, and, where the tool is refitted, which targets there are: `arm` gets
/// those. @throws InputError.
CalibrationData LoadValidationData(const std::string& path, const Refit& refit,
                                   double default_sigma, int num_threads,
                                   Arm* arm);

/// Names of points and planes of which nobody says where they are.
std::vector<std::string> UnknownReferences(const References& references);

/// The position errors of an arm, with the geometry of its joints as it is. Its
/// base and targets are refitted to the data first where asked for, and so are
/// unknown references in any case. @throws InputError where that fails.
Accuracy ValidationAccuracy(const std::string& path, const Arm& arm,
                            CalibrationData data, const Refit& refit,
                            int num_threads);

/// The arm with base and targets where it agrees best with another one.
Arm AlignedWith(const Arm& arm, const Arm& reference, std::uint64_t seed,
                int num_threads);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CLI_VALIDATION_DATA_H_
