// Errors that residuals show: harmonics of gears, jumps of the base. Rows are
// made up, so that what is to be found is known.

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <vector>

#include "src/common/random.h"
#include "src/error_terms/base_jump.h"
#include "src/error_terms/periodogram.h"

namespace alidade::internal::found_errors_test {
namespace {

constexpr int kPoses = 400;
constexpr int kJoints = 2;

// Three rows a pose, with turns of any size.
TermRows DrawRows(Random* random) {
  TermRows rows;
  rows.joint_values.resize(kJoints, kPoses);
  rows.turns.resize(3 * kPoses, 3 * (kJoints + 4));
  for (int pose = 0; pose < kPoses; ++pose) {
    rows.observations.push_back({pose, -1, Eigen::Index{3} * pose, 3, 3, 3});
    for (int j = 0; j < kJoints; ++j) {
      rows.joint_values(j, pose) = random->Uniform(-2.0, 2.0);
    }
  }
  for (double& entry : rows.turns.reshaped()) entry = random->Normal();
  return rows;
}

Eigen::VectorXd Noise(Random* random) {
  Eigen::VectorXd noise(3 * kPoses);
  for (double& one : noise) one = random->Normal();
  return noise;
}

TEST(FoundErrorsTest, HarmonicIsFoundAtItsFrequencyAndJoint) {
  Random random(1);
  const TermRows rows = DrawRows(&random);
  const WeightedRows data{rows, Eigen::VectorXd::Ones(kPoses)};
  Eigen::VectorXd residuals = Noise(&random);
  for (int pose = 0; pose < kPoses; ++pose) {
    const double shift = 0.6 * std::cos(100.3 * rows.joint_values(1, pose));
    residuals.segment<3>(3 * pose) +=
        shift * rows.turns.block<3, 1>(3 * pose, 5);
  }
  const auto found = FindHarmonics(data, residuals, {true, true}, 1);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].joint, 1);
  // A tenth of the width of a peak, 2 pi over a range of 4 rad.
  EXPECT_NEAR(found[0].cycles, 100.3, 0.15);
  // Its standard deviation is sqrt(2 / 1200).
  EXPECT_NEAR(found[0].amplitude / kTermUnit, 0.6, 0.15);
}

TEST(FoundErrorsTest, NoiseHasNeitherHarmonicsNorJumps) {
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    Random random(seed);
    const TermRows rows = DrawRows(&random);
    const WeightedRows data{rows, Eigen::VectorXd::Ones(kPoses)};
    const Eigen::VectorXd residuals = Noise(&random);
    found += FindBaseJump(data, residuals) ? 1 : 0;
    if (seed > 5) continue;
    found += FindHarmonics(data, residuals, {true, true}, 1).empty() ? 0 : 1;
  }
  EXPECT_EQ(found, 0);  // chances of 1e-4 and 1e-3 each
}

TEST(FoundErrorsTest, JumpIsFoundWhereItIs) {
  constexpr int kJump = 150;
  Random random(2);
  const TermRows rows = DrawRows(&random);
  const WeightedRows data{rows, Eigen::VectorXd::Ones(kPoses)};
  Eigen::VectorXd residuals = Noise(&random);
  for (int pose = kJump; pose < kPoses; ++pose) {
    residuals.segment<3>(3 * pose) +=
        0.8 * rows.turns.block<3, 1>(3 * pose, 3 * kJoints);
  }
  const std::optional<BaseJump> jump = FindBaseJump(data, residuals);
  ASSERT_TRUE(jump.has_value());
  // Places are four poses apart, and its own noise moves it by some.
  EXPECT_NEAR(jump->pose, kJump, 12);
  // A turn's rows are of size 1.
  EXPECT_NEAR(jump->distance, 0.8, 0.15);
}

}  // namespace
}  // namespace alidade::internal::found_errors_test
