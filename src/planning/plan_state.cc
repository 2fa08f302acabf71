#include "src/planning/plan_state.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "src/common/parallel.h"

namespace alidade::internal {
namespace {

// Below this part of a pose's information that others do not have, an update
// has lost half of its digits.
constexpr double kSmallestPivot = 1e-8;

// det(I + A) of a symmetric positive semidefinite m x m matrix, by Cholesky's
// decomposition in place. `a` holds its columns.
double DetPlusIdentity(int m, double* a) {
  double determinant = 1.0;
  for (int k = 0; k < m; ++k) {
    double pivot = 1.0 + a[k * m + k];
    for (int i = 0; i < k; ++i) pivot -= a[i * m + k] * a[i * m + k];
    determinant *= pivot;
    const double root = 1.0 / std::sqrt(pivot);
    for (int row = k + 1; row < m; ++row) {
      double entry = a[k * m + row];
      for (int i = 0; i < k; ++i) entry -= a[i * m + k] * a[i * m + row];
      a[k * m + row] = entry * root;
    }
  }
  return determinant;
}

// The same for the usual three rows.
double DetPlusIdentity3(const double* a) {
  const double xx = 1.0 + a[0], yy = 1.0 + a[4], zz = 1.0 + a[8];
  const double xy = a[1], xz = a[2], yz = a[5];
  return xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) +
         xz * (xy * yz - yy * xz);
}

// Adds sign * P^T P to an m x m matrix `sum`. P has `num_rows` rows; both are
// by columns, those of P `stride` apart. Of so few rows and columns, Eigen's
// expressions would take longer than their products.
void AddGram(double sign, Eigen::Index num_rows, Eigen::Index m,
             const double* p, Eigen::Index stride, double* sum) {
  for (Eigen::Index j = 0; j < m; ++j) {
    for (Eigen::Index i = 0; i <= j; ++i) {
      double dot = 0.0;
      for (Eigen::Index k = 0; k < num_rows; ++k) {
        dot += p[i * stride + k] * p[j * stride + k];
      }
      sum[j * m + i] += sign * dot;
      if (i != j) sum[i * m + j] += sign * dot;
    }
  }
}

// The indices of the `count` largest scores among `indices`, largest first;
// ties in the order of the indices.
std::vector<int> Largest(const Eigen::VectorXd& scores,
                         std::vector<int> indices, int count) {
  const auto wanted = std::min<std::ptrdiff_t>(
      count, static_cast<std::ptrdiff_t>(indices.size()));
  std::partial_sort(indices.begin(), indices.begin() + wanted, indices.end(),
                    [&](int a, int b) {
                      return scores[a] != scores[b] ? scores[a] > scores[b]
                                                    : a < b;
                    });
  indices.resize(wanted);
  return indices;
}

}  // namespace

PlanState::PlanState(const DesignProblem& problem, const DesignOptions& options,
                     double ridge, std::vector<int> chosen)
    : problem_(problem),
      options_(options),
      rows_each_(problem.candidates.rows_each),
      chosen_(std::move(chosen)),
      information_(problem.known + InformationOf(problem.candidates, chosen_)) {
  information_.diagonal().array() += ridge;
  if (!options.allow_repeats || problem.minimum_motion.size() > 0) {
    conflicts_.assign(problem.candidates.size(), 0);
  }
  for (const int candidate : chosen_) Count(candidate, 1);
  Refresh();
}

void PlanState::Refresh() {
  const Eigen::Index p = information_.rows();
  const Eigen::LLT<Eigen::MatrixXd> cholesky(information_);
  const Eigen::MatrixXd root =
      cholesky.matrixL().solve(Eigen::MatrixXd::Identity(p, p));
  inverse_ = root.transpose() * root;
  const PoseRows& rows = problem_.candidates;
  variances_.resize(rows_each_, rows.transposed.cols());
  const auto work = [&](std::int64_t begin, std::int64_t end) {
    const Eigen::Index first = begin * rows_each_;
    const Eigen::MatrixXd halves =
        root * rows.transposed.middleCols(first, (end - begin) * rows_each_);
    for (std::int64_t k = begin; k < end; ++k) {
      const auto half = halves.middleCols(k * rows_each_ - first, rows_each_);
      variances_.middleCols(k * rows_each_, rows_each_).noalias() =
          half.transpose().lazyProduct(half);
    }
  };
  ParallelFor(options_.num_threads, rows.size(), kCandidatesPerBlock, work);
}

Eigen::MatrixXd PlanState::UpdateOf(int candidate, double sign,
                                    double* pivot) const {
  const Eigen::MatrixXd rows = problem_.candidates.Pose(candidate);
  const Eigen::MatrixXd solved = inverse_ * rows;
  Eigen::MatrixXd middle = sign * rows.transpose() * solved;
  middle.diagonal().array() += 1.0;
  const Eigen::LLT<Eigen::MatrixXd> cholesky(middle);
  *pivot = cholesky.info() == Eigen::Success
               ? cholesky.matrixLLT().diagonal().array().square().minCoeff()
               : 0.0;
  return cholesky.matrixL().solve(solved.transpose()).transpose();
}

