#include <cmath>
#include <string>
#include <vector>

#include "src/calibration/improvement.h"
#include "src/common/format.h"
#include "src/common/text.h"
#include "src/report/answers.h"
#include "src/report/markup.h"
#include "src/report/report.h"
#include "src/report/result_page.h"
#include "src/report/table.h"
#include "src/report/uncertainty_report.h"

namespace alidade::internal {
namespace {

bool StartsWith(const std::string& text, const std::string& beginning) {
  return text.compare(0, beginning.size(), beginning) == 0;
}

// "0.72 mm → 0.19 mm" and how many times smaller that is.
std::string HeadlinePair(const std::string& title, double before, double after,
                         Dimension dimension) {
  // Where frames alone are found, "before" has them as well.
  constexpr double kSame = 1e-9;
  const bool is_same = std::abs(before - after) <= kSame * before;
  const auto shown = [&](double value, const char* look) {
    return Element("span", {{"class", look}},
                   Words(InUnit(value, dimension, 3) + "\u00a0" +
                         UnitForPeople(dimension)));
  };
  std::string html = Element("div", {{"class", "small"}}, title) +
                     Element("div", {{"class", "big"}},
                             (is_same ? "" : shown(before, "then") + " → ") +
                                 shown(after, "now"));
  if (before > 0.0 && after > 0.0 && !is_same) {
    const bool is_smaller = after <= before;
    const double ratio = is_smaller ? before / after : after / before;
    html += Element("div", {{"class", "small"}},
                    Words(FormatSignificant(ratio, 2) + " times " +
                          (is_smaller ? "smaller" : "larger")));
  }
  return Element("div", {}, html);
}

// Of validation poses where there are any.
std::string Headline(const CalibrationResult& result) {
  const KeptErrors set = JudgedSet(result).Judged();
  std::string html;
  if (set.after.n > 0) {
    html += HeadlinePair(std::string("mean ") + LengthErrorName(result),
                         set.before.mean, set.after.mean, Dimension::kLength) +
            HeadlinePair("largest", set.before.max, set.after.max,
                         Dimension::kLength);
  }
  if (set.rotation_after.n > 0) {
    html += HeadlinePair("mean orientation error", set.rotation_before.mean,
                         set.rotation_after.mean, Dimension::kAngle);
  }
  return html.empty()
             ? ""
             : Element("div", {{"class", "numbers"}, {"id", "headline"}}, html);
}

// Where to look for one's own place; empty where there is no map.
std::string WhereYouWork(const CalibrationResult& result) {
  if (RegionTable(result).empty()) return "";
  return Element(
      "dd", {},
      "Where you work: " +
          Element("a", {{"href", "#regions"}}, "accuracy by region") +
          ", and the " +
          Element("a", {{"href", "#workspace"}}, "map of the workspace") + ".");
}

std::string Answers(const CalibrationResult& result) {
  std::string list;
  for (const Answer& answer : AnswersOf(result)) {
    list += Element("dt", {}, Words(answer.question)) + "\n";
    for (const std::string& sentence : answer.sentences) {
      list += Element("dd", {}, Sentences(sentence)) + "\n";
    }
    if (answer.question == kHowAccurate) list += WhereYouWork(result);
  }
  return Element("dl", {{"id", "answers"}}, list);
}

std::string Acceptance(const CalibrationResult& result) {
  std::vector<std::string> checks;
  for (const Finding& finding : result.verdict.findings) {
    if (!StartsWith(finding.key, "acceptance.")) continue;
    checks.push_back(
        HtmlBadge(finding.level,
                  finding.level == FindingLevel::kPassed ? "met" : "missed") +
        " " + Sentences(WithNext(finding)));
  }
  return checks.empty() ? HtmlNote(FindingSentences(result, {"acceptance"}))
                        : HtmlList(checks, "acceptance", "plain");
}

std::string Warnings(const CalibrationResult& result) {
  std::vector<std::string> warnings;
  for (const Finding& finding : result.verdict.findings) {
    if (IsReason(finding) && !StartsWith(finding.key, "acceptance.")) {
      warnings.push_back(Sentences(WithNext(finding)));
    }
  }
  if (warnings.empty()) return "";
  const std::string title =
      warnings.size() == 1
          ? "Before you rely on it"
          : "Before you rely on it: " + std::to_string(warnings.size()) +
                " warnings";
  return Element("div", {{"class", "warnings"}, {"id", "warnings"}},
                 Element("h3", {}, title) + HtmlList(warnings, ""));
}

}  // namespace

std::string BeforeNote(const CalibrationResult& result) {
  if (result.before_note.empty()) return "";
  const std::string prefix = "before: ";
  return HtmlNote("Before: " +
                  (StartsWith(result.before_note, prefix)
                       ? result.before_note.substr(prefix.size())
                       : result.before_note) +
                  ".");
}

std::string FirstScreen(const CalibrationResult& result, const ArmView& view) {
  const std::string arm =
      ArmViewFigure(view, "The arm and its errors where it was measured");
  return Element("section", {{"id", "summary"}, {"aria-label", "Verdict"}},
                 HtmlVerdict(result.verdict.level, result.verdict.title,
                             result.verdict.sentence) +
                     HtmlPair({Headline(result) + Answers(result) +
                                   Acceptance(result) + BeforeNote(result),
                               arm}) +
                     Warnings(result));
}

}  // namespace alidade::internal
