#include "src/calibration/prior_scale.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "alidade/robust_loss.h"
#include "src/calibration/preparation.h"
#include "src/kernel/reduction.h"

namespace alidade::internal {
namespace {

// The fit without priors does not matter here: what the data say of the free
// parameters follows from where the fit with priors has come to.
class MarginalLikelihood {
 public:
  MarginalLikelihood(const CalibrationProblem& problem,
                     const Eigen::VectorXd& values,
                     const std::vector<RobustLoss>& losses)
      : problem_(problem) {
    ReducedLeastSquares reduced;
    Reducer(problem.model, problem.data, problem.free_columns, losses)
        .Reduce(values, &reduced);
    information_ = reduced.factor.transpose() * reduced.factor;
    const auto p = static_cast<Eigen::Index>(problem.free_columns.size());
    const Eigen::VectorXd nominal = problem.model.NominalValues();
    Eigen::VectorXd deviations(p);
    for (Eigen::Index k = 0; k < p; ++k) {
      const int column = Column(k);
      deviations[k] = values[column] - nominal[column];
    }
    // At the minimum the residuals' gradient is the priors', negative.
    gradient_ = information_ * deviations +
                PriorInformation({}).cwiseProduct(deviations);
  }

  // Twice the logarithm, but for a constant.
  double At(const PriorScaling& scaling) const {
    const Eigen::VectorXd priors = PriorInformation(scaling);
    Eigen::MatrixXd posterior = information_;
    posterior.diagonal() += priors;
    // Angles and lengths differ in size.
    const Eigen::VectorXd scale = posterior.diagonal().cwiseSqrt();
    const Eigen::VectorXd inverse = scale.cwiseInverse();
    posterior = inverse.asDiagonal() * posterior * inverse.asDiagonal();
    const Eigen::LDLT<Eigen::MatrixXd> factor(posterior);
    if (!factor.isPositive()) return -std::numeric_limits<double>::infinity();
    const Eigen::VectorXd b = inverse.cwiseProduct(gradient_);
    double sum = b.dot(factor.solve(b)) -
                 factor.vectorD().array().abs().log().sum() -
                 2.0 * scale.array().log().sum();
    for (const double prior : priors) {
      if (prior > 0.0) sum += std::log(prior);
    }
    return sum;
  }

 private:
  int Column(Eigen::Index k) const {
    return problem_.free_columns[static_cast<std::size_t>(k)];
  }

  // 1 / prior^2; 0 where there is none.
  Eigen::VectorXd PriorInformation(const PriorScaling& scaling) const {
    const auto p = static_cast<Eigen::Index>(problem_.free_columns.size());
    Eigen::VectorXd all = Eigen::VectorXd::Zero(p);
    for (Eigen::Index k = 0; k < p && problem_.priors.size() > 0; ++k) {
      const Parameter& parameter = problem_.model.layout().parameter(Column(k));
      const double prior = problem_.priors[Column(k)];
      if (!std::isfinite(prior)) continue;
      double factor = 1.0;
      if (ParameterLayout::IsJointKind(parameter.kind)) {
        factor = parameter.dimension == Dimension::kAngle ? scaling.angle
                                                          : scaling.length;
      }
      all[k] = std::pow(factor * prior, -2);
    }
    return all;
  }

  const CalibrationProblem& problem_;
  Eigen::MatrixXd information_;
  Eigen::VectorXd gradient_;
};

PriorScaling MostLikely(const MarginalLikelihood& likelihood) {
  constexpr int kFirst = -6;  // quarters of a decade
  constexpr int kLast = 10;
  constexpr double kLeastGain = 1e-9;
  PriorScaling best;
  double most = likelihood.At(best);
  for (int a = kFirst; a <= kLast; ++a) {
    for (int l = kFirst; l <= kLast; ++l) {
      const PriorScaling tried{std::pow(10.0, 0.25 * a),
                               std::pow(10.0, 0.25 * l)};
      const double likely = likelihood.At(tried);
      if (!(likely > most + kLeastGain)) continue;
      most = likely;
      best = tried;
    }
  }
  return best;
}

void Scale(const PriorScaling& scaling, PriorTolerances* priors) {
  for (double* angle : {&priors->beta, &priors->alpha, &priors->theta}) {
    *angle *= scaling.angle;
  }
  for (double* length : {&priors->d, &priors->r}) *length *= scaling.length;
}

}  // namespace

std::optional<PriorScaling> EstimatePriors(const CalibrationTask& stated,
                                           CalibrationTask* task,
                                           EstimatedSigmas* sigmas) {
  constexpr int kRounds = 2;
  const MeasurementModel model(task->arm, task->data.references,
                               task->execution());
  PriorScaling all;
  for (int round = 0; round < kRounds; ++round) {
    const IdentifiabilityOptions& options = task->options.identifiability;
    const Fit fit = FitOnce(*task, model, options);
    if (!fit.summary.IsSolutionUsable()) return std::nullopt;
    const CalibrationProblem problem =
        ProblemOf(*task, model, fit.identifiability);
    const PriorScaling more = MostLikely(MarginalLikelihood(
        problem, fit.values, TunedLosses(task->options.loss)));
    all.angle *= more.angle;
    all.length *= more.length;
    CalibrationTask next = stated;
    Scale(all, &next.options.identifiability.priors);
    if (next.options.estimate_sigma) {
      *sigmas = EstimateSigmas(&next);
      if (!(sigmas->length > 0.0)) return std::nullopt;
    }
    *task = std::move(next);
    if (more.angle == 1.0 && more.length == 1.0) break;
  }
  return all;
}

}  // namespace alidade::internal
