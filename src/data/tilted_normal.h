#ifndef ALIDADE_SRC_DATA_TILTED_NORMAL_H_
#define ALIDADE_SRC_DATA_TILTED_NORMAL_H_

#include <Eigen/Core>
#include <cmath>

#include "alidade/forward_kinematics.h"
#include "alidade/references.h"

namespace alidade::internal {

/// The normal of a plane tilted by u and v (references.h).
template <typename T>
Vector3<T> TiltedNormal(const Eigen::Vector3d& nominal, const T* tilt) {
  using std::sqrt;
  Eigen::Vector3d t1;
  Eigen::Vector3d t2;
  TangentBasis(nominal, &t1, &t2);
  // Kinds without a plane, whose `tilt` would be null, do not come here.
  // NOLINTNEXTLINE(clang-analyzer-core.NonNullParamChecker)
  const Vector3<T> n =
      nominal.cast<T>() + t1.cast<T>() * tilt[0] + t2.cast<T>() * tilt[1];
  return n / sqrt(T(1.0) + tilt[0] * tilt[0] + tilt[1] * tilt[1]);
}

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATA_TILTED_NORMAL_H_
