#ifndef ALIDADE_TESTS_SUPPORT_COST_EVALUATION_H_
#define ALIDADE_TESTS_SUPPORT_COST_EVALUATION_H_

#include <ceres/cost_function.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "alidade/parameter_layout.h"
#include "src/kernel/observation_cost.h"

namespace alidade::internal::testing {

/// An autodiff residual with its derivatives by the columns of the layout;
/// zero by those that it does not have.
struct CostEvaluation {
  Eigen::VectorXd residuals;
  Eigen::MatrixXd jacobian;
};

CostEvaluation EvaluateCost(const ObservationCost& cost,
                            const ParameterLayout& layout,
                            const Eigen::VectorXd& values);

}  // namespace alidade::internal::testing

#endif  // ALIDADE_TESTS_SUPPORT_COST_EVALUATION_H_
