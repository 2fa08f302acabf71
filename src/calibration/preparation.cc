#include "src/calibration/preparation.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "alidade/robust_loss.h"
#include "src/identifiability/analysis.h"
#include "src/identifiability/observability.h"
#include "src/identifiability/rules.h"
#include "src/kernel/compression.h"
#include "src/kernel/partition.h"

namespace alidade::internal {
namespace {

// The ratio of sigma to the priors settles in two or three rounds.
constexpr int kSigmaRounds = 4;

// A sigma below this is exact data, which have none.
constexpr double kSmallestSigma = 1e-12;

// Rows of lengths, or of orientations.
enum class RowClass { kLength, kRotation };

bool IsOf(RowClass which, int row) {
  return (row < 3) == (which == RowClass::kLength);
}

// Distances of reference points are known beforehand; no residual tells how
// well.
bool IsEstimated(const ObservationBlock& block) {
  return block.kind != MeasurementKind::kPointDistance;
}

// The data with only the rows of one class measured, correlations left out.
Dataset RowsOfClass(const Dataset& data, RowClass which) {
  Dataset rows = data;
  for (ObservationBlock& block : rows.blocks) {
    block.whiteners.clear();
    MatrixBuilder sigmas(block.sigmas);
    for (int row = 0; row < block.rows_each(); ++row) {
      if (IsOf(which, row) && IsEstimated(block)) continue;
      sigmas.map().row(row).setConstant(
          std::numeric_limits<double>::infinity());
    }
    block.sigmas = sigmas.Freeze();
  }
  return rows;
}

// What the sigmas of a class become: scale * sqrt(sigma^2 + added^2).
struct SigmaChange {
  double scale = 1.0;
  double added = 0.0;
};

// Rows that were measured, whose columns of the whitener are not zero.
std::vector<Eigen::Index> MeasuredRows(const Eigen::MatrixXd& whitener) {
  std::vector<Eigen::Index> rows;
  for (Eigen::Index row = 0; row < whitener.cols(); ++row) {
    if (!whitener.col(row).isZero(0.0)) rows.push_back(row);
  }
  return rows;
}

Eigen::MatrixXd Inverse(const Eigen::MatrixXd& matrix) {
  return matrix.llt().solve(
      Eigen::MatrixXd::Identity(matrix.rows(), matrix.cols()));
}

// The whitener of an observation after its covariance has changed.
Eigen::MatrixXd ChangedWhitener(const Eigen::MatrixXd& whitener, RowClass which,
                                const SigmaChange& change) {
  const std::vector<Eigen::Index> measured = MeasuredRows(whitener);
  const Eigen::MatrixXd information = whitener.transpose() * whitener;
  Eigen::MatrixXd covariance = Inverse(information(measured, measured));
  for (std::size_t k = 0; k < measured.size(); ++k) {
    if (!IsOf(which, static_cast<int>(measured[k]))) continue;
    const auto row = static_cast<Eigen::Index>(k);
    covariance(row, row) += change.added * change.added;
    covariance.row(row) *= change.scale;
    covariance.col(row) *= change.scale;
  }
  const Eigen::MatrixXd changed = Inverse(covariance).llt().matrixU();
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(whitener.rows(), whitener.cols());
  all(measured, measured) = changed;
  return all;
}

void ChangeSigmas(RowClass which, const SigmaChange& change, Dataset* data) {
  for (ObservationBlock& block : data->blocks) {
    if (!IsEstimated(block)) continue;
    MatrixBuilder changed(block.sigmas);
    for (int row = 0; row < block.rows_each(); ++row) {
      if (!IsOf(which, row)) continue;
      MatrixBuilder::Map all = changed.map();
      auto sigmas = all.row(row).array();
      sigmas =
          change.scale * (sigmas.square() + change.added * change.added).sqrt();
    }
    block.sigmas = changed.Freeze();
    for (Eigen::MatrixXd& whitener : block.whiteners) {
      if (whitener.size() == 0) continue;
      whitener = ChangedWhitener(whitener, which, change);
    }
  }
}

// The one sigma of all measured rows; nothing where they differ.
std::optional<double> CommonSigma(RowClass which, const Dataset& data) {
  std::optional<double> common;
  for (const ObservationBlock& block : data.blocks) {
    if (!IsEstimated(block)) continue;
    for (Eigen::Index i = 0; i < block.size(); ++i) {
      for (int row = 0; row < block.rows_each(); ++row) {
        const double sigma = block.sigmas(row, i);
        if (!IsOf(which, row) || !std::isfinite(sigma)) continue;
        if (common && *common != sigma) return std::nullopt;
        common = sigma;
      }
    }
  }
  return common;
}

double MedianSigma(RowClass which, const Dataset& data,
                   Communicator* communicator) {
  if (!data.partition) {
    const std::optional<double> common = CommonSigma(which, data);
    if (common) return *common;
  }
  std::vector<std::vector<double>> lists(data.blocks.size());
  for (std::size_t k = 0; k < lists.size(); ++k) {
    const ObservationBlock& block = data.blocks[k];
    if (!IsEstimated(block)) continue;
    for (int row = 0; row < block.rows_each(); ++row) {
      if (!IsOf(which, row)) continue;
      for (const double sigma : block.sigmas.row(row)) {
        if (std::isfinite(sigma)) lists[k].push_back(sigma);
      }
    }
  }
  std::vector<double> sigmas = InOrder(communicator, data, std::move(lists));
  return ComputeOnRoot(communicator, data, [&] {
    if (sigmas.empty()) return 0.0;
    const auto middle =
        sigmas.begin() + static_cast<std::ptrdiff_t>(sigmas.size() / 2);
    std::nth_element(sigmas.begin(), middle, sigmas.end());
    return *middle;
  });
}

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
double FreedomOfRows(const CalibrationProblem& problem,
                     const Eigen::VectorXd& values, const Dataset& rows) {
  const std::vector<int>& free = problem.free_columns;
  const Eigen::MatrixXd all =
      JacobianFactor(problem.model, values, problem.data, free);
  const Eigen::MatrixXd part =
      JacobianFactor(problem.model, values, rows, free);
  const double used = PredictTotal(all, PriorsOfFree(problem), part);
  const auto equations =
      static_cast<double>(GlobalEquations(problem.model.communicator(), rows));
  // What no row and no prior tells uses up nothing.
  return equations -
         (std::isfinite(used) ? used * used : static_cast<double>(free.size()));
}

void ScaleAll(double factor, Dataset* data) {
  ChangeSigmas(RowClass::kLength, {factor, 0.0}, data);
  ChangeSigmas(RowClass::kRotation, {factor, 0.0}, data);
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

std::vector<std::string> WithoutJoints(const std::vector<std::string>& names,
                                       const ParameterLayout& layout) {
  std::vector<std::string> frames;
  for (const std::string& name : names) {
    const std::optional<int> column = layout.Find(name);
    const bool is_joint =
        column && ParameterLayout::IsJointKind(layout.parameter(*column).kind);
    if (!is_joint) frames.push_back(name);
  }
  return frames;
}

}  // namespace

double TypicalResidual(const MeasurementModel& model, const Dataset& data,
                       const Eigen::VectorXd& values) {
  const SharedVector squared = SquaredNorms(model.Errors(values, data), data);
  std::vector<std::vector<double>> lists(data.blocks.size());
  Eigen::Index count = 0;
  for (std::size_t k = 0; k < lists.size(); ++k) {
    for (Eigen::Index i = 0; i < data.blocks[k].size(); ++i, ++count) {
      const int dimension = data.blocks[k].Dimension(i);
      if (dimension == 0) continue;
      lists[k].push_back(std::sqrt(squared[count]) / MedianOfChi(dimension));
    }
  }
  std::vector<double> norms =
      InOrder(model.communicator(), data, std::move(lists));
  return ComputeOnRoot(model.communicator(), data, [&] {
    return RobustScale(std::move(norms), 1) * MedianOfChi(1);
  });
}

CalibrationProblem ProblemOf(const CalibrationTask& task,
                             const MeasurementModel& model,
                             const IdentifiabilityResult& pass) {
  CalibrationProblem problem{model, task.data.training, FreeColumns(pass),
                             pass.nominal_rank, PriorsOf(pass)};
  if (task.options.bounds.empty()) return problem;
  const double infinity = std::numeric_limits<double>::infinity();
  problem.lower.setConstant(model.layout().size(), -infinity);
  problem.upper.setConstant(model.layout().size(), infinity);
  for (const ParameterBounds& bounds : task.options.bounds) {
    const int column = *model.layout().Find(bounds.parameter);
    problem.lower[column] = bounds.lower;
    problem.upper[column] = bounds.upper;
  }
  return problem;
}

Fit FitOnce(const CalibrationTask& task, const MeasurementModel& model,
            const IdentifiabilityOptions& options) {
  Fit fit;
  fit.values = model.NominalValues();
  fit.identifiability =
      AnalyzeIdentifiability(model, task.data.training, options);
  const CalibrationProblem problem =
      ProblemOf(task, model, fit.identifiability);
  fit.summary = SolveRobust(problem, task.options.loss,
                            task.options.solver_options, &fit.values);
  return fit;
}

Fit FitPart(const CalibrationTask& task, const MeasurementModel& model,
            const IdentifiabilityOptions& options) {
  constexpr int kRounds = 2;
  CalibrationTask coarse = task;
  if (task.options.loss != LossKind::kNone)
    coarse.options.loss = LossKind::kHuber;
  Fit fit;
  fit.values = model.NominalValues();
  for (int round = 0; round < kRounds; ++round) {
    const double typical =
        TypicalResidual(model, task.data.training, fit.values);
    coarse.data.training = task.data.training;
    if (std::isfinite(typical)) {
      ScaleAll(std::max(1.0, typical), &coarse.data.training);
    }
    Fit next = FitOnce(coarse, model, options);
    if (!next.summary.IsSolutionUsable()) return next;
    fit = std::move(next);
  }
  return fit;
}

IdentifiabilityOptions FramesOnly(const IdentifiabilityOptions& options,
                                  const ParameterLayout& layout) {
  IdentifiabilityOptions frames = options;
  // The published rules know joints alone.
  frames.method = IdentifiabilityMethod::kRank;
  frames.candidates.joints = false;
  frames.fix = WithoutJoints(options.fix, layout);
  frames.free = WithoutJoints(options.free, layout);
  frames.prefer = WithoutJoints(options.prefer, layout);
  return frames;
}

IdentifiabilityOptions OffsetsOnly(const IdentifiabilityOptions& options,
                                   const MeasurementModel& model) {
  const ParameterLayout& layout = model.layout();
  const Arm& arm = model.nominal();
  IdentifiabilityOptions offsets = FramesOnly(options, layout);
  offsets.candidates.joints = true;
  for (const Parameter& parameter : layout.parameters()) {
    if (!ParameterLayout::IsJointKind(parameter.kind)) continue;
    const bool revolute =
        arm.joints[parameter.index].type == JointType::kRevolute;
    if (parameter.kind ==
        (revolute ? ParameterKind::kTheta : ParameterKind::kR)) {
      continue;
    }
    offsets.fix.push_back(parameter.name);
  }
  for (const std::string& name : options.fix) {
    if (std::find(offsets.fix.begin(), offsets.fix.end(), name) ==
        offsets.fix.end()) {
      offsets.fix.push_back(name);
    }
  }
  return offsets;
}

namespace {

// Residuals of a fit that uses up nearly all equations say nothing of sigma.
bool TellsSigma(double freedom, Eigen::Index equations) {
  constexpr double kFewest = 3.0;
  constexpr double kSmallestPart = 0.1;
  return freedom >=
         std::max(kFewest, kSmallestPart * static_cast<double>(equations));
}

// The sigmas that the nominal geometry would have: more than the true ones, so
// that priors weigh more than they should, and no fit runs away.
EstimatedSigmas UseNominalResiduals(const MeasurementModel& model,
                                    const Dataset& stated,
                                    CalibrationTask* task) {
  const double typical = TypicalResidual(model, stated, model.NominalValues());
  task->data.training = stated;
  if (!(typical > 0.0) || !std::isfinite(typical)) return {};
  ScaleAll(typical, &task->data.training);
  if (task->data.validation) ScaleAll(typical, &*task->data.validation);
  const auto median = [&](RowClass which) {
    return MedianSigma(which, task->data.training, task->communicator);
  };
  return {median(RowClass::kLength), median(RowClass::kRotation), true};
}

}  // namespace

EstimatedSigmas EstimateSigmas(CalibrationTask* task) {
  const MeasurementModel model(task->arm, task->data.references,
                               task->execution());
  Communicator* const communicator = task->communicator;
  const Dataset stated = task->data.training;
  const std::optional<Dataset> stated_validation = task->data.validation;
  EstimatedSigmas sigmas;
  for (int round = 0; round < kSigmaRounds; ++round) {
    // The first sigmas may be far too small for what the model leaves.
    const Fit fit = round == 0
                        ? FitPart(*task, model, task->options.identifiability)
                        : FitOnce(*task, model, task->options.identifiability);
    if (!fit.summary.IsSolutionUsable()) return {};
    const CalibrationProblem problem =
        ProblemOf(*task, model, fit.identifiability);
    Dataset next = stated;
    std::optional<Dataset> next_validation = stated_validation;
    for (const RowClass which : {RowClass::kLength, RowClass::kRotation}) {
      const Dataset current = RowsOfClass(task->data.training, which);
      const Eigen::Index equations = GlobalEquations(communicator, current);
      if (equations == 0) continue;
      const double freedom = FreedomOfRows(problem, fit.values, current);
      if (!TellsSigma(freedom, equations)) {
        task->data.validation = stated_validation;
        return UseNominalResiduals(model, stated, task);
      }
      const Dataset rows = RowsOfClass(stated, which);
      const ErrorsOfClass errors(communicator, model.Errors(fit.values, rows),
                                 rows);
      const SigmaChange change = ComputeOnRoot(communicator, rows, [&] {
        return FindChange(task->options.loss, errors, freedom);
      });
      ChangeSigmas(which, change, &next);
      if (!(MedianSigma(which, next, communicator) > kSmallestSigma)) return {};
      if (next_validation) ChangeSigmas(which, change, &*next_validation);
    }
    task->data.training = std::move(next);
    task->data.validation = std::move(next_validation);
    sigmas.length =
        MedianSigma(RowClass::kLength, task->data.training, communicator);
    sigmas.rotation =
        MedianSigma(RowClass::kRotation, task->data.training, communicator);
  }
  return sigmas;
}

double MedianLengthSigma(const Dataset& data, Communicator* communicator) {
  return MedianSigma(RowClass::kLength, data, communicator);
}

double DegreesOfFreedom(const CalibrationProblem& problem,
                        const Eigen::VectorXd& values) {
  return FreedomOfRows(problem, values, problem.data);
}

}  // namespace alidade::internal
