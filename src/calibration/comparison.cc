#include "alidade/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_map>
#include <utility>

#include "src/calibration/improvement.h"
#include "src/calibration/parameter_assessment.h"
#include "src/common/format.h"
#include "src/common/text.h"

namespace alidade::internal {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// The standard deviation of normal values over their MAD.
constexpr double kMadToSigma = 1.4826;

// A tenth of the median error: arms are not distinguished by less.
constexpr double kRelativeFloor = 0.1;
constexpr double kGeometryFloor = 0.3;
// Of parameters whose standard deviation nobody knows (m, rad).
constexpr double kParameterFloor = 1e-6;
// One parameter alone shall not decide on the geometry of an arm.
constexpr double kLargestScore = 10.0;
constexpr std::size_t kFewestFree = 3;

constexpr std::size_t kNamedArms = 4;
constexpr std::size_t kNamedChanges = 3;

double MedianOf(std::vector<double> values) {
  values.erase(std::remove_if(values.begin(), values.end(),
                              [](double v) { return !std::isfinite(v); }),
               values.end());
  if (values.empty()) return kNone;
  std::sort(values.begin(), values.end());
  return 0.5 * (values[(values.size() - 1) / 2] + values[values.size() / 2]);
}

std::string SignedQuantity(double value, Dimension dimension) {
  const double unit = dimension == Dimension::kLength ? kMillimetre : kDegree;
  return (value > 0.0 ? "+" : "") + FormatSignificant(value / unit, 3) + " " +
         UnitForPeople(dimension);
}

// Deviations of every parameter by result, in the order in which results name
// them, with the median of its standard deviations.
std::vector<FleetParameter> ScoreParameters(
    const std::vector<ComparedResult>& results) {
  std::vector<FleetParameter> all;
  std::vector<std::vector<double>> stds;
  std::unordered_map<std::string, std::size_t> places;
  for (std::size_t i = 0; i < results.size(); ++i) {
    for (const ComparedParameter& parameter : results[i].parameters) {
      if (!parameter.is_free) continue;
      const auto [found, is_new] = places.emplace(parameter.name, all.size());
      if (is_new) {
        all.push_back({parameter.name, parameter.dimension, {}});
        all.back().deviations.values.assign(results.size(), kNone);
        stds.emplace_back();
      }
      all[found->second].deviations.values[i] = parameter.deviation;
      stds[found->second].push_back(parameter.std);
    }
  }
  std::vector<FleetParameter> kept;
  for (std::size_t k = 0; k < all.size(); ++k) {
    std::vector<double>& values = all[k].deviations.values;
    const auto num_free =
        std::count_if(values.begin(), values.end(),
                      [](double value) { return std::isfinite(value); });
    if (static_cast<std::size_t>(num_free) < kFewestFree) continue;
    const double std = MedianOf(stds[k]);
    all[k].deviations = ScoreRobustly(
        std::move(values), 0.0, std::isfinite(std) ? std : kParameterFloor);
    kept.push_back(std::move(all[k]));
  }
  return kept;
}

// Root mean square of an arm's scores, about 1 for a typical arm.
double GeometryDifference(const std::vector<FleetParameter>& parameters,
                          std::size_t arm) {
  double sum = 0.0;
  int count = 0;
  for (const FleetParameter& parameter : parameters) {
    const double score = parameter.deviations.scores[arm];
    if (!std::isfinite(score)) continue;
    const double cut = std::min(std::abs(score), kLargestScore);
    sum += cut * cut;
    ++count;
  }
  return count > 0 ? std::sqrt(sum / count) : kNone;
}

Finding MakeFinding(const std::string& key, double score,
                    const std::string& sentence) {
  const bool is_outlying = score > FleetSummary::kThreshold;
  return {key, score, FleetSummary::kThreshold,
          sentence + " (z = " + FormatSignificant(score, 3) + ")",
          is_outlying ? FindingLevel::kAttention : FindingLevel::kPassed};
}

std::string ErrorText(const char* when, double error, double median) {
  return std::string("mean error ") + when + " calibration " +
         FormatLength(error, 3) + ", typically " + FormatLength(median, 3);
}

FleetArm JudgeArm(const FleetSummary& fleet, std::size_t i) {
  FleetArm arm;
  arm.result = i;
  double most = -1.0;
  for (std::size_t k = 0; k < fleet.parameters.size(); ++k) {
    const double score = std::abs(fleet.parameters[k].deviations.scores[i]);
    if (!(score > most)) continue;
    most = score;
    arm.most_different = k;
  }
  std::string geometry = "geometry unlike that of the others";
  if (arm.most_different) {
    const FleetParameter& parameter = fleet.parameters[*arm.most_different];
    geometry +=
        ", most in " + parameter.name + " (" +
        SignedQuantity(parameter.deviations.values[i], parameter.dimension) +
        " from nominal)";
  }
  arm.findings = {MakeFinding("before", fleet.before.scores[i],
                              ErrorText("before", fleet.before.values[i],
                                        fleet.before.median)),
                  MakeFinding("after", fleet.after.scores[i],
                              ErrorText("after", fleet.after.values[i],
                                        fleet.after.median)),
                  MakeFinding("geometry", fleet.geometry.scores[i], geometry)};
  for (const Finding& finding : arm.findings) {
    if (finding.statistic > arm.score) arm.score = finding.statistic;
  }
  arm.is_outlier = arm.score > FleetSummary::kThreshold;
  return arm;
}

std::string OutlierReasons(const FleetArm& arm) {
  std::vector<std::string> reasons;
  for (const Finding& finding : arm.findings) {
    if (finding.level == FindingLevel::kAttention) {
      reasons.push_back(finding.sentence);
    }
  }
  return Join(reasons, "; ");
}

void JudgeFleet(const std::vector<ComparedResult>& results,
                std::int64_t num_failed, FleetSummary* fleet) {
  std::vector<std::string> outliers;
  for (const FleetArm& arm : fleet->arms) {
    if (arm.is_outlier) outliers.push_back(results[arm.result].label);
  }
  const auto num_outliers = static_cast<std::int64_t>(outliers.size());
  const std::string arms =
      Count(static_cast<std::int64_t>(results.size()), "arm");
  if (outliers.empty()) {
    fleet->level =
        num_failed > 0 ? FindingLevel::kFailed : FindingLevel::kPassed;
    fleet->title = num_failed > 0 ? "Failures" : "No outlier";
    fleet->sentence = "None of " + arms + " is an outlier.";
  } else {
    fleet->level = FindingLevel::kAttention;
    fleet->title = Count(num_outliers, "outlier");
    fleet->sentence =
        num_outliers == 1
            ? outliers[0] + " is an outlier among " + arms + ": " +
                  OutlierReasons(fleet->arms[0]) + "."
            : std::to_string(num_outliers) + " of " + arms + " are outliers: ";
  }
  if (num_outliers > 1) {
    const bool is_long = outliers.size() > kNamedArms;
    if (is_long) outliers.resize(kNamedArms);
    fleet->sentence +=
        Join(outliers, ", ") +
        (is_long ? " and " +
                       std::to_string(num_outliers -
                                      static_cast<std::int64_t>(kNamedArms)) +
                       " more."
                 : ".");
  }
  if (num_failed > 0) {
    fleet->sentence += " " + Count(num_failed, "calibration") + " failed.";
  }
}

// What there is to say of no results.
template <typename Summary>
bool IsEmpty(const std::vector<ComparedResult>& results, Summary* summary) {
  if (!results.empty()) return false;
  summary->level = FindingLevel::kFailed;
  summary->title = "No result";
  summary->sentence = "Every calibration failed.";
  return true;
}

const ComparedParameter* Find(const ComparedResult& result,
                              const std::string& name) {
  for (const ComparedParameter& parameter : result.parameters) {
    if (parameter.name == name) return &parameter;
  }
  return nullptr;
}

std::vector<ParameterChange> ListChanges(
    const std::vector<ComparedResult>& results) {
  std::vector<ParameterChange> changes;
  for (std::size_t i = 0; i + 1 < results.size(); ++i) {
    for (const ComparedParameter& earlier : results[i].parameters) {
      const ComparedParameter* const later = Find(results[i + 1], earlier.name);
      if (!earlier.is_free || later == nullptr || !later->is_free) continue;
      ParameterChange change;
      change.name = earlier.name;
      change.dimension = earlier.dimension;
      change.from = i;
      change.before = earlier.value;
      change.after = later->value;
      change.std = std::hypot(earlier.std, later->std);
      change.is_significant =
          std::abs(change.score()) > DriftSummary::kThreshold;
      changes.push_back(std::move(change));
    }
  }
  // Those that cannot be judged last.
  const auto size = [](const ParameterChange& change) {
    const double score = std::abs(change.score());
    return std::isnan(score) ? 0.0 : score;
  };
  std::stable_sort(changes.begin(), changes.end(),
                   [&size](const ParameterChange& a, const ParameterChange& b) {
                     return size(a) > size(b);
                   });
  return changes;
}

// Compliances, and joint functions at every twentieth degree that was measured,
// less their means there, which are the joint's zero as well.
void AddErrorTerms(const CalibrationResult& result, ComparedResult* compared) {
  constexpr double kStep = 20.0 * kDegree;
  if (!result.error_terms) return;
  for (const ErrorTermEstimate& term : result.error_terms->terms) {
    if (term.unit != "rad/(N m)") continue;
    compared->parameters.push_back({term.name + " per N m", Dimension::kAngle,
                                    term.value, term.value, term.std, true});
  }
  for (std::size_t j = 0; j < result.arm.errors.joints.size(); ++j) {
    const JointFunction& function = result.arm.errors.joints[j].function;
    const auto& measured = result.error_terms->measured;
    const auto range = std::find_if(
        measured.begin(), measured.end(), [j](const MeasuredRange& one) {
          return one.joint == static_cast<int>(j) + 1;
        });
    if (function.deviations.size() == 0 || range == measured.end()) continue;
    std::vector<double> places;
    double mean = 0.0;
    const auto last = static_cast<int>(std::floor(range->upper / kStep));
    for (auto k = static_cast<int>(std::ceil(range->lower / kStep)); k <= last;
         ++k) {
      places.push_back(k * kStep);
      mean += function.At(places.back());
    }
    mean /= std::max<double>(1.0, static_cast<double>(places.size()));
    for (const double q : places) {
      const double value = function.At(q) - mean;
      compared->parameters.push_back(
          {fmt::format("e{}({:.0f} deg)", j + 1, q / kDegree),
           Dimension::kAngle, value, value, function.DeviationAt(q), true});
    }
  }
}

}  // namespace
}  // namespace alidade::internal

