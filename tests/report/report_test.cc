#include "alidade/report/report.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

#include "tests/report/well_formed.h"

namespace alidade {
namespace {

bool Contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

// The text with every run of white space as one space, so that neither line
// breaks nor columns matter.
std::string Flat(const std::string& text) {
  std::istringstream words(text);
  std::string flat;
  for (std::string word; words >> word;)
    flat += (flat.empty() ? "" : " ") + word;
  return flat;
}

std::vector<std::string> Lines(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::vector<std::string> Cells(const std::string& line) {
  std::istringstream stream(line);
  std::vector<std::string> cells;
  for (std::string cell; std::getline(stream, cell, ',');) {
    cells.push_back(cell);
  }
  return cells;
}

std::string ContentOf(const std::vector<ReportFile>& files,
                      const std::string& name) {
  for (const ReportFile& file : files) {
    if (file.name == name) return file.content;
  }
  ADD_FAILURE() << "no file " << name;
  return "";
}

// A revolute and a prismatic joint; poses on a circle in the plane z = 0.215.
EvaluatedSet MakeSet(int num_poses, double before, double after) {
  EvaluatedSet set;
  set.name = "poses.csv";
  set.joint_values.resize(2, num_poses);
  set.joint_dimensions = {Dimension::kAngle, Dimension::kLength};
  set.positions.resize(3, num_poses);
  set.residual_before.resize(3, num_poses);
  set.residual_after.resize(3, num_poses);
  for (int i = 0; i < num_poses; ++i) {
    const double angle = 2.0 * kPi * i / num_poses;
    set.joint_values.col(i) << 0.25 * kPi, 0.012;
    set.positions.col(i) << 0.3 * std::cos(angle), 0.3 * std::sin(angle), 0.215;
    set.residual_before.col(i) << 0.6 * before, 0.0, -0.8 * before;
    set.residual_after.col(i) << 0.0, after, 0.0;
  }
  set.before = SummarizeErrors(set.ErrorBefore());
  set.after = SummarizeErrors(set.ErrorAfter());
  return set;
}

ParameterResult MakeParameter(const std::string& name, Dimension dimension,
                              double nominal, double value) {
  ParameterResult parameter;
  parameter.name = name;
  parameter.dimension = dimension;
  parameter.nominal = nominal;
  parameter.value = value;
  parameter.decision.name = name;
  return parameter;
}

std::vector<ParameterResult> MakeParameters() {
  ParameterResult beta = MakeParameter("beta1", Dimension::kAngle, 0.0, 0.009);
  beta.truth = 0.009;
  ParameterResult d = MakeParameter("d4", Dimension::kLength, 0.16, 0.1601004);
  d.truth = 0.1601;
  d.decision.stands_for = "d4 + 0.004 r4";
  ParameterResult r = MakeParameter("r4", Dimension::kLength, 0.0, 0.0);
  r.truth = 1e-4;
  r.decision.state = ParameterState::kFrozen;
  r.decision.rule = "parallel_r";
  r.decision.reason =
      "the axis of joint 4 is parallel to that of joint 2, so that r4 moves "
      "the point as r2 does, and only the first of them is kept";
  ParameterResult base = MakeParameter("base_x", Dimension::kLength, 0.0, 0.0);
  base.decision.state = ParameterState::kGiven;
  base.decision.reason = "not among the parameters to identify";
  return {beta, d, r, base};
}

IdentifiabilityResult MakeIdentifiability(
    const std::vector<ParameterResult>& parameters) {
  IdentifiabilityResult result;
  result.method = "rules";
  for (const auto& parameter : parameters) {
    result.decisions.push_back(parameter.decision);
  }
  result.num_free = 2;
  result.nominal_rank.singular_values = Eigen::Vector2d(1.0, 1e-17);
  result.nominal_rank.rank = 1;
  result.nominal_rank.gap = 3.2e11;
  result.perturbed_rank.singular_values = Eigen::Vector2d(1.0, 0.1);
  result.perturbed_rank.rank = 2;
  result.weak = {"beta1", "d4"};
  result.warnings = {"the rank is short at the nominal geometry"};
  return result;
}

SolverRun MakeRun(const std::string& solver, std::vector<double> errors) {
  SolverRun run;
  run.summary.solver = solver;
  run.summary.status = SolverStatus::kRoundingFloor;
  run.summary.message = "further steps are rounding";
  run.summary.initial_cost = 1000.0;
  run.summary.final_cost = 1e-20;
  run.summary.accepted_steps = static_cast<int>(errors.size()) - 1;
  run.summary.rounding_floor = 1.6e-16;
  run.summary.setup_time_s = 1e-3;
  run.summary.solve_time_s = 4.2e-3;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    IterationRecord record;
    record.iteration = static_cast<int>(i);
    record.max_error = errors[i];
    record.rms_error = 0.5 * errors[i];
    record.cost = 1e6 * errors[i];
    run.summary.iterations.push_back(record);
  }
  run.values = Eigen::Vector4d(0.009, 0.1601004, 0.0, 0.0);
  return run;
}

StudyParameter MakeStudyParameter(const ParameterResult& parameter,
                                  double published) {
  StudyParameter study;
  study.name = parameter.name;
  study.dimension = parameter.dimension;
  study.identified = parameter.decision.state == ParameterState::kFree;
  study.nominal = parameter.nominal;
  study.assumed = *parameter.truth - parameter.nominal;
  study.published = published;
  study.obtained = parameter.deviation();
  return study;
}

StudyResult MakeStudy(const std::vector<ParameterResult>& parameters) {
  StudyResult study;
  study.source = "A study of an arm";
  study.rows = {{"error after", "below 2e-13 mm", "2.1e-13 mm"}};
  study.parameters = {MakeStudyParameter(parameters[0], 0.009),
                      MakeStudyParameter(parameters[1], 1e-4),
                      MakeStudyParameter(parameters[2], 0.0)};
  study.absorptions = {{"r4", 1e-4, "d4", Dimension::kLength, 0.004, 4e-7}};
  study.angle_decimals = 4;
  study.length_decimals = 1;
  study.as_printed = SummarizeErrors(Eigen::VectorXd::Constant(20, 4e-7));
  study.three_more_decimals =
      SummarizeErrors(Eigen::VectorXd::Constant(20, 8e-10));
  study.timed_iterations = 100;
  study.timed_s = 0.01;
  study.published_s = 3543.0;
  return study;
}

JobResult MakeResult() {
  JobResult result;
  result.version = "1.2.3";
  result.command = "alidade calibrate job.yaml";
  result.title = "A calibration";
  result.arm = "two-joint arm";
  result.inputs = {{"job.yaml", std::string(64, 'a')}};
  result.seed = 42;
  result.parameters = MakeParameters();
  result.identifiability = MakeIdentifiability(result.parameters);
  result.train = MakeSet(5, 5.21e-3, 2.1e-16);
  result.heldout = MakeSet(20, 5.0e-3, 3e-16);
  result.runs = {MakeRun("ceres", {5.21e-3, 3e-5, 1e-8, 2.1e-16}),
                 MakeRun("pseudo_inverse", {5.21e-3, 1e-8, 2.2e-16})};
  result.runs[0].summary.iterations[1].accepted = false;
  result.runs[1].values[1] += 2e-15;
  result.study = MakeStudy(result.parameters);
  result.acceptance = {{"train_max", 1e-6, 2.1e-16}};
  result.total_time_s = 0.25;
  return result;
}

TEST(FormatIdentifiabilityTest, TellsEveryDecisionAndItsReason) {
  const std::string text = FormatIdentifiability(MakeResult().identifiability);
  const std::string flat = Flat(text);
  EXPECT_TRUE(Contains(flat,
                       "2 of 3 parameters are to be identified, 1 is "
                       "held at the nominal value."));
  EXPECT_TRUE(Contains(flat, "beta1 free"));
  EXPECT_TRUE(Contains(flat, "d4 free d4 + 0.004 r4"));
  EXPECT_TRUE(Contains(flat, "r4 frozen the axis of joint 4 is parallel"));
  EXPECT_TRUE(Contains(flat, "base_x given"));
  EXPECT_TRUE(Contains(flat, "these poses, nominal 1 of 2 3.2e+11"));
  EXPECT_TRUE(Contains(flat, "these poses, perturbed 2 of 2 nothing dropped"));
  EXPECT_TRUE(Contains(flat, "Told badly by these poses: beta1 d4"));
  EXPECT_TRUE(Contains(flat, "Warning: the rank is short"));
}

TEST(FormatIdentifiabilityTest, PutsEqualDecisionsInOneRow) {
  IdentifiabilityResult result;
  for (const char* name : {"alpha4", "theta4", "alpha5"}) {
    ParameterDecision decision;
    decision.name = name;
    decision.state = ParameterState::kFrozen;
    decision.reason = "its column is zero";
    result.decisions.push_back(decision);
  }
  EXPECT_TRUE(Contains(FormatIdentifiability(result),
                       "alpha4 theta4 alpha5  frozen  its column is zero"));
}

TEST(FormatIdentifiabilityTest, PrintsTheRefusal) {
  IdentifiabilityResult result;
  result.exceeds_rank = true;
  result.refusal = "alpha5 depends on r2";
  EXPECT_TRUE(Contains(FormatIdentifiability(result), "alpha5 depends on r2"));
}

TEST(FormatParametersTest, PrintsMillimetresAndDegrees) {
  const std::string flat = Flat(FormatParameters(MakeResult()));
  EXPECT_TRUE(
      Contains(flat, "beta1 deg 0.000000 0.515662 0.515662 0.515662 0 free"));
  EXPECT_TRUE(Contains(flat,
                       "d4 mm 160.000000 160.100400 0.100400 160.100000 "
                       "4.0e-04 free"));
  EXPECT_TRUE(
      Contains(flat, "r4 mm 0.000000 0.000000 0.000000 0.100000 -0.10 frozen"));
  EXPECT_TRUE(Contains(flat, "Given, and zero: base_x"));
}

TEST(FormatParametersTest, HasColumnsOfStdAndTruthWhereTheyAreKnown) {
  JobResult result = MakeResult();
  EXPECT_FALSE(Contains(FormatParameters(result), " std "));
  result.parameters[1].std = 2.5e-5;
  for (auto& parameter : result.parameters) parameter.truth.reset();
  const std::string flat = Flat(FormatParameters(result));
  EXPECT_TRUE(Contains(flat, " std "));
  EXPECT_FALSE(Contains(flat, "true value"));
  EXPECT_TRUE(
      Contains(flat, "d4 mm 160.000000 160.100400 0.100400 0.025 free"));
  EXPECT_TRUE(Contains(flat, "beta1 deg 0.000000 0.515662 0.515662 - free"));
}

TEST(FormatAccuracyTableTest, HasBeforeAndAfterOfBothSets) {
  const std::string flat = Flat(FormatAccuracyTable(MakeResult()));
  EXPECT_TRUE(Contains(flat,
                       "training poses before 5.210 5.210 0 5.210 5.210 "
                       "5.210 5"));
  EXPECT_TRUE(Contains(flat, "training poses after 2.100e-13"));
  EXPECT_TRUE(Contains(flat, "validation poses before 5.000"));
  EXPECT_TRUE(Contains(flat, "validation poses after 3.000e-13"));
}

TEST(FormatStudyTableTest, IsEmptyWithoutAStudy) {
  JobResult result = MakeResult();
  result.study.reset();
  EXPECT_EQ(FormatStudyTable(result), "");
  EXPECT_FALSE(Contains(FormatReport(result), "Published"));
}

TEST(FormatStudyTableTest, HasBothTablesOfTheStudy) {
  const std::string flat = Flat(FormatStudyTable(MakeResult()));
  EXPECT_TRUE(Contains(flat, "error after below 2e-13 mm 2.1e-13 mm"));
  // Table 1: joint 4 has d = 160 mm and r = 0.
  EXPECT_TRUE(Contains(flat, "4 160.0000 0.0000"));
  EXPECT_TRUE(Contains(flat, "beta1 rad 0.009000 0.0090 0.00900000 0 0 yes"));
  EXPECT_TRUE(Contains(flat, "d4 mm 0.100000 0.1 0.100400 0 0.400 yes"));
  EXPECT_TRUE(Contains(flat, "r4 mm 0.100000 0.0 0.000000 100 100 no"));
}

TEST(FormatStudyTableTest, ExplainsWhatAFrozenParameterDoes) {
  const std::string flat = Flat(FormatStudyTable(MakeResult()));
  EXPECT_TRUE(Contains(
      flat,
      "d4 comes out as 0.100400 mm, not 0.100000 mm: it takes up the frozen "
      "r4 (0.1000 mm off its nominal value) with coefficient 0.004000, that "
      "is 4.000e-04 mm. That explains the difference."));
}

TEST(FormatStudyTableTest, ClaimsNoExplanationThatTheNumbersDoNotBear) {
  JobResult result = MakeResult();
  result.study->absorptions[0].amount = 1e-7;
  const std::string flat = Flat(FormatStudyTable(result));
  EXPECT_FALSE(Contains(flat, "explains"));
  EXPECT_TRUE(Contains(flat,
                       "Together that is 1.000e-04 mm to first order, "
                       "of 4.000e-04 mm."));
}

TEST(FormatStudyTableTest, ExplainsThePrintedTable) {
  JobResult result = MakeResult();
  const std::string flat = Flat(FormatStudyTable(result));
  EXPECT_TRUE(Contains(flat,
                       "angles to 4 decimals of a radian, lengths to 1 "
                       "decimal of a mm"));
  EXPECT_TRUE(Contains(flat,
                       "4.0000e-04 mm (4.0e-07 m) in the mean, at most "
                       "4.0000e-04 mm, the same at every one of them."));
  EXPECT_TRUE(Contains(flat, "With 4 decimals of a mm it is 8.00e-07 mm"));
  EXPECT_TRUE(Contains(flat, "no limit of the calibration"));

  result.study->as_printed.min = 3e-7;
  result.heldout->after.max = 1e-6;
  const std::string other = Flat(FormatStudyTable(result));
  EXPECT_FALSE(Contains(other, "the same at every one"));
  EXPECT_FALSE(Contains(other, "no limit of the calibration"));
}

TEST(FormatStudyTableTest, ComparesTimes) {
  EXPECT_TRUE(Contains(Flat(FormatStudyTable(MakeResult())),
                       "100 iterations of the iterated pseudo-inverse take "
                       "10.0 ms here, and took 59.0 min"));
  EXPECT_TRUE(Contains(FormatStudyTable(MakeResult()), "354300"));
}

TEST(FormatComparisonTest, ShowsSolversSideBySide) {
  const std::string text = FormatComparison(MakeResult());
  const std::string flat = Flat(text);
  EXPECT_TRUE(Contains(flat, "solver Levenberg-Marquardt pseudo-inverse"));
  EXPECT_TRUE(Contains(flat, "iterations 3 2"));
  EXPECT_TRUE(Contains(flat, "chi-square before 1000 1000"));
  EXPECT_TRUE(Contains(flat, "time to solve 4.20 ms 4.20 ms"));
  EXPECT_TRUE(Contains(flat, "0 5.210 5210 5.210 5210"));
  EXPECT_TRUE(Contains(flat, "1 * 0.03000 30.00 1.000e-05 0.01000"));
  EXPECT_TRUE(Contains(flat, "* the step was tried and taken back"));
  EXPECT_TRUE(Contains(flat, "largest differences: d4 2.0e-12 mm"));
}

TEST(FormatComparisonTest, SaysWhereValuesAreTheSame) {
  JobResult result = MakeResult();
  result.runs[1].values = result.runs[0].values;
  EXPECT_TRUE(Contains(FormatComparison(result), "the same to the last bit"));
}

TEST(FormatComparisonTest, ShortensALongHistory) {
  JobResult result = MakeResult();
  result.runs[0] = MakeRun("ceres", std::vector<double>(1001, 1e-3));
  const std::string text = FormatComparison(result);
  EXPECT_LT(Lines(text).size(), 60U);
  EXPECT_TRUE(Contains(text, "\n     1000 "));
  EXPECT_TRUE(Contains(text, "\n      ..."));
}

TEST(FormatReportTest, BeginsWithTheVerdict) {
  const std::string text = FormatReport(MakeResult());
  const std::size_t accuracy = text.find("\nAccuracy\n");
  ASSERT_NE(accuracy, std::string::npos);
  const std::string head = Flat(text.substr(0, accuracy));
  EXPECT_TRUE(Contains(
      head,
      "The largest position error falls from 5.21 mm to 2.10e-13 mm at the 5 "
      "training poses and from 5.00 mm to 3.00e-13 mm at the 20 validation "
      "poses; Levenberg-Marquardt stopped at the rounding floor after 3 "
      "iterations; all acceptance limits are met."));
}

TEST(FormatReportTest, HasEverySectionAndTheProvenance) {
  const std::string text = FormatReport(MakeResult());
  for (const char* title :
       {"A calibration\n=", "\nAccuracy\n-", "\nWhat can be identified\n-",
        "\nParameters\n-", "\nSolvers\n-", "\nPublished study\n-",
        "\nProvenance\n-"}) {
    EXPECT_TRUE(Contains(text, title)) << title;
  }
  EXPECT_TRUE(Contains(text, "Alidade 1.2.3, seed 42"));
  EXPECT_TRUE(Contains(text, "alidade calibrate job.yaml"));
  EXPECT_TRUE(Contains(text, std::string(64, 'a')));
  EXPECT_TRUE(Contains(text, "whole job 250 ms"));
}

TEST(FormatReportTest, HasNoLineOverAHundredColumns) {
  for (const std::string& line : Lines(FormatReport(MakeResult()))) {
    EXPECT_LE(line.size(), 100U) << line;
    EXPECT_TRUE(line.empty() || line.back() != ' ') << line;
  }
}

TEST(FormatReportTest, ShoutsAMissedLimit) {
  JobResult result = MakeResult();
  result.acceptance.push_back({"heldout_max", 1e-16, 3e-16});
  const std::string flat = Flat(FormatReport(result));
  EXPECT_TRUE(Contains(flat, "1 of 2 acceptance limits MISSED."));
  EXPECT_TRUE(Contains(flat, "heldout_max mm 1.000e-13 3.000e-13 MISSED"));
}

TEST(FormatReportTest, SaysThatAnUnusableSolutionIsUnusable) {
  JobResult result = MakeResult();
  result.runs[0].summary.status = SolverStatus::kFailed;
  EXPECT_TRUE(Contains(Flat(FormatReport(result)),
                       "NOT USABLE: Levenberg-Marquardt failed"));
}

TEST(FormatReportTest, WorksOnAnEmptyResult) {
  const std::string text = FormatReport(JobResult());
  EXPECT_TRUE(Contains(text, "Nothing was calibrated: no solver has run."));
  JobResult refused;
  refused.identifiability.exceeds_rank = true;
  refused.identifiability.refusal = "alpha5 depends on r2.";
  EXPECT_TRUE(Contains(FormatReport(refused),
                       "Nothing was calibrated: alpha5 depends on r2."));
}

TEST(MakeCsvFilesTest, ColumnsReadBack) {
  const JobResult result = MakeResult();
  const std::vector<std::string> lines =
      Lines(ContentOf(MakeCsvFiles(result), "residuals.csv"));
  ASSERT_EQ(lines.size(), 6U);
  EXPECT_EQ(lines[0],
            "pose,q1_deg,q2_mm,x_mm,y_mm,z_mm,before_dx_mm,before_dy_mm,"
            "before_dz_mm,before_error_mm,after_dx_mm,after_dy_mm,after_dz_mm,"
            "after_error_mm");
  for (std::size_t pose = 1; pose < lines.size(); ++pose) {
    const std::vector<std::string> cells = Cells(lines[pose]);
    ASSERT_EQ(cells.size(), 14U);
    EXPECT_EQ(cells[0], std::to_string(pose));
    EXPECT_EQ(cells[1], "45");
    EXPECT_EQ(cells[2], "12");
    const auto column = static_cast<Eigen::Index>(pose - 1);
    EXPECT_EQ(std::atof(cells[3].c_str()),
              result.train.positions(0, column) / kMillimetre);
    EXPECT_EQ(std::atof(cells[8].c_str()),
              result.train.residual_before(2, column) / kMillimetre);
    EXPECT_EQ(std::atof(cells[9].c_str()),
              result.train.residual_before.col(column).norm() / kMillimetre);
    EXPECT_EQ(std::atof(cells[13].c_str()), 2.1e-16 / kMillimetre);
  }
}

TEST(MakeCsvFilesTest, HasEveryIterationOfEverySolver) {
  const std::vector<std::string> lines =
      Lines(ContentOf(MakeCsvFiles(MakeResult()), "iterations.csv"));
  ASSERT_EQ(lines.size(), 1U + 4U + 3U);
  EXPECT_EQ(lines[0],
            "solver,iteration,cost,max_error_mm,rms_error_mm,step_norm,"
            "accepted,time_s");
  const std::vector<std::string> cells = Cells(lines[2]);
  ASSERT_EQ(cells.size(), 8U);
  EXPECT_EQ(cells[0], "ceres");
  EXPECT_EQ(cells[1], "1");
  EXPECT_EQ(std::atof(cells[3].c_str()), 3e-5 / kMillimetre);
  EXPECT_EQ(cells[6], "false");
  EXPECT_EQ(Cells(lines[5])[0], "pseudo_inverse");
}

TEST(MakeCsvFilesTest, HasValidationPosesOnlyWhereThereAreAny) {
  JobResult result = MakeResult();
  EXPECT_EQ(Lines(ContentOf(MakeCsvFiles(result), "heldout.csv")).size(), 21U);
  result.heldout.reset();
  EXPECT_EQ(MakeCsvFiles(result).size(), 2U);
}

TEST(MakeFiguresTest, EachIsWellFormedAndHasItsHeadline) {
  const std::vector<ReportFile> files = MakeFigures(MakeResult());
  ASSERT_EQ(files.size(), 5U);
  for (const ReportFile& file : files) {
    EXPECT_EQ(WhatIsMalformed(file.content), "") << file.name;
    EXPECT_FALSE(Contains(file.content, "no data")) << file.name;
  }
  EXPECT_TRUE(Contains(ContentOf(files, "error_before.svg"), "5.21"));
  EXPECT_TRUE(Contains(ContentOf(files, "error_after.svg"), "2.10"));
  const std::string convergence = ContentOf(files, "convergence.svg");
  EXPECT_TRUE(Contains(convergence, "after 3 iterations"));
  EXPECT_TRUE(Contains(convergence, "after 2 iterations"));
  EXPECT_TRUE(Contains(convergence, "rounding floor"));
}

TEST(MakeFiguresTest, ValidationIsAMapOnlyInAHorizontalPlane) {
  JobResult result = MakeResult();
  EXPECT_TRUE(Contains(ContentOf(MakeFigures(result), "validation_after.svg"),
                       ">x [mm]</text>"));
  result.heldout->positions(2, 3) += 0.05;
  const std::string svg =
      ContentOf(MakeFigures(result), "validation_after.svg");
  EXPECT_FALSE(Contains(svg, ">x [mm]</text>"));
  EXPECT_TRUE(Contains(svg, ">validation pose</text>"));
}

TEST(MakeFiguresTest, DependsOnNothingButTheResult) {
  const std::vector<ReportFile> first = MakeFigures(MakeResult());
  const std::vector<ReportFile> second = MakeFigures(MakeResult());
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].content, second[i].content);
  }
}

