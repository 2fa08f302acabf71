#include "src/uncertainty/prediction.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "alidade/forward_kinematics.h"
#include "alidade/rotation.h"
#include "src/common/constants.h"
#include "src/common/distributions.h"
#include "src/common/parallel.h"
#include "src/kernel/measurement_model.h"
#include "src/kernel/partition.h"
#include "src/model/joint_draw.h"
#include "src/uncertainty/row_spread.h"

namespace alidade::internal {
namespace {

// The target's own pose as if it had been measured: residuals of zero, at which
// the derivative of a rotation's logarithm is the identity.
Dataset PosesOf(const MeasurementModel& model, const Eigen::VectorXd& values,
                const Eigen::MatrixXd& joint_values, int target) {
  Dataset data;
  data.joint_values = joint_values;
  ObservationBlock block;
  block.kind = MeasurementKind::kPose;
  const Eigen::Index n = joint_values.cols();
  block.targets.assign(n, target);
  Eigen::MatrixXd measured(6, n);
  block.sigmas = Eigen::MatrixXd::Ones(6, n);
  const GeometryView<double> geometry =
      ViewOf(model.layout(), values.data(), target);
  for (Eigen::Index i = 0; i < n; ++i) {
    Eigen::Matrix3d rotation;
    measured.col(i).head<3>() = TargetPose<double>(
        model.nominal(), geometry, joint_values.col(i).data(), &rotation);
    measured.col(i).tail<3>() = VectorFromRotation(rotation);
  }
  block.measured = std::move(measured);
  data.blocks.push_back(std::move(block));
  return data;
}

Eigen::Matrix3d Unknown() {
  return Eigen::Vector3d::Constant(kInfinity).asDiagonal();
}

// Poses whose Jacobians are in memory at once, and of those that are multiplied
// with the root at once.
constexpr Eigen::Index kPosesAtOnce = 4096;
constexpr Eigen::Index kPosesPerProduct = 64;

void PredictWithTerms(const MeasurementModel& model,
                      const Eigen::VectorXd& values,
                      const ParameterCovariance& covariance,
                      const Dataset& poses, PoseCovariance* predicted) {
  const RowSpread spreads(model, values, covariance, poses);
  ParallelFor(model.num_threads(), poses.num_poses(), kPosesPerProduct,
              [&](std::int64_t begin, std::int64_t end) {
                for (std::int64_t k = begin; k < end; ++k) {
                  const Eigen::MatrixXd spread =
                      spreads.Of(k, Eigen::MatrixXd());
                  const auto of = [&](int half, double excess) {
                    const auto s = spread.middleRows(half, 3);
                    Eigen::Matrix3d variance = s * s.transpose();
                    variance.diagonal().array() += excess;
                    return variance;
                  };
                  predicted[k] = {of(0, covariance.excess.length),
                                  of(3, covariance.excess.rotation)};
                }
              });
}

// The covariances of `poses`, of which there are kPosesAtOnce at most.
void PredictSome(const MeasurementModel& model, const Eigen::VectorXd& values,
                 const ParameterCovariance& covariance, const Dataset& poses,
                 PoseCovariance* predicted) {
  const auto p = static_cast<Eigen::Index>(covariance.size());
  if (covariance.terms) {
    PredictWithTerms(model, values, covariance, poses, predicted);
    return;
  }
  Eigen::MatrixXd jacobians(p, 6 * poses.num_poses());
  ForEachObservation(
      model, values, poses, covariance.columns,
      [&](int, Eigen::Index i, const Eigen::Ref<const Eigen::MatrixXd>& rows) {
        jacobians.middleCols(6 * i, 6) = rows.leftCols(p).transpose();
      });
  const auto work = [&](std::int64_t begin, std::int64_t end) {
    const auto some = jacobians.middleCols(6 * begin, 6 * (end - begin));
    const Eigen::MatrixXd spread = covariance.root.transpose() * some;
    for (std::int64_t k = begin; k < end; ++k) {
      for (const int half : {0, 3}) {
        // S = root^T J^T has S^T S = J C J^T.
        const Eigen::Index first = 6 * (k - begin) + half;
        const auto s = spread.middleCols(first, 3);
        const bool is_told =
            covariance.AreTold(some.middleCols(first, 3).transpose());
        Eigen::Matrix3d& variance =
            half == 0 ? predicted[k].position : predicted[k].rotation;
        variance =
            is_told ? Eigen::Matrix3d(s.transpose().lazyProduct(s)) : Unknown();
        variance.diagonal().array() +=
            half == 0 ? covariance.excess.length : covariance.excess.rotation;
      }
    }
  };
  ParallelFor(model.num_threads(), poses.num_poses(), kPosesPerProduct, work);
}

}  // namespace

std::vector<PoseCovariance> PredictCovariances(
    const MeasurementModel& model, const Eigen::VectorXd& values,
    const ParameterCovariance& covariance, const Eigen::MatrixXd& joint_values,
    int target) {
  std::vector<PoseCovariance> predicted(
      joint_values.cols(), {Eigen::Matrix3d::Zero(), Eigen::Matrix3d::Zero()});
  if (covariance.size() == 0) return predicted;
  for (Eigen::Index begin = 0; begin < joint_values.cols();
       begin += kPosesAtOnce) {
    const Eigen::Index count =
        std::min(kPosesAtOnce, joint_values.cols() - begin);
    const Dataset poses =
        PosesOf(model, values, joint_values.middleCols(begin, count), target);
    PredictSome(model, values, covariance, poses, &predicted[begin]);
  }
  return predicted;
}

Eigen::Vector3d SemiAxes(const Eigen::Matrix3d& covariance) {
  if (!covariance.allFinite()) return Eigen::Vector3d::Constant(kInfinity);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(
      covariance, Eigen::EigenvaluesOnly);
  return solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().reverse();
}

PredictedMap MapPrediction(const MeasurementModel& model,
                           const Eigen::VectorXd& values,
                           const ParameterCovariance& covariance, int count,
                           std::uint64_t seed,
                           const Eigen::VectorXd& true_values) {
  PredictedMap map;
  map.joint_values = DrawJointValues(model.nominal(), count, seed);
  map.positions = model.Predict(values, map.joint_values);
  const std::vector<PoseCovariance> predicted =
      PredictCovariances(model, values, covariance, map.joint_values);
  map.position_std.resize(count);
  map.rotation_std.resize(count);
  map.semi_axes.resize(3, count);
  for (int i = 0; i < count; ++i) {
    map.position_std[i] = std::sqrt(predicted[i].position.trace());
    map.rotation_std[i] = std::sqrt(predicted[i].rotation.trace());
    map.semi_axes.col(i) = SemiAxes(predicted[i].position);
  }
  map.summary = SummarizeErrors(map.position_std);
  const double lacking = 3.0 * covariance.excess.length;
  map.parts.from_model = std::sqrt(lacking);
  map.parts.from_parameters =
      std::sqrt(std::max(0.0, map.summary.rms * map.summary.rms - lacking));
  map.parts.from_measurement = std::sqrt(3.0) * covariance.excess.noise;
  map.rotation_summary = SummarizeErrors(map.rotation_std);
  if (true_values.size() > 0) {
    map.true_error =
        (model.Predict(true_values, map.joint_values) - map.positions)
            .colwise()
            .norm();
    map.true_summary = SummarizeErrors(map.true_error);
  }
  return map;
}

}  // namespace alidade::internal
