#include "src/uncertainty/diagnostics.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "src/common/constants.h"
#include "src/common/distributions.h"
#include "src/identifiability/generic_data.h"
#include "src/kernel/measurement_model.h"
#include "src/kernel/partition.h"

namespace alidade::internal {
namespace {

// More residuals would show deviations that do not matter.
constexpr Eigen::Index kMostTested = 5000;
constexpr Eigen::Index kFewestTested = 8;
constexpr int kMostLags = 10;

// More are looked at by an even sample.
constexpr Eigen::Index kMostObservations = 100000;

// What one observation says of itself.
struct Observed {
  int pose = -1;
  double leverage = 0.0;
  double cooks_distance = 0.0;
  double squared_norm = 0.0;
  int dimension = 0;
  std::array<double, 6> studentised{};  // NaN where not measured
};

// A sample of many data, or all of a few that several ranks have; nothing
// where the data may be looked at as they are.
std::optional<Dataset> Gathered(const FittedProblem& fit, bool is_sample) {
  Communicator* const communicator = fit.model.communicator();
  if (is_sample) return EvenSubset(communicator, fit.data, kMostObservations);
  if (!fit.data.partition) return std::nullopt;
  return GatherData(communicator, fit.data, fit.data);
}

class Diagnosis {
 public:
  Diagnosis(const FittedProblem& fit, const ParameterCovariance& covariance)
      : fit_(fit),
        covariance_(covariance),
        is_sample_(fit.data.global_observations() > kMostObservations),
        gathered_(Gathered(fit, is_sample_)),
        data_(gathered_ ? *gathered_ : fit.data),
        first_(FirstObservations(data_)),
        observed_(data_.num_observations()) {}

  ResidualDiagnostics Run(bool sigma_given, const Dataset& kept) {
    ForEachObservation(fit_.model, fit_.values, data_, covariance_.columns,
                       [this](int, Eigen::Index i,
                              const Eigen::Ref<const Eigen::MatrixXd>& rows) {
                         Visit(i, rows);
                       });
    ResidualDiagnostics out;
    SumUp(sigma_given, kept, &out);
    ListPoses(&out);
    ListStudentised(&out);
    out.histogram = CountStandardised(out.studentised);
    out.normality = TestNormality(Thinned(out.studentised));
    TestWhiteness(&out);
    return out;
  }

 private:
  const ObservationBlock& BlockOf(Eigen::Index i,
                                  Eigen::Index* in_block) const {
    const auto b =
        std::upper_bound(first_.begin(), first_.end(), i) - first_.begin() - 1;
    *in_block = i - first_[b];
    return data_.blocks[b];
  }

  void Visit(Eigen::Index i, const Eigen::Ref<const Eigen::MatrixXd>& rows) {
    Eigen::Index in_block = 0;
    const ObservationBlock& block = BlockOf(i, &in_block);
    Observed& one = observed_[i];
    one.pose = block.kind == MeasurementKind::kPointDistance
                   ? -1
                   : block.pose(in_block);
    one.dimension = block.Dimension(in_block);
    one.studentised.fill(kNan);
    if (one.dimension == 0) return;
    const Eigen::Index p = rows.cols() - 1;
    Eigen::VectorXd residual = rows.col(p);
    one.squared_norm = residual.squaredNorm();
    const double weight =
        fit_.losses.empty()
            ? 1.0
            : fit_.losses[one.dimension - 1].Weight(one.squared_norm);
    const Eigen::MatrixXd spread =
        std::sqrt(weight) * rows.leftCols(p) * covariance_.root;
    const Eigen::MatrixXd hat = spread * spread.transpose();
    one.leverage = hat.trace();
    residual *= std::sqrt(weight);
    const Eigen::MatrixXd rest =
        Eigen::MatrixXd::Identity(hat.rows(), hat.cols()) - hat;
    const Eigen::VectorXd freed = rest.ldlt().solve(residual);
    one.cooks_distance =
        std::max(0.0, freed.dot(hat * freed)) / static_cast<double>(p);
    for (Eigen::Index row = 0; row < rows.rows(); ++row) {
      if (std::isinf(block.sigmas(row, in_block))) continue;
      // A row that decides a parameter alone has no residual.
      one.studentised[row] = rest(row, row) > 1e-9
                                 ? rows(row, p) / std::sqrt(rest(row, row))
                                 : kNan;
    }
  }

  void SumUp(bool sigma_given, const Dataset& kept,
             ResidualDiagnostics* out) const {
    out->chi_square =
        SumInOrder(fit_.model.communicator(), kept,
                   SquaredNorms(fit_.model.Errors(fit_.values, kept), kept));
    out->degrees_of_freedom =
        static_cast<double>(GlobalEquations(fit_.model.communicator(), kept)) -
        EffectiveParameters(covariance_, FreePriors(fit_));
    if (out->degrees_of_freedom < 1.0) return;
    out->reduced_chi_square = out->chi_square / out->degrees_of_freedom;
    if (!sigma_given) return;
    out->chi_square_p_value = std::min(
        1.0,
        2.0 * std::min(
                  ChiSquareCdf(out->chi_square, out->degrees_of_freedom),
                  ChiSquareSurvival(out->chi_square, out->degrees_of_freedom)));
  }

