#include "src/error_terms/error_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "src/common/distributions.h"
#include "src/common/parallel.h"
#include "src/error_terms/folds.h"
#include "src/kernel/holdout.h"

namespace alidade::internal {
namespace {

// Linearisations: about the geometric fit, then about the result.
constexpr int kOuterIterations = 2;
constexpr int kReweightings = 3;

std::vector<int> AllOf(const TermRows& rows) {
  std::vector<int> all(rows.observations.size());
  std::iota(all.begin(), all.end(), 0);
  return all;
}

// What is left of an observation with a rung's estimate.
Eigen::VectorXd Left(const TermRows& rows, const TermColumns& columns,
                     const TermSolution& solution,
                     const TermRows::Observation& one) {
  return rows.residuals.segment(one.first_row, one.height) +
         rows.geometry.middleRows(one.first_row, one.height) *
             solution.geometry +
         ApplyTerms(rows, columns, solution.terms, one);
}

// Of each covariate that varies, none yet.
std::vector<CovariateEffect> EffectsOf(const Dataset& data) {
  std::vector<CovariateEffect> effects;
  for (std::size_t k = 0; k < data.covariate_names.size(); ++k) {
    const auto row = data.covariates.map().row(static_cast<Eigen::Index>(k));
    if (row.maxCoeff() > row.minCoeff()) {
      effects.push_back({data.covariate_names[k], row.mean()});
    }
  }
  return effects;
}

class ErrorFitter {
 public:
  explicit ErrorFitter(const ErrorFitInput& input)
      : input_(input),
        arm_(input.model.nominal()),
        folds_(MakeTrainingFolds(input.data)),
        values_(input.values) {
    arm_.errors.Clear();
    arm_.errors.covariates = EffectsOf(input.data);
    terms_ = arm_.errors;
    std::vector<TermSet> sets = input.sets;
    sets.insert(sets.begin(), TermSet{"geometry"});
    for (TermSet& set : sets) {
      fit_.rungs.push_back(
          {set, TermColumns(arm_, set, input.data.joint_values.map(),
                            Deviations())});
    }
  }

  std::optional<ErrorFit> Run() {
    Linearize();
    weights_.setOnes(static_cast<Eigen::Index>(rows_.observations.size()));
    if (!input_.losses.empty()) Reweight();
    ChooseScales();
    if (!input_.selects) {
      fit_.stacking.weights = Eigen::VectorXd::Unit(
          static_cast<Eigen::Index>(fit_.rungs.size()), fit_.rungs.size() - 1);
      fit_.stacking.share = 1.0;
    } else {
      LeaveOut(0);
      TryHarmonics();
      fit_.stacking = StackOf(fold_errors_);
    }
    for (std::size_t k = 0; k < fit_.rungs.size(); ++k) {
      fit_.rungs[k].weight = fit_.stacking.weights[k];
    }
    Blend();
    if (!(fit_.stacking.share > 0.0)) {
      fit_.jump = FindJump(LeftBy(0));
      fit_.values = input_.values;
      return std::move(fit_);
    }
    for (int outer = 1; outer < kOuterIterations; ++outer) {
      Linearize();
      if (!input_.losses.empty()) WeighBy(SquaresOf(LeftByStack()));
      SolveAll();
      Blend();
    }
    terms_.load_geometry = GeometryAt(values_, &terms_.load_target);
    fit_.values = values_;
    fit_.terms = terms_;
    fit_.weights = weights_;
    fit_.jump = FindJump(LeftByStack());
    fit_.covariance = JointCovariance();
    return std::move(fit_);
  }

 private:
  // Of the covariates about their references.
  Eigen::VectorXd Deviations() const {
    const Dataset& data = input_.data;
    Eigen::VectorXd deviations(
        static_cast<Eigen::Index>(arm_.errors.covariates.size()));
    deviations.setZero();
    for (int pose = 0; pose < data.num_poses(); ++pose) {
      const Eigen::VectorXd values = CovariatesAt(data, arm_, pose);
      for (Eigen::Index k = 0; k < values.size(); ++k) {
        const double off =
            values[k] -
            arm_.errors.covariates[static_cast<std::size_t>(k)].reference;
        deviations[k] += off * off;
      }
    }
    return (deviations / static_cast<double>(data.num_poses())).cwiseSqrt();
  }

  Eigen::VectorXd InUnits(const Eigen::VectorXd& values) const {
    Eigen::VectorXd units(static_cast<Eigen::Index>(input_.columns.size()));
    for (Eigen::Index k = 0; k < units.size(); ++k) {
      units[k] = values[input_.columns[k]] / kTermUnit;
    }
    return units;
  }

