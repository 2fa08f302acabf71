#include "src/planning/pose_rows.h"

#include <limits>

#include "alidade/forward_kinematics.h"
#include "alidade/rotation.h"
#include "src/identifiability/factor.h"

namespace alidade::internal {

Dataset MakePlannedData(const MeasurementModel& model,
                        const Eigen::MatrixXd& joint_values,
                        const PoseMeasurement& measurement) {
  const auto num_targets =
      static_cast<Eigen::Index>(measurement.targets.size());
  ObservationBlock block;
  block.kind = measurement.orientation ? MeasurementKind::kPose
                                       : MeasurementKind::kPosition;
  const Eigen::Index count = joint_values.cols() * num_targets;
  Eigen::MatrixXd measured(block.rows_each(), count);
  Eigen::VectorXd sigmas =
      Eigen::VectorXd::Constant(block.rows_each(), measurement.rotation_sigma);
  for (int axis = 0; axis < 3; ++axis) {
    sigmas[axis] = measurement.axes[axis]
                       ? measurement.sigma
                       : std::numeric_limits<double>::infinity();
  }
  block.sigmas = SharedMatrix::Repeated(sigmas, count);
  const Eigen::VectorXd values = model.NominalValues();
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto pose = static_cast<int>(i / num_targets);
    const int target = measurement.targets[i % num_targets];
    block.poses.push_back(pose);
    block.targets.push_back(target);
    Eigen::Matrix3d rotation;
    measured.col(i).head<3>() = TargetPose<double>(
        model.nominal(), ViewOf(model.layout(), values.data(), target),
        joint_values.col(pose).data(), &rotation);
    if (measurement.orientation) {
      measured.col(i).tail<3>() = VectorFromRotation(rotation);
    }
  }
  block.measured = std::move(measured);
  Dataset data;
  data.name = "planned poses";
  data.joint_values = joint_values;
  data.blocks = {std::move(block)};
  return data;
}

PoseRows MakePoseRows(const MeasurementModel& model,
                      const Eigen::VectorXd& values, const Dataset& data,
                      const std::vector<int>& columns) {
  Linearization linearization;
  model.Linearize(values, data, columns, &linearization);
  PoseRows rows;
  rows.rows_each = static_cast<int>(
      data.num_poses() > 0 ? data.num_rows() / data.num_poses() : 3);
  rows.transposed =
      ScaleColumns(model, columns, std::move(linearization.jacobian))
          .transpose();
  return rows;
}

}  // namespace alidade::internal
