#include "alidade/io/result_json.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/io/io_test_util.h"

namespace alidade {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// Statistics that are all different.
Accuracy MakeAccuracy(double scale) {
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

EvaluatedSet MakeEvaluatedSet(const std::string& name, double scale) {
  EvaluatedSet set;
  set.name = name;
  set.joint_dimensions = {Dimension::kAngle, Dimension::kLength};
  set.before = MakeAccuracy(scale);
  set.after = MakeAccuracy(1e-13 * scale);
  return set;
}

ParameterResult MakeParameter(const std::string& name, Dimension dimension) {
  ParameterResult parameter;
  parameter.name = name;
  parameter.kind = name.substr(0, 1);
  parameter.dimension = dimension;
  parameter.nominal = 0.1;
  parameter.value = 0.1 + 1.0 / 3e3;
  parameter.decision.name = name;
  return parameter;
}

SolverRun MakeRun() {
  SolverRun run;
  SolverSummary& summary = run.summary;
  summary.solver = "ceres";
  summary.status = SolverStatus::kRoundingFloor;
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
  summary.rounding_floor = 2e-16;
  summary.setup_time_s = 0.001;
  summary.solve_time_s = 0.25;
  summary.iterations = {{0, 1234.5, 0.005, 0.002, 0.0, true, 0.0},
                        {1, 12.25, 0.003, 0.001, 0.5, false, 0.125}};
  run.values = Eigen::Vector3d(1.0 / 3.0, -0.0, 1e-300);
  run.train = MakeAccuracy(1e-16);
  return run;
}

StudyResult MakeStudy() {
  StudyResult study;
  study.source = "A study";
  study.rows = {{"after_max", "2e-13 mm", "1.9e-13 mm"}};
  study.parameters.push_back(
      {"d4", Dimension::kLength, true, 0.16, 1e-4, 1e-4, 1.004e-4});
  study.parameters.push_back(
      {"beta1", Dimension::kAngle, false, 0.0, 0.009, 0.009, 0.009});
  study.absorptions = {{"r4", 1e-4, "d4", Dimension::kLength, 0.004, 4e-7}};
  study.angle_decimals = 4;
  study.length_decimals = 1;
  study.as_printed = MakeAccuracy(4e-7);
  study.three_more_decimals = MakeAccuracy(8e-10);
  study.timed_iterations = 100;
  study.timed_s = 0.01;
  study.published_s = 3543.198;
  return study;
}

JobResult MakeResult() {
  JobResult result;
  result.version = "0.1.0";
  result.command = "calibrate";
  result.title = "A \"test\" <\xc3\xa9>";
  result.arm = "two joints";
  result.inputs = {{"a.yaml", std::string(64, 'a')},
                   {"b.csv", std::string(64, 'b')}};
  result.seed = std::numeric_limits<std::uint64_t>::max();
  result.parameters = {MakeParameter("beta1", Dimension::kAngle),
                       MakeParameter("r3", Dimension::kLength)};
  result.parameters[0].truth = 0.2;
  result.parameters[0].std = 1e-5;
  ParameterDecision& decision = result.parameters[1].decision;
  decision.state = ParameterState::kFrozen;
  decision.rule = "parallel_r";
  decision.reason = "joint 3 is parallel to joint 2";
  decision.stands_for = "r2 + r3";
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
  result.heldout = MakeEvaluatedSet("heldout.csv", 2.0);
  result.study = MakeStudy();
  result.acceptance = {{"train_max", 1e-6, 2e-16}, {"heldout_max", 1e-6, 1.0}};
  result.identify_time_s = 0.002;
  result.total_time_s = 0.5;
  return result;
}

JobResult RoundTrip(const JobResult& result) {
  const TestDirectory directory;
  return LoadResultJson(
      directory.Write("result.json", FormatResultJson(result)));
}

void ExpectEqual(const Accuracy& a, const Accuracy& b) {
  EXPECT_EQ(a.mean, b.mean);
  EXPECT_EQ(a.rms, b.rms);
  EXPECT_EQ(a.stddev, b.stddev);
  EXPECT_EQ(a.median, b.median);
  EXPECT_EQ(a.p95, b.p95);
  EXPECT_EQ(a.min, b.min);
  EXPECT_EQ(a.max, b.max);
  EXPECT_EQ(a.n, b.n);
}

void ExpectEqual(const EvaluatedSet& a, const EvaluatedSet& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.joint_dimensions, b.joint_dimensions);
  ExpectEqual(a.before, b.before);
  ExpectEqual(a.after, b.after);
}

void ExpectEqual(const ParameterDecision& a, const ParameterDecision& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.state, b.state);
  EXPECT_EQ(a.rule, b.rule);
  EXPECT_EQ(a.reason, b.reason);
  EXPECT_EQ(a.stands_for, b.stands_for);
}

