#include "alidade/references.h"

#include <cmath>

namespace alidade {
namespace {

template <typename Named>
int FindByName(const std::vector<Named>& all, const std::string& name) {
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].name == name) return static_cast<int>(i);
  }
  return -1;
}

}  // namespace

int References::FindPoint(const std::string& name) const {
  return FindByName(points, name);
}

int References::FindPlane(const std::string& name) const {
  return FindByName(planes, name);
}

void TangentBasis(const Eigen::Vector3d& normal, Eigen::Vector3d* t1,
                  Eigen::Vector3d* t2) {
  const double sign = std::copysign(1.0, normal.z());
  const double a = -1.0 / (sign + normal.z());
  const double b = normal.x() * normal.y() * a;
  *t1 << 1.0 + sign * normal.x() * normal.x() * a, sign * b, -sign * normal.x();
  *t2 << b, sign + normal.y() * normal.y() * a, -normal.y();
}

}  // namespace alidade
