#ifndef ALIDADE_COMPARISON_H_
#define ALIDADE_COMPARISON_H_

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "alidade/accuracy.h"
#include "alidade/calibration_result.h"
#include "alidade/units.h"

namespace alidade {

// Several results side by side, read in three ways: as a fleet (one result an
// arm: which arm is an outlier), as one arm over time (which parameters changed
// from each result to the next), and as methods (the same measurements, which
// way of calibrating them leaves the lowest error).

/// How several results are read first.
enum class ComparisonKind { kFleet, kTime, kMethods };

/// A joint parameter of a result.
struct ComparedParameter {
  std::string name;
  Dimension dimension = Dimension::kLength;
  double value = 0.0;
  double deviation = 0.0;  ///< from nominal
  /// Standard deviation, predicted where it was not computed; NaN if unknown.
  double std = std::numeric_limits<double>::quiet_NaN();
  bool is_free = false;
};

/// What a comparison needs of a result, some kilobytes.
struct ComparedResult {
  std::string label;
  /// Position errors at the validation poses where there are any, else at those
  /// of the fit.
  Accuracy before;
  Accuracy after;
  bool is_validated = false;
  /// Of the joints. Base and target move with the instrument and the target,
  /// which says nothing of the arm.
  std::vector<ComparedParameter> parameters;
};

ComparedResult DescribeForComparison(const std::string& label,
                                     const CalibrationResult& result);

/// Values of one quantity, one for each result, and how far each is from their
/// median in robust standard deviations:
///
///     score = (value - median) / max(1.4826 MAD, floor),
///
/// MAD being the median of |value - median|, so that 1.4826 MAD estimates the
/// standard deviation of normal values and ignores outliers. This is the
/// modified z-score of Iglewicz and Hoaglin (How to Detect and Handle Outliers,
/// ASQC 1993), with a floor for values that hardly scatter.
struct RobustScores {
  double median = std::numeric_limits<double>::quiet_NaN();
  double spread = 0.0;  ///< the denominator above
  std::vector<double> values;
  std::vector<double> scores;  ///< NaN where there is no value, or no spread
};

/// The floor is `relative_floor` times the median plus `absolute_floor`. Values
/// that are not finite are left out of median and MAD.
RobustScores ScoreRobustly(std::vector<double> values, double relative_floor,
                           double absolute_floor);

/// An arm among others.
struct FleetArm {
  std::size_t result = 0;  ///< its place in what was compared
  bool is_outlier = false;
  double score = 0.0;  ///< the largest of its three, 0 if all are smaller
  /// Keys "before", "after" and "geometry": the score, the threshold, and in
  /// words what is unusual. Scores beyond the threshold have level kAttention.
  std::vector<Finding> findings;
  /// The parameter with the largest absolute score: its place in
  /// FleetSummary::parameters; nothing where no parameter is compared.
  std::optional<std::size_t> most_different;
};

/// The deviations from nominal of one parameter, NaN where it is not free.
struct FleetParameter {
  std::string name;
  Dimension dimension = Dimension::kLength;
  RobustScores deviations;
};

/// Which arms are outliers among the others: where the mean error before
/// calibration, that after it, or the difference of the geometry scores above
/// 3.5, the threshold that Iglewicz and Hoaglin recommend. Floors: a tenth of
/// the median error; 0.3 for the geometry. The difference of an arm's geometry
/// is the root mean square of its parameters' scores, each cut at 10 (floor:
/// the median standard deviation of the parameter), and about 1 for a typical
/// arm; parameters that are free in fewer than three arms do not count. With
/// fewer than five arms the scores have little meaning (`is_small`).
struct FleetSummary {
  static constexpr double kThreshold = 3.5;
  static constexpr std::size_t kFewest = 5;

  FindingLevel level = FindingLevel::kPassed;
  std::string title;  ///< "No outlier" ...
  std::string sentence;
  bool is_small = false;
  RobustScores before;
  RobustScores after;
  RobustScores geometry;
  std::vector<FleetParameter> parameters;
  std::vector<FleetArm> arms;  ///< by score, the largest first
};

/// A parameter that is free in two results that follow each other.
struct ParameterChange {
  std::string name;
  Dimension dimension = Dimension::kLength;
  std::size_t from = 0;  ///< the earlier result; the other is the next one
  double before = 0.0;
  double after = 0.0;
  double std = 0.0;  ///< of the difference: root of the sum of both variances
  bool is_significant = false;

  double difference() const { return after - before; }
  /// In standard deviations; NaN where these are unknown.
  double score() const { return difference() / std; }
};

/// Which parameters changed from each result to the next: significantly where
/// the difference is larger than 3 of its standard deviations, which
/// measurement noise alone does once in 370 comparisons.
struct DriftSummary {
  static constexpr double kThreshold = 3.0;

  FindingLevel level = FindingLevel::kPassed;
  std::string title;  ///< "No significant change" ...
  std::string sentence;
  std::vector<ParameterChange> changes;  ///< by absolute score, largest first
};

/// Results by mean error after calibration. So many that nobody reads them one
/// by one are runs (of a study, of a batch over seeds), summarised as a whole.
struct MethodSummary {
  static constexpr std::size_t kMostMethods = 30;

  FindingLevel level = FindingLevel::kPassed;
  std::string title;
  std::string sentence;
  std::vector<std::size_t> ranking;  ///< places of the results, lowest first

  bool are_runs() const { return ranking.size() > kMostMethods; }
};

/// `num_failed` calibrations came to no result. O(n p) for n results of p
/// parameters, but for sorting. With fewer than two results sentences say so.
FleetSummary CompareFleet(const std::vector<ComparedResult>& results,
                          std::int64_t num_failed);
DriftSummary CompareOverTime(const std::vector<ComparedResult>& results);
MethodSummary CompareMethods(const std::vector<ComparedResult>& results);

}  // namespace alidade

#endif  // ALIDADE_COMPARISON_H_
