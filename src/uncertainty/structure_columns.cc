#include "src/uncertainty/structure_columns.h"

#include <algorithm>
#include <cmath>

#include "alidade/units.h"
#include "src/model/chain_axes.h"

namespace alidade::internal {
namespace {

constexpr int kLowHarmonics = 3;
constexpr int kMostHarmonics = 32;
// Rows for each column of a ripple, of all joints.
constexpr Eigen::Index kRowsPerRipple = 8;
// A joint that moves less has not moved (rad, m).
constexpr double kStill = 1e-7;
// An axis along gravity has none but rounding (m).
constexpr double kNoMoment = 1e-6;

bool IsRevolute(const Joint& joint) {
  return joint.type == JointType::kRevolute;
}

}  // namespace

// What the factors of one pose have in common.
struct StructureColumns::Pose {
  int number;
  Eigen::VectorXd moments;  // of equal weights, about each joint
  Eigen::VectorXd loads;    // of the target's alone
};

StructureColumns::StructureColumns(const MeasurementModel& model,
                                   const Eigen::VectorXd& values,
                                   const Dataset& data, Eigen::Index rows,
                                   bool has_order)
    : arm_(model.layout().WithValues(model.nominal(), values)),
      layout_(model.layout()),
      data_(data),
      lower_(data.joint_values.map().rowwise().minCoeff()),
      range_(data.joint_values.map().rowwise().maxCoeff() - lower_) {
  const Eigen::Index columns = rows / (kRowsPerRipple * arm_.num_joints());
  const int ripples = static_cast<int>(
      std::min<Eigen::Index>(kMostHarmonics - kLowHarmonics, columns / 2));
  if (has_order) AddApproaches();
  for (int j = 0; j < arm_.num_joints(); ++j) AddJoint(j, ripples, has_order);
  for (const StructureKind kind :
       {StructureKind::kGravityMoment, StructureKind::kApproach}) {
    StructureFamily all{kind, 0, "", {}};
    for (const StructureFamily& one : families_) {
      if (one.kind == kind) all.columns.push_back(one.columns.front());
    }
    if (all.columns.size() > 1) families_.push_back(std::move(all));
  }
  AddSlowChanges({StructureKind::kRowOrder, 0, "", {}},
                 {Factor::kTime, 0, 1, 0}, 2);
  AddCovariates();
}

int StructureColumns::DirectionOf(int layout_column) {
  const auto found =
      std::find(directions_.begin(), directions_.end(), layout_column);
  if (found != directions_.end()) {
    return static_cast<int>(found - directions_.begin());
  }
  directions_.push_back(layout_column);
  return static_cast<int>(directions_.size()) - 1;
}

int StructureColumns::Add(const Column& column, StructureFamily* family) {
  columns_.push_back(column);
  family->columns.push_back(size() - 1);
  return size() - 1;
}

void StructureColumns::AddJoint(int joint, int ripples, bool has_order) {
  const bool turns = IsRevolute(arm_.joints[joint]);
  const int q = DirectionOf(
      layout_.Column(turns ? ParameterKind::kTheta : ParameterKind::kR, joint));
  const auto add_harmonics = [&](StructureKind kind, int first, int last) {
    StructureFamily family{kind, joint + 1, "", {}};
    for (int k = first; k <= last; ++k) {
      Add({Factor::kSine, joint, k, q}, &family);
      Add({Factor::kCosine, joint, k, q}, &family);
    }
    if (!family.columns.empty()) families_.push_back(std::move(family));
  };
  add_harmonics(StructureKind::kJointValue, 1, kLowHarmonics);
  add_harmonics(StructureKind::kJointRipple, kLowHarmonics + 1,
                kLowHarmonics + ripples);
  if (turns) {
    StructureFamily moment{StructureKind::kGravityMoment, joint + 1, "", {}};
    Add({Factor::kMoment, joint, 1, q}, &moment);
    Add({Factor::kLoad, joint, 1, q}, &moment);
    families_.push_back(std::move(moment));
    StructureFamily sign{StructureKind::kGravitySign, joint + 1, "", {}};
    Add({Factor::kSign, joint, 1, q}, &sign);
    families_.push_back(std::move(sign));
  }
  if (!has_order) return;
  StructureFamily approach{StructureKind::kApproach, joint + 1, "", {}};
  Add({Factor::kApproach, joint, 1, q}, &approach);
  families_.push_back(std::move(approach));
}

// What warms up or moves with a quantity: all lengths grow, the base moves, the
// zeros of the joints do.
void StructureColumns::AddSlowChanges(const StructureFamily& kind,
                                      Column factor, int most_powers) {
  StructureFamily growth = kind;
  factor.direction = -1;
  for (int power = 1; power <= most_powers; ++power) {
    if (most_powers > 1) factor.order = power;
    Add(factor, &growth);
  }
  if (most_powers > 1) factor.order = 1;
  StructureFamily base = kind;
  for (const ParameterKind of :
       {ParameterKind::kBaseTranslation, ParameterKind::kBaseRotation}) {
    for (int axis = 0; axis < 3; ++axis) {
      factor.direction = DirectionOf(layout_.Column(of, axis));
      Add(factor, &base);
    }
  }
  StructureFamily zeros = kind;
  for (int j = 0; j < arm_.num_joints(); ++j) {
    const ParameterKind of =
        IsRevolute(arm_.joints[j]) ? ParameterKind::kTheta : ParameterKind::kR;
    factor.direction = DirectionOf(layout_.Column(of, j));
    Add(factor, &zeros);
    DirectionOf(layout_.Column(ParameterKind::kD, j));
    DirectionOf(layout_.Column(ParameterKind::kR, j));
  }
  families_.insert(families_.end(), {growth, base, zeros});
}

// Marks of a station are 1 at its poses: its base is what moves.
void StructureColumns::AddCovariates() {
  if (data_.covariate_names.empty()) return;
  const auto values = data_.covariates.map();
  lowest_ = values.rowwise().minCoeff();
  span_ = values.rowwise().maxCoeff() - lowest_;
  for (int c = 0; c < values.rows(); ++c) {
    if (!(span_[c] > 0.0)) continue;
    AddSlowChanges({StructureKind::kCovariate,
                    0,
                    data_.covariate_names[static_cast<std::size_t>(c)],
                    {}},
                   {Factor::kCovariate, 0, c, 0}, 1);
  }
}

// A joint that stands still keeps the side that it came from.
void StructureColumns::AddApproaches() {
  const auto q = data_.joint_values.map();
  approach_ = Eigen::MatrixXd::Zero(q.rows(), q.cols());
  for (Eigen::Index i = 1; i < q.cols(); ++i) {
    for (Eigen::Index j = 0; j < q.rows(); ++j) {
      const double moved = q(j, i) - q(j, i - 1);
      approach_(j, i) = std::abs(moved) < kStill ? approach_(j, i - 1)
                        : moved > 0.0            ? 1.0
                                                 : -1.0;
    }
  }
}

double StructureColumns::Phase(int joint, int pose) const {
  const double q = data_.joint_values(joint, pose);
  if (IsRevolute(arm_.joints[joint])) return q;
  return range_[joint] > 0.0 ? kPi * (q - lower_[joint]) / range_[joint] : 0.0;
}

double StructureColumns::FactorOf(const Column& column, const Pose& at) const {
  const int j = column.joint;
  switch (column.factor) {
    case Factor::kSine:
      return std::sin(column.order * Phase(j, at.number));
    case Factor::kCosine:
      return std::cos(column.order * Phase(j, at.number));
    case Factor::kMoment:
      return at.moments[j];
    case Factor::kLoad:
      return at.loads[j];
    case Factor::kSign:
      return std::abs(at.moments[j]) < kNoMoment ? 0.0
             : at.moments[j] > 0.0               ? 1.0
                                                 : -1.0;
    case Factor::kApproach:
      return approach_(j, at.number);
    case Factor::kCovariate:
      return 2.0 *
                 (data_.covariates(column.order, at.number) -
                  lowest_[column.order]) /
                 span_[column.order] -
             1.0;
    case Factor::kTime:
      break;
  }
  const auto last =
      static_cast<double>(std::max<Eigen::Index>(1, data_.num_poses() - 1));
  return std::pow(2.0 * at.number / last - 1.0, column.order);
}

void StructureColumns::Fill(int pose, int target,
                            const Eigen::Ref<const Eigen::MatrixXd>& rows,
                            Eigen::Ref<Eigen::MatrixXd> columns) const {
  const int n = arm_.num_joints();
  const Eigen::VectorXd q = data_.joint_values.col(pose);
  ChainAxes axes;
  ComputeChainAxes(arm_, q.data(), &axes);
  const Eigen::Vector3d down =
      arm_.instrument_from_base.linear() * arm_.errors.gravity.normalized();
  const Eigen::Vector3d load =
      axes.instrument_from_last * arm_.last_from_target(target).translation();
  Pose at{pose, Eigen::VectorXd(n), Eigen::VectorXd(n)};
  Eigen::Vector3d sum = load;  // of the places of the weights beyond the joint
  Eigen::VectorXd growth = Eigen::VectorXd::Zero(rows.rows());
  for (int j = n - 1; j >= 0; --j) {
    const Joint& joint = arm_.joints[j];
    const double r = joint.r + (IsRevolute(joint) ? 0.0 : q[j]);
    const Eigen::Vector3d axis = axes.joint_axis.col(j);
    const Eigen::Vector3d origin = axes.origin_on_axis.col(j);
    at.loads[j] = axis.dot((load - origin).cross(down));
    at.moments[j] = axis.dot((sum - (n - j) * origin).cross(down));
    sum += origin + r * axis;
    for (std::size_t k = 0; k < directions_.size(); ++k) {
      const Parameter& parameter = layout_.parameter(directions_[k]);
      if (parameter.index != j) continue;
      const auto column = static_cast<Eigen::Index>(k);
      if (parameter.kind == ParameterKind::kD) {
        growth += joint.d * rows.col(column);
      } else if (parameter.kind == ParameterKind::kR) {
        growth += r * rows.col(column);
      }
    }
  }
  for (int c = 0; c < size(); ++c) {
    const Column& column = columns_[static_cast<std::size_t>(c)];
    const double factor = FactorOf(column, at);
    if (column.direction < 0) {
      columns.col(c) = factor * growth;
    } else {
      columns.col(c) = factor * rows.col(column.direction);
    }
  }
}

}  // namespace alidade::internal
