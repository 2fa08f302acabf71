#ifndef ALIDADE_SRC_JOB_LOST_TARGETS_H_
#define ALIDADE_SRC_JOB_LOST_TARGETS_H_

#include <set>
#include <string>
#include <vector>

#include "alidade/dataset.h"

namespace alidade::internal {

/// Rows of a file in which an instrument that has lost its target wrote
/// something else than a position.
struct LostTargets {
  std::vector<int> lines;         ///< ascending
  std::set<std::string> written;  ///< "-9999 mm"; empty: out of reach alone

  /// "the target was lost (...) and the row is left out: line 6, 10".
  std::string Describe() const;
};

/// Those of an arm of this reach (m): positions that have the same number three
/// times, are farther away than an arm of this size can be, or have a number
/// out of reach which stands there again and again or consists of nines. None
/// where they would be most of all rows: something else is wrong then.
LostTargets FindLostTargets(const Dataset& data, double reach);

/// The median distance of positions from their middle (m).
double TypicalDistance(const Dataset& data);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_JOB_LOST_TARGETS_H_
