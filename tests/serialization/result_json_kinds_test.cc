// Results of other kinds than positions, their stages and their uncertainty.

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <tuple>

#include "src/common/constants.h"
#include "src/serialization/result_json.h"
#include "tests/serialization/result_json_util.h"
#include "tests/support/io_test_util.h"

namespace alidade::internal::result_json_kinds_test {
namespace {

using testing::ExpectEqual;
using testing::MakeAccuracy;
using testing::MakeResult;
using testing::RoundTrip;

// What data of several kinds, poses of orientation and imports of foreign files
// add to a result.
CalibrationResult MakeResultOfKinds() {
  CalibrationResult result = MakeResult();
  result.runs[0].summary.evaluation = "reduced";
  result.train.rotation_before = MakeAccuracy(0.1);
  result.train.rotation_after = MakeAccuracy(0.01);
  result.validation->rotation_before = MakeAccuracy(0.2);
  result.validation->rotation_after = MakeAccuracy(0.02);
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
      {"validation_rotation_rms", 1e-3, 1.0 / 3e3, Dimension::kAngle});
  result.estimated_sigma = 1.0 / 3e5;
  result.estimated_rotation_sigma = 1.0 / 7e4;
  result.reduced_chi_square = 1.0 / 0.9;
  return result;
}

void ExpectEqual(const StageResult& a, const StageResult& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.num_free, b.num_free);
  ExpectEqual(a.train, b.train);
  ExpectEqual(a.validation, b.validation);
  ExpectEqual(a.train_rotation, b.train_rotation);
  ExpectEqual(a.validation_rotation, b.validation_rotation);
}

TEST(ResultJsonTest, KeepsTheEvaluationOfEachSolver) {
  const CalibrationResult read = RoundTrip(MakeResultOfKinds());
  EXPECT_EQ(read.runs[0].summary.evaluation, "reduced");
  EXPECT_EQ(read.runs[1].summary.evaluation, "");
}

TEST(ResultJsonTest, KeepsAccuraciesOfRotations) {
  const CalibrationResult result = MakeResultOfKinds();
  const CalibrationResult read = RoundTrip(result);
  ExpectEqual(read.train.rotation_before, result.train.rotation_before);
  ExpectEqual(read.train.rotation_after, result.train.rotation_after);
  ASSERT_TRUE(read.validation.has_value());
  ExpectEqual(read.validation->rotation_before,
              result.validation->rotation_before);
  ExpectEqual(read.validation->rotation_after,
              result.validation->rotation_after);
  // Without orientations there are none.
  EXPECT_EQ(RoundTrip(MakeResult()).train.rotation_after.n, 0);
}

TEST(ResultJsonTest, KeepsStagesWithTheirRotations) {
  const CalibrationResult result = MakeResultOfKinds();
  const CalibrationResult read = RoundTrip(result);
  ASSERT_EQ(read.stages.size(), 2U);
  ExpectEqual(read.stages[0], result.stages[0]);
  ExpectEqual(read.stages[1], result.stages[1]);
}

