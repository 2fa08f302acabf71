#include "src/error_terms/rung_fits.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "src/common/distributions.h"
#include "src/common/parallel.h"

namespace alidade::internal {
namespace {

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

// Of each observation.
Eigen::VectorXd SquaresOf(const TermRows& rows, const Eigen::VectorXd& left) {
  Eigen::VectorXd squares(static_cast<Eigen::Index>(rows.observations.size()));
  for (Eigen::Index k = 0; k < squares.size(); ++k) {
    const TermRows::Observation& one =
        rows.observations[static_cast<std::size_t>(k)];
    squares[k] = left.segment(one.first_row, one.height).squaredNorm();
  }
  return squares;
}

// Groups of terms that a set has beside those of a smaller one; 0 where it does
// not have all of its terms.
int GroupsBeside(const RungFit& smaller, const RungFit& larger) {
  const TermSet& a = smaller.set;
  const TermSet& b = larger.set;
  const bool has_all =
      b.elasticity >= a.elasticity && b.covariates >= a.covariates &&
      (a.function_length == 0.0 || a.function_length == b.function_length);
  return has_all ? larger.columns.num_groups() - smaller.columns.num_groups()
                 : 0;
}

}  // namespace

std::vector<CovariateEffect> EffectsOf(const Dataset& data,
                                       const std::vector<CovariateUse>& uses) {
  std::vector<CovariateEffect> effects;
  for (std::size_t k = 0; k < data.covariate_names.size(); ++k) {
    const auto row = data.covariates.map().row(static_cast<Eigen::Index>(k));
    const CovariateUse use = UseOf(data.covariate_names[k], uses);
    if (row.size() == 0) continue;
    if (!use.is_payload && !(row.maxCoeff() > row.minCoeff())) continue;
    const bool is_signed = use.is_approach || use.is_station;
    effects.push_back({use.name, is_signed ? 0.0 : row.mean()});
    effects.back().payload = use.is_payload ? 1.0 : 0.0;
  }
  return effects;
}

double ChanceOfGain(double gain, int variances) {
  if (!(gain > 0.0)) return 1.0;
  double chance = 0.0;
  double share = std::pow(0.5, variances);
  for (int i = 1; i <= variances; ++i) {
    share *= static_cast<double>(variances - i + 1) / i;
    chance += share * ChiSquareSurvival(gain, i);
  }
  return chance;
}

RungFits::RungFits(const ErrorFitInput& input)
    : input_(input),
      arm_(input.model.nominal()),
      folds_(MakeTrainingFolds(input.data)),
      values_(input.values) {
  arm_.errors.Clear();
  arm_.errors.covariates = EffectsOf(input.data, input.uses);
  for (const CovariateEffect& effect : arm_.errors.covariates) {
    if (effect.payload != 0.0) arm_.errors.payload.mass = effect.reference;
  }
  terms_ = arm_.errors;
  std::vector<TermSet> sets = input.sets;
  sets.insert(sets.begin(), TermSet{"geometry"});
  for (TermSet& set : sets) {
    set.uses = input.uses;
    rungs_.push_back({set, TermColumns(arm_, set, input.data.joint_values.map(),
                                       Deviations())});
  }
  Linearize();
  weights_.setOnes(static_cast<Eigen::Index>(rows_.observations.size()));
  if (!input_.losses.empty()) Reweight();
}

Eigen::VectorXd RungFits::Deviations() const {
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

Eigen::VectorXd RungFits::InUnits(const Eigen::VectorXd& values) const {
  Eigen::VectorXd units(static_cast<Eigen::Index>(input_.columns.size()));
  for (Eigen::Index k = 0; k < units.size(); ++k) {
    units[k] = values[input_.columns[k]] / kTermUnit;
  }
  return units;
}

Eigen::VectorXd RungFits::Priors() const {
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

TermRidge RungFits::RidgeOf(const RungFit& rung) const {
  return {rung.columns, InUnits(values_ - input_.model.NominalValues()),
          Priors()};
}

// With residuals as if there were no terms.
void RungFits::Linearize() {
  terms_.load_geometry = LoadGeometryAt(values_, &terms_.load_target);
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
Eigen::VectorXd RungFits::Bent(const TermRows::Observation& one, int pose,
                               const TermRows::RowMatrix& turns) const {
  if (pose < 0) return Eigen::VectorXd::Zero(one.height);
  const PoseErrors errors =
      ErrorsAt(arm_, rows_.joint_values.col(pose).data(),
               CovariatesAt(input_.data, arm_, pose).data());
  const Eigen::Index n = errors.shifts.size();
  Eigen::Matrix3Xd sizes(3, n + 4);
  sizes.topLeftCorner(2, n) = errors.tilts;
  sizes.row(2).head(n) = errors.shifts.transpose();
  sizes.middleCols<2>(n) = errors.base.reshaped(3, 2);
  sizes.rightCols<2>() = errors.target.reshaped(3, 2);
  return turns.middleRows(one.first_row, one.height) *
         (sizes.reshaped() / kTermUnit);
}

Eigen::MatrixXd RungFits::LoadGeometryAt(const Eigen::VectorXd& values,
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

double RungFits::Equations() const {
  double sum = 0.0;
  for (std::size_t k = 0; k < rows_.observations.size(); ++k) {
    sum += weights_[k] * rows_.observations[k].num_measured;
  }
  return sum;
}

void RungFits::Solve(const TermRidge& ridge, std::size_t k) {
  RungFit& rung = rungs_[k];
  solutions_[k] = ridge.Solve(grams_[k], rung.precisions);
  // Of exact data rounding may leave less than nothing.
  rung.variance = std::max(0.0, solutions_[k].cost) /
                  std::max(1.0, Equations() - ridge.num_geometry());
}

void RungFits::Choose(std::size_t k, const LogPrecisions& from) {
  RungFit& rung = rungs_[k];
  const TermRidge ridge = RidgeOf(rung);
  grams_[k] = TermGram(Data(), rung.columns, AllOf(rows_));
  const ChosenScales chosen = ridge.Choose(grams_[k], Equations(), from);
  rung.precisions = chosen.precisions;
  rung.criterion = chosen.criterion;
  Solve(ridge, k);
}

// The elastic rung's scales start those that have it too.
void RungFits::ChooseScales() {
  grams_.resize(rungs_.size());
  solutions_.resize(rungs_.size());
  LogPrecisions start = {};
  const std::size_t first = std::min<std::size_t>(2, rungs_.size());
  for (std::size_t k = 0; k < first; ++k) Choose(k, start);
  if (first == 2) start = rungs_[1].precisions;
  ParallelFor(input_.model.num_threads(),
              static_cast<std::int64_t>(rungs_.size() - first), 1,
              [&](std::int64_t begin, std::int64_t end) {
                for (std::int64_t k = begin; k < end; ++k) {
                  Choose(first + static_cast<std::size_t>(k), start);
                }
              });
  TryModuloTurn();
}

// All functions of a joint have to be of one kind, for their stack.
void RungFits::TryModuloTurn() {
  std::vector<std::size_t> changed;
  std::vector<RungFit> turned;
  for (std::size_t k = 0; k < rungs_.size(); ++k) {
    TermSet set = rungs_[k].set;
    set.modulo_turn = true;
    RungFit rung{set, TermColumns(arm_, set, input_.data.joint_values.map(),
                                  Deviations())};
    if (!rung.columns.has_periodic()) continue;
    changed.push_back(k);
    turned.push_back(std::move(rung));
  }
  if (changed.empty()) return;
  const std::vector<RungFit> plain = rungs_;
  const std::vector<Eigen::MatrixXd> plain_grams = grams_;
  const std::vector<TermSolution> plain_solutions = solutions_;
  ParallelFor(input_.model.num_threads(),
              static_cast<std::int64_t>(changed.size()), 1,
              [&](std::int64_t begin, std::int64_t end) {
                for (std::int64_t i = begin; i < end; ++i) {
                  rungs_[changed[i]] = turned[i];
                  Choose(changed[i], plain[changed[i]].precisions);
                }
              });
  const auto least = [&](const std::vector<RungFit>& rungs) {
    double criterion = std::numeric_limits<double>::infinity();
    for (const std::size_t k : changed) {
      criterion = std::min(criterion, rungs[k].criterion);
    }
    return criterion;
  };
  if (least(rungs_) < least(plain)) return;
  rungs_ = plain;
  grams_ = plain_grams;
  solutions_ = plain_solutions;
}

std::vector<std::pair<std::size_t, RungFit>> RungFits::DropWithoutEvidence() {
  std::vector<std::size_t> kept;
  std::vector<std::pair<std::size_t, RungFit>> dropped;
  for (std::size_t k = 0; k < rungs_.size(); ++k) {
    Describe(k);
    rungs_[k].is_weighed =
        std::none_of(kept.begin(), kept.end(), [&](std::size_t smaller) {
          const int groups = GroupsBeside(rungs_[smaller], rungs_[k]);
          const double gain = rungs_[smaller].criterion - rungs_[k].criterion;
          return groups > 0 && !(ChanceOfGain(gain, groups) < kEvidenceLevel);
        });
    if (rungs_[k].is_weighed) {
      kept.push_back(k);
    } else {
      dropped.emplace_back(k, rungs_[k]);
    }
  }
  for (std::size_t k = 0; k < kept.size(); ++k) {
    if (k == kept[k]) continue;
    rungs_[k] = std::move(rungs_[kept[k]]);
    grams_[k] = std::move(grams_[kept[k]]);
    solutions_[k] = std::move(solutions_[kept[k]]);
  }
  rungs_.erase(rungs_.begin() + static_cast<std::ptrdiff_t>(kept.size()),
               rungs_.end());
  grams_.resize(kept.size());
  solutions_.resize(kept.size());
  return dropped;
}

void RungFits::Describe(std::size_t k) {
  RungFit& rung = rungs_[k];
  rung.values = Moved(solutions_[k].geometry);
  rung.terms =
      rung.columns.TermsOf(solutions_[k].terms, terms_, arm_.num_joints());
}

void RungFits::AddRung(const TermSet& set, std::size_t like,
                       bool replaces_last) {
  const LogPrecisions start = rungs_[like].precisions;
  RungFit rung{set, TermColumns(arm_, set, input_.data.joint_values.map(),
                                Deviations())};
  if (replaces_last) {
    rungs_.back() = std::move(rung);
  } else {
    rungs_.push_back(std::move(rung));
    grams_.emplace_back();
    solutions_.emplace_back();
  }
  Choose(rungs_.size() - 1, start);
  LeaveOut(rungs_.size() - 1);
}

void RungFits::MoveTo(const Eigen::VectorXd& values, const ErrorTerms& terms) {
  values_ = values;
  terms_ = terms;
  has_terms_ = true;
  Linearize();
  if (!input_.losses.empty()) WeighBy(LeftByEstimate());
  ParallelFor(input_.model.num_threads(),
              static_cast<std::int64_t>(rungs_.size()), 1,
              [&](std::int64_t begin, std::int64_t end) {
                for (std::int64_t k = begin; k < end; ++k) {
                  RungFit& rung = rungs_[k];
                  const TermRidge ridge = RidgeOf(rung);
                  grams_[k] = TermGram(Data(), rung.columns, AllOf(rows_));
                  Solve(ridge, static_cast<std::size_t>(k));
                }
              });
}

std::vector<int> RungFits::LeftOut(const std::vector<bool>& poses) const {
  std::vector<int> left;
  for (std::size_t k = 0; k < rows_.observations.size(); ++k) {
    const TermRows::Observation& one = rows_.observations[k];
    if (one.pose < 0 || !(weights_[k] > 0.0)) continue;
    if (poses[one.pose]) left.push_back(static_cast<int>(k));
  }
  return left;
}

void RungFits::LeaveOut(std::size_t first) {
  fold_errors_.resize(folds_.left_out.size());
  ParallelFor(input_.model.num_threads(),
              static_cast<std::int64_t>(fold_errors_.size()), 1,
              [&](std::int64_t begin, std::int64_t end) {
                for (std::int64_t f = begin; f < end; ++f) {
                  LeaveOut(first, static_cast<std::size_t>(f),
                           &fold_errors_[f]);
                }
              });
  for (std::size_t k = first; k < rungs_.size(); ++k) {
    std::array<double, 2> sums{};
    std::array<double, 2> counts{};
    for (const FoldErrors& fold : fold_errors_) {
      for (const Eigen::MatrixXd& residual : fold.residuals) {
        const int kind = fold.is_region ? 0 : 1;
        sums[kind] += residual.col(k).norm();
        counts[kind] += 1.0;
      }
    }
    rungs_[k].region_error = sums[0] / std::max(1.0, counts[0]);
    rungs_[k].random_error = sums[1] / std::max(1.0, counts[1]);
  }
}

void RungFits::LeaveOut(std::size_t first, std::size_t f,
                        FoldErrors* fold) const {
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
  const auto rungs = static_cast<Eigen::Index>(rungs_.size());
  for (std::size_t i = 0; i < counted.size(); ++i) {
    const TermRows::Observation& one = rows_.observations[counted[i]];
    fold->poses[i] = one.pose;
    fold->residuals[i].conservativeResize(one.num_lengths, rungs);
  }
  for (auto k = static_cast<Eigen::Index>(first); k < rungs; ++k) {
    const RungFit& rung = rungs_[k];
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

// By what the loss makes of residuals, in units of their own median.
void RungFits::WeighBy(const Eigen::VectorXd& left) {
  const Eigen::VectorXd squares = SquaresOf(rows_, left);
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

// By the richest rung of moderate size, so that what is elastic is no outlier.
void RungFits::Reweight() {
  const RungFit& rung = rungs_[std::min<std::size_t>(1, rungs_.size() - 1)];
  const TermRidge ridge = RidgeOf(rung);
  LogPrecisions precisions = {};
  for (int round = 0; round < kReweightings; ++round) {
    const Eigen::MatrixXd gram = TermGram(Data(), rung.columns, AllOf(rows_));
    precisions = ridge.Choose(gram, Equations(), precisions).precisions;
    const TermSolution solution = ridge.Solve(gram, precisions);
    WeighBy(LeftBy(rung.columns, solution));
  }
}

Eigen::VectorXd RungFits::LeftBy(const TermColumns& columns,
                                 const TermSolution& solution) const {
  Eigen::VectorXd left(rows_.residuals.size());
  for (const TermRows::Observation& one : rows_.observations) {
    left.segment(one.first_row, one.height) =
        Left(rows_, columns, solution, one);
  }
  return left;
}

Eigen::VectorXd RungFits::LeftBy(std::size_t rung) const {
  return LeftBy(rungs_[rung].columns, solutions_[rung]);
}

Eigen::VectorXd RungFits::LeftByEstimate() const {
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

Eigen::VectorXd RungFits::Moved(const Eigen::VectorXd& step) const {
  Eigen::VectorXd values = values_;
  for (std::size_t k = 0; k < input_.columns.size(); ++k) {
    values[input_.columns[k]] += kTermUnit * step[k];
  }
  return values;
}

double RungFit::PriorDeviation(TermGroup group) const {
  const double unit =
      group == TermGroup::kOwnAxis || group == TermGroup::kOtherAxes
          ? 1e-4
          : kTermUnit;
  const double log = precisions[static_cast<int>(group)];
  return unit * std::sqrt(variance) * std::pow(10.0, -0.5 * log);
}

}  // namespace alidade::internal
