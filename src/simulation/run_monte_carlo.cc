#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "alidade/error.h"
#include "alidade/monte_carlo.h"
#include "alidade/rotation.h"
#include "src/calibration/calibration_task.h"
#include "src/calibration/fit_uncertainty.h"
#include "src/calibration/frame_fit.h"
#include "src/calibration/preparation.h"
#include "src/calibration/sigma_estimation.h"
#include "src/common/distributions.h"
#include "src/common/parallel.h"
#include "src/common/random.h"
#include "src/identifiability/analysis.h"
#include "src/kernel/reduction.h"
#include "src/model/joint_draw.h"
#include "src/simulation/repeated_calibration.h"
#include "src/simulation/simulated_data.h"
#include "src/simulation/trial_sums.h"
#include "src/uncertainty/nonlinearity.h"
#include "src/uncertainty/prediction.h"

namespace alidade::internal {
namespace {

// Trials between two looks at the precision; a fixed number, so that where a
// run stops does not depend on threads.
constexpr int kTrialsPerRound = 256;

const char* NameOf(SimulatedTruth truth) {
  switch (truth) {
    case SimulatedTruth::kGiven:
      return "given";
    case SimulatedTruth::kIdentified:
      return "identified";
    case SimulatedTruth::kPriors:
      return "priors";
  }
  return "";
}

void RequireNoContacts(const Dataset& data) {
  for (const ObservationBlock& block : data.blocks) {
    if (block.kind != MeasurementKind::kFixedPoint &&
        block.kind != MeasurementKind::kPlane) {
      continue;
    }
    SourceLocation location;
    location.file = data.name;
    throw InputError(location,
                     "contacts with points and planes cannot be simulated: "
                     "another arm would touch them at other joint values. "
                     "Expected positions, poses, distances or differences");
  }
}

// The job with its frames where they are, its sigmas as they are.
CalibrationTask Prepare(const CalibrationTask& task) {
  CalibrationTask prepared = task;
  CheckAndHoldOut(&prepared);
  RequireNoContacts(task.data.training);
  if (task.options.estimate_sigma && task.options.loss != LossKind::kNone) {
    throw InputError(
        {"", 0, 0, "measurement.sigma"},
        "trials with a robust loss cannot estimate sigma: expected a sigma "
        "(`calibrate` finds the one that the data have)");
  }
  FitFrames(&prepared);
  if (prepared.options.estimate_sigma) EstimateSigmas(&prepared);
  prepared.options.solver_options.on_iteration = {};
  prepared.options.solver_options.num_threads = 1;
  return prepared;
}

RepeatedCalibration::Options OptionsOf(const CalibrationTask& task) {
  RepeatedCalibration::Options options;
  options.loss = task.options.loss;
  options.estimate_sigma = task.options.estimate_sigma;
  options.solver = task.options.solver_options;
  return options;
}

class MonteCarlo {
 public:
  MonteCarlo(const CalibrationTask& task, const MonteCarloOptions& study,
             const TrialProgress& progress)
      : task_(Prepare(task)),
        study_(study),
        num_threads_(task.options.num_threads),
        progress_(progress),
        model_(task_.arm, task_.data.references, 1),
        pass_(AnalyzeIdentifiability(model_, task_.data.training,
                                     task_.options.identifiability)),
        calibration_(model_, pass_, OptionsOf(task_)),
        workspace_(DrawJointValues(task_.arm, study_.workspace_poses,
                                   study_.seed + 1)),
        reach_(Reach(task_.arm)),
        sums_(num_free()) {}

  MonteCarloResult Run() {
    const auto start = std::chrono::steady_clock::now();
    FindTruth();
    ChooseProfiles();
    Describe();
    for (int first = 0; first < study_.trials && !result_.stopped_early;
         first += kTrialsPerRound) {
      RunRound(first, std::min(first + kTrialsPerRound, study_.trials));
      if (progress_) {
        progress_(static_cast<int>(result_.trials.size()), study_.trials);
      }
      result_.stopped_early =
          sums_.IsPreciseEnough(study_.precision) &&
          static_cast<int>(result_.trials.size()) < study_.trials;
    }
    if (sums_.usable() > 0) {
      ListParameters();
      sums_.DescribeWorkspace(&result_);
    }
    result_.time_s =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start)
            .count();
    return std::move(result_);
  }

 private:
  Eigen::Index num_free() const {
    return static_cast<Eigen::Index>(calibration_.free_columns().size());
  }

