#include "src/error_terms/term_rows.h"

#include <Eigen/LU>
#include <algorithm>
#include <cstdint>
#include <utility>

#include "alidade/error_terms.h"
#include "alidade/rotation.h"
#include "src/common/parallel.h"
#include "src/model/chain_axes.h"

namespace alidade::internal {
namespace {

constexpr std::int64_t kPosesAtOnce = 256;

// Turns of one pose: the axes and points of each joint, in the instrument's
// frame.
struct PoseTurns {
  Eigen::Matrix3Xd axes;    // 3 n: x, y, z of each joint
  Eigen::Matrix3Xd points;  // n: of the joint's axis
  Eigen::Isometry3d last;   // frame
};

PoseTurns TurnsAt(const Arm& arm, const double* joint_values) {
  const int n = arm.num_joints();
  ChainAxes chain;
  ComputeChainAxes(arm, joint_values, &chain);
  PoseTurns turns;
  turns.axes.resize(3, Eigen::Index{3} * n);
  turns.points = chain.origin_on_axis;
  turns.last = chain.instrument_from_last;
  for (int j = 0; j < n; ++j) {
    const Eigen::Vector3d z = chain.joint_axis.col(j);
    // The next joint turns about y of this frame first.
    const Eigen::Vector3d y =
        j + 1 < n ? Eigen::Vector3d(chain.beta_axis.col(j + 1))
                  : Eigen::Vector3d(chain.instrument_from_last.linear().col(1));
    turns.axes.col(Eigen::Index{3} * j) = y.cross(z);
    turns.axes.col(Eigen::Index{3} * j + 1) = y;
    turns.axes.col(3 * j + 2) = z;
  }
  return turns;
}

// Observations of one pose each, whose derivatives by the base say what any
// small motion of the target does: of a difference its first or second pose.
Dataset OfOnePose(const Dataset& data, bool second) {
  Dataset probe = data;
  for (ObservationBlock& block : probe.blocks) {
    if (block.kind != MeasurementKind::kDifference) continue;
    block.kind = MeasurementKind::kPosition;
    if (second) block.poses = block.seconds;
    block.seconds.clear();
  }
  return probe;
}

std::vector<int> BaseColumns(const ParameterLayout& layout) {
  std::vector<int> columns;
  for (const ParameterKind kind :
       {ParameterKind::kBaseTranslation, ParameterKind::kBaseRotation}) {
    for (int axis = 0; axis < 3; ++axis) {
      columns.push_back(layout.Column(kind, axis));
    }
  }
  return columns;
}

class RowsMaker {
 public:
  RowsMaker(const MeasurementModel& model, const Eigen::VectorXd& values,
            const Dataset& data, const std::vector<int>& columns)
      : model_(model),
        values_(values),
        data_(data),
        columns_(columns),
        arm_(model.layout().WithValues(model.nominal(), values)) {}

  TermRows Make() {
    ListObservations();
    FillPoses();
    FillGeometry();
    FillTurns(false, &rows_.turns);
    if (data_.Has(MeasurementKind::kDifference)) {
      FillTurns(true, &rows_.second_turns);
    }
    return std::move(rows_);
  }

 private:
  void ListObservations() {
    Eigen::Index row = 0;
    for (const ObservationBlock& block : data_.blocks) {
      const bool has_pose = block.kind != MeasurementKind::kPointDistance;
      const int height = block.rows_each();
      for (Eigen::Index i = 0; i < block.size(); ++i) {
        TermRows::Observation one;
        if (has_pose) one.pose = block.pose(i);
        if (block.kind == MeasurementKind::kDifference) {
          one.second_pose = block.seconds[i];
        }
        one.first_row = row;
        one.height = height;
        one.num_lengths = has_pose ? std::min(height, 3) : 0;
        one.num_measured = block.Dimension(i);
        rows_.observations.push_back(one);
        row += height;
      }
    }
    num_rows_ = row;
  }

  void FillPoses() {
    const int n = arm_.num_joints();
    rows_.joint_values = data_.joint_values.map();
    rows_.moments.resize(Eigen::Index{3} * n, data_.num_poses());
    const std::vector<CovariateEffect>& effects = arm_.errors.covariates;
    rows_.covariates.resize(static_cast<Eigen::Index>(effects.size()),
                            data_.num_poses());
    for (int pose = 0; pose < data_.num_poses(); ++pose) {
      rows_.covariates.col(pose) = CovariatesAt(data_, arm_, pose);
    }
    for (Eigen::Index k = 0; k < rows_.covariates.rows(); ++k) {
      rows_.covariates.row(k).array() -=
          effects[static_cast<std::size_t>(k)].reference;
    }
    turns_.resize(static_cast<std::size_t>(data_.num_poses()));
    ParallelFor(model_.num_threads(), data_.num_poses(), kPosesAtOnce,
                [&](std::int64_t begin, std::int64_t end) {
                  for (std::int64_t k = begin; k < end; ++k) {
                    const double* const q = rows_.joint_values.col(k).data();
                    turns_[static_cast<std::size_t>(k)] = TurnsAt(arm_, q);
                    const Eigen::VectorXd covariates =
                        CovariatesAt(data_, arm_, static_cast<int>(k));
                    rows_.moments.col(k) =
                        LoadMoments(arm_, q, covariates.data()).reshaped();
                  }
                });
  }

