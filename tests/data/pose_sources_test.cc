#include <gtest/gtest.h>

#include <vector>

#include "alidade/dataset.h"

namespace alidade::internal {
namespace {

void ExpectSources(const PoseSources& sources,
                   const std::vector<PoseSource>& expected) {
  ASSERT_EQ(sources.size(), expected.size());
  EXPECT_EQ(sources.empty(), expected.empty());
  for (std::size_t pose = 0; pose < expected.size(); ++pose) {
    EXPECT_EQ(sources[pose].file, expected[pose].file) << pose;
    EXPECT_EQ(sources[pose].line, expected[pose].line) << pose;
  }
}

TEST(PoseSourcesTest, ConsecutiveLinesAreOneRun) {
  PoseSources sources;
  ExpectSources(sources, {});
  for (const PoseSource source :
       {PoseSource{0, 2}, {0, 3}, {0, 5}, {0, 5}, {1, 6}, {1, 7}}) {
    sources.push_back(source);
  }
  ExpectSources(sources, {{0, 2}, {0, 3}, {0, 5}, {0, 5}, {1, 6}, {1, 7}});
  EXPECT_EQ(sources.runs().size(), 4u);
}

TEST(PoseSourcesTest, ManyAreAppendedAtOnce) {
  PoseSources first;
  first.Append({0, 1}, 1000000000);
  first.Append({0, 9}, 0);
  EXPECT_EQ(first.runs().size(), 1u);
  EXPECT_EQ(first[999999999].line, 1000000000);
  PoseSources others;
  others.push_back({0, 7});
  others.push_back({1, 3});
  PoseSources all;
  all.push_back({0, 6});
  all.Append(others, 0);
  all.Append(others, 2);
  ExpectSources(all, {{0, 6}, {0, 7}, {1, 3}, {2, 7}, {3, 3}});
  all.MoveLines(-2);
  ExpectSources(all, {{0, 4}, {0, 5}, {1, 1}, {2, 5}, {3, 1}});
}

}  // namespace
}  // namespace alidade::internal
