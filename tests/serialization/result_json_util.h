#ifndef ALIDADE_TESTS_SERIALIZATION_RESULT_JSON_UTIL_H_
#define ALIDADE_TESTS_SERIALIZATION_RESULT_JSON_UTIL_H_

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "src/common/constants.h"
#include "src/serialization/result_json.h"
#include "tests/support/io_test_util.h"

namespace alidade::internal::testing {

// Statistics that are all different.
inline Accuracy MakeAccuracy(double scale) {
  Accuracy accuracy;
  accuracy.mean = scale / 3.0;
  accuracy.rms = scale / 7.0;
  accuracy.stddev = scale / 11.0;
  accuracy.median = scale / 13.0;
  accuracy.p95 = scale / 17.0;
  accuracy.min = scale / 19.0;
  accuracy.max = scale / 23.0;
  accuracy.n = 56;
  return accuracy;
}

inline EvaluatedSet MakeEvaluatedSet(const std::string& name, double scale) {
  EvaluatedSet set;
  set.name = name;
  set.joint_dimensions = {Dimension::kAngle, Dimension::kLength};
  set.before = MakeAccuracy(scale);
  set.after = MakeAccuracy(1e-13 * scale);
  return set;
}

inline ParameterResult MakeParameter(const std::string& name,
                                     Dimension dimension) {
  ParameterResult parameter;
  parameter.name = name;
  parameter.kind = name.substr(0, 1);
  parameter.dimension = dimension;
  parameter.nominal = 0.1;
  parameter.value = 0.1 + 1.0 / 3e3;
  parameter.decision.name = name;
  return parameter;
}

inline SolverRun MakeRun() {
  SolverRun run;
  SolverSummary& summary = run.summary;
  summary.solver = "ceres";
  summary.status = SolverStatus::kPrecisionLimit;
  summary.message = "stopped where rounding begins";
  summary.num_poses = 56;
  summary.num_residuals = 168;
  summary.num_parameters = 37;
  summary.num_free = 17;
  summary.initial_cost = 1234.5;
  summary.final_cost = 1e-20 / 3.0;
  summary.accepted_steps = 5;
  summary.rejected_steps = 1;
  summary.threads_given = 8;
  summary.threads_used = 1;
  summary.trust_region_given = 0.0;
  summary.trust_region_used = 1e10;
  summary.pseudo_inverse_tolerance_given = 1e-3;
  summary.pseudo_inverse_tolerance_used = 1e-9;
  summary.precision_limit = 2e-16;
  summary.setup_time_s = 0.001;
  summary.solve_time_s = 0.25;
  summary.iterations = {{0, 1234.5, 0.005, 0.002, 0.0, true, 0.0},
                        {1, 12.25, 0.003, 0.001, 0.5, false, 0.125}};
  run.values = Eigen::Vector3d(1.0 / 3.0, -0.0, 1e-300);
  run.train = MakeAccuracy(1e-16);
  return run;
}

inline CalibrationResult MakeResult() {
  CalibrationResult result;
  result.version = "0.1.0";
  result.command = "calibrate";
  result.title = "A \"test\" <\xc3\xa9>";
  result.arm_name = "two joints";
  result.inputs = {{"a.yaml", std::string(64, 'a')},
                   {"b.csv", std::string(64, 'b')}};
  result.seed = std::numeric_limits<std::uint64_t>::max();
  result.parameters = {MakeParameter("beta1", Dimension::kAngle),
                       MakeParameter("r3", Dimension::kLength)};
  result.parameters[0].truth = 0.2;
  result.parameters[0].published = 0.3;
  result.parameters[0].std = 1e-5;
  ParameterDecision& decision = result.parameters[1].decision;
  decision.state = ParameterState::kFixed;
  decision.rule = "parallel_r";
  decision.reason = "joint 3 is parallel to joint 2";
  decision.identified_combination = "r2 + r3";
  IdentifiabilityResult& identifiability = result.identifiability;
  identifiability.method = "rules";
  identifiability.decisions = {result.parameters[0].decision, decision};
  identifiability.nominal_rank.singular_values = Eigen::Vector2d(1.0, 1e-17);
  identifiability.nominal_rank.rank = 1;
  identifiability.nominal_rank.gap = 1e17;
  identifiability.perturbed_rank.singular_values = Eigen::Vector2d(1.0, 0.1);
  identifiability.perturbed_rank.rank = 2;
  identifiability.perturbed_rank.gap = kInfinity;
  identifiability.num_free = 1;
  identifiability.exceeds_rank = true;
  identifiability.refusal = "too many";
  identifiability.warnings = {"first", "second"};
  identifiability.weak = {"beta1"};
  result.runs = {MakeRun(), SolverRun()};
  result.runs[1].summary.solver = "pseudo_inverse";
  result.train = MakeEvaluatedSet("train.csv", 1.0);
  result.validation = MakeEvaluatedSet("validation.csv", 2.0);
  result.published_source = "A study";
  result.acceptance = {{"train_max", 1e-6, 2e-16},
                       {"validation_max", 1e-6, 1.0}};
  result.identify_time_s = 0.002;
  result.total_time_s = 0.5;
  return result;
}

inline CalibrationResult RoundTrip(const CalibrationResult& result) {
  const TestDirectory directory;
  return LoadResultJson(
      directory.Write("result.json", FormatResultJson(result)));
}

inline void ExpectEqual(const Accuracy& a, const Accuracy& b) {
  EXPECT_EQ(a.mean, b.mean);
  EXPECT_EQ(a.rms, b.rms);
  EXPECT_EQ(a.stddev, b.stddev);
  EXPECT_EQ(a.median, b.median);
  EXPECT_EQ(a.p95, b.p95);
  EXPECT_EQ(a.min, b.min);
  EXPECT_EQ(a.max, b.max);
  EXPECT_EQ(a.n, b.n);
}

inline void ExpectEqual(const EvaluatedSet& a, const EvaluatedSet& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.joint_dimensions, b.joint_dimensions);
  ExpectEqual(a.before, b.before);
  ExpectEqual(a.after, b.after);
}