  void FindTruth() {
    truth_ = model_.NominalValues();
    if (study_.truth == SimulatedTruth::kGiven) {
      truth_ = *task_.options.true_values;
    }
    if (study_.truth == SimulatedTruth::kIdentified) {
      const RepeatedCalibration::Outcome outcome =
          calibration_.Run(task_.data.training);
      if (!outcome.is_usable) {
        throw InputError({},
                         "the job finds no usable solution that could be the "
                         "truth of a simulation; `alidade calibrate` finds "
                         "why");
      }
      truth_ = outcome.values;
    }
    exact_ = task_.data.training;
    MeasureExactly(model_, truth_, exact_.joint_values, &exact_);
    equivalent_ = Equivalent();
  }

  // What exact measurements would give free parameters that identify
  // combinations with fixed ones too; priors left out, which would draw it to
  // nominal.
  Eigen::VectorXd Equivalent() const {
    Eigen::VectorXd values = model_.NominalValues();
    bool is_only_free = true;
    for (Eigen::Index column = 0; column < values.size(); ++column) {
      if (truth_[column] == values[column]) continue;
      is_only_free = is_only_free &&
                     std::binary_search(calibration_.free_columns().begin(),
                                        calibration_.free_columns().end(),
                                        static_cast<int>(column));
    }
    if (is_only_free) return truth_;
    CalibrationProblem problem = calibration_.ProblemOf(exact_);
    problem.priors.resize(0);
    problem.losses.clear();
    values = model_.NominalValues();
    const SolverSummary summary =
        SolveLevenbergMarquardt(problem, task_.options.solver_options, &values);
    return summary.IsSolutionUsable() ? values : truth_;
  }

  FittedProblem AtTruth() const {
    return {model_,
            exact_,
            calibration_.free_columns(),
            calibration_.priors(),
            calibration_.losses(),
            equivalent_};
  }

  void ChooseProfiles() {
    is_profile_.assign(num_free(), 0);
    const UncertaintyOptions& options = task_.options.uncertainty;
    if (options.intervals == IntervalMethod::kLinear) return;
    FittedProblem fit = AtTruth();
    const Eigen::VectorXd nonlinearity = MeasureNonlinearity(
        fit, InverseInformation(
                 JacobianFactor(model_, equivalent_, exact_, fit.free_columns),
                 fit.free_columns, FreePriors(fit)));
    for (Eigen::Index k = 0; k < num_free(); ++k) {
      is_profile_[k] = options.intervals == IntervalMethod::kProfile ||
                       nonlinearity[k] > options.nonlinearity_limit;
    }
  }

  void Describe() {
    result_.truth = NameOf(study_.truth);
    result_.seed = study_.seed;
    result_.trials_wanted = study_.trials;
    result_.confidence = task_.options.uncertainty.confidence;
    result_.sigma_estimated = task_.options.estimate_sigma;
    result_.workspace_poses = study_.workspace_poses;
    nominal_positions_ = model_.Predict(model_.NominalValues(), workspace_);
  }

  void RunRound(int first, int last) {
    std::vector<Trial> trials(last - first);
    ParallelFor(num_threads_, last - first, 1,
                [&](std::int64_t begin, std::int64_t end) {
                  for (std::int64_t k = begin; k < end; ++k) {
                    trials[k] = RunTrial(first + static_cast<int>(k));
                  }
                });
    for (Trial& trial : trials) {
      sums_.Add(trial);
      if (!trial.kept.usable) ++result_.failed;
      result_.trials.push_back(std::move(trial.kept));
    }
  }

  // The arm of this trial: drawn from the priors of its joints, those that are
  // fixed because others depend on them too, or the same.
  Eigen::VectorXd TruthOf(Random* random) const {
    Eigen::VectorXd truth = truth_;
    if (study_.truth != SimulatedTruth::kPriors) return truth;
    for (int column = 0; column < model_.layout().size(); ++column) {
      const ParameterKind kind = model_.layout().parameter(column).kind;
      if (!ParameterLayout::IsJointKind(kind) || !IsCandidate(column)) continue;
      truth[column] +=
          task_.options.identifiability.priors.Of(kind) * random->Normal();
    }
    return truth;
  }

  bool IsCandidate(int column) const {
    const ParameterDecision& decision = pass_.decisions[column];
    return decision.state == ParameterState::kFree ||
           (decision.state == ParameterState::kFixed &&
            decision.rule != "fixed_by_user");
  }

  // The combinations that free parameters identify where fixed ones are not at
  // nominal, to first order.
  Eigen::VectorXd StandIns(const Eigen::VectorXd& truth) const {
    const Eigen::VectorXd nominal = model_.NominalValues();
    Eigen::VectorXd values = truth;
    for (const Relation& relation : pass_.relations) {
      const int fixed = *model_.layout().Find(relation.parameter);
      if (pass_.decisions[fixed].state != ParameterState::kFixed) continue;
      values[fixed] = nominal[fixed];
      for (const auto& [name, coefficient] : relation.terms) {
        values[*model_.layout().Find(name)] +=
            coefficient * (truth[fixed] - nominal[fixed]);
      }
    }
    return values;
  }

