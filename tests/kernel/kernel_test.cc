#include "src/kernel/kernel.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "src/common/random.h"
#include "src/kernel/measurement_model.h"
#include "src/kernel/reduction.h"
#include "src/kernel/sine.h"
#include "src/kernel/tiles.h"
#include "tests/support/edit.h"
#include "tests/support/random_measurements.h"
#include "tests/support/vector_targets.h"

namespace alidade::internal {
namespace {

using testing::MeasuredArm;

class KernelTest : public testing::VectorTargetTest {};

// The largest errors of the sines and cosines of 64 angles at a time, in units
// of 2^-53.
double LargestError(const std::vector<double>& angles) {
  alignas(64) double sines[kTile];
  alignas(64) double cosines[kTile];
  long double largest = 0.0L;
  for (std::size_t first = 0; first + kTile <= angles.size(); first += kTile) {
    std::copy_n(&angles[first], kTile, sines);
    kernel::SineAndCosine(sines, cosines);
    for (int t = 0; t < kTile; ++t) {
      const long double angle = angles[first + t];
      largest = std::max(largest, std::abs(std::sin(angle) - sines[t]));
      largest = std::max(largest, std::abs(std::cos(angle) - cosines[t]));
    }
  }
  return static_cast<double>(largest * 0x1p53L);
}

TEST_P(KernelTest, SinesAndCosinesAreExactToRounding) {
  Random random(71);
  for (const double range : {1e-3, 1.0, 7.0, 1e3, 1e5}) {
    std::vector<double> angles;
    for (int k = 0; k < 100 * kTile; ++k) {
      angles.push_back(random.Uniform(-range, range));
    }
    // Half a unit in the last place of 1 is 0.5 here; of a correctly rounded
    // sine that is all.
    EXPECT_LE(LargestError(angles), 1.2) << range;
    EXPECT_GE(LargestError(angles), 0.2) << range;
  }
}

TEST_P(KernelTest, SinesNearMultiplesOfAQuarterTurnAreExact) {
  std::vector<double> angles;
  for (int k = 0; k < 20 * kTile; ++k) {
    const double multiple = (k - 10 * kTile) * 1.5707963267948966;
    angles.push_back(std::nextafter(multiple, k % 2 == 0 ? 1e9 : -1e9));
  }
  EXPECT_LE(LargestError(angles), 1.2);
}

TEST_P(KernelTest, LargeAnglesAreThoseOfTheLibrary) {
  std::vector<double> angles(kTile, 1.0);
  angles[5] = 1e15;
  angles[6] = -3e7;
  EXPECT_LE(LargestError(angles), 1.2);
}

// All kinds, each observation `times` times with joint values of its own.
MeasuredArm ManyPoses(int times, Random* random, bool is_flexible = false) {
  MeasuredArm measured = testing::RandomMeasurements(
      4, testing::Weighting::kFull, random, 0.3, is_flexible);
  const Eigen::Index poses = measured.data.num_poses();
  measured.data.joint_values =
      measured.data.joint_values.map().replicate(1, times).eval();
  Eigen::MatrixXd noisy = measured.data.joint_values.map();
  for (double& value : noisy.reshaped()) value += random->Uniform(-0.5, 0.5);
  measured.data.joint_values = std::move(noisy);
  if (is_flexible) {
    measured.data.covariates =
        measured.data.covariates.map().replicate(1, times).eval();
  }
  for (ObservationBlock& block : measured.data.blocks) {
    const auto size = static_cast<int>(block.size());
    const ObservationBlock once = block;
    block.measured = block.measured.map().replicate(1, times).eval();
    block.sigmas = block.sigmas.map().replicate(1, times).eval();
    block.poses.clear();
    for (int k = 0; k < times; ++k) {
      const int shift = k * static_cast<int>(poses);
      const bool turns = once.kind == MeasurementKind::kDifference;
      for (int i = 0; i < size; ++i) {
        block.poses.push_back(once.pose(i) + shift);
        if (k == 0) continue;
        if (!once.targets.empty()) block.targets.push_back(once.targets[i]);
        if (!once.references.empty()) {
          block.references.push_back(once.references[i]);
        }
        if (!once.seconds.empty()) {
          block.seconds.push_back(once.seconds[i] + (turns ? shift : 0));
        }
        if (!once.whiteners.empty()) {
          block.whiteners.push_back(once.whiteners[i]);
        }
      }
    }
  }
  return measured;
}

// Against the template that autodiff takes too: residuals, and derivatives by
// central differences of them.
void ExpectRowsOfTheTemplate(const MeasuredArm& measured) {
  const MeasurementModel model(measured.arm, measured.references, 1);
  std::vector<int> columns(model.layout().size());
  std::iota(columns.begin(), columns.end(), 0);
  Linearization rows;
  model.Linearize(measured.values, measured.data, columns, &rows);
  const auto whitened = [&](const Eigen::VectorXd& values) {
    Eigen::VectorXd errors = model.Errors(values, measured.data).map();
    Eigen::Index row = 0;
    for (const ObservationBlock& block : measured.data.blocks) {
      const Eigen::Index size = block.size() * block.rows_each();
      Whiten(block, 0, block.size(), errors.segment(row, size));
      row += size;
    }
    return errors;
  };
  const Eigen::VectorXd residuals = whitened(measured.values);
  const double largest = residuals.cwiseAbs().maxCoeff();
  EXPECT_LE((rows.residuals - residuals).cwiseAbs().maxCoeff(),
            1e-12 * largest);
  constexpr double kStep = 1e-5;
  for (const int column : columns) {
    Eigen::VectorXd above = measured.values;
    Eigen::VectorXd below = measured.values;
    above[column] += kStep;
    below[column] -= kStep;
    const Eigen::VectorXd slope =
        (whitened(above) - whitened(below)) / (2.0 * kStep);
    // Of the third derivative some 1e-10 is left, of rounding 1e-10.
    EXPECT_LE((rows.jacobian.col(column) - slope).cwiseAbs().maxCoeff(),
              2e-8 * (largest + slope.cwiseAbs().maxCoeff()))
        << model.layout().parameter(column).name;
  }
}

// Over more observations than a tile holds.
TEST_P(KernelTest, RowsAreThoseOfTheTemplate) {
  Random random(72);
  ExpectRowsOfTheTemplate(ManyPoses(40, &random));
}

TEST_P(KernelTest, RowsOfFlexibleArmsAreThoseOfTheTemplate) {
  Random random(76);
  ExpectRowsOfTheTemplate(ManyPoses(40, &random, true));
}

void ExpectOnlyColumnsAskedFor(const MeasuredArm& measured) {
  const MeasurementModel model(measured.arm, measured.references, 1);
  std::vector<int> columns(model.layout().size());
  std::iota(columns.begin(), columns.end(), 0);
  Linearization all;
  model.Linearize(measured.values, measured.data, columns, &all);
  for (const int column : columns) {
    Linearization one;
    model.Linearize(measured.values, measured.data, {column}, &one);
    // The compiler may contract other products where less is written.
    EXPECT_LE(
        (one.jacobian.col(0) - all.jacobian.col(column)).cwiseAbs().maxCoeff(),
        1e-13 * (1.0 + all.jacobian.col(column).cwiseAbs().maxCoeff()));
  }
}

TEST_P(KernelTest, OnlyTheColumnsAskedForAreWritten) {
  Random random(73);
  ExpectOnlyColumnsAskedFor(ManyPoses(12, &random));
  ExpectOnlyColumnsAskedFor(ManyPoses(12, &random, true));
}

// The cache holds all tiles, some of them or none: the same bits.
void ExpectBitsOfAnyCache(const MeasuredArm& measured) {
  const MeasurementModel model(measured.arm, measured.references, 2);
  const std::vector<int> columns = {0, 5, 9, 14, 20, 25, 30};
  ReducedLeastSquares expected;
  for (const std::size_t bytes :
       {std::size_t{0}, std::size_t{100000}, std::size_t{1} << 30}) {
    ReducerOptions options;
    options.cache_bytes = bytes;
    options.factorization = Factorization::kOrthogonal;
    Reducer reducer(model, measured.data, columns, {}, options);
    // The first evaluation fills the cache, the second one reads it.
    for (int evaluation = 0; evaluation < 2; ++evaluation) {
      ReducedLeastSquares problem;
      reducer.Reduce(measured.values, &problem);
      if (expected.factor.size() == 0) expected = problem;
      EXPECT_EQ(problem.factor, expected.factor) << bytes;
      EXPECT_EQ(problem.projected, expected.projected) << bytes;
      EXPECT_EQ(problem.cost, expected.cost) << bytes;
    }
  }
}

TEST_P(KernelTest, BitsDoNotDependOnTheCache) {
  Random random(74);
  ExpectBitsOfAnyCache(ManyPoses(60, &random));
  ExpectBitsOfAnyCache(ManyPoses(60, &random, true));
}

INSTANTIATE_TEST_SUITE_P(Targets, KernelTest, testing::AllVectorTargets(),
                         testing::TargetName);

TEST(TilesTest, CoverEveryObservationOnce) {
  Random random(75);
  const MeasuredArm measured = ManyPoses(50, &random);
  Tiles tiles(measured.arm, measured.data, 0);
  std::vector<std::vector<int>> seen(measured.data.blocks.size());
  for (std::size_t block = 0; block < seen.size(); ++block) {
    seen[block].resize(measured.data.blocks[block].size());
  }
  AlignedDoubles scratch = AllocateDoubles(tiles.scratch_size());
  for (std::int64_t k = 0; k < tiles.size(); ++k) {
    const Tile tile = tiles.Get(k, scratch.get());
    const ObservationBlock& block = measured.data.blocks[tile.block];
    ASSERT_GE(tile.count, 1);
    ASSERT_LE(tile.count, kTile);
    for (int lane = 0; lane < tile.count; ++lane) {
      const Eigen::Index i = tiles.Observation(k, lane);
      ++seen[tile.block][i];
      EXPECT_EQ(block.target(i), tile.target);
      if (tile.reference < 0) continue;
      EXPECT_EQ(block.references[i], tile.reference);
    }
  }
  for (const std::vector<int>& counts : seen) {
    for (const int count : counts) EXPECT_EQ(count, 1);
  }
}

}  // namespace
}  // namespace alidade::internal
