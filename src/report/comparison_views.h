#ifndef ALIDADE_SRC_REPORT_COMPARISON_VIEWS_H_
#define ALIDADE_SRC_REPORT_COMPARISON_VIEWS_H_

#include <cstdint>
#include <string>
#include <vector>

#include "alidade/calibration_result.h"
#include "alidade/comparison.h"

namespace alidade::internal {

/// One solver of a result.
struct ComparedRun {
  std::string solver;
  SolverStatus status = SolverStatus::kNotRun;
  std::int64_t iterations = 0;
  double cost = 0.0;
  double train_mean = 0.0;  ///< mean error at the poses of the fit (m)
  double time_s = 0.0;
};

/// What a comparison page needs of a result.
struct ComparisonItem {
  ComparedResult values;  ///< what is compared
  std::string version;
  std::string data;  ///< what it was measured on
  std::string link;  ///< from the page to the result's own; empty = none
  std::int64_t num_free = 0;
  std::int64_t num_limits = 0;
  std::int64_t num_missed = 0;
  std::int64_t num_warnings = 0;
  std::vector<ComparedRun> runs;
};

/// What comparison pages are made of: results and, for each, what else is
/// known of it.
struct ComparedItems {
  const std::vector<ComparedResult>& values;
  const std::vector<ComparisonItem>& items;
};

// A view of a page as markup: which arm is an outlier, which parameters
// changed, which method has the lowest error.
std::string FleetView(const ComparedItems& all, const FleetSummary& fleet);
std::string TimeView(const ComparedItems& all, const DriftSummary& drift);
std::string MethodsView(const ComparedItems& all, const MethodSummary& methods);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_REPORT_COMPARISON_VIEWS_H_
