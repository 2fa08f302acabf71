#include "src/common/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <set>
#include <vector>

namespace alidade::internal {
namespace {

constexpr int kNumDraws = 200000;

// Every moment below is the mean of kNumDraws independent terms of known
// variance. Five standard deviations of that mean: a correct generator misses
// it once in 1.7 million seeds, and the seeds are fixed.
double MeanTolerance(double variance_of_term) {
  return 5.0 * std::sqrt(variance_of_term / kNumDraws);
}

template <typename Draw>
std::vector<double> DrawMany(std::uint64_t seed, const Draw& draw) {
  Random random(seed);
  std::vector<double> draws(kNumDraws);
  for (double& value : draws) value = draw(&random);
  return draws;
}

double MeanPower(const std::vector<double>& draws, int power) {
  double sum = 0.0;
  for (const double value : draws) sum += std::pow(value, power);
  return sum / static_cast<double>(draws.size());
}

struct FirstOutputs {
  std::uint64_t seed;
  std::uint64_t stream;
  std::array<std::uint64_t, 5> outputs;
};

// From an implementation in Python (integers of any size), itself checked
// against the published outputs of SplitMix64 (seed 1234567:
// 6457827717110365317, 3203168211198807973 ...) and of xoshiro256++ (state 1,
// 2, 3, 4: 41943041, 58720359, 3588806011781223 ...).
constexpr std::array<FirstOutputs, 4> kFirstOutputs = {{
    {0,
     0,
     {0x84f09bf307c1073a, 0xc82ffb597ceee51b, 0xadf96905c5df4417,
      0xe9d9a8489d042c93, 0xad67db0249c41e0a}},
    {42,
     0,
     {0x5b5e4a1bffcbb2f3, 0xdad6b47570f6111d, 0xaa41d8357b710b2f,
      0xf02f3789cdc59c40, 0x8c560809b160a03d}},
    {42,
     7,
     {0x0d9893fc677d6169, 0x8c202a1a1dd3b94d, 0xb20f071eca7887c8,
      0x092b21a6dc9a40cb, 0xe2b8d1ab27943c3d}},
    {std::numeric_limits<std::uint64_t>::max(),
     1,
     {0xbce569b50056e03b, 0x9c995154e341a43b, 0xe56fa0df136d7b1d,
      0x5c97b5cf2c313d95, 0x60bbb4f07df80f5}},
}};

TEST(RandomTest, FirstOutputsAreThoseOfTheReference) {
  for (const FirstOutputs& expected : kFirstOutputs) {
    Random random(expected.seed, expected.stream);
    for (const std::uint64_t output : expected.outputs) {
      EXPECT_EQ(random.Next(), output)
          << "seed " << expected.seed << ", stream " << expected.stream;
    }
  }
}

TEST(RandomTest, StreamZeroIsTheDefault) {
  Random given(9, 0);
  Random left_out(9);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(given.Next(), left_out.Next());
}

TEST(RandomTest, SeedsAndStreamsAllDiffer) {
  constexpr int kNumSeeds = 30;
  constexpr int kNumStreams = 30;
  std::set<std::uint64_t> first_outputs;
  for (int seed = 0; seed < kNumSeeds; ++seed) {
    for (int stream = 0; stream < kNumStreams; ++stream) {
      first_outputs.insert(Random(seed, stream).Next());
    }
  }
  EXPECT_EQ(first_outputs.size(), kNumSeeds * kNumStreams);
}

TEST(RandomTest, NeighbouringStreamsAreUncorrelated) {
  Random first(5, 0);
  Random second(5, 1);
  double sum = 0.0;
  for (int i = 0; i < kNumDraws; ++i) sum += first.Normal() * second.Normal();
  // The product of two independent standard normals has variance 1.
  EXPECT_NEAR(sum / kNumDraws, 0.0, MeanTolerance(1.0));
}

TEST(RandomTest, UniformTakesTheUpper53Bits) {
  Random random(42);
  EXPECT_EQ(random.Uniform(), 0.35690749343466055);
  EXPECT_EQ(random.Uniform(), 0.8548386370393575);
  EXPECT_EQ(random.Uniform(), 0.6650672083446275);
  EXPECT_EQ(random.Uniform(), 0x1.e05e6f139b8b3p-1);
}

TEST(RandomTest, UniformFillsItsRangeAndNoMore) {
  double smallest = 1.0;
  double largest = 0.0;
  for (const double value :
       DrawMany(1, [](Random* random) { return random->Uniform(); })) {
    ASSERT_GE(value, 0.0);
    ASSERT_LT(value, 1.0);
    smallest = std::min(smallest, value);
    largest = std::max(largest, value);
  }
  // The chance that none of the draws falls below 1e-4 is exp(-20).
  EXPECT_LT(smallest, 1e-4);
  EXPECT_GT(largest, 1.0 - 1e-4);
}

TEST(RandomTest, UniformHasMeanAndVarianceOfTheDistribution) {
  const std::vector<double> centred =
      DrawMany(2, [](Random* random) { return random->Uniform(-1.0, 1.0); });
  // On [-1, 1): E x^2 = 1 / 3, E x^4 = 1 / 5.
  EXPECT_NEAR(MeanPower(centred, 1), 0.0, MeanTolerance(1.0 / 3.0));
  EXPECT_NEAR(MeanPower(centred, 2), 1.0 / 3.0,
              MeanTolerance(1.0 / 5.0 - 1.0 / 9.0));
}

TEST(RandomTest, UniformIsEvenOverItsRange) {
  constexpr int kNumBins = 20;
  std::array<int, kNumBins> counts = {};
  for (const double value :
       DrawMany(3, [](Random* random) { return random->Uniform(); })) {
    ++counts[static_cast<std::size_t>(value * kNumBins)];
  }
  double chi_square = 0.0;
  for (const int count : counts) {
    const double expected = static_cast<double>(kNumDraws) / kNumBins;
    chi_square += (count - expected) * (count - expected) / expected;
  }
  // 19 degrees of freedom: 0.1 % of all seeds lie below 5.4, 0.1 % above 43.8.
  EXPECT_GT(chi_square, 5.4);
  EXPECT_LT(chi_square, 43.8);
}

TEST(RandomTest, UniformOfARangeScalesTheUnitDraw) {
  Random unit(11);
  Random scaled(11);
  for (int i = 0; i < 1000; ++i) {
    const double value = scaled.Uniform(-3.0, 5.0);
    EXPECT_DOUBLE_EQ(value, -3.0 + 8.0 * unit.Uniform());
    EXPECT_GE(value, -3.0);
    EXPECT_LT(value, 5.0);
  }
}

TEST(RandomTest, UniformOfAnEmptyRangeIsItsBound) {
  Random random(12);
  EXPECT_EQ(random.Uniform(2.5, 2.5), 2.5);
}

TEST(RandomTest, FirstNormalsAreThoseOfThePolarMethod) {
  // From the same Python implementation; a unit or two in the last place for
  // the logarithm and the square root.
  const std::array<double, 4> expected = {
      -0.3869422507947611, 0.9595335505724674, 0.1804925674470889,
      0.4791717213237432};
  Random random(42);
  for (const double value : expected) EXPECT_DOUBLE_EQ(random.Normal(), value);
}

TEST(RandomTest, NormalHasTheFirstFourMoments) {
  const std::vector<double> draws =
      DrawMany(4, [](Random* random) { return random->Normal(); });
  // E x^2 = 1, E x^4 = 3, E x^6 = 15, E x^8 = 105.
  EXPECT_NEAR(MeanPower(draws, 1), 0.0, MeanTolerance(1.0));
  EXPECT_NEAR(MeanPower(draws, 2), 1.0, MeanTolerance(3.0 - 1.0));
  EXPECT_NEAR(MeanPower(draws, 3), 0.0, MeanTolerance(15.0));
  EXPECT_NEAR(MeanPower(draws, 4), 3.0, MeanTolerance(105.0 - 9.0));
}

TEST(RandomTest, TheTwoNormalsOfAPairAreUncorrelated) {
  Random random(6);
  double sum = 0.0;
  for (int i = 0; i < kNumDraws; ++i) {
    const double first = random.Normal();
    sum += first * random.Normal();
  }
  EXPECT_NEAR(sum / kNumDraws, 0.0, MeanTolerance(1.0));
}

TEST(RandomTest, ACopyContinuesAlikeInTheMiddleOfAPair) {
  Random random(7);
  random.Normal();
  Random copy = random;
  for (int i = 0; i < 9; ++i) EXPECT_EQ(copy.Normal(), random.Normal());
  EXPECT_EQ(copy.Next(), random.Next());
}

}  // namespace
}  // namespace alidade::internal
