#include "src/kernel/observation_cost.h"

#include <ceres/autodiff_cost_function.h>
#include <ceres/dynamic_autodiff_cost_function.h>

#include <cmath>

#include "src/kernel/observation_residual.h"

namespace alidade::internal {
namespace {

constexpr int kNumJointBlocks = 5;
constexpr int kLargestRows = 6;

class WhitenedResidual {
 public:
  WhitenedResidual(const MeasurementModel& model, const Dataset& data,
                   const ObservationBlock& block, Eigen::Index i)
      : residual_(model, data, block, i),
        rows_(block.rows_each()),
        target_(block.target(i)) {
    whitener_ = Eigen::MatrixXd::Identity(rows_, rows_);
    Whiten(block, i, 1, whitener_);
    is_diagonal_ = block.whiteners.empty() || block.whiteners[i].size() == 0;
  }

  // Five blocks, or more with the frames.
  template <typename T>
  bool operator()(const T* const* blocks, T* residual) const {
    GeometryView<T> geometry{blocks[0], blocks[1], blocks[2], blocks[3],
                             blocks[4], nullptr,   nullptr,   target_};
    ReferenceView<T> references;
    if (num_blocks > kNumJointBlocks) {
      geometry.base = blocks[kNumJointBlocks];
      geometry.tool = blocks[kNumJointBlocks + 1];
    }
    if (num_blocks > kNumJointBlocks + 2) {
      references.first = blocks[kNumJointBlocks + 2];
      references.second = blocks[num_blocks - 1];
    }
    return Evaluate(geometry, references, residual);
  }

  int num_blocks = kNumJointBlocks;

 private:
  template <typename T>
  bool Evaluate(const GeometryView<T>& geometry,
                const ReferenceView<T>& references, T* residual) const {
    T raw[kLargestRows];
    residual_.Evaluate(geometry, references, raw);
    for (int row = 0; row < rows_; ++row) {
      residual[row] = raw[row] * whitener_(row, row);
      if (is_diagonal_) continue;
      for (int other = 0; other < rows_; ++other) {
        if (other == row) continue;
        residual[row] += raw[other] * whitener_(row, other);
      }
    }
    return true;
  }

  ObservationResidual residual_;
  int rows_;
  int target_;
  Eigen::MatrixXd whitener_;
  bool is_diagonal_ = true;
};

// A position over the joint blocks alone, what most calibrations are made of.
// Its own functor: compilers take the other kinds for every number of joints
// otherwise.
class WhitenedPosition {
 public:
  WhitenedPosition(const MeasurementModel& model, const Dataset& data,
                   const ObservationBlock& block, Eigen::Index i)
      : arm_(&model.nominal()),
        joint_values_(data.joint_values.col(block.pose(i)).data()),
        target_(block.target(i)),
        position_(block.measured.col(i)),
        whitener_(Eigen::Matrix3d::Identity()) {
    Eigen::MatrixXd whitener = whitener_;
    Whiten(block, i, 1, whitener);
    whitener_ = whitener;
    covariates_ = CovariatesAt(data, *arm_, block.pose(i));
    is_diagonal_ = block.whiteners.empty() || block.whiteners[i].size() == 0;
  }

  template <typename T>
  bool operator()(const T* beta, const T* alpha, const T* d, const T* theta,
                  const T* r, T* residual) const {
    const Vector3<T> predicted = TargetPosition<T>(
        *arm_, {beta, alpha, d, theta, r, nullptr, nullptr, target_},
        joint_values_, covariates_.data());
    const Vector3<T> error = predicted - position_.cast<T>();
    for (int row = 0; row < 3; ++row) {
      residual[row] = error[row] * whitener_(row, row);
      for (int other = 0; !is_diagonal_ && other < 3; ++other) {
        if (other == row) continue;
        residual[row] += error[other] * whitener_(row, other);
      }
    }
    return true;
  }

 private:
  const Arm* arm_;
  const double* joint_values_;
  Eigen::VectorXd covariates_;
  int target_;
  Eigen::Vector3d position_;
  Eigen::Matrix3d whitener_;
  bool is_diagonal_ = true;
};

template <int n>
std::unique_ptr<ceres::CostFunction> MakeStatic(const WhitenedPosition& cost) {
  return std::make_unique<
      ceres::AutoDiffCostFunction<WhitenedPosition, 3, n, n, n, n, n>>(
      new WhitenedPosition(cost));
}

std::unique_ptr<ceres::CostFunction> MakeDynamic(const WhitenedResidual& cost,
                                                 const ParameterLayout& layout,
                                                 const std::vector<int>& blocks,
                                                 int rows) {
  auto dynamic =
      std::make_unique<ceres::DynamicAutoDiffCostFunction<WhitenedResidual>>(
          new WhitenedResidual(cost));
  for (const int block : blocks) {
    dynamic->AddParameterBlock(layout.blocks()[block].size);
  }
  dynamic->SetNumResiduals(rows);
  return dynamic;
}

// Null for more joints than have a cost function of their own.
std::unique_ptr<ceres::CostFunction> MakePosition(const WhitenedPosition& cost,
                                                  int num_joints) {
  switch (num_joints) {
    case 1:
      return MakeStatic<1>(cost);
    case 2:
      return MakeStatic<2>(cost);
    case 3:
      return MakeStatic<3>(cost);
    case 4:
      return MakeStatic<4>(cost);
    case 5:
      return MakeStatic<5>(cost);
    case 6:
      return MakeStatic<6>(cost);
    case 7:
      return MakeStatic<7>(cost);
    default:
      return nullptr;
  }
}

int BlockOf(const ParameterLayout& layout, int column) {
  const std::vector<ParameterBlock>& blocks = layout.blocks();
  int index = 0;
  while (column >= blocks[index].first_column + blocks[index].size) ++index;
  return index;
}

}  // namespace

ObservationCost MakeObservationCost(const MeasurementModel& model,
                                    const Dataset& data,
                                    const ObservationBlock& block,
                                    Eigen::Index i, bool with_frames) {
  const ParameterLayout& layout = model.layout();
  const int reference =
      ObservationResidual(model, data, block, i).FirstReferenceColumn();
  ObservationCost cost;
  cost.blocks = {0, 1, 2, 3, 4};
  if (with_frames || reference >= 0) {
    cost.blocks.push_back(
        BlockOf(layout, layout.Column(ParameterKind::kBaseTranslation, 0)));
    cost.blocks.push_back(BlockOf(
        layout,
        layout.Column(ParameterKind::kToolTranslation, 0, block.target(i))));
  }
  if (reference >= 0) cost.blocks.push_back(BlockOf(layout, reference));
  if (block.kind == MeasurementKind::kPointDistance) {
    cost.blocks.push_back(BlockOf(
        layout, layout.Column(ParameterKind::kPoint, 0, block.seconds[i])));
  }
  const bool is_plain = block.kind == MeasurementKind::kPosition &&
                        cost.blocks.size() == kNumJointBlocks;
  if (is_plain) {
    cost.function = MakePosition(WhitenedPosition(model, data, block, i),
                                 layout.num_joints());
  }
  if (cost.function == nullptr) {
    WhitenedResidual residual(model, data, block, i);
    residual.num_blocks = static_cast<int>(cost.blocks.size());
    cost.function =
        MakeDynamic(residual, layout, cost.blocks, block.rows_each());
  }
  return cost;
}

}  // namespace alidade::internal
