#include "alidade/identifiability_result.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace alidade {

double RankReport::SmallestCounted() const {
  return rank > 0 ? singular_values[rank - 1] : 1.0;
}

double RankReport::MiddleOfGap() const {
  double below = std::numeric_limits<double>::epsilon();
  if (rank < singular_values.size()) {
    below = std::max(below, singular_values[rank]);
  }
  return std::sqrt(SmallestCounted() * below);
}

const char* ToString(ParameterState state) {
  switch (state) {
    case ParameterState::kFree:
      return "free";
    case ParameterState::kFrozen:
      return "frozen";
    case ParameterState::kGiven:
      return "given";
  }
  return "unknown";
}

}  // namespace alidade
