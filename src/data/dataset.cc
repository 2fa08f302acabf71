#include "alidade/dataset.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

namespace alidade {

void PoseSources::push_back(const PoseSource& source) { Append(source, 1); }

void PoseSources::Append(const PoseSource& first, std::size_t count) {
  if (count == 0) return;
  bool continues = false;
  if (!runs_.empty()) {
    const Run& last = runs_.back();
    const auto next =
        last.source.line + static_cast<int>(size_ - last.first_pose);
    continues = last.source.file == first.file && next == first.line;
  }
  if (!continues) runs_.push_back({size_, first});
  size_ += count;
}

void PoseSources::Append(const PoseSources& others, int first_file) {
  for (std::size_t k = 0; k < others.runs_.size(); ++k) {
    const Run& run = others.runs_[k];
    const std::size_t end = k + 1 < others.runs_.size()
                                ? others.runs_[k + 1].first_pose
                                : others.size_;
    Append({run.source.file + first_file, run.source.line},
           end - run.first_pose);
  }
}

void PoseSources::MoveLines(int difference) {
  for (Run& run : runs_) run.source.line += difference;
}

PoseSource PoseSources::operator[](std::size_t pose) const {
  const auto after = std::upper_bound(
      runs_.begin(), runs_.end(), pose,
      [](std::size_t p, const Run& run) { return p < run.first_pose; });
  const Run& run = *(after - 1);
  return {run.source.file,
          run.source.line + static_cast<int>(pose - run.first_pose)};
}

}  // namespace alidade

