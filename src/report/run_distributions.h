#ifndef ALIDADE_SRC_REPORT_RUN_DISTRIBUTIONS_H_
#define ALIDADE_SRC_REPORT_RUN_DISTRIBUTIONS_H_

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "alidade/units.h"
#include "src/report/svg_chart.h"

namespace alidade::internal {

/// What many runs found of one parameter (rad, m).
struct RunParameter {
  std::string name;
  Dimension dimension = Dimension::kLength;
  double predicted_std = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> values;  ///< one for each run; NaN where it has none
};

/// Many calibrations, of which the whole says more than each.
struct ManyRuns {
  std::string each = "run";    ///< what one is called
  std::string error;           ///< "mean position error", of each run
  std::vector<double> before;  ///< errors (m); empty: not known of each
  std::vector<double> after;
  /// What was predicted for the error after calibration (m); NaN = nothing.
  double predicted = std::numeric_limits<double>::quiet_NaN();
  std::vector<RunParameter> parameters;
};

/// Two parameters whose values go together.
struct ParameterPair {
  std::size_t first = 0;
  std::size_t second = 0;
  double correlation = 0.0;
};

/// The `most` pairs with the largest absolute correlation over the runs that
/// have both, the strongest first; each parameter is in one pair at most.
/// Parameters that do not scatter are in none.
std::vector<ParameterPair> MostCorrelated(
    const std::vector<RunParameter>& parameters, std::size_t most);

/// How many errors after calibration are in each of equal parts.
LineChart ErrorHistogram(const ManyRuns& runs);
/// The share of runs with an error up to any value (the empirical distribution
/// function), before and after.
LineChart ErrorDistribution(const ManyRuns& runs);
/// The standard deviation of every parameter over the runs against the one
/// that was predicted.
LineChart SpreadChart(const ManyRuns& runs, Dimension dimension);
/// The values of two parameters in all runs.
LineChart PairChart(const ManyRuns& runs, const ParameterPair& pair);

/// All of these as figures of a page.
std::string DistributionFigures(const ManyRuns& runs);

/// "0.0345 mm in the median run, 0.0301 to 0.0399 mm in 90 % of them".
std::string MedianAndRange(std::vector<double> errors, const std::string& each);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_REPORT_RUN_DISTRIBUTIONS_H_
