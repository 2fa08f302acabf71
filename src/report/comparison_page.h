#ifndef ALIDADE_SRC_REPORT_COMPARISON_PAGE_H_
#define ALIDADE_SRC_REPORT_COMPARISON_PAGE_H_

#include <cstddef>
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

ComparisonItem MakeComparisonItem(const std::string& label,
                                  const CalibrationResult& result,
                                  const std::string& link);

/// One page of several results, which can be read in each way. 1 to 2 kB of
/// page a result; it holds what it needs of each, not the results.
class ComparisonPage {
 public:
  void Add(ComparisonItem item);
  /// As MakeComparisonItem.
  void Add(const std::string& label, const CalibrationResult& result,
           const std::string& link) {
    Add(MakeComparisonItem(label, result, link));
  }
  /// A job that came to no result, and why.
  void AddFailure(const std::string& label, const std::string& message);

  std::size_t num_results() const { return data_.size(); }

  /// Methods where all results are of the same data files and the same arm,
  /// else a fleet, which cannot be distinguished from an arm over time.
  ComparisonKind GuessKind() const;

  /// What the comparison shows, as the page says it.
  std::string Sentence(ComparisonKind kind) const;

  /// The first 2000 results in full, and how many more there are.
  std::string Render(ComparisonKind kind) const;

 private:
  struct Failure {
    std::string label;
    std::string message;
  };

  std::vector<ComparedResult> values_;
  std::vector<ComparisonItem> items_;  ///< without their values
  std::vector<Failure> failures_;
  std::vector<std::string> data_;  ///< what each result was measured on
  std::string version_;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_REPORT_COMPARISON_PAGE_H_
