#ifndef ALIDADE_MODEL_PARAMETER_LAYOUT_H_
#define ALIDADE_MODEL_PARAMETER_LAYOUT_H_

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "alidade/base/units.h"
#include "alidade/model/arm.h"

namespace alidade {

/// The families of parameters. The first five are blocks of one value per
/// joint; base and tool are blocks of six (translation, then rotation).
enum class ParameterKind {
  kBeta,
  kAlpha,
  kD,
  kTheta,
  kR,
  kBaseTranslation,
  kBaseRotation,
  kToolTranslation,
  kToolRotation,
};

/// One parameter: its name and what it is. `index` is the joint (from 0) for
/// the five joint kinds, the axis (0 = x, 1 = y, 2 = z) for the others.
struct Parameter {
  std::string name;  ///< "beta1", "r5", "base_x", "tool_rz"
  ParameterKind kind;
  int index;
  Dimension dimension;
};

/// A run of columns that Ceres holds as one parameter block.
struct ParameterBlock {
  std::string name;  ///< "beta", "alpha", "d", "theta", "r", "base", "tool"
  int first_column;
  int size;
};

/// The only owner of parameter names, units, blocks and columns. Every other
/// module asks it; none addresses a parameter by an integer of its own.
///
/// Columns follow the blocks beta, alpha, d, theta, r (n each), base (x y z
/// rx ry rz), tool (x y z rx ry rz): 5 n + 12 in all.
///
/// Values are absolute (rad, m), but for the rotations of base and tool:
/// these are rotation vectors of a small rotation that acts on the left of
/// the nominal one, so they are zero at the nominal arm
/// (R = Exp(rx, ry, rz) R_nominal).
///
/// Immutable after construction; safe to share between threads.
class ParameterLayout {
 public:
  /// @pre num_joints >= 1.
  explicit ParameterLayout(int num_joints);

  int num_joints() const { return num_joints_; }
  int size() const { return static_cast<int>(parameters_.size()); }

  const Parameter& parameter(int column) const { return parameters_[column]; }
  const std::vector<Parameter>& parameters() const { return parameters_; }
  const std::vector<ParameterBlock>& blocks() const { return blocks_; }

  /// Column of a kind's parameter. @pre index is in range for the kind.
  int Column(ParameterKind kind, int index) const;
  /// Column of a name, or nothing where no parameter has it.
  std::optional<int> Find(std::string_view name) const;

  /// True for the five kinds that belong to joints.
  static bool IsJointKind(ParameterKind kind);

  /// The values of an arm (size()). @pre arm.num_joints() == num_joints().
  Eigen::VectorXd Values(const Arm& arm) const;
  /// `nominal` with its geometry replaced by `values`; names, types and limits
  /// stay. @pre values.size() == size().
  Arm WithValues(const Arm& nominal, const Eigen::VectorXd& values) const;

 private:
  int num_joints_;
  std::vector<Parameter> parameters_;
  std::vector<ParameterBlock> blocks_;
};

}  // namespace alidade

#endif  // ALIDADE_MODEL_PARAMETER_LAYOUT_H_
