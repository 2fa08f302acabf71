#include "src/calibration/prior_check.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "alidade/robust_loss.h"
#include "src/common/format.h"
#include "src/common/random.h"
#include "src/identifiability/generic_data.h"
#include "src/kernel/holdout.h"

namespace alidade::internal {
namespace {

constexpr Eigen::Index kMostRefitted = 2000;
constexpr int kFolds = 5;
constexpr int kRepeats = 4;
constexpr double kWider = 100.0;

// Whether the priors can have moved the fit by a standard deviation in all.
// Where sigma comes from residuals that the priors themselves keep large, that
// says nothing, but then they dominate.
bool CanPull(const CalibrationSolution& fit,
             const IdentifiabilityResult& pass) {
  const Eigen::VectorXd nominal = fit.model().NominalValues();
  double bound = 0.0;
  double share = 0.0;
  for (const int column : fit.problem.ColumnsWithPrior()) {
    const double prior = fit.problem.priors[column];
    const double std = std::min(
        prior, pass.decisions[static_cast<std::size_t>(column)].predicted_std);
    bound +=
        std::abs(fit.values[column] - nominal[column]) * std / (prior * prior);
    share += std * std / (prior * prior);
  }
  return bound > 1.0 || (fit.task.options.estimate_sigma && share > 1.0);
}

// An observation, linearised.
struct Row {
  int group = -1;            // its configuration; -1: of none
  Eigen::MatrixXd jacobian;  // whitened, by the root of its weight
  Eigen::VectorXd residual;
  Eigen::VectorXd
      unwhiten;  // by which its lengths are multiplied; may be empty
};

class CrossCheck {
 public:
  explicit CrossCheck(const CalibrationSolution& fit)
      : fit_(fit),
        p_(static_cast<Eigen::Index>(fit.problem.free_columns.size())) {
    const Dataset data = EvenSubset(fit.task.communicator,
                                    fit.task.data.training, kMostRefitted);
    ListRows(data);
    const Eigen::VectorXd nominal = fit.model().NominalValues();
    with_.setZero(p_);
    wide_.setZero(p_);
    deviations_.setZero(p_);
    for (Eigen::Index k = 0; k < p_; ++k) {
      const int column = fit.problem.free_columns[static_cast<std::size_t>(k)];
      const double prior = fit.problem.priors[column];
      if (!std::isfinite(prior)) continue;
      const bool is_joint = ParameterLayout::IsJointKind(
          fit.model().layout().parameter(column).kind);
      with_[k] = 1.0 / (prior * prior);
      wide_[k] = is_joint ? with_[k] / (kWider * kWider) : with_[k];
      deviations_[k] = fit.values[column] - nominal[column];
    }
  }

  bool CanFold() const { return num_groups_ >= 2 * kFolds; }

  // Mean errors of what was left out, with priors and without, and their
  // difference in its standard errors.
  struct Errors {
    double with = 0.0;
    double without = 0.0;
    double t = 0.0;
  };
  Errors Run() {
    sums_.assign(static_cast<std::size_t>(num_groups_), {0.0, 0.0});
    for (int repeat = 0; repeat < kRepeats; ++repeat) Repeat(repeat);
    Errors errors;
    double squares = 0.0;
    for (const auto& [with, without] : sums_) {
      errors.with += with;
      errors.without += without;
      squares += std::pow(with - without, 2);
    }
    const auto n = static_cast<double>(num_groups_);
    const double gain = (errors.with - errors.without) / n;
    errors.t = gain / std::sqrt((squares / n - gain * gain) / (n - 1.0));
    errors.with /= kRepeats * static_cast<double>(num_lengths_);
    errors.without /= kRepeats * static_cast<double>(num_lengths_);
    return errors;
  }

 private:
  void ListRows(const Dataset& data) {
    const std::vector<RobustLoss> losses = TunedLosses(fit_.task.options.loss);
    const std::vector<int> groups = GroupByConfiguration(data);
    std::vector<double> weights(
        static_cast<std::size_t>(data.num_observations()), 1.0);
    rows_.resize(weights.size());
    const Eigen::VectorXi dimensions = Dimensions(data);
    ForEachObservation(
        fit_.model(), fit_.values, data, fit_.problem.free_columns,
        [&](int, Eigen::Index i, const Eigen::Ref<const Eigen::MatrixXd>& all) {
          if (dimensions[i] == 0) return;
          double& weight = weights[static_cast<std::size_t>(i)];
          if (!losses.empty()) {
            weight =
                losses[dimensions[i] - 1].Weight(all.col(p_).squaredNorm());
          }
          Row& row = rows_[static_cast<std::size_t>(i)];
          row.jacobian = std::sqrt(weight) * all.leftCols(p_);
          row.residual = std::sqrt(weight) * all.col(p_);
        });
    std::size_t count = 0;
    for (const ObservationBlock& block : data.blocks) {
      const Eigen::Index height = std::min(3, block.rows_each());
      const bool is_of_pose = block.kind != MeasurementKind::kPointDistance;
      for (Eigen::Index i = 0; i < block.size(); ++i, ++count) {
        Row& row = rows_[count];
        if (!is_of_pose || row.residual.size() == 0) continue;
        row.group = groups[static_cast<std::size_t>(block.pose(i))];
        num_groups_ = std::max(num_groups_, row.group + 1);
        AddLengths(block.sigmas.col(i).head(height), weights[count], &row);
      }
    }
  }

