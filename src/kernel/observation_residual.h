#ifndef ALIDADE_SRC_KERNEL_OBSERVATION_RESIDUAL_H_
#define ALIDADE_SRC_KERNEL_OBSERVATION_RESIDUAL_H_

#include <Eigen/Core>
#include <cmath>

#include "alidade/dataset.h"
#include "alidade/forward_kinematics.h"
#include "alidade/references.h"
#include "alidade/rotation.h"
#include "src/data/tilted_normal.h"
#include "src/kernel/measurement_model.h"

namespace alidade::internal {

/// Parameters of what an observation is measured against: x y z of points, u v
/// c of a plane; null where the kind has none.
template <typename T>
struct ReferenceView {
  const T* first = nullptr;
  const T* second = nullptr;
};

/// The residual of one observation as dataset.h defines it, not whitened, for
/// any scalar: the one definition that evaluation and autodiff share. Holds
/// pointers only; model and data outlive it.
class ObservationResidual {
 public:
  ObservationResidual(const MeasurementModel& model, const Dataset& data,
                      const ObservationBlock& block, Eigen::Index i)
      : model_(&model), data_(&data), block_(&block), i_(i) {}

  /// The reference parameters among all values of the layout.
  ReferenceView<double> ReferencesIn(const Eigen::VectorXd& values) const {
    ReferenceView<double> view;
    if (const int first = FirstReferenceColumn(); first >= 0) {
      view.first = &values[first];
    }
    if (block_->kind == MeasurementKind::kPointDistance) {
      view.second = &values[model_->layout().Column(ParameterKind::kPoint, 0,
                                                    block_->seconds[i_])];
    }
    return view;
  }

  /// First column of the point or plane, or -1.
  int FirstReferenceColumn() const {
    switch (block_->kind) {
      case MeasurementKind::kDistance:
      case MeasurementKind::kFixedPoint:
      case MeasurementKind::kPointDistance:
        return model_->layout().Column(ParameterKind::kPoint, 0,
                                       block_->references[i_]);
      case MeasurementKind::kPlane:
        return model_->layout().Column(ParameterKind::kPlaneTilt, 0,
                                       block_->references[i_]);
      default:
        return -1;
    }
  }

  template <typename T>
  void Evaluate(const GeometryView<T>& geometry,
                const ReferenceView<T>& references, T* residual) const {
    switch (block_->kind) {
      case MeasurementKind::kPosition:
        Store<T>(Position(geometry, block_->pose(i_)) - Measured<T>(),
                 residual);
        break;
      case MeasurementKind::kPose:
        EvaluatePose(geometry, residual);
        break;
      case MeasurementKind::kFixedPoint:
        Store<T>(
            Position(geometry, block_->pose(i_)) - PointAt(references.first),
            residual);
        break;
      case MeasurementKind::kDifference:
        Store<T>(Position(geometry, block_->pose(i_)) -
                     Position(geometry, block_->seconds[i_]) - Measured<T>(),
                 residual);
        break;
      case MeasurementKind::kDistance:
        *residual = Length<T>(Position(geometry, block_->pose(i_)) -
                              PointAt(references.first)) -
                    block_->measured(0, i_);
        break;
      case MeasurementKind::kPointDistance:
        *residual =
            Length<T>(PointAt(references.first) - PointAt(references.second)) -
            block_->measured(0, i_);
        break;
      case MeasurementKind::kPlane:
        *residual =
            TiltedNormal<T>(
                model_->references().planes[block_->references[i_]].normal,
                references.first)
                .dot(Position(geometry, block_->pose(i_))) -
            references.first[2];
        break;
    }
  }

 private:
  template <typename T>
  static Vector3<T> PointAt(const T* coordinates) {
    return Eigen::Map<const Vector3<T>>(coordinates);
  }

  template <typename T>
  static void Store(const Vector3<T>& value, T* residual) {
    Eigen::Map<Vector3<T>>{residual} = value;
  }

  // Of length zero, where the derivative is not defined, that of a constant.
  template <typename T>
  static T Length(const Vector3<T>& difference) {
    using std::sqrt;
    const T squared = difference.squaredNorm();
    return squared > T(0.0) ? sqrt(squared) : T(0.0);
  }

  template <typename T>
  Vector3<T> Measured() const {
    return block_->measured.col(i_).template head<3>().template cast<T>();
  }

  const double* JointValues(int pose) const {
    return data_->joint_values.col(pose).data();
  }

  template <typename T>
  Vector3<T> Position(const GeometryView<T>& geometry, int pose) const {
    return TargetPosition(model_->nominal(), geometry, JointValues(pose),
                          CovariatesAt(*data_, model_->nominal(), pose).data());
  }

  template <typename T>
  void EvaluatePose(const GeometryView<T>& geometry, T* residual) const {
    Eigen::Matrix<T, 3, 3> rotation;
    const Vector3<T> position = TargetPose(
        model_->nominal(), geometry, JointValues(block_->pose(i_)), &rotation,
        CovariatesAt(*data_, model_->nominal(), block_->pose(i_)).data());
    Store<T>(position - Measured<T>(), residual);
    const Eigen::Vector3d measured = block_->measured.col(i_).tail<3>();
    const Eigen::Matrix3d back = RotationFromVector<double>(-measured);
    const Eigen::Matrix<T, 3, 3> turn = rotation * back.cast<T>();
    Store<T>(VectorFromRotation<T>(turn), residual + 3);
  }

  const MeasurementModel* model_;
  const Dataset* data_;
  const ObservationBlock* block_;
  Eigen::Index i_;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_KERNEL_OBSERVATION_RESIDUAL_H_
