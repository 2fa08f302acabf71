#ifndef ALIDADE_SRC_PLANNING_POSE_ROWS_H_
#define ALIDADE_SRC_PLANNING_POSE_ROWS_H_

#include <Eigen/Core>
#include <vector>

#include "alidade/dataset.h"
#include "alidade/plan.h"
#include "src/kernel/measurement_model.h"

namespace alidade::internal {

/// A data set that stands for measurements yet to be made: one observation of
/// each target at each pose (n x N), those of a pose one after the other. What
/// is "measured" is what the nominal arm predicts. @pre targets exist.
Dataset MakePlannedData(const MeasurementModel& model,
                        const Eigen::MatrixXd& joint_values,
                        const PoseMeasurement& measurement);

/// The Jacobian rows of many poses, those of a pose side by side in memory:
/// column rows_each * k + i of `transposed` is row i of pose k, transposed
/// (parameters x rows_each * poses).
struct PoseRows {
  int rows_each = 3;
  Eigen::MatrixXd transposed;

  int num_parameters() const { return static_cast<int>(transposed.rows()); }
  int size() const { return static_cast<int>(transposed.cols() / rows_each); }
  /// parameters x rows_each: J_k^T.
  auto Pose(int k) const {
    return transposed.middleCols(Eigen::Index{rows_each} * k, rows_each);
  }
};

/// The whitened Jacobian at `values` of data in the order of MakePlannedData,
/// every column divided by its scale (ColumnScale of identifiability/factor.h):
/// a unit of each parameter then moves the end of the reach by a metre, so that
/// criteria which compare parameters compare lengths. O(poses columns).
/// @pre every pose has the same number of rows.
PoseRows MakePoseRows(const MeasurementModel& model,
                      const Eigen::VectorXd& values, const Dataset& data,
                      const std::vector<int>& columns);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_PLANNING_POSE_ROWS_H_
