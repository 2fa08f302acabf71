#include "src/calibration/plausibility.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "alidade/units.h"
#include "src/common/bytes.h"
#include "src/common/format.h"
#include "src/initialization/frame_start.h"
#include "src/kernel/partition.h"
#include "src/model/chain_axes.h"

namespace alidade::internal {
namespace {

constexpr Eigen::Index kFewest = 12;
constexpr Eigen::Index kEnough = 60;
constexpr double kTolerated = 0.02;  // of the reach
constexpr double kClearlyBetter = 4.0;
// A misfit of a larger part of how far the positions lie apart explains
// nothing: an arm that hardly moves fits to any small cloud.
constexpr double kExplains = 0.2;

// Joint values and the positions measured there, one by one.
struct Pairs {
  Eigen::MatrixXd joint_values;
  Eigen::Matrix3Xd points;
};

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
    Collect(holders, data);
  }

  Eigen::Index count() const { return count_; }
  bool are_finite() const { return are_finite_; }

  // What is looked at, each measurement with the joint values `shift` rows
  // before its own.
  Pairs Paired(int shift) const {
    const Eigen::Index rows = count_ - std::abs(shift);
    const Eigen::Index taken = std::min(kEnough, rows);
    Pairs pairs{Eigen::MatrixXd(joints_.rows(), taken),
                Eigen::Matrix3Xd(3, taken)};
    for (Eigen::Index k = 0; k < taken; ++k) {
      const Eigen::Index i = Thinned(k, taken, rows);
      pairs.joint_values.col(k) = joints_.col(IndexOf(i + (shift < 0)));
      pairs.points.col(k) = points_.col(IndexOf(i + (shift > 0)));
    }
    return pairs;
  }

 private:
  // The observations of a block that are looked at. Where these are all, as in
  // nearly all large blocks, they are not listed.
  class Members {
   public:
    explicit Members(const ObservationBlock& block) {
      for (Eigen::Index i = 0; i < block.size(); ++i) {
        if (IsMember(block, i)) ++size_;
      }
      if (size_ == block.size()) return;
      list_.reserve(static_cast<std::size_t>(size_));
      for (Eigen::Index i = 0; i < block.size(); ++i) {
        if (IsMember(block, i)) list_.push_back(i);
      }
    }
    Eigen::Index size() const { return size_; }
    Eigen::Index operator[](Eigen::Index k) const {
      return list_.empty() ? k : list_[static_cast<std::size_t>(k)];
    }

   private:
    static bool IsMember(const ObservationBlock& block, Eigen::Index i) {
      return HoldsPosition(block.kind) && block.target(i) == 0 &&
             block.sigmas.col(i).head<3>().allFinite();
    }

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

