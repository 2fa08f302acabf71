#ifndef ALIDADE_SRC_REPORT_COVERAGE_CHART_H_
#define ALIDADE_SRC_REPORT_COVERAGE_CHART_H_

#include <string>
#include <vector>

#include "alidade/units.h"
#include "src/report/svg_writer.h"

namespace alidade::internal {

/// The values of one joint, in the unit of people, over its range.
struct CoverageRow {
  std::string label;
  std::string unit;  ///< "deg", "mm"
  double lower = 0.0;
  double upper = 0.0;
  bool has_limits = false;  ///< lower and upper are joint limits
  std::vector<double> values;
};

/// A histogram for each joint over its own range, one below the other.
struct CoverageChart {
  std::string title = {};
  std::string subtitle = {};
  std::vector<CoverageRow> rows = {};
};

std::string RenderSvg(const CoverageChart& chart,
                      FigureMedium medium = FigureMedium::kFile);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_REPORT_COVERAGE_CHART_H_
