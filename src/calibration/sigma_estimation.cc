#include "src/calibration/sigma_estimation.h"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "alidade/robust_loss.h"
#include "src/calibration/distance_sigma.h"
#include "src/calibration/preparation.h"
#include "src/calibration/sigma_change.h"
#include "src/calibration/trimmed_fit.h"
#include "src/common/constants.h"
#include "src/identifiability/observability.h"
#include "src/kernel/partition.h"
#include "src/kernel/reduction.h"

namespace alidade::internal {
namespace {

// The ratio of sigma to the priors settles in two or three rounds.
constexpr int kSigmaRounds = 4;

// A sigma below this is exact data, which have none.
constexpr double kSmallestSigma = 1e-12;

Eigen::VectorXd PriorsOfFree(const CalibrationProblem& problem) {
  const auto p = static_cast<Eigen::Index>(problem.free_columns.size());
  Eigen::VectorXd priors =
      Eigen::VectorXd::Constant(p, std::numeric_limits<double>::infinity());
  for (Eigen::Index k = 0; k < p && problem.priors.size() > 0; ++k) {
    const double prior = problem.priors[problem.free_columns[k]];
    if (std::isfinite(prior)) priors[k] = prior;
  }
  return priors;
}

// Degrees of freedom of some rows of the data: their equations less the trace
// of their part of the hat matrix.
double DegreesOfFreedomOfRows(const CalibrationProblem& problem,
                              const Eigen::VectorXd& values,
                              const Dataset& rows) {
  const std::vector<int>& free = problem.free_columns;
  const Eigen::MatrixXd all =
      JacobianFactor(problem.model, values, problem.data, free);
  const Eigen::MatrixXd part =
      &rows == &problem.data
          ? all
          : JacobianFactor(problem.model, values, rows, free);
  const double used = PredictTotal(all, PriorsOfFree(problem), part);
  const auto equations =
      static_cast<double>(GlobalEquations(problem.model.communicator(), rows));
  // What no row and no prior determines uses up nothing.
  return equations -
         (std::isfinite(used) ? used * used : static_cast<double>(free.size()));
}

// What the sigmas of a class are compared with: squared errors and variances of
// its rows, observation after observation, of the global data set; on the root.
struct ErrorsOfClass {
  struct Row {
    double squared_error;
    double variance;
  };
  std::vector<Row> rows;
  std::vector<int> dimensions;  // rows of each observation

  ErrorsOfClass(Communicator* communicator, const SharedVector& errors,
                const Dataset& data) {
    std::vector<std::vector<Row>> rows_of(data.blocks.size());
    std::vector<std::vector<int>> dimensions_of(data.blocks.size());
    Eigen::Index first = 0;
    for (std::size_t k = 0; k < data.blocks.size(); ++k) {
      const ObservationBlock& block = data.blocks[k];
      for (Eigen::Index i = 0; i < block.size(); ++i) {
        const std::size_t before = rows_of[k].size();
        for (int row = 0; row < block.rows_each(); ++row) {
          const double sigma = block.sigmas(row, i);
          if (std::isinf(sigma)) continue;
          const double error = errors[first + row];
          rows_of[k].push_back({error * error, sigma * sigma});
        }
        first += block.rows_each();
        const auto count = static_cast<int>(rows_of[k].size() - before);
        if (count > 0) dimensions_of[k].push_back(count);
      }
    }
    rows = InOrder(communicator, data, std::move(rows_of));
    dimensions = InOrder(communicator, data, std::move(dimensions_of));
  }

  // By what factor the sigmas are too small with a variance added to each.
  double Factor(LossKind loss, double freedom, double added_variance) const {
    double sum = 0.0;
    std::vector<double> norms;
    std::size_t row = 0;
    for (const int dimension : dimensions) {
      double squared = 0.0;
      for (int k = 0; k < dimension; ++k, ++row) {
        squared +=
            rows[row].squared_error / (rows[row].variance + added_variance);
      }
      sum += squared;
      // Norms of several dimensions compare by their medians.
      norms.push_back(std::sqrt(squared) / medians[dimension]);
    }
    if (loss == LossKind::kNone) return std::sqrt(sum / freedom);
    return RobustScale(std::move(norms), 1) * MedianOfChi(1) *
           std::sqrt(static_cast<double>(rows.size()) / freedom);
  }

  double LargestVariance() const {
    double largest = 0.0;
    for (const Row& each : rows) largest = std::max(largest, each.variance);
    return largest;
  }