  void ListPoses(ResidualDiagnostics* out) const {
    if (is_sample_) return;
    out->poses.resize(data_.num_poses());
    for (std::size_t k = 0; k < out->poses.size(); ++k) {
      out->poses[k].pose = static_cast<int>(k);
      out->poses[k].where = SourceOf(data_, static_cast<int>(k));
    }
    for (const Observed& one : observed_) {
      if (one.pose < 0) continue;
      Influence& pose = out->poses[one.pose];
      pose.leverage += one.leverage;
      pose.cooks_distance += one.cooks_distance;
      pose.standardised =
          std::hypot(pose.standardised, std::sqrt(one.squared_norm));
    }
  }

  void ListStudentised(ResidualDiagnostics* out) const {
    std::vector<double> all;
    for (const Observed& one : observed_) {
      for (const double value : one.studentised) {
        if (std::isfinite(value)) all.push_back(value);
      }
    }
    out->studentised = Eigen::Map<const Eigen::VectorXd>(
        all.data(), static_cast<Eigen::Index>(all.size()));
  }

  static Eigen::VectorXd Thinned(const Eigen::VectorXd& all) {
    if (all.size() <= kMostTested) return all;
    Eigen::VectorXd some(kMostTested);
    for (Eigen::Index k = 0; k < kMostTested; ++k) {
      some[k] = all[k * all.size() / kMostTested];
    }
    return some;
  }

  // Each row of each block is a series of its own.
  void TestWhiteness(ResidualDiagnostics* out) const {
    double statistic = 0.0;
    int freedom = 0;
    for (std::size_t b = 0; b + 1 < first_.size(); ++b) {
      for (int row = 0; row < data_.blocks[b].rows_each(); ++row) {
        std::vector<double> series;
        for (Eigen::Index i = first_[b]; i < first_[b + 1]; ++i) {
          const double value = observed_[i].studentised[row];
          if (std::isfinite(value)) series.push_back(value);
        }
        const int lags =
            std::min(kMostLags, static_cast<int>(series.size()) / 5);
        if (lags < 1) continue;
        out->lags = std::max(out->lags, lags);
        statistic += LjungBox(series, lags);
        freedom += lags;
      }
    }
    if (freedom == 0) return;
    out->whiteness = {statistic, ChiSquareSurvival(statistic, freedom)};
  }

  static double LjungBox(const std::vector<double>& series, int lags) {
    const auto n = static_cast<double>(series.size());
    double mean = 0.0;
    for (const double value : series) mean += value / n;
    double variance = 0.0;
    for (const double value : series) {
      variance += (value - mean) * (value - mean);
    }
    if (!(variance > 0.0)) return 0.0;
    double sum = 0.0;
    for (int lag = 1; lag <= lags; ++lag) {
      double product = 0.0;
      for (std::size_t i = lag; i < series.size(); ++i) {
        product += (series[i] - mean) * (series[i - lag] - mean);
      }
      const double correlation = product / variance;
      sum += correlation * correlation / (n - lag);
    }
    return n * (n + 2.0) * sum;
  }

  const FittedProblem& fit_;
  const ParameterCovariance& covariance_;
  const bool is_sample_;
  const std::optional<Dataset> gathered_;
  const Dataset& data_;
  const std::vector<Eigen::Index> first_;
  std::vector<Observed> observed_;
};

}  // namespace

double AndersonDarlingPValue(double statistic) {
  // The fit of large statistics falls up to here only.
  const double a = std::min(statistic, 153.0);
  if (a >= 0.6) return std::exp(1.2937 - 5.709 * a + 0.0186 * a * a);
  if (a >= 0.34) return std::exp(0.9177 - 4.279 * a - 1.38 * a * a);
  if (a >= 0.2) return 1.0 - std::exp(-8.318 + 42.796 * a - 59.938 * a * a);
  return 1.0 - std::exp(-13.436 + 101.14 * a - 223.73 * a * a);
}

TestResult TestNormality(Eigen::VectorXd values) {
  TestResult result;
  const Eigen::Index size = values.size();
  if (size < kFewestTested) return result;
  const auto n = static_cast<double>(size);
  values.array() -= values.mean();
  const double deviation = std::sqrt(values.squaredNorm() / (n - 1.0));
  if (!(deviation > 0.0)) return result;
  std::sort(values.data(), values.data() + size);
  double sum = 0.0;
  for (Eigen::Index i = 0; i < size; ++i) {
    const double low = NormalCdf(values[i] / deviation);
    const double high = NormalCdf(-values[size - 1 - i] / deviation);
    // Far tails: a logarithm of zero would hide all else.
    constexpr double kLeast = 1e-300;
    sum += (2.0 * static_cast<double>(i) + 1.0) *
           (std::log(std::max(low, kLeast)) + std::log(std::max(high, kLeast)));
  }
  const double a = -n - sum / n;
  result.statistic = a * (1.0 + 0.75 / n + 2.25 / (n * n));
  result.p_value = AndersonDarlingPValue(result.statistic);
  return result;
}

ResidualDiagnostics DiagnoseResiduals(const FittedProblem& fit,
                                      const ParameterCovariance& covariance,
                                      bool sigma_given, const Dataset& kept) {
  return Diagnosis(fit, covariance).Run(sigma_given, kept);
}

}  // namespace alidade::internal
