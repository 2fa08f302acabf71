#include "src/uncertainty/arm_check.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "src/common/constants.h"
#include "src/common/distributions.h"
#include "src/common/svd.h"
#include "src/uncertainty/row_spread.h"

namespace alidade::internal {
namespace {

// The noncentrality at which T is above its limit with this probability.
double NoncentralityOf(double limit, double dof1, double dof2, double power) {
  const auto found = [&](double noncentrality) {
    return NoncentralFisherSurvival(limit, dof1, dof2, noncentrality);
  };
  double upper = 1.0;
  while (found(upper) < power && upper < 1e9) upper *= 2.0;
  double lower = upper > 1.0 ? 0.5 * upper : 0.0;
  for (int i = 0; i < 20; ++i) {
    const double middle = 0.5 * (lower + upper);
    (found(middle) < power ? lower : upper) = middle;
  }
  return upper;
}

// Rows of all observations, whitened by their sigmas.
class CheckedRows {
 public:
  CheckedRows(const MeasurementModel& model,
              const ParameterCovariance& covariance, const Dataset& data,
              const ArmCheckOptions& options)
      : model_(model),
        covariance_(covariance),
        spreads_(model, model.NominalValues(), covariance, data) {
    ChooseColumns(options);
    PlaceRows(data);
    derivatives_.setZero(num_rows_, static_cast<Eigen::Index>(columns_.size()));
    residuals_.setZero(num_rows_);
    spread_.setZero(num_rows_, spreads_.width());
    ForEachObservation(
        model, model.NominalValues(), data, columns_,
        [&](int, Eigen::Index i,
            const Eigen::Ref<const Eigen::MatrixXd>& rows) { Keep(i, rows); });
  }

  Eigen::Index size() const { return num_rows_; }
  const std::vector<Eigen::Index>& position_rows() const {
    return position_rows_;
  }
  const Eigen::VectorXd& residuals() const { return residuals_; }
  const Eigen::VectorXd& sigmas() const { return sigmas_; }

  // Of measurement, lack of the model and parameters.
  Eigen::MatrixXd Covariance() const {
    Eigen::MatrixXd covariance = spread_ * spread_.transpose();
    for (Eigen::Index row = 0; row < num_rows_; ++row) {
      covariance(row, row) +=
          covariance_.excess.RowVariance(axes_[row], sigmas_[row]);
    }
    return covariance;
  }

  // By what is refitted, and by what the calibration could not determine.
  Eigen::MatrixXd Nuisance(const std::vector<int>& refitted) const {
    const Eigen::MatrixXd own = Columns(covariance_.columns);
    Eigen::MatrixXd all(num_rows_, static_cast<Eigen::Index>(refitted.size()) +
                                       covariance_.null_space.cols());
    all << Columns(refitted), own * covariance_.null_space;
    return all;
  }

  // By the zeros of the joints.
  Eigen::MatrixXd ZeroColumns() const { return Columns(zeros_); }

  // The whitened residuals of another arm.
  Eigen::VectorXd ResidualsOf(const MeasurementModel& other,
                              const Dataset& data) const {
    Eigen::VectorXd residuals = Eigen::VectorXd::Zero(num_rows_);
    ForEachObservation(other, other.NominalValues(), data, {},
                       [&](int, Eigen::Index i,
                           const Eigen::Ref<const Eigen::MatrixXd>& rows) {
                         for (const auto& [row, place] : places_[i]) {
                           residuals[place] = rows(row, 0);
                         }
                       });
    return residuals;
  }

 private:
  struct Place {
    Eigen::Index row;    // of the observation
    Eigen::Index place;  // among all
  };

  void ChooseColumns(const ArmCheckOptions& options) {
    const Arm& arm = model_.nominal();
    for (int j = 0; j < arm.num_joints(); ++j) {
      const bool turns = arm.joints[j].type == JointType::kRevolute;
      zeros_.push_back(model_.layout().Column(
          turns ? ParameterKind::kTheta : ParameterKind::kR, j));
    }
    for (const auto& more : {covariance_.columns, options.refitted, zeros_}) {
      columns_.insert(columns_.end(), more.begin(), more.end());
    }
    std::sort(columns_.begin(), columns_.end());
    columns_.erase(std::unique(columns_.begin(), columns_.end()),
                   columns_.end());
  }

