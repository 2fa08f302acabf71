#include "src/kernel/kernel_targets.h"
//
#include <algorithm>
#include <cmath>

#include "src/kernel/aligned.h"
#include "src/kernel/sine.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/kernel/sine.cc"
#include <hwy/foreach_target.h>
//
#include "src/kernel/vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace alidade::internal::kernel::HWY_NAMESPACE {
namespace {

HWY_INLINE V Broadcast(double value) { return hn::Set(kTag, value); }

// Taylor's polynomials in z = y^2 for |y| <= pi / 4, without the terms that
// follow by themselves: what they leave out is below 1e-19.
HWY_INLINE V SineTail(V z) {
  V sum = Broadcast(1.0 / 355687428096000.0);  // 1 / 17!
  sum = hn::MulAdd(sum, z, Broadcast(-1.0 / 1307674368000.0));
  sum = hn::MulAdd(sum, z, Broadcast(1.0 / 6227020800.0));
  sum = hn::MulAdd(sum, z, Broadcast(-1.0 / 39916800.0));
  sum = hn::MulAdd(sum, z, Broadcast(1.0 / 362880.0));
  sum = hn::MulAdd(sum, z, Broadcast(-1.0 / 5040.0));
  sum = hn::MulAdd(sum, z, Broadcast(1.0 / 120.0));
  return hn::MulAdd(sum, z, Broadcast(-1.0 / 6.0));
}

HWY_INLINE V CosineTail(V z) {
  V sum = Broadcast(-1.0 / 6402373705728000.0);  // 1 / 18!
  sum = hn::MulAdd(sum, z, Broadcast(1.0 / 20922789888000.0));
  sum = hn::MulAdd(sum, z, Broadcast(-1.0 / 87178291200.0));
  sum = hn::MulAdd(sum, z, Broadcast(1.0 / 479001600.0));
  sum = hn::MulAdd(sum, z, Broadcast(-1.0 / 3628800.0));
  sum = hn::MulAdd(sum, z, Broadcast(1.0 / 40320.0));
  sum = hn::MulAdd(sum, z, Broadcast(-1.0 / 720.0));
  return hn::MulAdd(sum, z, Broadcast(1.0 / 24.0));
}

// The argument less its multiple n of pi / 2 (Cody and Waite 1980, "Software
// Manual for the Elementary Functions"), in two parts: pi / 2 is taken away in
// pieces of 33 bits, whose products with n are exact up to n = 2^20.
HWY_INLINE void SineAndCosineOf(V x, V* sine, V* cosine) {
  const V n = hn::Round(hn::Mul(x, Broadcast(0x1.45f306dc9c883p-1)));
  const V first = hn::Sub(x, hn::Mul(n, Broadcast(0x1.921fb544p+0)));
  const V piece = hn::Mul(n, Broadcast(0x1.0b4611a626331p-34));
  const V y = hn::Sub(first, piece);
  const V rest = hn::Sub(hn::Sub(first, y), piece);
  const V z = hn::Mul(y, y);
  const V half = hn::Mul(Broadcast(0.5), z);
  const V one = Broadcast(1.0);
  // sin(y + rest) = y + (y^3 tail + rest (1 - z / 2))
  const V s = hn::Add(y, hn::MulAdd(hn::Mul(z, y), SineTail(z),
                                    hn::Mul(rest, hn::Sub(one, half))));
  // cos(y + rest) = w + ((1 - w) - z / 2 + z^2 tail - y rest), w = 1 - z / 2
  const V w = hn::Sub(one, half);
  const V lost = hn::Sub(hn::Sub(one, w), half);
  const V c = hn::Add(w, hn::Add(lost, hn::MulSub(hn::Mul(z, z), CosineTail(z),
                                                  hn::Mul(y, rest))));
  // The quadrant, 0 to 3.
  const V quadrant =
      hn::NegMulAdd(Broadcast(4.0), hn::Floor(hn::Mul(n, Broadcast(0.25))), n);
  const auto is_first = hn::Eq(quadrant, one);
  const auto is_third = hn::Eq(quadrant, Broadcast(3.0));
  const auto is_second = hn::Eq(quadrant, Broadcast(2.0));
  const auto swaps = hn::Or(is_first, is_third);
  const V swapped_sine = hn::IfThenElse(swaps, c, s);
  const V swapped_cosine = hn::IfThenElse(swaps, s, c);
  *sine = hn::IfThenElse(hn::Or(is_second, is_third), hn::Neg(swapped_sine),
                         swapped_sine);
  *cosine = hn::IfThenElse(hn::Or(is_first, is_second), hn::Neg(swapped_cosine),
                           swapped_cosine);
}

void SineAndCosine(double* angles, double* cosines) {
  for (int t = 0; t < kTile; t += static_cast<int>(hn::Lanes(kTag))) {
    const V x = hn::Load(kTag, angles + t);
    V sine;
    V cosine;
    SineAndCosineOf(x, &sine, &cosine);
    hn::Store(sine, kTag, angles + t);
    hn::Store(cosine, kTag, cosines + t);
  }
}

}  // namespace
}  // namespace alidade::internal::kernel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace alidade::internal::kernel {

HWY_EXPORT(SineAndCosine);

void SineAndCosine(double* angles, double* cosines) {
  // Beyond, the vector code would lose digits.
  constexpr double kLargest = 1e5;
  double largest = 0.0;
  for (int t = 0; t < kTile; ++t) {
    largest = std::max(largest, std::abs(angles[t]));
  }
  if (largest <= kLargest) {
    HWY_DYNAMIC_DISPATCH(SineAndCosine)(angles, cosines);
    return;
  }
  for (int t = 0; t < kTile; ++t) {
    cosines[t] = std::cos(angles[t]);
    angles[t] = std::sin(angles[t]);
  }
}

}  // namespace alidade::internal::kernel
#endif  // HWY_ONCE
