#include "src/identifiability/generic_data.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <set>
#include <tuple>
#include <vector>

#include "src/common/constants.h"
#include "src/common/random.h"
#include "src/kernel/partition.h"
#include "src/model/joint_draw.h"
#include "tests/support/edit.h"
#include "tests/support/random_arms.h"
#include "tests/support/random_measurements.h"

namespace alidade::internal {
namespace {

using testing::MeasuredArm;
using testing::Weighting;

constexpr int kPoses = 9;
constexpr std::uint64_t kSeed = 17;

// Target, reference (-1: none) and which rows were measured.
using Pattern = std::tuple<int, int, std::vector<bool>>;

Pattern PatternOfObservation(const ObservationBlock& block, Eigen::Index i) {
  std::vector<bool> rows;
  for (const double sigma : block.sigmas.col(i)) {
    rows.push_back(std::isfinite(sigma));
  }
  const int reference = block.references.empty() ? -1 : block.references[i];
  return {block.target(i), reference, rows};
}

std::set<Pattern> PatternsOf(const ObservationBlock& block) {
  std::set<Pattern> patterns;
  for (Eigen::Index i = 0; i < block.size(); ++i) {
    patterns.insert(PatternOfObservation(block, i));
  }
  return patterns;
}

const ObservationBlock& BlockOf(const Dataset& data, MeasurementKind kind) {
  const auto is_of_kind = [kind](const ObservationBlock& block) {
    return block.kind == kind;
  };
  const auto first =
      std::find_if(data.blocks.begin(), data.blocks.end(), is_of_kind);
  EXPECT_NE(first, data.blocks.end());
  EXPECT_TRUE(std::none_of(std::next(first), data.blocks.end(), is_of_kind));
  return *first;
}

// Arms of every weighting, whose data have all kinds of two targets, some rows
// not measured.
class GenericDataTest : public ::testing::TestWithParam<Weighting> {
 protected:
  GenericDataTest()
      : random_(81, static_cast<int>(GetParam())),
        measured_(testing::RandomMeasurements(4, GetParam(), &random_)),
        model_(measured_.arm, measured_.references, 1),
        data_(measured_.data),
        generic_(MakeGenericData(model_, data_, kPoses, kSeed)) {}