void PlanState::Change(int candidate, double sign) {
  const auto rows = problem_.candidates.Pose(candidate);
  double pivot = 0.0;
  const Eigen::MatrixXd update = UpdateOf(candidate, sign, &pivot);
  information_ += sign * rows * rows.transpose();
  if (!(pivot > kSmallestPivot)) {
    Refresh();
    return;
  }
  inverse_ -= sign * update * update.transpose();
  const Eigen::MatrixXd& all = problem_.candidates.transposed;
  const auto work = [&](std::int64_t begin, std::int64_t end) {
    const Eigen::Index first = begin * rows_each_;
    const Eigen::MatrixXd products =
        update.transpose() * all.middleCols(first, (end - begin) * rows_each_);
    for (std::int64_t k = begin; k < end; ++k) {
      AddGram(-sign, products.rows(), rows_each_,
              products.col(k * rows_each_ - first).data(), products.rows(),
              variances_.col(k * rows_each_).data());
    }
  };
  ParallelFor(options_.num_threads, problem_.candidates.size(),
              kCandidatesPerBlock, work);
}

bool PlanState::Conflicts(int candidate, int other) const {
  if (!options_.allow_repeats && candidate == other) return true;
  if (problem_.minimum_motion.size() == 0) return false;
  return ((problem_.joint_values.col(candidate) -
           problem_.joint_values.col(other))
              .cwiseAbs()
              .array() < problem_.minimum_motion.array())
      .all();
}

void PlanState::Count(int candidate, int change) {
  for (std::size_t k = 0; k < conflicts_.size(); ++k) {
    if (Conflicts(static_cast<int>(k), candidate)) conflicts_[k] += change;
  }
}

bool PlanState::IsAllowed(int candidate, int place) const {
  if (conflicts_.empty()) return true;
  const int own = place >= 0 && Conflicts(candidate, chosen_[place]) ? 1 : 0;
  return conflicts_[candidate] == own;
}

void PlanState::Add(int candidate) {
  chosen_.push_back(candidate);
  Count(candidate, 1);
  Change(candidate, 1.0);
}

// First the new pose, then the old one goes: M stays regular.
void PlanState::Replace(int place, int candidate) {
  Count(chosen_[place], -1);
  Count(candidate, 1);
  Change(candidate, 1.0);
  Change(chosen_[place], -1.0);
  chosen_[place] = candidate;
}

BestCandidate PlanState::BestAddition() const {
  return BestBy(Eigen::MatrixXd(information_.rows(), 0), -1);
}

BestCandidate PlanState::BestReplacement(int place) const {
  double pivot = 0.0;
  const Eigen::MatrixXd removal = UpdateOf(chosen_[place], -1.0, &pivot);
  if (!(pivot > kSmallestPivot)) return {};
  BestCandidate best = BestBy(removal, place);
  best.gain /= OwnGain(place, removal);
  return best;
}

// It is 1 / det(I - V_i) too, which loses digits.
double PlanState::OwnGain(int place, const Eigen::MatrixXd& removal) const {
  const auto rows = problem_.candidates.Pose(chosen_[place]);
  Eigen::MatrixXd without =
      rows.transpose() * (inverse_ + removal * removal.transpose()) * rows;
  return DetPlusIdentity(rows_each_, without.data());
}

// The places of the plan, the pose of each taken out in turn.
struct PlanState::Vacancies {
  struct Vacancy {
    int place = 0;
    double wanted = 0.0;          // what det(I + V_k') must be above
    double smallest_trace = 0.0;  // which no V_k' below can be
  };
  std::vector<Vacancy> all;
  Eigen::MatrixXd removals;  // U^T of each, one below the other
};

PlanState::Vacancies PlanState::TakeOut(double smallest_gain) const {
  Vacancies vacancies;
  const auto places = static_cast<int>(chosen_.size());
  const Eigen::Index m = rows_each_;
  vacancies.removals.resize(places * m, information_.rows());
  Eigen::Index rows = 0;
  for (int place = 0; place < places; ++place) {
    double pivot = 0.0;
    const Eigen::MatrixXd removal = UpdateOf(chosen_[place], -1.0, &pivot);
    if (!(pivot > kSmallestPivot)) continue;
    const double wanted = OwnGain(place, removal) * std::exp(smallest_gain);
    const double mean = std::pow(wanted, 1.0 / rows_each_);
    vacancies.all.push_back({place, wanted, rows_each_ * (mean - 1.0)});
    vacancies.removals.middleRows(rows, m) = removal.transpose();
    rows += m;
  }
  vacancies.removals.conservativeResize(rows, Eigen::NoChange);
  return vacancies;
}

