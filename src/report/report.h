#ifndef ALIDADE_SRC_REPORT_REPORT_H_
#define ALIDADE_SRC_REPORT_REPORT_H_

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "alidade/calibration_result.h"
#include "alidade/monte_carlo.h"
#include "alidade/plan.h"
#include "src/common/text_pieces.h"
#include "src/simulation/noise_study_result.h"

namespace alidade::internal {

/// A file of a result directory. Tables with a row for each observation are
/// longer than all else that a result holds: they are made while they are
/// written, piece by piece, from the result that they were asked for of, which
/// must therefore stay where it is, unchanged, as long as the file is used.
/// Which files do is said where they are made.
struct ReportFile {
  /// Of a text that is there.
  ReportFile(std::string file_name, std::string text)
      : ReportFile(std::move(file_name), WholeText(std::move(text))) {}
  /// Of a text that is made each time it is asked for.
  ReportFile(std::string file_name, TextSource source)
      : name(std::move(file_name)), content(std::move(source)) {}

  /// The whole content as one text.
  std::string Text() const {
    std::string text;
    content([&text](std::string_view piece) { text += piece; });
    return text;
  }

  std::string name;
  TextSource content;  ///< gives the whole content, piece by piece
};

/// Text for people, each ending in a newline, at most 100 columns wide (a path
/// or a hash is never broken). Lengths in mm, angles in
/// deg.
std::string FormatIdentifiability(const IdentifiabilityResult& result);
std::string FormatParameters(const CalibrationResult& result);
std::string FormatAccuracyTable(const CalibrationResult& result);
/// Published and obtained values; empty where none are published.
std::string FormatPublished(const CalibrationResult& result);
/// Every solver side by side: outcome, cost and error per iteration, time,
/// and where the values differ.
std::string FormatComparison(const CalibrationResult& result);
/// What noise does to each way of calibrating: a table, and in words what it
/// shows.
std::string FormatNoiseStudy(const NoiseStudyResult& study);
/// noise_study.svg: the error over the workspace by trial, sorted, of every
/// method; noise_study.csv: both errors of every trial.
std::vector<ReportFile> MakeNoiseFiles(const NoiseStudyResult& study);
/// How predictions compare with what was observed at `where`, in words.
std::string FormatPredictionCheck(const std::string& where,
                                  const PredictionCheck& check);
std::string FormatPredictedMap(const PredictedMap& map);
/// predicted_map.csv and .svg, with a check z_scores.svg.
std::vector<ReportFile> MakePredictionFiles(
    const Arm& arm, const PredictedMap& map,
    const std::optional<PredictionCheck>& check);
/// influence.csv (leverage and Cook's distance by pose), predicted_map.csv and
/// .svg, residual_histogram.svg, validation_z_scores.svg; those that there is
/// something for. influence.csv is made of `result` when it is written:
/// ReportFile.
std::vector<ReportFile> MakeUncertaintyFiles(const CalibrationResult& result);
std::vector<ReportFile> MakeUncertaintyFiles(const CalibrationResult&&) =
    delete;
/// joint_functions.csv and .svg, joint_residuals.csv and .svg,
/// error_effects.svg and error_stages.svg, where error terms were estimated;
/// the last one where they were weighed. Of a copy of what they show.
std::vector<ReportFile> MakeErrorTermFiles(const CalibrationResult& result);
/// What simulated calibrations showed: a table of the parameters, and in words
/// the residual errors over the workspace.
std::string FormatMonteCarlo(const MonteCarloResult& result);
/// montecarlo.csv (parameters, SI units), trials.csv, coverage.svg,
/// workspace_error.svg, montecarlo.html, montecarlo.txt.
std::vector<ReportFile> MakeMonteCarloFiles(const MonteCarloResult& result);
/// singular_values.svg and, where there are relations, relations.svg: what
/// each parameter that is left out depends on.
std::vector<ReportFile> MakeIdentifiabilityFigures(
    const IdentifiabilityResult& result);
/// What `plan` prints: the predicted accuracy of the plan beside greedy and
/// random poses, and accuracy by the number of poses. Lengths in mm.
std::string FormatPlanSummary(const PlanResult& result);

/// The whole plan.txt: the summary, parameters, and the poses in their order.
std::string FormatPlan(const PlanResult& result);

/// accuracy.svg (predicted accuracy by the number of poses, with its bound) and
/// curve.csv, where there is a curve.
std::vector<ReportFile> MakePlanFiles(const PlanResult& result);

/// The sentences of the findings of these keys, in the order of the keys.
std::string FindingSentences(const CalibrationResult& result,
                             const std::vector<std::string>& keys);
/// What people should read before they use the result.
bool IsReason(const Finding& finding);
/// Its sentence, and what to do about it.
std::string WithNext(const Finding& finding);
/// The whole report.txt, `further` sections before its last. The result has
/// been judged (calibration/verdict.h).
std::string FormatReport(const CalibrationResult& result,
                         const std::string& further = "");

/// residuals.csv (training poses), validation.csv (with validation poses),
/// iterations.csv. Numbers read back to the same bits of the unit shown.
/// The first two are made of `result` when they are written: ReportFile.
std::vector<ReportFile> MakeCsvFiles(const CalibrationResult& result);
std::vector<ReportFile> MakeCsvFiles(const CalibrationResult&&) = delete;
/// error_before.svg, error_after.svg, convergence.svg, and, with validation
/// poses, validation_before.svg, validation_after.svg.
std::vector<ReportFile> MakeFigures(const CalibrationResult& result);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_REPORT_REPORT_H_