  Eigen::VectorXd Priors() const {
    const double none = std::numeric_limits<double>::infinity();
    Eigen::VectorXd priors = Eigen::VectorXd::Constant(
        static_cast<Eigen::Index>(input_.columns.size()), none);
    if (input_.priors.size() == 0) return priors;
    const Eigen::VectorXd given = InUnits(input_.priors);
    for (Eigen::Index k = 0; k < priors.size(); ++k) {
      if (std::isfinite(given[k])) priors[k] = given[k];
    }
    return priors;
  }

  TermRidge RidgeOf(const RungFit& rung) const {
    return {rung.columns, InUnits(values_ - input_.model.NominalValues()),
            Priors()};
  }

  // Rows about the present estimate, with residuals as if there were no terms.
  void Linearize() {
    terms_.load_geometry = GeometryAt(values_, &terms_.load_target);
    arm_.errors = terms_;
    const MeasurementModel model(arm_, input_.model.references(),
                                 input_.model.execution());
    rows_ = MakeTermRows(model, values_, input_.data, input_.columns);
    if (!has_terms_) return;
    for (const TermRows::Observation& one : rows_.observations) {
      auto residual = rows_.residuals.segment(one.first_row, one.height);
      residual -= Bent(one, one.pose, rows_.turns);
      if (one.second_pose >= 0) {
        residual -= Bent(one, one.second_pose, rows_.second_turns);
      }
    }
  }

  // What the present terms add to the rows of an observation.
  Eigen::VectorXd Bent(const TermRows::Observation& one, int pose,
                       const TermRows::RowMatrix& turns) const {
    if (pose < 0) return Eigen::VectorXd::Zero(one.height);
    const PoseErrors errors =
        ErrorsAt(arm_, rows_.joint_values.col(pose).data(),
                 CovariatesAt(input_.data, arm_, pose).data());
    const Eigen::Index n = errors.shifts.size();
    Eigen::Matrix3Xd sizes(3, n + 2);
    sizes.topLeftCorner(2, n) = errors.tilts;
    sizes.row(2).head(n) = errors.shifts.transpose();
    sizes.rightCols<2>() = errors.base.reshaped(3, 2);
    return turns.middleRows(one.first_row, one.height) *
           (sizes.reshaped() / kTermUnit);
  }

  // Moments are those of the arm as it is fitted.
  Eigen::MatrixXd GeometryAt(const Eigen::VectorXd& values,
                             Eigen::Vector3d* target) const {
    const Arm fitted =
        input_.model.layout().WithValues(input_.model.nominal(), values);
    Eigen::MatrixXd geometry(5, fitted.num_joints());
    for (int j = 0; j < fitted.num_joints(); ++j) {
      const Joint& joint = fitted.joints[j];
      geometry.col(j) << joint.beta, joint.alpha, joint.d, joint.theta, joint.r;
    }
    *target = MeanTargetOf(fitted);
    return geometry;
  }

  double Equations() const {
    double sum = 0.0;
    for (std::size_t k = 0; k < rows_.observations.size(); ++k) {
      sum += weights_[k] * rows_.observations[k].num_measured;
    }
    return sum;
  }

  WeightedRows Data() const { return {rows_, weights_}; }

  void Solve(const TermRidge& ridge, std::size_t k) {
    RungFit& rung = fit_.rungs[k];
    solutions_[k] = ridge.Solve(grams_[k], rung.precisions);
    // Of exact data rounding may leave less than nothing.
    rung.variance = std::max(0.0, solutions_[k].cost) /
                    std::max(1.0, Equations() - ridge.num_geometry());
  }

  void Choose(std::size_t k, const LogPrecisions& from) {
    RungFit& rung = fit_.rungs[k];
    const TermRidge ridge = RidgeOf(rung);
    grams_[k] = TermGram(Data(), rung.columns, AllOf(rows_));
    rung.precisions = ridge.Choose(grams_[k], Equations(), from);
    Solve(ridge, k);
  }

  // Each rung's scales, and its estimate from all data. The elastic one starts
  // those that have it too.
  void ChooseScales() {
    grams_.resize(fit_.rungs.size());
    solutions_.resize(fit_.rungs.size());
    LogPrecisions start = {};
    const std::size_t first = std::min<std::size_t>(2, fit_.rungs.size());
    for (std::size_t k = 0; k < first; ++k) Choose(k, start);
    if (first == 2) start = fit_.rungs[1].precisions;
    ParallelFor(input_.model.num_threads(),
                static_cast<std::int64_t>(fit_.rungs.size() - first), 1,
                [&](std::int64_t begin, std::int64_t end) {
                  for (std::int64_t k = begin; k < end; ++k) {
                    Choose(first + static_cast<std::size_t>(k), start);
                  }
                });
  }

