#include "alidade/measurement/position_model.h"

#include <cmath>
#include <limits>
#include <utility>

#include "alidade/base/parallel.h"
#include "alidade/model/chain_axes.h"
#include "alidade/model/forward_kinematics.h"

namespace alidade {
namespace {

// Small enough to balance threads, large enough that a thread's start does not
// show.
constexpr int kPosesPerBlock = 256;

// How the instrument's point turns when the base's rotation vector changes:
// column k of the left Jacobian of SO(3) is the axis for component k.
// Exp(w + e) = Exp(J e) Exp(w); Chirikjian 2012, "Stochastic Models,
// Information Theory, and Lie Groups 2", eq. 10.86.
Eigen::Matrix3d LeftJacobian(const Eigen::Vector3d& w) {
  const double angle_squared = w.squaredNorm();
  double a = 0.5 - angle_squared / 24.0;
  double b = 1.0 / 6.0 - angle_squared / 120.0;
  if (angle_squared > 1e-8) {
    const double angle = std::sqrt(angle_squared);
    const double half_sine = std::sin(0.5 * angle);
    a = 2.0 * half_sine * half_sine / angle_squared;
    b = (angle - std::sin(angle)) / (angle * angle_squared);
  }
  Eigen::Matrix3d skew;
  skew << 0.0, -w.z(), w.y(), w.z(), 0.0, -w.x(), -w.y(), w.x(), 0.0;
  return Eigen::Matrix3d::Identity() + a * skew + b * skew * skew;
}

// Derivative of the target's position by one parameter.
class PositionDerivative {
 public:
  PositionDerivative(const ParameterLayout& layout,
                     const Eigen::VectorXd& values)
      : layout_(layout),
        base_origin_(values.segment<3>(
            layout.Column(ParameterKind::kBaseTranslation, 0))),
        base_axes_(LeftJacobian(values.segment<3>(
            layout.Column(ParameterKind::kBaseRotation, 0)))) {}

  Eigen::Vector3d operator()(const ChainAxes& axes, int column) const {
    const Parameter& parameter = layout_.parameter(column);
    const int k = parameter.index;
    const Eigen::Vector3d target = axes.instrument_from_target.translation();
    switch (parameter.kind) {
      case ParameterKind::kBeta:
        return axes.beta_axis.col(k).cross(target - axes.origin_before.col(k));
      case ParameterKind::kAlpha:
        return axes.alpha_axis.col(k).cross(target - axes.origin_before.col(k));
      case ParameterKind::kD:
        return axes.alpha_axis.col(k);
      case ParameterKind::kTheta:
        return axes.joint_axis.col(k).cross(target -
                                            axes.origin_on_axis.col(k));
      case ParameterKind::kR:
        return axes.joint_axis.col(k);
      case ParameterKind::kBaseTranslation:
        return Eigen::Vector3d::Unit(k);
      case ParameterKind::kBaseRotation:
        return base_axes_.col(k).cross(target - base_origin_);
      case ParameterKind::kToolTranslation:
        return axes.instrument_from_last.linear().col(k);
      case ParameterKind::kToolRotation:
        break;
    }
    // A rotation of the target about its own origin moves no position.
    return Eigen::Vector3d::Zero();
  }

 private:
  const ParameterLayout& layout_;
  Eigen::Vector3d base_origin_;
  Eigen::Matrix3d base_axes_;
};

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
  const Arm arm = layout_.WithValues(nominal_, values);
  const PositionDerivative derivative(layout_, values);
  const Eigen::Matrix3Xd errors = Errors(values, data);
  out->residuals.resize(data.num_rows());
  out->jacobian.resize(data.num_rows(),
                       static_cast<Eigen::Index>(columns.size()));
  const auto fill = [&](std::int64_t begin, std::int64_t end) {
    ChainAxes axes;
    for (Eigen::Index i = begin; i < end; ++i) {
      const Eigen::Array3d sigma = data.sigmas.col(i);
      out->residuals.segment<3>(3 * i) = errors.col(i).array() / sigma;
      ComputeChainAxes(arm, data.joint_values.col(i).data(), &axes);
      for (Eigen::Index c = 0; c < out->jacobian.cols(); ++c) {
        out->jacobian.block<3, 1>(3 * i, c) =
            derivative(axes, columns[c]).array() / sigma;
      }
    }
  };
  ParallelFor(num_threads_, data.num_poses(), kPosesPerBlock, fill);
}

double PositionModel::RoundingError() const {
  return std::numeric_limits<double>::epsilon() * Reach(nominal_);
}

double ChiSquare(const Eigen::Matrix3Xd& errors, const Dataset& data) {
  return (errors.array() / data.sigmas.array()).square().sum();
}

}  // namespace alidade
