// `alidade plan` as a process, and that what it promises comes true.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "tests/support/process.h"
#include "tests/support/without_times.h"

namespace alidade::internal::plan_test {
namespace {

namespace fs = std::filesystem;

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using testing::ProcessResult;
using testing::ReadWhole;
using testing::TemporaryDirectory;
using testing::WithoutTimes;
using testing::WriteWhole;

const std::string kHead =
    "units: {length: mm, angle: deg}\n"
    "arm: " ALIDADE_SOURCE_DIR "/configs/robots/rv2aj_flange.yaml\n";

class PlanCommandTest : public ::testing::Test {
 protected:
  // A plan of few candidates; `more` are further lines.
  void WritePlan(const std::string& count, const std::string& more = "") {
    WriteWhole(directory_ / "plan.yaml",
               "format: alidade-plan-1\ntitle: Some poses\n" + kHead +
                   "measurement: {kind: position, sigma: 0.02}\n"
                   "poses: {count: " +
                   count +
                   "}\n"
                   "candidates: {count: 300}\nseed: 3\n" +
                   (more.empty() ? "identifiability: {policy: keep}\n" : more));
  }

  ProcessResult Alidade(const std::string& arguments) {
    return testing::RunIn(directory_.path(),
                          std::string(ALIDADE_BINARY) + " " + arguments);
  }

  nlohmann::json Json(const std::string& name) {
    return nlohmann::json::parse(ReadWhole(directory_ / name));
  }

  TemporaryDirectory directory_;
};

TEST_F(PlanCommandTest, WritesWhatItPrints) {
  WritePlan("12");
  const ProcessResult result = Alidade("plan plan.yaml --out=new/plan");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("Some poses"), HasSubstr("18 parameters")));
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(directory_ / "new/plan")) {
    const std::string name = entry.path().filename().string();
    if (name == ".alidade-files") continue;
    names.insert(name);
    EXPECT_THAT(result.out, HasSubstr("new/plan/" + name));
  }
  EXPECT_EQ(names,
            (std::set<std::string>{"accuracy.svg", "curve.csv", "plan.html",
                                   "plan.json", "plan.txt", "poses.csv"}));
  const std::string poses = ReadWhole(directory_ / "new/plan/poses.csv");
  const auto is_comment = [](const std::string& line) {
    return line[0] == '#';
  };
  std::istringstream lines(poses);
  int rows = 0;
  for (std::string line; std::getline(lines, line);) {
    if (!is_comment(line)) ++rows;
  }
  EXPECT_EQ(rows, 1 + 12);  // and the header
  EXPECT_THAT(poses, HasSubstr("q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,x_mm"));
}

// Measured with the noise that the plan was made for, the planned poses tell
// each parameter as well as it said. What is left is that the calibrated
// geometry is not the nominal one, where the plan was made: parameters differ
// by their standard deviations, 2e-4 rad at most, and so do columns of the
// Jacobian, relative to their size.
TEST_F(PlanCommandTest, CalibrationKeepsWhatThePlanPromised) {
  WritePlan("12");
  ASSERT_EQ(Alidade("plan plan.yaml --out=plan").status, 0);
  WriteWhole(directory_ / "simulation.yaml",
             "format: alidade-simulation-1\ntitle: as planned\n" + kHead +
                 "poses: {file: plan/poses.csv}\nnoise: {sigma: 0.02}\n"
                 "seed: 5\noutput: measured.csv\n");
  WriteWhole(directory_ / "job.yaml",
             "format: alidade-job-1\ntitle: as planned\n" + kHead +
                 "data: measured.csv\nmeasurement: {sigma: 0.02}\n"
                 "identifiability: {policy: keep}\n");
  ASSERT_EQ(Alidade("simulate simulation.yaml").status, 0);
  const ProcessResult calibrated = Alidade("calibrate job.yaml --out=result");
  ASSERT_EQ(calibrated.status, 0) << calibrated.err;
  std::map<std::string, double> stds;
  const nlohmann::json result = Json("result/result.json");
  for (const nlohmann::json& parameter : result["parameters"]) {
    if (parameter["std"].is_null()) continue;
    stds[parameter["name"]] = parameter["std"];
  }
  const nlohmann::json plan = Json("plan/plan.json");
  ASSERT_EQ(plan["parameters"].size(), 18U);
  for (const nlohmann::json& parameter : plan["parameters"]) {
    const std::string name = parameter["name"];
    ASSERT_EQ(stds.count(name), 1U) << name;
    EXPECT_NEAR(stds[name] / parameter["planned_std"].get<double>(), 1.0, 1e-3)
        << name;
  }
}

