#ifndef ALIDADE_SRC_KERNEL_KERNEL_TARGETS_H_
#define ALIDADE_SRC_KERNEL_KERNEL_TARGETS_H_

// Which instruction sets the vector sources are compiled for; include before
// any header of Highway. Left out: those that bring doubles nothing over the
// next smaller one (SSSE3, AVX3_DL), and vectors of unknown length, which
// cannot be members of a class (SVE, RVV).
#define HWY_DISABLED_TARGETS                                                   \
  (HWY_SSSE3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | \
   HWY_RVV)

#include <cstddef>

namespace alidade::internal::kernel {

/// Lanes of the longest vectors of doubles that the kernels use.
constexpr std::size_t kMostLanes = 8;

}  // namespace alidade::internal::kernel

#endif  // ALIDADE_SRC_KERNEL_KERNEL_TARGETS_H_
