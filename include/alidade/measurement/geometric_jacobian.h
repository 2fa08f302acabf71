#ifndef ALIDADE_MEASUREMENT_GEOMETRIC_JACOBIAN_H_
#define ALIDADE_MEASUREMENT_GEOMETRIC_JACOBIAN_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "alidade/model/arm.h"
#include "alidade/model/chain_axes.h"
#include "alidade/model/parameter_layout.h"

namespace alidade {

/// Derivatives of where a target is by the parameters of the layout, from the
/// axes of the chain (chain_axes.h), not whitened:
///
///   position     dp/dparameter                                  (m per unit)
///   orientation  w with R(parameter + e) = Exp(w e) R           (rad per unit)
///
/// both in the instrument's frame; small rotations act on the left. Zero for
/// the parameters of other targets and of references. An object holds one set
/// of values and a scratch buffer: use one per thread.
class GeometricJacobian {
 public:
  /// @pre values.size() == layout.size(); layout outlives the object.
  GeometricJacobian(const Arm& nominal, const ParameterLayout& layout,
                    const Eigen::VectorXd& values);

  /// What the derivatives are of, from now on. O(n), no allocation after the
  /// first call. @pre joint_values: n values; target is in range.
  void MoveTo(const double* joint_values, int target = 0);

  const Eigen::Isometry3d& instrument_from_target() const {
    return instrument_from_target_;
  }
  Eigen::Vector3d PositionDerivative(int column) const;
  Eigen::Vector3d RotationDerivative(int column) const;

 private:
  const ParameterLayout& layout_;
  Arm arm_;
  Eigen::Vector3d base_origin_;
  /// Column k: the axis that the base's rotation vector turns about when its
  /// component k grows; likewise for each target, in the last frame.
  Eigen::Matrix3d base_axes_;
  std::vector<Eigen::Matrix3d> tool_axes_;
  ChainAxes axes_;
  int target_ = 0;
  Eigen::Isometry3d instrument_from_target_ = Eigen::Isometry3d::Identity();
};

}  // namespace alidade

#endif  // ALIDADE_MEASUREMENT_GEOMETRIC_JACOBIAN_H_