  // What exact measurements of such an arm give the free parameters: the fit to
  // them that is nearest to the combinations, in units of the priors. Nothing
  // where it fails: an error against values that are none would count as the
  // trial's.
  std::optional<Eigen::VectorXd> FitExactly(
      const Eigen::VectorXd& truth) const {
    Eigen::VectorXd values = StandIns(truth);
    const MeasurementModel around(
        model_.layout().WithValues(model_.nominal(), values),
        model_.ReferencesAt(values), 1);
    Dataset exact = exact_;
    MeasureExactly(model_, truth, exact.joint_values, &exact);
    values = around.NominalValues();
    CalibrationProblem problem{around, exact, calibration_.free_columns()};
    problem.priors = calibration_.priors();
    const SolverSummary summary =
        SolveLevenbergMarquardt(problem, task_.options.solver_options, &values);
    if (!summary.IsSolutionUsable()) return std::nullopt;
    CountFromNominal(StandIns(truth), &values);
    return values;
  }

  // Rotations of frames and tilts of planes, counted from those of a model
  // whose nominal values are `start`, as they count from the nominal ones.
  void CountFromNominal(const Eigen::VectorXd& start,
                        Eigen::VectorXd* values) const {
    const ParameterLayout& layout = model_.layout();
    const auto add_rotation = [&](int column) {
      const Eigen::Vector3d before = start.segment<3>(column);
      values->segment<3>(column) = VectorFromRotation<double>(
          RotationFromVector<double>(values->segment<3>(column)) *
          RotationFromVector<double>(before));
    };
    add_rotation(layout.Column(ParameterKind::kBaseRotation, 0));
    for (int target = 0; target < layout.shape().num_targets; ++target) {
      add_rotation(layout.Column(ParameterKind::kToolRotation, 0, target));
    }
    for (int column = 0; column < layout.size(); ++column) {
      // To first order, as relations are.
      if (layout.parameter(column).kind == ParameterKind::kPlaneTilt) {
        (*values)[column] += start[column];
      }
    }
  }

  Trial RunTrial(int number) const {
    Random random(study_.seed, static_cast<std::uint64_t>(number));
    const Eigen::VectorXd truth = TruthOf(&random);
    Dataset data = exact_;
    const bool misses =
        study_.joint_angle_sigma > 0.0 || study_.joint_length_sigma > 0.0;
    if (misses || study_.truth == SimulatedTruth::kPriors) {
      SharedMatrix joint_values = data.joint_values;
      if (misses) {
        joint_values =
            MissedJointValues(study_, task_.arm, joint_values, &random);
      }
      MeasureExactly(model_, truth, joint_values, &data);
    }
    AddNoise(study_, reach_, &random, &data);
    const RepeatedCalibration::Outcome outcome = calibration_.Run(data);
    Trial trial;
    const std::optional<Eigen::VectorXd> sought =
        study_.truth == SimulatedTruth::kPriors
            ? FitExactly(truth)
            : std::optional<Eigen::VectorXd>(equivalent_);
    trial.kept.usable = outcome.is_usable && sought.has_value();
    if (!trial.kept.usable) return trial;
    trial.kept.reduced_chi_square = outcome.reduced_chi_square;
    LookAtParameters(*sought, data, outcome, &trial);
    LookAtWorkspace(truth, outcome, &trial);
    return trial;
  }

  void LookAtParameters(const Eigen::VectorXd& truth, const Dataset& data,
                        const RepeatedCalibration::Outcome& outcome,
                        Trial* trial) const {
    const std::vector<int>& columns = calibration_.free_columns();
    trial->kept.estimates = outcome.values(columns);
    trial->errors = trial->kept.estimates - truth(columns);
    trial->deviations = outcome.covariance.Deviations();
    trial->is_held.resize(columns.size());
    const double quantile = StudentTQuantile(
        0.5 + 0.5 * result_.confidence, outcome.covariance.degrees_of_freedom);
    for (std::size_t k = 0; k < columns.size(); ++k) {
      trial->is_held[k] =
          is_profile_[k] != 0
              ? IsInProfile(columns[k], truth, quantile, data, outcome)
              : std::abs(trial->errors[k]) <= quantile * trial->deviations[k];
    }
  }

