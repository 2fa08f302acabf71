#include "preparation.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "alidade/identifiability/analysis.h"
#include "alidade/identifiability/rules.h"
#include "alidade/measurement/compression.h"
#include "alidade/measurement/robust_loss.h"
#include "frame_fit.h"

namespace alidade {
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
    for (int row = 0; row < block.rows_each(); ++row) {
      if (IsOf(which, row) && IsEstimated(block)) continue;
      block.sigmas.row(row).setConstant(
          std::numeric_limits<double>::infinity());
    }
  }
  return rows;
}

// What the sigmas of a class become: scale * sqrt(sigma^2 + added^2).
struct SigmaChange {
  double scale = 1.0;
  double added = 0.0;
};

// The whitener of an observation after its covariance has changed.
Eigen::MatrixXd ChangedWhitener(const Eigen::MatrixXd& whitener,
                                RowClass which, const SigmaChange& change) {
  Eigen::MatrixXd covariance =
      (whitener.transpose() * whitener)
          .llt()
          .solve(Eigen::MatrixXd::Identity(whitener.rows(), whitener.cols()));
  for (Eigen::Index row = 0; row < covariance.rows(); ++row) {
    if (!IsOf(which, static_cast<int>(row))) continue;
    covariance(row, row) += change.added * change.added;
    covariance.row(row) *= change.scale;
    covariance.col(row) *= change.scale;
  }
  const Eigen::MatrixXd information = covariance.llt().solve(
      Eigen::MatrixXd::Identity(covariance.rows(), covariance.cols()));
  return information.llt().matrixU();
}

void ChangeSigmas(RowClass which, const SigmaChange& change, Dataset* data) {
  for (ObservationBlock& block : data->blocks) {
    if (!IsEstimated(block)) continue;
    for (int row = 0; row < block.rows_each(); ++row) {
      if (!IsOf(which, row)) continue;
      auto sigmas = block.sigmas.row(row).array();
      sigmas = change.scale *
               (sigmas.square() + change.added * change.added).sqrt();
    }
    for (Eigen::MatrixXd& whitener : block.whiteners) {
      if (whitener.size() == 0) continue;
      // Rows that were not measured have no covariance to change.
      if ((whitener.rowwise().norm().array() == 0.0).any()) continue;
      whitener = ChangedWhitener(whitener, which, change);
    }
  }
}

double MedianSigma(RowClass which, const Dataset& data) {
  std::vector<double> sigmas;
  for (const ObservationBlock& block : data.blocks) {
    if (!IsEstimated(block)) continue;
    for (int row = 0; row < block.rows_each(); ++row) {
      if (!IsOf(which, row)) continue;
      for (const double sigma : block.sigmas.row(row)) {
        if (std::isfinite(sigma)) sigmas.push_back(sigma);
      }
    }
  }
  if (sigmas.empty()) return 0.0;
  const auto middle = sigmas.begin() + sigmas.size() / 2;
  std::nth_element(sigmas.begin(), middle, sigmas.end());
  return *middle;
}

// The inverse of J^T J + P^-1 in units that make it well scaled, and what turns
// a factor of the free columns into them.
struct Information {
  Eigen::VectorXd scale;
  Eigen::MatrixXd inverse;
};

Information Invert(const CalibrationProblem& problem,
                   const Eigen::MatrixXd& factor) {
  const Eigen::Index p = factor.cols();
  Information information;
  information.scale = factor.colwise().norm();
  Eigen::VectorXd prior = Eigen::VectorXd::Zero(p);
  for (Eigen::Index k = 0; k < p; ++k) {
    if (problem.priors.size() > 0) {
      const double deviation = problem.priors[problem.free_columns[k]];
      prior[k] = std::isfinite(deviation) ? 1.0 / (deviation * deviation) : 0.0;
    }
    double& scale = information.scale[k];
    scale = std::sqrt(scale * scale + prior[k]);
    scale = scale > 0.0 ? 1.0 / scale : 1.0;
  }
  const Eigen::MatrixXd scaled = factor * information.scale.asDiagonal();
  Eigen::MatrixXd normal = scaled.transpose() * scaled;
  normal.diagonal().array() += prior.array() * information.scale.array().square();
  information.inverse =
      normal.completeOrthogonalDecomposition().pseudoInverse();
  return information;
}

// Degrees of freedom of some rows of the data: their equations less the trace
// of their part of the hat matrix.
double FreedomOfRows(const CalibrationProblem& problem,
                     const Eigen::VectorXd& values, const Dataset& rows) {
  const std::vector<int>& free = problem.free_columns;
  const Information information =
      Invert(problem, JacobianFactor(problem.model, values, problem.data, free));
  const Eigen::MatrixXd part =
      JacobianFactor(problem.model, values, rows, free) *
      information.scale.asDiagonal();
  const double used = (part * information.inverse * part.transpose()).trace();
  return static_cast<double>(rows.num_equations()) - used;
}

