// Merged data sets against what an observation by itself says.

#include "src/data/merge.h"

#include <gtest/gtest.h>

#include <numeric>
#include <utility>
#include <vector>

#include "alidade/dataset.h"
#include "src/common/random.h"
#include "tests/dataio/loaded_data_util.h"

namespace alidade::internal {
namespace {

ObservationBlock Block(MeasurementKind kind, int size, double first) {
  ObservationBlock block;
  block.kind = kind;
  Eigen::MatrixXd measured(RowsOf(kind), size);
  std::iota(measured.data(), measured.data() + measured.size(), first);
  block.sigmas = (measured.array() + 0.5).matrix();
  block.measured = std::move(measured);
  return block;
}

Dataset Part(int num_poses, std::vector<ObservationBlock> blocks) {
  Dataset part;
  part.name = "part";
  part.files = {"part"};
  part.joint_values = Eigen::MatrixXd::Random(2, num_poses);
  for (int i = 0; i < num_poses; ++i) part.sources.push_back({0, num_poses});
  part.blocks = std::move(blocks);
  return part;
}

TEST(MergeDatasetsTest, OnePartStaysAsItIs) {
  const Dataset part = Part(2, {Block(MeasurementKind::kPosition, 2, 1.0)});
  ExpectSameData(MergeDatasets({part}), part);
}

TEST(MergeDatasetsTest, PartsOfOnePositionPerPoseStaySo) {
  const Dataset a = Part(2, {Block(MeasurementKind::kPosition, 2, 1.0)});
  const Dataset b = Part(3, {Block(MeasurementKind::kPosition, 3, 9.0)});
  const Dataset all = MergeDatasets({a, b});
  ASSERT_EQ(all.blocks.size(), 1u);
  EXPECT_TRUE(all.blocks[0].poses.empty());
  EXPECT_TRUE(all.blocks[0].targets.empty());
  EXPECT_TRUE(all.blocks[0].whiteners.empty());
  EXPECT_EQ(all.positions().map().leftCols(2), a.positions());
  EXPECT_EQ(all.positions().map().rightCols(3), b.positions());
  EXPECT_EQ(all.sigmas().map().rightCols(3), b.sigmas());
  EXPECT_EQ(all.joint_values.map().rightCols(3), b.joint_values);
  EXPECT_EQ(all.name, "part, part");
  EXPECT_EQ(all.sources[1].file, 0);
  EXPECT_EQ(all.sources[2].file, 1);
}

TEST(MergeDatasetsTest, KindsListsAndWhitenersGoOnWhereThePosesDo) {
  ObservationBlock difference = Block(MeasurementKind::kDifference, 1, 1.0);
  difference.poses = {1};
  difference.seconds = {0};
  ObservationBlock distance = Block(MeasurementKind::kDistance, 2, 5.0);
  distance.references = {4, 2};
  ObservationBlock position = Block(MeasurementKind::kPosition, 2, 7.0);
  position.targets = {0, 3};
  position.whiteners = {Eigen::MatrixXd(), Eigen::Matrix3d::Identity()};
  const Dataset a = Part(2, {distance, difference});
  const Dataset b = Part(2, {position, difference, distance});
  const Dataset c = Part(3, {Block(MeasurementKind::kPosition, 3, 0.0)});
  const Dataset all = MergeDatasets({a, b, c});
  ASSERT_EQ(all.blocks.size(), 3u);
  EXPECT_EQ(all.blocks[0].kind, MeasurementKind::kDistance);
  EXPECT_EQ(all.blocks[0].poses, (std::vector<int>{0, 1, 2, 3}));
  EXPECT_EQ(all.blocks[0].references, (std::vector<int>{4, 2, 4, 2}));
  EXPECT_EQ(all.blocks[1].kind, MeasurementKind::kDifference);
  EXPECT_EQ(all.blocks[1].poses, (std::vector<int>{1, 3}));
  EXPECT_EQ(all.blocks[1].seconds, (std::vector<int>{0, 2}));
  EXPECT_TRUE(all.blocks[1].targets.empty());
  const ObservationBlock& positions = all.blocks[2];
  EXPECT_EQ(positions.poses, (std::vector<int>{2, 3, 4, 5, 6}));
  EXPECT_EQ(positions.targets, (std::vector<int>{0, 3, 0, 0, 0}));
  ASSERT_EQ(positions.whiteners.size(), 5u);
  EXPECT_EQ(positions.whiteners[1].size(), 9);
  EXPECT_EQ(positions.whiteners[4].size(), 0);
}

// As planned poses, which no file has, joined to measured ones.
TEST(MergeDatasetsTest, SourcesAreOfAllPosesOrOfNone) {
  Dataset planned = Part(3, {Block(MeasurementKind::kPosition, 3, 0.0)});
  planned.sources = {};
  planned.files.clear();
  const Dataset measured = Part(2, {Block(MeasurementKind::kPosition, 2, 1.0)});
  const Dataset all = MergeDatasets({planned, measured});
  EXPECT_EQ(all.num_poses(), 5);
  EXPECT_TRUE(all.sources.empty());
  EXPECT_EQ(SourceOf(all, 4), "");
  const Dataset none = Part(0, {});
  EXPECT_EQ(MergeDatasets({none, measured}).sources.size(), 2u);
}

}  // namespace
}  // namespace alidade::internal