  void PlaceRows(const Dataset& data) {
    std::vector<double> sigmas;
    for (const ObservationBlock& block : data.blocks) {
      for (Eigen::Index i = 0; i < block.sigmas.cols(); ++i) {
        places_.emplace_back();
        for (Eigen::Index row = 0; row < block.rows_each(); ++row) {
          const double sigma = block.sigmas(row, i);
          if (!std::isfinite(sigma)) continue;
          places_.back().push_back({row, num_rows_});
          if (HoldsPosition(block.kind) && row < 3) {
            position_rows_.push_back(num_rows_);
          }
          sigmas.push_back(sigma);
          axes_.push_back(row);
          ++num_rows_;
        }
      }
    }
    sigmas_ = Eigen::Map<const Eigen::VectorXd>(sigmas.data(), num_rows_);
  }

  void Keep(Eigen::Index i, const Eigen::Ref<const Eigen::MatrixXd>& rows) {
    const Eigen::Index p = rows.cols() - 1;
    Eigen::MatrixXd own(rows.rows(), covariance_.size());
    for (int k = 0; k < covariance_.size(); ++k) {
      own.col(k) = rows.col(IndexOf(covariance_.columns[k]));
    }
    const Eigen::MatrixXd spread = spreads_.Of(i, own);
    for (const auto& [row, place] : places_[i]) {
      derivatives_.row(place) = rows.row(row).head(p);
      residuals_[place] = rows(row, p);
      spread_.row(place) = spread.row(row);
    }
  }

  Eigen::Index IndexOf(int column) const {
    return std::lower_bound(columns_.begin(), columns_.end(), column) -
           columns_.begin();
  }

  Eigen::MatrixXd Columns(const std::vector<int>& chosen) const {
    Eigen::MatrixXd some(num_rows_, static_cast<Eigen::Index>(chosen.size()));
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      some.col(static_cast<Eigen::Index>(k)) =
          derivatives_.col(IndexOf(chosen[k]));
    }
    return some;
  }

  const MeasurementModel& model_;
  const ParameterCovariance& covariance_;
  const RowSpread spreads_;
  std::vector<int> zeros_;
  std::vector<int> columns_;
  std::vector<std::vector<Place>> places_;  // by observation
  std::vector<Eigen::Index> position_rows_;
  std::vector<Eigen::Index> axes_;
  Eigen::VectorXd sigmas_;
  Eigen::Index num_rows_ = 0;
  Eigen::MatrixXd derivatives_;
  Eigen::VectorXd residuals_;
  Eigen::MatrixXd spread_;
};

// Rows in units of their own covariance, without what G can explain.
class Whitening {
 public:
  Whitening(const Eigen::MatrixXd& covariance, const Eigen::MatrixXd& nuisance)
      : cholesky_(covariance), size_(covariance.rows()) {
    if (nuisance.cols() == 0) return;
    const Eigen::MatrixXd white = cholesky_.matrixL().solve(nuisance);
    const Eigen::VectorXd norms = white.colwise().norm();
    Eigen::MatrixXd scaled = white;
    for (Eigen::Index k = 0; k < norms.size(); ++k) {
      if (norms[k] > 0.0) scaled.col(k) /= norms[k];
    }
    basis_ = OrthonormalBasis(scaled, 1e-9);
  }

  Eigen::Index degrees_of_freedom() const { return size_ - basis_.cols(); }

  Eigen::MatrixXd Of(const Eigen::MatrixXd& rows) const {
    Eigen::MatrixXd white = cholesky_.matrixL().solve(rows);
    if (basis_.cols() > 0) white -= basis_ * (basis_.transpose() * white);
    return white;
  }
  // Back in the units that the rows were in.
  Eigen::VectorXd Back(const Eigen::VectorXd& white) const {
    return cholesky_.matrixL() * white;
  }

