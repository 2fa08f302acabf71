#include "alidade/stated_poses.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "alidade/error.h"
#include "alidade/rotation.h"
#include "src/common/names.h"
#include "src/common/text.h"
#include "src/dataio/covariance.h"
#include "src/dataio/inverse_pose.h"
#include "src/dataio/rotation_convention.h"

namespace alidade {
namespace internal {
namespace {

[[noreturn]] void Fail(const char* key, const std::string& message) {
  throw InputError({"", 0, 0, key}, message);
}

[[noreturn]] void FailAt(Eigen::Index i, const char* key,
                         const std::string& message) {
  Fail(key, "measurement " + std::to_string(i) + ": " + message);
}

std::string SizeText(Eigen::Index rows, Eigen::Index cols) {
  return std::to_string(rows) + " x " + std::to_string(cols);
}

void RequireSize(const Eigen::MatrixXd& matrix, const char* key,
                 Eigen::Index rows, Eigen::Index cols) {
  if (matrix.rows() == rows && (matrix.cols() == cols || matrix.cols() == 1)) {
    return;
  }
  Fail(key, "found " + SizeText(matrix.rows(), matrix.cols()) + ", expected " +
                SizeText(rows, cols) + " or " + SizeText(rows, 1));
}

void RequireFinite(const Eigen::MatrixXd& matrix, const char* key) {
  for (Eigen::Index i = 0; i < matrix.cols(); ++i) {
    if (matrix.col(i).allFinite()) continue;
    FailAt(i, key, "expected finite numbers");
  }
}

void RequirePositive(const Eigen::MatrixXd& matrix, const char* key) {
  if ((matrix.array() > 0.0).all()) return;
  Fail(key, "expected standard deviations above 0");
}

// Column i, or the only one.
auto ColumnOf(const Eigen::MatrixXd& matrix, Eigen::Index i) {
  return matrix.col(matrix.cols() == 1 ? 0 : i);
}

class ObservationMaker {
 public:
  explicit ObservationMaker(const StatedPoses& stated)
      : stated_(stated),
        size_(stated.positions.cols()),
        has_orientations_(stated.orientations.size() > 0) {
    RequireSize(stated.positions, "positions", 3, size_);
    RequireFinite(stated.positions, "positions");
    if (has_orientations_) CheckOrientations();
    CheckNoise();
  }

  ObservationBlock Make() const {
    ObservationBlock block;
    block.kind =
        has_orientations_ ? MeasurementKind::kPose : MeasurementKind::kPosition;
    const Eigen::Index rows = RowsOf(block.kind);
    MatrixBuilder measured(rows, size_), sigmas(rows, size_);
    block.whiteners.resize(static_cast<std::size_t>(size_));
    for (Eigen::Index i = 0; i < size_; ++i) {
      StatedObservation one = Observe(i);
      for (Eigen::Index k = 0; k < rows; ++k) {
        measured.map()(k, i) = one.measured[static_cast<std::size_t>(k)];
        sigmas.map()(k, i) = one.sigmas[static_cast<std::size_t>(k)];
      }
      block.whiteners[static_cast<std::size_t>(i)] = std::move(one.whitener);
    }
    block.measured = measured.Freeze();
    block.sigmas = sigmas.Freeze();
    if (std::all_of(block.whiteners.begin(), block.whiteners.end(),
                    [](const auto& one) { return one.size() == 0; })) {
      block.whiteners.clear();
    }
    return block;
  }

 private:
  void CheckOrientations() {
    const std::string& name = stated_.convention;
    if (name == "matrix" || name == "quaternion") {
      numbers_ = name == "matrix" ? 9 : 4;
    } else {
      convention_ = FindRotationConvention(name);
      if (!convention_) {
        std::vector<std::string> names = RotationConventionNames();
        names.insert(names.begin(), {"matrix", "quaternion"});
        Fail("convention", UnknownName("convention of rotations", name, names));
      }
    }
    const Eigen::MatrixXd& orientations = stated_.orientations;
    if (orientations.rows() != numbers_ || orientations.cols() != size_) {
      Fail("orientations",
           "found " + SizeText(orientations.rows(), orientations.cols()) +
               ", expected " + SizeText(numbers_, size_) + " of \"" + name +
               "\"");
    }
    RequireFinite(orientations, "orientations");
  }

  void CheckNoise() {
    if (stated_.covariances.size() > 0) {
      const bool is_whole = stated_.covariances.rows() == 36;
      RequireSize(stated_.covariances, "covariances",
                  is_whole && has_orientations_ ? 36 : 9, size_);
      has_turns_in_covariance_ = is_whole;
    } else {
      RequireSize(stated_.sigmas, "sigmas", 3, size_);
      RequirePositive(stated_.sigmas, "sigmas");
    }
    if (!has_orientations_) {
      if (stated_.is_inverse) {
        Fail("is_inverse", "expected orientations beside the positions");
      }
      return;
    }
    has_angle_sigmas_ = stated_.angle_sigmas.size() > 0;
    if (has_turns_in_covariance_) {
      if (has_angle_sigmas_) {
        Fail("angle_sigmas",
             "found beside covariances of positions and turns, expected one "
             "of both");
      }
      return;
    }
    if (has_angle_sigmas_ && (!convention_ || convention_->is_vector)) {
      Fail("angle_sigmas",
           "found with the convention \"" + stated_.convention +
               "\", expected Euler angles: rotation_sigmas are about the "
               "instrument's axes");
    }
    const char* key = has_angle_sigmas_ ? "angle_sigmas" : "rotation_sigmas";
    const Eigen::MatrixXd& sigmas =
        has_angle_sigmas_ ? stated_.angle_sigmas : stated_.rotation_sigmas;
    RequireSize(sigmas, key, 3, size_);
    RequirePositive(sigmas, key);
  }