TEST(ResultJsonTest, KeepsCrossValidation) {
  CalibrationResult result = MakeResultOfKinds();
  const CalibrationResult read = RoundTrip(result);
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

TEST(ResultJsonTest, KeepsErrorTerms) {
  CalibrationResult result = MakeResult();
  ErrorTermsResult& errors = result.error_terms.emplace();
  errors.share = 0.75;
  errors.sentence = "error terms are estimated";
  errors.region_error = 1.5e-4;
  errors.random_error = 1.25e-4;
  ErrorRung& rung = errors.rungs.emplace_back();
  rung.name = "elasticity";
  rung.num_terms = 18;
  rung.weight = 0.5;
  rung.compliance_std = 3e-5;
  rung.validation = MakeAccuracy(7.0);
  errors.terms = {{"k2_z", 4.5e-5, 1.25e-5, "rad/(N m)"},
                  {"g2_3", 1e-4, kNan, "1"}};
  errors.effects = {{0, "all", 1e-3, 2e-3}, {2, "elasticity", 1e-4, 3e-4}};
  errors.measured = {{1, -0.5, 0.25}};
  const CalibrationResult read = RoundTrip(result);
  ASSERT_TRUE(read.error_terms);
  EXPECT_EQ(read.error_terms->share, 0.75);
  EXPECT_EQ(read.error_terms->sentence, errors.sentence);
  EXPECT_EQ(read.error_terms->region_error, 1.5e-4);
  EXPECT_EQ(read.error_terms->random_error, 1.25e-4);
  ASSERT_EQ(read.error_terms->rungs.size(), 1U);
  EXPECT_EQ(read.error_terms->rungs[0].num_terms, 18);
  EXPECT_EQ(read.error_terms->rungs[0].weight, 0.5);
  EXPECT_EQ(read.error_terms->rungs[0].compliance_std, 3e-5);
  ExpectEqual(read.error_terms->rungs[0].validation, rung.validation);
  ASSERT_EQ(read.error_terms->terms.size(), 2U);
  EXPECT_EQ(read.error_terms->terms[0].name, "k2_z");
  EXPECT_EQ(read.error_terms->terms[0].value, 4.5e-5);
  EXPECT_EQ(read.error_terms->terms[0].std, 1.25e-5);
  EXPECT_EQ(read.error_terms->terms[0].unit, "rad/(N m)");
  EXPECT_TRUE(std::isnan(read.error_terms->terms[1].std));
  ASSERT_EQ(read.error_terms->effects.size(), 2U);
  EXPECT_EQ(read.error_terms->effects[1].joint, 2);
  EXPECT_EQ(read.error_terms->effects[1].term, "elasticity");
  EXPECT_EQ(read.error_terms->effects[1].rms, 1e-4);
  EXPECT_EQ(read.error_terms->effects[1].max, 3e-4);
  ASSERT_EQ(read.error_terms->measured.size(), 1U);
  EXPECT_EQ(read.error_terms->measured[0].joint, 1);
  EXPECT_EQ(read.error_terms->measured[0].lower, -0.5);
  EXPECT_EQ(read.error_terms->measured[0].upper, 0.25);
}

TEST(ResultJsonTest, KeepsRejectedRowsAndAliases) {
  const CalibrationResult result = MakeResultOfKinds();
  const CalibrationResult read = RoundTrip(result);
  ASSERT_EQ(read.rejected.size(), 2U);
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(read.rejected[i].file, result.rejected[i].file);
    EXPECT_EQ(read.rejected[i].line, result.rejected[i].line);
    EXPECT_EQ(read.rejected[i].reason, result.rejected[i].reason);
  }
  EXPECT_EQ(read.aliases, result.aliases);
}