 private:
  const Eigen::LLT<Eigen::MatrixXd> cholesky_;
  const Eigen::Index size_;
  Eigen::MatrixXd basis_ = {};
};

// Root of the mean squared norm of positions, and the largest, from rows.
void PositionErrors(const CheckedRows& rows, const Eigen::VectorXd& whitened,
                    double* rms, double* largest) {
  const std::vector<Eigen::Index>& places = rows.position_rows();
  double sum = 0.0;
  double most = 0.0;
  for (std::size_t k = 0; k + 2 < places.size(); k += 3) {
    double squared = 0.0;
    for (std::size_t axis = k; axis < k + 3; ++axis) {
      squared +=
          std::pow(whitened[places[axis]] * rows.sigmas()[places[axis]], 2.0);
    }
    sum += squared;
    most = std::max(most, squared);
  }
  const double count = std::max(1.0, static_cast<double>(places.size()) / 3.0);
  *rms = std::sqrt(sum / count);
  if (largest != nullptr) *largest = std::sqrt(most);
}

}  // namespace

double NoncentralFisherSurvival(double f, double dof1, double dof2,
                                double noncentrality) {
  const double mean = 0.5 * noncentrality;
  const double spread = 12.0 * std::sqrt(mean) + 40.0;
  if (mean > 1e8) return 1.0;
  // A Poisson mixture of central ones.
  double sum = 0.0;
  const double first = std::max(0.0, std::floor(mean - spread));
  const auto terms = static_cast<int>(mean + spread - first) + 1;
  for (int term = 0; term < terms; ++term) {
    const double j = first + term;
    const double log_weight =
        (mean > 0.0 ? j * std::log(mean) : (j > 0.0 ? -kInfinity : 0.0)) -
        mean - std::lgamma(j + 1.0);
    const double weight = std::exp(log_weight);
    if (weight < 1e-18) continue;
    const double dof = dof1 + 2.0 * j;
    sum += weight * FisherSurvival(f * dof1 / dof, dof, dof2);
  }
  return std::min(1.0, sum);
}

ArmCheckResult CheckArm(const MeasurementModel& calibrated,
                        const MeasurementModel& uncalibrated,
                        const ParameterCovariance& covariance,
                        const Dataset& data, const ArmCheckOptions& options) {
  const CheckedRows rows(calibrated, covariance, data, options);
  ArmCheckResult result;
  result.num_observations = data.num_observations();
  result.significance = options.significance;
  result.power = options.power;
  const Eigen::MatrixXd variance = rows.Covariance();
  const Whitening whitening(variance, rows.Nuisance(options.refitted));
  const auto dof = static_cast<double>(whitening.degrees_of_freedom());
  result.degrees_of_freedom = dof;
  if (dof < 1.0) return result;
  const double other = covariance.degrees_of_freedom;
  const double f_limit = FisherQuantile(1.0 - options.significance, dof, other);
  const Eigen::VectorXd residuals = whitening.Of(rows.residuals());
  result.statistic = residuals.squaredNorm();
  result.limit = f_limit * dof;
  result.p_value = FisherSurvival(result.statistic / dof, dof, other);
  result.passes = result.statistic <= result.limit;
  PositionErrors(rows, whitening.Back(residuals), &result.rms_error,
                 &result.max_error);
  PositionErrors(rows, variance.diagonal().cwiseSqrt(), &result.predicted_rms,
                 nullptr);

  const Eigen::VectorXd moved =
      rows.ResidualsOf(uncalibrated, data) - rows.residuals();
  PositionErrors(rows, moved, &result.uncalibrated_rms, nullptr);
  result.uncalibrated_found = NoncentralFisherSurvival(
      f_limit, dof, other, whitening.Of(moved).squaredNorm());
  const double needed = NoncentralityOf(f_limit, dof, other, options.power);
  // A move of variance 1 / 3 m^2 along each axis of each position.
  double per_move = 0.0;
  for (const Eigen::Index row : rows.position_rows()) {
    const Eigen::VectorXd unit =
        Eigen::VectorXd::Unit(rows.size(), row) / rows.sigmas()[row];
    per_move += whitening.Of(unit).squaredNorm() / 3.0;
  }
  result.found_move = std::sqrt(needed / per_move);
  const Eigen::MatrixXd zeros = rows.ZeroColumns();
  const Eigen::VectorXd seen = whitening.Of(zeros).colwise().norm();
  // What is below that is rounding.
  const double smallest = 1e-6 * zeros.colwise().norm().maxCoeff();
  result.found_zero.resize(seen.size());
  for (Eigen::Index j = 0; j < seen.size(); ++j) {
    result.found_zero[j] =
        seen[j] > smallest ? std::sqrt(needed) / seen[j] : kInfinity;
  }
  return result;
}

}  // namespace alidade::internal