// By what factor the sigmas of `rows` are too small for these errors.
double SigmaFactor(LossKind loss, const Eigen::VectorXd& errors,
                   const Dataset& rows, double freedom) {
  const Eigen::VectorXd squared = SquaredNorms(errors, rows);
  if (loss == LossKind::kNone) return std::sqrt(squared.sum() / freedom);
  // Norms of observations of several dimensions compare by their medians.
  const Eigen::VectorXi dimensions = Dimensions(rows);
  std::vector<double> norms;
  for (Eigen::Index i = 0; i < squared.size(); ++i) {
    if (dimensions[i] == 0) continue;
    norms.push_back(std::sqrt(squared[i]) / MedianOfChi(dimensions[i]));
  }
  const auto equations = static_cast<double>(rows.num_equations());
  return RobustScale(norms, 1) * MedianOfChi(1) *
         std::sqrt(equations / freedom);
}

double LargestSigma(const Dataset& rows) {
  double largest = 0.0;
  for (const ObservationBlock& block : rows.blocks) {
    for (const double sigma : block.sigmas.reshaped()) {
      if (std::isfinite(sigma)) largest = std::max(largest, sigma);
    }
  }
  return largest;
}

// The change that makes the sigmas of `rows` agree with the errors. Where they
// are too small, the model leaves more than the instrument: a variance that all
// rows have in common is added. Where they are too large, all are scaled.
SigmaChange FindChange(LossKind loss, const Eigen::VectorXd& errors,
                       RowClass which, const Dataset& rows, double freedom) {
  constexpr int kBisections = 40;
  const double factor = SigmaFactor(loss, errors, rows, freedom);
  if (!(factor > 1.0)) return {factor, 0.0};
  double low = 0.0;
  double high = factor * LargestSigma(rows);
  for (int step = 0; step < kBisections; ++step) {
    const double middle = 0.5 * (low + high);
    Dataset changed = rows;
    ChangeSigmas(which, {1.0, middle}, &changed);
    (SigmaFactor(loss, errors, changed, freedom) > 1.0 ? low : high) = middle;
  }
  return {1.0, high};
}

}  // namespace

CalibrationProblem ProblemOf(const JobConfig& config,
                             const MeasurementModel& model,
                             const IdentifiabilityResult& pass) {
  CalibrationProblem problem{model, config.data, FreeColumns(pass),
                             pass.nominal_rank, PriorsOf(pass)};
  if (config.bounds.empty()) return problem;
  const double infinity = std::numeric_limits<double>::infinity();
  problem.lower.setConstant(model.layout().size(), -infinity);
  problem.upper.setConstant(model.layout().size(), infinity);
  for (const ParameterBounds& bounds : config.bounds) {
    problem.lower[bounds.column] = bounds.lower;
    problem.upper[bounds.column] = bounds.upper;
  }
  return problem;
}

Fit FitOnce(const JobConfig& config, const MeasurementModel& model,
            const IdentifiabilityOptions& options) {
  Fit fit;
  fit.values = model.NominalValues();
  fit.identifiability = AnalyzeIdentifiability(model, config.data, options);
  const CalibrationProblem problem =
      ProblemOf(config, model, fit.identifiability);
  fit.summary =
      SolveRobust(problem, config.loss, config.solver_options, &fit.values);
  return fit;
}

IdentifiabilityOptions OffsetsOnly(const IdentifiabilityOptions& options,
                                   const Arm& arm) {
  const ParameterLayout layout(arm);
  IdentifiabilityOptions offsets = FramesOnly(options);
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

EstimatedSigmas EstimateSigmas(JobConfig* config, int num_threads) {
  const MeasurementModel model(config->arm, config->references, num_threads);
  const Dataset stated = config->data;
  const std::optional<Dataset> stated_validation = config->validation;
  EstimatedSigmas sigmas;
  for (int round = 0; round < kSigmaRounds; ++round) {
    const Fit fit = FitOnce(*config, model, config->identifiability);
    if (!fit.summary.IsSolutionUsable()) return {};
    const CalibrationProblem problem =
        ProblemOf(*config, model, fit.identifiability);
    Dataset next = stated;
    std::optional<Dataset> next_validation = stated_validation;
    for (const RowClass which : {RowClass::kLength, RowClass::kRotation}) {
      const Dataset current = RowsOfClass(config->data, which);
      if (current.num_equations() == 0) continue;
      const double freedom = FreedomOfRows(problem, fit.values, current);
      if (!(freedom > 0.0)) return {};
      const Dataset rows = RowsOfClass(stated, which);
      const SigmaChange change =
          FindChange(config->loss, model.Errors(fit.values, rows), which, rows,
                     freedom);
      ChangeSigmas(which, change, &next);
      if (!(MedianSigma(which, next) > kSmallestSigma)) return {};
      if (next_validation) ChangeSigmas(which, change, &*next_validation);
    }
    config->data = std::move(next);
    config->validation = std::move(next_validation);
    sigmas.length = MedianSigma(RowClass::kLength, config->data);
    sigmas.rotation = MedianSigma(RowClass::kRotation, config->data);
  }
  return sigmas;
}

double DegreesOfFreedom(const CalibrationProblem& problem,
                        const Eigen::VectorXd& values) {
  return FreedomOfRows(problem, values, problem.data);
}

}  // namespace alidade