  const std::array<double, 4> medians = {1.0, MedianOfChi(1), MedianOfChi(2),
                                         MedianOfChi(3)};
};

// The change that makes the sigmas agree with the errors. Where they are too
// small, the model leaves more than the instrument: a variance that all rows
// have in common is added. Where they are too large, all are scaled.
SigmaChange FindChange(LossKind loss, const ErrorsOfClass& errors,
                       double freedom) {
  constexpr int kBisections = 40;
  const double factor = errors.Factor(loss, freedom, 0.0);
  if (!(factor > 1.0)) return {factor, 0.0};
  double low = 0.0;
  double high = factor * std::sqrt(errors.LargestVariance());
  for (int step = 0; step < kBisections; ++step) {
    const double middle = 0.5 * (low + high);
    const bool is_small = errors.Factor(loss, freedom, middle * middle) > 1.0;
    (is_small ? low : high) = middle;
  }
  return {1.0, high};
}

constexpr double kFewestFreedom = 3.0;

// Residuals of a fit that uses up nearly all equations say nothing of sigma.
bool TellsSigma(double freedom, Eigen::Index equations) {
  constexpr double kSmallestPart = 0.1;
  return freedom >= std::max(kFewestFreedom,
                             kSmallestPart * static_cast<double>(equations));
}

// Rounds of a fit and of the sigmas that its residuals agree with.
class SigmaRounds {
 public:
  SigmaRounds(const CalibrationTask& task, const MeasurementModel& model)
      : model_(model), stated_(task), task_(task) {}

  /// From the sigmas and the start of `first`, whose sigmas are about right.
  SigmaRounds(const CalibrationTask& stated, const MeasurementModel& model,
              CalibrationTask first)
      : model_(model), stated_(stated), task_(std::move(first)), round_(1) {
    stated_.start = task_.start;
  }

  /// Fits once, with these options, and changes the sigmas. The sigmas of the
  /// first round may be far too small for what the model leaves.
  void Run(const IdentifiabilityOptions& options) {
    Fit fit = round_++ == 0 ? FitPart(task_, model_, options)
                            : FitOnce(task_, model_, options);
    sigmas_ = {};
    if (!fit.summary.IsSolutionUsable()) return Stop();
    CalibrationTask next = stated_;
    for (const RowClass which : {RowClass::kLength, RowClass::kRotation}) {
      if (!Change(which, fit, &next)) return;
    }
    task_ = std::move(next);
    sigmas_ = MedianSigmas();
    last_ = std::move(fit);
  }

  void RunAll(int rounds) {
    while (round_ < rounds && !has_stopped_) {
      Run(task_.options.identifiability);
    }
  }

  /// -2 log of the posterior density of the values and the sigmas, but for
  /// constants: what alternatives compare by. Infinite where there are none.
  double Cost() const {
    if (!(sigmas_.length > 0.0)) return kInfinity;
    const Fit fit = FitOnce(task_, model_, task_.options.identifiability);
    if (!fit.summary.IsSolutionUsable()) return kInfinity;
    const Dataset& data = task_.data.training;
    VectorBuilder logs(data.num_observations());
    double* log = logs.map().data();
    for (const ObservationBlock& block : data.blocks) {
      for (Eigen::Index i = 0; i < block.size(); ++i) {
        double sum = 0.0;
        for (int row = 0; row < block.rows_each(); ++row) {
          const double sigma = block.sigmas(row, i);
          if (std::isfinite(sigma)) sum += 2.0 * std::log(sigma);
        }
        *log++ = sum;
      }
    }
    return fit.summary.final_cost - ExcessOfPriors(fit) +
           SumInOrder(model_.communicator(), data, logs.Freeze());
  }

  /// A fit to the half of the data that agree best, from the last fit.
  std::optional<TrimmedFit> Trim() const {
    if (!last_) return std::nullopt;
    return FitTrimmed(ProblemOf(task_, model_, last_->identifiability),
                      last_->values);
  }

  const EstimatedSigmas& sigmas() const { return sigmas_; }
  const CalibrationTask& task() const { return task_; }

 private:
  void Stop() { has_stopped_ = true; }

