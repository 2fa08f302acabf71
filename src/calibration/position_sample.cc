#include "src/calibration/position_sample.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "alidade/rotation.h"
#include "src/common/bytes.h"
#include "src/kernel/partition.h"

namespace alidade::internal {
namespace {

constexpr Eigen::Index kFewestOfSample = 12;
constexpr Eigen::Index kEnough = 60;

bool IsTaken(const ObservationBlock& block, Eigen::Index i) {
  return HoldsPosition(block.kind) && block.target(i) == 0 &&
         block.sigmas.col(i).head<3>().allFinite();
}

// Column k of `count` that are evenly taken from so many.
Eigen::Index Thinned(Eigen::Index k, Eigen::Index count, Eigen::Index all) {
  return k * all / count;
}

// The positions of the first target, numbered through the global data set,
// and those of them that are looked at, with their neighbours, from all ranks.
class Positions {
 public:
  Positions(Communicator* holders, const Dataset& data) {
    for (const ObservationBlock& block : data.blocks) {
      members_.emplace_back(block);
    }
    CountAll(holders);
    Choose(holders, data);
    Collect(holders, data);
  }

  Eigen::Index count() const { return count_; }
  bool are_finite() const { return are_finite_; }

  // What is looked at: all but the first and the last, which have no row before
  // or after.
  PositionSample Sample() const {
    const auto taken = static_cast<Eigen::Index>(chosen_.size());
    const Eigen::MatrixXd none(joints_.rows(), taken);
    PositionSample sample{none, none, none, Eigen::Matrix3Xd(3, taken), {}};
    for (Eigen::Index k = 0; k < taken; ++k) {
      const Eigen::Index i = chosen_[static_cast<std::size_t>(k)];
      sample.joint_values.col(k) = joints_.col(IndexOf(i));
      sample.joint_values_before.col(k) = joints_.col(IndexOf(i - 1));
      sample.joint_values_after.col(k) = joints_.col(IndexOf(i + 1));
      sample.points.col(k) = points_.col(IndexOf(i));
      sample.numbers.push_back(i);
    }
    return sample;
  }

 private:
  // The observations of a block that are looked at. Where these are all, as in
  // nearly all large blocks, they are not listed.
  class Members {
   public:
    explicit Members(const ObservationBlock& block) {
      for (Eigen::Index i = 0; i < block.size(); ++i) {
        if (IsTaken(block, i)) ++size_;
      }
      if (size_ == block.size()) return;
      list_.reserve(static_cast<std::size_t>(size_));
      for (Eigen::Index i = 0; i < block.size(); ++i) {
        if (IsTaken(block, i)) list_.push_back(i);
      }
    }
    Eigen::Index size() const { return size_; }
    Eigen::Index operator[](Eigen::Index k) const {
      return list_.empty() ? k : list_[static_cast<std::size_t>(k)];
    }

   private:
    Eigen::Index size_ = 0;
    std::vector<Eigen::Index> list_;
  };

  // Numbers of the first of each block here, and of all.
  void CountAll(Communicator* holders) {
    std::vector<std::int64_t> sizes;
    for (const Members& members : members_) sizes.push_back(members.size());
    ByteWriter writer;
    writer.PutList(sizes);
    std::vector<std::vector<std::int64_t>> all;
    for (const std::string& bytes : holders->Gather(writer.Take())) {
      all.push_back(ByteReader(bytes).GetList<std::int64_t>());
    }
    for (std::size_t block = 0; block < sizes.size(); ++block) {
      for (int rank = 0; rank < holders->size(); ++rank) {
        if (rank == holders->rank()) first_.push_back(count_);
        count_ += all[static_cast<std::size_t>(rank)][block];
      }
    }
  }

  // Whether position k of a block here has the line after that of the one
  // before it.
  bool Follows(const Dataset& data, std::size_t block, Eigen::Index k) const {
    const auto source = [&](Eigen::Index at) {
      return data.sources[data.blocks[block].pose(members_[block][at])];
    };
    const PoseSource before = source(k - 1);
    const PoseSource here = source(k);
    return before.file == here.file && before.line + 1 == here.line;
  }