  // Rejected observations do not count.
  void AddLengths(const Eigen::Ref<const Eigen::VectorXd>& sigmas,
                  double weight, Row* row) {
    constexpr double kRejected = 0.5;
    if (!sigmas.allFinite() || weight < kRejected) return;
    row->unwhiten = sigmas / std::sqrt(weight);
    ++num_lengths_;
  }

  // The folds of one shuffle of the configurations.
  void Repeat(int repeat) {
    Random random(1, static_cast<std::uint64_t>(repeat));
    std::vector<std::pair<double, int>> order;
    for (int group = 0; group < num_groups_; ++group) {
      order.emplace_back(random.Uniform(), group);
    }
    std::sort(order.begin(), order.end());
    std::vector<int> fold_of(order.size());
    for (std::size_t k = 0; k < order.size(); ++k) {
      fold_of[static_cast<std::size_t>(order[k].second)] =
          static_cast<int>(k) % kFolds;
    }
    Eigen::MatrixXd information = Eigen::MatrixXd::Zero(p_, p_);
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(p_);
    AddRows([](const Row&) { return true; }, &information, &gradient);
    for (int fold = 0; fold < kFolds; ++fold) {
      LeaveOut(fold, fold_of, information, gradient);
    }
  }

  template <typename IsTaken>
  void AddRows(const IsTaken& is_taken, Eigen::MatrixXd* information,
               Eigen::VectorXd* gradient) const {
    for (const Row& row : rows_) {
      if (row.residual.size() == 0 || !is_taken(row)) continue;
      information->noalias() += row.jacobian.transpose() * row.jacobian;
      gradient->noalias() += row.jacobian.transpose() * row.residual;
    }
  }

  // `information` and `gradient` are those of all rows.
  void LeaveOut(int fold, const std::vector<int>& fold_of,
                const Eigen::MatrixXd& information,
                const Eigen::VectorXd& gradient) {
    const auto is_left_out = [&](const Row& row) {
      return row.group >= 0 &&
             fold_of[static_cast<std::size_t>(row.group)] == fold;
    };
    Eigen::MatrixXd of_fold = Eigen::MatrixXd::Zero(p_, p_);
    Eigen::VectorXd gradient_of_fold = Eigen::VectorXd::Zero(p_);
    AddRows(is_left_out, &of_fold, &gradient_of_fold);
    const Eigen::MatrixXd kept = information - of_fold;
    const Eigen::VectorXd kept_gradient = gradient - gradient_of_fold;
    const Eigen::VectorXd with = Step(kept, kept_gradient, with_);
    const Eigen::VectorXd without = Step(kept, kept_gradient, wide_);
    for (const Row& row : rows_) {
      if (!is_left_out(row) || row.unwhiten.size() == 0) continue;
      auto& [sum_with, sum_without] =
          sums_[static_cast<std::size_t>(row.group)];
      sum_with += Error(row, with);
      sum_without += Error(row, without);
    }
  }

  Eigen::VectorXd Step(Eigen::MatrixXd information, Eigen::VectorXd gradient,
                       const Eigen::VectorXd& priors) const {
    information.diagonal() += priors;
    gradient += priors.cwiseProduct(deviations_);
    // Angles and lengths differ in size.
    const Eigen::VectorXd inverse =
        information.diagonal().cwiseSqrt().cwiseInverse();
    information = inverse.asDiagonal() * information * inverse.asDiagonal();
    const Eigen::VectorXd scaled =
        information.ldlt().solve(inverse.cwiseProduct(gradient));
    return -inverse.cwiseProduct(scaled);
  }

  double Error(const Row& row, const Eigen::VectorXd& step) const {
    const Eigen::VectorXd whitened = row.residual + row.jacobian * step;
    return whitened.head(row.unwhiten.size()).cwiseProduct(row.unwhiten).norm();
  }

  const CalibrationSolution& fit_;
  const Eigen::Index p_;
  std::vector<Row> rows_;
  Eigen::VectorXd with_;  // 1 / prior^2
  Eigen::VectorXd wide_;
  Eigen::VectorXd deviations_;
  int num_groups_ = 0;
  std::int64_t num_lengths_ = 0;
  std::vector<std::pair<double, double>> sums_;
};

}  // namespace

std::string WarnOfPriors(const CalibrationSolution& fit,
                         const IdentifiabilityResult& pass) {
  constexpr double kLeastGain = 0.02;
  constexpr double kBeyondChance = 2.0;
  if (fit.problem.priors.size() == 0 || !CanPull(fit, pass)) {
    return "";
  }
  CrossCheck check(fit);
  if (!check.CanFold()) return "";
  const auto errors = check.Run();
  if (!(errors.without < (1.0 - kLeastGain) * errors.with) ||
      !(errors.t > kBeyondChance)) {
    return "";
  }
  const PriorTolerances& priors = fit.task.options.identifiability.priors;
  return "priors of " + FormatLength(std::min(priors.d, priors.r), 2) +
         " and " +
         FormatSignificant(
             1e3 * std::min({priors.beta, priors.alpha, priors.theta}), 2) +
         " mrad pull: with a hundred times wider ones the error of training "
         "poses left out of "
         "the fit (cross-validation, mean) is " +
         FormatLength(errors.without, 3) + " instead of " +
         FormatLength(errors.with, 3) + ". Widen `priors`" +
         (fit.task.options.prior_scale == PriorScale::kEstimated
              ? ""
              : ", or let the data find their size (`identifiability: "
                "{prior_scale: estimated}`)");
}

}  // namespace alidade::internal