void ExpectEqual(const RankReport& a, const RankReport& b) {
  EXPECT_EQ(a.singular_values, b.singular_values);
  EXPECT_EQ(a.rank, b.rank);
  EXPECT_EQ(a.gap, b.gap);
}

void ExpectEqual(const SolverSummary& a, const SolverSummary& b) {
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
  EXPECT_EQ(a.rounding_floor, b.rounding_floor);
  EXPECT_EQ(a.setup_time_s, b.setup_time_s);
  EXPECT_EQ(a.solve_time_s, b.solve_time_s);
}

void ExpectEqual(const IterationRecord& a, const IterationRecord& b) {
  EXPECT_EQ(a.iteration, b.iteration);
  EXPECT_EQ(a.cost, b.cost);
  EXPECT_EQ(a.max_error, b.max_error);
  EXPECT_EQ(a.rms_error, b.rms_error);
  EXPECT_EQ(a.step_norm, b.step_norm);
  EXPECT_EQ(a.accepted, b.accepted);
  EXPECT_EQ(a.time_s, b.time_s);
}

TEST(ResultJsonTest, KeepsProvenance) {
  const JobResult result = MakeResult();
  const JobResult read = RoundTrip(result);
  EXPECT_EQ(read.version, result.version);
  EXPECT_EQ(read.command, result.command);
  EXPECT_EQ(read.title, result.title);
  EXPECT_EQ(read.arm, result.arm);
  EXPECT_EQ(read.seed, result.seed);
  EXPECT_EQ(read.identify_time_s, result.identify_time_s);
  EXPECT_EQ(read.total_time_s, result.total_time_s);
  ASSERT_EQ(read.inputs.size(), 2U);
  EXPECT_EQ(read.inputs[1].path, "b.csv");
  EXPECT_EQ(read.inputs[1].sha256, std::string(64, 'b'));
}

TEST(ResultJsonTest, KeepsParametersAndDecisions) {
  const JobResult result = MakeResult();
  const JobResult read = RoundTrip(result);
  ASSERT_EQ(read.parameters.size(), 2U);
  for (int i = 0; i < 2; ++i) {
    const ParameterResult& a = read.parameters[i];
    const ParameterResult& b = result.parameters[i];
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.kind, b.kind);
    EXPECT_EQ(a.dimension, b.dimension);
    EXPECT_EQ(a.nominal, b.nominal);
    EXPECT_EQ(a.value, b.value);
    EXPECT_EQ(a.truth, b.truth);
    ExpectEqual(a.decision, b.decision);
    ExpectEqual(read.identifiability.decisions[i], b.decision);
  }
  EXPECT_EQ(read.parameters[0].std, 1e-5);
  EXPECT_TRUE(std::isnan(read.parameters[1].std));
}

