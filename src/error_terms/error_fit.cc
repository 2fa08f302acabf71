#include "src/error_terms/error_fit.h"

#include <algorithm>
#include <utility>

#include "src/kernel/holdout.h"

namespace alidade::internal {
namespace {

// Linearisations: about the geometric fit, then about the result.
constexpr int kOuterIterations = 2;

class ErrorFitter {
 public:
  explicit ErrorFitter(const ErrorFitInput& input)
      : input_(input), fits_(input) {}

  ErrorFit Run() {
    fits_.ChooseScales();
    std::vector<std::pair<std::size_t, RungFit>> dropped;
    if (input_.selects) {
      dropped = fits_.DropWithoutEvidence();
      fits_.LeaveOut(0);
      TryHarmonics();
      fit_.stacking = StackOf(fits_.fold_errors());
    } else {
      fit_.stacking.weights =
          Eigen::VectorXd::Unit(static_cast<Eigen::Index>(fits_.rungs().size()),
                                fits_.rungs().size() - 1);
      fit_.stacking.share = 1.0;
    }
    for (std::size_t k = 0; k < fits_.rungs().size(); ++k) {
      fits_.rungs()[k].weight = WeightOf(k, fit_.stacking.share);
    }
    Blend();
    if (fit_.stacking.share > 0.0 || fits_.rungs().front().columns.size() > 0) {
      for (int outer = 1; outer < kOuterIterations; ++outer) {
        fits_.MoveTo(values_, terms_);
        Blend();
      }
      Finish();
    } else {
      fit_.jump = FindJump(fits_.LeftBy(0));
      fit_.values = input_.values;
    }
    fit_.weights = fits_.weights();
    fit_.rungs = fits_.rungs();
    for (auto& [place, rung] : dropped) {
      fit_.rungs.insert(fit_.rungs.begin() + static_cast<std::ptrdiff_t>(place),
                        std::move(rung));
    }
    return std::move(fit_);
  }

 private:
  void Finish() {
    terms_.load_geometry = fits_.LoadGeometryAt(values_, &terms_.load_target);
    fit_.values = values_;
    fit_.terms = terms_;
    fit_.jump = FindJump(fits_.LeftByEstimate());
    fit_.covariance = JointCovariance();
  }

  std::size_t Best() const {
    return static_cast<std::size_t>(
        std::min_element(fits_.rungs().begin(), fits_.rungs().end(),
                         [](const RungFit& a, const RungFit& b) {
                           return a.random_error < b.random_error;
                         }) -
        fits_.rungs().begin());
  }

  std::vector<FoundHarmonic> HarmonicsLeftBy(std::size_t rung) const {
    const Eigen::VectorXd residuals = -fits_.LeftBy(rung);
    std::vector<bool> is_revolute;
    for (const Joint& joint : fits_.arm().joints) {
      is_revolute.push_back(joint.type == JointType::kRevolute);
    }
    return FindHarmonics(fits_.Data(), residuals, is_revolute,
                         input_.model.num_threads());
  }

  // Another rung: the best one with the harmonics that it lacks; and again,
  // since weaker ones show when the strongest are gone.
  void TryHarmonics() {
    constexpr int kRounds = 3;
    for (int round = 0; round < kRounds; ++round) {
      const std::size_t best = Best();
      const std::vector<FoundHarmonic> found = HarmonicsLeftBy(best);
      if (found.empty()) return;
      TermSet set = fits_.rungs()[best].set;
      if (round == 0) set.name += " + gear harmonics";
      for (const FoundHarmonic& harmonic : found) {
        set.joint_cycles.emplace_back(harmonic.joint, harmonic.cycles);
      }
      fit_.harmonics.insert(fit_.harmonics.end(), found.begin(), found.end());
      fits_.AddRung(set, best, round > 0);
      if (Best() + 1 != fits_.rungs().size()) return;
    }
  }

  // Of folds that have nothing left (all of their observations were rejected)
  // there is nothing to learn.
  StackingResult StackOf(std::vector<FoldErrors> folds) const {
    folds.erase(std::remove_if(folds.begin(), folds.end(),
                               [](const FoldErrors& fold) {
                                 return fold.residuals.empty();
                               }),
                folds.end());
    if (!folds.empty()) return Stack(folds);
    StackingResult none;
    none.weights = Eigen::VectorXd::Unit(
        static_cast<Eigen::Index>(fits_.rungs().size()), 0);
    return none;
  }

  std::optional<BaseJump> FindJump(const Eigen::VectorXd& left) const {
    if (!fits_.arm().errors.covariates.empty()) return std::nullopt;
    return FindBaseJump(fits_.Data(), left);
  }

