#include "alidade/measurement/position_model.h"

#include <limits>
#include <utility>

#include "alidade/base/parallel.h"
#include "alidade/measurement/geometric_jacobian.h"
#include "alidade/model/forward_kinematics.h"

namespace alidade {
namespace {

// Small enough to balance threads, large enough that a thread's start does not
// show.
constexpr int kPosesPerBlock = 256;

}  // namespace

PositionModel::PositionModel(Arm nominal, int num_threads)
    : nominal_(std::move(nominal)),
      layout_(nominal_.num_joints()),
      num_threads_(num_threads) {}

Eigen::Matrix3Xd PositionModel::Predict(
    const Eigen::VectorXd& values, const Eigen::MatrixXd& joint_values) const {
  const GeometryView<double> geometry = ViewOf(layout_, values.data());
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

Eigen::Matrix3Xd PositionModel::Errors(const Eigen::VectorXd& values,
                                       const Dataset& data) const {
  return Predict(values, data.joint_values) - data.positions;
}

void PositionModel::Linearize(const Eigen::VectorXd& values,
                              const Dataset& data,
                              const std::vector<int>& columns,
                              Linearization* out) const {
  const Eigen::Matrix3Xd errors = Errors(values, data);
  out->residuals.resize(data.num_rows());
  out->jacobian.resize(data.num_rows(),
                       static_cast<Eigen::Index>(columns.size()));
  const auto fill = [&](std::int64_t begin, std::int64_t end) {
    GeometricJacobian jacobian(nominal_, layout_, values);
    for (Eigen::Index i = begin; i < end; ++i) {
      const Eigen::Array3d sigma = data.sigmas.col(i);
      out->residuals.segment<3>(3 * i) = errors.col(i).array() / sigma;
      auto rows = out->jacobian.middleRows<3>(3 * i);
      jacobian.Evaluate(data.joint_values.col(i).data(), columns,
                        MeasurementKind::kPosition, rows);
      rows.array().colwise() /= sigma;
    }
  };
  ParallelFor(num_threads_, data.num_poses(), kPosesPerBlock, fill);
}

double PositionModel::RoundingError() const {
  return std::numeric_limits<double>::epsilon() * Reach(nominal_);
}

Eigen::VectorXd SquaredNorms(const Eigen::Matrix3Xd& errors,
                             const Dataset& data) {
  return (errors.array() / data.sigmas.array())
      .square()
      .colwise()
      .sum()
      .transpose();
}

double ChiSquare(const Eigen::Matrix3Xd& errors, const Dataset& data) {
  return (errors.array() / data.sigmas.array()).square().sum();
}

}  // namespace alidade