  // The interval holds the truth where the cost there, minimised over all
  // other parameters, is not above its limit: one solve instead of a search for
  // both bounds.
  bool IsInProfile(int column, const Eigen::VectorXd& truth, double quantile,
                   const Dataset& data,
                   const RepeatedCalibration::Outcome& outcome) const {
    Dataset scaled = data;
    for (ObservationBlock& block : scaled.blocks) {
      block.sigmas = block.sigmas.map() * outcome.sigma_factor;
      for (Eigen::MatrixXd& w : block.whiteners) w /= outcome.sigma_factor;
    }
    const CalibrationProblem problem = calibration_.ProblemOf(scaled);
    const Resolve resolve =
        ResolveByCeres(problem, task_.options.solver_options);
    Eigen::VectorXd values = outcome.values;
    const std::optional<double> least = resolve(-1, &values);
    values = outcome.values;
    values[column] = truth[column];
    const std::optional<double> cost = resolve(column, &values);
    return least && cost && *cost - *least <= quantile * quantile;
  }

  void LookAtWorkspace(const Eigen::VectorXd& truth,
                       const RepeatedCalibration::Outcome& outcome,
                       Trial* trial) const {
    const Eigen::Matrix3Xd true_positions = model_.Predict(truth, workspace_);
    const Eigen::Matrix3Xd errors =
        model_.Predict(outcome.values, workspace_) - true_positions;
    trial->nominal_square =
        (nominal_positions_ - true_positions).colwise().squaredNorm().mean();
    trial->kept.workspace_rms =
        std::sqrt(errors.colwise().squaredNorm().mean());
    const double dof = outcome.covariance.degrees_of_freedom;
    const double bound = StudentTQuantile(0.5 + 0.5 * result_.confidence, dof);
    const double ellipsoid = 3.0 * FisherQuantile(result_.confidence, 3.0, dof);
    const std::vector<PoseCovariance> predicted = PredictCovariances(
        model_, outcome.values, outcome.covariance, workspace_);
    for (Eigen::Index i = 0; i < errors.cols(); ++i) {
      const Eigen::Matrix3d& covariance = predicted[i].position;
      if (!covariance.allFinite()) continue;
      ++trial->num_predicted;
      trial->predicted_square += covariance.trace();
      for (int axis = 0; axis < 3; ++axis) {
        trial->axes_held += std::abs(errors(axis, i)) <=
                            bound * std::sqrt(covariance(axis, axis));
      }
      trial->ellipsoids_held += IsWithin(covariance, errors.col(i), ellipsoid);
    }
    if (trial->num_predicted > 0) {
      trial->predicted_square /= static_cast<double>(trial->num_predicted);
    }
  }

  // Along axes of (nearly) no uncertainty there must be no error.
  static bool IsWithin(const Eigen::Matrix3d& covariance,
                       const Eigen::Vector3d& error, double limit) {
    constexpr double kNothing = 1e-12;
    const Eigen::Matrix3d kept = covariance + Eigen::Matrix3d::Identity() *
                                                  kNothing * covariance.trace();
    return error.dot(kept.inverse() * error) <= limit;
  }

  void ListParameters() {
    const FittedProblem fit = AtTruth();
    const Eigen::VectorXd bounds =
        InverseInformation(
            JacobianFactor(model_, equivalent_, exact_, fit.free_columns),
            fit.free_columns, FreePriors(fit))
            .Deviations();
    double squares = 0.0;
    for (Eigen::Index k = 0; k < num_free(); ++k) {
      const int column = calibration_.free_columns()[k];
      const Parameter& parameter = model_.layout().parameter(column);
      SimulatedParameter one = sums_.DescribeParameter(k);
      one.name = parameter.name;
      one.dimension = parameter.dimension;
      if (study_.truth != SimulatedTruth::kPriors) {
        one.truth = equivalent_[column];
      }
      one.bound = bounds[k];
      one.is_profile = is_profile_[k] != 0;
      squares += std::pow(one.spread / one.bound, 2);
      result_.parameters.push_back(std::move(one));
    }
    result_.inefficiency =
        std::sqrt(squares / std::max(1.0, static_cast<double>(num_free())));
  }

  const CalibrationTask task_;
  const MonteCarloOptions study_;
  const int num_threads_;
  const TrialProgress& progress_;
  const MeasurementModel model_;
  const IdentifiabilityResult pass_;
  const RepeatedCalibration calibration_;
  const Eigen::MatrixXd workspace_;
  Eigen::Matrix3Xd nominal_positions_;
  const double reach_;
  Eigen::VectorXd truth_;
  Eigen::VectorXd equivalent_;  // as far as the free columns determine it
  Dataset exact_;
  std::vector<char> is_profile_;

  TrialSums sums_;
  MonteCarloResult result_;
};

}  // namespace
}  // namespace alidade::internal

namespace alidade {

MonteCarloResult RunMonteCarlo(const Arm& arm, const CalibrationData& data,
                               const CalibrationOptions& options,
                               const MonteCarloOptions& study,
                               const TrialProgress& progress) {
  return internal::MonteCarlo({arm, data, options}, study, progress).Run();
}

}  // namespace alidade