// The caution about the arm itself is in all that is written, and can be left
// out.
TEST_F(PlanCommandTest, SaysWhereTheArmMayBeInItsOwnWay) {
  constexpr char kWorth[] = "This is a caution by a rough model of the arm";
  const auto unwrapped = [](std::string text) {
    std::replace(text.begin(), text.end(), '\n', ' ');
    return text;
  };
  WritePlan("12");
  const ProcessResult plain = Alidade("plan plan.yaml --out=plain");
  ASSERT_EQ(plain.status, 0) << plain.err;
  EXPECT_THAT(unwrapped(plain.out), HasSubstr("capsules of 39.1 mm radius"));
  EXPECT_THAT(unwrapped(ReadWhole(directory_ / "plain/plan.txt")),
              HasSubstr(kWorth));
  EXPECT_THAT(ReadWhole(directory_ / "plain/plan.html"), HasSubstr(kWorth));
  EXPECT_NEAR(Json("plain/plan.json")["links"]["radius"], 0.0391, 1e-12);
  WritePlan("12", "identifiability: {policy: keep}\nlink_radius: 70\n");
  const ProcessResult thick = Alidade("plan plan.yaml --out=thick");
  ASSERT_EQ(thick.status, 0) << thick.err;
  EXPECT_THAT(thick.out, HasSubstr("The arm may be in its own way at "));
  const nlohmann::json overlaps = Json("thick/plan.json")["links"]["overlaps"];
  EXPECT_GE(overlaps.size(), 1U);
  // The choice of poses is another matter.
  EXPECT_EQ(ReadWhole(directory_ / "thick/poses.csv"),
            ReadWhole(directory_ / "plain/poses.csv"));
  WritePlan("12", "identifiability: {policy: keep}\nlink_radius: 0\n");
  const ProcessResult none = Alidade("plan plan.yaml --out=none");
  EXPECT_THAT(none.out, Not(HasSubstr("capsules")));
  EXPECT_EQ(Json("none/plan.json")["links"]["radius"], 0.0);
}

TEST_F(PlanCommandTest, DependsOnTheSeedButNotOnThreads) {
  WritePlan("9");
  ASSERT_EQ(Alidade("plan plan.yaml --out=one --threads=1").status, 0);
  ASSERT_EQ(Alidade("plan plan.yaml --out=two --threads=2").status, 0);
  ASSERT_EQ(Alidade("plan plan.yaml --out=other --seed=4").status, 0);
  for (const char* name : {"poses.csv", "accuracy.svg", "curve.csv"}) {
    EXPECT_EQ(ReadWhole(directory_ / (std::string("one/") + name)),
              ReadWhole(directory_ / (std::string("two/") + name)))
        << name;
  }
  EXPECT_EQ(WithoutTimes(directory_ / "one/plan.json"),
            WithoutTimes(directory_ / "two/plan.json"));
  EXPECT_NE(ReadWhole(directory_ / "one/poses.csv"),
            ReadWhole(directory_ / "other/poses.csv"));
}

TEST_F(PlanCommandTest, RefusesWithoutWritingAnything) {
  WritePlan("5");
  const ProcessResult few = Alidade("plan plan.yaml --out=out");
  EXPECT_EQ(few.status, 3);
  EXPECT_THAT(few.out, IsEmpty());
  EXPECT_THAT(few.err, AllOf(HasSubstr("plan.yaml: 5 poses"),
                             HasSubstr("plan more poses")));
  WritePlan("many");
  const ProcessResult wrong = Alidade("plan plan.yaml --out=out");
  EXPECT_EQ(wrong.status, 2);
  EXPECT_THAT(wrong.err, HasSubstr("plan.yaml:6:16: poses.count"));
  WritePlan("12",
            "region: {boxes: [{x: [5000, 6000], y: [0, 10], "
            "z: [0, 10]}]}\n");
  const ProcessResult far = Alidade("plan plan.yaml --out=out");
  EXPECT_EQ(far.status, 2);
  EXPECT_THAT(far.err,
              HasSubstr("region: all boxes are farther from the base than "
                        "the arm can reach"));
  EXPECT_FALSE(fs::exists(directory_ / "out"));
}

}  // namespace
}  // namespace alidade::internal::plan_test