TEST(MakeFiguresTest, SaysNoDataForAnEmptyResult) {
  for (const ReportFile& file : MakeFigures(JobResult())) {
    EXPECT_EQ(WhatIsMalformed(file.content), "");
    EXPECT_TRUE(Contains(file.content, "no data")) << file.name;
  }
}

// Three observations of two poses and one of none: a position with its target
// in quotes, a distance, an orientation, and a distance of two points.
EvaluatedSet MakeMixedSet() {
  EvaluatedSet set;
  set.name = "mixed.csv";
  set.joint_dimensions = {Dimension::kAngle, Dimension::kLength};
  set.joint_values.resize(2, 2);
  set.joint_values << 0.25 * kPi, 0.5 * kPi, 0.012, 0.016;
  set.labels = {{"position", 1, "ball, \"left\"", "data,1.csv:12"},
                {"distance", 0, "smr", "data.csv:7"},
                {"pose", 1, "", "", false, true},
                {"point distance", -1, "", ""}};
  set.positions.setConstant(3, 4, std::nan(""));
  set.positions.col(0) << 0.25, 0.5, 0.125;
  set.residual_before.setZero(3, 4);
  set.residual_before.col(0) << 0.003, 0.0, 0.004;
  set.residual_before(0, 1) = -0.002;
  set.residual_before(0, 3) = 0.001;
  set.residual_after.setZero(3, 4);
  set.residual_after(0, 1) = 0.0005;
  set.rotation_residual_before.setZero(3, 4);
  set.rotation_residual_before.col(2) << 0.0, 0.5 * kDegree, 0.0;
  set.rotation_residual_after.setZero(3, 4);
  set.rotation_residual_after.col(2) << 0.25 * kDegree, 0.0, 0.0;
  set.before = SummarizeErrors(Eigen::Vector2d(0.005, 0.002));
  set.after = SummarizeErrors(Eigen::Vector2d(0.0, 0.0005));
  set.rotation_before =
      SummarizeErrors(Eigen::VectorXd::Constant(1, 0.5 * kDegree));
  set.rotation_after =
      SummarizeErrors(Eigen::VectorXd::Constant(1, 0.25 * kDegree));
  return set;
}

