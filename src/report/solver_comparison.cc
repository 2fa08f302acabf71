#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "src/common/format.h"
#include "src/common/text.h"
#include "src/report/report.h"
#include "src/report/result_tables.h"
#include "src/solve/solver_names.h"

namespace alidade::internal {
namespace {

constexpr int kStatusWidth = 24;
// A longer history shows its beginning and its end.
constexpr std::size_t kMostIterations = 40;
constexpr std::size_t kFirstIterations = 25;
constexpr std::size_t kLastIterations = 10;
// Values that differ most, of lengths and of angles each.
constexpr std::size_t kMostDifferences = 3;

std::string CostText(double cost) {
  return cost < 0.0 ? "-" : FormatSignificant(cost, 4);
}

std::size_t LongestHistory(const std::vector<SolverRun>& runs) {
  std::size_t longest = 0;
  for (const SolverRun& run : runs) {
    longest = std::max(longest, run.summary.iterations.size());
  }
  return longest;
}

bool AnyRejected(const std::vector<SolverRun>& runs) {
  return std::any_of(runs.begin(), runs.end(), [](const SolverRun& run) {
    return std::any_of(
        run.summary.iterations.begin(), run.summary.iterations.end(),
        [](const IterationRecord& record) { return !record.accepted; });
  });
}

std::vector<TableCell> IterationRow(const std::vector<SolverRun>& runs,
                                    std::size_t iteration) {
  std::vector<TableCell> row = {std::to_string(iteration)};
  for (const SolverRun& run : runs) {
    if (iteration >= run.summary.iterations.size()) {
      row.insert(row.end(), {"", ""});
      continue;
    }
    const IterationRecord& record = run.summary.iterations[iteration];
    row.emplace_back((record.accepted ? "" : "* ") +
                     FormatSignificant(record.max_error / kMillimetre, 4));
    row.push_back(NumberCell(record.cost, 4));
  }
  return row;
}

std::string IterationTable(const std::vector<SolverRun>& runs) {
  const std::size_t length = LongestHistory(runs);
  if (length == 0) return "";
  std::vector<Table::Column> columns = {">iteration"};
  for (const SolverRun& run : runs) {
    const std::string title = ShortSolverTitle(run.summary.solver);
    columns.insert(columns.end(), {">" + title + " max [mm]", ">chi-square"});
  }
  Table table(columns);
  for (std::size_t i = 0; i < length; ++i) {
    if (length > kMostIterations && i == kFirstIterations) {
      std::vector<TableCell> gap(columns.size(), "");
      gap.front() = "...";
      table.AddRow(std::move(gap));
      i = length - kLastIterations;
    }
    table.AddRow(IterationRow(runs, i));
  }
  return "\nLargest position error by iteration:\n\n" + table.ToText() +
         (AnyRejected(runs) ? "* the step was rejected\n" : "");
}

// A parameter and how far its values differ (m or rad).
struct Difference {
  const ParameterResult* parameter = nullptr;
  double value = 0.0;
};

std::vector<Difference> LargestDifferences(const CalibrationResult& result,
                                           const Eigen::VectorXd& difference,
                                           Dimension dimension) {
  std::vector<Difference> found;
  for (std::size_t i = 0; i < result.parameters.size(); ++i) {
    const double value = difference[static_cast<Eigen::Index>(i)];
    if (result.parameters[i].dimension == dimension && value != 0.0) {
      found.push_back({&result.parameters[i], value});
    }
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Difference& a, const Difference& b) {
                     return std::abs(a.value) > std::abs(b.value);
                   });
  if (found.size() > kMostDifferences) found.resize(kMostDifferences);
  return found;
}

std::string DifferenceText(const Difference& difference) {
  const bool length = difference.parameter->dimension == Dimension::kLength;
  return difference.parameter->name + " " +
         FormatSignificant(
             length ? difference.value / kMillimetre : difference.value, 2) +
         (length ? " mm" : " rad");
}

}  // namespace

std::string DifferenceSentence(const CalibrationResult& result,
                               const SolverRun& other) {
  const SolverRun& first = result.runs.front();
  const auto size = static_cast<Eigen::Index>(result.parameters.size());
  if (first.values.size() != size || other.values.size() != size) return "";
  const Eigen::VectorXd difference = other.values - first.values;
  std::vector<std::string> parts;
  for (const Dimension dimension : {Dimension::kLength, Dimension::kAngle}) {
    for (const Difference& each :
         LargestDifferences(result, difference, dimension)) {
      parts.push_back(DifferenceText(each));
    }
  }
  const std::string names = ShortSolverTitle(other.summary.solver) + " minus " +
                            ShortSolverTitle(first.summary.solver);
  if (parts.empty()) return names + ": the values are the same to the last bit";
  return names + ", largest differences: " + Join(parts, ", ");
}

Table SolverTable(const std::vector<SolverRun>& runs) {
  std::vector<Table::Column> columns = {{"solver"}};
  std::vector<std::vector<TableCell>> rows = {
      {"outcome"},        {"iterations"},        {"steps accepted"},
      {"steps rejected"}, {"chi-square before"}, {"chi-square after"},
      {"rms error [mm]"}, {"max error [mm]"},    {"evaluation"},
      {"time to set up"}, {"time to solve"}};
  for (const SolverRun& run : runs) {
    const SolverSummary& summary = run.summary;
    columns.emplace_back(">" + ShortSolverTitle(summary.solver));
    columns.back().width = kStatusWidth;
    const std::vector<TableCell> cells = {
        ToString(summary.status),
        CountCell(summary.accepted_steps + summary.rejected_steps),
        CountCell(summary.accepted_steps),
        CountCell(summary.rejected_steps),
        {CostText(summary.initial_cost), summary.initial_cost},
        {CostText(summary.final_cost), summary.final_cost},
        QuantityCell(run.train.rms, Dimension::kLength, 4),
        QuantityCell(run.train.max, Dimension::kLength, 4),
        summary.evaluation.empty() ? "Jacobian" : summary.evaluation,
        {FormatDuration(summary.setup_time_s), summary.setup_time_s},
        {FormatDuration(summary.solve_time_s), summary.solve_time_s}};
    for (std::size_t i = 0; i < rows.size(); ++i) rows[i].push_back(cells[i]);
  }
  Table table("solvers",
              runs.size() > 1 ? "The solvers, on the same data" : "The solver",
              std::move(columns));
  for (std::vector<TableCell>& row : rows) table.AddRow(std::move(row));
  return table;
}

std::string FormatComparison(const CalibrationResult& result) {
  if (result.runs.empty()) return "No solver has run.\n";
  std::string text =
      SolverTable(result.runs).ToText() + IterationTable(result.runs);
  for (std::size_t i = 1; i < result.runs.size(); ++i) {
    const std::string sentence = DifferenceSentence(result, result.runs[i]);
    if (!sentence.empty()) text += "\n" + Paragraph(sentence);
  }
  return text;
}

}  // namespace alidade::internal
