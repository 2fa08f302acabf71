#include <ceres/cost_function.h>
#include <ceres/problem.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "src/kernel/reduction.h"
#include "src/solve/formulation.h"
#include "src/solve/progress.h"

namespace alidade::internal {
namespace {

// The free values, as Ceres has them, among all of the layout.
void Expand(const CalibrationProblem& problem, const double* free,
            Eigen::VectorXd* all) {
  for (std::size_t k = 0; k < problem.free_columns.size(); ++k) {
    (*all)[problem.free_columns[k]] = free[k];
  }
}

// With z the projected residual and c the cost, the residual is z and below it
// sqrt(c - |z|^2), what no step can lower to first order: half its squared norm
// is what Ceres minimises, R its Jacobian.
class ReducedResidual : public ceres::CostFunction {
 public:
  // `start`: the reduced problem at `values`.
  ReducedResidual(const CalibrationProblem& problem,
                  const Eigen::VectorXd& values, ReducedLeastSquares start,
                  Progress* progress)
      : problem_(problem),
        progress_(*progress),
        reducer_(*progress->reducer()),
        values_(values),
        current_(std::move(start)),
        current_at_(values),
        next_at_(Eigen::VectorXd::Constant(values.size(), NAN)) {
    const auto p = static_cast<int>(problem.free_columns.size());
    mutable_parameter_block_sizes()->push_back(p);
    set_num_residuals(p + 1);
  }

  // Not to be called from two threads at once: Ceres has one.
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    Expand(problem_, parameters[0], &values_);
    const int p = parameter_block_sizes()[0];
    Eigen::Map<Eigen::VectorXd> residual(residuals, p + 1);
    if (jacobians == nullptr || jacobians[0] == nullptr) {
      TryStep();
      residual.setZero();
      residual[p] = std::sqrt(cost_);
      return residual.allFinite();
    }
    MakeCurrent();
    residual.head(p) = current_.projected;
    residual[p] =
        std::sqrt(std::max(0.0, cost_ - current_.projected.squaredNorm()));
    Eigen::Map<
        Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>
        jacobian(jacobians[0], p + 1, p);
    jacobian.topRows(p) = current_.factor;
    jacobian.row(p).setZero();
    const Eigen::RowVectorXd norms = current_.factor.colwise().norm();
    const double largest = norms.maxCoeff();
    for (int k = 0; k < p; ++k) {
      if (norms[k] <= kRoundingColumn * largest) jacobian.col(k).setZero();
    }
    return residual.allFinite() && current_.factor.allFinite();
  }

  // By the last trial, where that step ends the solve.
  std::optional<double> PredictedDecrease() const {
    return is_last_ ? std::optional<double>(predicted_decrease_) : std::nullopt;
  }

 private:
  // Of a trial step only the cost is asked for. Most steps succeed, and then
  // all else is asked for at the same values: it is made at once. Behind a step
  // that was rejected, and of one that ends the solve whatever it does, the
  // cost alone is, which is cheaper.
  void TryStep() const {
    const Eigen::VectorXd step = (values_ - current_at_)(problem_.free_columns);
    const Eigen::VectorXd change = current_.factor * step;
    predicted_decrease_ = -change.dot(2.0 * current_.projected + change);
    is_last_ =
        predicted_decrease_ >= 0.0 && progress_.WouldStop(predicted_decrease_);
    if (expects_success_ && !is_last_) MakeNext();
    expects_success_ = false;
    cost_ = reducer_.Summarize(values_).cost;
  }

  // The reduced problem at the values, but not where the last step led to:
  // nobody uses its derivatives.
  void MakeCurrent() const {
    expects_success_ = true;
    if (is_last_) return;
    if (values_ != current_at_) {
      if (values_ != next_at_) MakeNext();
      std::swap(current_, next_);
      std::swap(current_at_, next_at_);
    }
    cost_ = current_.cost;
  }

  void MakeNext() const {
    reducer_.Reduce(values_, &next_);
    next_at_ = values_;
  }

  const CalibrationProblem& problem_;
  Progress& progress_;
  Reducer& reducer_;
  mutable Eigen::VectorXd values_;
  mutable ReducedLeastSquares current_;
  mutable Eigen::VectorXd current_at_;
  mutable ReducedLeastSquares next_;
  mutable Eigen::VectorXd next_at_;
  mutable double cost_ = 0.0;
  mutable double predicted_decrease_ = 0.0;
  mutable bool is_last_ = false;
  // False after a trial whose Jacobian was never asked for.
  mutable bool expects_success_ = true;
};

class ReducedFormulation : public Formulation {
 public:
  ReducedFormulation(const CalibrationProblem& problem,
                     const Eigen::VectorXd& values, ReducedLeastSquares start,
                     Progress* progress)
      : problem_(problem),
        values_(values),
        free_(values(problem.free_columns)),
        used_gram_(progress->reducer()->used_gram()),
        residual_(
            new ReducedResidual(problem, values, std::move(start), progress)) {
    ceres_problem_.AddResidualBlock(residual_, nullptr, free_.data());
  }

  ceres::Problem* problem() override { return &ceres_problem_; }
  Eigen::VectorXd Values() const override {
    Eigen::VectorXd all = values_;
    Expand(problem_, free_.data(), &all);
    return all;
  }
  // Normal equations give a step to as many digits as products give R.
  ceres::LinearSolverType linear_solver() const override {
    return used_gram_ ? ceres::DENSE_NORMAL_CHOLESKY : ceres::DENSE_QR;
  }
  std::optional<double> PredictedDecrease() const override {
    return residual_->PredictedDecrease();
  }

 private:
  const CalibrationProblem& problem_;
  const Eigen::VectorXd values_;
  Eigen::VectorXd free_;
  const bool used_gram_;
  ReducedResidual* const residual_;  // ceres_problem_ owns it
  ceres::Problem ceres_problem_;
};

}  // namespace

std::unique_ptr<Formulation> MakeReducedFormulation(
    const CalibrationProblem& problem, const Eigen::VectorXd& values,
    ReducedLeastSquares start, Progress* progress) {
  return std::make_unique<ReducedFormulation>(problem, values, std::move(start),
                                              progress);
}

}  // namespace alidade::internal