TEST(ResultJsonTest, KeepsIdentifiability) {
  const IdentifiabilityResult result = MakeResult().identifiability;
  const IdentifiabilityResult read = RoundTrip(MakeResult()).identifiability;
  EXPECT_EQ(read.method, result.method);
  ExpectEqual(read.nominal_rank, result.nominal_rank);
  ExpectEqual(read.perturbed_rank, result.perturbed_rank);
  EXPECT_EQ(read.num_free, result.num_free);
  EXPECT_EQ(read.exceeds_rank, result.exceeds_rank);
  EXPECT_EQ(read.refusal, result.refusal);
  EXPECT_EQ(read.warnings, result.warnings);
  EXPECT_EQ(read.weak, result.weak);
}

TEST(ResultJsonTest, KeepsRuns) {
  const JobResult result = MakeResult();
  const JobResult read = RoundTrip(result);
  ASSERT_EQ(read.runs.size(), 2U);
  for (int i = 0; i < 2; ++i) {
    ExpectEqual(read.runs[i].summary, result.runs[i].summary);
    ExpectEqual(read.runs[i].train, result.runs[i].train);
    EXPECT_EQ(read.runs[i].values, result.runs[i].values);
  }
  EXPECT_TRUE(std::signbit(read.runs[0].values[1]));
  ASSERT_EQ(read.runs[0].summary.iterations.size(), 2U);
  for (int i = 0; i < 2; ++i) {
    ExpectEqual(read.runs[0].summary.iterations[i],
                result.runs[0].summary.iterations[i]);
  }
}

TEST(ResultJsonTest, KeepsEveryStatus) {
  JobResult result = MakeResult();
  for (const SolverStatus status :
       {SolverStatus::kNotRun, SolverStatus::kConverged,
        SolverStatus::kRoundingFloor, SolverStatus::kIterationLimit,
        SolverStatus::kFailed, SolverStatus::kUnusable}) {
    result.runs[0].summary.status = status;
    EXPECT_EQ(RoundTrip(result).runs[0].summary.status, status);
  }
}

TEST(ResultJsonTest, KeepsAccuracyAndAcceptance) {
  const JobResult result = MakeResult();
  const JobResult read = RoundTrip(result);
  ExpectEqual(read.train, result.train);
  ASSERT_TRUE(read.heldout.has_value());
  ExpectEqual(*read.heldout, *result.heldout);
  ASSERT_EQ(read.acceptance.size(), 2U);
  EXPECT_EQ(read.acceptance[1].quantity, "heldout_max");
  EXPECT_EQ(read.acceptance[1].limit, 1e-6);
  EXPECT_EQ(read.acceptance[1].obtained, 1.0);
}

TEST(ResultJsonTest, KeepsTheStudy) {
  const StudyResult study = MakeStudy();
  const StudyResult read = RoundTrip(MakeResult()).study.value();
  EXPECT_EQ(read.source, study.source);
  ASSERT_EQ(read.rows.size(), 1U);
  EXPECT_EQ(read.rows[0].quantity, study.rows[0].quantity);
  EXPECT_EQ(read.rows[0].published, study.rows[0].published);
  EXPECT_EQ(read.rows[0].obtained, study.rows[0].obtained);
  ASSERT_EQ(read.parameters.size(), 2U);
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(read.parameters[i].name, study.parameters[i].name);
    EXPECT_EQ(read.parameters[i].dimension, study.parameters[i].dimension);
    EXPECT_EQ(read.parameters[i].identified, study.parameters[i].identified);
    EXPECT_EQ(read.parameters[i].nominal, study.parameters[i].nominal);
    EXPECT_EQ(read.parameters[i].assumed, study.parameters[i].assumed);
    EXPECT_EQ(read.parameters[i].published, study.parameters[i].published);
    EXPECT_EQ(read.parameters[i].obtained, study.parameters[i].obtained);
  }
  ASSERT_EQ(read.absorptions.size(), 1U);
  EXPECT_EQ(read.absorptions[0].frozen, "r4");
  EXPECT_EQ(read.absorptions[0].frozen_deviation, 1e-4);
  EXPECT_EQ(read.absorptions[0].taken_up_by, "d4");
  EXPECT_EQ(read.absorptions[0].dimension, Dimension::kLength);
  EXPECT_EQ(read.absorptions[0].coefficient, 0.004);
  EXPECT_EQ(read.absorptions[0].amount, 4e-7);
  EXPECT_EQ(read.angle_decimals, 4);
  EXPECT_EQ(read.length_decimals, 1);
  ExpectEqual(read.as_printed, study.as_printed);
  ExpectEqual(read.three_more_decimals, study.three_more_decimals);
  EXPECT_EQ(read.timed_iterations, 100);
  EXPECT_EQ(read.timed_s, 0.01);
  EXPECT_EQ(read.published_s, 3543.198);
}

