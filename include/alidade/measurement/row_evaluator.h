#ifndef ALIDADE_MEASUREMENT_ROW_EVALUATOR_H_
#define ALIDADE_MEASUREMENT_ROW_EVALUATOR_H_

#include <Eigen/Core>
#include <vector>

#include "alidade/measurement/dataset.h"
#include "alidade/measurement/geometric_jacobian.h"
#include "alidade/measurement/measurement_model.h"

namespace alidade {

/// The Jacobian of a data set, some observations at a time: what every pass
/// over the data (solvers, ranks, covariances) takes its derivatives from. With
/// p', w the derivatives of position and orientation (geometric_jacobian.h),
/// u the direction from the point c to p and e = Log(R R_m^T), the rows are
///
///   kPosition, kFixedPoint   p' - c'
///   kPose                    p';  J(e)^-1 w    (rotation.h)
///   kDistance                u . (p' - c')     (0 where p = c)
///   kPlane                   n . p' + n' . p - offset'
///   kDifference              p' at the pose less p' at the second one
///   kPointDistance           u . (c' - c2')
///
/// One per thread; model, data and columns outlive it.
class RowEvaluator {
 public:
  RowEvaluator(const MeasurementModel& model, const Eigen::VectorXd& values,
               const Dataset& data, const std::vector<int>& columns);

  /// Whitened derivatives of `count` observations of block `block` from
  /// `first` on: count * rows_each x columns. O(n + columns) each.
  void Fill(const ObservationBlock& block, Eigen::Index first,
            Eigen::Index count, Eigen::Ref<Eigen::MatrixXd> jacobian);

 private:
  using Rows = Eigen::Ref<Eigen::MatrixXd, 0, Eigen::OuterStride<>>;

  void FillOne(const ObservationBlock& block, Eigen::Index i, Rows rows);
  void FillPose(const ObservationBlock& block, Eigen::Index i, Rows rows) const;
  void FillPlane(int plane, Rows rows) const;
  void FillDistance(int point, Rows rows) const;
  void FillPointDistance(int first, int second, Rows rows) const;
  Eigen::Vector3d PointDerivative(int point, int column) const;

  const MeasurementModel& model_;
  const Dataset& data_;
  const std::vector<int>& columns_;
  const References references_;
  GeometricJacobian jacobian_;
  GeometricJacobian second_;
};

}  // namespace alidade

#endif  // ALIDADE_MEASUREMENT_ROW_EVALUATOR_H_