// `products`: the removals times the candidate's rows.
bool PlanState::Improves(
    int candidate, const Vacancies& vacancies,
    const Eigen::Ref<const Eigen::MatrixXd>& products) const {
  const Eigen::Index m = rows_each_;
  const auto own = variances_.middleCols(candidate * m, m);
  const double trace = own.trace();
  Eigen::MatrixXd variance;
  for (std::size_t i = 0; i < vacancies.all.size(); ++i) {
    const Vacancies::Vacancy& vacancy = vacancies.all[i];
    const auto product =
        products.middleRows(static_cast<Eigen::Index>(i) * m, m);
    if (trace + product.squaredNorm() < vacancy.smallest_trace) continue;
    variance = own;
    AddGram(1.0, m, m, product.data(), products.outerStride(), variance.data());
    if (DetPlusIdentity(rows_each_, variance.data()) > vacancy.wanted &&
        IsAllowed(candidate, vacancy.place)) {
      return true;
    }
  }
  return false;
}

std::vector<int> PlanState::Improving(double smallest_gain) const {
  // Products of so many stay in the second-level cache.
  constexpr std::int64_t kBlock = 32;
  const Vacancies vacancies = TakeOut(smallest_gain);
  const int count = problem_.candidates.size();
  const Eigen::Index m = rows_each_;
  std::vector<char> improves(count, 0);
  const auto work = [&](std::int64_t begin, std::int64_t end) {
    const Eigen::MatrixXd products =
        vacancies.removals *
        problem_.candidates.transposed.middleCols(begin * m, (end - begin) * m);
    for (std::int64_t k = begin; k < end; ++k) {
      improves[k] = Improves(static_cast<int>(k), vacancies,
                             products.middleCols((k - begin) * m, m));
    }
  };
  ParallelFor(options_.num_threads, count, kBlock, work);
  std::vector<int> found;
  for (int k = 0; k < count; ++k) {
    if (improves[k] != 0) found.push_back(k);
  }
  return found;
}

// The largest det(I + V_k + (J_k U)(J_k U)^T), U of the pose that is taken
// out.
BestCandidate PlanState::BestBy(const Eigen::MatrixXd& removal,
                                int place) const {
  const Eigen::MatrixXd& all = problem_.candidates.transposed;
  const int count = problem_.candidates.size();
  std::vector<BestCandidate> bests((count + kCandidatesPerBlock - 1) /
                                   kCandidatesPerBlock);
  const Eigen::Index m = rows_each_;
  const auto work = [&](std::int64_t begin, std::int64_t end) {
    BestCandidate& best = bests[begin / kCandidatesPerBlock];
    const Eigen::MatrixXd products =
        removal.transpose() * all.middleCols(begin * m, (end - begin) * m);
    Eigen::MatrixXd variance(m, m);
    for (std::int64_t k = begin; k < end; ++k) {
      const double* own = variances_.col(k * m).data();
      std::copy(own, own + m * m, variance.data());
      AddGram(1.0, products.rows(), m, products.col((k - begin) * m).data(),
              products.rows(), variance.data());
      const double gain = m == 3 ? DetPlusIdentity3(variance.data())
                                 : DetPlusIdentity(rows_each_, variance.data());
      if (gain > best.gain && IsAllowed(static_cast<int>(k), place)) {
        best = {gain, static_cast<int>(k)};
      }
    }
  };
  ParallelFor(options_.num_threads, count, kCandidatesPerBlock, work);
  BestCandidate best;
  for (const BestCandidate& block : bests) {
    if (block.gain > best.gain) best = block;
  }
  return best;
}

std::vector<int> PlanState::Shortlist(const DesignSlope& slope, int place,
                                      int count) const {
  const Eigen::MatrixXd& all = problem_.candidates.transposed;
  const Eigen::Index m = rows_each_;
  const int size = problem_.candidates.size();
  Eigen::VectorXd scores(size);
  const auto work = [&](std::int64_t begin, std::int64_t end) {
    const Eigen::MatrixXd products =
        slope.factor.transpose() * all.middleCols(begin * m, (end - begin) * m);
    const Eigen::RowVectorXd rows =
        slope.weights.transpose() * products.cwiseAbs2();
    for (std::int64_t k = begin; k < end; ++k) {
      scores[k] = rows.segment((k - begin) * m, m).sum();
    }
  };
  ParallelFor(options_.num_threads, size, kCandidatesPerBlock, work);
  std::vector<int> allowed;
  for (int k = 0; k < size; ++k) {
    if (IsAllowed(k, place)) allowed.push_back(k);
  }
  return Largest(scores, std::move(allowed), count);
}

std::vector<int> PlanState::MostInformative(int count) const {
  const int size = problem_.candidates.size();
  Eigen::VectorXd gains(size);
  std::vector<int> all(size);
  std::iota(all.begin(), all.end(), 0);
  for (const int k : all) {
    Eigen::MatrixXd variance =
        variances_.middleCols(Eigen::Index{rows_each_} * k, rows_each_);
    gains[k] = DetPlusIdentity(rows_each_, variance.data());
  }
  std::vector<int> chosen = Largest(gains, std::move(all), count);
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

}  // namespace alidade::internal