TEST(ResultJsonTest, KeepsAnEmptyResult) {
  const JobResult read = RoundTrip(JobResult());
  EXPECT_TRUE(read.parameters.empty() && read.runs.empty());
  EXPECT_FALSE(read.heldout || read.study);
}

// The keys that other programs rely on.
TEST(FormatResultJsonTest, HasTheKeysOfTheDocumentation) {
  const auto json = nlohmann::json::parse(FormatResultJson(MakeResult()));
  EXPECT_EQ(json["format"], "alidade-result-1");
  EXPECT_EQ(json["inputs"][0]["sha256"], std::string(64, 'a'));
  EXPECT_EQ(json["seed"], 18446744073709551615U);
  EXPECT_EQ(json["parameters"][1]["state"], "frozen");
  EXPECT_EQ(json["parameters"][1]["unit"], "m");
  EXPECT_EQ(json["parameters"][1]["stands_for"], "r2 + r3");
  EXPECT_TRUE(json["parameters"][1]["std"].is_null());
  EXPECT_TRUE(json["identifiability"]["perturbed_rank"]["gap"].is_null());
  EXPECT_EQ(json["accuracy"]["train"]["before"]["n"], 56);
  EXPECT_EQ(json["accuracy"]["heldout"]["after"]["max"], 2e-13 / 23.0);
  EXPECT_EQ(json["solver"]["name"], "ceres");
  EXPECT_EQ(json["solver"]["status"], "rounding_floor");
  EXPECT_EQ(json["solver"]["iterations"], 1);
  EXPECT_EQ(json["solver"]["time_s"], 0.251);
  EXPECT_EQ(json["runs"][0]["history"][1]["accepted"], false);
  EXPECT_EQ(json["acceptance"][0]["met"], true);
  EXPECT_EQ(json["acceptance"][1]["met"], false);
}

TEST(FormatResultJsonTest, GivesTheSameBytesTwice) {
  EXPECT_EQ(FormatResultJson(MakeResult()), FormatResultJson(MakeResult()));
}

TEST(FormatResultJsonTest, SurvivesTextThatIsNoUtf8) {
  JobResult result = MakeResult();
  result.inputs[0].path = "\xff\xfe.yaml";
  EXPECT_NO_THROW(RoundTrip(result));
}

struct Damage {
  const char* name;
  std::string from;
  std::string to;
  ExpectedError expected;
};

void PrintTo(const Damage& damage, std::ostream* out) { *out << damage.name; }

class DamagedResultTest : public ::testing::TestWithParam<Damage> {};

TEST_P(DamagedResultTest, NamesThePlace) {
  const Damage& damage = GetParam();
  std::string text = FormatResultJson(MakeResult());
  const std::size_t at = text.find(damage.from);
  ASSERT_NE(at, std::string::npos);
  text.replace(at, damage.from.size(), damage.to);
  const TestDirectory directory;
  const std::string path = directory.Write("result.json", text);
  ExpectInputError([&] { LoadResultJson(path); }, damage.expected);
}