  // Numbers of those that are looked at: with lines left out between them, the
  // positions before and after are not those of the rows before and after. A
  // file is read by one rank, so that neighbours are never apart.
  void Choose(Communicator* holders, const Dataset& data) {
    const Eigen::Index rows = std::max<Eigen::Index>(0, count_ - 2);
    const Eigen::Index taken = std::min(kEnough, rows);
    std::vector<std::int64_t> mine(static_cast<std::size_t>(taken), count_);
    for (Eigen::Index k = 0; k < taken; ++k) {
      chosen_.push_back(1 + Thinned(k, taken, rows));
      for (std::size_t block = 0; block < members_.size(); ++block) {
        const Eigen::Index first = first_[block];
        const Eigen::Index end =
            std::min<Eigen::Index>(1 + Thinned(k + 1, taken, rows) - first,
                                   members_[block].size() - 1);
        for (Eigen::Index i = std::max<Eigen::Index>(1, chosen_.back() - first);
             i < end && !data.sources.empty(); ++i) {
          if (!Follows(data, block, i) || !Follows(data, block, i + 1)) {
            continue;
          }
          mine[k] = std::min<std::int64_t>(mine[k], first + i);
          break;
        }
      }
    }
    ByteWriter writer;
    writer.PutList(mine);
    std::vector<std::int64_t> nearest(static_cast<std::size_t>(taken), count_);
    for (const std::string& bytes : holders->Gather(writer.Take())) {
      const auto list = ByteReader(bytes).GetList<std::int64_t>();
      for (std::size_t k = 0; k < list.size(); ++k) {
        nearest[k] = std::min(nearest[k], list[k]);
      }
    }
    std::vector<Eigen::Index> adjacent;
    for (const std::int64_t number : nearest) {
      if (number < count_) adjacent.push_back(number);
    }
    if (static_cast<Eigen::Index>(adjacent.size()) >= kFewestOfSample) {
      chosen_ = std::move(adjacent);
    }
  }

  std::vector<Eigen::Index> Wanted() const {
    std::vector<Eigen::Index> wanted;
    for (const Eigen::Index i : chosen_) {
      wanted.insert(wanted.end(), {i - 1, i, i + 1});
    }
    std::sort(wanted.begin(), wanted.end());
    wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
    return wanted;
  }

  // Fills the columns that are wanted, with those of other ranks.
  void Collect(Communicator* holders, const Dataset& data) {
    wanted_ = Wanted();
    const auto size = static_cast<Eigen::Index>(wanted_.size());
    joints_.setZero(data.num_joints(), size);
    points_.setZero(3, size);
    bool are_finite = true;
    std::vector<std::int64_t> mine;
    for (std::size_t block = 0; block < members_.size(); ++block) {
      const ObservationBlock& observations = data.blocks[block];
      for (Eigen::Index k = 0; k < members_[block].size(); ++k) {
        const Eigen::Index i = members_[block][k];
        const Eigen::Vector3d point = observations.measured.col(i).head<3>();
        are_finite = are_finite && point.allFinite();
        const Eigen::Index number = first_[block] + k;
        if (!std::binary_search(wanted_.begin(), wanted_.end(), number)) {
          continue;
        }
        joints_.col(IndexOf(number)) =
            data.joint_values.col(observations.pose(i));
        points_.col(IndexOf(number)) = point;
        mine.push_back(IndexOf(number));
      }
    }
    are_finite_ = holders->Sum(are_finite ? 0 : 1) == 0;
    ByteWriter writer;
    for (const std::int64_t column : mine) {
      writer.Put(column);
      writer.PutMatrix(joints_.col(column));
      writer.PutMatrix(points_.col(column));
    }
    for (const std::string& bytes : holders->Gather(writer.Take())) {
      ByteReader reader(bytes);
      while (!reader.is_at_end()) {
        const auto column = reader.Get<std::int64_t>();
        joints_.col(column) = reader.GetMatrix();
        points_.col(column) = reader.GetMatrix();
      }
    }
  }