  // A zero that was set wrong is not drawn from a prior of manufacture: beyond
  // five standard deviations the prior says that much and no more, as one with
  // a wide tail of small weight would.
  double ExcessOfPriors(const Fit& fit) const {
    constexpr double kMost = 25.0;
    const CalibrationProblem problem =
        ProblemOf(task_, model_, fit.identifiability);
    const Eigen::VectorXd nominal = model_.NominalValues();
    double excess = 0.0;
    for (const int column : problem.ColumnsWithPrior()) {
      const double times =
          (fit.values[column] - nominal[column]) / problem.priors[column];
      excess += std::max(0.0, times * times - kMost);
    }
    return excess;
  }

  // False where that ends the rounds.
  bool Change(RowClass which, const Fit& fit, CalibrationTask* next) {
    Communicator* const communicator = task_.communicator;
    const Dataset current = RowsOfClass(task_.data.training, which);
    const Eigen::Index equations = GlobalEquations(communicator, current);
    if (equations == 0) return true;
    const CalibrationProblem problem =
        ProblemOf(task_, model_, fit.identifiability);
    const double freedom = DegreesOfFreedomOfRows(problem, fit.values, current);
    if (!TellsSigma(freedom, equations)) {
      UseNominalResiduals();
      return false;
    }
    const Dataset rows = RowsOfClass(stated_.data.training, which);
    const ErrorsOfClass errors(communicator, model_.Errors(fit.values, rows),
                               rows);
    const SigmaChange change = ComputeOnRoot(communicator, rows, [&] {
      return FindChange(task_.options.loss, errors, freedom);
    });
    ChangeSigmas(which, change, &next->data.training);
    if (next->data.validation) {
      ChangeSigmas(which, change, &*next->data.validation);
    }
    if (MedianSigma(which, next->data.training, communicator) >
        kSmallestSigma) {
      return true;
    }
    Stop();
    return false;
  }

  // The sigmas that the nominal geometry would have: more than the true ones,
  // so that priors weigh more than they should, and no fit runs away.
  void UseNominalResiduals() {
    Stop();
    task_ = stated_;
    const double freedom = FreedomBesideFrames();
    if (freedom < kFewestFreedom) return;
    const auto equations = static_cast<double>(
        GlobalEquations(task_.communicator, stated_.data.training));
    const double typical =
        std::sqrt(equations / freedom) *
        TypicalResidual(model_, stated_.data.training, model_.NominalValues());
    if (!(typical > 0.0) || !std::isfinite(typical)) return;
    ScaleSigmas(typical, &task_.data.training);
    if (task_.data.validation) ScaleSigmas(typical, &*task_.data.validation);
    sigmas_ = MedianSigmas();
    sigmas_.is_bound = true;
  }

  // Equations less what base, targets and references, found from the same
  // data, have taken: the nominal residuals have no more degrees of freedom.
  double FreedomBesideFrames() const {
    const CandidateGroups& candidates =
        stated_.options.identifiability.candidates;
    const ParameterLayout& layout = model_.layout();
    std::vector<int> frames;
    for (int column = 0; column < layout.size(); ++column) {
      switch (layout.parameter(column).kind) {
        case ParameterKind::kBaseTranslation:
        case ParameterKind::kBaseRotation:
          if (candidates.base) frames.push_back(column);
          break;
        case ParameterKind::kToolTranslation:
        case ParameterKind::kToolRotation:
          if (candidates.tool) frames.push_back(column);
          break;
        case ParameterKind::kPoint:
        case ParameterKind::kPlaneTilt:
        case ParameterKind::kPlaneOffset:
          frames.push_back(column);
          break;
        default:
          break;
      }
    }
    const Dataset& data = stated_.data.training;
    const auto equations =
        static_cast<double>(GlobalEquations(task_.communicator, data));
    if (frames.empty()) return equations;
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(
        JacobianFactor(model_, model_.NominalValues(), data, frames));
    qr.setThreshold(1e-9);
    return equations - static_cast<double>(qr.rank());
  }

  EstimatedSigmas MedianSigmas() const {
    const auto median = [this](RowClass which) {
      return MedianSigma(which, task_.data.training, task_.communicator);
    };
    return {median(RowClass::kLength), median(RowClass::kRotation)};
  }

