// What the vector sources have in common, compiled once for each instruction
// set of each of them: include after foreach_target.h, between no namespaces.
#if defined(ALIDADE_SRC_MEASUREMENT_VECTORS_INL_H_) == \
    defined(HWY_TARGET_TOGGLE)
#ifdef ALIDADE_SRC_MEASUREMENT_VECTORS_INL_H_
#undef ALIDADE_SRC_MEASUREMENT_VECTORS_INL_H_
#else
#define ALIDADE_SRC_MEASUREMENT_VECTORS_INL_H_
#endif

#include <hwy/highway.h>

#include "src/kernel/kernel_targets.h"

HWY_BEFORE_NAMESPACE();
namespace alidade::internal::kernel::HWY_NAMESPACE {
// Each source has its own of each instruction set.
namespace {  // NOLINT(google-build-namespaces)

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::CappedTag<double, kMostLanes>;
using V = hn::Vec<D>;
constexpr D kTag;

}  // namespace
}  // namespace alidade::internal::kernel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // include guard of each instruction set
