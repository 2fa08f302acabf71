#ifndef ALIDADE_SRC_SERIALIZATION_PARTITIONED_DATA_H_
#define ALIDADE_SRC_SERIALIZATION_PARTITIONED_DATA_H_

#include <cstdint>
#include <string>
#include <vector>

#include "alidade/communicator.h"
#include "alidade/references.h"
#include "src/dataio/dataset_csv.h"
#include "src/serialization/yaml_reader.h"

namespace alidade::internal {

/// Who reads which of a job's data sets: rank r of K the consecutive files
/// from ceil(r F / K) to ceil((r + 1) F / K) of F. Ranks without a file have
/// nothing to do.
class FileAssignment {
 public:
  /// All is read here.
  FileAssignment() = default;
  /// `paths` are those of all data sets that `value` names. Collective.
  /// @throws InputError where ranks see different files.
  FileAssignment(Communicator* communicator, const YamlValue& value,
                 const std::vector<std::string>& paths);

  int rank() const { return rank_; }
  /// The rank that reads the next file.
  int NextReader();

 private:
  int rank_ = 0;
  int size_ = 1;
  std::int64_t next_ = 0;
  std::int64_t count_ = 0;
};

/// The texts of every rank, on every rank. Collective.
std::vector<std::vector<std::string>> TextsOfRanks(
    Communicator* communicator, const std::vector<std::string>& mine);

/// Each of them once, in the order of ranks. Collective.
std::vector<std::string> DistinctTexts(Communicator* communicator,
                                       const std::vector<std::string>& mine);

/// The rows of every rank, on every rank. Collective.
std::vector<RejectedRow> OfAllRanks(Communicator* communicator,
                                    const std::vector<RejectedRow>& mine);

/// Makes what the ranks have read parts of one. Reference points and
/// planes that files have added to those `known` before get the numbers that
/// they have where one process reads all. Rejected rows of all are then on
/// every rank. Collective.
void PartitionLoaded(Communicator* communicator, const References& known,
                     LoadedData* loaded, References* references);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_PARTITIONED_DATA_H_
