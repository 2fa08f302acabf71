#include "src/calibration/trimmed_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "alidade/robust_loss.h"
#include "src/common/random.h"
#include "src/identifiability/generic_data.h"
#include "src/kernel/measurement_model.h"

namespace alidade::internal {
namespace {

constexpr Eigen::Index kMostSampled = 120;
constexpr int kStarts = 400;
// After so many starts a smaller scale shows, where there is any.
constexpr int kFirstStarts = 80;
constexpr double kShows = 0.8;
constexpr int kFirstSteps = 2;
constexpr std::size_t kMostRefined = 8;
constexpr int kMostSteps = 20;
// The sigmas of the fit that this begins with may be far too large for the
// observations that agree: priors weigh as if they were this much smaller.
constexpr double kSmallerSigma = 0.1;

struct LinearObservation {
  Eigen::MatrixXd jacobian;  // whitened, one column per free parameter
  Eigen::VectorXd residual;
  Eigen::MatrixXd information;
  double unit = 1.0;  // the median norm of a residual of so many rows
};

struct Candidate {
  Eigen::VectorXd step;
  double objective = std::numeric_limits<double>::infinity();
};

class Search {
 public:
  Search(const CalibrationProblem& problem, const Eigen::VectorXd& values)
      : p_(static_cast<Eigen::Index>(problem.free_columns.size())) {
    const Dataset sample =
        EvenSubset(problem.model.communicator(), problem.data, kMostSampled);
    const Eigen::VectorXi dimensions = Dimensions(sample);
    observations_.resize(static_cast<std::size_t>(dimensions.size()));
    ForEachObservation(
        problem.model, values, sample, problem.free_columns,
        [&](int, Eigen::Index i,
            const Eigen::Ref<const Eigen::MatrixXd>& rows) {
          if (dimensions[i] == 0) return;
          LinearObservation& one = observations_[static_cast<std::size_t>(i)];
          one.jacobian = rows.leftCols(p_);
          one.residual = rows.col(p_);
          one.information = one.jacobian.transpose() * one.jacobian;
          one.unit = MedianOfChi(dimensions[i]);
        });
    observations_.erase(
        std::remove_if(
            observations_.begin(), observations_.end(),
            [](const auto& one) { return one.residual.size() == 0; }),
        observations_.end());
    for (const LinearObservation& one : observations_) {
      rows_ += one.residual.size();
    }
    AddPriors(problem, values);
  }

  bool IsDetermined() const { return !observations_.empty() && rows_ > 4 * p_; }

  Candidate Run() const {
    Candidate first = Best(0, kFirstStarts);
    if (first.step.size() == 0 ||
        Scale(first.step) > kShows * Scale(Eigen::VectorXd::Zero(p_))) {
      return first;
    }
    const Candidate second = Best(kFirstStarts, kStarts);
    return second.objective < first.objective ? second : first;
  }

  // The median norm of the residuals after a step.
  double Scale(const Eigen::VectorXd& step) const {
    return RobustScale(Norms(step), 1);
  }

 private:
  using Subset = std::vector<std::size_t>;

  Candidate Best(int first_start, int last_start) const {
    std::vector<Candidate> candidates;
    for (int start = first_start; start < last_start; ++start) {
      Random random(1, static_cast<std::uint64_t>(start));
      candidates.push_back(Concentrate(Draw(start, &random), kFirstSteps));
    }
    const auto is_better = [](const Candidate& a, const Candidate& b) {
      return a.objective < b.objective;
    };
    std::stable_sort(candidates.begin(), candidates.end(), is_better);
    candidates.resize(std::min(candidates.size(), kMostRefined));
    for (Candidate& candidate : candidates) {
      if (candidate.step.size() == 0) continue;
      candidate = Concentrate(Closest(candidate.step), kMostSteps);
    }
    return *std::min_element(candidates.begin(), candidates.end(), is_better);
  }

  std::size_t size() const { return observations_.size(); }

  // Observations of which that many must agree.
  std::size_t Half() const {
    const auto needed =
        size() * static_cast<std::size_t>(p_) / static_cast<std::size_t>(rows_);
    return std::min(size(), (size() + needed + 1) / 2);
  }