namespace alidade {

using internal::Count;
using internal::FormatLength;
using internal::FormatSignificant;
using internal::GeometryDifference;
using internal::IsEmpty;
using internal::Join;
using internal::JudgeArm;
using internal::JudgedSet;
using internal::JudgeFleet;
using internal::kGeometryFloor;
using internal::kMadToSigma;
using internal::kNamedChanges;
using internal::kNone;
using internal::KnownStd;
using internal::kRelativeFloor;
using internal::ListChanges;
using internal::MedianOf;
using internal::ScoreParameters;
using internal::SignedQuantity;

ComparedResult DescribeForComparison(const std::string& label,
                                     const CalibrationResult& result) {
  const EvaluatedSet& set = JudgedSet(result);
  const KeptErrors errors = set.Judged();
  ComparedResult compared{
      label, errors.before, errors.after, &set != &result.train, {}};
  for (const ParameterResult& parameter : result.parameters) {
    const std::string& kind = parameter.kind;
    if (kind != "beta" && kind != "alpha" && kind != "d" && kind != "theta" &&
        kind != "r") {
      continue;
    }
    const double std = KnownStd(result, parameter);
    compared.parameters.push_back(
        {parameter.name, parameter.dimension, parameter.value,
         parameter.deviation(), std::isfinite(std) ? std : kNone,
         parameter.decision.state == ParameterState::kFree});
  }
  internal::AddErrorTerms(result, &compared);
  return compared;
}

RobustScores ScoreRobustly(std::vector<double> values, double relative_floor,
                           double absolute_floor) {
  RobustScores result;
  result.values = std::move(values);
  result.median = MedianOf(result.values);
  std::vector<double> distances;
  for (const double value : result.values) {
    distances.push_back(std::abs(value - result.median));
  }
  result.spread = std::max(kMadToSigma * MedianOf(distances),
                           relative_floor * result.median + absolute_floor);
  for (const double value : result.values) {
    result.scores.push_back(std::isfinite(value) && result.spread > 0.0
                                ? (value - result.median) / result.spread
                                : kNone);
  }
  return result;
}

FleetSummary CompareFleet(const std::vector<ComparedResult>& results,
                          std::int64_t num_failed) {
  FleetSummary fleet;
  if (IsEmpty(results, &fleet)) return fleet;
  fleet.is_small = results.size() < FleetSummary::kFewest;
  fleet.parameters = ScoreParameters(results);
  std::vector<double> before, after, geometry;
  for (std::size_t i = 0; i < results.size(); ++i) {
    before.push_back(results[i].before.mean);
    after.push_back(results[i].after.mean);
    geometry.push_back(GeometryDifference(fleet.parameters, i));
  }
  fleet.before = ScoreRobustly(std::move(before), kRelativeFloor, 0.0);
  fleet.after = ScoreRobustly(std::move(after), kRelativeFloor, 0.0);
  fleet.geometry = ScoreRobustly(std::move(geometry), 0.0, kGeometryFloor);
  for (std::size_t i = 0; i < results.size(); ++i) {
    fleet.arms.push_back(JudgeArm(fleet, i));
  }
  std::stable_sort(
      fleet.arms.begin(), fleet.arms.end(),
      [](const FleetArm& a, const FleetArm& b) { return a.score > b.score; });
  JudgeFleet(results, num_failed, &fleet);
  return fleet;
}

DriftSummary CompareOverTime(const std::vector<ComparedResult>& results) {
  DriftSummary drift;
  if (IsEmpty(results, &drift)) return drift;
  drift.changes = ListChanges(results);
  const auto& changes = drift.changes;
  if (std::none_of(changes.begin(), changes.end(),
                   [](const ParameterChange& change) {
                     return std::isfinite(change.score());
                   })) {
    drift.level = FindingLevel::kAttention;
    drift.title = "Cannot be determined";
    drift.sentence =
        "No joint parameter is estimated with a standard deviation in two "
        "successive results, so that changes cannot be judged.";
    return drift;
  }
  const std::int64_t found = std::count_if(
      changes.begin(), changes.end(),
      [](const ParameterChange& change) { return change.is_significant; });
  if (found == 0) {
    drift.title = "No significant change";
    drift.sentence = "No joint parameter changed by more than " +
                     FormatSignificant(DriftSummary::kThreshold, 1) +
                     " standard deviations between " + results.front().label +
                     " and " + results.back().label + ".";
    return drift;
  }
  drift.level = FindingLevel::kAttention;
  drift.title = Count(found, "significant change");
  std::vector<std::string> named;
  for (const ParameterChange& change : changes) {
    if (!change.is_significant || named.size() == kNamedChanges) break;
    named.push_back(change.name + " by " +
                    SignedQuantity(change.difference(), change.dimension) +
                    " (" + FormatSignificant(std::abs(change.score()), 2) +
                    " standard deviations) from " + results[change.from].label +
                    " to " + results[change.from + 1].label);
  }
  drift.sentence =
      (found == 1 ? std::string("One joint parameter changed significantly: ")
                  : std::to_string(found) +
                        " changes of joint parameters are significant, the "
                        "largest: ") +
      Join(named, "; ") + ".";
  return drift;
}

MethodSummary CompareMethods(const std::vector<ComparedResult>& results) {
  MethodSummary methods;
  if (IsEmpty(results, &methods)) return methods;
  methods.ranking.resize(results.size());
  std::iota(methods.ranking.begin(), methods.ranking.end(), std::size_t{0});
  std::stable_sort(methods.ranking.begin(), methods.ranking.end(),
                   [&results](std::size_t a, std::size_t b) {
                     return results[a].after.mean < results[b].after.mean;
                   });
  const std::size_t number = results.size();
  methods.title = Count(static_cast<std::int64_t>(number),
                        methods.are_runs() ? "run" : "method");
  const ComparedResult& best = results[methods.ranking.front()];
  const ComparedResult& worst = results[methods.ranking.back()];
  const bool are_validated = std::all_of(
      results.begin(), results.end(),
      [](const ComparedResult& result) { return result.is_validated; });
  if (methods.are_runs()) {
    const auto error = [&](double share) {
      const auto place = static_cast<std::size_t>(
          std::lround(share * static_cast<double>(number - 1)));
      return FormatLength(results[methods.ranking[place]].after.mean, 3);
    };
    methods.sentence = std::to_string(number) +
                       " runs: after calibration the mean error at " +
                       (are_validated ? "validation" : "training") +
                       " poses is " + error(0.5) + " in the median run, " +
                       error(0.05) + " to " + error(0.95) + " in 90 % of them.";
    return methods;
  }
  methods.sentence = best.label + " has the lowest mean error at " +
                     (are_validated ? "validation" : "training") + " poses, " +
                     FormatLength(best.after.mean, 3);
  if (results.size() > 1) {
    methods.sentence += "; " + worst.label + " has the highest, " +
                        FormatLength(worst.after.mean, 3);
  }
  methods.sentence += ".";
  return methods;
}

}  // namespace alidade
