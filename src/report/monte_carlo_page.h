#ifndef ALIDADE_SRC_REPORT_MONTE_CARLO_PAGE_H_
#define ALIDADE_SRC_REPORT_MONTE_CARLO_PAGE_H_

#include <string>

#include "alidade/monte_carlo.h"
#include "src/report/svg_chart.h"
#include "src/report/table.h"

namespace alidade::internal {

// What montecarlo.txt and montecarlo.html both have.

/// How many trials of what truth.
std::string MonteCarloOpening(const MonteCarloResult& result);
/// How often intervals and ellipsoids over the workspace hold the truth.
std::string MonteCarloCoverage(const MonteCarloResult& result);
Table SimulatedParameterTable(const MonteCarloResult& result);
/// How often the interval of each parameter holds the truth.
LineChart CoverageOfParameters(const MonteCarloResult& result);

/// montecarlo.html: what the trials show, as distributions.
std::string RenderMonteCarloPage(const MonteCarloResult& result);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_REPORT_MONTE_CARLO_PAGE_H_
