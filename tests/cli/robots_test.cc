// Arm files that are named "robots/NAME": `alidade robots`, jobs and commands.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "tests/support/process.h"

namespace alidade::internal::robots_test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using testing::ProcessResult;
using testing::ReadWhole;
using testing::TemporaryDirectory;
using testing::WriteWhole;

const std::string kSource = ALIDADE_SOURCE_DIR;

constexpr char kOwnArm[] = R"(format: alidade-arm-1
name: arm of this cell
units: {length: mm, angle: deg}
joints:
  - {type: revolute, r: 300, limits: [-150, 150]}
  - {type: revolute, alpha: -90}
)";

class RobotsTest : public ::testing::Test {
 protected:
  // Runs in a folder that knows nothing of the source tree.
  ProcessResult Alidade(const std::string& arguments,
                        const std::string& folders = "") {
    return testing::RunProcess("cd " + directory_.path().string() +
                               " && ALIDADE_ROBOTS=" + folders + " " +
                               ALIDADE_BINARY + " " + arguments);
  }

  void Write(const std::string& name, const std::string& text) {
    WriteWhole(directory_ / name, text);
  }

  TemporaryDirectory directory_;
};

TEST_F(RobotsTest, ListsTheArmsThatComeWithTheProgram) {
  const ProcessResult result = Alidade("robots");
  EXPECT_EQ(result.status, 0);
  EXPECT_THAT(result.err, IsEmpty());
  EXPECT_THAT(result.out, HasSubstr("robots/ur10e "));
  EXPECT_THAT(result.out, HasSubstr("Universal Robots UR10e"));
  EXPECT_THAT(result.out, HasSubstr("robots/rv2aj_flange "));
  EXPECT_THAT(result.out, HasSubstr(kSource + "/configs/robots"));
  EXPECT_THAT(result.out, Not(HasSubstr("rv2aj_deviations")));
}

TEST_F(RobotsTest, ListsThoseOfAName) {
  const ProcessResult result = Alidade("robots 'KR 6'");
  EXPECT_EQ(result.status, 0);
  EXPECT_THAT(result.out, HasSubstr("robots/kr6_r900_2 "));
  EXPECT_THAT(result.out, Not(HasSubstr("ur10e")));
  EXPECT_THAT(Alidade("robots irb120").out,
              HasSubstr("ABB IRB 120, targets smr1, smr2, smr3"));
  EXPECT_EQ(Alidade("robots robbie").status, 2);
  const ProcessResult similar = Alidade("show kr6");
  EXPECT_EQ(similar.status, 2);
  EXPECT_THAT(similar.err, HasSubstr("\"kr6\" is no file, did you mean "
                                     "robots/kr6_r900_2, "));
  // Files of one's own, and what says nothing, are no names of arms.
  for (const char* missing : {"arm.yaml", "a.yaml", "r", "'***'", "robots"}) {
    const ProcessResult result = Alidade(std::string("show ") + missing);
    EXPECT_EQ(result.status, 2);
    EXPECT_THAT(result.err, Not(HasSubstr("did you mean"))) << missing;
  }
  const std::string many = Alidade("show irb").err;
  EXPECT_EQ(std::count(many.begin(), many.end(), ','), 5) << many;
}

TEST_F(RobotsTest, CommandsTakeTheirNames) {
  const std::string path = kSource + "/configs/robots/ur10e.yaml";
  const ProcessResult of_path = Alidade("show " + path);
  EXPECT_EQ(of_path.status, 0);
  for (const char* name : {"robots/ur10e", "robots/ur10e.yaml"}) {
    const ProcessResult of_name = Alidade("show " + std::string(name));
    EXPECT_EQ(of_name.status, 0);
    EXPECT_EQ(of_name.out, of_path.out);
  }
  Write("joints.csv",
        "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\n1,2,3,4,5,6\n");
  EXPECT_EQ(Alidade("fk robots/ur10e joints.csv").out,
            Alidade("fk " + path + " joints.csv").out);
  EXPECT_EQ(
      Alidade("export robots/ur5e --as=offsets --nominal=robots/ur5e").status,
      0);
}