namespace alidade {

bool HoldsPosition(MeasurementKind kind) {
  return kind == MeasurementKind::kPosition || kind == MeasurementKind::kPose;
}

bool HasReference(MeasurementKind kind) {
  return kind == MeasurementKind::kDistance ||
         kind == MeasurementKind::kFixedPoint ||
         kind == MeasurementKind::kPlane ||
         kind == MeasurementKind::kPointDistance;
}

bool HasSecond(MeasurementKind kind) {
  return kind == MeasurementKind::kDifference ||
         kind == MeasurementKind::kPointDistance;
}

int RowsOf(MeasurementKind kind) {
  switch (kind) {
    case MeasurementKind::kPosition:
    case MeasurementKind::kFixedPoint:
    case MeasurementKind::kDifference:
      return 3;
    case MeasurementKind::kPose:
      return 6;
    case MeasurementKind::kDistance:
    case MeasurementKind::kPlane:
    case MeasurementKind::kPointDistance:
      return 1;
  }
  return 0;
}

const char* NameOf(MeasurementKind kind) {
  switch (kind) {
    case MeasurementKind::kPosition:
      return "position";
    case MeasurementKind::kPose:
      return "pose";
    case MeasurementKind::kDistance:
      return "distance";
    case MeasurementKind::kFixedPoint:
      return "fixed point";
    case MeasurementKind::kPlane:
      return "plane";
    case MeasurementKind::kDifference:
      return "difference";
    case MeasurementKind::kPointDistance:
      return "point distance";
  }
  return "";
}

int ObservationBlock::Dimension(Eigen::Index i) const {
  return static_cast<int>(sigmas.col(i).array().isFinite().count());
}

Eigen::Index Dataset::num_observations() const {
  Eigen::Index count = 0;
  for (const ObservationBlock& block : blocks) count += block.size();
  return count;
}

Eigen::Index Dataset::num_rows() const {
  Eigen::Index count = 0;
  for (const ObservationBlock& block : blocks) count += block.measured.size();
  return count;
}

Eigen::Index Dataset::num_equations() const {
  Eigen::Index count = 0;
  for (const ObservationBlock& block : blocks) {
    count += block.sigmas.map().array().isFinite().count();
  }
  return count;
}

bool Dataset::Has(MeasurementKind kind) const {
  for (std::size_t block = 0; block < blocks.size(); ++block) {
    if (blocks[block].kind == kind && global_observations(block) > 0) {
      return true;
    }
  }
  return false;
}

Eigen::Index Dataset::global_poses() const {
  return partition ? partition->global_poses : num_poses();
}

Eigen::Index Dataset::global_observations(std::size_t block) const {
  return partition ? partition->global_observations[block]
                   : blocks[block].size();
}

Eigen::Index Dataset::global_observations() const {
  Eigen::Index count = 0;
  for (std::size_t block = 0; block < blocks.size(); ++block) {
    count += global_observations(block);
  }
  return count;
}

std::pair<Eigen::Index, Eigen::Index> Dataset::ShardRange(
    std::size_t shard, std::size_t block) const {
  const Eigen::Index end = blocks[block].size();
  if (shards.empty()) return {0, end};
  const bool is_last = shard + 1 == shards.size();
  return {shards[shard].first_observations[block],
          is_last ? end : shards[shard + 1].first_observations[block]};
}

ObservationBlock& Dataset::PositionBlock() {
  if (blocks.empty()) blocks.emplace_back();
  CHECK(blocks.size() == 1 && blocks[0].kind == MeasurementKind::kPosition)
      << "not a data set of positions alone";
  return blocks[0];
}

Eigen::VectorXd CovariatesAt(const Dataset& data, const Arm& arm, int pose) {
  const std::vector<CovariateEffect>& effects = arm.errors.covariates;
  Eigen::VectorXd values(static_cast<Eigen::Index>(effects.size()));
  for (Eigen::Index k = 0; k < values.size(); ++k) {
    const CovariateEffect& effect = effects[static_cast<std::size_t>(k)];
    const auto found = std::find(data.covariate_names.begin(),
                                 data.covariate_names.end(), effect.name);
    values[k] =
        found == data.covariate_names.end()
            ? effect.reference
            : data.covariates(found - data.covariate_names.begin(), pose);
  }
  return values;
}

std::string SourceOf(const Dataset& data, int pose) {
  if (data.sources.empty()) return "";
  const PoseSource source = data.sources[pose];
  return data.files[source.file] + ":" + std::to_string(source.line);
}

bool HaveOneSigma(const ObservationBlock& block, Eigen::Index first,
                  Eigen::Index count) {
  if (count < 2) return true;
  const SharedMatrix& sigmas = block.sigmas;
  const auto bytes = [&](Eigen::Index columns) {
    return sizeof(double) * static_cast<std::size_t>(columns * sigmas.rows());
  };
  const double* const begin = sigmas.col(first).data();
  if (sigmas.stride() == sigmas.rows()) {
    // Each column is the one before it.
    return std::memcmp(begin, sigmas.col(first + 1).data(), bytes(count - 1)) ==
           0;
  }
  for (Eigen::Index i = 1; i < count; ++i) {
    if (std::memcmp(begin, sigmas.col(first + i).data(), bytes(1)) != 0) {
      return false;
    }
  }
  return true;
}

Dataset MakePositions(SharedMatrix joint_values, SharedMatrix points,
                      SharedMatrix sigmas) {
  Dataset data;
  data.joint_values = std::move(joint_values);
  data.positions() = std::move(points);
  data.sigmas() = std::move(sigmas);
  return data;
}

Dataset MakePositions(SharedMatrix joint_values, SharedMatrix points,
                      double sigma) {
  SharedMatrix sigmas = SharedMatrix::Repeated(Eigen::Vector3d::Constant(sigma),
                                               joint_values.cols());
  return MakePositions(std::move(joint_values), std::move(points),
                       std::move(sigmas));
}

void DropTrivialPoses(Eigen::Index num_poses, ObservationBlock* block) {
  std::vector<int>& poses = block->poses;
  bool counts = static_cast<Eigen::Index>(poses.size()) == num_poses;
  for (std::size_t i = 0; counts && i < poses.size(); ++i) {
    counts = poses[i] == static_cast<int>(i);
  }
  if (counts || block->kind == MeasurementKind::kPointDistance) poses.clear();
}

void Whiten(const ObservationBlock& block, Eigen::Index first,
            Eigen::Index count, Eigen::Ref<Eigen::MatrixXd> rows) {
  const int height = block.rows_each();
  for (Eigen::Index i = 0; i < count; ++i) {
    auto mine = rows.middleRows(i * height, height);
    const Eigen::Index k = first + i;
    if (!block.whiteners.empty() && block.whiteners[k].size() > 0) {
      mine = (block.whiteners[k] * mine).eval();
      continue;
    }
    mine.array().colwise() /= block.sigmas.col(k).array();
  }
}

}  // namespace alidade
