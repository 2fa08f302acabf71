#ifndef ALIDADE_SRC_KERNEL_ROBUST_FIT_H_
#define ALIDADE_SRC_KERNEL_ROBUST_FIT_H_

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

namespace alidade::internal {

/// Robust nonlinear least squares with few unknowns. A Model is a value that
/// can be copied, with
///
///   static constexpr int kBlockSize      residuals of one observation
///   static constexpr int kTargetColumn   first column of the targets
///   Eigen::Matrix3Xd targets             held near 0 by a weak prior
///   void Linearize(FitRows* rows) const  residuals r and dr / d(step)
///   void Move(const Eigen::VectorXd& step)
struct FitRows {
  Eigen::VectorXd residuals;  ///< kBlockSize per observation (m)
  Eigen::MatrixXd jacobian;   ///< as many rows
};

/// Of a start: less is asked of it than of a loss in a solve (robust_loss.h).
enum class FitWeighting { kHuber, kTukey };

/// The norms of consecutive blocks.
Eigen::VectorXd BlockNorms(const Eigen::VectorXd& residuals, int block_size);

/// The median of the norms, larger where the unknowns use up the equations,
/// and at least 1e-6 m.
double FitScale(const Eigen::VectorXd& norms, const FitRows& rows);

/// The norm, in scales, from which an observation has no weight (Tukey).
constexpr double kTukeyCut = 6.0;

/// The observations' weights, in [0, 1].
Eigen::VectorXd RobustWeights(const Eigen::VectorXd& norms, double scale,
                              FitWeighting weighting);

/// The sum of the observations' squared residuals by their weights, and of the
/// targets' prior.
double WeighedSum(const FitRows& rows, const Eigen::VectorXd& weights,
                  double scale, const Eigen::Matrix3Xd& targets);

/// Multiplies the rows by the square roots of their observations' weights, and
/// appends those of the targets' prior.
void WeighRows(const Eigen::VectorXd& weights, double scale,
               const Eigen::Matrix3Xd& targets, int target_column,
               FitRows* rows);

/// The damped Gauss-Newton step of minimum norm.
Eigen::VectorXd FitStep(const FitRows& rows, double damping);

/// The steps (m and rad together, of arms of some metres) below which a fit has
/// ended: of one start among others, far below what distinguishes them, and of
/// the best of them.
constexpr double kSmallestStepOfStart = 1e-7;
constexpr double kSmallestStep = 1e-12;

/// A sum that grows by less than this part of it may do so by rounding alone,
/// where residuals are a millionth of the coordinates. Of smaller ones,
/// rounding is more, and the fit ends at a last step that it rejects.
constexpr double kSumRounding = 1e-10;

/// Improves the model until an undamped step is below `smallest_step`, or
/// rounding rejects it; to `max_iterations` where neither happens. The sum of
/// weighed squares rises by no more than kSumRounding a step.
template <typename Model>
void Refine(FitWeighting weighting, int max_iterations, double smallest_step,
            Model* model) {
  double damping = 1e-4;
  bool is_last = false;
  FitRows rows;
  model->Linearize(&rows);
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    const Eigen::VectorXd norms = BlockNorms(rows.residuals, Model::kBlockSize);
    const double scale = FitScale(norms, rows);
    const Eigen::VectorXd weights = RobustWeights(norms, scale, weighting);
    const double sum = WeighedSum(rows, weights, scale, model->targets);
    FitRows weighed = rows;
    WeighRows(weights, scale, model->targets, Model::kTargetColumn, &weighed);
    const Eigen::VectorXd step = FitStep(weighed, damping);
    if (!step.allFinite()) return;
    Model moved = *model;
    moved.Move(step);
    FitRows moved_rows;
    moved.Linearize(&moved_rows);
    // With the weights of before: what lowers this sum lowers that of losses.
    if (!(WeighedSum(moved_rows, weights, scale, moved.targets) <=
          (1.0 + kSumRounding) * sum)) {
      damping = damping > 0.0 ? 10.0 * damping : 1e-8;
      if (is_last || damping > 1e6) return;
      continue;
    }
    *model = std::move(moved);
    rows = std::move(moved_rows);
    if (step.norm() >= smallest_step) {
      is_last = false;
      damping = damping < 1e-8 ? 0.0 : 0.1 * damping;
    } else if (damping > 0.0) {
      // What the data hardly hold has not moved yet.
      is_last = true;
      damping = 0.0;
    } else {
      return;
    }
  }
}

/// Refines every start and then the best of them; nothing where none has
/// finite residuals. The sum of norms decides, which few outliers do not rule;
/// of starts that end alike, the first.
template <typename Model>
std::optional<Model> FitFromStarts(const std::vector<Model>& starts) {
  std::optional<Model> best;
  double best_sum = std::numeric_limits<double>::infinity();
  for (Model model : starts) {
    Refine(FitWeighting::kHuber, 40, kSmallestStepOfStart, &model);
    FitRows rows;
    model.Linearize(&rows);
    const Eigen::VectorXd norms = BlockNorms(rows.residuals, Model::kBlockSize);
    const double alike = 1e-3 * norms.sum() + 1e-9 * double(norms.size());
    if (!std::isfinite(alike) || norms.sum() + alike >= best_sum) continue;
    best_sum = norms.sum();
    best = model;
  }
  if (best) Refine(FitWeighting::kTukey, 60, kSmallestStep, &*best);
  return best;
}

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_KERNEL_ROBUST_FIT_H_
