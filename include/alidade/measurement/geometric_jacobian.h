#ifndef ALIDADE_MEASUREMENT_GEOMETRIC_JACOBIAN_H_
#define ALIDADE_MEASUREMENT_GEOMETRIC_JACOBIAN_H_

#include <Eigen/Core>
#include <vector>

#include "alidade/model/arm.h"
#include "alidade/model/chain_axes.h"
#include "alidade/model/parameter_layout.h"

namespace alidade {

/// What is measured of the target at a pose.
enum class MeasurementKind {
  kPosition,  ///< 3 rows: x y z (m)
  kPose,      ///< 6 rows: x y z (m), then the rotation vector (rad)
};

/// Rows of one measurement: 3 or 6.
int RowsOf(MeasurementKind kind);

/// Derivatives of where the target is by the parameters of the layout, from the
/// axes of the chain (chain_axes.h), not whitened:
///
///   position     dp/dparameter                                  (m per unit)
///   orientation  w with R(parameter + e) = Exp(w e) R           (rad per unit)
///
/// both in the instrument's frame; small rotations act on the left. An object
/// holds one set of values and a scratch buffer: use one per thread.
class GeometricJacobian {
 public:
  /// @pre values.size() == layout.size(); layout outlives the object.
  GeometricJacobian(const Arm& nominal, const ParameterLayout& layout,
                    const Eigen::VectorXd& values);

  /// Fills rows [first_row, first_row + RowsOf(kind)) of `out`, one column per
  /// entry of `columns`. O(n + columns), no allocation after the first call.
  void Evaluate(const double* joint_values, const std::vector<int>& columns,
                MeasurementKind kind, Eigen::Ref<Eigen::MatrixXd> out);

 private:
  Eigen::Vector3d PositionDerivative(int column) const;
  Eigen::Vector3d RotationDerivative(int column) const;

  const ParameterLayout& layout_;
  Arm arm_;
  Eigen::Vector3d base_origin_;
  /// Column k: the axis that the base's rotation vector turns about when its
  /// component k grows; likewise for the tool, in the last frame.
  Eigen::Matrix3d base_axes_;
  Eigen::Matrix3d tool_axes_;
  ChainAxes axes_;
};

}  // namespace alidade

#endif  // ALIDADE_MEASUREMENT_GEOMETRIC_JACOBIAN_H_
