#ifndef ALIDADE_SRC_UNCERTAINTY_STRUCTURE_COLUMNS_H_
#define ALIDADE_SRC_UNCERTAINTY_STRUCTURE_COLUMNS_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "alidade/uncertainty.h"
#include "src/kernel/measurement_model.h"

namespace alidade::internal {

/// Columns that are tested together, and what of.
struct StructureFamily {
  StructureKind kind = StructureKind::kJointValue;
  int joint = 0;             ///< from 1; 0 = of all joints, or of none
  std::string covariate;     ///< its name
  std::vector<int> columns;  ///< of StructureColumns
};

/// What an arm does that rigid geometry does not describe, as columns beside
/// its Jacobian J: a function of the pose times the derivative by the value of
/// a joint, J_q, so that a test of residuals against them speaks physics:
///
///   joint value        J_q sin(k q), J_q cos(k q), k = 1 ... 3
///   joint ripple       the same from k = 4 on, as far as there are data
///   gravity moment     J_q m, m the moment about the joint of equal weights
///                      at the frames beyond it and at the target; J_q m of the
///                      target's alone
///   gravity sign       J_q sign(m)
///   approach           J_q times the sign of the joint's last movement
///   row order          J_q t; the base's columns times t; growth of all
///                      lengths with t and t^2; t from -1 to 1 over the rows
///   covariate          the same of each covariate, from -1 to 1 over its
///                      range, without the square
///
/// Of the moment and the approach there is also a family of all joints at once.
/// A sliding joint's value counts in half turns over its range.
class StructureColumns {
 public:
  /// `rows`: of measurements, which the number of ripples depends on.
  /// `has_order`: consecutive poses were measured one after the other.
  StructureColumns(const MeasurementModel& model, const Eigen::VectorXd& values,
                   const Dataset& data, Eigen::Index rows, bool has_order);

  int size() const { return static_cast<int>(columns_.size()); }
  const std::vector<StructureFamily>& families() const { return families_; }
  /// Columns of the layout whose derivatives the columns are made of.
  const std::vector<int>& directions() const { return directions_; }

  /// `rows`: derivatives of an observation at `pose` of a target, one column
  /// per direction. Thread-safe.
  void Fill(int pose, int target, const Eigen::Ref<const Eigen::MatrixXd>& rows,
            Eigen::Ref<Eigen::MatrixXd> columns) const;

 private:
  enum class Factor {
    kSine,
    kCosine,
    kMoment,
    kLoad,
    kSign,
    kApproach,
    kTime,
    kCovariate
  };
  // Factor of joint `joint` times direction `direction`; the growth of all
  // lengths where that is -1. `order`: of a harmonic, power of the time, or the
  // covariate.
  struct Column {
    Factor factor;
    int joint;
    int order;
    int direction;
  };
  struct Pose;

  int Add(const Column& column, StructureFamily* family);
  int DirectionOf(int layout_column);
  void AddJoint(int joint, int ripples, bool has_order);
  void AddSlowChanges(const StructureFamily& kind, Column factor,
                      int most_powers);
  void AddCovariates();
  void AddApproaches();
  double Phase(int joint, int pose) const;
  double FactorOf(const Column& column, const Pose& at) const;

  const Arm arm_;
  const ParameterLayout& layout_;
  const Dataset& data_;
  std::vector<int> directions_;
  std::vector<Column> columns_;
  std::vector<StructureFamily> families_;
  Eigen::VectorXd lower_;  // of each joint's values
  Eigen::VectorXd range_;
  Eigen::MatrixXd approach_;  // signs, n x poses
  Eigen::VectorXd lowest_;    // of each covariate
  Eigen::VectorXd span_;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_UNCERTAINTY_STRUCTURE_COLUMNS_H_
