#ifndef ALIDADE_SRC_JOB_LOST_TARGETS_H_
#define ALIDADE_SRC_JOB_LOST_TARGETS_H_

#include <set>
#include <string>
#include <utility>
#include <vector>

#include "alidade/arm.h"
#include "alidade/dataset.h"

namespace alidade::internal {

/// Positions of a file in whose place an instrument that has lost its target
/// wrote something else.
struct LostTargets {
  /// Lines all of whose positions are so, ascending.
  std::vector<int> lines;
  /// The others: line, number of the target.
  std::set<std::pair<int, int>> positions;
  std::set<std::string> written;  ///< "-9999 mm"; empty: out of reach alone
  /// There are so many that something else is wrong: nothing is left out.
  bool are_most = false;

  bool empty() const { return lines.empty() && positions.empty(); }
  /// "the target was lost (...) and the row is left out: line 6, 10".
  std::vector<std::string> Describe(const Arm& arm) const;
};

/// Those of an arm of this reach (m): positions that have the same number three
/// times, are farther away than an arm of this size can be, or have a number
/// out of reach which stands there again and again or consists of nines.
LostTargets FindLostTargets(const Dataset& data, double reach);

/// Takes single positions out of the data.
void DropPositions(const std::set<std::pair<int, int>>& positions,
                   Dataset* data);

/// The median distance of positions from their middle (m).
double TypicalDistance(const Dataset& data);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_JOB_LOST_TARGETS_H_
