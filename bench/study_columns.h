#ifndef ALIDADE_BENCH_STUDY_COLUMNS_H_
#define ALIDADE_BENCH_STUDY_COLUMNS_H_

#include <algorithm>
#include <vector>

#include "alidade/parameter_layout.h"

namespace alidade::internal::bench {

/// Columns of the 17 parameters that the RV-2AJ study frees, ascending.
inline std::vector<int> StudyColumns(const ParameterLayout& layout) {
  std::vector<int> columns;
  for (const char* name :
       {"beta1", "beta3", "beta4", "alpha1", "alpha2", "alpha3", "d1", "d2",
        "d3", "d4", "d5", "theta1", "theta2", "theta3", "r1", "r2", "r5"}) {
    columns.push_back(*layout.Find(name));
  }
  std::sort(columns.begin(), columns.end());
  return columns;
}

}  // namespace alidade::internal::bench

#endif  // ALIDADE_BENCH_STUDY_COLUMNS_H_