  // Priors are rows of the problem: their information and gradient.
  void AddPriors(const CalibrationProblem& problem,
                 const Eigen::VectorXd& values) {
    constexpr double kRidge = 1e-9;
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(p_, p_);
    for (const LinearObservation& one : observations_) all += one.information;
    prior_information_ = kRidge * all.diagonal() +
                         Eigen::VectorXd::Constant(p_, kRidge * kRidge);
    prior_gradient_.setZero(p_);
    const Eigen::VectorXd nominal = problem.model.NominalValues();
    for (Eigen::Index k = 0; k < p_ && problem.priors.size() > 0; ++k) {
      const int column = problem.free_columns[static_cast<std::size_t>(k)];
      const double prior = problem.priors[column];
      if (!std::isfinite(prior)) continue;
      const double weight = std::pow(kSmallerSigma / prior, 2);
      prior_information_[k] += weight;
      prior_gradient_[k] = weight * (values[column] - nominal[column]);
    }
  }

  // Just enough observations to determine all parameters, or, every other
  // time, half as many, the priors determining the rest.
  Subset Draw(int start, Random* random) const {
    const std::size_t enough = 1 + size() * static_cast<std::size_t>(p_) /
                                       static_cast<std::size_t>(rows_);
    const std::size_t count = start % 2 == 0 ? enough : enough / 2 + 1;
    Subset all(size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    for (std::size_t k = 0; k < count; ++k) {
      const double place =
          random->Uniform(static_cast<double>(k), static_cast<double>(size()));
      std::swap(all[k],
                all[std::min(size() - 1, static_cast<std::size_t>(place))]);
    }
    all.resize(count);
    return all;
  }

  Eigen::VectorXd Solve(const Subset& subset) const {
    Eigen::MatrixXd information = prior_information_.asDiagonal();
    Eigen::VectorXd gradient = prior_gradient_;
    for (const std::size_t i : subset) {
      const LinearObservation& one = observations_[i];
      information += one.information;
      gradient.noalias() += one.jacobian.transpose() * one.residual;
    }
    // Angles and lengths differ in size.
    const Eigen::VectorXd scale = information.diagonal().cwiseSqrt();
    const Eigen::VectorXd inverse = scale.cwiseInverse();
    const Eigen::MatrixXd scaled =
        inverse.asDiagonal() * information * inverse.asDiagonal();
    return -(inverse.asDiagonal() *
             scaled.ldlt().solve(inverse.cwiseProduct(gradient)));
  }

  std::vector<double> Norms(const Eigen::VectorXd& step) const {
    std::vector<double> norms;
    norms.reserve(size());
    for (const LinearObservation& one : observations_) {
      norms.push_back((one.residual + one.jacobian * step).norm() / one.unit);
    }
    return norms;
  }

  // The half that a step leaves the smallest residuals.
  Subset Closest(const Eigen::VectorXd& step) const {
    const std::vector<double> norms = Norms(step);
    Subset all(size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    std::nth_element(
        all.begin(), all.begin() + static_cast<std::ptrdiff_t>(Half() - 1),
        all.end(), [&norms](std::size_t a, std::size_t b) {
          return norms[a] != norms[b] ? norms[a] < norms[b] : a < b;
        });
    all.resize(Half());
    std::sort(all.begin(), all.end());
    return all;
  }

  Candidate Concentrate(Subset subset, int steps) const {
    Candidate candidate;
    for (int k = 0; k <= steps; ++k) {
      const Eigen::VectorXd step = Solve(subset);
      if (!step.allFinite()) return candidate;
      Subset next = Closest(step);
      const std::vector<double> norms = Norms(step);
      double objective = 0.0;
      for (const std::size_t i : next) objective += norms[i] * norms[i];
      if (objective < candidate.objective) candidate = {step, objective};
      if (next == subset) break;
      subset = std::move(next);
    }
    return candidate;
  }

  const Eigen::Index p_;
  Eigen::Index rows_ = 0;
  std::vector<LinearObservation> observations_;
  Eigen::VectorXd prior_information_;
  Eigen::VectorXd prior_gradient_;
};

}  // namespace

std::optional<TrimmedFit> FitTrimmed(const CalibrationProblem& problem,
                                     const Eigen::VectorXd& values) {
  const Search search(problem, values);
  if (!search.IsDetermined()) return std::nullopt;
  const Candidate best = search.Run();
  const double before = search.Scale(Eigen::VectorXd::Zero(
      static_cast<Eigen::Index>(problem.free_columns.size())));
  if (!std::isfinite(best.objective) || !(before > 0.0)) return std::nullopt;
  TrimmedFit fit{values, search.Scale(best.step) / before};
  for (std::size_t k = 0; k < problem.free_columns.size(); ++k) {
    fit.values[problem.free_columns[k]] +=
        best.step[static_cast<Eigen::Index>(k)];
  }
  return fit;
}

}  // namespace alidade::internal
