#include "alidade/shared_matrix.h"

#include <cstddef>

#include "src/common/memory.h"

namespace alidade {

template <typename Plain>
BasicSharedMatrix<Plain> BasicSharedMatrix<Plain>::Repeated(
    const Eigen::VectorXd& column, Index count) {
  const auto rows = static_cast<std::size_t>(column.size());
  return {internal::RepeatLarge(column.data(), rows,
                                static_cast<std::size_t>(count)),
          column.size(), count, column.size()};
}

template <typename Plain>
BasicMatrixBuilder<Plain>::BasicMatrixBuilder(Index rows, Index cols)
    : first_(internal::AllocateLarge(static_cast<std::size_t>(rows * cols))),
      rows_(rows),
      cols_(cols) {}

template class BasicSharedMatrix<Eigen::MatrixXd>;
template class BasicMatrixBuilder<Eigen::MatrixXd>;
template class BasicMatrixBuilder<Eigen::VectorXd>;

}  // namespace alidade
