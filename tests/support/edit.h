#ifndef ALIDADE_TESTS_SUPPORT_EDIT_H_
#define ALIDADE_TESTS_SUPPORT_EDIT_H_

#include <utility>

#include "alidade/shared_matrix.h"

namespace alidade::internal::testing {

/// A copy of a shared matrix to change, which replaces it at the end of its
/// life.
template <typename Plain>
class Edited {
 public:
  explicit Edited(BasicSharedMatrix<Plain>* matrix)
      : matrix_(matrix), numbers_(matrix->map()) {}
  ~Edited() { *matrix_ = std::move(numbers_); }
  Edited(const Edited&) = delete;
  Edited& operator=(const Edited&) = delete;

  Plain& operator*() { return numbers_; }
  Plain* operator->() { return &numbers_; }
  double& at(Eigen::Index row, Eigen::Index col) { return numbers_(row, col); }

 private:
  BasicSharedMatrix<Plain>* const matrix_;
  Plain numbers_;
};

/// Changes numbers within a statement, as in Edit(&data.positions()).at(1, 7) =
/// 0.5, or as long as the returned object is there.
template <typename Plain>
Edited<Plain> Edit(BasicSharedMatrix<Plain>* matrix) {
  return Edited<Plain>(matrix);
}

}  // namespace alidade::internal::testing

#endif  // ALIDADE_TESTS_SUPPORT_EDIT_H_