  // geometry + share (stack - geometry), which is linear in all coefficients.
  void Blend() {
    const double share = fit_.stacking.share;
    const TermColumns all = UnionOfColumns();
    Eigen::VectorXd coefficients = Eigen::VectorXd::Zero(all.size());
    Eigen::VectorXd step =
        Eigen::VectorXd::Zero(static_cast<Eigen::Index>(input_.columns.size()));
    for (std::size_t k = 0; k < fits_.rungs().size(); ++k) {
      const RungFit& rung = fits_.rungs()[k];
      const double weight = WeightOf(k, share);
      step += weight * fits_.solution(k).geometry;
      coefficients +=
          weight * (all.From(rung.columns) * fits_.solution(k).terms);
      fits_.Describe(k);
    }
    values_ = fits_.Moved(step);
    terms_ = all.TermsOf(coefficients, fits_.terms(), fits_.arm().num_joints());
  }

  // Of a rung in what is delivered.
  double WeightOf(std::size_t k, double share) const {
    return share * fit_.stacking.weights[k] + (k == 0 ? 1.0 - share : 0.0);
  }

  TermColumns UnionOfColumns() const {
    std::vector<TermColumns> all;
    for (std::size_t k = 0; k < fits_.rungs().size(); ++k) {
      if (WeightOf(k, fit_.stacking.share) > 0.0) {
        all.push_back(fits_.rungs()[k].columns);
      }
    }
    return TermColumns::Union(all);
  }

  std::shared_ptr<const TermCovariance> JointCovariance() {
    std::vector<RungEstimate> estimates;
    for (std::size_t k = 0; k < fits_.rungs().size(); ++k) {
      const RungFit& rung = fits_.rungs()[k];
      estimates.push_back({rung.columns, fit_.stacking.weights[k]});
      const double weight = WeightOf(k, fit_.stacking.share);
      if (!(weight > 0.0)) continue;
      RungEstimate& estimate = estimates.back();
      const Eigen::MatrixXd inverse =
          fits_.RidgeOf(rung).Covariance(fits_.gram(k), rung.precisions);
      fit_.effective +=
          weight * fits_.gram(k)
                       .topLeftCorner(inverse.rows(), inverse.cols())
                       .cwiseProduct(inverse)
                       .sum();
      estimate.values.resize(inverse.rows());
      estimate.values << fits_.InUnits(rung.values),
          rung.columns.CoefficientsOf(rung.terms);
      estimate.covariance = rung.variance * inverse;
      const double prior =
          rung.PriorDeviation(TermGroup::kFunction) / kTermUnit;
      estimate.function_variance = prior * prior;
    }
    const TermColumns all = UnionOfColumns();
    std::shared_ptr<const TermCovariance> covariance =
        CovarianceOfStack(estimates, fit_.stacking.share, all, input_.columns);
    SetDeviations(*covariance);
    return covariance;
  }

  // Of functions less their means over the training poses: a constant is the
  // joint's zero as well, and one of both alone is hardly known.
  void SetDeviations(const TermCovariance& covariance) {
    const TermColumns& all = covariance.columns;
    const Eigen::MatrixXd root = covariance.root.bottomRows(all.size());
    const TermRows& rows = fits_.Data().rows;
    Eigen::VectorXd shares = Eigen::VectorXd::Zero(all.size());
    const auto poses = static_cast<int>(rows.joint_values.cols());
    for (int pose = 0; pose < poses; ++pose) {
      all.ForEachAt(rows.NumbersOf(pose),
                    [&](int column, int /*turn*/, double size) {
                      shares[column] += size / poses;
                    });
    }
    for (const FunctionKnots& knots : all.functions()) {
      const int first = all.num_dense() + knots.offset;
      const auto own = root.middleRows(first, knots.count);
      const Eigen::RowVectorXd mean =
          shares.segment(first, knots.count).transpose() * own;
      fit_.terms.joints[knots.joint].function.deviations =
          kTermUnit * (own.rowwise() - mean).rowwise().norm();
    }
  }

  const ErrorFitInput& input_;
  RungFits fits_;
  Eigen::VectorXd values_;
  ErrorTerms terms_;
  ErrorFit fit_;
};

}  // namespace

std::optional<ErrorFit> FitErrorTerms(const ErrorFitInput& input) {
  const std::vector<int> groups = GroupByConfiguration(input.data);
  const int count =
      groups.empty() ? 0 : *std::max_element(groups.begin(), groups.end()) + 1;
  if (input.selects && count < kFewestForErrorTerms) return std::nullopt;
  return ErrorFitter(input).Run();
}

}  // namespace alidade::internal