INSTANTIATE_TEST_SUITE_P(
    Results, DamagedResultTest,
    ::testing::Values(
        Damage{"Syntax",
               "\"version\": \"0.1.0\"",
               "\"version\": 0.1.0",
               {3, 17, "", "not valid JSON"}},
        Damage{"OtherFormat",
               "alidade-result-1",
               "alidade-result-9",
               {0, 0, "format", "unknown word \"alidade-result-9\""}},
        Damage{"MissingKey",
               "\"command\"",
               "\"comand\"",
               {0, 0, "command", "missing, expected this key"}},
        Damage{"MissingInnerKey",
               "\"nominal\"",
               "\"x\"",
               {0, 0, "parameters[1].nominal", "missing"}},
        Damage{
            "TextForNumber",
            "\"nominal\": 0.1",
            "\"nominal\": \"0.1\"",
            {0, 0, "parameters[1].nominal", "expected a number, found string"}},
        Damage{"UnknownUnit",
               "\"unit\": \"rad\"",
               "\"unit\": \"deg\"",
               {0, 0, "parameters[1].unit",
                "unknown word \"deg\", expected one of m, rad"}},
        Damage{"NegativeSeed",
               "18446744073709551615",
               "-1",
               {0, 0, "seed", "expected an integer not below zero"}},
        Damage{"HugeInteger",
               "\"rank\": 1",
               "\"rank\": 99999999999",
               {0, 0, "identifiability.nominal_rank.rank",
                "expected a smaller integer"}},
        Damage{"HugeNumber",
               "\"nominal\": 0.1",
               "\"nominal\": 1e999",
               {0, 0, "", "a number in it does not fit a double"}}),
    [](const ::testing::TestParamInfo<Damage>& damage) {
      return std::string(damage.param.name);
    });

TEST(LoadResultJsonTest, SurvivesEveryTruncation) {
  const TestDirectory directory;
  const std::string text = FormatResultJson(MakeResult());
  // The last two characters are a brace and a line break.
  for (std::size_t size = 0; size + 2 < text.size(); size += 37) {
    const std::string path =
        directory.Write("result.json", text.substr(0, size));
    EXPECT_THROW(LoadResultJson(path), InputError) << size;
  }
}

TEST(LoadResultJsonTest, SurvivesDeepNestingAndOtherRoots) {
  const TestDirectory directory;
  for (const std::string& text :
       {std::string(10000, '['),
        std::string(10000, '[') + std::string(10000, ']'), std::string("null"),
        std::string("12"), std::string("\xff")}) {
    const std::string path = directory.Write("result.json", text);
    EXPECT_THROW(LoadResultJson(path), InputError);
  }
}

TEST(LoadResultJsonTest, ReadsNullAsNotANumber) {
  JobResult result = MakeResult();
  result.parameters[0].value = kInfinity;
  result.parameters[1].value = kNan;
  const JobResult read = RoundTrip(result);
  EXPECT_TRUE(std::isnan(read.parameters[0].value));
  EXPECT_TRUE(std::isnan(read.parameters[1].value));
}

// What data of several kinds, poses of orientation and imports of foreign files
// add to a result.
JobResult MakeResultOfKinds() {
  JobResult result = MakeResult();
  result.runs[0].summary.evaluation = "compressed";
  result.train.rotation_before = MakeAccuracy(0.1);
  result.train.rotation_after = MakeAccuracy(0.01);
  result.heldout->rotation_before = MakeAccuracy(0.2);
  result.heldout->rotation_after = MakeAccuracy(0.02);
  result.stages = {{"frames only", 12, MakeAccuracy(3.0), MakeAccuracy(4.0),
                    MakeAccuracy(0.3), MakeAccuracy(0.4)},
                   {"all geometry", 30, MakeAccuracy(5.0), {}, {}, {}}};
  result.cross_validation =
      CrossValidation{7, MakeAccuracy(6.0), MakeAccuracy(0.6)};
  result.rejected = {{"data, \"1\".csv", 17, "not a number: \"--\""},
                     {"b.csv", 3, "joint 2 is outside of its limits"}};
  result.aliases = {{"point1", "A"}, {"tool2", "ball, \"left\""}};
  result.references = {
      {"point1", "A", true, {1.0 / 3.0, -2.0, 0.25}, kNan},
      {"plane1", "table, \"top\"", false, {0.6, 0.0, 0.8}, -1.0 / 7.0}};
  result.repeats = {1.0 / 3e4, 123456789012, 1.0 / 7e3, 9};
  result.acceptance.push_back(
      {"heldout_rotation_rms", 1e-3, 1.0 / 3e3, Dimension::kAngle});
  result.estimated_sigma = 1.0 / 3e5;
  result.estimated_rotation_sigma = 1.0 / 7e4;
  result.reduced_chi_square = 1.0 / 0.9;
  return result;
}

