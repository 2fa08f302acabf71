#ifndef ALIDADE_SRC_COMMON_EIGEN_INSTANCES_H_
#define ALIDADE_SRC_COMMON_EIGEN_INSTANCES_H_

// Eigen's decompositions and products of dynamic matrices of doubles, compiled
// once in eigen_instances.cc. Each source that solves a system would compile
// them again otherwise, which takes the compiler up to 20 seconds of 25; the
// precompiled headers include this one, so that no source has to.

#include <Eigen/Dense>

namespace alidade::internal {

using InstanceMatrix = Eigen::MatrixXd;
using InstanceVector = Eigen::VectorXd;
using InstanceSequence =
    Eigen::HouseholderSequence<InstanceMatrix, InstanceVector, 1>;

}  // namespace alidade::internal

// Numbers are Eigen's: 0 is stored by columns, 1 by rows, the last a stride.
// NOLINTBEGIN(bugprone-macro-parentheses): the argument is a declaration's
// first word.
// clang-format off
#define ALIDADE_EIGEN_INSTANCES(TEMPLATE)                                      \
  namespace Eigen {                                                            \
  using ::alidade::internal::InstanceMatrix;                                   \
  using ::alidade::internal::InstanceVector;                                   \
  using ::alidade::internal::InstanceSequence;                                 \
  TEMPLATE class LLT<InstanceMatrix>;                                          \
  TEMPLATE LLT<InstanceMatrix>& LLT<InstanceMatrix>::compute(                  \
      const EigenBase<InstanceMatrix>&);                                       \
  TEMPLATE void LLT<InstanceMatrix>::_solve_impl(                              \
      const InstanceVector&, InstanceVector&) const;                           \
  TEMPLATE void LLT<InstanceMatrix>::_solve_impl(                              \
      const InstanceMatrix&, InstanceMatrix&) const;                           \
  TEMPLATE class LDLT<InstanceMatrix>;                                         \
  TEMPLATE LDLT<InstanceMatrix>& LDLT<InstanceMatrix>::compute(                \
      const EigenBase<InstanceMatrix>&);                                       \
  TEMPLATE void LDLT<InstanceMatrix>::_solve_impl_transposed<true>(            \
      const InstanceVector&, InstanceVector&) const;                           \
  TEMPLATE void LDLT<InstanceMatrix>::_solve_impl_transposed<true>(            \
      const InstanceMatrix&, InstanceMatrix&) const;                           \
  TEMPLATE class HouseholderQR<InstanceMatrix>;                                \
  TEMPLATE void HouseholderQR<InstanceMatrix>::_solve_impl(                    \
      const InstanceVector&, InstanceVector&) const;                           \
  TEMPLATE class ColPivHouseholderQR<InstanceMatrix>;                          \
  TEMPLATE ColPivHouseholderQR<InstanceMatrix>&                                \
  ColPivHouseholderQR<InstanceMatrix>::compute(                                \
      const EigenBase<InstanceMatrix>&);                                       \
  TEMPLATE void ColPivHouseholderQR<InstanceMatrix>::_solve_impl(              \
      const InstanceVector&, InstanceVector&) const;                           \
  TEMPLATE void ColPivHouseholderQR<InstanceMatrix>::_solve_impl(              \
      const InstanceMatrix&, InstanceMatrix&) const;                           \
  TEMPLATE class HouseholderSequence<InstanceMatrix, InstanceVector, 1>;       \
  TEMPLATE void InstanceSequence::applyThisOnTheLeft(InstanceVector&, bool)    \
      const;                                                                   \
  TEMPLATE void InstanceSequence::applyThisOnTheLeft(InstanceMatrix&, bool)    \
      const;                                                                   \
  TEMPLATE void InstanceSequence::evalTo(InstanceMatrix&) const;               \
  TEMPLATE class PartialPivLU<InstanceMatrix>;                                 \
  TEMPLATE class FullPivLU<InstanceMatrix>;                                    \
  TEMPLATE class SelfAdjointEigenSolver<InstanceMatrix>;                       \
  TEMPLATE SelfAdjointEigenSolver<InstanceMatrix>&                             \
  SelfAdjointEigenSolver<InstanceMatrix>::compute(                             \
      const EigenBase<InstanceMatrix>&, int);                                  \
  TEMPLATE class JacobiSVD<Matrix3d>;                                          \
  TEMPLATE class JacobiSVD<InstanceMatrix>;                                    \
  namespace internal {                                                         \
  TEMPLATE struct general_matrix_matrix_product<                               \
      Index, double, 0, false, double, 0, false, 0, 1>;                        \
  TEMPLATE struct general_matrix_matrix_product<                               \
      Index, double, 1, false, double, 0, false, 0, 1>;                        \
  TEMPLATE struct general_matrix_matrix_product<                               \
      Index, double, 0, false, double, 1, false, 0, 1>;                        \
  TEMPLATE struct general_matrix_matrix_product<                               \
      Index, double, 1, false, double, 1, false, 0, 1>;                        \
  TEMPLATE struct triangular_solve_matrix<                                     \
      double, Index, OnTheLeft, Lower, false, 0, 0, 1>;                        \
  TEMPLATE struct triangular_solve_matrix<                                     \
      double, Index, OnTheLeft, Upper, false, 0, 0, 1>;                        \
  TEMPLATE struct triangular_solve_matrix<                                     \
      double, Index, OnTheLeft, Upper, false, 1, 0, 1>;                        \
  TEMPLATE struct triangular_solve_matrix<                                     \
      double, Index, OnTheLeft, UnitLower, false, 0, 0, 1>;                    \
  }                                                                            \
  }
// clang-format on
// NOLINTEND(bugprone-macro-parentheses)

ALIDADE_EIGEN_INSTANCES(extern template)

#endif  // ALIDADE_SRC_COMMON_EIGEN_INSTANCES_H_
