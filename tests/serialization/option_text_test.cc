#include "alidade/option_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "alidade/error.h"
#include "tests/support/io_test_util.h"
#include "tests/support/rv2aj_arms.h"

namespace alidade::internal {
namespace {

using ::testing::HasSubstr;
using ::testing::IsSupersetOf;
using ::testing::StartsWith;

constexpr char kUnits[] = "units: {length: mm, angle: deg}\n";

std::string Text(const std::string& options) {
  return kUnits + ("options: " + options);
}

CalibrationOptions Read(const std::string& options,
                        CalibrationOptions given = {}) {
  ReadOptions(Text(options), testing::Rv2ajFlange(), {}, &given);
  return given;
}

std::vector<std::string> NamesOf(const std::vector<OptionDescription>& all) {
  std::vector<std::string> names;
  for (const OptionDescription& option : all) names.push_back(option.name);
  return names;
}

// Every one of them and what they hold.
void Check(const std::vector<OptionDescription>& all) {
  const std::set<std::string> types = {"number", "integer", "boolean", "text",
                                       "word",   "section", "items",   "value"};
  std::set<std::string> names;
  for (const OptionDescription& option : all) {
    EXPECT_TRUE(names.insert(option.name).second) << option.name;
    EXPECT_FALSE(option.text.empty()) << option.name;
    EXPECT_EQ(types.count(option.type), 1U) << option.name;
    EXPECT_EQ(option.type == "word", !option.words.empty()) << option.name;
    if (!option.fields.empty()) {
      EXPECT_TRUE(option.type == "section" || option.type == "items")
          << option.name;
    }
    Check(option.fields);
  }
}

TEST(OptionTextTest, DescribesAllOptions) {
  EXPECT_THAT(
      NamesOf(OptionsOfCalibration()),
      IsSupersetOf({"estimate_sigma", "solver", "robust", "compare_with",
                    "identifiability", "errors", "bounds", "validation",
                    "acceptance", "uncertainty"}));
  EXPECT_THAT(NamesOf(OptionsOfMonteCarlo()),
              IsSupersetOf({"trials", "seed", "truth", "outliers"}));
  EXPECT_THAT(NamesOf(OptionsOfPlan()),
              IsSupersetOf({"poses", "measurement", "candidates", "criterion",
                            "identifiability"}));
  EXPECT_THAT(NamesOf(OptionsOfData()),
              IsSupersetOf({"file", "columns", "rotation", "target", "point",
                            "plane", "inverse", "payload"}));
  Check(OptionsOfCalibration());
  Check(OptionsOfMonteCarlo());
  Check(OptionsOfPlan());
  Check(OptionsOfData());
}

TEST(OptionTextTest, WhatIsLeftOutStays) {
  CalibrationOptions given;
  given.loss = LossKind::kTukey;
  given.solver_options.max_iterations = 7;
  given.estimate_sigma = true;
  const CalibrationOptions read = Read("{}", given);
  EXPECT_EQ(read.loss, LossKind::kTukey);
  EXPECT_EQ(read.solver_options.max_iterations, 7);
  EXPECT_TRUE(read.estimate_sigma);
  EXPECT_EQ(Read("{robust: {loss: huber}}", given).loss, LossKind::kHuber);
}

TEST(OptionTextTest, ReadsInTheUnitsOfTheText) {
  const CalibrationOptions read = Read(
      "{identifiability: {priors: {d: 2, theta: 0.5}, fix: [d3]}, "
      "acceptance: {train_max: 0.3}, bounds: {d4: [-1, 2]}, "
      "validation: {fraction: 0.25, seed: 9}}");
  EXPECT_DOUBLE_EQ(read.identifiability.priors.d, 2e-3);
  EXPECT_DOUBLE_EQ(read.identifiability.priors.theta, 0.5 * kDegree);
  EXPECT_DOUBLE_EQ(read.acceptance.train_max.value(), 3e-4);
  ASSERT_TRUE(read.holdout.has_value());
  EXPECT_DOUBLE_EQ(read.holdout->fraction, 0.25);
  EXPECT_EQ(read.holdout->seed, 9U);
  EXPECT_FALSE(read.folds.has_value());
  // Of the nominal 160 mm.
  ASSERT_EQ(read.bounds.size(), 1U);
  EXPECT_NEAR(read.bounds[0].lower, 0.159, 1e-15);
  EXPECT_NEAR(read.bounds[0].upper, 0.162, 1e-15);
}

TEST(OptionTextTest, JsonIsAPartOfYaml) {
  CalibrationOptions options;
  ReadOptions(
      R"({"units": {"length": "m", "angle": "rad"},
          "options": {"solver": {"max_iterations": 3}}})",
      testing::Rv2ajFlange(), {}, &options);
  EXPECT_EQ(options.solver_options.max_iterations, 3);
}