  std::size_t Best() const {
    return static_cast<std::size_t>(
        std::min_element(fit_.rungs.begin(), fit_.rungs.end(),
                         [](const RungFit& a, const RungFit& b) {
                           return a.random_error < b.random_error;
                         }) -
        fit_.rungs.begin());
  }

  std::vector<FoundHarmonic> HarmonicsLeftBy(std::size_t rung) const {
    const Eigen::VectorXd residuals = -LeftBy(rung);
    std::vector<bool> is_revolute;
    for (const Joint& joint : arm_.joints) {
      is_revolute.push_back(joint.type == JointType::kRevolute);
    }
    return FindHarmonics(Data(), residuals, is_revolute,
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
      TermSet set = fit_.rungs[best].set;
      if (round == 0) set.name += " + gear harmonics";
      for (const FoundHarmonic& harmonic : found) {
        set.joint_cycles.emplace_back(harmonic.joint, harmonic.cycles);
      }
      fit_.harmonics.insert(fit_.harmonics.end(), found.begin(), found.end());
      const LogPrecisions start = fit_.rungs[best].precisions;
      RungFit rung{set, TermColumns(arm_, set, input_.data.joint_values.map(),
                                    Deviations())};
      if (round == 0) {
        fit_.rungs.push_back(std::move(rung));
        grams_.emplace_back();
        solutions_.emplace_back();
      } else {
        fit_.rungs.back() = std::move(rung);
      }
      Choose(fit_.rungs.size() - 1, start);
      LeaveOut(fit_.rungs.size() - 1);
      if (Best() + 1 != fit_.rungs.size()) return;
    }
  }

  // The same scales at another linearisation.
  void SolveAll() {
    ParallelFor(input_.model.num_threads(),
                static_cast<std::int64_t>(fit_.rungs.size()), 1,
                [&](std::int64_t begin, std::int64_t end) {
                  for (std::int64_t k = begin; k < end; ++k) {
                    RungFit& rung = fit_.rungs[k];
                    const TermRidge ridge = RidgeOf(rung);
                    grams_[k] = TermGram(Data(), rung.columns, AllOf(rows_));
                    Solve(ridge, static_cast<std::size_t>(k));
                  }
                });
  }

  std::vector<int> LeftOut(const std::vector<bool>& poses) const {
    std::vector<int> left;
    for (std::size_t k = 0; k < rows_.observations.size(); ++k) {
      const TermRows::Observation& one = rows_.observations[k];
      if (one.pose < 0 || !(weights_[k] > 0.0)) continue;
      if (poses[one.pose]) left.push_back(static_cast<int>(k));
    }
    return left;
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
    none.weights =
        Eigen::VectorXd::Unit(static_cast<Eigen::Index>(fit_.rungs.size()), 0);
    return none;
  }

  // What the rungs from `first` on leave of every fold that they are fitted
  // without.
  void LeaveOut(std::size_t first) {
    fold_errors_.resize(folds_.left_out.size());
    ParallelFor(input_.model.num_threads(),
                static_cast<std::int64_t>(fold_errors_.size()), 1,
                [&](std::int64_t begin, std::int64_t end) {
                  for (std::int64_t f = begin; f < end; ++f) {
                    LeaveOut(first, static_cast<std::size_t>(f),
                             &fold_errors_[f]);
                  }
                });
    for (std::size_t k = first; k < fit_.rungs.size(); ++k) {
      std::array<double, 2> sums{};
      std::array<double, 2> counts{};
      for (const FoldErrors& fold : fold_errors_) {
        for (const Eigen::MatrixXd& residual : fold.residuals) {
          const int kind = fold.is_region ? 0 : 1;
          sums[kind] += residual.col(k).norm();
          counts[kind] += 1.0;
        }
      }
      fit_.rungs[k].region_error = sums[0] / std::max(1.0, counts[0]);
      fit_.rungs[k].random_error = sums[1] / std::max(1.0, counts[1]);
    }
  }

