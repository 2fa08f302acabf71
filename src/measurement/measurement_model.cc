#include "alidade/measurement/measurement_model.h"

#include <cmath>
#include <limits>
#include <utility>

#include "alidade/base/parallel.h"
#include "alidade/measurement/observation_rows.h"
#include "alidade/model/forward_kinematics.h"
#include "observation_residual.h"

namespace alidade {
namespace {

// Small enough to balance threads, large enough that a thread's start does not
// show.
constexpr int kPosesPerBlock = 256;

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

// The residual of observation i of a block; rows that were not measured are
// zero.
void FillError(const MeasurementModel& model, const Eigen::VectorXd& values,
               const Dataset& data, const ObservationBlock& block,
               Eigen::Index i, Eigen::Ref<Eigen::VectorXd> error) {
  const ObservationResidual residual(model, data, block, i);
  residual.Evaluate<double>(
      ViewOf(model.layout(), values.data(), block.target(i)),
      residual.ReferencesIn(values), error.data());
  for (Eigen::Index row = 0; row < error.size(); ++row) {
    if (std::isinf(block.sigmas(row, i))) error[row] = 0.0;
  }
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

}  // namespace

MeasurementModel::MeasurementModel(Arm nominal, References references,
                                   int num_threads)
    : nominal_(std::move(nominal)),
      references_(std::move(references)),
      layout_(ShapeOf(nominal_, references_)),
      num_threads_(num_threads) {}

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
                                           const Eigen::MatrixXd& joint_values,
                                           int target) const {
  const GeometryView<double> geometry = ViewOf(layout_, values.data(), target);
  Eigen::Matrix3Xd predicted(3, joint_values.cols());
  ParallelFor(num_threads_, joint_values.cols(), kPosesPerBlock,
              [&](std::int64_t begin, std::int64_t end) {
                for (Eigen::Index i = begin; i < end; ++i) {
                  predicted.col(i) = TargetPosition(nominal_, geometry,
                                                    joint_values.col(i).data());
                }
              });
  return predicted;
}

Eigen::VectorXd MeasurementModel::Errors(const Eigen::VectorXd& values,
                                         const Dataset& data) const {
  Eigen::VectorXd errors(data.num_rows());
  Eigen::Index row = 0;
  for (const ObservationBlock& block : data.blocks) {
    const int height = block.rows_each();
    ParallelFor(num_threads_, block.size(), kPosesPerBlock,
                [&](std::int64_t begin, std::int64_t end) {
                  for (Eigen::Index i = begin; i < end; ++i) {
                    FillError(*this, values, data, block, i,
                              errors.segment(row + i * height, height));
                  }
                });
    row += block.size() * height;
  }
  return errors;
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

Eigen::VectorXd SquaredNorms(const Eigen::VectorXd& errors,
                             const Dataset& data) {
  Eigen::VectorXd whitened = errors;
  Eigen::Index row = 0;
  for (const ObservationBlock& block : data.blocks) {
    const Eigen::Index size = block.size() * block.rows_each();
    Whiten(block, 0, block.size(), whitened.segment(row, size));
    row += size;
  }
  Eigen::VectorXd norms(data.num_observations());
  Eigen::Index count = 0;
  ForEachObservation(data, [&](const ObservationBlock& block, Eigen::Index,
                               Eigen::Index first) {
    norms[count++] = whitened.segment(first, block.rows_each()).squaredNorm();
  });
  return norms;
}

double ChiSquare(const Eigen::VectorXd& errors, const Dataset& data) {
  return SquaredNorms(errors, data).sum();
}

Eigen::VectorXd LengthErrors(const Eigen::VectorXd& errors,
                             const Dataset& data) {
  Eigen::VectorXd norms(data.num_observations());
  Eigen::Index count = 0;
  ForEachObservation(data, [&](const ObservationBlock& block, Eigen::Index,
                               Eigen::Index first) {
    const int height = std::min(3, block.rows_each());
    norms[count++] = errors.segment(first, height).norm();
  });
  return norms;
}

Eigen::VectorXd RotationErrors(const Eigen::VectorXd& errors,
                               const Dataset& data) {
  std::vector<double> norms;
  ForEachObservation(data, [&](const ObservationBlock& block, Eigen::Index i,
                               Eigen::Index first) {
    if (block.kind != MeasurementKind::kPose) return;
    if (!block.sigmas.col(i).tail<3>().array().isFinite().any()) return;
    norms.push_back(errors.segment<3>(first + 3).norm());
  });
  return Eigen::Map<const Eigen::VectorXd>(
      norms.data(), static_cast<Eigen::Index>(norms.size()));
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

}  // namespace alidade