  Eigen::Index IndexOf(Eigen::Index number) const {
    return std::lower_bound(wanted_.begin(), wanted_.end(), number) -
           wanted_.begin();
  }

  std::vector<Members> members_;     // of each block here
  std::vector<Eigen::Index> first_;  // the number of the first of them
  Eigen::Index count_ = 0;
  bool are_finite_ = false;
  std::vector<Eigen::Index> chosen_;  // numbers of what is looked at
  std::vector<Eigen::Index> wanted_;  // with neighbours, in ascending order
  Eigen::MatrixXd joints_;            // a column for each of them
  Eigen::Matrix3Xd points_;
};

}  // namespace

std::optional<PositionSample> SamplePositions(const Dataset& data,
                                              Communicator* communicator) {
  const Positions positions(HoldersOf(communicator, data), data);
  if (positions.count() < kFewestOfSample || !positions.are_finite()) {
    return std::nullopt;
  }
  return positions.Sample();
}

std::optional<Dataset> PositionsInRowOrder(const Dataset& training,
                                           const Dataset& held_out) {
  constexpr std::int64_t kMost = 100000;
  for (const Dataset* data : {&training, &held_out}) {
    if (data->partition || data->sources.empty() ||
        data->files != training.files || data->num_observations() > kMost) {
      return std::nullopt;
    }
  }
  struct Row {
    PoseSource source;
    const Dataset* data;
    const ObservationBlock* block;
    Eigen::Index i;
  };
  std::vector<Row> rows;
  for (const Dataset* data : {&training, &held_out}) {
    for (const ObservationBlock& block : data->blocks) {
      for (Eigen::Index i = 0; i < block.size(); ++i) {
        if (!IsTaken(block, i)) continue;
        rows.push_back({data->sources[block.pose(i)], data, &block, i});
      }
    }
  }
  const auto place = [](const Row& row) {
    return std::make_pair(row.source.file, row.source.line);
  };
  std::stable_sort(rows.begin(), rows.end(), [&](const Row& a, const Row& b) {
    return place(a) < place(b);
  });
  const auto count = static_cast<Eigen::Index>(rows.size());
  Eigen::MatrixXd joints(training.num_joints(), count);
  Eigen::Matrix3Xd points(3, count);
  PoseSources sources;
  for (Eigen::Index k = 0; k < count; ++k) {
    const Row& row = rows[static_cast<std::size_t>(k)];
    joints.col(k) = row.data->joint_values.col(row.block->pose(row.i));
    points.col(k) = row.block->measured.col(row.i).head<3>();
    sources.push_back(row.source);
  }
  Dataset all = MakePositions(joints, points, 1.0);
  all.name = training.name;
  all.files = training.files;
  all.sources = std::move(sources);
  return all;
}

std::string PlaceOfPosition(const Dataset& data, Eigen::Index number) {
  if (data.partition) return "";
  for (const ObservationBlock& block : data.blocks) {
    for (Eigen::Index i = 0; i < block.size(); ++i) {
      if (IsTaken(block, i) && number-- == 0) {
        return SourceOf(data, block.pose(i));
      }
    }
  }
  return "";
}

Dataset WithInversePoses(const Dataset& data) {
  Dataset inverse = data;
  for (ObservationBlock& block : inverse.blocks) {
    if (block.kind != MeasurementKind::kPose) continue;
    MatrixBuilder measured(block.measured);
    for (Eigen::Index i = 0; i < block.size(); ++i) {
      auto pose = measured.map().col(i);
      const Eigen::Vector3d back = -pose.tail<3>();
      pose.head<3>() =
          (-(RotationFromVector<double>(back) * pose.head<3>())).eval();
      pose.tail<3>() = back;
    }
    block.measured = measured.Freeze();
  }
  return inverse;
}

double ExtentOf(const Eigen::Matrix3Xd& points) {
  const Eigen::Vector3d mean = points.rowwise().mean();
  return std::sqrt((points.colwise() - mean).squaredNorm() /
                   static_cast<double>(points.cols()));
}

}  // namespace alidade::internal
