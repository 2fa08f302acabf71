#include "src/job/lost_targets.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

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
          data.sources[block.pose(i)].line, block.target(i));
    }
  }
}

Eigen::Vector3d MedianOf(const Dataset& data) {
  Eigen::Vector3d median = Eigen::Vector3d::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    ForEachPosition(
        data, [&](const Eigen::Vector3d& point, int /*line*/, int /*target*/) {
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

// Coordinates that mean none: out of reach, and there again and again or
// of nines alone.
std::set<double> SentinelsOf(const Dataset& data, const Eigen::Vector3d& middle,
                             double reach) {
  constexpr double kOutOfReach = 2.5;  // reaches
  constexpr int kOften = 3;
  const double limit = kOutOfReach * reach;
  std::map<double, int> counts;
  ForEachPosition(
      data, [&](const Eigen::Vector3d& point, int /*line*/, int /*target*/) {
        for (int axis = 0; axis < 3; ++axis) {
          if (std::abs(point[axis] - middle[axis]) > limit) {
            ++counts[point[axis]];
          }
        }
      });
  std::set<double> sentinels;
  for (const auto& [value, count] : counts) {
    if (count >= kOften || IsOfNines(value)) sentinels.insert(value);
  }
  return sentinels;
}

}  // namespace

std::vector<std::string> LostTargets::Describe(const Arm& arm) const {
  const std::string how = written.empty()
                              ? "out of reach"
                              : JoinNames({written.begin(), written.end()}) +
                                    " in place of a position, or out of reach";
  if (are_most) {
    return {
        "more than half of the positions look as where the target was "
        "lost (" +
        how +
        "): they are read as they stand, and --exclude leaves rows out; "
        "where they are right, the arm is of another size"};
  }
  std::vector<std::string> notes;
  const auto add = [&](const std::string& begin, const std::string& what,
                       const std::vector<std::string>& numbers) {
    if (numbers.empty()) return;
    notes.push_back(begin + " was lost (" + how + ") and " + what +
                    " is left out: line " + JoinNames(numbers));
  };
  std::vector<std::string> numbers;
  for (const int line : lines) numbers.push_back(std::to_string(line));
  add("the target", "the row", numbers);
  for (int target = 0; target < arm.num_targets(); ++target) {
    numbers.clear();
    for (const auto& [line, of] : positions) {
      if (of == target) numbers.push_back(std::to_string(line));
    }
    add("target " + arm.targets[static_cast<std::size_t>(target)].name,
        "its position", numbers);
  }
  return notes;
}

LostTargets FindLostTargets(const Dataset& data, double reach) {
  constexpr double kFar = 20.0;  // reaches
  const double far = kFar * reach;
  const Eigen::Vector3d middle = MedianOf(data);
  const std::set<double> sentinels = SentinelsOf(data, middle, reach);
  std::map<int, int> num_seen;  // by line
  LostTargets lost;
  std::size_t num_all = 0;
  ForEachPosition(data, [&](const Eigen::Vector3d& point, int line,
                            int target) {
    ++num_all;
    const bool is_one = point[0] == point[1] && point[1] == point[2];
    const auto sentinel =
        std::find_if(point.begin(), point.end(),
                     [&](double x) { return sentinels.count(x) > 0; });
    const bool has_sentinel = sentinel != point.end();
    if (!is_one && !has_sentinel && (point - middle).norm() < far) {
      ++num_seen[line];
      return;
    }
    lost.positions.emplace(line, target);
    if (is_one || has_sentinel) {
      lost.written.insert(
          ShortestNumber(InMillimetres(is_one ? point[0] : *sentinel)) + " mm");
    }
  });
  if (2 * lost.positions.size() > num_all) {
    lost.positions.clear();
    lost.are_most = true;
    return lost;
  }
  for (auto at = lost.positions.begin(); at != lost.positions.end();) {
    const int line = at->first;
    if (num_seen.count(line) > 0) {
      ++at;
      continue;
    }
    if (lost.lines.empty() || lost.lines.back() != line) {
      lost.lines.push_back(line);
    }
    at = lost.positions.erase(at);
  }
  return lost;
}

void DropPositions(const std::set<std::pair<int, int>>& positions,
                   Dataset* data) {
  if (positions.empty()) return;
  for (ObservationBlock& block : data->blocks) {
    if (!HoldsPosition(block.kind)) continue;
    std::vector<Eigen::Index> kept;
    for (Eigen::Index i = 0; i < block.size(); ++i) {
      const int line = data->sources[block.pose(i)].line;
      if (positions.count({line, block.target(i)}) == 0) kept.push_back(i);
    }
    ObservationBlock rest;
    rest.kind = block.kind;
    for (const Eigen::Index i : kept) {
      rest.poses.push_back(block.pose(i));
      rest.targets.push_back(block.target(i));
      if (!block.references.empty()) {
        rest.references.push_back(block.references[i]);
      }
      if (!block.whiteners.empty()) {
        rest.whiteners.push_back(block.whiteners[i]);
      }
    }
    rest.measured = Eigen::MatrixXd(block.measured.map()(Eigen::all, kept));
    rest.sigmas = Eigen::MatrixXd(block.sigmas.map()(Eigen::all, kept));
    block = std::move(rest);
  }
}

double TypicalDistance(const Dataset& data) {
  const Eigen::Vector3d middle = MedianOf(data);
  std::vector<double> distances;
  ForEachPosition(
      data, [&](const Eigen::Vector3d& point, int /*line*/, int /*target*/) {
        distances.push_back((point - middle).norm());
      });
  if (distances.empty()) return 0.0;
  const auto half =
      distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), half, distances.end());
  return *half;
}

}  // namespace alidade::internal
