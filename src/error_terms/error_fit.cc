#include "src/error_terms/error_fit.h"

#include <Eigen/Cholesky>
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

class ErrorFitter {
 public:
  explicit ErrorFitter(const ErrorFitInput& input)
      : input_(input),
        arm_(input.model.nominal()),
        folds_(MakeTrainingFolds(input.data)),
        values_(input.values) {
    arm_.errors.joints.clear();
    arm_.errors.coupling.resize(0, 0);
    terms_ = arm_.errors;
    std::vector<TermSet> sets = input.sets;
    sets.insert(sets.begin(), TermSet{"geometry"});
    for (TermSet& set : sets) {
      fit_.rungs.push_back(
          {set, TermColumns(arm_, set, input.data.joint_values.map())});
    }
  }

  std::optional<ErrorFit> Run() {
    Linearize();
    weights_.setOnes(static_cast<Eigen::Index>(rows_.observations.size()));
    if (!input_.losses.empty()) Reweight();
    ChooseScales();
    if (!input_.selects) {
      fit_.stacking.weights =
          Eigen::VectorXd::Unit(static_cast<Eigen::Index>(fit_.rungs.size()),
                                fit_.rungs.size() - 1);
      fit_.stacking.share = 1.0;
    } else {
      fit_.stacking = Stack(LeaveOut());
    }
    for (std::size_t k = 0; k < fit_.rungs.size(); ++k) {
      fit_.rungs[k].weight = WeightOf(k, fit_.stacking.share);
    }
    Blend();
    if (!(fit_.stacking.share > 0.0)) {
      fit_.values = input_.values;
      return std::move(fit_);
    }
    for (int outer = 1; outer < kOuterIterations; ++outer) {
      Linearize();
      if (!input_.losses.empty()) WeighBy(LeftByStack());
      SolveAll();
      Blend();
    }
    terms_.load_geometry = GeometryAt(values_, &terms_.load_target);
    fit_.values = values_;
    fit_.terms = terms_;
    fit_.weights = weights_;
    fit_.covariance = JointCovariance();
    return std::move(fit_);
  }

 private:
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
    if (arm_.errors.empty()) return;
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
        ErrorsAt(arm_, rows_.joint_values.col(pose).data());
    Eigen::Matrix3Xd sizes(3, errors.shifts.size());
    sizes.topRows<2>() = errors.tilts;
    sizes.row(2) = errors.shifts.transpose();
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

