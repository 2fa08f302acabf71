#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "src/calibration/improvement.h"
#include "src/common/format.h"
#include "src/common/text.h"
#include "src/report/figures.h"
#include "src/report/report.h"
#include "src/report/result_page.h"
#include "src/report/result_tables.h"
#include "src/report/uncertainty_report.h"

namespace alidade::internal {
namespace {

constexpr Eigen::Index kFewestResiduals = 8;

Histogram OfOwnSpread(const EvaluatedSet& set) {
  std::vector<double> values;
  const auto& residuals = set.residual_after.map();
  for (const double value : residuals.reshaped()) {
    if (std::isfinite(value) && value != 0.0) values.push_back(value);
  }
  const auto size = static_cast<Eigen::Index>(values.size());
  const Eigen::Map<const Eigen::VectorXd> all(values.data(), size);
  if (size < kFewestResiduals) return {};
  return CountStandardised(
      all / std::sqrt(all.squaredNorm() / static_cast<double>(size)));
}

// Standardised residuals where they were computed, else the coordinates of the
// residuals over their own root mean square.
std::string ResidualHistogram(const CalibrationResult& result) {
  const char* const title = "Are the residuals like noise?";
  if (result.uncertainty) {
    const Histogram& computed = result.uncertainty->residuals.histogram;
    if (!HasNothing(computed)) {
      return HtmlFigure("histogram", HistogramFigure(title, computed),
                        "residuals over their standard deviations");
    }
  }
  const Histogram own = OfOwnSpread(result.train);
  if (HasNothing(own)) return "";
  return HtmlFigure(
      "histogram", HistogramFigure(title, own),
      "coordinates of training poses over their root mean square");
}

std::string JointFigures(const EvaluatedSet& set, const std::string& poses) {
  if (set.joint_values.cols() == 0) return "";
  std::vector<PageChoice> choices;
  for (Eigen::Index j = 0; j < set.joint_values.rows(); ++j) {
    const std::string number = std::to_string(j + 1);
    choices.push_back(
        {number,
         HtmlFigure("by-joint-" + number, JointFigure(set, j),
                    poses + "; a pattern that is left after calibration is "
                            "what the model does not have: compliance, "
                            "gears, backlash")});
  }
  return HtmlChoices("by-joint", "Error by the value of joint", choices);
}

bool HasErrors(const EvaluatedSet& set) {
  return set.residual_after.cols() > 0;
}

}  // namespace

PageSection ResidualsSection(const CalibrationResult& result) {
  constexpr auto kBefore = CalibrationState::kBefore;
  constexpr auto kAfter = CalibrationState::kAfter;
  const bool is_validated = result.validation && HasErrors(*result.validation);
  std::string html = HtmlParagraph(FindingSentences(
      result, {"sigma", "chi_square", "normality", "whiteness"}));
  html += HtmlPair({ResidualHistogram(result),
                    is_validated
                        ? JointFigures(*result.validation, "validation poses")
                        : JointFigures(result.train, "training poses")});
  if (HasErrors(result.train)) {
    const std::string pose = ObservationName(result.train, "training");
    html += HtmlPair(
        {HtmlFigure("by-pose-before", ErrorFigure(result.train, kBefore, pose)),
         HtmlFigure("by-pose", ErrorFigure(result.train, kAfter, pose))});
  }
  if (is_validated) {
    const EvaluatedSet& set = *result.validation;
    html += HtmlPair({HtmlFigure("validation-before",
                                 ValidationFigure(set, kBefore, result.arm)),
                      HtmlFigure("validation-after",
                                 ValidationFigure(set, kAfter, result.arm))});
  }
  if (result.uncertainty) {
    html += HtmlParagraph(DescribeLackOfFit(*result.uncertainty)) +
            StructureTable(result.uncertainty->lack_of_fit).ToHtml() +
            InfluenceTable(result.uncertainty->residuals).ToHtml();
  }
  return {"residuals", "Residuals", html};
}

}  // namespace alidade::internal
