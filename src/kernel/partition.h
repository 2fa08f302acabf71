#ifndef ALIDADE_SRC_KERNEL_PARTITION_H_
#define ALIDADE_SRC_KERNEL_PARTITION_H_

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "alidade/communicator.h"
#include "alidade/dataset.h"
#include "src/common/bytes.h"

// Data sets of which every rank of a communicator holds a part. What is done to
// all observations is done to each part where it is; what must be known of all
// of them (a median, a sum) goes to the root as numbers in the global order,
// and its outcome back. So it has the same bits as it has of a global data set,
// which all of this takes as well, with any communicator: it then does no more
// than it must, and is not collective. Else all functions are.
namespace alidade::internal {

/// Makes the data sets that the ranks have read parts of one, as MergeDatasets
/// would merge them: the same blocks on all, in the same order, with the same
/// lists; files and name are those of the global data set.
/// @pre joint values have as many rows everywhere.
void MakePartition(Communicator* communicator, Dataset* data);

/// Appends observations that belong to no pose (kPointDistance), given alike on
/// every rank: they go to the first shard of the root.
void AppendGlobal(Communicator* communicator, const ObservationBlock& block,
                  Dataset* data);

/// Makes what each rank has taken out of its part of `data` a part as well.
/// @pre part has the blocks of data.
void CountParts(Communicator* communicator, const Dataset& data, Dataset* part);

/// The ranks that hold parts of the data: this one alone, where it has all.
Communicator* HoldersOf(Communicator* communicator, const Dataset& data);

/// The sum of all holders' numbers, on every rank.
std::int64_t SumOverRanks(Communicator* communicator, const Dataset& data,
                          std::int64_t mine);

/// The number of scalar measurements of the global data set.
Eigen::Index GlobalEquations(Communicator* communicator, const Dataset& data);

/// Whether `mine` is true on every rank.
bool OnAllRanks(Communicator* communicator, const Dataset& data, bool mine);

/// Poses that were taken out of a part, `mine`, with those of all others: a
/// global data set without shards, on every rank.
/// @pre mine has the part's blocks, and lists where the others' have them.
Dataset GatherData(Communicator* communicator, const Dataset& data,
                   Dataset mine);

/// compute() where numbers in the global order are; its value on every rank.
template <typename Compute>
auto ComputeOnRoot(Communicator* communicator, const Dataset& data,
                   const Compute& compute) {
  Communicator* const holders = HoldersOf(communicator, data);
  decltype(compute()) value{};
  if (holders->is_root()) value = compute();
  return holders->FromRoot(value);
}

/// Numbers of some observations of each block, in the global order: block after
/// block, in each rank after rank. On the root; nothing on others.
template <typename T>
std::vector<T> InOrder(Communicator* communicator, const Dataset& data,
                       std::vector<std::vector<T>> by_block) {
  std::vector<std::vector<std::vector<T>>> ranks;  // of each its blocks
  if (!data.partition) {
    if (by_block.size() == 1) return std::move(by_block.front());
    ranks.push_back(std::move(by_block));
  } else {
    ByteWriter writer;
    for (const std::vector<T>& list : by_block) writer.PutList(list);
    by_block.clear();
    for (const std::string& bytes : communicator->GatherToRoot(writer.Take())) {
      ByteReader reader(bytes);
      ranks.emplace_back();
      for (std::size_t k = 0; k < data.blocks.size(); ++k) {
        ranks.back().push_back(reader.GetList<T>());
      }
    }
  }
  std::vector<T> all;
  for (std::size_t k = 0; k < data.blocks.size(); ++k) {
    for (const auto& blocks : ranks) {
      all.insert(all.end(), blocks[k].begin(), blocks[k].end());
    }
  }
  return all;
}

/// A column of `mine` for each observation: those of the global data set, in
/// order. On the root; as many rows and no column on others.
SharedMatrix ObservationsInOrder(Communicator* communicator,
                                 const Dataset& data, SharedMatrix mine);
/// The same with an entry for each observation.
SharedVector EntriesInOrder(Communicator* communicator, const Dataset& data,
                            SharedVector mine);
/// The sum of entries, one for each observation, added up in the global order;
/// on every rank.
double SumInOrder(Communicator* communicator, const Dataset& data,
                  SharedVector mine);
/// The same as ObservationsInOrder with a column for each pose.
SharedMatrix PosesInOrder(Communicator* communicator, const Dataset& data,
                          SharedMatrix mine);

/// The global number of observation i of a block here.
Eigen::Index GlobalObservation(const Dataset& data, std::size_t block,
                               Eigen::Index i);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_KERNEL_PARTITION_H_
