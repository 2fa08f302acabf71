#include "src/identifiability/factor.h"

namespace alidade::internal {

double ColumnScale(const MeasurementModel& model, int column) {
  return model.layout().parameter(column).dimension == Dimension::kAngle
             ? ArmReach(model.nominal())
             : 1.0;
}

Eigen::MatrixXd ScaleColumns(const MeasurementModel& model,
                             const std::vector<int>& columns,
                             Eigen::MatrixXd factor) {
  for (Eigen::Index c = 0; c < factor.cols(); ++c) {
    factor.col(c) /= ColumnScale(model, columns[c]);
  }
  return factor;
}

Eigen::MatrixXd SelectColumns(const Eigen::MatrixXd& matrix,
                              const std::vector<int>& indices) {
  Eigen::MatrixXd selected(matrix.rows(),
                           static_cast<Eigen::Index>(indices.size()));
  for (Eigen::Index c = 0; c < selected.cols(); ++c) {
    selected.col(c) = matrix.col(indices[c]);
  }
  return selected;
}

}  // namespace alidade::internal