std::vector<std::string> MixedLines() {
  JobResult result = MakeResult();
  result.train = MakeMixedSet();
  return Lines(ContentOf(MakeCsvFiles(result), "residuals.csv"));
}

TEST(MakeCsvFilesTest, LabelsObservationsOfSeveralKinds) {
  const std::vector<std::string> lines = MixedLines();
  ASSERT_EQ(lines.size(), 5U);
  EXPECT_EQ(lines[0],
            "pose,kind,target,where,q1_deg,q2_mm,x_mm,y_mm,z_mm,before_dx_mm,"
            "before_dy_mm,before_dz_mm,before_error_mm,after_dx_mm,after_dy_mm,"
            "after_dz_mm,after_error_mm,before_rotation_deg,"
            "after_rotation_deg");
  // Names are quoted where they hold a comma or quotes, which are doubled.
  EXPECT_EQ(lines[1],
            "2,position,\"ball, \"\"left\"\"\",\"data,1.csv:12\",90,16,"
            "250,500,125,3,0,4,5,0,0,0,0,,");
  // No position and no orientation was measured: empty cells.
  EXPECT_EQ(lines[2],
            "1,distance,smr,data.csv:7,45,12,,,,-2,0,0,2,0.5,0,0,0.5,,");
  EXPECT_EQ(lines[3], "2,pose,,,90,16,,,,,,,,,,,,0.5,0.25");
  // Of no pose.
  EXPECT_EQ(lines[4], ",point distance,,,,,,,,1,0,0,1,0,0,0,0,,");
}

