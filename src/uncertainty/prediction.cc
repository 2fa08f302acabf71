#include "alidade/uncertainty/prediction.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "alidade/base/distributions.h"
#include "alidade/base/parallel.h"
#include "alidade/measurement/observation_rows.h"
#include "alidade/measurement/share.h"
#include "alidade/model/forward_kinematics.h"
#include "alidade/model/joint_draw.h"
#include "alidade/model/rotation.h"

namespace alidade {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Rounding leaves so much of a direction that rows do not see.
constexpr double kNotSeen = 1e-6;

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
  block.measured.resize(6, n);
  block.sigmas = Eigen::MatrixXd::Ones(6, n);
  const GeometryView<double> geometry =
      ViewOf(model.layout(), values.data(), target);
  for (Eigen::Index i = 0; i < n; ++i) {
    Eigen::Matrix3d rotation;
    block.measured.col(i).head<3>() = TargetPose<double>(
        model.nominal(), geometry, joint_values.col(i).data(), &rotation);
    block.measured.col(i).tail<3>() = VectorFromRotation(rotation);
  }
  data.blocks.push_back(std::move(block));
  return data;
}

// Rows of the Jacobian times the root, and whether they see what is not told.
struct SpreadRows {
  Eigen::MatrixXd rows;
  bool is_told = true;
};

SpreadRows Spread(const ParameterCovariance& covariance,
                  const Eigen::Ref<const Eigen::MatrixXd>& jacobian) {
  SpreadRows spread{jacobian * covariance.root};
  if (covariance.untold.cols() > 0) {
    spread.is_told =
        (jacobian * covariance.untold).norm() <= kNotSeen * jacobian.norm();
  }
  return spread;
}

Eigen::Matrix3d Unknown() {
  return Eigen::Vector3d::Constant(kInfinity).asDiagonal();
}

// Poses whose Jacobians are in memory at once, and of those that are multiplied
// with the root at once.
constexpr Eigen::Index kPosesAtOnce = 4096;
constexpr Eigen::Index kPosesPerProduct = 64;

// Of three columns: S = root^T J^T has S^T S = J C J^T.
Eigen::Matrix3d CovarianceOf(
    const Eigen::Ref<const Eigen::MatrixXd>& jacobian,
    const Eigen::Ref<const Eigen::MatrixXd>& spread,
    const Eigen::Ref<const Eigen::MatrixXd>& along_untold) {
  if (along_untold.rows() > 0 &&
      along_untold.norm() > kNotSeen * jacobian.norm()) {
    return Unknown();
  }
  return spread.transpose().lazyProduct(spread);
}

// The covariances of `poses`, of which there are kPosesAtOnce at most.
void PredictSome(const MeasurementModel& model, const Eigen::VectorXd& values,
                 const ParameterCovariance& covariance, const Dataset& poses,
                 PoseCovariance* predicted) {
  const auto p = static_cast<Eigen::Index>(covariance.size());
  Eigen::MatrixXd jacobians(p, 6 * poses.num_poses());
  ForEachObservation(
      model, values, poses, covariance.columns,
      [&](int, Eigen::Index i, const Eigen::Ref<const Eigen::MatrixXd>& rows) {
        jacobians.middleCols(6 * i, 6) = rows.leftCols(p).transpose();
      });
  const auto work = [&](std::int64_t begin, std::int64_t end) {
    const auto some = jacobians.middleCols(6 * begin, 6 * (end - begin));
    const Eigen::MatrixXd spread = covariance.root.transpose() * some;
    Eigen::MatrixXd untold(0, some.cols());
    if (covariance.untold.cols() > 0) {
      untold = covariance.untold.transpose() * some;
    }
    for (std::int64_t k = begin; k < end; ++k) {
      for (const int half : {0, 3}) {
        const Eigen::Index first = 6 * (k - begin) + half;
        (half == 0 ? predicted[k].position : predicted[k].rotation) =
            CovarianceOf(some.middleCols(first, 3), spread.middleCols(first, 3),
                         untold.middleCols(first, 3));
      }
    }
  };
  ParallelFor(model.num_threads(), poses.num_poses(), kPosesPerProduct, work);
}

