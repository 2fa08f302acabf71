#include "src/identifiability/generic_data.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "alidade/forward_kinematics.h"
#include "src/common/bytes.h"
#include "src/kernel/holdout.h"
#include "src/kernel/partition.h"
#include "src/model/joint_draw.h"

namespace alidade::internal {
namespace {

// What is measured at a pose: target, reference and the axes, as bits.
using Pattern = std::tuple<int, int, unsigned>;

unsigned MeasuredAxes(const ObservationBlock& block, Eigen::Index i) {
  unsigned axes = 0;
  for (int row = 0; row < block.rows_each(); ++row) {
    if (std::isfinite(block.sigmas(row, i))) axes |= 1U << row;
  }
  return axes;
}

Pattern PatternOf(const ObservationBlock& block, Eigen::Index i) {
  const int reference = block.references.empty() ? 0 : block.references[i];
  return {block.target(i), reference, MeasuredAxes(block, i)};
}

// The observations of each pattern.
std::map<Pattern, std::vector<Eigen::Index>> ByPattern(
    const ObservationBlock& block) {
  std::map<Pattern, std::vector<Eigen::Index>> observations;
  for (Eigen::Index i = 0; i < block.size(); ++i) {
    observations[PatternOf(block, i)].push_back(i);
  }
  return observations;
}

// How many observations of each pattern the global data set has, and how many
// of them other ranks have before this one's.
struct PatternCount {
  Eigen::Index before = 0;
  Eigen::Index all = 0;
};

std::map<Pattern, PatternCount> CountPatterns(
    Communicator* holders,
    const std::map<Pattern, std::vector<Eigen::Index>>& mine) {
  std::map<Pattern, PatternCount> counts;
  ByteWriter writer;
  for (const auto& [pattern, list] : mine) {
    const auto& [target, reference, axes] = pattern;
    writer.Put(target);
    writer.Put(reference);
    writer.Put(axes);
    writer.Put(static_cast<std::int64_t>(list.size()));
  }
  int rank = 0;
  for (const std::string& bytes : holders->Gather(writer.Take())) {
    const bool is_before = rank++ < holders->rank();
    ByteReader reader(bytes);
    while (!reader.is_at_end()) {
      const int target = reader.Get<int>();
      const int reference = reader.Get<int>();
      const auto axes = reader.Get<unsigned>();
      const auto size = reader.Get<std::int64_t>();
      PatternCount& count = counts[{target, reference, axes}];
      count.all += size;
      if (is_before) count.before += size;
    }
  }
  return counts;
}

// About `count` observations of a block, evenly spaced among those of each
// pattern, so that rare ones keep their say: those that are here.
std::vector<Eigen::Index> EvenlySpaced(Communicator* holders,
                                       const ObservationBlock& block,
                                       Eigen::Index count) {
  constexpr Eigen::Index kFewestOfEach = 32;
  const std::map<Pattern, std::vector<Eigen::Index>> mine = ByPattern(block);
  const std::map<Pattern, PatternCount> patterns = CountPatterns(holders, mine);
  const Eigen::Index of_each =
      std::max(kFewestOfEach,
               count / std::max<Eigen::Index>(
                           1, static_cast<Eigen::Index>(patterns.size())));
  std::vector<Eigen::Index> chosen;
  for (const auto& [pattern, list] : mine) {
    const auto& [before, size] = patterns.at(pattern);
    const auto end = before + static_cast<Eigen::Index>(list.size());
    const Eigen::Index taken = std::min(of_each, size);
    for (Eigen::Index k = 0; k < taken; ++k) {
      const Eigen::Index i = k * size / taken;
      if (i >= before && i < end) chosen.push_back(list[i - before]);
    }
  }
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

// Every pattern at every pose.
ObservationBlock Repeat(const ObservationBlock& block, int num_poses) {
  const std::map<Pattern, std::vector<Eigen::Index>> patterns =
      ByPattern(block);
  const auto count = static_cast<Eigen::Index>(patterns.size()) * num_poses;
  ObservationBlock repeated;
  repeated.kind = block.kind;
  repeated.measured = Eigen::MatrixXd::Zero(block.rows_each(), count);
  MatrixBuilder sigmas(Eigen::MatrixXd::Ones(block.rows_each(), count));
  for (const auto& [pattern, observations] : patterns) {
    const auto& [target, reference, axes] = pattern;
    for (int pose = 0; pose < num_poses; ++pose) {
      const auto i = static_cast<Eigen::Index>(repeated.poses.size());
      repeated.poses.push_back(pose);
      repeated.targets.push_back(target);
      if (!block.references.empty()) repeated.references.push_back(reference);
      if (block.kind == MeasurementKind::kDifference) {
        repeated.seconds.push_back((pose + 1) % num_poses);
      }
      for (int row = 0; row < block.rows_each(); ++row) {
        if ((axes >> static_cast<unsigned>(row) & 1U) != 0U) continue;
        sigmas.map()(row, i) = std::numeric_limits<double>::infinity();
      }
    }
  }
  repeated.sigmas = sigmas.Freeze();
  return repeated;
}

// Orientations as the nominal arm has them.
void MeasureOrientations(const MeasurementModel& model, Dataset* data) {
  const Eigen::VectorXd values = model.NominalValues();
  for (ObservationBlock& block : data->blocks) {
    if (block.kind != MeasurementKind::kPose) continue;
    MatrixBuilder measured(block.measured);
    for (Eigen::Index i = 0; i < block.size(); ++i) {
      Eigen::Matrix3d rotation;
      TargetPose<double>(model.nominal(),
                         ViewOf(model.layout(), values.data(), block.target(i)),
                         data->joint_values.col(block.pose(i)).data(),
                         &rotation);
      measured.map().col(i).tail<3>() = VectorFromRotation(rotation);
    }
    block.measured = measured.Freeze();
  }
}

}  // namespace

Dataset MakeGenericData(const MeasurementModel& model, const Dataset& data,
                        int num_poses, std::uint64_t seed) {
  // A subset has every combination that its data set has.
  if (data.partition) {
    return MakeGenericData(model, EvenSubset(model.communicator(), data, 1),
                           num_poses, seed);
  }
  Dataset generic;
  generic.joint_values = DrawJointValues(model.nominal(), num_poses, seed);
  for (const ObservationBlock& block : data.blocks) {
    generic.blocks.push_back(block.kind == MeasurementKind::kPointDistance
                                 ? block
                                 : Repeat(block, num_poses));
  }
  generic = WithUnitSigmas(model, std::move(generic));
  MeasureOrientations(model, &generic);
  return generic;
}

Dataset WithUnitSigmas(const MeasurementModel& model, Dataset data) {
  const double angle = 1.0 / ArmReach(model.nominal());
  for (ObservationBlock& block : data.blocks) {
    block.whiteners.clear();
    MatrixBuilder sigmas(block.sigmas);
    for (Eigen::Index i = 0; i < block.size(); ++i) {
      for (int row = 0; row < block.rows_each(); ++row) {
        double& sigma = sigmas.map()(row, i);
        if (std::isfinite(sigma)) sigma = row < 3 ? 1.0 : angle;
      }
    }
    block.sigmas = sigmas.Freeze();
  }
  return data;
}

Dataset EvenSubset(Communicator* communicator, const Dataset& data,
                   Eigen::Index count) {
  if (data.global_poses() <= count) {
    return GatherData(communicator, data, data);
  }
  Dataset subset;
  subset.name = data.name;
  subset.files = data.files;
  subset.joint_values = data.joint_values;
  subset.covariate_names = data.covariate_names;
  subset.covariates = data.covariates;
  subset.sources = data.sources;
  std::vector<bool> is_needed(data.num_poses(), false);
  for (const ObservationBlock& block : data.blocks) {
    if (block.kind == MeasurementKind::kPointDistance) {
      subset.blocks.push_back(block);
      continue;
    }
    subset.blocks.push_back(TakeObservations(
        block, EvenlySpaced(HoldersOf(communicator, data), block, count)));
    const ObservationBlock& taken = subset.blocks.back();
    for (Eigen::Index i = 0; i < taken.size(); ++i) {
      is_needed[taken.pose(i)] = true;
      if (block.kind != MeasurementKind::kDifference) continue;
      is_needed[taken.seconds[i]] = true;
    }
  }
  std::vector<Eigen::Index> poses;
  for (std::size_t pose = 0; pose < is_needed.size(); ++pose) {
    if (is_needed[pose]) poses.push_back(static_cast<Eigen::Index>(pose));
  }
  return GatherData(communicator, data, SelectPoses(subset, poses));
}

}  // namespace alidade::internal