  const MeasurementModel& model_;
  CalibrationTask stated_;
  CalibrationTask task_;
  std::optional<Fit> last_;
  EstimatedSigmas sigmas_;
  int round_ = 0;
  bool has_stopped_ = false;
};

// Where a joint's zero is degrees off, the nominal residuals are so large that
// with sigmas of their size the priors hold the arm there, and sigmas and
// values agree with each other: the posterior has two maxima. Rounds that begin
// with wide priors come to the other one, if there is any.
std::optional<SigmaRounds> FromWidePriors(const CalibrationTask& task,
                                          const MeasurementModel& model,
                                          const EstimatedSigmas& found) {
  constexpr double kLess = 0.7;
  if (task.options.identifiability.method != IdentifiabilityMethod::kRank) {
    return std::nullopt;
  }
  SigmaRounds wide(task, model);
  wide.Run(WidenPriors(task.options.identifiability));
  const EstimatedSigmas& sigmas = wide.sigmas();
  const bool is_other =
      sigmas.length > 0.0 && !sigmas.is_bound &&
      (sigmas.length < kLess * found.length ||
       sigmas.rotation < kLess * found.rotation || !(found.length > 0.0));
  if (!is_other) return std::nullopt;
  wide.RunAll(kSigmaRounds);
  return wide;
}

constexpr double kMuchLess = 0.5;

// Where nearly half of the observations are off together, a robust loss whose
// scale comes from all of them takes them in: sigma and fit agree with each
// other, and the posterior has two maxima again.
std::optional<SigmaRounds> FromTrimmed(const CalibrationTask& task,
                                       const MeasurementModel& model,
                                       const SigmaRounds& found) {
  if (task.options.loss == LossKind::kNone || !(found.sigmas().length > 0.0) ||
      found.sigmas().is_bound) {
    return std::nullopt;
  }
  const std::optional<TrimmedFit> trimmed = found.Trim();
  if (!trimmed || !(trimmed->scale < kMuchLess)) return std::nullopt;
  CalibrationTask first = found.task();
  first.start = trimmed->values;
  ScaleSigmas(std::max(trimmed->scale, kSmallestSigma), &first.data.training);
  SigmaRounds rounds(task, model, std::move(first));
  rounds.RunAll(kSigmaRounds + 1);
  return rounds;
}

EstimatedSigmas Settle(CalibrationTask* task) {
  const MeasurementModel model(task->arm, task->data.references,
                               task->execution());
  SigmaRounds rounds(*task, model);
  rounds.RunAll(kSigmaRounds);
  const std::optional<SigmaRounds> wide =
      FromWidePriors(*task, model, rounds.sigmas());
  const bool is_wide_better =
      wide && !wide->sigmas().is_bound && wide->Cost() < rounds.Cost();
  const SigmaRounds& so_far = is_wide_better ? *wide : rounds;
  const std::optional<SigmaRounds> trimmed = FromTrimmed(*task, model, so_far);
  const bool is_trimmed_better =
      trimmed && !trimmed->sigmas().is_bound && trimmed->Cost() < so_far.Cost();
  const SigmaRounds& best = is_trimmed_better ? *trimmed : so_far;
  *task = best.task();
  EstimatedSigmas sigmas = best.sigmas();
  sigmas.has_two_groups = trimmed && !is_trimmed_better &&
                          trimmed->sigmas().length > 0.0 &&
                          trimmed->sigmas().length < kMuchLess * sigmas.length;
  return sigmas;
}

}  // namespace

EstimatedSigmas EstimateSigmas(CalibrationTask* task) {
  const bool has_distances =
      task->data.training.Has(MeasurementKind::kPointDistance);
  if (!has_distances) return Settle(task);
  CalibrationTask stated = *task;
  EstimatedSigmas sigmas = Settle(task);
  if (!(sigmas.length > 0.0) || sigmas.is_bound) return sigmas;
  const MeasurementModel model(task->arm, task->data.references,
                               task->execution());
  const Fit fit = FitOnce(*task, model, task->options.identifiability);
  if (!fit.summary.IsSolutionUsable()) return sigmas;
  const double factor = EstimateDistanceFactor(*task, model, fit);
  if (factor == 1.0) return sigmas;
  ScaleDistanceSigmas(factor, &stated.data.training);
  *task = std::move(stated);
  sigmas = Settle(task);
  sigmas.distance_factor = factor;
  return sigmas;
}

double MedianLengthSigma(const Dataset& data, Communicator* communicator) {
  return MedianSigma(RowClass::kLength, data, communicator);
}

double DegreesOfFreedom(const CalibrationProblem& problem,
                        const Eigen::VectorXd& values) {
  return DegreesOfFreedomOfRows(problem, values, problem.data);
}

double DegreesOfFreedom(const CalibrationProblem& problem,
                        const Eigen::VectorXd& values, const Dataset& part) {
  return DegreesOfFreedomOfRows(problem, values, part);
}

}  // namespace alidade::internal
