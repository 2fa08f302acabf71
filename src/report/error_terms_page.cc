#include <optional>
#include <string>
#include <vector>

#include "src/report/error_term_tables.h"
#include "src/report/figures.h"
#include "src/report/markup.h"
#include "src/report/result_page.h"

namespace alidade::internal {
namespace {

template <typename MakeChart>
std::string ChartsByJoint(const CalibrationResult& result,
                          const std::string& id, const MakeChart& make) {
  std::vector<std::string> figures;
  for (int j = 0; j < result.arm.num_joints(); ++j) {
    const std::optional<LineChart> chart = make(result, j);
    if (!chart) continue;
    figures.push_back(HtmlFigure(id + "-" + std::to_string(j + 1), *chart));
  }
  return HtmlPair(figures);
}

// A part with its heading, where it has something to show.
std::string Part(const std::string& title, const std::string& text,
                 const std::string& html) {
  if (html.empty()) return "";
  return Element("h3", {}, Words(title)) + HtmlParagraph(text) + html;
}

std::string Compliances(const CalibrationResult& result) {
  const ErrorTermsResult& errors = *result.error_terms;
  const std::string loads =
      result.arm.errors.links.empty()
          ? "Masses are not stated, so that moments are those of 1 kg at each "
            "joint and of the payload: a compliance takes up how heavy the arm "
            "is."
          : "Moments are those of the stated masses.";
  const Table compliances = ComplianceTable(result.arm, errors.terms);
  return Part(
      "Compliances and other terms",
      compliances.empty()
          ? ""
          : "A compliance is what a moment of gravity about an axis of "
            "a joint's frame turns everything after that joint by; z "
            "is the joint's own axis. " +
                loads,
      compliances.ToHtml() + OtherTermTable(result.arm, errors.terms).ToHtml());
}

}  // namespace

std::string ErrorStagesPart(const CalibrationResult& result) {
  const ErrorTermsResult& errors = *result.error_terms;
  return HtmlPair(
             {HtmlFigure("stages-figure", ErrorStagesFigure(result),
                         "Regions left out of the fit are training poses in "
                         "held-out parts of joint space."),
              PriorTable(errors).ToHtml()}) +
         RungTable(errors, result).ToHtml();
}

PageSection ErrorTermsSectionOf(const CalibrationResult& result) {
  PageSection section = {"error-terms", "Errors that are not rigid geometry",
                         ""};
  if (!result.error_terms) return section;
  const ErrorTermsResult& errors = *result.error_terms;
  section.html = HtmlParagraph(DescribeErrorTerms(result));
  if (!(errors.share > 0.0)) return section;
  section.html +=
      HtmlPair({errors.effects.empty()
                    ? ""
                    : HtmlFigure("effects", ErrorEffectsFigure(errors)),
                EffectTable(errors).ToHtml()});
  section.html += Part(
      "Error function of each joint",
      "What each joint turns further than its value says, against that value. "
      "Dots are training poses: the function and what is left of the error "
      "along the joint. The band is that of the shape: a constant cannot be "
      "distinguished from the joint's offset. Grey and dashed, where the joint "
      "was not measured: there the function fades out and its band grows to "
      "what is known of such functions beforehand.",
      ChartsByJoint(result, "function", JointFunctionChart));
  section.html += FunctionTable(result.arm, errors.measured).ToHtml();
  section.html += Compliances(result);
  section.html += Part(
      "Residuals by joint value, before and after",
      "What each joint would have to turn further to take most of a training "
      "pose's error away. A pattern that geometry leaves is what the terms are "
      "for; one that they leave is what the model still does not have.",
      ChartsByJoint(result, "residuals-of-joint", JointResidualChart));
  return section;
}

}  // namespace alidade::internal
