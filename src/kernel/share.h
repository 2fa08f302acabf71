#ifndef ALIDADE_SRC_KERNEL_SHARE_H_
#define ALIDADE_SRC_KERNEL_SHARE_H_

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "alidade/dataset.h"
#include "alidade/team.h"

// Data sets of which every member of a team has a share. What is done to all
// observations is done to each share where it is; what must be known of all of
// them (a median, a sum) goes to member 0 as numbers in the order of the whole,
// and its outcome back. So it has the same bits as it has of a whole data set,
// which all of this takes as well: it then does no more than it must.
//
// All functions are collective (team.h) where the data set is a share.
namespace alidade::internal {

/// Makes the data sets that the members have read shares of one, as
/// MergeDatasets would merge them: the same blocks on all, in the same order,
/// with the same lists; files and name are those of the whole.
/// @pre `team` outlives the data; joint values have as many rows everywhere.
void ShareData(Team* team, Dataset* data);

/// Counts poses and observations anew after some were taken out of a share.
/// @pre the members have the same blocks.
void CountShare(Dataset* data);

/// Appends observations that belong to no pose (kPointDistance), given alike on
/// every member: they go to the first shard of member 0.
void AppendShared(const ObservationBlock& block, Dataset* data);

/// The sum of the members' numbers, on every member.
std::int64_t SumOverMembers(const Dataset& data, std::int64_t mine);

/// The number of scalar measurements of all shares.
Eigen::Index AllEquations(const Dataset& data);

/// Whether `mine` is true on every member.
bool OnAllMembers(const Dataset& data, bool mine);

/// Poses that were taken out of a share, `mine`, with those of all others: a
/// whole data set without shards, on every member.
/// @pre mine has the share's blocks, and lists where the others' have them.
Dataset GatherData(const Dataset& data, Dataset mine);

/// Whether this member knows the whole: it is member 0, or has all data.
inline bool KnowsAll(const Dataset& data) {
  return data.share.team == nullptr || data.share.team->is_first();
}

/// compute() where the whole is known; its value on every member.
template <typename Compute>
auto ComputeOnFirst(const Dataset& data, const Compute& compute) {
  decltype(compute()) value{};
  if (KnowsAll(data)) value = compute();
  return data.share.team == nullptr ? value : data.share.team->OfFirst(value);
}

/// Numbers of some observations of each block, in the order of the whole data
/// set: block after block, in each member after member. On member 0; nothing on
/// others.
template <typename T>
std::vector<T> InOrder(const Dataset& data,
                       std::vector<std::vector<T>> by_block) {
  std::vector<std::vector<std::vector<T>>> members;  // of each its blocks
  if (data.share.team == nullptr) {
    if (by_block.size() == 1) return std::move(by_block.front());
    members.push_back(std::move(by_block));
  } else {
    ByteWriter writer;
    for (const std::vector<T>& list : by_block) writer.PutList(list);
    by_block.clear();
    for (const std::string& bytes :
         data.share.team->GatherToFirst(writer.Take())) {
      ByteReader reader(bytes);
      members.emplace_back();
      for (std::size_t k = 0; k < data.blocks.size(); ++k) {
        members.back().push_back(reader.GetList<T>());
      }
    }
  }
  std::vector<T> all;
  if (members.empty()) return all;
  for (std::size_t k = 0; k < data.blocks.size(); ++k) {
    for (const auto& blocks : members) {
      all.insert(all.end(), blocks[k].begin(), blocks[k].end());
    }
  }
  return all;
}

/// A column of `mine` for each observation: those of the whole, in order. On
/// member 0; as many rows and no column on others.
SharedMatrix ObservationsInOrder(const Dataset& data, SharedMatrix mine);
/// The same with an entry for each observation.
SharedVector EntriesInOrder(const Dataset& data, SharedVector mine);
/// The sum of entries, one for each observation, added up in the order of the
/// whole; on every member.
double SumInOrder(const Dataset& data, SharedVector mine);
/// The same as ObservationsInOrder with a column for each pose.
SharedMatrix PosesInOrder(const Dataset& data, SharedMatrix mine);

/// The number of the whole's observation that is observation i of a block here.
Eigen::Index ObservationInAll(const Dataset& data, std::size_t block,
                              Eigen::Index i);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_KERNEL_SHARE_H_