  // Each rung's scales, and its estimate from all data. The elastic one starts
  // those that have it too.
  void ChooseScales() {
    const double equations = Equations();
    grams_.resize(fit_.rungs.size());
    solutions_.resize(fit_.rungs.size());
    LogPrecisions start = {};
    const auto choose = [&](std::size_t k, const LogPrecisions& from) {
      RungFit& rung = fit_.rungs[k];
      const TermRidge ridge = RidgeOf(rung);
      grams_[k] = TermGram(Data(), rung.columns, AllOf(rows_));
      rung.precisions = ridge.Choose(grams_[k], equations, from);
      rung.variance = ridge.Variance(grams_[k], equations, rung.precisions);
      solutions_[k] = ridge.Solve(grams_[k], rung.precisions);
    };
    const std::size_t first = std::min<std::size_t>(2, fit_.rungs.size());
    for (std::size_t k = 0; k < first; ++k) choose(k, start);
    if (first == 2) start = fit_.rungs[1].precisions;
    ParallelFor(input_.model.num_threads(),
                static_cast<std::int64_t>(fit_.rungs.size() - first), 1,
                [&](std::int64_t begin, std::int64_t end) {
                  for (std::int64_t k = begin; k < end; ++k) {
                    choose(first + static_cast<std::size_t>(k), start);
                  }
                });
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
                    solutions_[k] = ridge.Solve(grams_[k], rung.precisions);
                    rung.variance =
                        ridge.Variance(grams_[k], Equations(), rung.precisions);
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

  // What all rungs leave of every fold that they are fitted without.
  std::vector<FoldErrors> LeaveOut() {
    const std::size_t num_folds = folds_.left_out.size();
    const auto rungs = static_cast<Eigen::Index>(fit_.rungs.size());
    std::vector<FoldErrors> folds(num_folds);
    ParallelFor(input_.model.num_threads(),
                static_cast<std::int64_t>(num_folds), 1,
                [&](std::int64_t begin, std::int64_t end) {
                  for (std::int64_t f = begin; f < end; ++f) {
                    folds[f] = LeaveOut(static_cast<std::size_t>(f), rungs);
                  }
                });
    for (std::size_t k = 0; k < fit_.rungs.size(); ++k) {
      std::array<double, 2> sums{};
      std::array<double, 2> counts{};
      for (const FoldErrors& fold : folds) {
        for (const Eigen::MatrixXd& residual : fold.residuals) {
          const int kind = fold.is_region ? 0 : 1;
          sums[kind] += residual.col(k).norm();
          counts[kind] += 1.0;
        }
      }
      fit_.rungs[k].region_error = sums[0] / std::max(1.0, counts[0]);
      fit_.rungs[k].random_error = sums[1] / std::max(1.0, counts[1]);
    }
    return folds;
  }

  FoldErrors LeaveOut(std::size_t f, Eigen::Index rungs) const {
    FoldErrors fold;
    fold.is_region = f < TrainingFolds::kRegions;
    const std::vector<int> left = LeftOut(folds_.left_out[f]);
    std::vector<int> counted;
    for (const int observation : left) {
      const TermRows::Observation& one = rows_.observations[observation];
      if (one.num_lengths == 0) continue;
      counted.push_back(observation);
      fold.poses.push_back(one.pose);
      fold.residuals.emplace_back(one.num_lengths, rungs);
    }
    for (Eigen::Index k = 0; k < rungs; ++k) {
      const RungFit& rung = fit_.rungs[k];
      const Eigen::MatrixXd gram =
          grams_[k] - TermGram(Data(), rung.columns, left);
      const TermSolution solution =
          RidgeOf(rung).Solve(gram, rung.precisions);
      for (std::size_t i = 0; i < counted.size(); ++i) {
        const TermRows::Observation& one = rows_.observations[counted[i]];
        fold.residuals[i].col(k) =
            Left(rows_, rung.columns, solution, one).head(one.num_lengths);
      }
    }
    return fold;
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
    const RungFit& rung = fit_.rungs[std::min<std::size_t>(
        1, fit_.rungs.size() - 1)];
    const TermRidge ridge = RidgeOf(rung);
    LogPrecisions precisions = {};
    for (int round = 0; round < kReweightings; ++round) {
      const Eigen::MatrixXd gram =
          TermGram(Data(), rung.columns, AllOf(rows_));
      precisions = ridge.Choose(gram, Equations(), precisions);
      const TermSolution solution = ridge.Solve(gram, precisions);
      Eigen::VectorXd squares(weights_.size());
      for (std::size_t k = 0; k < rows_.observations.size(); ++k) {
        squares[k] = Left(rows_, rung.columns, solution, rows_.observations[k])
                         .squaredNorm();
      }
      WeighBy(squares);
    }
  }

  Eigen::VectorXd LeftByStack() const {
    Eigen::VectorXd squares(weights_.size());
    for (std::size_t k = 0; k < rows_.observations.size(); ++k) {
      const TermRows::Observation& one = rows_.observations[k];
      Eigen::VectorXd left =
          rows_.residuals.segment(one.first_row, one.height) +
          Bent(one, one.pose, rows_.turns);
      if (one.second_pose >= 0) {
        left += Bent(one, one.second_pose, rows_.second_turns);
      }
      squares[k] = left.squaredNorm();
    }
    return squares;
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

  // That of a mixture of the rungs: within and between them.
  std::shared_ptr<const TermCovariance> JointCovariance() {
    constexpr double kRounding = 1e-10;
    const TermColumns all = UnionOfColumns();
    const auto p = static_cast<Eigen::Index>(input_.columns.size());
    const Eigen::Index size = p + all.size();
    Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(size, size);
    Eigen::VectorXd mean(size);
    mean << InUnits(values_), all.CoefficientsOf(terms_);
    for (std::size_t k = 0; k < fit_.rungs.size(); ++k) {
      const RungFit& rung = fit_.rungs[k];
      const double weight = WeightOf(k, fit_.stacking.share);
      if (!(weight > 0.0)) continue;
      const Eigen::MatrixXd inverse =
          RidgeOf(rung).Covariance(grams_[k], rung.precisions);
      fit_.effective +=
          weight * grams_[k]
                       .topLeftCorner(inverse.rows(), inverse.cols())
                       .cwiseProduct(inverse)
                       .sum();
      const Eigen::MatrixXd own = weight * rung.variance * inverse;
      const Eigen::MatrixXd from = all.From(rung.columns);
      const Eigen::MatrixXd beside = from * own.bottomLeftCorner(
                                                rung.columns.size(), p);
      covariance.topLeftCorner(p, p) += own.topLeftCorner(p, p);
      covariance.bottomLeftCorner(all.size(), p) += beside;
      covariance.topRightCorner(p, all.size()) += beside.transpose();
      covariance.bottomRightCorner(all.size(), all.size()) +=
          from *
          own.bottomRightCorner(rung.columns.size(), rung.columns.size()) *
          from.transpose();
      Eigen::VectorXd off(size);
      off << InUnits(rung.values), from * rung.columns.CoefficientsOf(rung.terms);
      off -= mean;
      covariance += weight * off * off.transpose();
    }
    SetDeviations(covariance.bottomRightCorner(all.size(), all.size()), all);
    covariance.diagonal() *= 1.0 + kRounding;
    covariance.diagonal().array() += 1e-14;
    return std::make_shared<TermCovariance>(TermCovariance{
        all, input_.columns, covariance.llt().matrixL().toDenseMatrix()});
  }

  // Deviations of functions less their means at the poses: a constant is the
  // joint's theta, and not known of either alone.
  void SetDeviations(const Eigen::MatrixXd& covariance,
                     const TermColumns& all) {
    for (const FunctionKnots& knots : all.functions()) {
      Eigen::VectorXd mean = Eigen::VectorXd::Zero(knots.count);
      const auto values = rows_.joint_values.row(knots.joint);
      for (const double value : values) {
        const double place = (value - knots.first) / knots.spacing;
        const int below =
            std::clamp(static_cast<int>(place), 0, knots.count - 2);
        mean[below] += below + 1.0 - place;
        mean[below + 1] += place - below;
      }
      mean /= static_cast<double>(values.size());
      const Eigen::Index first = all.num_dense() + knots.offset;
      const auto own = covariance.block(first, first, knots.count, knots.count);
      const Eigen::VectorXd beside = own * mean;
      const Eigen::VectorXd variances =
          (own.diagonal() - 2.0 * beside).array() + mean.dot(beside);
      fit_.terms.joints[knots.joint].function.deviations =
          kTermUnit * variances.cwiseMax(0.0).cwiseSqrt();
    }
  }

  const ErrorFitInput& input_;
  Arm arm_;
  const TrainingFolds folds_;
  Eigen::VectorXd values_;
  ErrorTerms terms_;
  TermRows rows_;
  Eigen::VectorXd weights_;
  std::vector<Eigen::MatrixXd> grams_;
  std::vector<TermSolution> solutions_;
  ErrorFit fit_;
};

}  // namespace

Eigen::MatrixXd TermCovariance::Spread(
    const TermRows& rows, const TermRows::Observation& one) const {
  const Eigen::Index p = rows.num_columns();
  Eigen::MatrixXd spread =
      rows.geometry.middleRows(one.first_row, one.height) * root.topRows(p);
  for (const bool second : {false, true}) {
    const int pose = second ? one.second_pose : one.pose;
    if (pose < 0) continue;
    const TermRows::RowMatrix& all = second ? rows.second_turns : rows.turns;
    const auto turns = all.middleRows(one.first_row, one.height);
    // What the terms do to each turn, in unit deviations.
    Eigen::MatrixXd sizes = Eigen::MatrixXd::Zero(turns.cols(), root.cols());
    columns.ForEachAt(
        rows.joint_values.col(pose).data(), rows.moments.col(pose).data(),
        [&](int column, int turn, double size) {
          sizes.row(turn) += size * root.row(p + column);
        });
    spread += turns * sizes;
  }
  return spread;
}

double RungFit::PriorDeviation(TermGroup group) const {
  const double unit = group == TermGroup::kOwnAxis ||
                              group == TermGroup::kOtherAxes
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
