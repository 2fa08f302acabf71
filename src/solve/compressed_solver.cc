#include "src/solve/compressed_solver.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "src/solve/damped_step.h"

namespace alidade::internal {
namespace {

// As in Ceres: a step that gains less than this part of what was predicted is
// taken back, and a radius leaves no room for another one.
constexpr double kFewestGained = 1e-3;
constexpr double kLargestRadius = 1e16;
constexpr double kSmallestRadius = 1e-32;

// A column of less than this part of the largest is rounding: its parameter
// moves nothing here, and is held as firmly as the others are free.
constexpr double kRounding = 1e-12;

// Where no step was ever taken, and the residual is this much along what the
// columns can reach, it is no minimum.
constexpr double kNotStationary = 1e-3;

class TrustRegion {
 public:
  explicit TrustRegion(double radius)
      : radius_(radius), largest_(std::max(radius, kLargestRadius)) {}

  double radius() const { return radius_; }

  void Accept(double gain_ratio) {
    const double miss = 2.0 * gain_ratio - 1.0;
    radius_ /= std::max(1.0 / 3.0, 1.0 - miss * miss * miss);
    radius_ = std::min(radius_, largest_);
    divisor_ = 2.0;
  }

  void Reject() {
    radius_ /= divisor_;
    divisor_ *= 2.0;
  }

 private:
  double radius_;
  const double largest_;
  double divisor_ = 2.0;
};

class LevenbergMarquardt {
 public:
  LevenbergMarquardt(const CalibrationProblem& problem, double radius,
                     CompressedProblem* compressed, Progress* progress,
                     Eigen::VectorXd* values)
      : problem_(problem),
        progress_(*progress),
        compressor_(*progress->compressor()),
        region_(radius),
        values_(*values),
        current_(*compressed) {
    const auto p = static_cast<Eigen::Index>(problem.free_columns.size());
    known_.weights = Eigen::VectorXd::Zero(p);
    known_.residuals = Eigen::VectorXd::Zero(p);
    if (problem.ColumnsWithPrior().empty()) return;
    nominal_ = problem.model.NominalValues();
    for (Eigen::Index k = 0; k < p; ++k) {
      const double prior = problem.priors[problem.free_columns[k]];
      if (std::isfinite(prior)) known_.weights[k] = 1.0 / prior;
    }
  }

  void Run() {
    while (!progress_.stopped()) {
      if (!current_.factor.allFinite() || !current_.projected.allFinite()) {
        progress_.Stop(SolverStatus::kFailed,
                       "derivatives are not finite, or their squares: look for "
                       "poses or units that are wrong");
      } else if (region_.radius() < kSmallestRadius) {
        progress_.Stop(SolverStatus::kConverged,
                       "no step however small lowers the cost");
      } else {
        TakeStep();
      }
    }
    const SolverSummary& summary = progress_.summary();
    if (summary.status == SolverStatus::kConverged &&
        summary.accepted_steps == 0 && Gradient() > kNotStationary) {
      progress_.Stop(SolverStatus::kFailed,
                     "no step lowers the cost, though it is no minimum: fix "
                     "what the identifiability pass calls weak");
    }
  }

 private:
  // The largest cosine between the residual and a column that is not rounding,
  // priors included.
  double Gradient() const {
    const Eigen::VectorXd norms = Norms();
    const double residual = std::sqrt(progress_.cost());
    double cosine = 0.0;
    for (Eigen::Index k = 0; k < norms.size(); ++k) {
      if (norms[k] <= kRounding * norms.maxCoeff() || residual == 0.0) continue;
      const double product = current_.factor.col(k).dot(current_.projected) +
                             known_.weights[k] * known_.residuals[k];
      cosine = std::max(cosine, std::abs(product) / (norms[k] * residual));
    }
    return cosine;
  }

  // Of the columns, priors included.
  Eigen::VectorXd Norms() const {
    return (current_.factor.colwise().squaredNorm().transpose() +
            known_.weights.cwiseAbs2())
        .cwiseSqrt();
  }

  void TakeStep() {
    const Eigen::VectorXd& step = ComputeStep();
    trial_ = values_;
    for (Eigen::Index k = 0; k < step.size(); ++k) {
      trial_[problem_.free_columns[k]] += step[k];
    }
    const double cost = progress_.cost();
    IterationStep told;
    told.norm = step.norm();
    told.predicted_decrease = PredictedDecrease(step);
    told.accepted = false;
    has_next_ = false;
    if (told.predicted_decrease >= 0.0 && trial_.allFinite()) {
      const double gained = cost - CostOfTrial(told.predicted_decrease);
      const double gain_ratio = gained / told.predicted_decrease;
      told.accepted = gain_ratio > kFewestGained;
      if (told.accepted) region_.Accept(gain_ratio);
    } else {
      // Says nothing: count it as large.
      told.predicted_decrease = 2.0 * cost;
    }
    if (told.accepted) {
      values_ = trial_;
    } else {
      region_.Reject();
    }
    expects_success_ = told.accepted;
    if (progress_.Record(told, values_) || !told.accepted) return;
    if (!has_next_) compressor_.Compress(values_, &next_);
    std::swap(current_, next_);
  }

  // (R^T R + P^2 + D^2) step = -(R^T z + P w).
  const Eigen::VectorXd& ComputeStep() {
    const Eigen::VectorXd norms = Norms();
    const double largest = norms.maxCoeff();
    const double root = std::sqrt(region_.radius());
    damping_.resize(norms.size());
    for (Eigen::Index k = 0; k < norms.size(); ++k) {
      const bool is_rounding = norms[k] <= kRounding * largest;
      damping_[k] = is_rounding ? std::max(largest, 1.0) : norms[k] / root;
    }
    if (nominal_.size() > 0) {
      for (Eigen::Index k = 0; k < known_.weights.size(); ++k) {
        const int column = problem_.free_columns[k];
        known_.residuals[k] =
            known_.weights[k] * (values_[column] - nominal_[column]);
      }
    }
    return damped_.Solve(current_.factor, current_.projected, known_, damping_);
  }

  // What the linear model expects the cost to lose.
  double PredictedDecrease(const Eigen::VectorXd& step) {
    change_.noalias() = current_.factor * step;
    const double measured = change_.dot(2.0 * current_.projected + change_);
    change_ = known_.weights.cwiseProduct(step);
    return -measured - change_.dot(2.0 * known_.residuals + change_);
  }

  // Behind a step that was taken back the next one may be too, and of one that
  // is to be the last nobody asks for a Jacobian.
  double CostOfTrial(double predicted) {
    if (expects_success_ && !progress_.WouldStop(predicted)) {
      compressor_.Compress(trial_, &next_);
      has_next_ = true;
    }
    return progress_.Cost(trial_);
  }

  const CalibrationProblem& problem_;
  Progress& progress_;
  Compressor& compressor_;
  TrustRegion region_;
  Eigen::VectorXd& values_;
  CompressedProblem& current_;
  CompressedProblem next_;  // at the trial, where has_next_
  bool has_next_ = false;
  bool expects_success_ = true;
  Eigen::VectorXd nominal_;  // where there are priors
  DampedStep::Diagonal known_;
  DampedStep damped_;
  Eigen::VectorXd damping_;
  Eigen::VectorXd change_;
  Eigen::VectorXd trial_;
};

}  // namespace

void IterateLevenbergMarquardt(const CalibrationProblem& problem, double radius,
                               CompressedProblem* compressed,
                               Progress* progress, Eigen::VectorXd* values) {
  LevenbergMarquardt(problem, radius, compressed, progress, values).Run();
}

}  // namespace alidade::internal
