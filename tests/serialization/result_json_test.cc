#include "src/serialization/result_json.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "src/common/constants.h"
#include "tests/serialization/result_json_util.h"
#include "tests/support/io_test_util.h"

namespace alidade::internal::result_json_test {
namespace {

using testing::ExpectEqual;
using testing::MakeResult;
using testing::RoundTrip;

TEST(ResultJsonTest, KeepsProvenance) {
  const CalibrationResult result = MakeResult();
  const CalibrationResult read = RoundTrip(result);
  EXPECT_EQ(read.version, result.version);
  EXPECT_EQ(read.command, result.command);
  EXPECT_EQ(read.title, result.title);
  EXPECT_EQ(read.arm_name, result.arm_name);
  EXPECT_EQ(read.seed, result.seed);
  EXPECT_EQ(read.identify_time_s, result.identify_time_s);
  EXPECT_EQ(read.total_time_s, result.total_time_s);
  ASSERT_EQ(read.inputs.size(), 2U);
  EXPECT_EQ(read.inputs[1].path, "b.csv");
  EXPECT_EQ(read.inputs[1].sha256, std::string(64, 'b'));
}

TEST(ResultJsonTest, KeepsParametersAndDecisions) {
  const CalibrationResult result = MakeResult();
  const CalibrationResult read = RoundTrip(result);
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

TEST(ResultJsonTest, KeepsTheVerdict) {
  CalibrationResult result = MakeResult();
  result.parameters[0].assessment = ParameterAssessment::kPriorDominated;
  result.plausibility = {{"plausibility.zero_positions", 2.0, 0.0, "two",
                          FindingLevel::kAttention}};
  result.verdict = {FindingLevel::kAttention,
                    "Usable, with warnings",
                    "It was better.",
                    {{"solver", kNan, kNan, "Done.", FindingLevel::kPassed},
                     {"rank", 16.0, 17.0, "Short.", FindingLevel::kNote}}};
  const CalibrationResult read = RoundTrip(result);
  EXPECT_EQ(read.parameters[0].assessment,
            ParameterAssessment::kPriorDominated);
  ASSERT_EQ(read.plausibility.size(), 1U);
  EXPECT_EQ(read.plausibility[0].statistic, 2.0);
  EXPECT_EQ(read.verdict.level, FindingLevel::kAttention);
  EXPECT_EQ(read.verdict.title, "Usable, with warnings");
  EXPECT_EQ(read.verdict.sentence, "It was better.");
  ASSERT_EQ(read.verdict.findings.size(), 2U);
  EXPECT_EQ(read.verdict.findings[0].key, "solver");
  EXPECT_TRUE(std::isnan(read.verdict.findings[0].statistic));
  EXPECT_EQ(read.verdict.findings[1].threshold, 17.0);
  EXPECT_EQ(read.verdict.findings[1].sentence, "Short.");
  EXPECT_EQ(read.verdict.findings[1].level, FindingLevel::kNote);
}

// Results of earlier versions have none of it.
TEST(ResultJsonTest, JudgesAResultWithoutVerdict) {
  nlohmann::json json = nlohmann::json::parse(FormatResultJson(MakeResult()));
  json.erase("verdict");
  json.erase("plausibility");
  for (auto& parameter : json["parameters"]) parameter.erase("assessment");
  const TestDirectory directory;
  const CalibrationResult read =
      LoadResultJson(directory.Write("result.json", json.dump()));
  EXPECT_EQ(read.verdict.title, "Not accepted");
  EXPECT_EQ(read.parameters[0].assessment, ParameterAssessment::kWeak);
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
  const CalibrationResult result = MakeResult();
  const CalibrationResult read = RoundTrip(result);
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
  CalibrationResult result = MakeResult();
  for (const SolverStatus status :
       {SolverStatus::kNotRun, SolverStatus::kConverged,
        SolverStatus::kPrecisionLimit, SolverStatus::kIterationLimit,
        SolverStatus::kFailed, SolverStatus::kUnusable}) {
    result.runs[0].summary.status = status;
    EXPECT_EQ(RoundTrip(result).runs[0].summary.status, status);
  }
}

TEST(ResultJsonTest, KeepsAccuracyAndAcceptance) {
  const CalibrationResult result = MakeResult();
  const CalibrationResult read = RoundTrip(result);
  ExpectEqual(read.train, result.train);
  ASSERT_TRUE(read.validation.has_value());
  ExpectEqual(*read.validation, *result.validation);
  ASSERT_EQ(read.acceptance.size(), 2U);
  EXPECT_EQ(read.acceptance[1].quantity, "validation_max");
  EXPECT_EQ(read.acceptance[1].limit, 1e-6);
  EXPECT_EQ(read.acceptance[1].obtained, 1.0);
}

TEST(ResultJsonTest, KeepsPublishedValues) {
  const CalibrationResult read = RoundTrip(MakeResult());
  EXPECT_EQ(read.published_source, "A study");
  EXPECT_EQ(read.parameters[0].published, 0.3);
  EXPECT_FALSE(read.parameters[1].published.has_value());
}

// Earlier versions wrote what studies/rv2aj computes.
TEST(ResultJsonTest, StudyOfAnEarlierVersionIsPassedOver) {
  auto json = nlohmann::json::parse(FormatResultJson(MakeResult()));
  json["study"] = {{"source", "A study"}, {"rows", nlohmann::json::array()}};
  const TestDirectory directory;
  const CalibrationResult read =
      LoadResultJson(directory.Write("result.json", json.dump()));
  EXPECT_EQ(read.parameters.size(), 2U);
}

// What results of format 1 call what they have in common with those of today.
TEST(ResultJsonTest, FilesOfFormat1AreRead) {
  const std::pair<const char*, const char*> names[] = {
      {"alidade-result-2", "alidade-result-1"},
      {"\"validation\":", "\"heldout\":"},
      {"\"identified_combination\"", "\"stands_for\""},
      {"\"state\": \"fixed\"", "\"state\": \"frozen\""},
      {"_degrees_of_freedom\"", "_freedom\""},
      {"\"precision_limit\"", "\"rounding_floor\""}};
  std::string text = FormatResultJson(MakeResult());
  for (const auto& [today, before] : names) {
    ASSERT_NE(text.find(today), std::string::npos) << today;
    for (std::size_t at = 0;
         (at = text.find(today, at)) != std::string::npos;) {
      text.replace(at, std::string(today).size(), before);
    }
  }
  const TestDirectory directory;
  const CalibrationResult read =
      LoadResultJson(directory.Write("result.json", text));
  EXPECT_EQ(FormatResultJson(read), FormatResultJson(RoundTrip(MakeResult())));
}

TEST(ResultJsonTest, KeepsAnEmptyResult) {
  const CalibrationResult read = RoundTrip(CalibrationResult());
  EXPECT_TRUE(read.parameters.empty() && read.runs.empty());
  EXPECT_FALSE(read.validation);
  EXPECT_EQ(read.published_source, "");
}

// The keys that other programs rely on.
TEST(FormatResultJsonTest, HasTheKeysOfTheDocumentation) {
  const auto json = nlohmann::json::parse(FormatResultJson(MakeResult()));
  EXPECT_EQ(json["format"], "alidade-result-2");
  EXPECT_EQ(json["inputs"][0]["sha256"], std::string(64, 'a'));
  EXPECT_EQ(json["seed"], 18446744073709551615U);
  EXPECT_EQ(json["parameters"][1]["state"], "fixed");
  EXPECT_EQ(json["parameters"][1]["unit"], "m");
  EXPECT_EQ(json["parameters"][1]["identified_combination"], "r2 + r3");
  EXPECT_TRUE(json["parameters"][1]["std"].is_null());
  EXPECT_TRUE(json["identifiability"]["perturbed_rank"]["gap"].is_null());
  EXPECT_EQ(json["accuracy"]["train"]["before"]["n"], 56);
  EXPECT_EQ(json["accuracy"]["validation"]["after"]["max"], 2e-13 / 23.0);
  EXPECT_EQ(json["solver"]["name"], "ceres");
  EXPECT_EQ(json["solver"]["status"], "precision_limit");
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
  CalibrationResult result = MakeResult();
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
               "alidade-result-2",
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
  CalibrationResult result = MakeResult();
  result.parameters[0].value = kInfinity;
  result.parameters[1].value = kNan;
  const CalibrationResult read = RoundTrip(result);
  EXPECT_TRUE(std::isnan(read.parameters[0].value));
  EXPECT_TRUE(std::isnan(read.parameters[1].value));
}

// What old names are replaced in is walked through by recursion.
TEST(ParseResultJsonTest, RefusesDeepNesting) {
  constexpr std::size_t kDepth = 100000;
  const std::string text = R"({"format": "alidade-result-1", "a": )" +
                           std::string(kDepth, '[') + std::string(kDepth, ']') +
                           "}";
  ExpectInputError([&] { ParseResultJson(text, "result.json"); },
                   {0, 0, "", "nested deeper than 100 levels"});
}

}  // namespace
}  // namespace alidade::internal::result_json_test
