#include "src/uncertainty/residual_structure.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "src/common/distributions.h"
#include "src/common/scaled_eigensystem.h"

namespace alidade::internal {
namespace {

constexpr double kSignificant = 0.005;
constexpr double kWorthAWord = 0.02;
constexpr double kFewestLeft = 10.0;
constexpr int kMostFound = 8;
// Of squared norms: what is left of a column beside others is rounding.
constexpr double kDependent = 1e-6;

// P^-1 of the free columns.
Eigen::VectorXd PriorPrecisions(const FittedProblem& fit) {
  return FreePriors(fit).array().square().inverse();
}

}  // namespace

StructureFit::StructureFit(const FittedProblem& fit, const ResidualGram& gram)
    : gram_(gram), p_(static_cast<Eigen::Index>(fit.free_columns.size())) {
  constexpr double kNotDetermined = 1e-12;
  all_ = gram.products[kLengths];
  if (gram.products[kRotations].size() > 0) all_ += gram.products[kRotations];
  const Eigen::Index m = all_.rows() - p_ - 1;
  const Eigen::VectorXd prior = PriorPrecisions(fit);
  const Eigen::VectorXd deviations =
      fit.values(fit.free_columns) -
      fit.model.NominalValues()(fit.free_columns);
  Eigen::MatrixXd information = all_.topLeftCorner(p_, p_);
  information.diagonal() += prior;
  int rank = 0;
  inverse_ =
      ScaledEigensystem(information).PseudoInverse(kNotDetermined, &rank);
  const Eigen::MatrixXd jz = all_.block(0, p_, p_, m);
  b_ = all_.col(p_ + m).head(p_) + prior.cwiseProduct(deviations);
  schur_ = all_.block(p_, p_, m, m) - jz.transpose() * inverse_ * jz;
  right_ = all_.col(p_ + m).segment(p_, m) - jz.transpose() * (inverse_ * b_);
  norms_ = all_.diagonal().segment(p_, m);
  for (const int which : {kLengths, kRotations}) {
    squares_ += Squares(which);
    freedom_ += Freedom(which);
  }
}

double StructureFit::Squares(int which) const {
  const Eigen::MatrixXd& products = gram_.products[which];
  if (products.size() == 0) return 0.0;
  const Eigen::Index m = right_.size();
  Eigen::VectorXd moved = Eigen::VectorXd::Zero(p_ + m + 1);
  moved[p_ + m] = 1.0;
  Eigen::VectorXd b = b_;
  if (!added_.empty()) {
    int rank = 0;
    const Eigen::MatrixXd jz = all_.block(0, p_, p_, m)(Eigen::all, added_);
    const Eigen::MatrixXd whole = all_.block(p_, p_, m, m)(added_, added_) -
                                  jz.transpose() * inverse_ * jz;
    const Eigen::VectorXd right = all_.col(p_ + m).segment(p_, m)(added_) -
                                  jz.transpose() * (inverse_ * b_);
    const Eigen::VectorXd found =
        ScaledEigensystem(whole).PseudoInverse(kDependent, &rank) * right;
    b -= jz * found;
    moved.segment(p_, m)(added_) = -found;
  }
  moved.head(p_) = -(inverse_ * b);
  return std::max(0.0, moved.dot(products * moved));
}

double StructureFit::Freedom(int which) const {
  const Eigen::MatrixXd& products = gram_.products[which];
  if (products.size() == 0) return 0.0;
  const double rows = gram_.rows[kLengths] + gram_.rows[kRotations];
  return gram_.rows[which] -
         inverse_.cwiseProduct(products.topLeftCorner(p_, p_)).sum() -
         rank_added_ * gram_.rows[which] / rows;
}

std::vector<int> StructureFit::Independent(
    const std::vector<int>& columns) const {
  // Of a joint that moves no target there is rounding alone.
  constexpr double kNothing = 1e-16;
  const double nothing = kNothing * norms_.maxCoeff();
  std::vector<int> kept;
  for (const int c : columns) {
    if (norms_[c] > nothing && schur_(c, c) > kDependent * norms_[c]) {
      kept.push_back(c);
    }
  }
  return kept;
}

StructureFit::Gain StructureFit::GainOf(const std::vector<int>& columns) const {
  const std::vector<int> kept = Independent(columns);
  Gain gain;
  const Eigen::VectorXd right = right_(kept);
  const Eigen::MatrixXd inverse = ScaledEigensystem(schur_(kept, kept))
                                      .PseudoInverse(kDependent, &gain.rank);
  gain.squares = kept.empty() ? 0.0 : right.dot(inverse * right);
  return gain;
}

void StructureFit::AddColumns(const std::vector<int>& columns) {
  const std::vector<int> kept = Independent(columns);
  if (kept.empty()) return;
  int rank = 0;
  const Eigen::MatrixXd inverse =
      ScaledEigensystem(schur_(kept, kept)).PseudoInverse(kDependent, &rank);
  const Eigen::MatrixXd across = schur_(Eigen::all, kept) * inverse;
  const Eigen::VectorXd right = right_(kept);
  squares_ -= right.dot(inverse * right);
  right_ -= across * right;
  schur_ -= across * schur_(kept, Eigen::all).eval();
  freedom_ -= rank;
  rank_added_ += rank;
  added_.insert(added_.end(), kept.begin(), kept.end());
}

namespace {

class Search {
 public:
  Search(const std::vector<StructureFamily>& families, StructureFit* fit)
      : families_(families), fit_(fit), is_found_(families.size(), false) {}