  void FillGeometry() {
    const auto p = static_cast<Eigen::Index>(columns_.size());
    rows_.geometry.setZero(num_rows_, p);
    rows_.residuals.setZero(num_rows_);
    ForEachObservation(model_, values_, data_, columns_,
                       [&](int, Eigen::Index i,
                           const Eigen::Ref<const Eigen::MatrixXd>& whitened) {
                         const TermRows::Observation& one =
                             rows_.observations[static_cast<std::size_t>(i)];
                         rows_.geometry.middleRows(one.first_row, one.height) =
                             kTermUnit * whitened.leftCols(p);
                         rows_.residuals.segment(one.first_row, one.height) =
                             whitened.col(p);
                       });
  }

  // A turn by a about a point c moves what is measured as one about the base's
  // origin b and a translation a x (b - c).
  void FillTurns(bool second, TermRows::RowMatrix* turns) {
    const Eigen::Vector3d base = arm_.instrument_from_base.translation();
    const ParameterLayout& layout = model_.layout();
    // The axes that the base's own rotation vector turns about.
    const Eigen::Matrix3d from_axes =
        LeftJacobianOfRotation(
            values_.segment<3>(layout.Column(ParameterKind::kBaseRotation, 0)))
            .inverse();
    const int n = arm_.num_joints();
    turns->setZero(num_rows_, Eigen::Index{3} * (n + 4));
    const Eigen::Matrix3d base_axes = arm_.instrument_from_base.linear();
    const auto visit = [&](int, Eigen::Index i,
                           const Eigen::Ref<const Eigen::MatrixXd>& moves) {
      const TermRows::Observation& one =
          rows_.observations[static_cast<std::size_t>(i)];
      const int pose = second ? one.second_pose : one.pose;
      if (pose < 0) return;
      const double sign = second ? -kTermUnit : kTermUnit;
      turns->block(one.first_row, Eigen::Index{3} * n, one.height, 3) =
          sign * moves.leftCols<3>() * base_axes;
      turns->block(one.first_row, 3 * n + 3, one.height, 3) =
          sign * moves.middleCols<3>(3) * from_axes * base_axes;
      const PoseTurns& at = turns_[static_cast<std::size_t>(pose)];
      const auto move = [&](const Eigen::Vector3d& axis) {
        return (sign * (moves.leftCols<3>() * axis)).eval();
      };
      const auto turn = [&](const Eigen::Vector3d& axis,
                            const Eigen::Vector3d& point) {
        return (sign * (moves.leftCols<3>() * axis.cross(base - point) +
                        moves.middleCols<3>(3) * (from_axes * axis)))
            .eval();
      };
      auto columns = turns->middleRows(one.first_row, one.height);
      for (int j = 0; j < n; ++j) {
        for (int k = 0; k < 3; ++k) {
          const Eigen::Vector3d axis = at.axes.col(3 * j + k);
          columns.col(3 * j + k) =
              k == 2 && arm_.joints[j].type == JointType::kPrismatic
                  ? move(axis)
                  : turn(axis, at.points.col(j));
        }
      }
      for (int k = 0; k < 3; ++k) {
        const Eigen::Vector3d axis = at.last.linear().col(k);
        columns.col(3 * n + 6 + k) = move(axis);
        columns.col(3 * n + 9 + k) = turn(axis, at.last.translation());
      }
    };
    ForEachObservation(model_, values_, OfOnePose(data_, second),
                       BaseColumns(layout), visit);
  }

  const MeasurementModel& model_;
  const Eigen::VectorXd& values_;
  const Dataset& data_;
  const std::vector<int>& columns_;
  const Arm arm_;
  Eigen::Index num_rows_ = 0;
  std::vector<PoseTurns> turns_;
  TermRows rows_;
};

}  // namespace

TermRows MakeTermRows(const MeasurementModel& model,
                      const Eigen::VectorXd& values, const Dataset& data,
                      const std::vector<int>& columns) {
  return RowsMaker(model, values, data, columns).Make();
}

}  // namespace alidade::internal
