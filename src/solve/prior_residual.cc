#include "src/solve/prior_residual.h"

#include <algorithm>
#include <utility>

namespace alidade::internal {

PriorResidual::PriorResidual(int block_size, std::vector<Entry> entries)
    : entries_(std::move(entries)) {
  mutable_parameter_block_sizes()->push_back(block_size);
  set_num_residuals(static_cast<int>(entries_.size()));
}

bool PriorResidual::Evaluate(double const* const* parameters, double* residuals,
                             double** jacobians) const {
  const int size = parameter_block_sizes()[0];
  const bool wants_jacobian = jacobians != nullptr && jacobians[0] != nullptr;
  if (wants_jacobian) {
    std::fill_n(jacobians[0], num_residuals() * size, 0.0);
  }
  for (std::size_t k = 0; k < entries_.size(); ++k) {
    const Entry& entry = entries_[k];
    residuals[k] = (parameters[0][entry.index] - entry.nominal) / entry.prior;
    if (wants_jacobian) {
      jacobians[0][k * size + entry.index] = 1.0 / entry.prior;
    }
  }
  return true;
}

}  // namespace alidade::internal
