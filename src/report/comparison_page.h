#ifndef ALIDADE_SRC_REPORT_COMPARISON_PAGE_H_
#define ALIDADE_SRC_REPORT_COMPARISON_PAGE_H_

#include <cstddef>
#include <string>
#include <vector>

#include "alidade/calibration_result.h"
#include "alidade/comparison.h"
#include "src/report/comparison_views.h"

namespace alidade::internal {

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
