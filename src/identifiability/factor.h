#ifndef ALIDADE_SRC_IDENTIFIABILITY_FACTOR_H_
#define ALIDADE_SRC_IDENTIFIABILITY_FACTOR_H_

#include <Eigen/Core>
#include <vector>

#include "src/kernel/measurement_model.h"

namespace alidade::internal {

/// What a unit of the parameter moves a point at the end of the reach by: the
/// arm's reach for angles, 1 for lengths. The base turns about itself, so that
/// columns divided by it compare in metres wherever the instrument stands.
double ColumnScale(const MeasurementModel& model, int column);

/// The factor with every column divided by its scale.
Eigen::MatrixXd ScaleColumns(const MeasurementModel& model,
                             const std::vector<int>& columns,
                             Eigen::MatrixXd factor);

/// The columns of a matrix at `indices`, in that order.
Eigen::MatrixXd SelectColumns(const Eigen::MatrixXd& matrix,
                              const std::vector<int>& indices);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_IDENTIFIABILITY_FACTOR_H_
