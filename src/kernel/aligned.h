#ifndef ALIDADE_SRC_KERNEL_ALIGNED_H_
#define ALIDADE_SRC_KERNEL_ALIGNED_H_

#include <hwy/aligned_allocator.h>

#include <algorithm>
#include <cstddef>
#include <new>

namespace alidade::internal {

/// Observations that the batched kernel takes at once: a multiple of every
/// vector length, and few enough for their rows to stay in the first-level
/// cache.
constexpr int kTile = 64;

/// Doubles at an address that vectors of any length may be loaded from.
using AlignedDoubles = hwy::AlignedFreeUniquePtr<double[]>;

/// Not initialised. Throws std::bad_alloc.
inline AlignedDoubles AllocateDoubles(std::size_t count) {
  AlignedDoubles doubles =
      hwy::AllocateAligned<double>(std::max<std::size_t>(count, 1));
  if (doubles == nullptr) throw std::bad_alloc();
  return doubles;
}

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_KERNEL_ALIGNED_H_
