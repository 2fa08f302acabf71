#include "src/dataio/rotation_convention.h"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <utility>

#include "alidade/rotation.h"
#include "alidade/units.h"

namespace alidade::internal {
namespace {

// Of R^T R from 1, and of a quaternion's norm.
constexpr double kRounding = 1e-3;

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

double NearestTurn(double angle, double near) {
  return angle + 2.0 * kPi * std::round((near - angle) / (2.0 * kPi));
}

Eigen::Vector3d VectorNear(const Eigen::Matrix3d& rotation,
                           const Eigen::Vector3d& near) {
  Eigen::Vector3d vector = VectorFromRotation(rotation);
  const double angle = vector.norm();
  if (angle < 1e-9) return vector;
  const Eigen::Vector3d axis = vector / angle;
  return axis * NearestTurn(angle, axis.dot(near));
}

// Below this sine of the angle between the first and the third axis, angles are
// in gimbal lock.
constexpr double kLocked = 1e-9;

// The three angles from left to right, the first given where locked. In the
// axes of the sequence, R's column of the third axis is what the first two
// angles make of it; with the first one undone the other two remain.
Eigen::Vector3d AnglesFrom(const std::array<Turn, 3>& turns,
                           const Eigen::Matrix3d& rotation, double near) {
  const Eigen::Vector3d& a = turns[0].axis;
  const Eigen::Vector3d& b = turns[1].axis;
  const Eigen::Vector3d& c = turns[2].axis;
  const Eigen::Vector3d side = a.cross(b);
  const Eigen::Vector3d third = rotation * c;
  // b stays at right angles to the third axis wherever that turns.
  const double across = b.dot(third);
  const double along = side.dot(third);
  double first = near;
  if (std::hypot(across, along) > kLocked) {
    // third = Rot(a) (in the plane of a and side).
    first = std::atan2(-across, along);
  }
  const Eigen::Matrix3d rest =
      Eigen::AngleAxisd(-first, a).toRotationMatrix() * rotation;
  const Eigen::Vector3d turned = rest * c;
  const double second = std::atan2(c.cross(turned).dot(b), c.dot(turned));
  const double last = std::atan2(-(rest.transpose() * b).dot(c.cross(b)),
                                 (rest.transpose() * b).dot(b));
  return {first, second, last};
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

std::optional<Eigen::Matrix3d> RotationOfMatrix(const Eigen::Matrix3d& matrix) {
  const Eigen::Matrix3d error =
      matrix.transpose() * matrix - Eigen::Matrix3d::Identity();
  if (!(error.cwiseAbs().maxCoeff() <= kRounding &&
        matrix.determinant() > 0.0)) {
    return std::nullopt;
  }
  return Eigen::Quaterniond(matrix).normalized().toRotationMatrix();
}

std::optional<Eigen::Matrix3d> RotationOfQuaternion(
    const Eigen::Vector4d& numbers) {
  const Eigen::Quaterniond quaternion(numbers[0], numbers[1], numbers[2],
                                      numbers[3]);
  if (!(std::abs(quaternion.norm() - 1.0) <= kRounding)) return std::nullopt;
  return quaternion.normalized().toRotationMatrix();
}

Eigen::Vector3d NumbersOf(const RotationConvention& convention,
                          const Eigen::Matrix3d& rotation,
                          const Eigen::Vector3d& near) {
  if (convention.is_vector) return VectorNear(rotation, near);
  const std::array<Turn, 3> turns = TurnsOf(convention);
  const bool is_proper = convention.axes[0] == convention.axes[2];
  Eigen::Vector3d best;
  double least = std::numeric_limits<double>::infinity();
  const Eigen::Vector3d angles =
      AnglesFrom(turns, rotation, near[turns[0].number]);
  // The same rotation the other way round.
  const Eigen::Vector3d other(angles[0] + kPi,
                              is_proper ? -angles[1] : kPi - angles[1],
                              angles[2] + kPi);
  for (const Eigen::Vector3d& candidate : {angles, other}) {
    Eigen::Vector3d numbers;
    for (int i = 0; i < 3; ++i) {
      const int number = turns[i].number;
      numbers[number] = NearestTurn(candidate[i], near[number]);
    }
    const double distance = (numbers - near).norm();
    if (distance >= least) continue;
    least = distance;
    best = numbers;
  }
  return best;
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