TEST(MakeCsvFilesTest, HasNoColumnsOfRotationsWithoutOrientations) {
  JobResult result = MakeResult();
  result.train = MakeMixedSet();
  result.train.rotation_residual_before.resize(3, 0);
  result.train.rotation_residual_after.resize(3, 0);
  const std::string text = ContentOf(MakeCsvFiles(result), "residuals.csv");
  EXPECT_FALSE(Contains(text, "rotation"));
  EXPECT_TRUE(Contains(
      text, "1,distance,smr,data.csv:7,45,12,,,,-2,0,0,2,0.5,0,0,0.5\n"));
}

// No name breaks the lines of a table.
TEST(MakeCsvFilesTest, KeepsAnObservationInOneLine) {
  JobResult result = MakeResult();
  result.train = MakeMixedSet();
  result.train.labels[0].target = "one\ntwo";
  const std::vector<std::string> lines =
      Lines(ContentOf(MakeCsvFiles(result), "residuals.csv"));
  ASSERT_EQ(lines.size(), 5U);
  EXPECT_TRUE(Contains(lines[1], ",\"one two\","));
}

// Training and validation poses of orientation, one of them each.
JobResult MakeResultOfOrientations() {
  JobResult result = MakeResult();
  result.train = MakeMixedSet();
  result.heldout = MakeMixedSet();
  result.heldout->rotation_after =
      SummarizeErrors(Eigen::VectorXd::Constant(2, 0.125 * kDegree));
  return result;
}

