#ifndef ALIDADE_SRC_KERNEL_SINE_H_
#define ALIDADE_SRC_KERNEL_SINE_H_

namespace alidade::internal::kernel {

/// kTile sines and cosines (aligned.h): `angles` (rad) becomes their sines.
/// Errors are below 1.2 * 2^-53 for angles up to 1e5 rad; where one is larger,
/// all are taken by the C library. Both arrays are aligned to 64 bytes.
void SineAndCosine(double* angles, double* cosines);

}  // namespace alidade::internal::kernel

#endif  // ALIDADE_SRC_KERNEL_SINE_H_
