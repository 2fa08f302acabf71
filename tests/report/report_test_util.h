#ifndef ALIDADE_TESTS_REPORT_REPORT_TEST_UTIL_H_
#define ALIDADE_TESTS_REPORT_REPORT_TEST_UTIL_H_

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "src/report/report.h"
#include "tests/support/edit.h"

namespace alidade::internal::testing {

inline bool Contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

// The text with every run of white space as one space, so that neither line
// breaks nor columns matter.
inline std::string Flat(const std::string& text) {
  std::istringstream words(text);
  std::string flat;
  for (std::string word; words >> word;)
    flat += (flat.empty() ? "" : " ") + word;
  return flat;
}

inline std::vector<std::string> Lines(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

inline std::vector<std::string> Cells(const std::string& line) {
  std::istringstream stream(line);
  std::vector<std::string> cells;
  for (std::string cell; std::getline(stream, cell, ',');) {
    cells.push_back(cell);
  }
  return cells;
}

inline std::string ContentOf(const std::vector<ReportFile>& files,
                             const std::string& name) {
  for (const ReportFile& file : files) {
    if (file.name == name) return file.Text();
  }
  ADD_FAILURE() << "no file " << name;
  return "";
}

// A revolute and a prismatic joint; poses on a circle in the plane z = 0.215.
inline EvaluatedSet MakeSet(int num_poses, double before, double after) {
  EvaluatedSet set;
  set.name = "poses.csv";
  set.joint_dimensions = {Dimension::kAngle, Dimension::kLength};
  Eigen::MatrixXd positions(3, num_poses);
  for (int i = 0; i < num_poses; ++i) {
    const double angle = 2.0 * kPi * i / num_poses;
    positions.col(i) << 0.3 * std::cos(angle), 0.3 * std::sin(angle), 0.215;
  }
  const auto repeated = [&](const Eigen::VectorXd& column) {
    return SharedMatrix::Repeated(column, num_poses);
  };
  set.joint_values = repeated(Eigen::Vector2d(0.25 * kPi, 0.012));
  set.positions = std::move(positions);
  set.residual_before =
      repeated(Eigen::Vector3d(0.6 * before, 0.0, -0.8 * before));
  set.residual_after = repeated(Eigen::Vector3d(0.0, after, 0.0));
  set.before = SummarizeErrors(set.ErrorBefore());
  set.after = SummarizeErrors(set.ErrorAfter());
  return set;
}

inline ParameterResult MakeParameter(const std::string& name,
                                     Dimension dimension, double nominal,
                                     double value) {
  ParameterResult parameter;
  parameter.name = name;
  parameter.dimension = dimension;
  parameter.nominal = nominal;
  parameter.value = value;
  parameter.decision.name = name;
  return parameter;
}

inline std::vector<ParameterResult> MakeParameters() {
  ParameterResult beta = MakeParameter("beta1", Dimension::kAngle, 0.0, 0.009);
  beta.truth = 0.009;
  ParameterResult d = MakeParameter("d4", Dimension::kLength, 0.16, 0.1601004);
  d.truth = 0.1601;
  d.decision.identified_combination = "d4 + 0.004 r4";
  ParameterResult r = MakeParameter("r4", Dimension::kLength, 0.0, 0.0);
  r.truth = 1e-4;
  r.decision.state = ParameterState::kFixed;
  r.decision.rule = "parallel_r";
  r.decision.reason =
      "the axis of joint 4 is parallel to that of joint 2, so that r4 moves "
      "the point as r2 does, and only the first of them is kept";
  ParameterResult base = MakeParameter("base_x", Dimension::kLength, 0.0, 0.0);
  base.decision.state = ParameterState::kGiven;
  base.decision.reason = "not among the parameters to identify";
  return {beta, d, r, base};
}

inline IdentifiabilityResult MakeIdentifiability(
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

inline SolverRun MakeRun(const std::string& solver,
                         std::vector<double> errors) {
  SolverRun run;
  run.summary.solver = solver;
  run.summary.status = SolverStatus::kPrecisionLimit;
  run.summary.message = "further steps are rounding";
  run.summary.initial_cost = 1000.0;
  run.summary.final_cost = 1e-20;
  run.summary.accepted_steps = static_cast<int>(errors.size()) - 1;
  run.summary.precision_limit = 1.6e-16;
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

inline CalibrationResult MakeResult() {
  CalibrationResult result;
  result.version = "1.2.3";
  result.command = "alidade calibrate job.yaml";
  result.title = "A calibration";
  result.arm_name = "two-joint arm";
  result.inputs = {{"job.yaml", std::string(64, 'a')}};
  result.seed = 42;
  result.parameters = MakeParameters();
  result.identifiability = MakeIdentifiability(result.parameters);
  result.train = MakeSet(5, 5.21e-3, 2.1e-16);
  result.validation = MakeSet(20, 5.0e-3, 3e-16);
  result.runs = {MakeRun("ceres", {5.21e-3, 3e-5, 1e-8, 2.1e-16}),
                 MakeRun("pseudo_inverse", {5.21e-3, 1e-8, 2.2e-16})};
  result.runs[0].summary.iterations[1].accepted = false;
  result.runs[1].values[1] += 2e-15;
  result.published_source = "A study of an arm";
  result.parameters[1].published = 0.1601;
  result.acceptance = {{"train_max", 1e-6, 2.1e-16}};
  result.total_time_s = 0.25;
  return result;
}

// Three observations of two poses and one of none: a position with its target
// in quotes, a distance, an orientation, and a distance of two points.
inline EvaluatedSet MakeMixedSet() {
  EvaluatedSet set;
  set.name = "mixed.csv";
  set.joint_dimensions = {Dimension::kAngle, Dimension::kLength};
  set.joint_values = Eigen::MatrixXd(2, 2);
  *testing::Edit(&set.joint_values) << 0.25 * kPi, 0.5 * kPi, 0.012, 0.016;
  set.labels = {{"position", 1, "ball, \"left\"", "data,1.csv:12"},
                {"distance", 0, "smr", "data.csv:7"},
                {"pose", 1, "", "", false, true},
                {"point distance", -1, "", ""}};
  set.positions = Eigen::MatrixXd::Constant(3, 4, std::nan(""));
  testing::Edit(&set.positions)->col(0) << 0.25, 0.5, 0.125;
  set.residual_before = Eigen::MatrixXd::Zero(3, 4);
  testing::Edit(&set.residual_before)->col(0) << 0.003, 0.0, 0.004;
  testing::Edit(&set.residual_before).at(0, 1) = -0.002;
  testing::Edit(&set.residual_before).at(0, 3) = 0.001;
  set.residual_after = Eigen::MatrixXd::Zero(3, 4);
  testing::Edit(&set.residual_after).at(0, 1) = 0.0005;
  set.rotation_residual_before = Eigen::MatrixXd::Zero(3, 4);
  testing::Edit(&set.rotation_residual_before)->col(2) << 0.0, 0.5 * kDegree,
      0.0;
  set.rotation_residual_after = Eigen::MatrixXd::Zero(3, 4);
  testing::Edit(&set.rotation_residual_after)->col(2) << 0.25 * kDegree, 0.0,
      0.0;
  set.before = SummarizeErrors(Eigen::Vector2d(0.005, 0.002));
  set.after = SummarizeErrors(Eigen::Vector2d(0.0, 0.0005));
  set.rotation_before =
      SummarizeErrors(Eigen::VectorXd::Constant(1, 0.5 * kDegree));
  set.rotation_after =
      SummarizeErrors(Eigen::VectorXd::Constant(1, 0.25 * kDegree));
  return set;
}

}  // namespace alidade::internal::testing

#endif  // ALIDADE_TESTS_REPORT_REPORT_TEST_UTIL_H_