TEST(FormatReportTest, HasATableOfOrientations) {
  const std::string flat = Flat(FormatReport(MakeResultOfOrientations()));
  EXPECT_TRUE(Contains(flat,
                       "orientation error [deg] calibration mean rms std "
                       "median p95 max n"));
  EXPECT_TRUE(Contains(flat,
                       "training poses before 0.5000 0.5000 0 0.5000 0.5000 "
                       "0.5000 1"));
  EXPECT_TRUE(Contains(flat,
                       "training poses after 0.2500 0.2500 0 0.2500 0.2500 "
                       "0.2500 1"));
  EXPECT_TRUE(Contains(flat,
                       "validation poses after 0.1250 0.1250 0 0.1250 0.1250 "
                       "0.1250 2"));
  EXPECT_FALSE(Contains(FormatReport(MakeResult()), "orientation"));
}

// Which kind and target errors belong to, of labelled observations alone.
TEST(FormatReportTest, TellsKindsAndTargetsApart) {
  JobResult result = MakeResult();
  EXPECT_FALSE(Contains(FormatReport(result), "of which"));
  result.train = MakeMixedSet();
  const std::string flat = Flat(FormatReport(result));
  EXPECT_TRUE(Contains(flat, "of which, after [mm]"));
  EXPECT_TRUE(Contains(flat,
                       "training poses distance of smr 0.5000 0.5000 0 "
                       "0.5000 0.5000 0.5000 1"));
  EXPECT_TRUE(
      Contains(flat, "training poses position of ball, \"left\" 0 0 0 0"));
  EXPECT_FALSE(Contains(flat, "point distance"));
}

