#include "tests/support/cost_evaluation.h"

namespace alidade::internal::testing {

CostEvaluation EvaluateCost(const ObservationCost& cost,
                            const ParameterLayout& layout,
                            const Eigen::VectorXd& values) {
  using RowMajor =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const int rows = cost.function->num_residuals();
  std::vector<const double*> parameters;
  std::vector<std::vector<double>> derivatives;
  std::vector<double*> pointers;
  for (std::size_t b = 0; b < cost.blocks.size(); ++b) {
    const ParameterBlock& block = layout.blocks()[cost.blocks[b]];
    EXPECT_EQ(cost.function->parameter_block_sizes()[b], block.size);
    parameters.push_back(values.data() + block.first_column);
    derivatives.emplace_back(rows * block.size);
  }
  for (std::vector<double>& derivative : derivatives) {
    pointers.push_back(derivative.data());
  }
  CostEvaluation evaluation;
  evaluation.residuals.resize(rows);
  evaluation.jacobian.setZero(rows, layout.size());
  EXPECT_TRUE(cost.function->Evaluate(
      parameters.data(), evaluation.residuals.data(), pointers.data()));
  for (std::size_t b = 0; b < cost.blocks.size(); ++b) {
    const ParameterBlock& block = layout.blocks()[cost.blocks[b]];
    evaluation.jacobian.middleCols(block.first_column, block.size) =
        Eigen::Map<const RowMajor>(pointers[b], rows, block.size);
  }
  return evaluation;
}

}  // namespace alidade::internal::testing
