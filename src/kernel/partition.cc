#include "src/kernel/partition.h"

#include <glog/logging.h>

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <string>
#include <utility>

#include "src/common/bytes.h"
#include "src/data/merge_blocks.h"

namespace alidade::internal {
namespace {

// What the others must know of a block to give theirs the same lists.
struct BlockOutline {
  MeasurementKind kind = MeasurementKind::kPosition;
  std::int64_t size = 0;
  bool has_targets = false;
  bool has_whiteners = false;
  bool is_of_each_pose = false;
};

struct Outline {
  std::string name;
  std::vector<std::string> files;
  std::vector<BlockOutline> blocks;
};

std::string Pack(const Dataset& data) {
  ByteWriter writer;
  writer.PutText(data.name);
  writer.PutTexts(data.files);
  std::vector<BlockOutline> blocks;
  for (const ObservationBlock& block : data.blocks) {
    if (block.size() == 0) continue;
    blocks.push_back({block.kind, block.size(), !block.targets.empty(),
                      !block.whiteners.empty(), block.poses.empty()});
  }
  // A kind that is missing here is not measured at each pose.
  writer.PutList(blocks);
  writer.Put(static_cast<std::int64_t>(data.num_poses()));
  return writer.Take();
}

// The global blocks: kinds in the order that they first come in.
class GlobalOutline {
 public:
  void Add(const std::string& bytes) {
    ByteReader reader(bytes);
    const std::string name = reader.GetText();
    if (!name.empty()) name_ += (name_.empty() ? "" : ", ") + name;
    first_files_.push_back(static_cast<int>(files_.size()));
    for (std::string& file : reader.GetTexts()) {
      files_.push_back(std::move(file));
    }
    const auto blocks = reader.GetList<BlockOutline>();
    const bool has_poses = reader.Get<std::int64_t>() > 0;
    for (const BlockOutline& block : blocks) {
      BlockOutline* const mine = FindOrAdd(block.kind);
      mine->has_targets = mine->has_targets || block.has_targets;
      mine->has_whiteners = mine->has_whiteners || block.has_whiteners;
      mine->is_of_each_pose = mine->is_of_each_pose && block.is_of_each_pose;
    }
    if (has_poses) kinds_of_ranks_.push_back(blocks);
  }

  // Once all are added.
  void Finish() {
    for (BlockOutline& block : blocks_) {
      for (const std::vector<BlockOutline>& rank : kinds_of_ranks_) {
        const bool is_there = std::any_of(rank.begin(), rank.end(),
                                          [&](const BlockOutline& other) {
                                            return other.kind == block.kind;
                                          });
        block.is_of_each_pose = block.is_of_each_pose && is_there;
      }
    }
  }

  const std::string& name() const { return name_; }
  const std::vector<std::string>& files() const { return files_; }
  int first_file(int rank) const { return first_files_[rank]; }
  const std::vector<BlockOutline>& blocks() const { return blocks_; }

 private:
  BlockOutline* FindOrAdd(MeasurementKind kind) {
    for (BlockOutline& block : blocks_) {
      if (block.kind == kind) return &block;
    }
    blocks_.push_back({kind, 0, false, false, true});
    return &blocks_.back();
  }