TEST(FormatReportTest, HasCrossValidationOfBoth) {
  JobResult result = MakeResultOfOrientations();
  result.cross_validation = CrossValidation{
      5, SummarizeErrors(Eigen::VectorXd::Constant(2, 0.002)),
      SummarizeErrors(Eigen::VectorXd::Constant(2, 0.0625 * kDegree))};
  const std::string flat = Flat(FormatReport(result));
  EXPECT_TRUE(Contains(
      flat, "held out once 5 folds 2.000 2.000 0 2.000 2.000 2.000 2"));
  EXPECT_TRUE(Contains(flat,
                       "held out once 5 folds 0.06250 0.06250 0 0.06250 "
                       "0.06250 0.06250 2"));
  result.cross_validation->rotation = {};
  EXPECT_FALSE(Contains(Flat(FormatReport(result)), "0.06250"));
}

TEST(FormatReportTest, TellsWhatStagesBringToBoth) {
  JobResult result = MakeResultOfOrientations();
  StageResult stage;
  stage.name = "frames only";
  stage.num_free = 12;
  stage.train = SummarizeErrors(Eigen::VectorXd::Constant(2, 0.008));
  stage.heldout = SummarizeErrors(Eigen::VectorXd::Constant(2, 0.004));
  stage.train_rotation =
      SummarizeErrors(Eigen::VectorXd::Constant(2, 0.75 * kDegree));
  stage.heldout_rotation =
      SummarizeErrors(Eigen::VectorXd::Constant(2, 0.375 * kDegree));
  result.stages = {stage};
  std::string flat = Flat(FormatReport(result));
  EXPECT_TRUE(Contains(flat, "What each part of the calibration brings:"));
  EXPECT_TRUE(Contains(flat, "validation mean rms std median p95 max [mm]"));
  EXPECT_TRUE(Contains(flat, "frames only 12 4.000 4.000 0 4.000 4.000 4.000"));
  EXPECT_TRUE(Contains(
      flat, "validation orientation mean rms std median p95 max [deg]"));
  EXPECT_TRUE(
      Contains(flat, "frames only 12 0.3750 0.3750 0 0.3750 0.3750 0.3750"));
  // Without validation poses those of the training count.
  result.heldout.reset();
  flat = Flat(FormatReport(result));
  EXPECT_TRUE(Contains(flat, "frames only 12 8.000 8.000 0 8.000 8.000 8.000"));
  EXPECT_TRUE(
      Contains(flat, "frames only 12 0.7500 0.7500 0 0.7500 0.7500 0.7500"));
}