inline void ExpectEqual(const ParameterDecision& a,
                        const ParameterDecision& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.state, b.state);
  EXPECT_EQ(a.rule, b.rule);
  EXPECT_EQ(a.reason, b.reason);
  EXPECT_EQ(a.identified_combination, b.identified_combination);
}

inline void ExpectEqual(const RankReport& a, const RankReport& b) {
  EXPECT_EQ(a.singular_values, b.singular_values);
  EXPECT_EQ(a.rank, b.rank);
  EXPECT_EQ(a.gap, b.gap);
}

inline void ExpectEqual(const SolverSummary& a, const SolverSummary& b) {
  EXPECT_EQ(a.solver, b.solver);
  EXPECT_EQ(a.status, b.status);
  EXPECT_EQ(a.message, b.message);
  EXPECT_EQ(a.num_poses, b.num_poses);
  EXPECT_EQ(a.num_residuals, b.num_residuals);
  EXPECT_EQ(a.num_parameters, b.num_parameters);
  EXPECT_EQ(a.num_free, b.num_free);
  EXPECT_EQ(a.initial_cost, b.initial_cost);
  EXPECT_EQ(a.final_cost, b.final_cost);
  EXPECT_EQ(a.accepted_steps, b.accepted_steps);
  EXPECT_EQ(a.rejected_steps, b.rejected_steps);
  EXPECT_EQ(a.threads_given, b.threads_given);
  EXPECT_EQ(a.threads_used, b.threads_used);
  EXPECT_EQ(a.trust_region_given, b.trust_region_given);
  EXPECT_EQ(a.trust_region_used, b.trust_region_used);
  EXPECT_EQ(a.pseudo_inverse_tolerance_given, b.pseudo_inverse_tolerance_given);
  EXPECT_EQ(a.pseudo_inverse_tolerance_used, b.pseudo_inverse_tolerance_used);
  EXPECT_EQ(a.precision_limit, b.precision_limit);
  EXPECT_EQ(a.setup_time_s, b.setup_time_s);
  EXPECT_EQ(a.solve_time_s, b.solve_time_s);
}

inline void ExpectEqual(const IterationRecord& a, const IterationRecord& b) {
  EXPECT_EQ(a.iteration, b.iteration);
  EXPECT_EQ(a.cost, b.cost);
  EXPECT_EQ(a.max_error, b.max_error);
  EXPECT_EQ(a.rms_error, b.rms_error);
  EXPECT_EQ(a.step_norm, b.step_norm);
  EXPECT_EQ(a.accepted, b.accepted);
  EXPECT_EQ(a.time_s, b.time_s);
}

}  // namespace alidade::internal::testing

#endif  // ALIDADE_TESTS_SERIALIZATION_RESULT_JSON_UTIL_H_