TEST(OptionTextTest, OptionsOfStudiesAndPlans) {
  MonteCarloOptions study;
  ReadOptions(Text("{trials: 12, outliers: {fraction: 0.1, size: 2}}"), &study);
  EXPECT_EQ(study.trials, 12);
  EXPECT_DOUBLE_EQ(study.outlier_fraction, 0.1);
  EXPECT_DOUBLE_EQ(study.outlier_size, 2e-3);
  PlanOptions plan;
  CalibrationOptions calibration;
  ReadOptions(Text("{seed: 2, poses: {count: 21}, measurement: {sigma: 0.02}, "
                   "criterion: A, "
                   "identifiability: {parameters: [joints, base]}}"),
              testing::Rv2ajFlange(), {}, &plan, &calibration);
  EXPECT_EQ(plan.design.num_poses, 21);
  EXPECT_EQ(plan.design.criterion, DesignCriterion::kA);
  EXPECT_TRUE(calibration.identifiability.candidates.base);
  EXPECT_FALSE(calibration.identifiability.candidates.tool);
}

// Nothing is taken that a job file would refuse, and options stay as they were.
TEST(OptionTextTest, RefusesByKeyLineAndColumn) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"{robust: {loss: hubert}}", "options.robust.loss"},
      {"{robust: 3}", "options.robust"},
      {"{robst: {}}", "options.robst"},
      {"{solver: {max_iterations: 0}}", "options.solver.max_iterations"},
      {"{solver: {max_iterations: 1.5}}", "options.solver.max_iterations"},
      {"{solver: {max_iterations: 99999999999999999999}}",
       "options.solver.max_iterations"},
      {"{uncertainty: {confidence: .nan}}", "options.uncertainty.confidence"},
      {"{uncertainty: {confidence: 1}}", "options.uncertainty.confidence"},
      {"{identifiability: {fix: [d9]}}", "options.identifiability.fix[1]"},
      {"{identifiability: {fix: {d: 1}}}", "options.identifiability.fix"},
      {"{identifiability: {priors: {d: -1}}}",
       "options.identifiability.priors.d"},
      {"{identifiability: {priors: {d: .inf}}}",
       "options.identifiability.priors.d"},
      {"{bounds: {d3: [1, -1]}}", "options.bounds.d3"},
      {"{validation: {}}", "options.validation"},
      {"{validation: {fraction: 0.5, folds: 3}}", "options.validation"},
      {"{acceptance: {train_max: 0}}", "options.acceptance.train_max"},
      {"{estimate_sigma: perhaps}", "options.estimate_sigma"},
      {"{errors: {harmonics: [0]}}", "options.errors.harmonics[1]"},
      {"[]", "options"},
      {"3", "options"},
  };
  for (const auto& [options, key] : cases) {
    CalibrationOptions read;
    read.solver_options.max_iterations = 77;
    try {
      ReadOptions(Text(options), testing::Rv2ajFlange(), {}, &read);
      ADD_FAILURE() << options << " is taken";
    } catch (const InputError& error) {
      EXPECT_EQ(error.location().key, key) << error.what();
      EXPECT_EQ(error.location().line, 2) << error.what();
      EXPECT_GT(error.location().column, 0);
    }
    EXPECT_EQ(read.solver_options.max_iterations, 77) << options;
  }
}

TEST(OptionTextTest, RefusesWhatIsNoText) {
  for (const std::string& text :
       {std::string(), std::string("{"), std::string("\0\1", 2),
        std::string("options: {}"), std::string(kUnits),
        kUnits + std::string("options: &a {}\nmore: *a\n"),
        std::string("units: {length: parsec, angle: deg}\noptions: {}\n"),
        std::string(200, '['), std::string("options: {}\nunits: 3\n")}) {
    CalibrationOptions options;
    EXPECT_THROW(ReadOptions(text, testing::Rv2ajFlange(), {}, &options),
                 InputError)
        << text;
    MonteCarloOptions study;
    EXPECT_THROW(ReadOptions(text, &study), InputError) << text;
  }
}

class LoadMeasurementsTest : public ::testing::Test {
 protected:
  LoadMeasurementsTest() {
    arm_.joints.resize(2);
    arm_.targets = {{"ball", {}}, {"probe", {}}};
    for (Target& target : arm_.targets) target.last_from_target.setIdentity();
    Csv("a.csv", "x_mm,y_mm,z_mm,day,set,lost",
        {"1,2,3,mon,x,0", "4,5,6,tue,y,0", ",,,tue,y,1"});
    Csv("b.csv", "distance_mm,point", {"100,P", "200,Q"});
  }

  void Csv(const std::string& name, const std::string& header,
           const std::vector<std::string>& rows) {
    std::string text = "q1_deg,q2_deg," + header + "\n";
    for (const std::string& row : rows) text += "10,20," + row + "\n";
    directory_.Write(name, text);
  }