  std::string name_;
  std::vector<std::string> files_;
  std::vector<int> first_files_;
  std::vector<BlockOutline> blocks_;
  std::vector<std::vector<BlockOutline>> kinds_of_ranks_;
};

ObservationBlock EmptyBlock(MeasurementKind kind) {
  ObservationBlock block;
  block.kind = kind;
  block.measured = Eigen::MatrixXd(block.rows_each(), 0);
  block.sigmas = block.measured;
  return block;
}

void GiveLists(const BlockOutline& outline, ObservationBlock* block) {
  const auto size = static_cast<std::size_t>(block->size());
  if (outline.has_targets) block->targets.resize(size, 0);
  if (outline.has_whiteners) block->whiteners.resize(size);
  if (!outline.is_of_each_pose && block->poses.empty() &&
      block->kind != MeasurementKind::kPointDistance) {
    block->poses.resize(size);
    std::iota(block->poses.begin(), block->poses.end(), 0);
  }
}

// Puts the blocks, and what shards say of them, in the global order.
void Rearrange(const std::vector<BlockOutline>& outlines, Dataset* data) {
  std::vector<ObservationBlock> blocks;
  std::vector<Shard> shards = data->shards;
  for (Shard& shard : shards) shard.first_observations.clear();
  for (const BlockOutline& outline : outlines) {
    const auto found = std::find_if(
        data->blocks.begin(), data->blocks.end(),
        [&](const ObservationBlock& b) { return b.kind == outline.kind; });
    const bool is_here = found != data->blocks.end();
    const auto k = static_cast<std::size_t>(found - data->blocks.begin());
    for (std::size_t s = 0; s < shards.size(); ++s) {
      shards[s].first_observations.push_back(
          is_here ? data->shards[s].first_observations[k] : 0);
    }
    blocks.push_back(is_here ? std::move(*found) : EmptyBlock(outline.kind));
    GiveLists(outline, &blocks.back());
  }
  data->blocks = std::move(blocks);
  data->shards = std::move(shards);
}

void PutBlock(const ObservationBlock& block, ByteWriter* writer) {
  writer->PutList(block.poses);
  writer->PutList(block.targets);
  writer->PutList(block.references);
  writer->PutList(block.seconds);
  writer->PutMatrix(block.measured);
  writer->PutMatrix(block.sigmas);
  writer->Put(static_cast<std::int64_t>(block.whiteners.size()));
  for (const Eigen::MatrixXd& whitener : block.whiteners) {
    writer->PutMatrix(whitener);
  }
}

void PutSources(const PoseSources& sources, ByteWriter* writer) {
  writer->PutList(sources.runs());
  writer->Put(static_cast<std::int64_t>(sources.size()));
}

PoseSources GetSources(ByteReader* reader) {
  const auto runs = reader->GetList<PoseSources::Run>();
  const auto size = static_cast<std::size_t>(reader->Get<std::int64_t>());
  PoseSources sources;
  for (std::size_t k = 0; k < runs.size(); ++k) {
    const std::size_t end = k + 1 < runs.size() ? runs[k + 1].first_pose : size;
    sources.Append(runs[k].source, end - runs[k].first_pose);
  }
  return sources;
}

ObservationBlock GetBlock(MeasurementKind kind, ByteReader* reader) {
  ObservationBlock block;
  block.kind = kind;
  block.poses = reader->GetList<int>();
  block.targets = reader->GetList<int>();
  block.references = reader->GetList<int>();
  block.seconds = reader->GetList<int>();
  block.measured = reader->GetMatrix();
  block.sigmas = reader->GetMatrix();
  block.whiteners.resize(static_cast<std::size_t>(reader->Get<std::int64_t>()));
  for (Eigen::MatrixXd& whitener : block.whiteners) {
    whitener = reader->GetMatrix();
  }
  return block;
}

// Columns of every rank, one rank after the other.
SharedMatrix SideBySide(Eigen::Index rows,
                        const std::vector<std::string>& ranks) {
  std::vector<Eigen::MatrixXd> parts;
  Eigen::Index count = 0;
  for (const std::string& bytes : ranks) {
    parts.push_back(ByteReader(bytes).GetMatrix());
    count += parts.back().cols();
  }
  MatrixBuilder all(rows, count);
  Eigen::Index first = 0;
  for (const Eigen::MatrixXd& part : parts) {
    all.map().middleCols(first, part.cols()) = part;
    first += part.cols();
  }
  return all.Freeze();
}

// What was taken out of all parts as one. `mine` has the names.
Dataset JoinRanks(const std::vector<Dataset>& parts, Dataset mine) {
  Dataset all;
  all.name = std::move(mine.name);
  all.files = std::move(mine.files);
  Eigen::Index num_poses = 0;
  for (const Dataset& part : parts) num_poses += part.num_poses();
  MatrixBuilder joint_values(mine.num_joints(), num_poses);
  all.covariate_names = std::move(mine.covariate_names);
  const bool has_covariates = !all.covariate_names.empty();
  MatrixBuilder covariates(
      static_cast<Eigen::Index>(all.covariate_names.size()),
      has_covariates ? num_poses : 0);
  std::vector<std::vector<PartBlock>> blocks(mine.blocks.size());
  Eigen::Index first = 0;
  for (const Dataset& part : parts) {
    joint_values.map().middleCols(first, part.num_poses()) =
        part.joint_values.map();
    if (has_covariates) {
      covariates.map().middleCols(first, part.num_poses()) =
          part.covariates.map();
    }
    all.sources.Append(part.sources, 0);
    for (std::size_t k = 0; k < blocks.size(); ++k) {
      blocks[k].push_back({&part.blocks[k], static_cast<int>(first)});
    }
    first += part.num_poses();
  }
  all.joint_values = joint_values.Freeze();
  all.covariates = covariates.Freeze();
  for (const std::vector<PartBlock>& parts_of_kind : blocks) {
    all.blocks.push_back(MergeBlocks(parts_of_kind, num_poses));
  }
  return all;
}

// What is here among what all ranks have.
Partition Count(Communicator* communicator, const Dataset& data) {
  std::vector<std::int64_t> mine = {data.num_poses()};
  for (const ObservationBlock& block : data.blocks) {
    mine.push_back(block.size());
  }
  ByteWriter writer;
  writer.PutList(mine);
  std::vector<Eigen::Index> first(mine.size(), 0);
  std::vector<Eigen::Index> all(mine.size(), 0);
  int rank = 0;
  for (const std::string& bytes : communicator->Gather(writer.Take())) {
    if (rank++ == communicator->rank()) first = all;
    const auto counts = ByteReader(bytes).GetList<std::int64_t>();
    for (std::size_t k = 0; k < all.size(); ++k) all[k] += counts[k];
  }
  return {first[0],
          all[0],
          {first.begin() + 1, first.end()},
          {all.begin() + 1, all.end()}};
}

}  // namespace

void MakePartition(Communicator* communicator, Dataset* data) {
  GlobalOutline global;
  for (const std::string& bytes : communicator->Gather(Pack(*data))) {
    global.Add(bytes);
  }
  global.Finish();
  Rearrange(global.blocks(), data);
  data->name = global.name();
  data->files = global.files();
  PoseSources sources;
  sources.Append(data->sources, global.first_file(communicator->rank()));
  data->sources = std::move(sources);
  data->partition = Count(communicator, *data);
}

void CountParts(Communicator* communicator, const Dataset& data,
                Dataset* part) {
  if (data.partition) part->partition = Count(communicator, *part);
}

void AppendGlobal(Communicator* communicator, const ObservationBlock& block,
                  Dataset* data) {
  const bool is_mine = HoldersOf(communicator, *data)->is_root();
  data->blocks.push_back(is_mine ? block : EmptyBlock(block.kind));
  const Eigen::Index size = data->blocks.back().size();
  for (std::size_t s = 0; s < data->shards.size(); ++s) {
    data->shards[s].first_observations.push_back(s == 0 ? 0 : size);
  }
  CountParts(communicator, *data, data);
}

Communicator* HoldersOf(Communicator* communicator, const Dataset& data) {
  if (!data.partition) return SingleProcess();
  CHECK(communicator != SingleProcess()) << "who has the other parts?";
  return communicator;
}

std::int64_t SumOverRanks(Communicator* communicator, const Dataset& data,
                          std::int64_t mine) {
  return HoldersOf(communicator, data)->Sum(mine);
}

Eigen::Index GlobalEquations(Communicator* communicator, const Dataset& data) {
  return SumOverRanks(communicator, data, data.num_equations());
}

bool OnAllRanks(Communicator* communicator, const Dataset& data, bool mine) {
  return SumOverRanks(communicator, data, mine ? 0 : 1) == 0;
}

Dataset GatherData(Communicator* communicator, const Dataset& data,
                   Dataset mine) {
  mine.shards.clear();
  mine.partition.reset();
  if (!data.partition) return mine;
  ByteWriter writer;
  writer.PutMatrix(mine.joint_values);
  writer.PutMatrix(mine.covariates);
  PutSources(mine.sources, &writer);
  for (const ObservationBlock& block : mine.blocks) PutBlock(block, &writer);
  std::vector<Dataset> parts;
  for (const std::string& bytes : communicator->Gather(writer.Take())) {
    ByteReader reader(bytes);
    parts.emplace_back();
    parts.back().joint_values = reader.GetMatrix();
    parts.back().covariates = reader.GetMatrix();
    parts.back().sources = GetSources(&reader);
    for (const ObservationBlock& block : mine.blocks) {
      parts.back().blocks.push_back(GetBlock(block.kind, &reader));
    }
  }
  return JoinRanks(parts, std::move(mine));
}

SharedMatrix PosesInOrder(Communicator* communicator, const Dataset& data,
                          SharedMatrix mine) {
  if (!data.partition) return mine;
  const Eigen::Index rows = mine.rows();
  ByteWriter writer;
  writer.PutMatrix(mine);
  mine = {};
  return SideBySide(rows, communicator->GatherToRoot(writer.Take()));
}

SharedMatrix ObservationsInOrder(Communicator* communicator,
                                 const Dataset& data, SharedMatrix mine) {
  if (!data.partition) return mine;
  MatrixBuilder all(mine.rows(),
                    communicator->is_root() ? data.global_observations() : 0);
  Eigen::Index mine_first = 0;
  Eigen::Index first = 0;
  for (const ObservationBlock& block : data.blocks) {
    ByteWriter writer;
    writer.PutMatrix(mine.Columns(mine_first, block.size()));
    mine_first += block.size();
    const SharedMatrix columns =
        SideBySide(mine.rows(), communicator->GatherToRoot(writer.Take()));
    all.map().middleCols(first, columns.cols()) = columns.map();
    first += columns.cols();
  }
  return all.Freeze();
}

SharedVector EntriesInOrder(Communicator* communicator, const Dataset& data,
                            SharedVector mine) {
  if (!data.partition) return mine;
  return ObservationsInOrder(communicator, data, mine.Reshaped(1))
      .map()
      .transpose();
}

double SumInOrder(Communicator* communicator, const Dataset& data,
                  SharedVector mine) {
  const SharedVector all = EntriesInOrder(communicator, data, std::move(mine));
  return ComputeOnRoot(communicator, data, [&] { return all.map().sum(); });
}

Eigen::Index GlobalObservation(const Dataset& data, std::size_t block,
                               Eigen::Index i) {
  Eigen::Index first =
      data.partition ? data.partition->first_observations[block] : 0;
  for (std::size_t k = 0; k < block; ++k) first += data.global_observations(k);
  return first + i;
}

}  // namespace alidade::internal