  void LeaveOut(std::size_t first, std::size_t f, FoldErrors* fold) const {
    fold->is_region = f < TrainingFolds::kRegions;
    const std::vector<int> left = LeftOut(folds_.left_out[f]);
    std::vector<int> counted;
    for (const int observation : left) {
      if (rows_.observations[observation].num_lengths > 0) {
        counted.push_back(observation);
      }
    }
    fold->residuals.resize(counted.size());
    fold->poses.resize(counted.size());
    const auto rungs = static_cast<Eigen::Index>(fit_.rungs.size());
    for (std::size_t i = 0; i < counted.size(); ++i) {
      const TermRows::Observation& one = rows_.observations[counted[i]];
      fold->poses[i] = one.pose;
      fold->residuals[i].conservativeResize(one.num_lengths, rungs);
    }
    for (auto k = static_cast<Eigen::Index>(first); k < rungs; ++k) {
      const RungFit& rung = fit_.rungs[k];
      const Eigen::MatrixXd gram =
          grams_[k] - TermGram(Data(), rung.columns, left);
      const TermSolution solution = RidgeOf(rung).Solve(gram, rung.precisions);
      for (std::size_t i = 0; i < counted.size(); ++i) {
        const TermRows::Observation& one = rows_.observations[counted[i]];
        fold->residuals[i].col(k) =
            Left(rows_, rung.columns, solution, one).head(one.num_lengths);
      }
    }
  }

  // Weights of the observations by what the loss makes of their residuals, in
  // units of their own median.
  void WeighBy(const Eigen::VectorXd& squares) {
    std::vector<double> typical;
    for (std::size_t k = 0; k < rows_.observations.size(); ++k) {
      const int d = rows_.observations[k].num_measured;
      if (d > 0) typical.push_back(squares[k] / ChiSquareQuantile(0.5, d));
    }
    if (typical.empty()) return;
    const auto middle =
        typical.begin() + static_cast<std::ptrdiff_t>(typical.size() / 2);
    std::nth_element(typical.begin(), middle, typical.end());
    const double scale = std::max(*middle, std::numeric_limits<double>::min());
    for (std::size_t k = 0; k < rows_.observations.size(); ++k) {
      const int d = rows_.observations[k].num_measured;
      if (d == 0) continue;
      std::array<double, 3> rho{};
      input_.losses[d - 1].Evaluate(squares[k] / scale, rho.data());
      weights_[k] = rho[1];
    }
  }

  // By the richest rung of moderate size, so that what bends is no outlier.
  void Reweight() {
    const RungFit& rung =
        fit_.rungs[std::min<std::size_t>(1, fit_.rungs.size() - 1)];
    const TermRidge ridge = RidgeOf(rung);
    LogPrecisions precisions = {};
    for (int round = 0; round < kReweightings; ++round) {
      const Eigen::MatrixXd gram = TermGram(Data(), rung.columns, AllOf(rows_));
      precisions = ridge.Choose(gram, Equations(), precisions);
      const TermSolution solution = ridge.Solve(gram, precisions);
      WeighBy(SquaresOf(LeftBy(rung.columns, solution)));
    }
  }

  // Residuals of all rows: of an estimate, of a rung, of what is delivered.
  Eigen::VectorXd LeftBy(const TermColumns& columns,
                         const TermSolution& solution) const {
    Eigen::VectorXd left(rows_.residuals.size());
    for (const TermRows::Observation& one : rows_.observations) {
      left.segment(one.first_row, one.height) =
          Left(rows_, columns, solution, one);
    }
    return left;
  }
  Eigen::VectorXd LeftBy(std::size_t rung) const {
    return LeftBy(fit_.rungs[rung].columns, solutions_[rung]);
  }
  Eigen::VectorXd LeftByStack() const {
    Eigen::VectorXd left = rows_.residuals;
    for (const TermRows::Observation& one : rows_.observations) {
      auto some = left.segment(one.first_row, one.height);
      some += Bent(one, one.pose, rows_.turns);
      if (one.second_pose >= 0) {
        some += Bent(one, one.second_pose, rows_.second_turns);
      }
    }
    return left;
  }

  Eigen::VectorXd SquaresOf(const Eigen::VectorXd& left) const {
    Eigen::VectorXd squares(weights_.size());
    for (std::size_t k = 0; k < rows_.observations.size(); ++k) {
      const TermRows::Observation& one = rows_.observations[k];
      squares[static_cast<Eigen::Index>(k)] =
          left.segment(one.first_row, one.height).squaredNorm();
    }
    return squares;
  }

  std::optional<BaseJump> FindJump(const Eigen::VectorXd& left) const {
    if (!arm_.errors.covariates.empty()) return std::nullopt;
    return FindBaseJump(Data(), left);
  }

