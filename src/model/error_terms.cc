#include "alidade/error_terms.h"

#include <algorithm>
#include <cmath>

namespace alidade {
namespace {

// The place of a joint value among the knots, and its share of the way to the
// next one; before the first knot -1, behind the last one the number of knots
// - 1.
struct Place {
  Eigen::Index knot;
  double share;
};

Place PlaceOf(const JointFunction& function, double joint_value) {
  const auto count = static_cast<double>(function.values.size());
  double place = (joint_value - function.first) / function.spacing;
  if (function.is_periodic) {
    // Of a tiny negative place rounding makes a whole turn.
    place -= count * std::floor(place / count);
    if (!(place < count)) place = 0.0;
  }
  const double knot = std::floor(std::clamp(place, -2.0, count + 1.0));
  return {static_cast<Eigen::Index>(knot), place - knot};
}

double Interpolate(const JointFunction& function, const Eigen::VectorXd& at,
                   double joint_value) {
  const auto [knot, share] = PlaceOf(function, joint_value);
  const auto value = [&](Eigen::Index k) {
    return k >= 0 && k < at.size() ? at[k] : 0.0;
  };
  const double below = value(knot);
  const double above =
      value(function.is_periodic && knot + 1 == at.size() ? 0 : knot + 1);
  if (below == 0.0 && above == 0.0) return 0.0;
  return (1.0 - share) * below + share * above;
}

}  // namespace

double JointFunction::At(double joint_value) const {
  return empty() ? 0.0 : Interpolate(*this, values, joint_value);
}

double JointFunction::DeviationAt(double joint_value) const {
  return deviations.size() == 0 ? 0.0
                                : Interpolate(*this, deviations, joint_value);
}

double SmoothSign(double moment) {
  return moment / std::hypot(moment, kBacklashMoment);
}

}  // namespace alidade
