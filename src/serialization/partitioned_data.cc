#include "src/serialization/partitioned_data.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "src/common/bytes.h"
#include "src/common/names.h"
#include "src/kernel/partition.h"

namespace alidade::internal {
namespace {

// Names from `first` on, which the data have brought.
template <typename Reference>
std::vector<std::string> NewNames(const std::vector<Reference>& references,
                                  std::size_t first) {
  std::vector<std::string> names;
  for (std::size_t k = first; k < references.size(); ++k) {
    names.push_back(references[k].name);
  }
  return names;
}

// The list with what other ranks have added to it, in their order. Returns
// the new number of each of its entries.
template <typename Reference>
std::vector<int> MergeNames(Communicator* communicator, std::size_t num_known,
                            std::vector<Reference>* references) {
  const std::vector<std::string> mine = NewNames(*references, num_known);
  ByteWriter writer;
  writer.PutTexts(mine);
  std::vector<std::string> all;
  for (const std::string& bytes : communicator->Gather(writer.Take())) {
    for (std::string& name : ByteReader(bytes).GetTexts()) {
      if (std::find(all.begin(), all.end(), name) != all.end()) continue;
      all.push_back(std::move(name));
    }
  }
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
  ByteWriter writer;
  writer.PutTexts(paths);
  const std::vector<std::string> all = communicator->Gather(writer.Take());
  for (std::size_t rank = 1; rank < all.size(); ++rank) {
    if (all[rank] == all[0]) continue;
    value.Fail("process " + std::to_string(rank) + " sees " +
               std::to_string(ByteReader(all[rank]).GetTexts().size()) +
               " files here that are not the " +
               std::to_string(ByteReader(all[0]).GetTexts().size()) +
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
  ByteWriter writer;
  for (const RejectedRow& row : mine) {
    writer.PutText(row.file);
    writer.Put(row.line);
    writer.PutText(row.reason);
  }
  std::vector<RejectedRow> all;
  for (const std::string& bytes : communicator->Gather(writer.Take())) {
    ByteReader reader(bytes);
    while (!reader.is_at_end()) {
      RejectedRow row;
      row.file = reader.GetText();
      row.line = reader.Get<int>();
      row.reason = reader.GetText();
      all.push_back(std::move(row));
    }
  }
  return all;
}

}  // namespace alidade::internal