  std::vector<Eigen::Index> Wanted() const {
    std::vector<Eigen::Index> wanted;
    for (const Eigen::Index rows : {count_, count_ - 1}) {
      const Eigen::Index taken = std::min(kEnough, rows);
      for (Eigen::Index k = 0; k < taken; ++k) {
        const Eigen::Index i = Thinned(k, taken, rows);
        wanted.push_back(i);
        if (i + 1 < count_) wanted.push_back(i + 1);
      }
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
  std::vector<Eigen::Index> wanted_;  // numbers, in ascending order
  Eigen::MatrixXd joints_;            // a column for each of them
  Eigen::Matrix3Xd points_;
};

// Median misfit of the nominal arm with any base and tool (m).
double Misfit(const Arm& arm, const Pairs& pairs) {
  Arm in_base = arm;
  in_base.instrument_from_base.setIdentity();
  std::vector<Eigen::Isometry3d> frames;
  ChainAxes axes;
  for (Eigen::Index i = 0; i < pairs.points.cols(); ++i) {
    ComputeChainAxes(in_base, pairs.joint_values.col(i).data(), &axes);
    frames.push_back(axes.instrument_from_last);
  }
  const std::optional<PositionStart> start = StartFromPositions(
      frames, pairs.points, std::vector<int>(frames.size(), 0), 1);
  return start ? start->misfit.median : std::numeric_limits<double>::infinity();
}

// Whether half of the positions are within `tolerated` with the target as the
// arm states it and a base that fits all of them best: one way to place the
// arm, found at a fraction of the cost of the best one.
bool FitsAsStated(const Arm& arm, const Pairs& pairs, double tolerated) {
  Arm in_base = arm;
  in_base.instrument_from_base.setIdentity();
  Eigen::Matrix3Xd targets(3, pairs.points.cols());
  ChainAxes axes;
  for (Eigen::Index i = 0; i < targets.cols(); ++i) {
    ComputeChainAxes(in_base, pairs.joint_values.col(i).data(), &axes);
    targets.col(i) = axes.instrument_from_target.translation();
  }
  const std::optional<RigidFit> fit = FitRigid(targets, pairs.points);
  if (!fit) return false;
  Eigen::VectorXd misfits =
      (fit->b_from_a * targets - pairs.points).colwise().norm();
  if (!misfits.allFinite()) return false;
  double* const middle = misfits.data() + misfits.size() / 2;
  std::nth_element(misfits.data(), middle, misfits.data() + misfits.size());
  return *middle <= tolerated;
}

// How far the positions lie apart: the root mean square about their mean (m).
double Extent(const Eigen::Matrix3Xd& points) {
  const Eigen::Vector3d mean = points.rowwise().mean();
  return std::sqrt((points.colwise() - mean).squaredNorm() /
                   static_cast<double>(points.cols()));
}

struct InputMistake {
  std::string text;  // what the user should do
  std::function<void(Pairs*)> mend;
  int shift = 0;  // of Positions::Paired
};

std::string JointName(int j) { return "q" + std::to_string(j + 1); }

void ScaleAngles(const Arm& arm, double factor, Pairs* pairs) {
  for (int j = 0; j < arm.num_joints(); ++j) {
    if (arm.joints[j].type != JointType::kRevolute) continue;
    pairs->joint_values.row(j) *= factor;
  }
}

std::vector<InputMistake> UnitMistakes(const Arm& arm) {
  return {
      {"the joint angles are in degrees but read as radians: state the "
       "unit deg",
       [&arm](Pairs* pairs) { ScaleAngles(arm, kDegree, pairs); }},
      {"the joint angles are in radians but read as degrees: state the "
       "unit rad",
       [&arm](Pairs* pairs) { ScaleAngles(arm, 1.0 / kDegree, pairs); }},
      {"the positions are in mm but read as m: state the unit mm",
       [](Pairs* pairs) { pairs->points *= kMillimetre; }},
      {"the positions are in m but read as mm: state the unit m",
       [](Pairs* pairs) { pairs->points /= kMillimetre; }},
      {"the positions are ten times too small, as cm read as mm: state their "
       "unit",
       [](Pairs* pairs) { pairs->points *= 10.0; }},
      {"the positions are ten times too large, as mm read as cm: state their "
       "unit",
       [](Pairs* pairs) { pairs->points /= 10.0; }},
      {"the positions are in inches but read as mm: multiply them by 25.4",
       [](Pairs* pairs) { pairs->points *= 25.4; }},
      {"two of the columns x, y and z are swapped, or one of them has the "
       "wrong sign: they make a mirror image",
       [](Pairs* pairs) { pairs->points.row(0).swap(pairs->points.row(1)); }},
      {"the measurements are one row late: row k holds what was measured "
       "at the joint values of row k - 1",
       [](Pairs*) {}, 1},
      {"the measurements are one row early: row k holds what was measured "
       "at the joint values of row k + 1",
       [](Pairs*) {}, -1}};
}

std::vector<InputMistake> JointMistakes(const Arm& arm) {
  std::vector<InputMistake> mistakes;
  for (int j = 0; j < arm.num_joints(); ++j) {
    mistakes.push_back(
        {"joint " + std::to_string(j + 1) +
             " counts the other way: give it `sign: -1` in the arm "
             "file",
         [j](Pairs* pairs) { pairs->joint_values.row(j) *= -1.0; }});
    if (arm.joints[j].type == JointType::kRevolute) {
      for (const int turn : {90, -90, 180}) {
        mistakes.push_back({"the zero of joint " + std::to_string(j + 1) +
                                " is elsewhere: add " + std::to_string(turn) +
                                " deg to its theta in the arm file",
                            [j, turn](Pairs* pairs) {
                              pairs->joint_values.row(j).array() +=
                                  turn * kDegree;
                            }});
      }
    }
    for (int k = j + 1; k < arm.num_joints(); ++k) {
      mistakes.push_back({"the columns " + JointName(j) + " and " +
                              JointName(k) + " are swapped",
                          [j, k](Pairs* pairs) {
                            pairs->joint_values.row(j).swap(
                                pairs->joint_values.row(k));
                          }});
    }
  }
  return mistakes;
}

}  // namespace

InputDiagnosis DiagnoseInput(const Arm& arm, const Dataset& data,
                             Communicator* communicator) {
  const Positions positions(HoldersOf(communicator, data), data);
  if (positions.count() < kFewest || !positions.are_finite()) return {};
  Arm at_origin = arm;
  at_origin.instrument_from_base.setIdentity();
  const double tolerated = kTolerated * Reach(at_origin);
  const Pairs as_read = positions.Paired(0);
  if (FitsAsStated(arm, as_read, tolerated)) return {};
  const double misfit = Misfit(arm, as_read);
  if (!(misfit > tolerated) || !std::isfinite(misfit)) return {};
  std::vector<InputMistake> mistakes = UnitMistakes(arm);
  for (InputMistake& mistake : JointMistakes(arm)) {
    mistakes.push_back(std::move(mistake));
  }
  const InputMistake* best = nullptr;
  double best_misfit = std::min(tolerated, misfit / kClearlyBetter);
  for (const InputMistake& mistake : mistakes) {
    Pairs mended = positions.Paired(mistake.shift);
    mistake.mend(&mended);
    const double mended_misfit = Misfit(arm, mended);
    if (mended_misfit >= best_misfit ||
        mended_misfit > kExplains * Extent(mended.points)) {
      continue;
    }
    best = &mistake;
    best_misfit = mended_misfit;
  }
  Finding finding{"plausibility.position_misfit", misfit, tolerated, "",
                  FindingLevel::kAttention};
  finding.sentence =
      "the measured positions do not fit this arm wherever its base and tool "
      "are: half of them are more than " +
      FormatLength(misfit, 3) + " off";
  finding.sentence +=
      best == nullptr
          ? ". No single mistake of units, columns or signs explains it: check "
            "whether the arm file describes the arm that was measured"
          : ". They fit to " + FormatLength(best_misfit, 3) + " if " +
                best->text;
  return {finding, best != nullptr};
}

std::optional<Finding> DiagnoseZeros(const Dataset& data,
                                     Communicator* communicator) {
  std::string first;
  std::int64_t count = 0;
  for (const ObservationBlock& block : data.blocks) {
    if (!HoldsPosition(block.kind)) continue;
    for (Eigen::Index i = 0; i < block.size(); ++i) {
      const auto sigmas = block.sigmas.col(i).head<3>();
      const auto position = block.measured.col(i).head<3>();
      if (!(position.array() == 0.0).all() || !sigmas.allFinite()) continue;
      if (++count == 1) first = SourceOf(data, block.pose(i));
    }
  }
  count = SumOverRanks(communicator, data, count);
  if (count == 0) return std::nullopt;
  return Finding{
      "plausibility.zero_positions", static_cast<double>(count), 0.0,
      (first.empty() ? "" : first + ": ") + std::to_string(count) +
          (count == 1 ? " position is" : " positions are") +
          " exactly 0, 0, 0, which instruments write when they have lost the "
          "target: empty these cells or leave the rows out",
      FindingLevel::kAttention};
}

}  // namespace alidade::internal
