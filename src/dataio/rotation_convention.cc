#include "src/dataio/rotation_convention.h"

#include <Eigen/Geometry>
#include <utility>

#include "alidade/rotation.h"

namespace alidade::internal {
namespace {

constexpr char kVectorName[] = "rotation_vector";

std::string NameOf(const RotationConvention& convention) {
  if (convention.is_vector) return kVectorName;
  std::string name = convention.is_intrinsic ? "intrinsic_" : "extrinsic_";
  for (const int axis : convention.axes) name += "xyz"[axis];
  return name;
}

// The common ones first: lists in messages are cut.
std::vector<RotationConvention> AllConventions() {
  std::vector<RotationConvention> conventions;
  RotationConvention vector;
  vector.is_vector = true;
  conventions.push_back(vector);
  for (const bool is_proper : {false, true}) {
    for (const bool is_intrinsic : {true, false}) {
      for (int a = 0; a < 3; ++a) {
        for (int step = 1; step < 3; ++step) {
          const int b = (a + step) % 3;
          const int c = is_proper ? a : (a + 2 * step) % 3;
          conventions.push_back({false, is_intrinsic, {a, b, c}});
        }
      }
    }
  }
  return conventions;
}

// The turn that one of the numbers stands for.
struct Turn {
  int number;
  Eigen::Vector3d axis;
};

// The factors of R from left to right.
std::array<Turn, 3> TurnsOf(const RotationConvention& convention) {
  const std::array<int, 3>& axes = convention.axes;
  const bool is_proper = axes[0] == axes[2];
  std::array<Turn, 3> turns;
  for (int i = 0; i < 3; ++i) {
    turns[i] = {is_proper ? i : axes[i], Eigen::Vector3d::Unit(axes[i])};
  }
  if (!convention.is_intrinsic) std::swap(turns[0], turns[2]);
  return turns;
}

}  // namespace

const std::vector<std::string>& RotationConventionNames() {
  static const auto* const names = [] {
    auto* all = new std::vector<std::string>;
    for (const RotationConvention& convention : AllConventions()) {
      all->push_back(NameOf(convention));
    }
    return all;
  }();
  return *names;
}

std::optional<RotationConvention> FindRotationConvention(
    std::string_view name) {
  for (const RotationConvention& convention : AllConventions()) {
    if (NameOf(convention) == name) return convention;
  }
  return std::nullopt;
}

Eigen::Matrix3d RotationOf(const RotationConvention& convention,
                           const Eigen::Vector3d& numbers) {
  if (convention.is_vector) return RotationFromVector<double>(numbers);
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  for (const auto& [number, axis] : TurnsOf(convention)) {
    rotation *= Eigen::AngleAxisd(numbers[number], axis).toRotationMatrix();
  }
  return rotation;
}

Eigen::Matrix3d TurningAxes(const RotationConvention& convention,
                            const Eigen::Vector3d& numbers) {
  if (convention.is_vector) return LeftJacobianOfRotation(numbers);
  Eigen::Matrix3d axes;
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  for (const auto& [number, axis] : TurnsOf(convention)) {
    axes.col(number) = rotation * axis;
    rotation *= Eigen::AngleAxisd(numbers[number], axis).toRotationMatrix();
  }
  return axes;
}

}  // namespace alidade::internal
