#include "src/calibration/outliers.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "alidade/robust_loss.h"
#include "src/calibration/evaluate.h"
#include "src/calibration/label_bytes.h"
#include "src/common/bytes.h"
#include "src/common/distributions.h"
#include "src/common/text.h"
#include "src/kernel/partition.h"
#include "src/uncertainty/row_spread.h"

namespace alidade::internal {
namespace {

// Observations beyond this are outliers: were all residuals Gaussian, one of
// them would be there in so many of all calibrations.
constexpr double kChanceOfOutlier = 0.05;

// An observation of less weight is rejected.
constexpr double kRejected = 0.5;

// More validation outliers than this part, and than so many times the part of
// training outliers, are no mistakes of measurement.
constexpr double kFewPart = 0.2;
constexpr double kTimesTraining = 2.0;

// Those of all ranks, on the root.
std::vector<Outlier> WithThoseOfOthers(Communicator* communicator,
                                       const Dataset& data,
                                       std::vector<Outlier> mine) {
  if (!data.partition) return mine;
  ByteWriter writer;
  for (const Outlier& outlier : mine) {
    writer.Put(outlier.observation);
    PutLabel(outlier.label, &writer);
    writer.Put(outlier.error);
    writer.Put(outlier.standardised);
    writer.Put(outlier.weight);
  }
  std::vector<Outlier> all;
  for (const std::string& bytes : communicator->GatherToRoot(writer.Take())) {
    ByteReader reader(bytes);
    while (!reader.is_at_end()) {
      Outlier outlier;
      outlier.observation = reader.Get<std::int64_t>();
      outlier.label = GetLabel(&reader);
      outlier.error = reader.Get<double>();
      outlier.standardised = reader.Get<double>();
      outlier.weight = reader.Get<double>();
      all.push_back(std::move(outlier));
    }
  }
  return all;
}

// The data with these observations, block after block, as if they had not been
// measured.
Dataset Without(const std::vector<Eigen::Index>& observations,
                const Dataset& data) {
  Dataset kept = data;
  auto next = observations.begin();
  Eigen::Index first = 0;
  for (ObservationBlock& block : kept.blocks) {
    MatrixBuilder sigmas(block.sigmas);
    for (; next != observations.end() && *next < first + block.size(); ++next) {
      const Eigen::Index i = *next - first;
      sigmas.map().col(i).setConstant(std::numeric_limits<double>::infinity());
      if (!block.whiteners.empty()) block.whiteners[i].setZero();
    }
    block.sigmas = sigmas.Freeze();
    first += block.size();
  }
  return kept;
}

class Search {
 public:
  Search(const CalibrationSolution& fit, const Dataset& data)
      : fit_(fit),
        data_(data),
        losses_(TunedLosses(fit.task.options.loss)),
        errors_(fit.model().Errors(fit.values, data)),
        squared_(SquaredNorms(errors_, data)),
        dimensions_(Dimensions(data)) {
    const double chance =
        kChanceOfOutlier / static_cast<double>(std::max<Eigen::Index>(
                               1, data.global_observations()));
    for (std::size_t rows = 1; rows < limits_.size(); ++rows) {
      limits_[rows] = ChiSquareUpperQuantile(chance, static_cast<int>(rows));
    }
  }

  bool HasCandidates() const {
    bool is_any = false;
    for (Eigen::Index i = 0; i < squared_.size() && !is_any; ++i) {
      is_any = IsBeyond(i, squared_[i]);
    }
    return Sum(is_any ? 1 : 0) > 0;
  }

  // Predictions are less certain than the measurements alone: outliers are
  // among those beyond the limit already.
  void Predict(const ParameterCovariance& covariance) {
    const Eigen::MatrixXd sigmas = StackedSigmas();
    const RowSpread spreads(fit_.model(), fit_.values, covariance, data_);
    predicted_.assign(squared_.data(), squared_.data() + squared_.size());
    ForEachObservation(
        fit_.model(), fit_.values, data_, covariance.columns,
        [&](int, Eigen::Index i, const Eigen::Ref<const Eigen::MatrixXd>& all) {
          if (!IsBeyond(i, squared_[i])) return;
          const Eigen::Index p = all.cols() - 1;
          const Eigen::MatrixXd spread = spreads.Of(i, all.leftCols(p));
          Eigen::MatrixXd variance = spread * spread.transpose();
          for (Eigen::Index row = 0; row < all.rows(); ++row) {
            variance(row, row) +=
                covariance.excess.RowVariance(row, sigmas(row, i));
          }
          const Eigen::VectorXd residual = all.col(p);
          predicted_[i] = covariance.AreTold(all.leftCols(p))
                              ? residual.dot(variance.llt().solve(residual))
                              : 0.0;
        });
  }

  void Run() {
    constexpr int kPositionRows = 3;
    found_.limit = std::sqrt(limits_[kPositionRows]);
    const SharedVector lengths = LengthErrors(errors_, data_);
    Eigen::Index count = 0;
    for (std::size_t k = 0; k < data_.blocks.size(); ++k) {
      for (Eigen::Index i = 0; i < data_.blocks[k].size(); ++i, ++count) {
        const double squared =
            predicted_.empty() ? squared_[count] : predicted_[count];
        if (!IsBeyond(count, squared)) continue;
        const double weight =
            losses_.empty() ? 1.0
                            : losses_[dimensions_[count] - 1].Weight(squared);
        outliers_.push_back(count);
        if (weight < kRejected) rejected_.push_back(count);
        found_.outliers.push_back({GlobalObservation(data_, k, i),
                                   LabelOf(fit_.model().nominal(), data_, k, i),
                                   lengths[count], std::sqrt(squared), weight});
      }
    }
    found_.num_outliers = Sum(static_cast<std::int64_t>(outliers_.size()));
    Gather();
  }