  LoadedMeasurements Load(const std::string& rest) const {
    return LoadMeasurements(kUnits + rest, arm_);
  }
  std::string File(const std::string& name) const {
    return "file: " + directory_.Path(name);
  }

  Arm arm_;
  TestDirectory directory_;
};

TEST_F(LoadMeasurementsTest, ReadsFilesAsAJobDoes) {
  const LoadedMeasurements loaded = Load(
      "measurement: {sigma: 0.05}\n"
      "references: {points: [{name: Q, position: [1, 2, 3], known: true}], "
      "distances: [{between: [P, Q], distance: 50, sigma: 0.01}]}\n"
      "data:\n  - {" +
      File("a.csv") + ", target: probe, columns: {station: day}}\n  - {" +
      File("b.csv") + ", target: ball, columns: {}}\n");
  EXPECT_EQ(loaded.data.num_poses(), 4);
  ASSERT_EQ(loaded.data.blocks.size(), 3U);
  EXPECT_EQ(loaded.data.blocks[0].targets, (std::vector<int>{1, 1}));
  EXPECT_EQ(loaded.data.blocks[0].sigmas.map()(0, 0), 5e-5);
  EXPECT_EQ(loaded.data.blocks[1].references, (std::vector<int>{1, 0}));
  EXPECT_EQ(loaded.data.blocks[2].kind, MeasurementKind::kPointDistance);
  ASSERT_EQ(loaded.references.points.size(), 2U);
  EXPECT_TRUE(loaded.references.points[0].is_known);
  EXPECT_EQ(loaded.references.points[0].position,
            Eigen::Vector3d(1e-3, 2e-3, 3e-3));
  EXPECT_EQ(loaded.references.points[1].name, "P");
  EXPECT_EQ(loaded.sets, (std::vector<std::string>{"x", "y", "", ""}));
  ASSERT_EQ(loaded.rejected.size(), 1U);
  EXPECT_EQ(loaded.rejected[0].line, 4);
  // Tuesday, and the file without stations.
  ASSERT_EQ(loaded.uses.size(), 2U);
  EXPECT_TRUE(loaded.uses[0].is_station);
  EXPECT_EQ(loaded.uses[0].name, "station tue");
  EXPECT_TRUE(loaded.are_sigmas_stated);
}

TEST_F(LoadMeasurementsTest, SigmasThatAreEstimatedAreAFirstGuess) {
  const std::string data = "data: {" + File("b.csv") + ", target: ball}\n";
  EXPECT_FALSE(
      Load("measurement: {sigma: estimate}\n" + data).are_sigmas_stated);
  EXPECT_TRUE(Load("measurement: {sigma: estimate, instrument: 0.01}\n" + data)
                  .are_sigmas_stated);
}

TEST_F(LoadMeasurementsTest, RefusesByKey) {
  const std::string sigma = "measurement: {sigma: 0.05}\n";
  const std::string b = "{" + File("b.csv") + ", ";
  const std::vector<std::pair<std::string, std::string>> cases = {
      {sigma, ""},
      {sigma + "data: []\n", "data"},
      {sigma + "data: " + b + "target: wrist}\n", "data.target"},
      {sigma + "data: " + b + "targt: ball}\n", "data.targt"},
      {sigma + "data: " + b + "sigma: 0}\n", "data.sigma"},
      {sigma + "data: " + b + "target: ball, columns: {joints: [a]}}\n",
       "data.columns.joints"},
      {sigma + "data: " + b + "rotation: zyx}\n", "data.rotation"},
      {sigma + "data: " + b + "payload: -1}\n", "data.payload"},
      {sigma + "data: {target: ball}\n", "data"},
      {"measurement: {sigma: -1}\ndata: " + b + "target: ball}\n",
       "measurement.sigma"},
      {sigma + "references: {points: [{name: P, known: true}]}\ndata: " + b +
           "target: ball}\n",
       "references.points[1]"},
      {sigma + "reference: {}\ndata: " + b + "target: ball}\n", "reference"},
  };
  for (const auto& [text, key] : cases) {
    try {
      Load(text);
      ADD_FAILURE() << text << " is taken";
    } catch (const InputError& error) {
      EXPECT_THAT(error.location().key, StartsWith(key)) << error.what();
      EXPECT_EQ(error.location().file, "options") << error.what();
    }
  }
  // What is wrong in a file has its place there.
  Csv("c.csv", "x_mm,y_mm,z_mm", {"1,2,3", "1,2,x"});
  try {
    Load(sigma + "data: {" + File("c.csv") + ", target: ball}\n");
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_THAT(error.location().file, HasSubstr("c.csv"));
    EXPECT_EQ(error.location().line, 3);
  }
  EXPECT_THROW(Load(sigma + "data: {" + File("no.csv") + ", target: ball}\n"),
               InputError);
}

}  // namespace
}  // namespace alidade::internal
