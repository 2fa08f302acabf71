#ifndef ALIDADE_SRC_ERROR_TERMS_TERM_ROWS_H_
#define ALIDADE_SRC_ERROR_TERMS_TERM_ROWS_H_

#include <Eigen/Core>
#include <vector>

#include "alidade/dataset.h"
#include "src/kernel/measurement_model.h"

namespace alidade::internal {

/// What terms depend on at one pose.
struct PoseNumbers {
  const double* joint_values;
  const double* moments;
  const double* covariates;  ///< less their references
};

/// The whitened rows of a data set at some values of a model, from which
/// the columns of all error terms are made. A term turns all behind a joint
/// about an axis of its frame (or moves a prismatic joint) by its coefficient
/// times a number of the pose: its column is one of `turns` times that number.
///
/// Where an observation is of two poses it has two parts, of which the second
/// has turns alone.
struct TermRows {
  using RowMatrix =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  struct Observation {
    int pose = -1;         ///< -1: of none
    int second_pose = -1;  ///< of a difference
    Eigen::Index first_row = 0;
    int height = 0;
    /// Rows from the first on that are lengths of the arm's error.
    int num_lengths = 0;
    int num_measured = 0;  ///< rows
  };

  std::vector<Observation> observations;
  RowMatrix geometry;  ///< rows x columns of the model, per mm and mrad
  /// Rows x 3 (n + 4): x, y, z of each joint; moves of the base along its axes
  /// and turns about them; the same of the targets and the axes of the last
  /// frame; per mm and mrad.
  RowMatrix turns;
  RowMatrix second_turns;        ///< the same of second poses; or empty
  Eigen::VectorXd residuals;     ///< predicted - measured
  Eigen::MatrixXd joint_values;  ///< n x poses
  Eigen::MatrixXd moments;       ///< 3 n x poses (N m)
  Eigen::MatrixXd covariates;    ///< less their references, of the arm's

  int num_columns() const { return static_cast<int>(geometry.cols()); }
  int num_joints() const { return static_cast<int>(joint_values.rows()); }
  PoseNumbers NumbersOf(int pose) const {
    return {joint_values.col(pose).data(), moments.col(pose).data(),
            covariates.col(pose).data()};
  }
};

/// What coefficients of geometry and turns are multiples of (m, rad).
constexpr double kTermUnit = 1e-3;

/// O(N (columns + joints)) time and memory.
TermRows MakeTermRows(const MeasurementModel& model,
                      const Eigen::VectorXd& values, const Dataset& data,
                      const std::vector<int>& columns);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_ERROR_TERMS_TERM_ROWS_H_
