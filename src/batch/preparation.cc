#include "preparation.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

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

// The data with only the rows of one class measured.
Dataset RowsOfClass(const Dataset& data, RowClass which) {
  Dataset rows = data;
  for (ObservationBlock& block : rows.blocks) {
    for (int row = 0; row < block.rows_each(); ++row) {
      if (IsOf(which, row) && IsEstimated(block)) continue;
      block.sigmas.row(row).setConstant(
          std::numeric_limits<double>::infinity());
      for (Eigen::MatrixXd& whitener : block.whiteners) {
        if (whitener.size() > 0) whitener.row(row).setZero();
      }
    }
  }
  return rows;
}

void ScaleSigmas(RowClass which, double factor, Dataset* data) {
  for (ObservationBlock& block : data->blocks) {
    if (!IsEstimated(block)) continue;
    for (int row = 0; row < block.rows_each(); ++row) {
      if (!IsOf(which, row)) continue;
      block.sigmas.row(row) *= factor;
      for (Eigen::MatrixXd& whitener : block.whiteners) {
        if (whitener.size() > 0) whitener.col(row) /= factor;
      }
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

// By what factor the sigmas of a class are too small.
double SigmaFactor(const JobConfig& config, const CalibrationProblem& problem,
                   const Eigen::VectorXd& values, RowClass which) {
  const Dataset rows = RowsOfClass(config.data, which);
  const auto equations = static_cast<double>(rows.num_equations());
  const double freedom = FreedomOfRows(problem, values, rows);
  if (!(freedom > 0.0)) return 0.0;
  const Eigen::VectorXd squared =
      SquaredNorms(problem.model.Errors(values, rows), rows);
  if (config.loss == LossKind::kNone) {
    return std::sqrt(squared.sum() / freedom);
  }
  // Norms of observations of several dimensions compare by their medians.
  const Eigen::VectorXi dimensions = Dimensions(rows);
  std::vector<double> norms;
  for (Eigen::Index i = 0; i < squared.size(); ++i) {
    if (dimensions[i] == 0) continue;
    norms.push_back(std::sqrt(squared[i]) / MedianOfChi(dimensions[i]));
  }
  return RobustScale(norms, 1) * MedianOfChi(1) *
         std::sqrt(equations / freedom);
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
  EstimatedSigmas sigmas;
  for (int round = 0; round < kSigmaRounds; ++round) {
    const Fit fit = FitOnce(*config, model, config->identifiability);
    if (!fit.summary.IsSolutionUsable()) return {};
    const CalibrationProblem problem =
        ProblemOf(*config, model, fit.identifiability);
    for (const RowClass which : {RowClass::kLength, RowClass::kRotation}) {
      const double used = MedianSigma(which, config->data);
      if (used == 0.0) continue;
      const double factor = SigmaFactor(*config, problem, fit.values, which);
      if (!(factor * used > kSmallestSigma)) return {};
      ScaleSigmas(which, factor, &config->data);
      if (config->validation) {
        ScaleSigmas(which, factor, &*config->validation);
      }
    }
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
