#include "bench/analytic_ceres.h"

#include <ceres/ceres.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "src/model/chain_axes.h"

namespace alidade::internal::bench {
namespace {

// What all residuals of a problem use, one after the other: Ceres has one
// thread.
struct Shared {
  const CalibrationProblem& problem;
  Arm arm;
  ChainAxes axes;
};

class PoseResidual : public ceres::CostFunction {
 public:
  PoseResidual(Shared* shared, Eigen::Index pose)
      : shared_(*shared), pose_(pose) {
    set_num_residuals(3);
    mutable_parameter_block_sizes()->push_back(
        static_cast<int>(shared_.problem.free_columns.size()));
  }

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    const CalibrationProblem& problem = shared_.problem;
    const ParameterLayout& layout = problem.model.layout();
    const std::vector<int>& columns = problem.free_columns;
    Arm& arm = shared_.arm;
    ChainAxes& axes = shared_.axes;
    for (std::size_t k = 0; k < columns.size(); ++k) {
      const Parameter& parameter = layout.parameter(columns[k]);
      Joint& joint = arm.joints[parameter.index];
      const double value = parameters[0][k];
      switch (parameter.kind) {
        case ParameterKind::kBeta:
          joint.beta = value;
          break;
        case ParameterKind::kAlpha:
          joint.alpha = value;
          break;
        case ParameterKind::kD:
          joint.d = value;
          break;
        case ParameterKind::kTheta:
          joint.theta = value;
          break;
        default:
          joint.r = value;
      }
    }
    const Dataset& data = problem.data;
    ComputeChainAxes(arm, data.joint_values.col(pose_).data(), &axes);
    const Eigen::Vector3d p = axes.instrument_from_target.translation();
    const Eigen::Array3d sigma = data.sigmas().col(pose_);
    Eigen::Map<Eigen::Array3d>{residuals} =
        (p - data.positions().col(pose_)).array() / sigma;
    if (jacobians == nullptr || jacobians[0] == nullptr) return true;
    const auto size = static_cast<Eigen::Index>(columns.size());
    Eigen::Map<Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor>>
        jacobian(jacobians[0], 3, size);
    for (Eigen::Index k = 0; k < size; ++k) {
      jacobian.col(k) =
          Derivative(layout.parameter(columns[k]), axes, p).array() / sigma;
    }
    return true;
  }

 private:
  static Eigen::Vector3d Derivative(const Parameter& parameter,
                                    const ChainAxes& axes,
                                    const Eigen::Vector3d& p) {
    const int j = parameter.index;
    switch (parameter.kind) {
      case ParameterKind::kBeta:
        return axes.beta_axis.col(j).cross(p - axes.origin_before.col(j));
      case ParameterKind::kAlpha:
        return axes.alpha_axis.col(j).cross(p - axes.origin_before.col(j));
      case ParameterKind::kD:
        return axes.alpha_axis.col(j);
      case ParameterKind::kTheta:
        return axes.joint_axis.col(j).cross(p - axes.origin_on_axis.col(j));
      default:
        return axes.joint_axis.col(j);
    }
  }

  Shared& shared_;
  const Eigen::Index pose_;
};

// Stops where SolveLevenbergMarquardt does: a step that is predicted to lower
// the cost by less than the function tolerance.
class StopByPrediction : public ceres::IterationCallback {
 public:
  explicit StopByPrediction(double tolerance) : tolerance_(tolerance) {}

  ceres::CallbackReturnType operator()(
      const ceres::IterationSummary& iteration) override {
    if (iteration.iteration == 0 || !iteration.step_is_valid) {
      return ceres::SOLVER_CONTINUE;
    }
    const double predicted =
        iteration.relative_decrease == 0.0
            ? 0.0
            : iteration.cost_change / iteration.relative_decrease;
    return predicted <= tolerance_ * iteration.cost
               ? ceres::SOLVER_TERMINATE_SUCCESSFULLY
               : ceres::SOLVER_CONTINUE;
  }

 private:
  const double tolerance_;
};

}  // namespace

double SolveAnalytic(const CalibrationProblem& problem,
                     const SolverOptions& options, Eigen::VectorXd* values,
                     int* iterations) {
  Shared shared{problem, problem.model.nominal(), {}};
  std::vector<double> free;
  for (const int column : problem.free_columns) {
    CHECK(ParameterLayout::IsJointKind(
        problem.model.layout().parameter(column).kind));
    free.push_back((*values)[column]);
  }
  ceres::Problem ceres_problem;
  for (Eigen::Index i = 0; i < problem.data.num_poses(); ++i) {
    ceres_problem.AddResidualBlock(new PoseResidual(&shared, i), nullptr,
                                   free.data());
  }
  ceres::Solver::Options ceres_options;
  ceres_options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  ceres_options.num_threads = 1;
  ceres_options.logging_type = ceres::SILENT;
  ceres_options.max_num_iterations = options.max_iterations;
  ceres_options.initial_trust_region_radius =
      options.initial_trust_region_radius;
  ceres_options.max_trust_region_radius =
      std::max(ceres_options.max_trust_region_radius,
               options.initial_trust_region_radius);
  ceres_options.function_tolerance = 0.0;
  ceres_options.gradient_tolerance = 0.0;
  ceres_options.parameter_tolerance = 0.0;
  StopByPrediction stop(options.function_tolerance);
  ceres_options.callbacks.push_back(&stop);
  ceres::Solver::Summary summary;
  ceres::Solve(ceres_options, &ceres_problem, &summary);
  for (std::size_t k = 0; k < free.size(); ++k) {
    (*values)[problem.free_columns[k]] = free[k];
  }
  *iterations = static_cast<int>(summary.iterations.size()) - 1;
  return 2.0 * summary.final_cost;
}

}  // namespace alidade::internal::bench
