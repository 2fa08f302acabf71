#ifndef ALIDADE_SRC_SOLVE_PRIOR_RESIDUAL_H_
#define ALIDADE_SRC_SOLVE_PRIOR_RESIDUAL_H_

#include <ceres/cost_function.h>

#include <vector>

namespace alidade::internal {

/// (value - nominal) / prior for some entries of one parameter block.
class PriorResidual : public ceres::CostFunction {
 public:
  struct Entry {
    int index;  ///< in the block
    double nominal;
    double prior;
  };

  PriorResidual(int block_size, std::vector<Entry> entries);

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  std::vector<Entry> entries_;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SOLVE_PRIOR_RESIDUAL_H_