TEST(FormatReportTest, ListsRejectedRows) {
  JobResult result = MakeResult();
  EXPECT_FALSE(Contains(FormatReport(result), "Rejected rows"));
  result.rejected = {{"poses.csv", 17, "q2 is no number"}};
  std::string flat = Flat(FormatReport(result));
  EXPECT_TRUE(
      Contains(flat, "1 row took no part. result.json lists all of them."));
  EXPECT_TRUE(Contains(flat, "poses.csv 17 q2 is no number"));
  for (int line = 100; line < 140; ++line) {
    result.rejected.push_back({"poses.csv", line, "empty"});
  }
  flat = Flat(FormatReport(result));
  EXPECT_TRUE(Contains(flat, "41 rows took no part."));
  EXPECT_TRUE(Contains(flat, "The first 30:"));
  EXPECT_TRUE(Contains(flat, "poses.csv 128 empty"));
  EXPECT_FALSE(Contains(flat, "poses.csv 129 empty"));
}

TEST(FormatReportTest, TellsWhatRepeatsDifferBy) {
  JobResult result = MakeResult();
  EXPECT_FALSE(Contains(FormatReport(result), "Repeated"));
  result.repeats.length = 2.5e-5;
  result.repeats.length_freedom = 27;
  EXPECT_TRUE(Contains(Flat(FormatReport(result)),
                       "Repeated configurations differ by 0.0250 mm in a "
                       "coordinate (standard deviation, 27 degrees of "
                       "freedom): what no geometry can take away."));
  result.repeats.rotation = 0.125 * kDegree;
  result.repeats.rotation_freedom = 9;
  EXPECT_TRUE(Contains(Flat(FormatReport(result)),
                       "27 degrees of freedom) and 0.125 deg in orientation: "
                       "what no geometry can take away."));
}

TEST(FormatReportTest, NamesTargetsAndPointsAndUnitsOfLimits) {
  JobResult result = MakeResultOfOrientations();
  result.aliases = {{"tool2", "smr2"}, {"point1", "A"}};
  result.acceptance.push_back(
      {"heldout_rotation_max", kDegree, 0.5 * kDegree, Dimension::kAngle});
  const std::string text = FormatReport(result);
  const std::string flat = Flat(text);
  EXPECT_TRUE(Contains(flat, "tool2 is smr2, point1 is A."));
  EXPECT_TRUE(Contains(flat, "heldout_rotation_max deg 1.000 0.5000 met"));
  for (const std::string& line : Lines(text)) {
    EXPECT_LE(line.size(), 100U) << line;
  }
}

}  // namespace
}  // namespace alidade
