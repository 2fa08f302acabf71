#include "src/serialization/partitioned_data.h"

#include <algorithm>
#include <cstddef>

#include "src/common/bytes.h"
#include "src/kernel/partition.h"

namespace alidade::internal {
namespace {

// The list with what other ranks have added to it, in their order. Returns
// the new number of each of its entries.
template <typename Reference>
std::vector<int> MergeNames(Communicator* communicator, std::size_t num_known,
                            std::vector<Reference>* references) {
  std::vector<std::string> mine;
  for (std::size_t k = num_known; k < references->size(); ++k) {
    mine.push_back((*references)[k].name);
  }
  const std::vector<std::string> all = DistinctTexts(communicator, mine);
  std::vector<int> numbers(num_known);
  for (std::size_t k = 0; k < num_known; ++k) numbers[k] = static_cast<int>(k);
  for (const std::string& name : mine) {
    const auto at = std::find(all.begin(), all.end(), name) - all.begin();
    numbers.push_back(static_cast<int>(num_known) + static_cast<int>(at));
  }
  references->resize(num_known);
  for (const std::string& name : all) {
    references->emplace_back();
    references->back().name = name;
  }
  return numbers;
}

}  // namespace

FileAssignment::FileAssignment(Communicator* communicator,
                               const YamlValue& value,
                               const std::vector<std::string>& paths)
    : rank_(communicator->rank()),
      size_(communicator->size()),
      count_(static_cast<std::int64_t>(paths.size())) {
  const auto all = TextsOfRanks(communicator, paths);
  for (std::size_t rank = 1; rank < all.size(); ++rank) {
    if (all[rank] == all[0]) continue;
    value.Fail("process " + std::to_string(rank) + " sees " +
               std::to_string(all[rank].size()) +
               " files here that are not the " + std::to_string(all[0].size()) +
               " that process 0 sees: expected the same names on all machines");
  }
}

int FileAssignment::NextReader() {
  return size_ == 1 ? 0 : static_cast<int>(next_++ * size_ / count_);
}

void PartitionLoaded(Communicator* communicator, const References& known,
                     LoadedData* loaded, References* references) {
  const std::vector<int> points =
      MergeNames(communicator, known.points.size(), &references->points);
  const std::vector<int> planes =
      MergeNames(communicator, known.planes.size(), &references->planes);
  for (ObservationBlock& block : loaded->data.blocks) {
    const std::vector<int>& numbers =
        block.kind == MeasurementKind::kPlane ? planes : points;
    for (int& reference : block.references) reference = numbers[reference];
  }
  MakePartition(communicator, &loaded->data);
  if (!OnAllRanks(communicator, loaded->data, loaded->sets.empty())) {
    loaded->sets.resize(static_cast<std::size_t>(loaded->data.num_poses()));
  }
  loaded->rejected = OfAllRanks(communicator, loaded->rejected);
}

std::vector<RejectedRow> OfAllRanks(Communicator* communicator,
                                    const std::vector<RejectedRow>& mine) {
  std::vector<std::string> texts;
  for (const RejectedRow& row : mine) {
    texts.insert(texts.end(), {row.file, std::to_string(row.line), row.reason});
  }
  std::vector<RejectedRow> all;
  for (const auto& rows : TextsOfRanks(communicator, texts)) {
    for (std::size_t k = 0; k < rows.size(); k += 3) {
      all.push_back({rows[k], std::stoi(rows[k + 1]), rows[k + 2]});
    }
  }
  return all;
}

std::vector<std::vector<std::string>> TextsOfRanks(
    Communicator* communicator, const std::vector<std::string>& mine) {
  ByteWriter writer;
  writer.PutTexts(mine);
  std::vector<std::vector<std::string>> all;
  for (const std::string& bytes : communicator->Gather(writer.Take())) {
    all.push_back(ByteReader(bytes).GetTexts());
  }
  return all;
}

std::vector<std::string> DistinctTexts(Communicator* communicator,
                                       const std::vector<std::string>& mine) {
  std::vector<std::string> distinct;
  for (const auto& texts : TextsOfRanks(communicator, mine)) {
    for (const std::string& text : texts) {
      if (std::find(distinct.begin(), distinct.end(), text) == distinct.end()) {
        distinct.push_back(text);
      }
    }
  }
  return distinct;
}

}  // namespace alidade::internal
