#include "src/kernel/sigma_totals.h"

#include <algorithm>
#include <string>
#include <vector>

#include "src/common/bytes.h"
#include "src/common/parallel.h"
#include "src/kernel/partition.h"

namespace alidade::internal {
namespace {

constexpr Eigen::Index kObservationsPerBlock = 8192;

// Consecutive observations of one shard and block.
struct Piece {
  std::size_t block = 0;
  Eigen::Index first = 0;
  Eigen::Index count = 0;
};

void Add(const SigmaTotals& more, SigmaTotals* sum) {
  sum->are_positive = sum->are_positive && more.are_positive;
  sum->equations += more.equations;
  sum->length_information += more.length_information;
  sum->rotation_information += more.rotation_information;
}

// Of `count` observations that are all like this one.
SigmaTotals Times(Eigen::Index count, SigmaTotals one) {
  one.equations *= count;
  one.length_information *= static_cast<double>(count);
  one.rotation_information *= static_cast<double>(count);
  return one;
}

SigmaTotals Sum(const ObservationBlock& block, const Piece& piece) {
  if (piece.count > 1 && HaveOneSigma(block, piece.first, piece.count)) {
    return Times(piece.count, Sum(block, {piece.block, piece.first, 1}));
  }
  const auto sigmas =
      block.sigmas.map().middleCols(piece.first, piece.count).array();
  SigmaTotals totals;
  totals.are_positive = (sigmas > 0.0).all();
  totals.equations = sigmas.isFinite().count();
  const int lengths = std::min(3, block.rows_each());
  const auto information = sigmas.inverse().square();
  totals.length_information = information.topRows(lengths).sum();
  if (block.rows_each() > lengths) {
    totals.rotation_information =
        information.bottomRows(block.rows_each() - lengths).sum();
  }
  return totals;
}

std::vector<Piece> PiecesOf(const Dataset& data, std::size_t shard) {
  std::vector<Piece> pieces;
  for (std::size_t block = 0; block < data.blocks.size(); ++block) {
    const auto [begin, end] = data.ShardRange(shard, block);
    for (Eigen::Index i = begin; i < end; i += kObservationsPerBlock) {
      pieces.push_back({block, i, std::min(kObservationsPerBlock, end - i)});
    }
  }
  return pieces;
}

}  // namespace

SigmaTotals SumSigmas(const Dataset& data, const Execution& execution) {
  std::vector<SigmaTotals> shards;
  for (std::size_t shard = 0; shard < data.num_shards(); ++shard) {
    const std::vector<Piece> pieces = PiecesOf(data, shard);
    std::vector<SigmaTotals> sums(pieces.size());
    ParallelFor(execution.num_threads, static_cast<std::int64_t>(pieces.size()),
                1, [&](std::int64_t begin, std::int64_t /*end*/) {
                  const Piece& piece = pieces[begin];
                  sums[begin] = Sum(data.blocks[piece.block], piece);
                });
    shards.emplace_back();
    for (const SigmaTotals& sum : sums) Add(sum, &shards.back());
  }
  ByteWriter writer;
  writer.PutList(shards);
  SigmaTotals all;
  for (const std::string& bytes :
       HoldersOf(execution.communicator, data)->Gather(writer.Take())) {
    for (const SigmaTotals& sum : ByteReader(bytes).GetList<SigmaTotals>()) {
      Add(sum, &all);
    }
  }
  return all;
}

}  // namespace alidade::internal
