#include "src/calibration/verdict.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "tests/report/report_test_util.h"

namespace alidade::internal::verdict_test {
namespace {

using testing::Contains;
using testing::MakeResult;

Verdict VerdictOf(CalibrationResult result) {
  JudgeResult(&result);
  return result.verdict;
}

// The finding of a key; a failure where there is not exactly one.
Finding FindingOf(const CalibrationResult& result, const std::string& key) {
  Finding found;
  int count = 0;
  for (const Finding& finding : VerdictOf(result).findings) {
    if (finding.key != key) continue;
    found = finding;
    ++count;
  }
  EXPECT_EQ(count, 1) << key;
  return found;
}

bool HasFinding(const CalibrationResult& result, const std::string& key) {
  const Verdict verdict = VerdictOf(result);
  return std::any_of(verdict.findings.begin(), verdict.findings.end(),
                     [&key](const Finding& one) { return one.key == key; });
}

// Mean errors at the validation poses, before 10 mm.
CalibrationResult MakeResultAfter(double mean) {
  CalibrationResult result = MakeResult();
  result.validation->before.mean = 0.01;
  result.validation->after.mean = mean;
  result.validation->after.max = mean;
  return result;
}

// Where the arm was right before, errors grow by what the parameters are
// uncertain by, and with enough poses that is no chance.
TEST(VerdictTest, GrowthWithinTheUncertaintyOfTheParametersIsNoFailure) {
  CalibrationResult result = MakeResultAfter(0.0105);
  result.validation->change_t = 20.0;
  result.validation->before.rms = 0.011;
  result.validation->after.rms = 0.0115;
  result.uncertainty.emplace().validation.emplace();
  // sqrt(0.0115^2 - 0.011^2) = 0.00335, over sqrt(6.6): 0.00131.
  result.uncertainty->validation->parts.from_parameters = 0.00132;
  EXPECT_EQ(FindingOf(result, "improvement").level, FindingLevel::kAttention);
  result.uncertainty->validation->parts.from_parameters = 0.00129;
  EXPECT_EQ(FindingOf(result, "improvement").level, FindingLevel::kFailed);
}

TEST(VerdictTest, CrossValidationFarAboveTheFitIsNoted) {
  CalibrationResult result = MakeResult();
  result.train.after.rms = 1e-5;
  CrossValidation folds;
  folds.folds = 4;
  folds.position.n = 20;
  folds.position.rms = 2.9e-5;
  result.cross_validation = folds;
  EXPECT_EQ(FindingOf(result, "cross_validation").level, FindingLevel::kPassed);
  result.cross_validation->position.rms = 3.1e-5;
  const Finding found = FindingOf(result, "cross_validation");
  EXPECT_EQ(found.level, FindingLevel::kAttention);
  EXPECT_EQ(found.next, "Measure more poses, or identify fewer parameters.");
  // Like with like: the fit's own errors are without what it rejected, too.
  result.cross_validation->kept = {2, folds.position, {}};
  EXPECT_EQ(FindingOf(result, "cross_validation").level, FindingLevel::kPassed);
}

TEST(VerdictTest, FoldsStandBesideTheErrorsOfTheFit) {
  CalibrationResult result = MakeResult();
  result.cross_validation = CrossValidation{5, {}, {}};
  result.cross_validation->position.mean = 2e-5;
  const std::string left_out = "left out of the fit in turn, it is 0.0200 mm.";
  EXPECT_FALSE(Contains(VerdictOf(result).sentence, left_out));
  result.validation.reset();
  EXPECT_TRUE(Contains(VerdictOf(result).sentence, left_out))
      << VerdictOf(result).sentence;
}

TEST(VerdictTest, AcceptedWhereAllLimitsAreMet) {
  const Verdict verdict = VerdictOf(MakeResult());
  EXPECT_EQ(verdict.level, FindingLevel::kPassed);
  EXPECT_EQ(verdict.title, "Accepted");
  EXPECT_EQ(verdict.sentence,
            "The mean position error at 20 validation poses falls from 5.00 mm "
            "to 3.00e-13 mm, the numerical precision limit. All acceptance "
            "limits are met.");
  EXPECT_EQ(
      FindingOf(MakeResult(), "solver").sentence,
      "Levenberg-Marquardt stopped at the numerical precision limit after 3 "
      "iterations.");
}

TEST(VerdictTest, UsableWithoutLimitsAndValidation) {
  CalibrationResult result = MakeResult();
  result.acceptance.clear();
  EXPECT_EQ(VerdictOf(result).title, "Usable");
  EXPECT_EQ(FindingOf(result, "acceptance").sentence,
            "No acceptance limits were set.");
  result.validation.reset();
  const Finding finding = FindingOf(result, "acceptance");
  EXPECT_TRUE(Contains(finding.sentence, "there are no validation poses"));
  EXPECT_EQ(finding.level, FindingLevel::kNote);
  EXPECT_TRUE(Contains(VerdictOf(result).sentence, "at 5 training poses"));
}

TEST(VerdictTest, AMissedLimitIsNotAccepted) {
  CalibrationResult result = MakeResult();
  result.acceptance.push_back({"validation_max", 1e-5, 7.1e-5});
  const Verdict verdict = VerdictOf(result);
  EXPECT_EQ(verdict.level, FindingLevel::kFailed);
  EXPECT_EQ(verdict.title, "Not accepted");
  EXPECT_TRUE(
      Contains(verdict.sentence, "1 of 2 acceptance limits is missed."));
  const Finding finding = FindingOf(result, "acceptance.validation_max");
  EXPECT_EQ(finding.statistic, 7.1e-5);
  EXPECT_EQ(finding.threshold, 1e-5);
  EXPECT_EQ(finding.sentence,
            "Largest position error at validation poses: 0.0710 mm, limit "
            "0.01 mm.");
}

TEST(VerdictTest, GainOfATenthIsTheLeast) {
  const CalibrationResult better = MakeResultAfter(0.00899999);
  EXPECT_EQ(VerdictOf(better).title, "Accepted");
  const CalibrationResult hardly = MakeResultAfter(0.00900001);
  EXPECT_EQ(VerdictOf(hardly).title, "Accepted, hardly better than before");
  EXPECT_EQ(VerdictOf(hardly).level, FindingLevel::kAttention);
  EXPECT_NEAR(FindingOf(hardly, "improvement").statistic, 0.9, 1e-5);
  EXPECT_EQ(FindingOf(hardly, "improvement").threshold, 0.9);
  EXPECT_EQ(VerdictOf(MakeResultAfter(0.00999999)).title,
            "Accepted, hardly better than before");
  const Verdict worse = VerdictOf(MakeResultAfter(0.01000001));
  EXPECT_EQ(worse.title, "Worse than before");
  EXPECT_EQ(worse.level, FindingLevel::kFailed);
  EXPECT_TRUE(Contains(worse.sentence, "grows from 10.0 mm to 10.0 mm"));
}

TEST(VerdictTest, WarningsWantALook) {
  CalibrationResult result = MakeResult();
  EXPECT_EQ(FindingOf(result, "warning").level, FindingLevel::kNote);
  result.plausibility = {{"plausibility.zero_positions", 1.0, 0.0,
                          "data.csv:5: 1 position is exactly 0, 0, 0",
                          FindingLevel::kAttention}};
  result.warnings = {result.plausibility[0].sentence, "the residuals are large",
                     "the residuals are large"};
  const Verdict verdict = VerdictOf(result);
  EXPECT_EQ(verdict.level, FindingLevel::kAttention);
  EXPECT_EQ(verdict.title, "Accepted, with warnings");
  EXPECT_EQ(FindingOf(result, "plausibility.zero_positions").sentence,
            "data.csv:5: 1 position is exactly 0, 0, 0.");
  // The other one, and that of the identifiability analysis.
  EXPECT_EQ(
      std::count_if(verdict.findings.begin(), verdict.findings.end(),
                    [](const Finding& one) { return one.key == "warning"; }),
      2);
}

// What is there and what to do are distinguished where the text asks for it,
// but not within a quotation of a file.
TEST(VerdictTest, ReasonsSayWhatToDoNext) {
  CalibrationResult result = MakeResult();
  result.warnings = {
      "data.csv:5: the residuals are large: look for wrong units",
      "too few (`robust: {loss: huber}`). Measure more poses, or state sigma",
      "at a bound: d3"};
  const Verdict verdict = VerdictOf(result);
  EXPECT_EQ(verdict.decision(), VerdictDecision::kAcceptedWithWarnings);
  ASSERT_GE(verdict.findings.size(), 3u);
  EXPECT_EQ(verdict.findings[0].sentence,
            "data.csv:5: the residuals are large.");
  EXPECT_EQ(verdict.findings[0].next, "Look for wrong units.");
  EXPECT_EQ(verdict.findings[1].sentence, "Too few (`robust: {loss: huber}`).");
  EXPECT_EQ(verdict.findings[1].next, "Measure more poses, or state sigma.");
  EXPECT_EQ(verdict.findings[2].sentence, "At a bound: d3.");
  EXPECT_FALSE(verdict.findings[2].next.empty());
}

TEST(VerdictTest, ReasonsComeInTheOrderOfTheirWeight) {
  CalibrationResult result = MakeResultAfter(0.02);
  result.validation->change_t = 10.0;
  result.status = CalibrationStatus::kFailed;
  result.message = "the mean error grows: look for what is wrong";
  result.warnings = {"the residuals are large: look for wrong units"};
  const Verdict verdict = VerdictOf(result);
  EXPECT_EQ(verdict.decision(), VerdictDecision::kRejected);
  EXPECT_EQ(verdict.title, "Worse than before");
  EXPECT_EQ(verdict.findings[0].key, "rejected");
  EXPECT_EQ(verdict.findings[0].next, "Look for what is wrong.");
  for (std::size_t k = 1; k < verdict.findings.size(); ++k) {
    EXPECT_GE(verdict.findings[k - 1].level, verdict.findings[k].level);
  }
  for (const Finding& finding : verdict.findings) {
    EXPECT_EQ(finding.level < FindingLevel::kAttention || !finding.next.empty(),
              true)
        << finding.key;
  }
  EXPECT_EQ(VerdictOf(MakeResult()).decision(), VerdictDecision::kAccepted);
}

TEST(VerdictTest, AFailedSolverIsNotUsable) {
  CalibrationResult result = MakeResult();
  result.runs[0].summary.status = SolverStatus::kFailed;
  const Verdict verdict = VerdictOf(result);
  EXPECT_EQ(verdict.level, FindingLevel::kFailed);
  EXPECT_EQ(verdict.title, "Not usable");
  EXPECT_EQ(verdict.sentence,
            "Levenberg-Marquardt failed after 3 iterations: further steps are "
            "rounding. These values are not to be used.");
  result.runs.clear();
  EXPECT_EQ(VerdictOf(result).title, "Not calibrated");
}

TEST(VerdictTest, OutliersAreSaidWithTheirLimit) {
  CalibrationResult result = MakeResult();
  EXPECT_FALSE(HasFinding(result, "outliers"));
  result.outlier_limit = 4.5;
  EXPECT_EQ(FindingOf(result, "outliers").level, FindingLevel::kPassed);
  result.outliers.resize(2);
  result.outliers[0].standardised = 12.25;
  const Finding finding = FindingOf(result, "outliers");
  EXPECT_EQ(finding.statistic, 12.25);
  EXPECT_EQ(finding.threshold, 4.5);
  EXPECT_EQ(finding.sentence,
            "2 outliers: standardised residuals above 4.50, which one of all "
            "exceeds by chance in 5 % of calibrations; the largest is 12.2.");
  EXPECT_EQ(VerdictOf(result).level, FindingLevel::kPassed);
}

// Noise of 0.02 mm in three coordinates is sqrt(8 / pi) times as long.
TEST(VerdictTest, NoiseIsSaidWhereItExplainsAGoodPart) {
  CalibrationResult result = MakeResultAfter(4e-5);
  result.sigma = 2e-5;
  result.runs[0].summary.num_residuals = 15;
  const Finding finding = FindingOf(result, "measurement_noise");
  EXPECT_NEAR(finding.statistic, 3.19154e-5, 1e-10);
  EXPECT_TRUE(Contains(finding.sentence, "a mean error of 0.0319 mm"));
  const auto is_said = [&result](double error) {
    result.validation->after.mean = error;
    return HasFinding(result, "measurement_noise");
  };
  EXPECT_TRUE(is_said(6.382e-5));
  EXPECT_FALSE(is_said(6.384e-5));
  EXPECT_TRUE(is_said(2.128e-5));
  EXPECT_FALSE(is_said(2.127e-5));
  result.estimated_sigma = 2e-5;
  EXPECT_FALSE(is_said(4e-5));
}

TEST(VerdictTest, TestsOfResidualsHaveTheirThreshold) {
  CalibrationResult result = MakeResult();
  result.uncertainty.emplace();
  ResidualDiagnostics& residuals = result.uncertainty->residuals;
  residuals.reduced_chi_square = 1.0;
  residuals.chi_square_p_value = 0.5;
  residuals.normality.p_value = 1.001e-3;
  residuals.whiteness.p_value = 0.999e-3;
  EXPECT_EQ(FindingOf(result, "chi_square").level, FindingLevel::kPassed);
  EXPECT_EQ(FindingOf(result, "normality").level, FindingLevel::kPassed);
  const Finding whiteness = FindingOf(result, "whiteness");
  EXPECT_EQ(whiteness.level, FindingLevel::kNote);
  EXPECT_EQ(whiteness.statistic, 0.999e-3);
  EXPECT_EQ(whiteness.threshold, 1e-3);
  residuals.reduced_chi_square = 0.0999;
  EXPECT_FALSE(HasFinding(result, "whiteness"));
}

TEST(VerdictTest, PredictionIsComparedWithWhatChanceAllows) {
  PredictionCheck check;
  EXPECT_EQ(DescribePrediction("Poses", check), "");
  check.axes = {90, 100, 0.91, 0.98};
  check.rms_z = 1.25;
  check.verdict = "larger";
  EXPECT_EQ(DescribePrediction("Poses", check),
            "Poses: 90.0 % of 100 coordinates lie within their 95.0 % "
            "intervals (91.0 % to 98.0 % by chance); errors are 1.25 times the "
            "predicted ones (root mean square): observed errors are larger "
            "than predicted.");
  CalibrationResult result = MakeResult();
  result.uncertainty.emplace();
  result.uncertainty->validation = check;
  const Finding finding = FindingOf(result, "prediction");
  EXPECT_EQ(finding.level, FindingLevel::kNote);
  EXPECT_EQ(finding.statistic, 0.9);
  EXPECT_EQ(finding.threshold, 0.91);
}

TEST(VerdictTest, ParametersAreAssessed) {
  CalibrationResult result = MakeResult();
  result.identifiability.weak = {"d4"};
  const auto assess = [&result](int i) {
    JudgeResult(&result);
    return result.parameters[i].assessment;
  };
  EXPECT_EQ(assess(0), ParameterAssessment::kEstimated);
  EXPECT_EQ(assess(1), ParameterAssessment::kWeak);
  EXPECT_EQ(assess(2), ParameterAssessment::kFixed);
  EXPECT_EQ(assess(3), ParameterAssessment::kKnown);
  // Predicted: the prior has std^2 / prior^2 of the information.
  ParameterDecision& decision = result.parameters[0].decision;
  decision.prior_std = 1.0;
  decision.predicted_std = std::sqrt(0.4999);
  EXPECT_EQ(assess(0), ParameterAssessment::kEstimated);
  decision.predicted_std = std::sqrt(0.5001);
  EXPECT_EQ(assess(0), ParameterAssessment::kPriorDominated);
  // Computed.
  result.uncertainty.emplace();
  result.uncertainty->parameters.emplace_back();
  ParameterUncertainty& known = result.uncertainty->parameters[0];
  known.name = "beta1";
  known.std = 1e-5;
  known.prior_share = 0.4999;
  EXPECT_EQ(assess(0), ParameterAssessment::kEstimated);
  known.prior_share = 0.5001;
  EXPECT_EQ(assess(0), ParameterAssessment::kPriorDominated);
  known.prior_share = 0.0;
  known.std = std::numeric_limits<double>::infinity();
  EXPECT_EQ(assess(0), ParameterAssessment::kWeak);
}

}  // namespace
}  // namespace alidade::internal::verdict_test