void ExpectEqual(const StageResult& a, const StageResult& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.num_free, b.num_free);
  ExpectEqual(a.train, b.train);
  ExpectEqual(a.heldout, b.heldout);
  ExpectEqual(a.train_rotation, b.train_rotation);
  ExpectEqual(a.heldout_rotation, b.heldout_rotation);
}

TEST(ResultJsonTest, KeepsTheEvaluationOfEachSolver) {
  const JobResult read = RoundTrip(MakeResultOfKinds());
  EXPECT_EQ(read.runs[0].summary.evaluation, "compressed");
  EXPECT_EQ(read.runs[1].summary.evaluation, "");
}

TEST(ResultJsonTest, KeepsAccuraciesOfRotations) {
  const JobResult result = MakeResultOfKinds();
  const JobResult read = RoundTrip(result);
  ExpectEqual(read.train.rotation_before, result.train.rotation_before);
  ExpectEqual(read.train.rotation_after, result.train.rotation_after);
  ASSERT_TRUE(read.heldout.has_value());
  ExpectEqual(read.heldout->rotation_before, result.heldout->rotation_before);
  ExpectEqual(read.heldout->rotation_after, result.heldout->rotation_after);
  // Without orientations there are none.
  EXPECT_EQ(RoundTrip(MakeResult()).train.rotation_after.n, 0);
}

TEST(ResultJsonTest, KeepsStagesWithTheirRotations) {
  const JobResult result = MakeResultOfKinds();
  const JobResult read = RoundTrip(result);
  ASSERT_EQ(read.stages.size(), 2U);
  ExpectEqual(read.stages[0], result.stages[0]);
  ExpectEqual(read.stages[1], result.stages[1]);
}

TEST(ResultJsonTest, KeepsCrossValidation) {
  JobResult result = MakeResultOfKinds();
  const JobResult read = RoundTrip(result);
  ASSERT_TRUE(read.cross_validation.has_value());
  EXPECT_EQ(read.cross_validation->folds, 7);
  ExpectEqual(read.cross_validation->position,
              result.cross_validation->position);
  ExpectEqual(read.cross_validation->rotation,
              result.cross_validation->rotation);
  result.cross_validation->rotation = {};
  EXPECT_EQ(RoundTrip(result).cross_validation->rotation.n, 0);
  result.cross_validation.reset();
  EXPECT_FALSE(RoundTrip(result).cross_validation.has_value());
}

TEST(ResultJsonTest, KeepsRejectedRowsAndAliases) {
  const JobResult result = MakeResultOfKinds();
  const JobResult read = RoundTrip(result);
  ASSERT_EQ(read.rejected.size(), 2U);
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(read.rejected[i].file, result.rejected[i].file);
    EXPECT_EQ(read.rejected[i].line, result.rejected[i].line);
    EXPECT_EQ(read.rejected[i].reason, result.rejected[i].reason);
  }
  EXPECT_EQ(read.aliases, result.aliases);
}