  Random random_;
  const MeasuredArm measured_;
  const MeasurementModel model_;
  const Dataset data_;
  const Dataset generic_;
};

TEST_P(GenericDataTest, HasPosesDrawnWithinTheLimits) {
  EXPECT_EQ(generic_.joint_values,
            DrawJointValues(model_.nominal(), kPoses, kSeed));
  for (int j = 0; j < model_.nominal().num_joints(); ++j) {
    const Joint& joint = model_.nominal().joints[j];
    EXPECT_GE(generic_.joint_values.row(j).minCoeff(), joint.lower);
    EXPECT_LE(generic_.joint_values.row(j).maxCoeff(), joint.upper);
  }
}

// Contacts too, as if any pose made them.
TEST_P(GenericDataTest, HasEveryPatternOnceAtEveryDrawnPose) {
  for (const MeasurementKind kind : testing::AllKinds()) {
    if (kind == MeasurementKind::kPointDistance) continue;
    SCOPED_TRACE(NameOf(kind));
    const ObservationBlock& block = BlockOf(generic_, kind);
    const std::set<Pattern> expected = PatternsOf(BlockOf(data_, kind));
    ASSERT_EQ(block.size(),
              kPoses * static_cast<Eigen::Index>(expected.size()));
    for (int pose = 0; pose < kPoses; ++pose) {
      std::set<Pattern> patterns;
      for (Eigen::Index i = 0; i < block.size(); ++i) {
        if (block.pose(i) == pose) {
          patterns.insert(PatternOfObservation(block, i));
        }
      }
      EXPECT_EQ(patterns, expected) << pose;
    }
  }
}

TEST_P(GenericDataTest, DifferencesAreOfTwoDrawnPoses) {
  const ObservationBlock& block =
      BlockOf(generic_, MeasurementKind::kDifference);
  ASSERT_EQ(static_cast<Eigen::Index>(block.seconds.size()), block.size());
  for (Eigen::Index i = 0; i < block.size(); ++i) {
    EXPECT_GE(block.seconds[i], 0);
    EXPECT_LT(block.seconds[i], kPoses);
    EXPECT_NE(block.seconds[i], block.pose(i));
  }
}

TEST_P(GenericDataTest, PointDistancesStay) {
  const ObservationBlock& from =
      BlockOf(data_, MeasurementKind::kPointDistance);
  const ObservationBlock& block =
      BlockOf(generic_, MeasurementKind::kPointDistance);
  EXPECT_EQ(block.references, from.references);
  EXPECT_EQ(block.seconds, from.seconds);
  EXPECT_EQ(block.measured, from.measured);
}

// A metre, and what turns by a metre at the end of the reach.
void ExpectUnitSigmas(const MeasurementModel& model, const Dataset& data) {
  const double angle = 1.0 / ArmReach(model.nominal());
  for (const ObservationBlock& block : data.blocks) {
    EXPECT_TRUE(block.whiteners.empty()) << NameOf(block.kind);
    for (Eigen::Index i = 0; i < block.size(); ++i) {
      for (int row = 0; row < block.rows_each(); ++row) {
        const double sigma = block.sigmas(row, i);
        if (std::isinf(sigma)) continue;
        EXPECT_EQ(sigma, row < 3 ? 1.0 : angle) << NameOf(block.kind);
      }
    }
  }
}

TEST_P(GenericDataTest, RowsAreInMetres) { ExpectUnitSigmas(model_, generic_); }

TEST_P(GenericDataTest, OrientationsAreThoseOfTheNominalArm) {
  const SharedVector turns =
      RotationErrors(model_.Errors(model_.NominalValues(), generic_), generic_);
  ASSERT_GT(turns.size(), 0);
  // The rotation to a vector and back, and between two of them: some tens of
  // eps. Norms are not below zero.
  EXPECT_LE(turns.map().maxCoeff(), 1e-14);
}

TEST_P(GenericDataTest, DependsOnTheSeedAlone) {
  const Dataset again = MakeGenericData(model_, data_, kPoses, kSeed);
  EXPECT_EQ(again.joint_values, generic_.joint_values);
  const Dataset other = MakeGenericData(model_, data_, kPoses, kSeed + 1);
  EXPECT_NE(other.joint_values, generic_.joint_values);
}

TEST_P(GenericDataTest, WithUnitSigmasKeepsAllElse) {
  const Dataset unit = WithUnitSigmas(model_, data_);
  ExpectUnitSigmas(model_, unit);
  EXPECT_EQ(unit.joint_values, data_.joint_values);
  ASSERT_EQ(unit.blocks.size(), data_.blocks.size());
  for (std::size_t k = 0; k < unit.blocks.size(); ++k) {
    const ObservationBlock& block = unit.blocks[k];
    const ObservationBlock& from = data_.blocks[k];
    EXPECT_EQ(block.kind, from.kind);
    EXPECT_EQ(block.poses, from.poses);
    EXPECT_EQ(block.seconds, from.seconds);
    EXPECT_EQ(block.measured, from.measured);
    for (Eigen::Index i = 0; i < block.size(); ++i) {
      EXPECT_EQ(PatternOfObservation(block, i), PatternOfObservation(from, i));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Weightings, GenericDataTest,
                         ::testing::Values(Weighting::kSigmas,
                                           Weighting::kMasked,
                                           Weighting::kFull));

TEST(GenericDataOfPositionsTest, HasNoPosesButTheDrawnOnes) {
  Random random(82);
  const MeasurementModel model(testing::RandomArm(3, &random));
  Dataset data =
      MakePositions(Eigen::MatrixXd::Zero(3, 1), Eigen::Matrix3Xd::Zero(3, 1),
                    Eigen::Matrix3Xd::Ones(3, 1));
  const Dataset generic = MakeGenericData(model, data, kPoses, kSeed);
  EXPECT_EQ(generic.num_poses(), kPoses);
  EXPECT_EQ(generic.num_equations(), 3 * kPoses);
  // One coordinate only at one pose: another pattern.
  data =
      MakePositions(Eigen::MatrixXd::Zero(3, 4), Eigen::Matrix3Xd::Zero(3, 4),
                    Eigen::Matrix3Xd::Constant(3, 4, 1e-4));
  testing::Edit(&data.sigmas())->col(2) << kInfinity, 1e-4, kInfinity;
  EXPECT_EQ(MakeGenericData(model, data, kPoses, kSeed).num_equations(),
            4 * kPoses);
}

// Poses that differ in the first joint, 1e-3 apart, and no observation.
Dataset DataOf(int num_poses) {
  Dataset data;
  Eigen::MatrixXd joint_values = Eigen::MatrixXd::Zero(2, num_poses);
  for (int i = 0; i < num_poses; ++i) joint_values(0, i) = 1e-3 * i;
  data.joint_values = std::move(joint_values);
  return data;
}

ObservationBlock* AddBlock(MeasurementKind kind, int count, Dataset* data) {
  ObservationBlock block;
  block.kind = kind;
  block.measured = Eigen::MatrixXd::Zero(RowsOf(kind), count);
  block.sigmas = Eigen::MatrixXd::Constant(RowsOf(kind), count, 1e-4);
  data->blocks.push_back(block);
  return &data->blocks.back();
}

constexpr Eigen::Index kSubset = 256;

// What is left is of the data: each observation at the pose that it was of.
void ExpectPosesFrom(const Dataset& data, const Dataset& subset) {
  const auto is_of_data = [&](const Eigen::VectorXd& pose) {
    for (Eigen::Index i = 0; i < data.num_poses(); ++i) {
      if (data.joint_values.col(i) == pose) return true;
    }
    return false;
  };
  for (Eigen::Index i = 0; i < subset.num_poses(); ++i) {
    EXPECT_TRUE(is_of_data(subset.joint_values.col(i))) << i;
  }
  for (const ObservationBlock& block : subset.blocks) {
    for (Eigen::Index i = 0; i < block.size(); ++i) {
      ASSERT_GE(block.pose(i), 0);
      ASSERT_LT(block.pose(i), subset.num_poses());
    }
  }
}

TEST(EvenSubsetTest, KeepsEverySocketThatContactsCycleOver) {
  constexpr int kContacts = 1024;
  constexpr int kSockets = 4;
  Dataset data = DataOf(kContacts);
  ObservationBlock* const block =
      AddBlock(MeasurementKind::kFixedPoint, kContacts, &data);
  for (int i = 0; i < kContacts; ++i) {
    block->poses.push_back(i);
    block->references.push_back(i % kSockets);
  }
  const Dataset subset = EvenSubset(SingleProcess(), data, kSubset);
  const ObservationBlock& left = BlockOf(subset, MeasurementKind::kFixedPoint);
  ASSERT_EQ(static_cast<Eigen::Index>(left.references.size()), left.size());
  ExpectPosesFrom(data, subset);
  for (int socket = 0; socket < kSockets; ++socket) {
    EXPECT_GE(
        std::count(left.references.begin(), left.references.end(), socket), 1)
        << socket;
  }
  for (Eigen::Index i = 0; i < left.size(); ++i) {
    // Of the pose that it was of.
    const double angle = subset.joint_values(0, left.pose(i));
    EXPECT_EQ(std::lround(angle / 1e-3) % kSockets, left.references[i]);
  }
}

TEST(EvenSubsetTest, KeepsRareContactsAmongManyPositions) {
  constexpr int kPositions = 5000;
  constexpr int kContacts = 50;
  Dataset data = DataOf(kPositions + kContacts);
  AddBlock(MeasurementKind::kPosition, kPositions, &data);
  for (int i = 0; i < kPositions; ++i) data.blocks[0].poses.push_back(i);
  ObservationBlock* const contacts =
      AddBlock(MeasurementKind::kFixedPoint, kContacts, &data);
  for (int i = 0; i < kContacts; ++i) {
    contacts->poses.push_back(kPositions + i);
    contacts->references.push_back(0);
  }
  const Dataset subset = EvenSubset(SingleProcess(), data, kSubset);
  ExpectPosesFrom(data, subset);
  EXPECT_GE(BlockOf(subset, MeasurementKind::kFixedPoint).size(), 30);
  const Eigen::Index positions =
      BlockOf(subset, MeasurementKind::kPosition).size();
  EXPECT_GE(positions, 30);
  EXPECT_LT(positions, kPositions);
}

// Every fifth of five times as many, from the first on.
TEST(EvenSubsetTest, TakesPositionsInEvenSteps) {
  constexpr int kMany = 5 * static_cast<int>(kSubset);
  Dataset data = DataOf(kMany);
  AddBlock(MeasurementKind::kPosition, kMany, &data);
  const Dataset subset = EvenSubset(SingleProcess(), data, kSubset);
  ASSERT_EQ(subset.num_poses(), kSubset);
  for (int i = 0; i < kSubset; ++i) {
    EXPECT_EQ(subset.joint_values(0, i), data.joint_values(0, 5 * i)) << i;
  }
}

// Two ranks have the poses one after the other: the same are chosen.
TEST(EvenSubsetTest, OfPartsIsThatOfTheWhole) {
  constexpr int kFirst = 700;
  constexpr int kAll = 3000;
  Dataset whole = DataOf(kAll);
  AddBlock(MeasurementKind::kPosition, kAll, &whole);
  const Dataset expected = EvenSubset(SingleProcess(), whole, kSubset);
  RunOnThreads(2, [&](Communicator* communicator) {
    const bool is_root = communicator->is_root();
    const int count = is_root ? kFirst : kAll - kFirst;
    Dataset part = DataOf(count);
    part.joint_values =
        is_root ? whole.joint_values.map().leftCols(kFirst).eval()
                : whole.joint_values.map().rightCols(kAll - kFirst).eval();
    AddBlock(MeasurementKind::kPosition, count, &part);
    MakePartition(communicator, &part);
    EXPECT_EQ(EvenSubset(communicator, part, kSubset).joint_values,
              expected.joint_values);
  });
}

TEST(EvenSubsetTest, KeepsDifferencesOfConsecutivePoses) {
  constexpr int kDifferences = 600;
  Dataset data = DataOf(kDifferences + 1);
  ObservationBlock* const block =
      AddBlock(MeasurementKind::kDifference, kDifferences, &data);
  for (int i = 0; i < kDifferences; ++i) {
    block->poses.push_back(i);
    block->seconds.push_back(i + 1);
  }
  const Dataset subset = EvenSubset(SingleProcess(), data, kSubset);
  ExpectPosesFrom(data, subset);
  const ObservationBlock& left = BlockOf(subset, MeasurementKind::kDifference);
  EXPECT_GE(left.size(), 30);
  EXPECT_LT(left.size(), kDifferences);
  for (Eigen::Index i = 0; i < left.size(); ++i) {
    // Of consecutive poses still, which are 1e-3 apart.
    const double first = subset.joint_values(0, left.pose(i));
    const double second = subset.joint_values(0, left.seconds[i]);
    EXPECT_NEAR(second - first, 1e-3, 1e-12);
  }
}

TEST(EvenSubsetTest, LeavesSmallDataAsTheyAre) {
  Random random(83);
  const Dataset data =
      testing::RandomMeasurements(3, Weighting::kFull, &random).data;
  const Dataset subset = EvenSubset(SingleProcess(), data, kSubset);
  EXPECT_EQ(subset.joint_values, data.joint_values);
  ASSERT_EQ(subset.blocks.size(), data.blocks.size());
  for (std::size_t k = 0; k < data.blocks.size(); ++k) {
    EXPECT_EQ(subset.blocks[k].kind, data.blocks[k].kind);
    EXPECT_EQ(subset.blocks[k].poses, data.blocks[k].poses);
    EXPECT_EQ(subset.blocks[k].targets, data.blocks[k].targets);
    EXPECT_EQ(subset.blocks[k].references, data.blocks[k].references);
    EXPECT_EQ(subset.blocks[k].seconds, data.blocks[k].seconds);
    EXPECT_EQ(subset.blocks[k].measured, data.blocks[k].measured);
    EXPECT_EQ(subset.blocks[k].sigmas, data.blocks[k].sigmas);
    EXPECT_EQ(subset.blocks[k].whiteners, data.blocks[k].whiteners);
  }
}

}  // namespace
}  // namespace alidade::internal
