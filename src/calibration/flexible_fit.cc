#include "src/calibration/flexible_fit.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "src/calibration/evaluate.h"
#include "src/calibration/sigma_change.h"
#include "src/common/distributions.h"
#include "src/common/format.h"
#include "src/common/text.h"
#include "src/identifiability/generic_data.h"
#include "src/kernel/holdout.h"

namespace alidade::internal {
namespace {

// Lengths of the joint functions that are weighed, rad.
constexpr double kLengths[] = {0.1, 0.3, 1.5};

std::vector<TermSet> SetsOf(const ErrorTermOptions& options,
                            const Dataset& data) {
  const std::vector<CovariateEffect> effects = EffectsOf(data, options.uses);
  const bool has_covariates = std::any_of(
      effects.begin(), effects.end(), [&](const CovariateEffect& effect) {
        const CovariateUse use = UseOf(effect.name, options.uses);
        return !use.is_payload && !use.is_station;
      });
  if (options.selection == ErrorTermSelection::kStated) {
    TermSet set;
    set.name = "stated terms";
    set.elasticity = options.elasticity;
    set.function_length = options.function_length;
    set.cycles = options.harmonics;
    set.scale = options.scale;
    set.backlash = options.backlash;
    set.coupling = options.coupling;
    set.covariates = has_covariates && options.covariates;
    return {set};
  }
  TermSet elastic;
  elastic.name = "elasticity";
  elastic.elasticity = true;
  std::vector<TermSet> sets = {elastic};
  if (has_covariates) {
    sets.push_back(elastic);
    sets.back().name += " + covariates";
    sets.back().covariates = true;
  }
  for (const double length : kLengths) {
    TermSet set = elastic;
    set.name = "elasticity + functions of length " +
               FormatSignificant(length, 2) + " rad";
    set.function_length = length;
    sets.push_back(set);
    if (!has_covariates) continue;
    set.name += " + covariates";
    set.covariates = true;
    sets.push_back(set);
  }
  return sets;
}

Arm WithTerms(const Arm& arm, const ErrorTerms& terms) {
  Arm flexible = arm;
  flexible.errors = terms;
  return flexible;
}

ErrorRung Describe(const CalibrationSolution& rigid, const RungFit& rung,
                   double sigma) {
  ErrorRung described;
  described.name = rung.set.name;
  described.num_terms = rung.columns.size();
  described.weight = rung.weight;
  described.is_weighed = rung.is_weighed;
  const auto deviation = [&](TermGroup group) {
    const auto& dense = rung.columns.dense();
    const bool is_there =
        group == TermGroup::kFunction
            ? rung.columns.num_knots() > 0
            : std::any_of(dense.begin(), dense.end(), [&](const auto& term) {
                return term.group == group;
              });
    return is_there ? rung.PriorDeviation(group) : 0.0;
  };
  described.compliance_std = deviation(TermGroup::kOwnAxis);
  described.other_compliance_std = deviation(TermGroup::kOtherAxes);
  described.function_std = deviation(TermGroup::kFunction);
  described.region_error = rung.region_error * sigma;
  described.random_error = rung.random_error * sigma;
  const MeasurementModel model(WithTerms(rigid.task.arm, rung.terms),
                               rigid.task.data.references,
                               rigid.task.execution());
  described.train =
      EvaluateAccuracy(model, rigid.task.data.training, rung.values);
  if (rigid.task.data.validation) {
    described.validation =
        EvaluateAccuracy(model, *rigid.task.data.validation, rung.values);
    if (rigid.task.data.training.Has(MeasurementKind::kPose)) {
      described.validation_rotation =
          EvaluateRotations(model, *rigid.task.data.validation, rung.values);
    }
  }
  return described;
}

Finding Describe(const BaseJump& jump, const Dataset& data, double sigma) {
  Finding finding;
  finding.key = "base_jump";
  finding.statistic = jump.distance * sigma;
  // Poses in number see less than what one measurement is uncertain by.
  finding.level =
      jump.distance < 1.0 ? FindingLevel::kNote : FindingLevel::kAttention;
  const std::string where = SourceOf(data, jump.pose);
  finding.sentence =
      "the base, or the instrument, moved before " +
      (where.empty() ? "pose " + std::to_string(jump.pose + 1) : where) +
      " or so, by " + FormatSignificant(finding.statistic / kMillimetre, 2) +
      " mm at the target (by chance once in " +
      FormatSignificant(1.0 / std::max(1e-15, jump.false_alarm), 1) +
      " data sets)";
  if (finding.level == FindingLevel::kNote) {
    finding.sentence += ", less than the noise of one measurement";
    return finding;
  }
  finding.next =
      "State where the base stood in a column (`columns: {station: ...}`), or "
      "calibrate the parts alone.";
  return finding;
}

// Of the rungs that were fitted without regions.
double LeastRegionError(const ErrorTermsResult& result) {
  double least = result.rungs.front().region_error;
  for (const ErrorRung& rung : result.rungs) {
    if (rung.is_weighed) least = std::min(least, rung.region_error);
  }
  return least;
}

std::string SentenceOf(const ErrorTermsResult& result, bool is_stated) {
  if (is_stated) return "the error terms that were asked for are estimated";
  if (result.rungs.empty()) {
    return "no error terms: fewer than " +
           std::to_string(kFewestForErrorTerms) +
           " configurations decide nothing";
  }
  if (!(result.share > 0.0)) {
    return "no error terms: held-out training poses are not predicted better "
           "with them";
  }
  return "error terms are estimated: within the training poses they make the "
         "error of held-out ones " +
         FormatSignificant(result.rungs.front().region_error /
                               std::max(1e-12, LeastRegionError(result)),
                           2) +
         " times smaller";
}

// "; `temp` has no effect that the data show".
std::string WithoutEffect(const ErrorTerms& terms) {
  std::vector<std::string> names;
  for (const CovariateEffect& effect : terms.covariates) {
    if (effect.is_zero()) names.push_back("`" + effect.name + "`");
  }
  if (names.empty()) return "";
  return "; " + Join(names, ", ") + (names.size() == 1 ? " has" : " have") +
         " no effect that the data show";
}

Dataset AtMost(Eigen::Index poses, const CalibrationTask& task) {
  const Dataset& data = task.data.training;
  if (data.num_poses() <= poses) return data;
  return EvenSubset(task.communicator, data, poses);
}

}  // namespace

std::string ErrorTermsObstacle(const CalibrationTask& task) {
  if (task.communicator->size() > 1) {
    return "they need all data in one process: run without mpirun";
  }
  return "";
}

std::optional<FlexibleFit> FitFlexible(const CalibrationSolution& rigid,
                                       ErrorTermsResult* result,
                                       std::vector<Finding>* findings) {
  const CalibrationTask& task = rigid.task;
  const bool is_stated =
      task.options.errors.selection == ErrorTermSelection::kStated;
  const Dataset data = AtMost(kMostForErrorTerms, task);
  ErrorFitInput input{rigid.model(),
                      data,
                      rigid.problem.free_columns,
                      rigid.values,
                      rigid.problem.priors,
                      TunedLosses(task.options.loss),
                      SetsOf(task.options.errors, data),
                      task.options.errors.uses,
                      !is_stated};
  std::optional<ErrorFit> fit = FitErrorTerms(input);
  if (fit) {
    result->share = fit->stacking.share;
    result->t_regions = fit->stacking.t_regions;
    result->t_random = fit->stacking.t_random;
    result->effective_terms = fit->effective;
    const double sigma =
        MedianSigma(RowClass::kLength, data, task.communicator);
    result->region_error = fit->stacking.region_error * sigma;
    result->random_error = fit->stacking.random_error * sigma;
    for (const RungFit& rung : fit->rungs) {
      result->rungs.push_back(Describe(rigid, rung, sigma));
      result->rungs.back().evidence =
          fit->rungs.front().criterion - rung.criterion;
    }
    if (fit->jump) findings->push_back(Describe(*fit->jump, data, sigma));
  }
  result->sentence = SentenceOf(*result, is_stated);
  if (fit) result->sentence += WithoutEffect(fit->terms);
  if (!fit || !fit->covariance) return std::nullopt;
  if (!(result->share > 0.0)) {
    result->sentence += "; but each station has a base of its own";
  }
  FlexibleFit flexible;
  flexible.model.emplace(WithTerms(task.arm, fit->terms), task.data.references,
                         task.execution());
  flexible.values = fit->values;
  flexible.covariance = fit->covariance;
  return flexible;
}

void MatchSigmas(const MeasurementModel& model, const Eigen::VectorXd& values,
                 double effective, CalibrationTask* task) {
  const Dataset& training = task->data.training;
  const double left = std::max(
      0.1, 1.0 - effective / static_cast<double>(training.num_equations()));
  const bool is_robust = task->options.loss != LossKind::kNone;
  std::vector<std::pair<RowClass, double>> factors;
  for (const RowClass which : {RowClass::kLength, RowClass::kRotation}) {
    const Dataset rows = RowsOfClass(training, which);
    const SharedVector squares = SquaredNorms(model.Errors(values, rows), rows);
    const Eigen::VectorXi dimensions = Dimensions(rows);
    double sum = 0.0;
    double count = 0.0;
    std::vector<double> typical;
    for (Eigen::Index i = 0; i < dimensions.size(); ++i) {
      if (dimensions[i] == 0) continue;
      sum += squares[i];
      count += dimensions[i];
      typical.push_back(squares[i] / ChiSquareQuantile(0.5, dimensions[i]));
    }
    if (typical.empty()) continue;
    const auto middle =
        typical.begin() + static_cast<std::ptrdiff_t>(typical.size() / 2);
    std::nth_element(typical.begin(), middle, typical.end());
    const double square = (is_robust ? *middle : sum / count) / left;
    if (square > 0.0) factors.emplace_back(which, std::sqrt(square));
  }
  for (const auto& [which, factor] : factors) {
    ChangeSigmas(which, {factor, 0.0}, &task->data.training);
    if (task->data.validation) {
      ChangeSigmas(which, {factor, 0.0}, &*task->data.validation);
    }
  }
}

}  // namespace alidade::internal
