#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <tuple>
#include <utility>
#include <vector>

#include "src/common/distributions.h"
#include "src/kernel/measurement_model.h"
#include "src/kernel/partition.h"
#include "src/uncertainty/expected_share.h"
#include "src/uncertainty/prediction.h"
#include "src/uncertainty/row_spread.h"

namespace alidade::internal {
namespace {

// Observations that the expected shares are computed from, of all at most.
constexpr Eigen::Index kMostSampled = 100;

// Rows that were measured.
std::vector<Eigen::Index> MeasuredRows(const ObservationBlock& block,
                                       Eigen::Index i) {
  std::vector<Eigen::Index> rows;
  for (Eigen::Index row = 0; row < block.rows_each(); ++row) {
    if (std::isfinite(block.sigmas(row, i))) rows.push_back(row);
  }
  return rows;
}

// What validation observations say, collected by several threads.
class HeldOut {
 public:
  HeldOut(const MeasurementModel& model, const Eigen::VectorXd& values,
          const ParameterCovariance& covariance, const Dataset& data,
          double confidence)
      : communicator_(model.communicator()),
        covariance_(covariance),
        spreads_(model, values, covariance, data),
        data_(data),
        ellipsoid_(3.0 * FisherQuantile(confidence, 3.0,
                                        covariance.degrees_of_freedom)),
        first_(FirstObservations(data)),
        stride_((data.global_observations() + kMostSampled - 1) / kMostSampled),
        scores_(data.num_observations()) {}

  // `rows`: whitened derivatives of observation i, and its residual.
  void Add(Eigen::Index i, const Eigen::Ref<const Eigen::MatrixXd>& whitened) {
    const auto b =
        std::upper_bound(first_.begin(), first_.end(), i) - first_.begin() - 1;
    const ObservationBlock& block = data_.blocks[b];
    if (block.kind == MeasurementKind::kPointDistance) return;
    const Eigen::Index p = whitened.cols() - 1;
    const std::vector<Eigen::Index> measured =
        MeasuredRows(block, i - first_[b]);
    if (measured.empty() || !covariance_.AreTold(whitened.leftCols(p))) return;
    const Eigen::VectorXd sigmas = block.sigmas.col(i - first_[b]);
    const Eigen::MatrixXd of_fit = spreads_.Of(i, whitened.leftCols(p));
    const Eigen::VectorXd residual = WithExcess(sigmas, whitened.col(p));
    const Eigen::MatrixXd spread = WithExcess(sigmas, of_fit);
    const Eigen::MatrixXd variance =
        Eigen::MatrixXd::Identity(spread.rows(), spread.rows()) +
        spread * spread.transpose();
    Scores& scores = scores_[i];
    for (const Eigen::Index row : measured) {
      scores.z.push_back(residual[row] / std::sqrt(variance(row, row)));
    }
    const bool is_position =
        HoldsPosition(block.kind) && measured.size() >= 3 && measured[2] == 2;
    if (is_position) {
      // Dynamic, for which Cholesky's decomposition is compiled already.
      const Eigen::VectorXd error = residual.head<3>();
      const Eigen::MatrixXd of_position = variance.topLeftCorner<3, 3>();
      scores.held =
          error.dot(of_position.llt().solve(error)) <= ellipsoid_ ? 1 : 0;
      const Eigen::Vector3d sigma = sigmas.head<3>();
      scores.from_parameters =
          of_fit.topRows<3>().rowwise().squaredNorm().dot(sigma.cwiseAbs2());
      scores.from_measurement =
          covariance_.excess.noise_ratio[0] * sigma.squaredNorm();
    }
    if (GlobalObservation(data_, b, i - first_[b]) % stride_ != 0) return;
    for (const Eigen::Index row : measured) {
      for (Eigen::Index k = 0; k < spread.cols(); ++k) {
        scores.spread.push_back(spread(row, k));
      }
    }
    scores.is_whole_position = is_position;
  }

  // Collective; complete on the root.
  std::vector<double> ZScores() const {
    return Gather([](const Scores& one) { return one.z; });
  }
  PredictedRows SampledRows(std::int64_t all) const {
    return {AsRows(Gather([](const Scores& one) { return one.spread; })), all};
  }
  PredictedRows SampledPositions(std::int64_t all) const {
    const auto three_rows = static_cast<std::ptrdiff_t>(3 * spreads_.width());
    return {AsRows(Gather([&](const Scores& one) {
              return one.is_whole_position
                         ? std::vector<double>(one.spread.begin(),
                                               one.spread.begin() + three_rows)
                         : std::vector<double>();
            })),
            all};
  }
  // On every rank.
  PredictionParts Parts() const {
    const auto mean = [this](double Scores::*part) {
      const std::vector<double> all = Gather([part](const Scores& one) {
        return one.held < 0 ? std::vector<double>()
                            : std::vector<double>{one.*part};
      });
      return ComputeOnRoot(communicator_, data_, [&all] {
        double sum = 0.0;
        for (const double each : all) sum += each;
        return std::sqrt(
            sum / static_cast<double>(std::max<std::size_t>(1, all.size())));
      });
    };
    return {mean(&Scores::from_parameters),
            std::sqrt(3.0 * covariance_.excess.length),
            mean(&Scores::from_measurement)};
  }
  std::int64_t Positions(bool held_alone) const {
    const auto mine =
        std::count_if(scores_.begin(), scores_.end(), [&](const Scores& one) {
          return held_alone ? one.held > 0 : one.held >= 0;
        });
    return SumOverRanks(communicator_, data_, static_cast<std::int64_t>(mine));
  }

