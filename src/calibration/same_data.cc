#include "src/calibration/same_data.h"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <string_view>

namespace alidade::internal {
namespace {

constexpr Eigen::Index kMostCompared = 1000000;

// Coarse decimals make some repeated measurements alike; a copy makes half of
// all.
constexpr double kManyOfAll = 0.2;

using Prints = std::vector<std::size_t>;

void Append(const Eigen::Ref<const Eigen::VectorXd>& values,
            std::string* bytes) {
  for (const double value : values) {
    const double positive = value + 0.0;  // -0 is 0
    bytes->append(reinterpret_cast<const char*>(&positive), sizeof(positive));
  }
}

// A number of each observation of a position, in ascending order. Others
// (contacts, distances) may well agree.
Prints PrintsOf(const Dataset& data) {
  Prints prints;
  for (const ObservationBlock& block : data.blocks) {
    if (!HoldsPosition(block.kind)) continue;
    for (Eigen::Index i = 0; i < block.size(); ++i) {
      std::string bytes = std::to_string(block.target(i));
      Append(data.joint_values.col(block.pose(i)), &bytes);
      Append(block.measured.col(i), &bytes);
      prints.push_back(std::hash<std::string_view>()(bytes));
    }
  }
  std::sort(prints.begin(), prints.end());
  return prints;
}

bool IsTooLarge(const Dataset& data) {
  return data.partition.has_value() || data.num_observations() > kMostCompared;
}

// Of `count` of `all` measurements, where that is more than `threshold` of all.
void AddFinding(const std::string& key, std::size_t count, std::size_t all,
                double threshold, const std::string& text,
                std::vector<Finding>* findings) {
  const double fraction = static_cast<double>(count) / static_cast<double>(all);
  if (!(fraction > threshold)) return;
  findings->push_back(
      {"plausibility." + key, fraction, threshold,
       std::to_string(count) + " of " + std::to_string(all) + text,
       FindingLevel::kAttention});
}

}  // namespace

std::vector<Finding> DiagnoseSameData(const CalibrationTask& task) {
  std::vector<Finding> findings;
  if (IsTooLarge(task.data.training)) return findings;
  const Prints fitted = PrintsOf(task.data.training);
  Prints distinct = fitted;
  distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
  const std::size_t repeated = fitted.size() - distinct.size();
  AddFinding(
      "repeated_data", repeated, fitted.size(), kManyOfAll,
      " measurements are in the data before, joint values and measured "
      "values to the last digit: is a file there twice, or a copy of it? "
      "They count as independent, so that standard deviations are too small",
      &findings);
  if (!task.data.validation || IsTooLarge(*task.data.validation)) {
    return findings;
  }
  const Prints validation = PrintsOf(*task.data.validation);
  const auto is_fitted = [&](std::size_t print) {
    return std::binary_search(distinct.begin(), distinct.end(), print);
  };
  const auto shared = static_cast<std::size_t>(
      std::count_if(validation.begin(), validation.end(), is_fitted));
  AddFinding(
      "validation_data", shared, validation.size(), 0.0,
      " validation measurements are those that the fit has used, to the "
      "last digit: their errors say nothing of other poses. Validate with "
      "data that are not in `data`",
      &findings);
  return findings;
}

}  // namespace alidade::internal