  std::int64_t num_outliers() const { return found_.num_outliers; }

  OutlierSearch Take() {
    found_.num_rejected = Sum(static_cast<std::int64_t>(rejected_.size()));
    if (found_.num_rejected > 0) found_.kept = Without(rejected_, data_);
    return std::move(found_);
  }

  void LeaveOut() { found_.ordinary = Without(outliers_, data_); }

  void RejectNone() {
    for (Outlier& outlier : found_.outliers) outlier.weight = 1.0;
    rejected_.clear();
  }

 private:
  bool IsBeyond(Eigen::Index i, double squared) const {
    return dimensions_[i] > 0 && squared > limits_[dimensions_[i]];
  }

  // Of each observation, by its rows.
  Eigen::MatrixXd StackedSigmas() const {
    Eigen::MatrixXd sigmas = Eigen::MatrixXd::Ones(6, squared_.size());
    Eigen::Index first = 0;
    for (const ObservationBlock& block : data_.blocks) {
      sigmas.block(0, first, block.rows_each(), block.size()) =
          block.sigmas.map();
      first += block.size();
    }
    return sigmas;
  }

  std::int64_t Sum(std::int64_t mine) const {
    return SumOverRanks(fit_.task.communicator, data_, mine);
  }

  void Gather() {
    found_.outliers = WithThoseOfOthers(fit_.task.communicator, data_,
                                        std::move(found_.outliers));
    std::stable_sort(found_.outliers.begin(), found_.outliers.end(),
                     [](const Outlier& a, const Outlier& b) {
                       if (a.standardised != b.standardised) {
                         return a.standardised > b.standardised;
                       }
                       return a.observation < b.observation;
                     });
  }

  const CalibrationSolution& fit_;
  const Dataset& data_;
  const std::vector<RobustLoss> losses_;
  const SharedVector errors_;
  const SharedVector squared_;
  const Eigen::VectorXi dimensions_;
  std::array<double, 7> limits_{};  // squared, of observations of 0 to 6 rows
  std::vector<double> predicted_;   // squared, in predicted deviations
  std::vector<Eigen::Index> outliers_;
  std::vector<Eigen::Index> rejected_;
  OutlierSearch found_;
};

}  // namespace

std::vector<Eigen::Index> RejectedObservations(
    const std::vector<Outlier>& outliers) {
  std::vector<Eigen::Index> rejected;
  for (const Outlier& outlier : outliers) {
    if (outlier.weight < kRejected) rejected.push_back(outlier.observation);
  }
  std::sort(rejected.begin(), rejected.end());
  return rejected;
}

std::string PlacesOf(const std::vector<Outlier>& outliers) {
  constexpr std::size_t kMostNamed = 3;
  const bool has_rejected = !RejectedObservations(outliers).empty();
  std::vector<std::string> places;
  std::size_t more = 0;
  for (const Outlier& outlier : outliers) {
    if (has_rejected && !(outlier.weight < kRejected)) continue;
    if (outlier.label.where.empty()) return "";
    if (places.size() < kMostNamed) {
      places.push_back(outlier.label.where);
    } else {
      ++more;
    }
  }
  if (places.empty()) return "";
  return " (" + Join(places, ", ") +
         (more > 0 ? " and " + std::to_string(more) + " more" : "") + ")";
}

OutlierSearch FindOutliers(const CalibrationSolution& fit) {
  Search search(fit, fit.task.data.training);
  search.Run();
  return search.Take();
}

OutlierSearch FindValidationOutliers(const CalibrationSolution& fit,
                                     const OutlierSearch& training,
                                     const ParameterCovariance& prediction) {
  const Dataset& data = *fit.task.data.validation;
  Search search(fit, data);
  if (search.HasCandidates()) search.Predict(prediction);
  search.Run();
  const auto part = [](std::int64_t count, Eigen::Index all) {
    return static_cast<double>(count) /
           static_cast<double>(std::max<Eigen::Index>(1, all));
  };
  constexpr double kMostPart = 0.4;
  const double few = std::clamp(
      kTimesTraining * part(training.num_outliers,
                            fit.task.data.training.global_observations()),
      kFewPart, kMostPart);
  if (part(search.num_outliers(), data.global_observations()) > few) {
    search.RejectNone();
  } else if (search.num_outliers() > 0) {
    search.LeaveOut();
  }
  return search.Take();
}

void CountKeptAlone(const CalibrationSolution& fit,
                    const OutlierSearch& training, SolverSummary* summary) {
  if (!training.kept) return;
  summary->num_rejected = training.num_rejected;
  for (IterationRecord& record : summary->iterations) {
    const Accuracy accuracy =
        EvaluateAccuracy(fit.model(), *training.kept, record.values);
    record.max_error = accuracy.max;
    record.rms_error = accuracy.rms;
  }
}

}  // namespace alidade::internal
