#include "alidade/measurement/row_evaluator.h"

#include "alidade/model/rotation.h"

namespace alidade {
namespace {

// The direction in which a distance grows; none where it is zero.
Eigen::Vector3d DirectionOf(const Eigen::Vector3d& difference) {
  const double norm = difference.norm();
  if (norm > 0.0) return difference / norm;
  return Eigen::Vector3d::Zero();
}

}  // namespace

RowEvaluator::RowEvaluator(const MeasurementModel& model,
                           const Eigen::VectorXd& values, const Dataset& data,
                           const std::vector<int>& columns)
    : model_(model),
      data_(data),
      columns_(columns),
      references_(model.ReferencesAt(values)),
      jacobian_(model.nominal(), model.layout(), values),
      second_(model.nominal(), model.layout(), values) {}

void RowEvaluator::Fill(const ObservationBlock& block, Eigen::Index first,
                        Eigen::Index count,
                        Eigen::Ref<Eigen::MatrixXd> jacobian) {
  const int height = block.rows_each();
  for (Eigen::Index i = 0; i < count; ++i) {
    FillOne(block, first + i, jacobian.middleRows(i * height, height));
  }
  Whiten(block, first, count, jacobian);
}

void RowEvaluator::FillOne(const ObservationBlock& block, Eigen::Index i,
                           Rows rows) {
  if (block.kind == MeasurementKind::kPointDistance) {
    FillPointDistance(block.references[i], block.seconds[i], rows);
    return;
  }
  jacobian_.MoveTo(data_.joint_values.col(block.pose(i)).data(),
                   block.target(i));
  const auto num_columns = static_cast<Eigen::Index>(columns_.size());
  switch (block.kind) {
    case MeasurementKind::kPosition:
      for (Eigen::Index c = 0; c < num_columns; ++c) {
        rows.col(c) = jacobian_.PositionDerivative(columns_[c]);
      }
      break;
    case MeasurementKind::kPose:
      FillPose(block, i, rows);
      break;
    case MeasurementKind::kFixedPoint:
      for (Eigen::Index c = 0; c < num_columns; ++c) {
        rows.col(c) = jacobian_.PositionDerivative(columns_[c]) -
                      PointDerivative(block.references[i], columns_[c]);
      }
      break;
    case MeasurementKind::kDistance:
      FillDistance(block.references[i], rows);
      break;
    case MeasurementKind::kPlane:
      FillPlane(block.references[i], rows);
      break;
    case MeasurementKind::kDifference:
      second_.MoveTo(data_.joint_values.col(block.seconds[i]).data(),
                     block.target(i));
      for (Eigen::Index c = 0; c < num_columns; ++c) {
        rows.col(c) = jacobian_.PositionDerivative(columns_[c]) -
                      second_.PositionDerivative(columns_[c]);
      }
      break;
    case MeasurementKind::kPointDistance:
      break;
  }
}

void RowEvaluator::FillPose(const ObservationBlock& block, Eigen::Index i,
                            Rows rows) const {
  const Eigen::Vector3d measured = block.measured.col(i).tail<3>();
  const Eigen::Matrix3d turn = jacobian_.instrument_from_target().linear() *
                               RotationFromVector<double>(-measured);
  const Eigen::Matrix3d log_derivative =
      InverseLeftJacobianOfRotation(VectorFromRotation(turn));
  for (Eigen::Index c = 0; c < rows.cols(); ++c) {
    rows.col(c).head<3>() = jacobian_.PositionDerivative(columns_[c]);
    rows.col(c).tail<3>() =
        log_derivative * jacobian_.RotationDerivative(columns_[c]);
  }
}

void RowEvaluator::FillDistance(int point, Rows rows) const {
  const Eigen::Vector3d direction =
      DirectionOf(jacobian_.instrument_from_target().translation() -
                  references_.points[point].position);
  for (Eigen::Index c = 0; c < rows.cols(); ++c) {
    rows(0, c) = direction.dot(jacobian_.PositionDerivative(columns_[c]) -
                               PointDerivative(point, columns_[c]));
  }
}

void RowEvaluator::FillPlane(int plane, Rows rows) const {
  const Eigen::Vector3d p = jacobian_.instrument_from_target().translation();
  const Eigen::Vector3d n = references_.planes[plane].normal;
  const Eigen::Vector3d n0 = model_.references().planes[plane].normal;
  Eigen::Vector3d tangents[2];
  TangentBasis(n0, &tangents[0], &tangents[1]);
  // The length of n0 + u t1 + v t2, of which n0 has the part 1.
  const double length = 1.0 / n.dot(n0);
  for (Eigen::Index c = 0; c < rows.cols(); ++c) {
    const Parameter& parameter = model_.layout().parameter(columns_[c]);
    rows(0, c) = n.dot(jacobian_.PositionDerivative(columns_[c]));
    if (parameter.object != plane) continue;
    if (parameter.kind == ParameterKind::kPlaneOffset) rows(0, c) = -1.0;
    if (parameter.kind == ParameterKind::kPlaneTilt) {
      const Eigen::Vector3d& t = tangents[parameter.index];
      rows(0, c) = (t - n * n.dot(t)).dot(p) / length;
    }
  }
}

void RowEvaluator::FillPointDistance(int first, int second, Rows rows) const {
  const Eigen::Vector3d direction = DirectionOf(
      references_.points[first].position - references_.points[second].position);
  for (Eigen::Index c = 0; c < rows.cols(); ++c) {
    rows(0, c) = direction.dot(PointDerivative(first, columns_[c]) -
                               PointDerivative(second, columns_[c]));
  }
}

Eigen::Vector3d RowEvaluator::PointDerivative(int point, int column) const {
  const Parameter& parameter = model_.layout().parameter(column);
  if (parameter.kind != ParameterKind::kPoint || parameter.object != point) {
    return Eigen::Vector3d::Zero();
  }
  return Eigen::Vector3d::Unit(parameter.index);
}

}  // namespace alidade