TEST(ResultJsonTest, KeepsReferences) {
  const CalibrationResult result = MakeResultOfKinds();
  const CalibrationResult read = RoundTrip(result);
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

// A damaged file is an error with its place, in a summary and a record too.
TEST(LoadResultJsonTest, RefusesVectorsOfOtherSizes) {
  auto json = nlohmann::json::parse(FormatResultJson(MakeResultOfKinds()));
  json["references"][0]["position"].push_back(1.0);
  const TestDirectory directory;
  const std::string path = directory.Write("result.json", json.dump());
  ExpectInputError([&] { LoadResultJson(path); },
                   {0, 0, "references[1].position", "expected 3 numbers"});
}

TEST(LoadBatchSummaryTest, NamesThePlace) {
  const std::string text = FormatBatchSummary({"1", {BatchEntry()}, ""});
  const TestDirectory directory;
  for (const auto& [from, to, expected] :
       {std::tuple<std::string, std::string, ExpectedError>{
            "alidade-batch-2",
            "alidade-batch-9",
            {0, 0, "format", "unknown word \"alidade-batch-9\""}},
        {"\"not_run\",", "\"runs\",", {0, 0, "jobs[1].status", "unknown word"}},
        {"\"iterations\": 0",
         "\"iterations\": 0.5",
         {0, 0, "jobs[1].iterations", "expected an integer"}}}) {
    std::string damaged = text;
    damaged.replace(damaged.find(from), from.size(), to);
    const std::string path = directory.Write("summary.json", damaged);
    ExpectInputError([&, file = path] { LoadBatchSummary(file); }, expected);
  }
}

TEST(ParseBatchRecordTest, IsNothingForLinesThatAreNoRecords) {
  const std::string line = FormatBatchRecord(BatchRecord());
  EXPECT_TRUE(ParseBatchRecord(line).has_value());
  EXPECT_FALSE(ParseBatchRecord(line.substr(0, line.size() / 2)).has_value());
  EXPECT_FALSE(ParseBatchRecord("{}").has_value());
  EXPECT_FALSE(ParseBatchRecord("[1]").has_value());
}

TEST(ResultJsonTest, KeepsRepeatsAndTheFit) {
  const CalibrationResult result = MakeResultOfKinds();
  const CalibrationResult read = RoundTrip(result);
  EXPECT_EQ(read.repeats.length, result.repeats.length);
  EXPECT_EQ(read.repeats.length_degrees_of_freedom, 123456789012);
  EXPECT_EQ(read.repeats.rotation, result.repeats.rotation);
  EXPECT_EQ(read.repeats.rotation_degrees_of_freedom, 9);
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
  uncertainty.validation = check;
  uncertainty.warnings = {"it bends"};
  return uncertainty;
}

TEST(ResultJsonTest, KeepsTheUncertainty) {
  CalibrationResult result = MakeResult();
  result.uncertainty = MakeUncertainty();
  result.sigma = 2e-5 / 3.0;
  const CalibrationResult read = RoundTrip(result);
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
  EXPECT_EQ(a.validation->axes.held, b.validation->axes.held);
  EXPECT_EQ(a.validation->ellipsoids.n, b.validation->ellipsoids.n);
  EXPECT_EQ(a.validation->rms_z, b.validation->rms_z);
  EXPECT_EQ(a.validation->verdict, b.validation->verdict);
  EXPECT_EQ(a.validation->histogram.counts, b.validation->histogram.counts);
  EXPECT_EQ(a.warnings, b.warnings);
}

TEST(ResultJsonTest, KeepsTheUnitOfEachAcceptanceLimit) {
  const CalibrationResult read = RoundTrip(MakeResultOfKinds());
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
  EXPECT_EQ(json["solver"]["evaluation"], "reduced");
  EXPECT_EQ(json["accuracy"]["train"]["rotation_after"]["n"], 56);
  EXPECT_EQ(json["stages"][0]["validation_rotation"]["max"], 0.4 / 23.0);
  EXPECT_FALSE(json["stages"][1].contains("validation_rotation"));
  EXPECT_EQ(json["cross_validation"]["folds"], 7);
  EXPECT_EQ(json["rejected_rows"][1]["line"], 3);
  EXPECT_EQ(json["aliases"][0]["block"], "point1");
  EXPECT_EQ(json["aliases"][0]["name"], "A");
  EXPECT_EQ(json["references"][0]["position"][1], -2.0);
  EXPECT_EQ(json["references"][0]["known"], true);
  EXPECT_EQ(json["references"][1]["normal"][2], 0.8);
  EXPECT_EQ(json["references"][1]["offset"], -1.0 / 7.0);
  EXPECT_FALSE(json["references"][0].contains("offset"));
  EXPECT_EQ(json["repeats"]["rotation_degrees_of_freedom"], 9);
  EXPECT_EQ(json["acceptance"][0]["unit"], "m");
  EXPECT_EQ(json["acceptance"][2]["unit"], "rad");
}

}  // namespace
}  // namespace alidade::internal::result_json_kinds_test
