#ifndef ALIDADE_SRC_REPORT_COMPARISON_VIEWS_H_
#define ALIDADE_SRC_REPORT_COMPARISON_VIEWS_H_

#include <string>
#include <vector>

#include "alidade/comparison.h"
#include "src/report/comparison_page.h"

namespace alidade::internal {

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