// Job and program may go elsewhere; a file of one's own has its path.
TEST_F(RobotsTest, ImportedJobsKeepTheirNames) {
  Write("export.csv",
        "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg,x_mm,y_mm,z_mm\n"
        "1,2,3,4,5,6,700,8,9\n");
  ASSERT_EQ(Alidade("import export.csv --arm=robots/ur10e --out=a").status, 0);
  EXPECT_THAT(ReadWhole(directory_ / "a/job.yaml"),
              HasSubstr("arm: 'robots/ur10e'\n"));
  std::filesystem::copy_file(kSource + "/configs/robots/ur10e.yaml",
                             directory_.path() / "ur10e.yaml");
  ASSERT_EQ(Alidade("import export.csv --arm=ur10e.yaml --out=b").status, 0);
  EXPECT_THAT(ReadWhole(directory_ / "b/job.yaml"),
              HasSubstr("arm: '../ur10e.yaml'\n"));
}

TEST_F(RobotsTest, JobsAndSimulationsTakeTheirNames) {
  Write("simulation.yaml", R"(format: alidade-simulation-1
units: {length: mm, angle: deg}
arm: robots/rv2aj_wrist
poses: {random: {count: 4}}
seed: 1
output: data.csv
)");
  const ProcessResult simulated = Alidade("simulate simulation.yaml");
  EXPECT_EQ(simulated.status, 0) << simulated.err;
  Write("job.yaml", R"(format: alidade-job-2
units: {length: mm, angle: deg}
title: named arm
arm: robots/rv2aj_wrist
data: data.csv
measurement: {sigma: 0.02}
)");
  const ProcessResult checked = Alidade("check job.yaml");
  EXPECT_EQ(checked.status, 0) << checked.err;
  EXPECT_THAT(checked.out, HasSubstr("job, 4 poses"));
}

TEST_F(RobotsTest, FoldersOfOnesOwnGoFirst) {
  std::filesystem::create_directory(directory_ / "own");
  Write("own/ur10e.yaml", kOwnArm);
  Write("own/broken.yaml", "format: alidade-arm-1\nname: [\n");
  const ProcessResult list = Alidade("robots", "no_such_folder:own");
  EXPECT_EQ(list.status, 0);
  EXPECT_THAT(list.out, HasSubstr("arm of this cell"));
  EXPECT_THAT(list.out, Not(HasSubstr("Universal Robots UR10e")));
  EXPECT_THAT(list.out, HasSubstr("robots/ur5e "));
  EXPECT_THAT(list.out, HasSubstr("wrong: "));
  EXPECT_THAT(Alidade("show robots/ur10e", "own").out,
              HasSubstr("arm of this cell"));
}

// Relative paths keep their meaning.
TEST_F(RobotsTest, AFileOfThatPathGoesBeforeAll) {
  std::filesystem::create_directory(directory_ / "robots");
  Write("robots/ur10e.yaml", kOwnArm);
  EXPECT_THAT(Alidade("show robots/ur10e.yaml").out,
              HasSubstr("arm of this cell"));
  EXPECT_THAT(Alidade("show robots/ur10e").out,
              HasSubstr("Universal Robots UR10e"));
}

TEST_F(RobotsTest, UnknownNamesAreRefusedWhereTheyStand) {
  const ProcessResult shown = Alidade("show robots/ur10f");
  EXPECT_EQ(shown.status, 2);
  EXPECT_THAT(shown.err,
              HasSubstr("unknown arm \"robots/ur10f\", did you mean"));
  EXPECT_THAT(shown.err, HasSubstr("'alidade robots' lists them"));
  Write("job.yaml", R"(format: alidade-job-2
units: {length: mm, angle: deg}
title: unknown arm
arm: robots/UR10E
data: data.csv
measurement: {sigma: 0.02}
)");
  const ProcessResult checked = Alidade("check job.yaml");
  EXPECT_EQ(checked.status, 2);
  EXPECT_THAT(checked.err, HasSubstr("job.yaml:4:6: arm: unknown arm"));
  EXPECT_THAT(checked.err, HasSubstr("did you mean \"robots/ur10e\"?"));
}

TEST_F(RobotsTest, ANameWithoutItsFolderIsRefusedWithIt) {
  Write("job.yaml", R"(format: alidade-job-2
units: {length: mm, angle: deg}
title: bare name
arm: ur10e
data: data.csv
measurement: {sigma: 0.02}
)");
  for (const char* command :
       {"show ur10e", "check job.yaml", "import data.csv --arm=ur10e"}) {
    const ProcessResult result = Alidade(command);
    EXPECT_EQ(result.status, 2) << command;
    EXPECT_THAT(result.err, HasSubstr("\"ur10e\" is no file, did you mean "
                                      "\"robots/ur10e\"?"));
  }
}

}  // namespace
}  // namespace alidade::internal::robots_test
