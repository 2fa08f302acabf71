#ifndef ALIDADE_PARAMETER_LAYOUT_H_
#define ALIDADE_PARAMETER_LAYOUT_H_

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "alidade/arm.h"
#include "alidade/units.h"

namespace alidade {

/// The families of parameters. The first five are blocks of one value per
/// joint; base and tool are blocks of six (translation, then rotation). Points
/// (three) and planes (three) are references that the arm is measured against,
/// in the instrument's frame.
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
  kPoint,
  kPlaneTilt,
  kPlaneOffset,
};

/// One parameter: its name and what it is. `index` is the joint (from 0) for
/// the five joint kinds, the axis (0 = x, 1 = y, 2 = z) for the others;
/// `object` the target, point or plane (from 0).
struct Parameter {
  std::string name;  ///< "beta1", "r5", "base_x", "tool_rz", "point2_x"
  ParameterKind kind;
  int index;
  Dimension dimension;
  int object = 0;
};

/// A run of columns that Ceres holds as one parameter block.
struct ParameterBlock {
  std::string name;  ///< "beta" ... "r", "base", "tool", "tool2", "point1" ...
  int first_column;
  int size;
};

/// What a layout has parameters for.
struct LayoutShape {
  int num_joints = 1;
  int num_targets = 1;
  int num_points = 0;
  int num_planes = 0;
};

/// The only owner of parameter names, units, blocks and columns. Every other
/// module asks it; none addresses a parameter by an integer of its own.
///
/// Columns follow the blocks beta, alpha, d, theta, r (n each), base (x y z
/// rx ry rz), tool (x y z rx ry rz), those of further targets (tool2, ...),
/// points (point1_x ...), planes (plane1_u plane1_v plane1_c ...): 5 n + 12 for
/// an arm with one target and no references.
///
/// A plane has the points p with n . p = c and the unit normal
/// n ~ n0 + u t1 + v t2 about its nominal one n0 (references.h).
///
/// Values are absolute (rad, m), but for the rotations of base and tool:
/// these are rotation vectors of a small rotation that acts on the left of
/// the nominal one, so they are zero at the nominal arm
/// (R = Exp(rx, ry, rz) R_nominal).
///
/// Immutable after construction; safe to share between threads.
class ParameterLayout {
 public:
  /// @pre num_joints >= 1, num_targets >= 1.
  explicit ParameterLayout(const LayoutShape& shape);
  explicit ParameterLayout(int num_joints)
      : ParameterLayout(LayoutShape{num_joints}) {}
  /// Of an arm measured against no references.
  explicit ParameterLayout(const Arm& arm)
      : ParameterLayout(LayoutShape{arm.num_joints(), arm.num_targets()}) {}

  int num_joints() const { return shape_.num_joints; }
  const LayoutShape& shape() const { return shape_; }
  int size() const { return static_cast<int>(parameters_.size()); }

  const Parameter& parameter(int column) const { return parameters_[column]; }
  const std::vector<Parameter>& parameters() const { return parameters_; }
  const std::vector<ParameterBlock>& blocks() const { return blocks_; }

  /// Column of a kind's parameter. @pre index and object are in range for the
  /// kind.
  int Column(ParameterKind kind, int index, int object = 0) const;
  /// Column of a name, or nothing where no parameter has it.
  std::optional<int> Find(std::string_view name) const;

  /// True for the five kinds that belong to joints.
  static bool IsJointKind(ParameterKind kind);
  /// True for those of points and planes.
  static bool IsReferenceKind(ParameterKind kind);

  /// The values of an arm (size()); zero for references.
  /// @pre the arm has the layout's joints and targets.
  Eigen::VectorXd Values(const Arm& arm) const;
  /// `nominal` with its geometry replaced by `values`; names, types and limits
  /// stay. @pre values.size() == size().
  Arm WithValues(const Arm& nominal, const Eigen::VectorXd& values) const;

 private:
  void AddFrame(const std::string& name, ParameterKind translation,
                ParameterKind rotation, int object);
  void AddPoint(int object);
  void AddPlane(int object);

  LayoutShape shape_;
  std::vector<Parameter> parameters_;
  std::vector<ParameterBlock> blocks_;
};

}  // namespace alidade

#endif  // ALIDADE_PARAMETER_LAYOUT_H_
