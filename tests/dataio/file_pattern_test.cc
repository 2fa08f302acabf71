#include "src/dataio/file_pattern.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "alidade/units.h"
#include "src/serialization/job_config.h"
#include "tests/support/io_test_util.h"

namespace alidade::internal {
namespace {

TEST(MatchesPatternTest, StarStandsForAnyCharacters) {
  struct Case {
    const char* pattern;
    const char* name;
    bool matches;
  };
  for (const Case& one : std::vector<Case>{{"*", "", true},
                                           {"*", "a.csv", true},
                                           {"*.csv", "a.csv", true},
                                           {"*.csv", "a.csv.tmp", false},
                                           {"a*", "a", true},
                                           {"a*b*c", "abc", true},
                                           {"a*b*c", "aXbbYbZc", true},
                                           {"a*b*c", "acb", false},
                                           {"*ab", "aab", true},
                                           {"**", "x", true},
                                           {"a?c", "abc", false},
                                           {"abc", "abc", true},
                                           {"", "a", false}}) {
    EXPECT_EQ(MatchesPattern(one.pattern, one.name), one.matches)
        << one.pattern << " " << one.name;
  }
}

TEST(MatchesPatternTest, ManyStarsTakeNoExponentialTime) {
  std::string pattern;
  for (int i = 0; i < 50; ++i) pattern += "*a";
  EXPECT_FALSE(MatchesPattern(pattern + "*b", std::string(2000, 'a')));
}

// A job with three shards of one row each.
class ShardsTest : public ::testing::Test {
 protected:
  ShardsTest() {
    std::filesystem::create_directories(directory_.Path("shards"));
    directory_.Write("arm.yaml",
                     "format: alidade-arm-1\n"
                     "name: arm\n"
                     "units: {length: mm, angle: deg}\n"
                     "joints: [{type: revolute, r: 100}]\n");
    for (const int i : {3, 1, 2}) WriteShard(i);
    directory_.Write("shards/.run_0.csv", "hidden");
    directory_.Write("shards/run_4.csv.tmp-1-1", "half a file");
    std::filesystem::create_directories(directory_.Path("shards/run_5.csv"));
  }

  void WriteShard(int i) {
    const std::string number = std::to_string(i);
    directory_.Write("shards/run_" + number + ".csv",
                     "q1_deg,x_mm,y_mm,z_mm\n" + number + ",1,2,3\n");
  }

  JobConfig Load(const std::string& data) {
    return LoadJob(directory_.Write("job.yaml",
                                    "format: alidade-job-1\n"
                                    "title: A test\n"
                                    "units: {length: mm, angle: deg}\n"
                                    "arm: arm.yaml\n"
                                    "measurement: {sigma: 0.02}\n"
                                    "data: " +
                                        data + "\n"));
  }

  TestDirectory directory_;
};

TEST_F(ShardsTest, AreReadInTheOrderOfTheirNames) {
  const JobConfig job = Load("shards/run_*.csv");
  ASSERT_EQ(job.data.training.num_poses(), 3);
  for (int i = 0; i < 3; ++i) {
    const std::string path =
        directory_.Path("shards/run_" + std::to_string(i + 1) + ".csv");
    EXPECT_NEAR(job.data.training.joint_values(0, i), (i + 1) * kDegree, 1e-15);
    EXPECT_EQ(job.data.training.files[i], path);
    EXPECT_EQ(SourceOf(job.data.training, i), path + ":2");
    EXPECT_EQ(job.input_files[2 + i], path);
  }
}

TEST_F(ShardsTest, StandInListsAndMapsAmongOtherFiles) {
  const JobConfig job =
      Load("[shards/run_2.csv, {file: \"shards/*1.csv\", sigma: 3}]");
  ASSERT_EQ(job.data.training.num_poses(), 2);
  EXPECT_EQ(job.data.training.sigmas()(0, 0), 2e-5);
  EXPECT_EQ(job.data.training.sigmas()(0, 1), 3e-3);
}

TEST_F(ShardsTest, MayBeHeldOutOneByOne) {
  const JobConfig job = Load("shards/run_*.csv\nvalidation: {file: run_2.csv}");
  EXPECT_EQ(job.data.training.num_poses(), 2);
  ASSERT_TRUE(job.data.validation);
  EXPECT_EQ(job.data.validation->num_poses(), 1);
}

TEST_F(ShardsTest, NoMatchIsAnErrorWhereThePatternStands) {
  ExpectInputError([&] { Load("shards/walk_*.csv"); },
                   {6, 7, "data", "no file matches"});
  ExpectInputError([&] { Load("[shards/run_1.csv, no_such/*.csv]"); },
                   {6, 26, "data[2]", "no_such/*.csv"});
}

TEST_F(ShardsTest, ErrorsInOneSayWhichAndWhereItIsNamed) {
  directory_.Write("shards/run_2.csv", "q1_deg,x_mm\n1,wide\n");
  try {
    Load("shards/run_*.csv");
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_EQ(error.location().file, directory_.Path("shards/run_2.csv"));
    EXPECT_NE(error.message().find("named in"), std::string::npos);
  }
}

}  // namespace
}  // namespace alidade::internal
