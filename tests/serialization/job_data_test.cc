#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "alidade/parameter_layout.h"
#include "alidade/units.h"
#include "src/common/constants.h"
#include "src/common/files.h"
#include "src/serialization/job_config.h"
#include "tests/support/io_test_util.h"

namespace alidade::internal {
namespace {

using Eigen::Vector3d;

const char kArmText[] =
    "format: alidade-arm-1\n"
    "name: arm\n"
    "units: {length: mm, angle: deg}\n"
    "joints: [{type: revolute, r: 100}, {type: revolute, alpha: 90}]\n"
    "targets: [{name: ball, x: 5}, {name: probe, z: 7}]\n";

// A job whose lines from the seventh on are the test's.
class DataJob {
 public:
  DataJob() {
    directory_.Write("arm.yaml", kArmText);
    Csv("a.csv", "x_mm,y_mm,z_mm,target,set",
        {"1,2,3,ball,fit", "4,5,6,probe,check", "7,8,9,ball,fit"});
    Csv("b.csv", "distance_mm,point", {"100,P", "200,Q"});
  }

  void Csv(const std::string& name, const std::string& header,
           const std::vector<std::string>& rows) {
    std::string text = "q1_deg,q2_deg," + header + "\n";
    for (const std::string& row : rows) {
      text += std::to_string(++num_rows_) + ",20," + row + "\n";
    }
    directory_.Write(name, text);
  }

  std::string Path(const std::string& name) const {
    return directory_.Path(name);
  }

  JobConfig Load(const std::string& lines) const {
    return LoadJob(directory_.Write("job.yaml",
                                    "format: alidade-job-1\n"
                                    "title: A test\n"
                                    "units: {length: mm, angle: deg}\n"
                                    "arm: arm.yaml\n"
                                    "measurement: {sigma: 0.02}\n"
                                    "# the test's own\n" +
                                        lines));
  }

  void ExpectError(const std::string& lines,
                   const ExpectedError& expected) const {
    ExpectInputError([&] { Load(lines); }, expected);
  }

