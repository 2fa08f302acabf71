#include "src/planning/efficiency.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace alidade::internal {
namespace {

constexpr int kIterations = 100;

// Candidates whose v_k is this part of the largest at the plan may get weights;
// where the weights are best, all that have one have the largest.
constexpr double kMayCount = 0.5;

// So many iterations apart, weights below this part of the largest are dropped.
constexpr int kDropEvery = 10;
constexpr double kDropped = 1e-3;

double LogDeterminant(const Eigen::MatrixXd& information) {
  const Eigen::MatrixXd factor = information.llt().matrixL();
  return 2.0 * factor.diagonal().array().log().sum();
}

// Weights of some of the candidates.
class WeightedPlan {
 public:
  WeightedPlan(const DesignProblem& problem, int num_poses, int num_threads)
      : all_(problem), num_poses_(num_poses), num_threads_(num_threads) {}

  void Set(const std::vector<int>& candidates, const Eigen::VectorXd& weights) {
    part_ = RestrictCandidates(all_, candidates);
    weights_ = weights / weights.sum();
    ComputeInformation();
  }

  // Gives each weight its v_k; in some iterations drops the small ones.
  void Improve(int iteration) {
    const Eigen::VectorXd variances =
        PredictedVariances(part_.candidates, information_, num_threads_);
    weights_ = weights_.cwiseProduct(variances);
    weights_ /= weights_.sum();
    if (iteration % kDropEvery == 0) DropSmall();
    ComputeInformation();
  }

  // Of log det M of any plan of as many poses.
  double Bound() const {
    const Eigen::VectorXd mine =
        PredictedVariances(part_.candidates, information_, num_threads_);
    const double most =
        PredictedVariances(all_.candidates, information_, num_threads_)
            .maxCoeff();
    return LogDeterminant(information_) +
           num_poses_ * (most - weights_.dot(mine));
  }

 private:
  void DropSmall() {
    const double least = kDropped * weights_.maxCoeff();
    std::vector<int> kept;
    Eigen::VectorXd weights(weights_.size());
    for (Eigen::Index k = 0; k < weights_.size(); ++k) {
      if (weights_[k] < least) continue;
      weights[static_cast<Eigen::Index>(kept.size())] = weights_[k];
      kept.push_back(static_cast<int>(k));
    }
    part_ = RestrictCandidates(part_, kept);
    weights_ = weights.head(static_cast<Eigen::Index>(kept.size()));
    weights_ /= weights_.sum();
  }

  void ComputeInformation() {
    const Eigen::Index m = part_.candidates.rows_each;
    Eigen::MatrixXd rows = part_.candidates.transposed;
    for (Eigen::Index k = 0; k < weights_.size(); ++k) {
      rows.middleCols(k * m, m) *= std::sqrt(num_poses_ * weights_[k]);
    }
    information_ = all_.known;
    information_.noalias() += rows * rows.transpose();
  }

  const DesignProblem& all_;
  const double num_poses_;
  const int num_threads_;
  DesignProblem part_;
  Eigen::VectorXd weights_;
  Eigen::MatrixXd information_;
};

}  // namespace

double DeterminantEfficiency(const DesignProblem& problem,
                             const std::vector<int>& chosen, int num_threads) {
  const PoseRows& rows = problem.candidates;
  const Eigen::MatrixXd information =
      problem.known + InformationOf(rows, chosen);
  const Eigen::VectorXd variances =
      PredictedVariances(rows, information, num_threads);
  Eigen::VectorXd counts = Eigen::VectorXd::Zero(rows.size());
  for (const int k : chosen) counts[k] += 1.0;
  std::vector<int> candidates;
  for (int k = 0; k < rows.size(); ++k) {
    const bool may_count = variances[k] >= kMayCount * variances.maxCoeff();
    if (may_count || counts[k] > 0.0) candidates.push_back(k);
  }
  // As much weight as the plan has, evenly over all that may get some.
  const double even = static_cast<double>(chosen.size()) /
                      static_cast<double>(candidates.size());
  Eigen::VectorXd weights(static_cast<Eigen::Index>(candidates.size()));
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    weights[static_cast<Eigen::Index>(i)] = counts[candidates[i]] + even;
  }
  WeightedPlan plan(problem, static_cast<int>(chosen.size()), num_threads);
  plan.Set(candidates, weights);
  for (int iteration = 1; iteration <= kIterations; ++iteration) {
    plan.Improve(iteration);
  }
  // Where the plan itself is the better weights.
  const double own = LogDeterminant(information) +
                     static_cast<double>(chosen.size()) * variances.maxCoeff() -
                     variances.dot(counts);
  const double gap = LogDeterminant(information) - std::min(own, plan.Bound());
  return std::exp(std::min(0.0, gap) / rows.num_parameters());
}

}  // namespace alidade::internal