TEST(ResultJsonTest, KeepsReferences) {
  const JobResult result = MakeResultOfKinds();
  const JobResult read = RoundTrip(result);
  ASSERT_EQ(read.references.size(), 2U);
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(read.references[i].block, result.references[i].block);
    EXPECT_EQ(read.references[i].name, result.references[i].name);
    EXPECT_EQ(read.references[i].is_known, result.references[i].is_known);
    EXPECT_EQ(read.references[i].vector, result.references[i].vector);
  }
  EXPECT_TRUE(std::isnan(read.references[0].offset));
  EXPECT_EQ(read.references[1].offset, -1.0 / 7.0);
  EXPECT_TRUE(RoundTrip(MakeResult()).references.empty());
}

TEST(ResultJsonTest, KeepsRepeatsAndTheFit) {
  const JobResult result = MakeResultOfKinds();
  const JobResult read = RoundTrip(result);
  EXPECT_EQ(read.repeats.length, result.repeats.length);
  EXPECT_EQ(read.repeats.length_freedom, 123456789012);
  EXPECT_EQ(read.repeats.rotation, result.repeats.rotation);
  EXPECT_EQ(read.repeats.rotation_freedom, 9);
  EXPECT_EQ(read.estimated_sigma, result.estimated_sigma);
  EXPECT_EQ(read.estimated_rotation_sigma, result.estimated_rotation_sigma);
  EXPECT_EQ(read.reduced_chi_square, result.reduced_chi_square);
}

UncertaintyResult MakeUncertainty() {
  UncertaintyResult uncertainty;
  uncertainty.confidence = 0.9;
  uncertainty.degrees_of_freedom = 1.0 / 3e-2;
  uncertainty.estimator = "sandwich";
  uncertainty.parameters = {
      {"beta1", 1e-5 / 3.0, {-1.0 / 7.0, 0.25, true}, 0.125, 1.0 / 9.0},
      {"r1", kInfinity, {-kInfinity, kInfinity, false}, kInfinity, 0.0}};
  uncertainty.covariance.resize(2, 2);
  uncertainty.covariance << 1.0 / 3.0, 2.0, 2.0, 5.0;
  uncertainty.correlated = {{"beta1", "r1", -0.99 / 3.0}};
  ResidualDiagnostics& residuals = uncertainty.residuals;
  residuals.chi_square = 151.0 / 3.0;
  residuals.degrees_of_freedom = 150.5;
  residuals.reduced_chi_square = 1.0 / 3.0;
  residuals.normality = {0.3 / 7.0, 0.6 / 7.0};
  residuals.whiteness = {31.0 / 7.0, kNan};
  residuals.lags = 10;
  residuals.histogram.counts = {1, 2, 3};
  PredictedMap map;
  map.summary = MakeAccuracy(1e-4);
  map.true_summary = MakeAccuracy(2e-4);
  uncertainty.workspace = map;
  PredictionCheck check;
  check.confidence = 0.9;
  check.axes = {90, 100, 0.8 / 3.0, 0.95};
  check.ellipsoids = {31, 33, 0.75, 0.99};
  check.rms_z = 1.0 / 0.9;
  check.verdict = "agree";
  check.histogram.counts = {4, 5};
  uncertainty.heldout = check;
  uncertainty.warnings = {"it bends"};
  return uncertainty;
}