  // geometry + share (stack - geometry), which is linear in all coefficients.
  void Blend() {
    const double share = fit_.stacking.share;
    const TermColumns all = UnionOfColumns();
    Eigen::VectorXd coefficients = Eigen::VectorXd::Zero(all.size());
    Eigen::VectorXd step =
        Eigen::VectorXd::Zero(static_cast<Eigen::Index>(input_.columns.size()));
    const int n = arm_.num_joints();
    for (std::size_t k = 0; k < fit_.rungs.size(); ++k) {
      RungFit& rung = fit_.rungs[k];
      const double weight = WeightOf(k, share);
      step += weight * solutions_[k].geometry;
      coefficients += weight * (all.From(rung.columns) * solutions_[k].terms);
      rung.values = Moved(solutions_[k].geometry);
      rung.terms = rung.columns.TermsOf(solutions_[k].terms, terms_, n);
    }
    values_ = Moved(step);
    has_terms_ = true;
    terms_ = all.TermsOf(coefficients, terms_, n);
  }

  // Of a rung in what is delivered.
  double WeightOf(std::size_t k, double share) const {
    return share * fit_.stacking.weights[k] + (k == 0 ? 1.0 - share : 0.0);
  }

  Eigen::VectorXd Moved(const Eigen::VectorXd& step) const {
    Eigen::VectorXd values = values_;
    for (std::size_t k = 0; k < input_.columns.size(); ++k) {
      values[input_.columns[k]] += kTermUnit * step[k];
    }
    return values;
  }

  TermColumns UnionOfColumns() const {
    std::vector<TermColumns> all;
    for (std::size_t k = 0; k < fit_.rungs.size(); ++k) {
      if (WeightOf(k, fit_.stacking.share) > 0.0) {
        all.push_back(fit_.rungs[k].columns);
      }
    }
    return TermColumns::Union(all);
  }

  std::shared_ptr<const TermCovariance> JointCovariance() {
    std::vector<RungEstimate> estimates;
    for (std::size_t k = 0; k < fit_.rungs.size(); ++k) {
      const RungFit& rung = fit_.rungs[k];
      estimates.push_back({rung.columns, fit_.stacking.weights[k]});
      const double weight = WeightOf(k, fit_.stacking.share);
      if (!(weight > 0.0)) continue;
      RungEstimate& estimate = estimates.back();
      const Eigen::MatrixXd inverse =
          RidgeOf(rung).Covariance(grams_[k], rung.precisions);
      fit_.effective +=
          weight * grams_[k]
                       .topLeftCorner(inverse.rows(), inverse.cols())
                       .cwiseProduct(inverse)
                       .sum();
      estimate.values.resize(inverse.rows());
      estimate.values << InUnits(rung.values),
          rung.columns.CoefficientsOf(rung.terms);
      estimate.covariance = rung.variance * inverse;
      const double prior =
          rung.PriorDeviation(TermGroup::kFunction) / kTermUnit;
      estimate.function_variance = prior * prior;
    }
    const TermColumns all = UnionOfColumns();
    std::shared_ptr<const TermCovariance> covariance =
        CovarianceOfStack(estimates, fit_.stacking.share, all, input_.columns);
    SetDeviations(
        covariance->root.bottomRows(all.size()).rowwise().squaredNorm(), all);
    return covariance;
  }

  void SetDeviations(const Eigen::VectorXd& variances, const TermColumns& all) {
    for (const FunctionKnots& knots : all.functions()) {
      fit_.terms.joints[knots.joint].function.deviations =
          kTermUnit *
          variances.segment(all.num_dense() + knots.offset, knots.count)
              .cwiseSqrt();
    }
  }

  const ErrorFitInput& input_;
  Arm arm_;
  const TrainingFolds folds_;
  Eigen::VectorXd values_;
  ErrorTerms terms_;
  bool has_terms_ = false;
  TermRows rows_;
  Eigen::VectorXd weights_;
  std::vector<Eigen::MatrixXd> grams_;
  std::vector<TermSolution> solutions_;
  std::vector<FoldErrors> fold_errors_;
  ErrorFit fit_;
};

}  // namespace

double RungFit::PriorDeviation(TermGroup group) const {
  const double unit =
      group == TermGroup::kOwnAxis || group == TermGroup::kOtherAxes
          ? 1e-4
          : kTermUnit;
  const double log = precisions[static_cast<int>(group)];
  return unit * std::sqrt(variance) * std::pow(10.0, -0.5 * log);
}

std::optional<ErrorFit> FitErrorTerms(const ErrorFitInput& input) {
  const std::vector<int> groups = GroupByConfiguration(input.data);
  const int count =
      groups.empty() ? 0 : *std::max_element(groups.begin(), groups.end()) + 1;
  if (input.selects && count < kFewestForErrorTerms) return std::nullopt;
  return ErrorFitter(input).Run();
}

}  // namespace alidade::internal
