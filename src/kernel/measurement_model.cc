#include "src/kernel/measurement_model.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

#include "src/common/parallel.h"
#include "src/data/tilted_normal.h"
#include "src/kernel/kernel.h"
#include "src/kernel/tile_rows.h"
#include "src/kernel/tiles.h"

namespace alidade::internal {
namespace {

// Small enough to balance threads, large enough that memory for a tile's rows
// does not show.
constexpr std::int64_t kTilesPerBlock = 32;

// The row of the stacked residual at which each observation begins.
std::vector<Eigen::Index> FirstRowOfEach(const Dataset& data) {
  std::vector<Eigen::Index> rows;
  rows.reserve(data.num_observations());
  Eigen::Index row = 0;
  for (const ObservationBlock& block : data.blocks) {
    for (Eigen::Index i = 0; i < block.size(); ++i) {
      rows.push_back(row);
      row += block.rows_each();
    }
  }
  return rows;
}

LayoutShape ShapeOf(const Arm& arm, const References& references) {
  return {arm.num_joints(), arm.num_targets(), references.num_points(),
          references.num_planes()};
}

// Calls visit(block, i, first row) for every observation.
template <typename Visit>
void ForEachObservation(const Dataset& data, const Visit& visit) {
  Eigen::Index row = 0;
  for (const ObservationBlock& block : data.blocks) {
    for (Eigen::Index i = 0; i < block.size(); ++i) {
      visit(block, i, row);
      row += block.rows_each();
    }
  }
}

// Copies one lane of a tile to `out`, rows of the observation by columns.
void CopyLane(TileRows* rows, int lane, Eigen::MatrixXd* out) {
  const int width = rows->num_derivatives() + 1;
  const int height = rows->height();
  const auto stride = rows->stride();
  out->resize(height, width);
  double* to = out->data();
  for (int column = 0; column < width; ++column) {
    const double* from = rows->rows() + column * stride + lane;
    for (int row = 0; row < height; ++row, from += kTile) *to++ = *from;
  }
}

}  // namespace

MeasurementModel::MeasurementModel(Arm nominal, References references,
                                   const Execution& execution)
    : nominal_(std::move(nominal)),
      references_(std::move(references)),
      layout_(ShapeOf(nominal_, references_)),
      execution_(execution) {}

Eigen::VectorXd MeasurementModel::NominalValues() const {
  Eigen::VectorXd values = layout_.Values(nominal_);
  for (int k = 0; k < references_.num_points(); ++k) {
    values.segment<3>(layout_.Column(ParameterKind::kPoint, 0, k)) =
        references_.points[k].position;
  }
  for (int k = 0; k < references_.num_planes(); ++k) {
    values[layout_.Column(ParameterKind::kPlaneOffset, 0, k)] =
        references_.planes[k].offset;
  }
  return values;
}

References MeasurementModel::ReferencesAt(const Eigen::VectorXd& values) const {
  References references = references_;
  for (int k = 0; k < references.num_points(); ++k) {
    references.points[k].position =
        values.segment<3>(layout_.Column(ParameterKind::kPoint, 0, k));
  }
  for (int k = 0; k < references.num_planes(); ++k) {
    ReferencePlane& plane = references.planes[k];
    const int tilt = layout_.Column(ParameterKind::kPlaneTilt, 0, k);
    plane.normal = TiltedNormal<double>(plane.normal, &values[tilt]);
    plane.offset = values[layout_.Column(ParameterKind::kPlaneOffset, 0, k)];
  }
  return references;
}

Eigen::Matrix3Xd MeasurementModel::Predict(const Eigen::VectorXd& values,
                                           const SharedMatrix& joint_values,
                                           int target) const {
  // Errors of what was measured at the origin.
  const Eigen::Index poses = joint_values.cols();
  Dataset at_origin = MakePositions(
      joint_values, SharedMatrix::Repeated(Eigen::Vector3d::Zero(), poses),
      SharedMatrix::Repeated(Eigen::Vector3d::Ones(), poses));
  if (target != 0) at_origin.blocks.front().targets.assign(poses, target);
  return Errors(values, at_origin).map().reshaped(3, poses);
}

SharedVector MeasurementModel::Errors(const Eigen::VectorXd& values,
                                      const Dataset& data) const {
  Tiles tiles(nominal_, data, 0, RowScale::kUnit);
  const kernel::Columns no_columns(layout_, {});
  kernel::Constants constants;
  kernel::ComputeConstants(nominal_, references_, layout_, values, &constants);
  std::vector<Eigen::Index> first_rows;
  Eigen::Index num_rows = 0;
  for (const ObservationBlock& block : data.blocks) {
    first_rows.push_back(num_rows);
    num_rows += block.size() * block.rows_each();
  }
  VectorBuilder errors(num_rows);
  double* const first_error = errors.map().data();
  const auto work = [&](std::int64_t begin, std::int64_t end) {
    TileRows rows(&tiles, layout_.num_joints(), 0);
    for (std::int64_t tile = begin; tile < end; ++tile) {
      rows.Evaluate(constants, no_columns, tile);
      const int height = rows.height();
      for (int lane = 0; lane < rows.tile().count; ++lane) {
        double* const to = first_error + first_rows[rows.tile().block] +
                           tiles.Observation(tile, lane) * height;
        for (int row = 0; row < height; ++row) {
          to[row] = rows.residual()[std::ptrdiff_t{row} * kTile + lane];
        }
      }
    }
  };
  ParallelFor(num_threads(), tiles.size(), kTilesPerBlock, work);
  return errors.Freeze();
}

void MeasurementModel::Linearize(const Eigen::VectorXd& values,
                                 const Dataset& data,
                                 const std::vector<int>& columns,
                                 Linearization* out) const {
  const auto p = static_cast<int>(columns.size());
  out->residuals.resize(data.num_rows());
  out->jacobian.resize(data.num_rows(), p);
  const std::vector<Eigen::Index> first_rows = FirstRowOfEach(data);
  ForEachObservation(*this, values, data, columns,
                     [&](int, Eigen::Index observation,
                         const Eigen::Ref<const Eigen::MatrixXd>& rows) {
                       const Eigen::Index first = first_rows[observation];
                       out->jacobian.middleRows(first, rows.rows()) =
                           rows.leftCols(p);
                       out->residuals.segment(first, rows.rows()) = rows.col(p);
                     });
}

double MeasurementModel::RoundingError() const {
  return std::numeric_limits<double>::epsilon() * Reach(nominal_);
}

SharedVector SquaredNorms(const SharedVector& errors, const Dataset& data) {
  VectorBuilder norms(data.num_observations());
  double* norm = norms.map().data();
  ForEachObservation(data, [&](const ObservationBlock& block, Eigen::Index i,
                               Eigen::Index first) {
    Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 6, 1> rows =
        errors.map().segment(first, block.rows_each());
    Whiten(block, i, 1, rows);
    *norm++ = rows.squaredNorm();
  });
  return norms.Freeze();
}

double ChiSquare(const SharedVector& errors, const Dataset& data) {
  return SquaredNorms(errors, data).map().sum();
}

SharedVector LengthErrors(const SharedVector& errors, const Dataset& data) {
  VectorBuilder norms(data.num_observations());
  double* norm = norms.map().data();
  ForEachObservation(data, [&](const ObservationBlock& block, Eigen::Index,
                               Eigen::Index first) {
    const int height = std::min(3, block.rows_each());
    *norm++ = errors.map().segment(first, height).norm();
  });
  return norms.Freeze();
}

SharedVector RotationErrors(const SharedVector& errors, const Dataset& data) {
  const auto is_measured = [](const ObservationBlock& block, Eigen::Index i) {
    return block.kind == MeasurementKind::kPose &&
           block.sigmas.col(i).tail<3>().array().isFinite().any();
  };
  Eigen::Index count = 0;
  ForEachObservation(
      data, [&](const ObservationBlock& block, Eigen::Index i, Eigen::Index) {
        if (is_measured(block, i)) ++count;
      });
  VectorBuilder norms(count);
  double* norm = norms.map().data();
  ForEachObservation(data, [&](const ObservationBlock& block, Eigen::Index i,
                               Eigen::Index first) {
    if (!is_measured(block, i)) return;
    *norm++ = errors.map().segment<3>(first + 3).norm();
  });
  return norms.Freeze();
}

Eigen::VectorXi Dimensions(const Dataset& data) {
  Eigen::VectorXi dimensions(data.num_observations());
  Eigen::Index count = 0;
  ForEachObservation(
      data, [&](const ObservationBlock& block, Eigen::Index i, Eigen::Index) {
        dimensions[count++] = block.Dimension(i);
      });
  return dimensions;
}

std::vector<Eigen::Index> FirstObservations(const Dataset& data) {
  std::vector<Eigen::Index> first = {0};
  for (const ObservationBlock& block : data.blocks) {
    first.push_back(first.back() + block.size());
  }
  return first;
}

void ForEachObservation(const MeasurementModel& model,
                        const Eigen::VectorXd& values, const Dataset& data,
                        const std::vector<int>& columns,
                        const VisitRows& visit) {
  Tiles tiles(model.nominal(), data, 0);
  const kernel::Columns wanted(model.layout(), columns);
  kernel::Constants constants;
  kernel::ComputeConstants(model.nominal(), model.references(), model.layout(),
                           values, &constants);
  const std::vector<Eigen::Index> first = FirstObservations(data);
  const std::int64_t part_size =
      std::max<std::int64_t>(1, (tiles.size() + kRowParts - 1) / kRowParts);
  const auto work = [&](std::int64_t begin, std::int64_t end) {
    TileRows rows(&tiles, model.layout().num_joints(),
                  static_cast<int>(columns.size()));
    Eigen::MatrixXd out;
    for (std::int64_t tile = begin; tile < end; ++tile) {
      rows.Evaluate(constants, wanted, tile);
      for (int lane = 0; lane < rows.tile().count; ++lane) {
        CopyLane(&rows, lane, &out);
        visit(static_cast<int>(begin / part_size),
              first[rows.tile().block] + tiles.Observation(tile, lane), out);
      }
    }
  };
  ParallelFor(model.num_threads(), tiles.size(), part_size, work);
}

}  // namespace alidade::internal
