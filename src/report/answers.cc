#include "src/report/answers.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "src/calibration/improvement.h"
#include "src/calibration/outliers.h"
#include "src/common/text.h"
#include "src/report/report.h"

namespace alidade::internal {
namespace {

// "2 of 2100 training measurements (file.csv:7, file.csv:9)".
void AddRejected(const char* set_name, const EvaluatedSet& set,
                 const std::vector<Outlier>& outliers,
                 std::vector<std::string>* parts) {
  if (!set.kept || set.kept->num_rejected == 0) return;
  const std::int64_t kept =
      std::max(set.kept->after.n, set.kept->rotation_after.n);
  parts->push_back(std::to_string(set.kept->num_rejected) + " of " +
                   std::to_string(kept + set.kept->num_rejected) + " " +
                   set_name + " observations" + PlacesOf(outliers));
}

bool IsValidated(const CalibrationResult& result) {
  return result.cross_validation || &JudgedSet(result) != &result.train;
}

Answer MayItBeUsed(const CalibrationResult& result) {
  const Verdict& verdict = result.verdict;
  Answer answer{"May I use this arm?", {}};
  const auto reasons =
      std::count_if(verdict.findings.begin(), verdict.findings.end(), IsReason);
  switch (verdict.decision()) {
    case VerdictDecision::kAccepted:
      answer.sentences.emplace_back(
          !IsValidated(result)
              ? "Probably: nothing speaks against it, but there are no "
                "validation poses that would have shown it."
          : result.acceptance.empty()
              ? "Yes: nothing speaks against it. State `acceptance` limits to "
                "have it checked against what you need."
              : "Yes: it meets all limits that were set.");
      break;
    case VerdictDecision::kAcceptedWithWarnings:
      answer.sentences.push_back(
          "Yes, with care: look at " +
          (reasons == 1
               ? std::string("the warning first.")
               : "the " + std::to_string(reasons) + " warnings first."));
      break;
    case VerdictDecision::kRejected:
      answer.sentences.push_back(
          "No." + (verdict.findings.empty()
                       ? ""
                       : " " + WithNext(verdict.findings.front())));
      break;
  }
  const std::string outliers = OutlierNote(result);
  if (!outliers.empty()) answer.sentences.push_back(outliers);
  return answer;
}

Answer FromFindings(const CalibrationResult& result, std::string question,
                    const std::vector<std::string>& keys) {
  Answer answer{std::move(question), {}};
  for (const std::string& key : keys) {
    for (const Finding& finding : result.verdict.findings) {
      if (finding.key == key) answer.sentences.push_back(WithNext(finding));
    }
  }
  return answer;
}

}  // namespace

std::string OutlierNote(const CalibrationResult& result) {
  std::vector<std::string> parts;
  AddRejected("training", result.train, result.outliers, &parts);
  if (result.validation) {
    AddRejected("validation", *result.validation, result.validation_outliers,
                &parts);
  }
  if (!parts.empty()) {
    return "Outliers: " + Join(parts, " and ") +
           " were rejected; these numbers are without them.";
  }
  std::vector<Outlier> all = result.outliers;
  all.insert(all.end(), result.validation_outliers.begin(),
             result.validation_outliers.end());
  const std::size_t count = all.size();
  if (count == 0) return "";
  return Count(static_cast<std::int64_t>(count), "outlier") +
         (count == 1 ? " is" : " are") + " among the observations" +
         PlacesOf(all) +
         "; these "
         "numbers contain " +
         (count == 1 ? "it." : "them.");
}

std::vector<Answer> AnswersOf(const CalibrationResult& result) {
  std::vector<Answer> answers = {MayItBeUsed(result)};
  if (result.verdict.decision() == VerdictDecision::kRejected &&
      !result.IsUsable()) {
    return answers;
  }
  for (Answer& answer : std::vector<Answer>{
           FromFindings(result, kHowAccurate,
                        {"accuracy", "measurement_noise"}),
           FromFindings(result, "Where is it worst?", {"worst_place"}),
           FromFindings(result, "What should I measure next?",
                        {"next_measurement"})}) {
    if (!answer.sentences.empty()) answers.push_back(std::move(answer));
  }
  return answers;
}

std::string FormatAnswers(const CalibrationResult& result) {
  std::string text;
  for (const Answer& answer : AnswersOf(result)) {
    text += Paragraph(answer.question + " " + Join(answer.sentences, " "));
  }
  return text;
}

}  // namespace alidade::internal