 private:
  // Of an observation.
  struct Scores {
    std::vector<double> z;
    int held = -1;               // whether a position's ellipsoid holds
    std::vector<double> spread;  // J root, row by row, of those sampled
    bool is_whole_position = false;
    double from_parameters = 0.0;  // variances of a whole position (m^2)
    double from_measurement = 0.0;
  };

  // Noise and what the model lacks are one deviation of a measured row.
  Eigen::MatrixXd WithExcess(
      const Eigen::VectorXd& sigmas,
      const Eigen::Ref<const Eigen::MatrixXd>& whitened) const {
    Eigen::MatrixXd rows = whitened;
    const ModelExcess& excess = covariance_.excess;
    if (!excess.is_there()) return rows;
    for (Eigen::Index row = 0; row < rows.rows(); ++row) {
      rows.row(row) /= std::sqrt(excess.RowVariance(row, sigmas[row]));
    }
    return rows;
  }

  template <typename Pick>
  std::vector<double> Gather(const Pick& pick) const {
    std::vector<std::vector<double>> by_block(data_.blocks.size());
    for (std::size_t b = 0; b < by_block.size(); ++b) {
      for (Eigen::Index i = first_[b]; i < first_[b + 1]; ++i) {
        const std::vector<double> more = pick(scores_[i]);
        by_block[b].insert(by_block[b].end(), more.begin(), more.end());
      }
    }
    return InOrder(communicator_, data_, std::move(by_block));
  }

  Eigen::MatrixXd AsRows(const std::vector<double>& numbers) const {
    const Eigen::Index p = spreads_.width();
    const auto size = static_cast<Eigen::Index>(numbers.size());
    return Eigen::Map<const Eigen::MatrixXd>(numbers.data(), p,
                                             p > 0 ? size / p : 0)
        .transpose();
  }

  Communicator* const communicator_;
  const ParameterCovariance& covariance_;
  const RowSpread spreads_;
  const Dataset& data_;
  const double ellipsoid_;
  const std::vector<Eigen::Index> first_;
  const Eigen::Index stride_;
  std::vector<Scores> scores_;
};

void CountHeld(const HeldOut& validation, double dof, PredictionCheck* check) {
  check->axes.n = check->z_scores.size();
  const double bound = StudentTQuantile(0.5 + 0.5 * check->confidence, dof);
  check->axes.held = (check->z_scores.array().abs() <= bound).count();
  check->ellipsoids.n = validation.Positions(false);
  check->ellipsoids.held = validation.Positions(true);
  const PredictedRows rows = validation.SampledRows(check->axes.n);
  const PredictedRows positions =
      validation.SampledPositions(check->ellipsoids.n);
  if (rows.spread.rows() > 0) {
    std::tie(check->axes.lower, check->axes.upper) =
        ExpectedShares(rows, check->confidence, dof);
  }
  if (positions.spread.rows() > 0) {
    std::tie(check->ellipsoids.lower, check->ellipsoids.upper) =
        ExpectedEllipsoidShares(positions, check->confidence, dof);
  }
}

// A few errors far beyond all predictions hardly change how many are within
// them: their root mean square shows them. Where one direction of the
// parameters is behind all of them, it is no larger than one deviate in 99 %.
std::string Verdict(const PredictionCheck& check, double dof) {
  if (check.axes.n == 0) return "nothing to compare";
  if (!std::isfinite(check.rms_z)) return "cannot be determined";
  const auto is_short = [](const Coverage& share) {
    return share.n > 0 && share.rate() < share.lower;
  };
  if (is_short(check.axes) || is_short(check.ellipsoids) ||
      check.rms_z > StudentTQuantile(0.995, dof)) {
    return "larger";
  }
  if (check.axes.rate() > check.axes.upper) return "smaller";
  return "agree";
}

}  // namespace

PredictionCheck CheckPrediction(const MeasurementModel& model,
                                const Eigen::VectorXd& values,
                                const ParameterCovariance& covariance,
                                const Dataset& validation, double confidence) {
  HeldOut scores(model, values, covariance, validation, confidence);
  ForEachObservation(
      model, values, validation, covariance.columns,
      [&](int, Eigen::Index i, const Eigen::Ref<const Eigen::MatrixXd>& rows) {
        scores.Add(i, rows);
      });
  PredictionCheck check;
  check.confidence = confidence;
  const std::vector<double> z = scores.ZScores();
  check.z_scores = Eigen::Map<const Eigen::VectorXd>(
      z.data(), static_cast<Eigen::Index>(z.size()));
  CountHeld(scores, covariance.degrees_of_freedom, &check);
  check.parts = scores.Parts();
  if (check.axes.n > 0) {
    check.rms_z = std::sqrt(check.z_scores.squaredNorm() /
                            static_cast<double>(check.axes.n));
  }
  check.histogram = CountStandardised(check.z_scores);
  check.verdict = Verdict(check, covariance.degrees_of_freedom);
  return check;
}

}  // namespace alidade::internal