  StatedObservation Observe(Eigen::Index i) const {
    StatedObservation one;
    std::copy_n(stated_.positions.col(i).data(), 3, one.measured.begin());
    if (has_orientations_) {
      const Eigen::Vector3d vector = VectorFromRotation(RotationAt(i));
      std::copy_n(vector.data(), 3, one.measured.begin() + 3);
    }
    const Noise noise = NoiseAt(i);
    std::copy_n(noise.sigmas.data(), noise.sigmas.size(), one.sigmas.begin());
    one.whitener = noise.whitener;
    if (stated_.is_inverse && !InvertPose(&one)) {
      FailAt(i, "sigmas",
             "inverse poses need position and orientation whole, expected "
             "finite standard deviations");
    }
    return one;
  }

  Eigen::Matrix3d RotationAt(Eigen::Index i) const {
    const auto numbers = stated_.orientations.col(i);
    if (convention_) return RotationOf(*convention_, numbers.head<3>());
    const bool is_matrix = numbers_ == 9;
    const std::optional<Eigen::Matrix3d> rotation =
        is_matrix ? RotationOfMatrix(
                        Eigen::Map<
                            const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(
                            numbers.data()))
                  : RotationOfQuaternion(numbers.head<4>());
    if (!rotation) {
      FailAt(i, "orientations",
             is_matrix
                 ? "expected a rotation matrix: rows of unit vectors at right "
                   "angles, right-handed"
                 : "the quaternion's norm is " +
                       ShortestNumber(numbers.norm()) +
                       ", expected w, x, y, z of norm 1");
    }
    return *rotation;
  }

  Noise NoiseAt(Eigen::Index i) const {
    Noise position;
    if (stated_.covariances.size() > 0) {
      position = NoiseOfCovariance(i);
      if (has_turns_in_covariance_) return position;
    } else {
      position = IndependentNoise(ColumnOf(stated_.sigmas, i));
    }
    if (!has_orientations_) return position;
    return StackNoise(position, TurnNoise(i));
  }

  Noise NoiseOfCovariance(Eigen::Index i) const {
    const Eigen::VectorXd numbers = ColumnOf(stated_.covariances, i);
    const Eigen::Index rows = has_turns_in_covariance_ ? 6 : 3;
    Eigen::MatrixXd covariance =
        Eigen::Map<const Eigen::MatrixXd>(numbers.data(), rows, rows);
    std::vector<bool> is_measured;
    for (Eigen::Index k = 0; k < rows; ++k) {
      is_measured.push_back(covariance(k, k) !=
                            std::numeric_limits<double>::infinity());
    }
    const double largest = covariance.diagonal().cwiseAbs().maxCoeff();
    if ((covariance - covariance.transpose()).cwiseAbs().maxCoeff() >
        1e-9 * largest) {
      FailAt(i, "covariances", "expected symmetric matrices");
    }
    const std::optional<Noise> noise = CorrelatedNoise(covariance, is_measured);
    if (!noise) {
      FailAt(i, "covariances",
             "is not positive definite, expected variances above zero and "
             "correlations between -1 and 1");
    }
    return *noise;
  }

  Noise TurnNoise(Eigen::Index i) const {
    if (!has_angle_sigmas_) {
      return IndependentNoise(ColumnOf(stated_.rotation_sigmas, i));
    }
    const Eigen::Vector3d sigmas = ColumnOf(stated_.angle_sigmas, i);
    const Eigen::Matrix3d turns =
        TurningAxes(*convention_, stated_.orientations.col(i).head<3>()) *
        sigmas.asDiagonal();
    const std::optional<Noise> noise =
        CorrelatedNoise(turns * turns.transpose(), {true, true, true});
    if (!noise) {
      FailAt(i, "angle_sigmas",
             "the angles are in gimbal lock, where they leave a direction "
             "without noise, expected rotation_sigmas instead");
    }
    return *noise;
  }

  const StatedPoses& stated_;
  const Eigen::Index size_;
  const bool has_orientations_;
  std::optional<RotationConvention> convention_;
  Eigen::Index numbers_ = 3;
  bool has_turns_in_covariance_ = false;
  bool has_angle_sigmas_ = false;
};

}  // namespace
}  // namespace internal

ObservationBlock MakeObservations(const StatedPoses& stated) {
  return internal::ObservationMaker(stated).Make();
}

}  // namespace alidade