TEST(ResultJsonTest, KeepsTheUncertainty) {
  JobResult result = MakeResult();
  result.uncertainty = MakeUncertainty();
  result.sigma = 2e-5 / 3.0;
  const JobResult read = RoundTrip(result);
  EXPECT_EQ(read.sigma, result.sigma);
  ASSERT_TRUE(read.uncertainty);
  const UncertaintyResult& a = *result.uncertainty;
  const UncertaintyResult& b = *read.uncertainty;
  EXPECT_EQ(a.confidence, b.confidence);
  EXPECT_EQ(a.degrees_of_freedom, b.degrees_of_freedom);
  EXPECT_EQ(a.estimator, b.estimator);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(a.parameters[k].name, b.parameters[k].name);
    EXPECT_EQ(a.parameters[k].std, b.parameters[k].std);
    EXPECT_EQ(a.parameters[k].interval.lower, b.parameters[k].interval.lower);
    EXPECT_EQ(a.parameters[k].interval.upper, b.parameters[k].interval.upper);
    EXPECT_EQ(a.parameters[k].interval.is_profile,
              b.parameters[k].interval.is_profile);
    EXPECT_EQ(a.parameters[k].nonlinearity, b.parameters[k].nonlinearity);
    EXPECT_EQ(a.parameters[k].prior_share, b.parameters[k].prior_share);
  }
  EXPECT_EQ(a.covariance, b.covariance);
  EXPECT_EQ(a.correlated[0].second, b.correlated[0].second);
  EXPECT_EQ(a.correlated[0].correlation, b.correlated[0].correlation);
  EXPECT_EQ(a.residuals.chi_square, b.residuals.chi_square);
  EXPECT_EQ(a.residuals.normality.p_value, b.residuals.normality.p_value);
  EXPECT_TRUE(std::isnan(b.residuals.whiteness.p_value));
  EXPECT_EQ(a.residuals.histogram.counts, b.residuals.histogram.counts);
  ExpectEqual(a.workspace->summary, b.workspace->summary);
  ExpectEqual(a.workspace->true_summary, b.workspace->true_summary);
  EXPECT_EQ(a.heldout->axes.held, b.heldout->axes.held);
  EXPECT_EQ(a.heldout->ellipsoids.n, b.heldout->ellipsoids.n);
  EXPECT_EQ(a.heldout->rms_z, b.heldout->rms_z);
  EXPECT_EQ(a.heldout->verdict, b.heldout->verdict);
  EXPECT_EQ(a.heldout->histogram.counts, b.heldout->histogram.counts);
  EXPECT_EQ(a.warnings, b.warnings);
}

TEST(ResultJsonTest, KeepsTheUnitOfEachAcceptanceLimit) {
  const JobResult read = RoundTrip(MakeResultOfKinds());
  ASSERT_EQ(read.acceptance.size(), 3U);
  EXPECT_EQ(read.acceptance[0].dimension, Dimension::kLength);
  EXPECT_EQ(read.acceptance[2].dimension, Dimension::kAngle);
  EXPECT_EQ(read.acceptance[2].limit, 1e-3);
  EXPECT_EQ(read.acceptance[2].obtained, 1.0 / 3e3);
  EXPECT_TRUE(read.acceptance[2].met());
}

TEST(FormatResultJsonTest, HasTheKeysOfKinds) {
  const auto json =
      nlohmann::json::parse(FormatResultJson(MakeResultOfKinds()));
  EXPECT_EQ(json["solver"]["evaluation"], "compressed");
  EXPECT_EQ(json["accuracy"]["train"]["rotation_after"]["n"], 56);
  EXPECT_EQ(json["stages"][0]["heldout_rotation"]["max"], 0.4 / 23.0);
  EXPECT_FALSE(json["stages"][1].contains("heldout_rotation"));
  EXPECT_EQ(json["cross_validation"]["folds"], 7);
  EXPECT_EQ(json["rejected_rows"][1]["line"], 3);
  EXPECT_EQ(json["aliases"][0]["block"], "point1");
  EXPECT_EQ(json["aliases"][0]["name"], "A");
  EXPECT_EQ(json["references"][0]["position"][1], -2.0);
  EXPECT_EQ(json["references"][0]["known"], true);
  EXPECT_EQ(json["references"][1]["normal"][2], 0.8);
  EXPECT_EQ(json["references"][1]["offset"], -1.0 / 7.0);
  EXPECT_FALSE(json["references"][0].contains("offset"));
  EXPECT_EQ(json["repeats"]["rotation_freedom"], 9);
  EXPECT_EQ(json["acceptance"][0]["unit"], "m");
  EXPECT_EQ(json["acceptance"][2]["unit"], "rad");
}

}  // namespace
}  // namespace alidade
