#ifndef ALIDADE_SRC_FLEET_BATCH_PLACES_H_
#define ALIDADE_SRC_FLEET_BATCH_PLACES_H_

#include <filesystem>
#include <string>
#include <unordered_set>

#include "alidade/error.h"
#include "src/fleet/batch_plan.h"

namespace alidade::internal {

/// A job reads what the batch replaces. Unlike other errors of a job, one that
/// ends the batch: what the job reads must stay.
class OutputConflict : public InputError {
 public:
  using InputError::InputError;
};

/// The directories of a batch's results, which are replaced as wholes.
class BatchPlaces {
 public:
  BatchPlaces(const BatchPlan& plan, const std::string& directory);

  /// @throws OutputConflict where the file is in one of them.
  void Refuse(const std::string& input) const;

  /// The same of all that job files name plainly, before any job is read.
  void RefuseArmsAndData(const BatchPlan& plan) const;

 private:
  const std::filesystem::path directory_;
  std::unordered_set<std::string> names_;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_FLEET_BATCH_PLACES_H_