 private:
  TestDirectory directory_;
  int num_rows_ = 0;
};

TEST(JobDataTest, MergesFiles) {
  const DataJob files;
  const JobConfig job = files.Load(
      "data: [a.csv, {file: b.csv, target: probe, sigma: 0.5},\n"
      "  {file: a.csv, columns: {}}]\n");
  const Dataset& data = job.data.training;
  ASSERT_EQ(data.num_poses(), 8);
  EXPECT_NEAR(data.joint_values(0, 3), 4 * kDegree, 1e-15);
  ASSERT_EQ(data.blocks.size(), 2U);
  EXPECT_EQ(data.blocks[0].poses, (std::vector<int>{0, 1, 2, 5, 6, 7}));
  EXPECT_EQ(data.blocks[0].targets, (std::vector<int>{0, 1, 0, 0, 1, 0}));
  EXPECT_EQ(data.blocks[0].measured.col(4), Vector3d(0.004, 0.005, 0.006));
  EXPECT_EQ(data.blocks[0].sigmas(0, 0), 2e-5);
  EXPECT_EQ(data.blocks[1].kind, MeasurementKind::kDistance);
  EXPECT_EQ(data.blocks[1].poses, (std::vector<int>{3, 4}));
  EXPECT_EQ(data.blocks[1].targets, (std::vector<int>{1, 1}));
  EXPECT_EQ(data.blocks[1].references, (std::vector<int>{0, 1}));
  EXPECT_EQ(data.blocks[1].sigmas(0, 0), 5e-4);
  ASSERT_EQ(data.sources.size(), 8U);
  EXPECT_EQ(data.sources[5].file, 2);
  EXPECT_EQ(data.sources[4].line, 3);
  EXPECT_EQ(data.files,
            (std::vector<std::string>{files.Path("a.csv"), files.Path("b.csv"),
                                      files.Path("a.csv")}));
  // Each file once.
  EXPECT_EQ(job.input_files.size(), 4U);
  ASSERT_EQ(job.data.references.num_points(), 2);
  EXPECT_EQ(job.data.references.points[1].name, "Q");
}

// Rows of it may be of two kinds, which more than its name then says.
TEST(JobDataTest, AFileIsNamedOnce) {
  const DataJob files;
  files.ExpectError("data: [a.csv, a.csv]\n",
                    {7, 15, "data[2]", "a.csv is named twice"});
  files.ExpectError("data: ['a*.csv', {file: ./a.csv}]\n",
                    {7, 25, "data[2].file", "a.csv is named twice"});
}

TEST(JobDataTest, ShiftsDifferencesAndSharesNames) {
  DataJob files;
  files.Csv("c.csv", "dx_mm,dy_mm,dz_mm,from,target",
            {"1,2,3,2,ball", ",,,,ball"});
  files.Csv("d.csv", "point,target", {"P,ball", "R,ball"});
  const JobConfig job =
      files.Load("data: [{file: b.csv, target: ball}, c.csv, d.csv]\n");
  const ObservationBlock& difference = job.data.training.blocks.at(1);
  EXPECT_EQ(difference.poses, std::vector<int>{2});
  EXPECT_EQ(difference.seconds, std::vector<int>{3});
  EXPECT_EQ(job.data.training.blocks.at(2).references,
            (std::vector<int>{0, 2}));
  EXPECT_EQ(job.data.references.num_points(), 3);
}

TEST(JobDataTest, ListsRejectedRows) {
  DataJob files;
  files.Csv("c.csv", "x_mm,target", {",ball", "1,ball", ",ball"});
  const JobConfig job = files.Load("data: [a.csv, c.csv]\n");
  EXPECT_EQ(job.data.training.num_poses(), 4);
  ASSERT_EQ(job.rejected.size(), 2U);
  EXPECT_EQ(job.rejected[1].file, files.Path("c.csv"));
  EXPECT_EQ(job.rejected[1].line, 4);
  EXPECT_EQ(job.data.training.blocks[0].sigmas(1, 3), kInfinity);
}

TEST(JobDataTest, ReadsEveryKeyOfAnEntry) {
  DataJob files;
  files.Csv("c.csv", "a_x_mm,a_y_mm,a_z_mm,b_x_mm,b_y_mm,b_z_mm,s_mm,kind",
            {"1,2,3,4,5,6,0.1,A", "1,2,3,4,5,6,0.1,B"});
  const JobConfig job = files.Load(
      "data:\n"
      "  file: c.csv\n"
      "  columns:\n"
      "    targets: {probe: [a_x_mm, a_y_mm, a_z_mm], ball: [b_x_mm, b_y_mm, "
      "b_z_mm]}\n"
      "  where: {kind: B}\n");
  EXPECT_EQ(job.data.training.num_poses(), 1);
  EXPECT_EQ(job.data.training.blocks[0].targets, (std::vector<int>{1, 0}));
  EXPECT_EQ(job.data.training.blocks[0].poses, (std::vector<int>{0, 0}));
  EXPECT_NEAR(job.data.training.joint_values(0, 0), 7 * kDegree, 1e-15);
}

TEST(JobDataTest, ReadsOrientationsAndTheirSigmas) {
  DataJob files;
  files.Csv("c.csv", "x_mm,y_mm,z_mm,rx_deg,ry_deg,rz_deg,target",
            {"1,2,3,0,0,90,ball"});
  const auto sigma = [&](const std::string& lines) {
    return files.Load(lines).data.training.blocks.at(0).sigmas(3, 0);
  };
  const std::string entry = "data: {file: c.csv, rotation: extrinsic_xyz";
  // 0.02 mm over 0.2 m.
  EXPECT_NEAR(sigma(entry + "}\n"), 1e-4, 1e-18);
  EXPECT_NEAR(sigma(entry + ", sigma: 0.04}\n"), 2e-4, 1e-18);
  EXPECT_EQ(sigma(entry + ", rotation_sigma: 0.5}\n"), 0.5 * kDegree);
  const JobConfig job = files.Load(
      entry +
      "}\nacceptance: {train_rotation_rms: 1, train_rotation_max: 2}\n");
  EXPECT_EQ(job.options.acceptance.train_rotation_rms, kDegree);
  EXPECT_EQ(job.options.acceptance.train_rotation_max, 2 * kDegree);
  const JobConfig position =
      files.Load("data: {file: c.csv, rotation: ignore}\n");
  EXPECT_FALSE(position.data.training.Has(MeasurementKind::kPose));
}

TEST(JobDataTest, MeasurementGivesTheSigmaOfRotations) {
  DataJob files;
  files.Csv("c.csv", "wx_deg,wy_deg,wz_deg,target", {"0,0,90,ball"});
  const std::string path = files.Path("job.yaml");
  files.Load("data: c.csv\n");
  std::string text = ReadFile(path);
  const std::string from = "{sigma: 0.02}";
  text.replace(text.find(from), from.size(),
               "{sigma: estimate, sigma_rotation: 0.05}");
  WriteFileAtomically(path, text);
  const JobConfig job = LoadJob(path);
  EXPECT_TRUE(job.options.estimate_sigma);
  EXPECT_EQ(job.data.training.blocks[0].sigmas(3, 0), 0.05 * kDegree);
}

const char kReferences[] =
    "references:\n"
    "  points:\n"
    "    - {name: Q, position: [10, 20, 30], known: true}\n"
    "    - {name: P, position: [1, 2, 3]}\n"
    "    - {name: S}\n"
    "  planes:\n"
    "    - {name: floor, normal: [0, 0, 2], offset: 5, known: true}\n"
    "    - {name: wall}\n"
    "  distances:\n"
    "    - {between: [P, Q], distance: 50, sigma: 0.1}\n"
    "    - {between: [S, P], distance: 60}\n";

TEST(JobDataTest, ReadsReferences) {
  const DataJob files;
  const JobConfig job = files.Load(
      std::string("data: {file: b.csv, target: ball}\n") + kReferences);
  const References& references = job.data.references;
  ASSERT_EQ(references.num_points(), 3);
  EXPECT_TRUE(references.points[0].is_known);
  EXPECT_FALSE(references.points[1].is_known);
  EXPECT_EQ(references.points[1].position, Vector3d(0.001, 0.002, 0.003));
  EXPECT_TRUE(references.points[2].position.isZero(0.0));
  ASSERT_EQ(references.num_planes(), 2);
  EXPECT_EQ(references.planes[0].normal, Vector3d(0, 0, 1));
  EXPECT_EQ(references.planes[0].offset, 0.005);
  EXPECT_TRUE(references.planes[0].is_known);
  EXPECT_EQ(job.data.training.blocks.at(0).references,
            (std::vector<int>{1, 0}));
  const ObservationBlock& distances = job.data.training.blocks.at(1);
  EXPECT_EQ(distances.kind, MeasurementKind::kPointDistance);
  EXPECT_EQ(distances.references, (std::vector<int>{1, 2}));
  EXPECT_EQ(distances.seconds, (std::vector<int>{0, 1}));
  EXPECT_EQ(distances.measured(0, 0), 0.05);
  EXPECT_EQ(distances.sigmas(0, 0), 1e-4);
  EXPECT_EQ(distances.sigmas(0, 1), 2e-5);
  EXPECT_TRUE(distances.poses.empty());
}

TEST(JobDataTest, ParametersAreThoseOfArmAndReferences) {
  const DataJob files;
  const JobConfig job = files.Load(
      std::string("data: {file: b.csv, target: ball}\n") + kReferences +
      "identifiability: {fix: [tool2_x, point3_z, plane2_c]}\n"
      "bounds:\n"
      "  r1: [-1, 2]\n"
      "  theta2: [-.inf, 3]\n");
  EXPECT_EQ(job.options.identifiability.fix.size(), 3U);
  const ParameterLayout layout(LayoutShape{2, 2, 3, 2});
  ASSERT_EQ(job.options.bounds.size(), 2U);
  EXPECT_EQ(job.options.bounds[0].parameter, "r1");
  EXPECT_NEAR(job.options.bounds[0].lower, 0.099, 1e-16);
  EXPECT_NEAR(job.options.bounds[0].upper, 0.102, 1e-16);
  EXPECT_EQ(job.options.bounds[1].lower, -kInfinity);
  EXPECT_EQ(job.options.bounds[1].upper, 3 * kDegree);
}

// Two joints that turn, two targets.
TEST(JobDataTest, ParametersAreNamedByKindsJointsFramesAndPatterns) {
  const DataJob files;
  using Names = std::vector<std::string>;
  const auto load = [&](const std::string& section) {
    return files
        .Load("data: {file: b.csv, target: ball}\nidentifiability: {" +
              section + "}\n")
        .options.identifiability;
  };
  EXPECT_EQ(load("fix: [alpha, d*]").fix,
            (Names{"alpha1", "alpha2", "d1", "d2"}));
  EXPECT_EQ(load("fix: [joint 2]").fix,
            (Names{"beta2", "alpha2", "d2", "theta2", "r2"}));
  EXPECT_EQ(load("free: [theta]").free, (Names{"theta1", "theta2"}));
  EXPECT_EQ(load("fix: [offsets]").fix, (Names{"theta1", "theta2"}));
  EXPECT_EQ(load("fix: [geometry]").fix.size(), 10U);
  EXPECT_EQ(load("fix: [frames]").fix.size(), 18U);
  EXPECT_EQ(load("fix: [tool2]").fix.size(), 6U);
  EXPECT_EQ(load("prefer: [r, alpha1]").prefer, (Names{"r1", "r2", "alpha1"}));
  // The narrower entry counts.
  const IdentifiabilityOptions some = load("fix: [geometry], free: [theta]");
  EXPECT_EQ(some.fix.size(), 8U);
  EXPECT_EQ(some.free, (Names{"theta1", "theta2"}));
  const IdentifiabilityOptions one = load("fix: [theta1], free: [theta]");
  EXPECT_EQ(one.fix, (Names{"theta1"}));
  EXPECT_EQ(one.free, (Names{"theta2"}));
  // Offsets alone, and more where it is asked for.
  const IdentifiabilityOptions offsets =
      load("parameters: [offsets, frames], free: [d2]");
  EXPECT_TRUE(offsets.candidates.joints && offsets.candidates.base &&
              offsets.candidates.tool);
  EXPECT_EQ(offsets.fix,
            (Names{"beta1", "beta2", "alpha1", "alpha2", "d1", "r1", "r2"}));
}

// Whether loading fails with these words.
void ExpectRefusal(const DataJob& files, const std::string& job,
                   const std::string& says) {
  try {
    files.Load(job);
    FAIL() << "expected an error: " << says;
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find(says), std::string::npos)
        << error.what();
  }
}

TEST(JobDataTest, UnknownReferencesDoNotGoWithAllThatJobsAskFor) {
  const DataJob files;
  WriteFileAtomically(files.Path("truth.yaml"),
                      "format: alidade-deviations-1\n"
                      "units: {length: mm, angle: deg}\n"
                      "deviations: {r1: 0.5}\n");
  const std::string data = "data: {file: b.csv, target: ball}\n";
  ExpectRefusal(files, data + kReferences + "truth: truth.yaml\n",
                "known: true");
  ExpectRefusal(files,
                data + kReferences + "identifiability: {method: rules}\n",
                "method: rank");
  ExpectRefusal(files, data + kReferences + "bounds: {point2_y: [-1, 1]}\n",
                "bounds hold for joint parameters");
  ExpectRefusal(files, data + "bounds: {base_x: [-1, 1]}\n",
                "bounds hold for joint parameters");
}

TEST(JobDataTest, HoldsOutSets) {
  const DataJob files;
  const JobConfig job = files.Load(
      "data: [a.csv, {file: a.csv, columns: {}}]\n"
      "validation: {set: [check]}\n");
  EXPECT_EQ(job.data.training.num_poses(), 4);
  ASSERT_TRUE(job.data.validation.has_value());
  EXPECT_EQ(job.data.validation->num_poses(), 2);
  EXPECT_EQ(job.data.validation->blocks[0].measured(0, 1), 0.004);
  EXPECT_FALSE(job.options.holdout || job.options.folds);
}

TEST(JobDataTest, HoldsOutAFile) {
  DataJob files;
  files.Csv("c.csv", "x_mm,target", {"1,ball"});
  for (const char* name : {"2", "c.csv", "./c.csv"}) {
    const JobConfig job = files.Load(
        "data: [a.csv, c.csv]\nvalidation: {file: " + std::string(name) +
        "}\n");
    EXPECT_EQ(job.data.training.num_poses(), 3) << name;
    ASSERT_EQ(job.data.validation->num_poses(), 1) << name;
    EXPECT_EQ(job.data.validation->sources[0].line, 2);
  }
}

TEST(JobDataTest, DealsFolds) {
  const DataJob files;
  const JobConfig job = files.Load(
      "data: a.csv\nvalidation: {folds: 3, seed: 8}\n"
      "acceptance: {validation_rms: 1}\n");
  ASSERT_TRUE(job.options.folds.has_value());
  EXPECT_EQ(job.options.folds->folds, 3);
  EXPECT_EQ(job.options.folds->seed, 8U);
  EXPECT_EQ(job.data.training.num_poses(), 3);
  EXPECT_FALSE(job.data.validation.has_value());
  EXPECT_EQ(job.options.acceptance.validation_rms, 1e-3);
}

TEST(JobDataErrorTest, Entries) {
  const DataJob files;
  files.ExpectError("data: []\n", {7, 7, "data", "the list is empty"});
  files.ExpectError("data: [a.csv, {file: b.csv, tarket: x}]\n",
                    {7, 29, "data[2].tarket", "did you mean \"target\"?"});
  files.ExpectError("data: {file: a.csv, rotation: xyz}\n",
                    {7, 31, "data.rotation",
                     "unknown convention of rotations \"xyz\", did you mean "
                     "\"intrinsic_xyz\" or \"extrinsic_xyz\"? Expected one "
                     "of ignore, rotation_vector, intrinsic_xyz"});
  files.ExpectError("data: {file: a.csv, rotation: intrinsic_xy}\n",
                    {7, 31, "data.rotation", "did you mean \"intrinsic_xy"});
  files.ExpectError("data: {file: b.csv, target: bal}\n",
                    {7, 29, "data.target", "did you mean \"ball\"?"});
  files.ExpectError(
      "data: {file: b.csv, columns: {targets: {bal: [x, y, z]}}}\n",
      {7, 46, "data.columns.targets.bal", "unknown target \"bal\""});
  files.ExpectError(
      "data: {file: b.csv, columns: {target: t, targets: {ball: [x, y, z]}}}\n",
      {7, 51, "data.columns.targets", "found beside \"target\""});
  files.ExpectError("data: {file: b.csv, columns: {orientation: [a, b]}}\n",
                    {7, 44, "data.columns.orientation",
                     "of a rotation matrix, row by row, found 2"});
  files.ExpectError(
      "data: {file: a.csv, rotation_sigma: 0}\n",
      {7, 37, "data.rotation_sigma", "expected an angle above 0, found 0"});
  files.ExpectError("data: {file: b.csv, where: kind}\n",
                    {7, 28, "data.where", "expected a map of columns and"});
}

TEST(JobDataErrorTest, References) {
  const DataJob files;
  const std::string data = "data: {file: b.csv, target: ball}\n";
  files.ExpectError(
      data + "references: {distances: [{between: [P, R], distance: 5}]}\n",
      {8, 40, "references.distances[1].between[2]",
       "unknown reference point \"R\", expected one of P, Q"});
  files.ExpectError(
      data + "references: {distances: [{between: [P, P], distance: 5}]}\n",
      {8, 36, "references.distances[1].between", "two different points"});
  files.ExpectError(
      data + "references: {distances: [{between: [P, Q], distance: 0}]}\n",
      {8, 54, "references.distances[1].distance", "above 0, found 0"});
  files.ExpectError(data + "references: {points: [{name: A, known: true}]}\n",
                    {8, 23, "references.points[1].position", "missing"});
  files.ExpectError(data + "references: {points: [{name: A}, {name: A}]}\n",
                    {8, 41, "references.points[2].name", "\"A\" is repeated"});
  files.ExpectError(
      data + "references: {planes: [{name: A, normal: [0, 0, 0]}]}\n",
      {8, 41, "references.planes[1].normal", "is zero or out of range"});
}

TEST(JobDataErrorTest, BoundsAndNames) {
  const DataJob files;
  const std::string data = "data: {file: b.csv, target: ball}\n";
  files.ExpectError(
      data + "bounds: {r1: [1, 2]}\n",
      {8, 14, "bounds.r1", "the nominal value, 0, between them, found [1, 2]"});
  files.ExpectError(data + "bounds: {r1: [2, -2]}\n",
                    {8, 14, "bounds.r1", "lower < upper"});
  files.ExpectError(data + "bounds: {r1: [0, 0]}\n",
                    {8, 14, "bounds.r1", "lower < upper"});
  files.ExpectError(data + "bounds: {r3: [-1, 1]}\n",
                    {8, 10, "bounds.r3", "unknown key \"r3\""});
  files.ExpectError(
      data + "identifiability: {fix: [point3_x]}\n",
      {8, 25, "identifiability.fix[1]", "unknown parameter \"point3_x\""});
  files.ExpectError(data + "identifiability: {fix: [thetta]}\n",
                    {8, 25, "identifiability.fix[1]",
                     "unknown parameter \"thetta\", did you mean \"theta\"?"});
  files.ExpectError(data + "identifiability: {free: [joint 3]}\n",
                    {8, 26, "identifiability.free[1]",
                     "unknown parameter \"joint 3\", did you mean"});
  files.ExpectError(
      data + "identifiability: {fix: [alpha], free: [alpha]}\n",
      {8, 18, "identifiability", "stands in `fix` and in `free`"});
}

TEST(JobDataErrorTest, Validation) {
  DataJob files;
  const std::string data = "data: a.csv\n";
  files.ExpectError(data + "validation: {folds: 4}\n",
                    {8, 21, "validation.folds",
                     "the data set has 3 different configurations"});
  files.ExpectError(data + "validation: {folds: 1}\n",
                    {8, 21, "validation.folds", "an integer from 2"});
  files.ExpectError(data + "validation: {folds: 2, fraction: 0.5}\n",
                    {8, 13, "validation", "not both"});
  files.ExpectError(data + "validation: {set: check, seed: 1}\n",
                    {8, 13, "validation", "not both"});
  files.ExpectError(data + "validation: {set: [chek]}\n",
                    {8, 20, "validation.set[1]",
                     "unknown set \"chek\", did you mean \"check\"?"});
  files.ExpectError(data + "validation: {set: [check, fit]}\n",
                    {8, 19, "validation.set", "holds out all poses"});
  files.ExpectError(data + "validation: {file: x.csv}\n",
                    {8, 20, "validation.file", "its place in that list"});
  files.ExpectError(data + "validation: {file: 1}\n",
                    {8, 20, "validation.file", "holds out all poses"});
  files.ExpectError(
      "data: {file: b.csv, target: ball}\nvalidation: {set: a}\n",
      {8, 19, "validation.set", "no data set has a column \"set\""});
}

TEST(JobDataTest, StationsOfValidationDataAreThoseOfTheFit) {
  DataJob files;
  const std::string header = "x_mm,y_mm,z_mm,target,day";
  files.Csv("e.csv", header, {"1,2,3,ball,mon", "1,2,3,ball,tue"});
  files.Csv("f.csv", header, {"4,5,6,ball,tue", "4,5,6,ball,mon"});
  files.Csv("g.csv", header, {"4,5,6,ball,wed", "4,5,6,ball,mon"});
  const std::string data = "data: {file: e.csv, columns: {station: day}}\n";
  const std::string others = ", columns: {station: day}}}\n";
  const JobConfig job =
      files.Load(data + "validation: {data: {file: f.csv" + others);
  const Dataset& validation = *job.data.validation;
  EXPECT_EQ(validation.covariate_names,
            (std::vector<std::string>{"station tue"}));
  EXPECT_EQ(validation.covariates(0, 0), 1.0);
  EXPECT_EQ(validation.covariates(0, 1), 0.0);
  files.ExpectError(
      data + "validation: {data: {file: g.csv" + others,
      {8, 20, "validation.data", "station wed is none of those of `data`"});
}

TEST(JobDataErrorTest, RotationLimitsNeedOrientations) {
  const DataJob files;
  files.ExpectError(
      "data: a.csv\nacceptance: {train_rotation_rms: 1}\n",
      {8, 34, "acceptance.train_rotation_rms", "no orientation is measured"});
  files.ExpectError(
      "data: a.csv\nacceptance: {validation_rotation_max: 1}\n",
      {8, 39, "acceptance.validation_rotation_max", "add \"validation\""});
}

}  // namespace
}  // namespace alidade::internal
