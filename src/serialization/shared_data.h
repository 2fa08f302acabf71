#ifndef ALIDADE_SRC_SERIALIZATION_SHARED_DATA_H_
#define ALIDADE_SRC_SERIALIZATION_SHARED_DATA_H_

#include <cstdint>
#include <string>
#include <vector>

#include "alidade/references.h"
#include "alidade/team.h"
#include "src/dataio/dataset_csv.h"
#include "src/serialization/yaml_reader.h"

namespace alidade::internal {

/// Who reads which of a job's data sets: member r of K the consecutive files
/// from ceil(r F / K) to ceil((r + 1) F / K) of F. Members without a file have
/// nothing to do.
class FileShare {
 public:
  /// All is read here.
  FileShare() = default;
  /// `paths` are those of all data sets that `value` names. Collective.
  /// @throws InputError where members see different files.
  FileShare(Team* team, const YamlValue& value,
            const std::vector<std::string>& paths);

  int rank() const { return rank_; }
  /// The member that reads the next file.
  int NextReader();

 private:
  int rank_ = 0;
  int size_ = 1;
  std::int64_t next_ = 0;
  std::int64_t count_ = 0;
};

/// The rows of every member, on every member. Collective.
std::vector<RejectedRow> OfAllMembers(Team* team,
                                      const std::vector<RejectedRow>& mine);

/// Makes what the members have read a share of one each. Reference points and
/// planes that files have added to those `known` before get the numbers that
/// they have where one process reads all. Rejected rows of all are then on
/// every member. Collective.
void ShareLoaded(Team* team, const References& known, LoadedData* loaded,
                 References* references);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_SHARED_DATA_H_
