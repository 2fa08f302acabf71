#include "src/job/lost_targets.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "src/common/constants.h"
#include "src/common/format.h"
#include "src/common/names.h"
#include "src/common/number_text.h"
#include "src/common/numbers.h"

namespace alidade::internal {
namespace {

template <typename Use>
void ForEachPosition(const Dataset& data, const Use& use) {
  for (const ObservationBlock& block : data.blocks) {
    if (!HoldsPosition(block.kind)) continue;
    for (Eigen::Index i = 0; i < block.size(); ++i) {
      use(Eigen::Vector3d(block.measured.map().col(i).head<3>()),
          data.sources[block.pose(i)].line);
    }
  }
}

Eigen::Vector3d MedianOf(const Dataset& data) {
  Eigen::Vector3d median = Eigen::Vector3d::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    ForEachPosition(data, [&](const Eigen::Vector3d& point, int /*line*/) {
      values.push_back(point[axis]);
    });
    if (values.empty()) continue;
    const auto middle =
        values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    median[axis] = *middle;
  }
  return median;
}

// As it may have been written: to nine digits.
double InMillimetres(double metres) {
  constexpr int kDigits = 9;
  return NumberOrNan(FormatSignificant(metres / kMillimetre, kDigits));
}

// 999, -9999.9, in mm or m.
bool IsOfNines(double metres) {
  std::string digits = ShortestNumber(std::abs(InMillimetres(metres)));
  digits.erase(std::remove(digits.begin(), digits.end(), '.'), digits.end());
  digits.erase(digits.find_last_not_of('0') + 1);
  return digits.size() > 2 &&
         digits.find_first_not_of('9') == std::string::npos;
}

// Coordinates that stand for none: out of reach, and there again and again or
// of nines alone.
std::set<double> SentinelsOf(const Dataset& data, const Eigen::Vector3d& middle,
                             double reach) {
  constexpr double kOutOfReach = 2.5;  // reaches
  constexpr int kOften = 3;
  const double limit = kOutOfReach * reach;
  std::map<double, int> counts;
  ForEachPosition(data, [&](const Eigen::Vector3d& point, int /*line*/) {
    for (int axis = 0; axis < 3; ++axis) {
      if (std::abs(point[axis] - middle[axis]) > limit) ++counts[point[axis]];
    }
  });
  std::set<double> sentinels;
  for (const auto& [value, count] : counts) {
    if (count >= kOften || IsOfNines(value)) sentinels.insert(value);
  }
  return sentinels;
}

}  // namespace

std::string LostTargets::Describe() const {
  std::vector<std::string> names;
  for (const int line : lines) names.push_back(std::to_string(line));
  return "the target was lost (" +
         (written.empty() ? "out of reach"
                          : JoinNames({written.begin(), written.end()}) +
                                " in place of a position, or out of reach") +
         ") and the row is left out: line " + JoinNames(names);
}

LostTargets FindLostTargets(const Dataset& data, double reach) {
  constexpr double kFar = 20.0;  // reaches
  const double far = kFar * reach;
  const Eigen::Vector3d middle = MedianOf(data);
  const std::set<double> sentinels = SentinelsOf(data, middle, reach);
  std::set<int> lines;
  LostTargets lost;
  ForEachPosition(data, [&](const Eigen::Vector3d& point, int line) {
    const bool is_one = point[0] == point[1] && point[1] == point[2];
    const auto sentinel =
        std::find_if(point.begin(), point.end(),
                     [&](double x) { return sentinels.count(x) > 0; });
    const bool has_sentinel = sentinel != point.end();
    if (!is_one && !has_sentinel && (point - middle).norm() < far) return;
    lines.insert(line);
    if (is_one || has_sentinel) {
      lost.written.insert(
          ShortestNumber(InMillimetres(is_one ? point[0] : *sentinel)) + " mm");
    }
  });
  if (2 * lines.size() > data.sources.size()) return {};
  lost.lines.assign(lines.begin(), lines.end());
  return lost;
}

double TypicalDistance(const Dataset& data) {
  const Eigen::Vector3d middle = MedianOf(data);
  std::vector<double> distances;
  ForEachPosition(data, [&](const Eigen::Vector3d& point, int /*line*/) {
    distances.push_back((point - middle).norm());
  });
  if (distances.empty()) return 0.0;
  const auto half =
      distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), half, distances.end());
  return *half;
}

}  // namespace alidade::internal