  std::vector<StructureTest> Run() {
    const double all = fit_->AllSquares();
    std::vector<StructureTest> found;
    std::vector<StructureTest> first;
    while (found.size() < kMostFound) {
      const std::vector<StructureTest> tests = TestAll(all);
      if (first.empty()) first = tests;
      const int best = Strongest(tests);
      if (best < 0) break;
      StructureTest test = tests[static_cast<std::size_t>(best)];
      test.is_found = true;
      found.push_back(test);
      is_found_[static_cast<std::size_t>(best)] = true;
      fit_->AddColumns(families_[static_cast<std::size_t>(best)].columns);
    }
    std::vector<StructureTest> others;
    for (std::size_t k = 0; k < first.size(); ++k) {
      if (!is_found_[k] && first[k].degrees_of_freedom > 0.0) {
        others.push_back(first[k]);
      }
    }
    std::stable_sort(others.begin(), others.end(),
                     [](const StructureTest& a, const StructureTest& b) {
                       return a.p_value < b.p_value;
                     });
    found.insert(found.end(), others.begin(), others.end());
    return found;
  }

 private:
  // Of all families, those found before as well; `all`: the squares of which a
  // part is explained.
  std::vector<StructureTest> TestAll(double all) {
    std::vector<StructureTest> tests;
    evidence_.clear();
    for (const StructureFamily& family : families_) {
      StructureTest test;
      test.kind = family.kind;
      test.joint = family.joint;
      test.covariate = family.covariate;
      const StructureFit::Gain gain = fit_->GainOf(family.columns);
      const double rest = fit_->AllSquares() - gain.squares;
      const double freedom = fit_->AllFreedom() - gain.rank;
      double evidence = 0.0;
      if (gain.rank > 0 && freedom >= kFewestLeft && rest > 0.0) {
        test.degrees_of_freedom = gain.rank;
        test.statistic = gain.squares / gain.rank / (rest / freedom);
        test.p_value = FisherSurvival(test.statistic, gain.rank, freedom);
        test.explained = gain.squares / all;
        const double n = fit_->AllFreedom();
        evidence =
            n * std::log(fit_->AllSquares() / rest) - gain.rank * std::log(n);
      }
      tests.push_back(test);
      evidence_.push_back(evidence);
    }
    CorrectForMany(&tests);
    return tests;
  }

  // Holm 1979, "A simple sequentially rejective multiple test procedure".
  static void CorrectForMany(std::vector<StructureTest>* tests) {
    std::vector<std::size_t> order;
    for (std::size_t k = 0; k < tests->size(); ++k) {
      if ((*tests)[k].degrees_of_freedom > 0.0) order.push_back(k);
    }
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) {
                       return (*tests)[a].p_value < (*tests)[b].p_value;
                     });
    double least = 0.0;
    for (std::size_t k = 0; k < order.size(); ++k) {
      double& p = (*tests)[order[k]].p_value;
      least = std::max(
          least, std::min(1.0, p * static_cast<double>(order.size() - k)));
      p = least;
    }
  }

  int Strongest(const std::vector<StructureTest>& tests) const {
    int best = -1;
    for (std::size_t k = 0; k < tests.size(); ++k) {
      const StructureTest& test = tests[k];
      if (is_found_[k] || !(test.p_value < kSignificant) ||
          test.explained < kWorthAWord) {
        continue;
      }
      if (best < 0 ||
          evidence_[k] > evidence_[static_cast<std::size_t>(best)]) {
        best = static_cast<int>(k);
      }
    }
    return best;
  }

  const std::vector<StructureFamily>& families_;
  StructureFit* const fit_;
  std::vector<bool> is_found_;
  std::vector<double> evidence_;
};

}  // namespace

std::vector<StructureTest> FindStructure(
    const std::vector<StructureFamily>& families, StructureFit* fit) {
  if (!(fit->AllSquares() > 0.0)) return {};
  return Search(families, fit).Run();
}

}  // namespace alidade::internal
