#include "src/job/frame_table.h"

#include <cmath>
#include <limits>
#include <vector>

#include "alidade/parameter_layout.h"
#include "alidade/units.h"
#include "src/common/format.h"

namespace alidade::internal {
namespace {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

struct Frame {
  std::string name;
  Eigen::Isometry3d pose;
  Vector6d deviations;  // NaN where nothing was identified
};

// What origin and rotation of the inverse change by with those of the frame,
// both rotations on the left: p' = -R^T p, R' = R^T.
Matrix6d DerivativeOfInverse(const Eigen::Isometry3d& frame) {
  const Eigen::Matrix3d turn = frame.linear().transpose();
  Matrix6d derivative = Matrix6d::Zero();
  derivative.topLeftCorner<3, 3>() = -turn;
  for (int k = 0; k < 3; ++k) {
    derivative.block<3, 1>(0, 3 + k) =
        -turn * frame.translation().cross(Eigen::Vector3d::Unit(k));
  }
  derivative.bottomRightCorner<3, 3>() = -turn;
  return derivative;
}

// Of the six parameters from `first`, as `derivative` hands them on.
Vector6d Deviations(const ParameterCovariance* covariance, int first,
                    const Matrix6d& derivative) {
  Vector6d deviations =
      Vector6d::Constant(std::numeric_limits<double>::quiet_NaN());
  if (covariance == nullptr) return deviations;
  Eigen::MatrixXd root = Eigen::MatrixXd::Zero(6, covariance->root.cols());
  Eigen::MatrixXd unknown =
      Eigen::MatrixXd::Zero(6, covariance->null_space.cols());
  for (int k = 0; k < covariance->size(); ++k) {
    const int row = covariance->columns[k] - first;
    if (row < 0 || row >= 6) continue;
    root.row(row) = covariance->root.row(k);
    unknown.row(row) = covariance->null_space.row(k);
  }
  root = derivative * root;
  unknown = derivative * unknown;
  for (int row = 0; row < 6; ++row) {
    if (!unknown.row(row).isZero(0.0)) {
      deviations[row] = std::numeric_limits<double>::infinity();
    } else if (!root.row(row).isZero(0.0)) {
      deviations[row] = root.row(row).norm();
    }
  }
  return deviations;
}

std::vector<Frame> FramesOf(const Arm& arm,
                            const Eigen::Isometry3d& last_from_flange,
                            const ParameterCovariance* covariance) {
  const ParameterLayout layout(arm);
  std::vector<Frame> frames;
  const Eigen::Isometry3d flange_from_last = last_from_flange.inverse();
  Matrix6d to_flange = Matrix6d::Zero();
  to_flange.topLeftCorner<3, 3>() = flange_from_last.linear();
  to_flange.bottomRightCorner<3, 3>() = flange_from_last.linear();
  for (int target = 0; target < arm.num_targets(); ++target) {
    const int first = layout.Column(ParameterKind::kToolTranslation, 0, target);
    const std::string& name = arm.targets[target].name;
    frames.push_back({name.empty() ? "tool" : name,
                      flange_from_last * arm.last_from_target(target),
                      Deviations(covariance, first, to_flange)});
  }
  const Eigen::Isometry3d& base = arm.instrument_from_base;
  const int first = layout.Column(ParameterKind::kBaseTranslation, 0);
  frames.push_back(
      {"base", base, Deviations(covariance, first, Matrix6d::Identity())});
  frames.push_back({"instrument", base.inverse(),
                    Deviations(covariance, first, DerivativeOfInverse(base))});
  return frames;
}

std::string DeviationCell(double value, double scale) {
  if (std::isnan(value)) return "";
  return std::isfinite(value) ? FormatSignificant(value / scale, 3) : "inf";
}

std::vector<AddedColumn> DeviationColumns(const std::vector<Frame>& frames) {
  std::vector<AddedColumn> columns;
  for (int k = 0; k < 6; ++k) {
    const bool is_length = k < 3;
    AddedColumn column{std::string("std_") + (is_length ? "" : "w") +
                           "xyz"[k % 3] + (is_length ? "_mm" : "_deg"),
                       {}};
    for (const Frame& frame : frames) {
      column.cells.push_back(DeviationCell(frame.deviations[k],
                                           is_length ? kMillimetre : kDegree));
    }
    columns.push_back(std::move(column));
  }
  return columns;
}

}  // namespace

std::string FormatFrames(const Arm& arm,
                         const Eigen::Isometry3d& last_from_flange,
                         const ParameterCovariance* covariance,
                         const PoseFormat& format) {
  const std::vector<Frame> frames = FramesOf(arm, last_from_flange, covariance);
  std::vector<Eigen::Isometry3d> poses;
  for (const Frame& frame : frames) poses.push_back(frame.pose);
  std::vector<AddedColumn> columns = PoseColumns("", poses, format);
  if (covariance != nullptr) {
    for (AddedColumn& column : DeviationColumns(frames)) {
      columns.push_back(std::move(column));
    }
  }
  std::string text = "name";
  for (const AddedColumn& column : columns) text += "," + column.name;
  text += "\n";
  for (std::size_t i = 0; i < frames.size(); ++i) {
    text += frames[i].name;
    for (const AddedColumn& column : columns) text += "," + column.cells[i];
    text += "\n";
  }
  return text;
}

}  // namespace alidade::internal
