#ifndef ALIDADE_SRC_COMMON_RANDOM_H_
#define ALIDADE_SRC_COMMON_RANDOM_H_

#include <array>
#include <cstdint>

namespace alidade::internal {

/// xoshiro256++ (Blackman, Vigna 2021, "Scrambled linear pseudorandom number
/// generators"), its state filled by SplitMix64 from (seed, stream).
///
/// The engine and the transforms below are our own choice because those of
/// the standard library differ between implementations: the same seed gives
/// the same numbers on every machine (Normal up to the rounding of log).
/// Streams of one seed are independent for every practical purpose, so that
/// trial k of a study draws the same numbers whatever thread runs it.
class Random {
 public:
  explicit Random(std::uint64_t seed, std::uint64_t stream = 0);

  std::uint64_t Next();
  /// Uniform in [0, 1), 53 random bits.
  double Uniform();
  /// Uniform in [lower, upper). @pre lower <= upper, both finite.
  double Uniform(double lower, double upper);
  /// Standard normal, by Marsaglia's polar method.
  double Normal();

 private:
  std::array<std::uint64_t, 4> state_;
  double spare_normal_ = 0.0;
  bool has_spare_normal_ = false;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_COMMON_RANDOM_H_