// Rows that were measured.
std::vector<Eigen::Index> MeasuredRows(const ObservationBlock& block,
                                       Eigen::Index i) {
  std::vector<Eigen::Index> rows;
  for (Eigen::Index row = 0; row < block.rows_each(); ++row) {
    if (std::isfinite(block.sigmas(row, i))) rows.push_back(row);
  }
  return rows;
}

// Where sigma is told by residuals, too few or too many deviations are.
std::string Verdict(const PredictionCheck& check) {
  if (check.axes.n == 0) return "nothing to compare";
  if (check.axes.upper < check.confidence) return "larger";
  if (check.axes.lower > check.confidence) return "smaller";
  return "agree";
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

PredictionCheck CheckPrediction(const MeasurementModel& model,
                                const Eigen::VectorXd& values,
                                const ParameterCovariance& covariance,
                                const Dataset& heldout, double confidence) {
  PredictionCheck check;
  check.confidence = confidence;
  const double dof = covariance.degrees_of_freedom;
  const double bound = StudentTQuantile(0.5 + 0.5 * confidence, dof);
  // Of an observation: its z-scores, and whether a position's ellipsoid holds.
  struct Scores {
    std::vector<double> z;
    int held = -1;
  };
  std::vector<Scores> scores(heldout.num_observations());
  const std::vector<Eigen::Index> first = FirstObservations(heldout);
  const double ellipsoid = 3.0 * FisherQuantile(confidence, 3.0, dof);
  ForEachObservation(
      model, values, heldout, covariance.columns,
      [&](int, Eigen::Index i, const Eigen::Ref<const Eigen::MatrixXd>& rows) {
        const auto b =
            std::upper_bound(first.begin(), first.end(), i) - first.begin() - 1;
        const ObservationBlock& block = heldout.blocks[b];
        if (block.kind == MeasurementKind::kPointDistance) return;
        const std::vector<Eigen::Index> measured =
            MeasuredRows(block, i - first[b]);
        const Eigen::Index p = rows.cols() - 1;
        const SpreadRows spread = Spread(covariance, rows.leftCols(p));
        if (measured.empty() || !spread.is_told) return;
        const Eigen::MatrixXd variance =
            Eigen::MatrixXd::Identity(rows.rows(), rows.rows()) +
            spread.rows * spread.rows.transpose();
        for (const Eigen::Index row : measured) {
          scores[i].z.push_back(rows(row, p) / std::sqrt(variance(row, row)));
        }
        if (!HoldsPosition(block.kind) || measured.size() < 3) return;
        if (measured[2] != 2) return;
        const Eigen::Vector3d error = rows.col(p).head<3>();
        const Eigen::Matrix3d of_position = variance.topLeftCorner<3, 3>();
        scores[i].held =
            error.dot(of_position.llt().solve(error)) <= ellipsoid ? 1 : 0;
      });
  std::vector<std::vector<double>> z_of(heldout.blocks.size());
  std::int64_t mine_held = 0;
  std::int64_t mine = 0;
  for (std::size_t b = 0; b < z_of.size(); ++b) {
    for (Eigen::Index i = first[b]; i < first[b + 1]; ++i) {
      const Scores& one = scores[i];
      z_of[b].insert(z_of[b].end(), one.z.begin(), one.z.end());
      mine += one.held >= 0 ? 1 : 0;
      mine_held += one.held > 0 ? 1 : 0;
    }
  }
  const std::vector<double> z = InOrder(heldout, std::move(z_of));
  check.ellipsoids.n = SumOverMembers(heldout, mine);
  check.ellipsoids.held = SumOverMembers(heldout, mine_held);
  check.z_scores = Eigen::Map<const Eigen::VectorXd>(
      z.data(), static_cast<Eigen::Index>(z.size()));
  check.axes.n = check.z_scores.size();
  check.axes.held = (check.z_scores.array().abs() <= bound).count();
  for (Coverage* coverage : {&check.axes, &check.ellipsoids}) {
    std::tie(coverage->lower, coverage->upper) =
        RateInterval(coverage->held, coverage->n, 0.95);
  }
  if (check.axes.n > 0) {
    check.rms_z = std::sqrt(check.z_scores.squaredNorm() /
                            static_cast<double>(check.axes.n));
  }
  check.histogram = CountStandardised(check.z_scores);
  check.verdict = Verdict(check);
  return check;
}

}  // namespace alidade
