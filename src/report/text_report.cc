#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "src/common/format.h"
#include "src/common/text.h"
#include "src/report/answers.h"
#include "src/report/budget_report.h"
#include "src/report/error_term_tables.h"
#include "src/report/report.h"
#include "src/report/result_tables.h"
#include "src/report/table.h"
#include "src/report/uncertainty_report.h"
#include "src/solve/solver_names.h"

namespace alidade::internal {

namespace {

constexpr int kParameterDecimals = 6;
bool IsUnremarkable(const ParameterResult& parameter) {
  return parameter.decision.state == ParameterState::kGiven &&
         parameter.nominal == 0.0 && parameter.value == 0.0 &&
         parameter.truth.value_or(0.0) == 0.0;
}

TableCell FixedParameter(double value, Dimension dimension) {
  return FormatParameter(value, dimension, kParameterDecimals);
}

TableCell SignificantParameter(double value, Dimension dimension) {
  if (std::isnan(value)) return "-";
  return InUnit(value, dimension, 2);
}

// Without the columns that not every job has.
Table ParameterTable(const CalibrationResult& result,
                     std::vector<std::string>* left_out) {
  bool has_std = false;
  bool has_truth = false;
  for (const ParameterResult& parameter : result.parameters) {
    has_std |= std::isfinite(parameter.std);
    has_truth |= parameter.truth.has_value();
  }
  std::vector<Table::Column> columns = {"name", "unit", ">nominal",
                                        ">identified", ">deviation"};
  if (has_std) columns.emplace_back(">std");
  if (has_truth) columns.insert(columns.end(), {">true value", ">difference"});
  columns.emplace_back("state");
  Table table(columns);
  for (const ParameterResult& one : result.parameters) {
    if (IsUnremarkable(one)) {
      left_out->push_back(one.name);
      continue;
    }
    const Dimension dimension = one.dimension;
    std::vector<TableCell> row = {one.name, UnitForPeople(dimension),
                                  FixedParameter(one.nominal, dimension),
                                  FixedParameter(one.value, dimension),
                                  FixedParameter(one.deviation(), dimension)};
    if (has_std) row.push_back(SignificantParameter(one.std, dimension));
    if (has_truth && one.truth) {
      row.push_back(FixedParameter(*one.truth, dimension));
      row.push_back(SignificantParameter(one.value - *one.truth, dimension));
    } else if (has_truth) {
      row.insert(row.end(), {"-", "-"});
    }
    const bool is_free = one.decision.state == ParameterState::kFree;
    row.emplace_back(is_free && one.assessment > ParameterAssessment::kFixed
                         ? AssessmentForPeople(one.assessment)
                         : StateForPeople(one.decision.state));
    table.AddRow(std::move(row));
  }
  return table;
}

bool IsWarning(const Finding& finding) {
  return finding.key == "warning" || finding.key.rfind("plausibility.", 0) == 0;
}

std::string SolverMessages(const CalibrationResult& result) {
  std::string text = "\n";
  for (const SolverRun& run : result.runs) {
    text +=
        Paragraph(SolverTitle(run.summary.solver) + ": " +
                  ToString(run.summary.status) + ". " + run.summary.message);
  }
  return text;
}

std::string Provenance(const CalibrationResult& result) {
  double solve_time = 0.0;
  if (!result.runs.empty()) {
    const SolverSummary& summary = result.runs.front().summary;
    solve_time = summary.setup_time_s + summary.solve_time_s;
  }
  std::string text = Paragraph("Alidade " + result.version + ", seed " +
                               std::to_string(result.seed));
  text += Paragraph("Command: " + result.command);
  text += Paragraph("Times: identifiability " +
                    FormatDuration(result.identify_time_s) + ", solver " +
                    FormatDuration(solve_time) + ", whole job " +
                    FormatDuration(result.total_time_s));
  if (!result.inputs.empty()) text += "Inputs, each with its SHA-256:\n";
  for (const InputFile& input : result.inputs) {
    text += "  " + input.path + "\n    " + input.sha256 + "\n";
  }
  return text;
}

// "tool2: smr2, point1: A".
std::string Aliases(const CalibrationResult& result) {
  std::vector<std::string> names;
  for (const auto& [block, name] : result.aliases) {
    names.push_back(block + " is " + name);
  }
  return names.empty() ? "" : Paragraph(Join(names, ", ") + ".");
}

std::string Section(const std::string& title, const std::string& body) {
  if (body.empty()) return "";
  return "\n" + Heading(title) + body;
}

}  // namespace

std::string FormatParameters(const CalibrationResult& result) {
  std::vector<std::string> left_out;
  std::string text = ParameterTable(result, &left_out).ToText();
  if (left_out.empty()) return text;
  return text + Paragraph("Known, and zero: " + Join(left_out, " "));
}

const char* StateForPeople(ParameterState state) {
  switch (state) {
    case ParameterState::kFree:
      return "estimated";
    case ParameterState::kFixed:
      return "fixed";
    case ParameterState::kGiven:
      break;
  }
  return "known";
}

const char* AssessmentForPeople(ParameterAssessment assessment) {
  switch (assessment) {
    case ParameterAssessment::kEstimated:
      return "estimated";
    case ParameterAssessment::kPriorDominated:
      return "prior-dominated";
    case ParameterAssessment::kWeak:
      return "weakly identifiable";
    case ParameterAssessment::kFixed:
      return "fixed";
    case ParameterAssessment::kKnown:
      break;
  }
  return "known";
}

bool IsReason(const Finding& finding) {
  return IsWarning(finding) || finding.level >= FindingLevel::kAttention;
}

std::string WithNext(const Finding& finding) {
  return finding.sentence + (finding.next.empty() ? "" : " " + finding.next);
}

std::string FindingSentences(const CalibrationResult& result,
                             const std::vector<std::string>& keys) {
  std::vector<std::string> sentences;
  for (const std::string& key : keys) {
    for (const Finding& finding : result.verdict.findings) {
      if (finding.key == key) sentences.push_back(finding.sentence);
    }
  }
  return Join(sentences, " ");
}

std::string FormatPublished(const CalibrationResult& result) {
  Table table({"name", "unit", ">published", ">obtained", ">difference"});
  for (const ParameterResult& one : result.parameters) {
    if (!one.published) continue;
    const double difference = one.value - *one.published;
    table.AddRow({one.name, UnitForPeople(one.dimension),
                  FixedParameter(*one.published, one.dimension),
                  FixedParameter(one.value, one.dimension),
                  SignificantParameter(difference, one.dimension)});
  }
  if (table.empty()) return "";
  return Paragraph("Published: " + result.published_source) + "\n" +
         table.ToText();
}

std::string FormatReport(const CalibrationResult& result,
                         const std::string& further) {
  const std::string title =
      result.title.empty() ? "Calibration of " + result.arm_name : result.title;
  std::string text = Heading(title, '=') + "\n";
  if (!result.arm_name.empty()) {
    text += Paragraph("Arm: " + result.arm_name) + "\n";
  }
  text += Paragraph(result.verdict.title + ". " + result.verdict.sentence);
  for (const Finding& finding : result.verdict.findings) {
    if (!IsReason(finding)) continue;
    text += Paragraph((IsWarning(finding) ? "Warning: " : "Reason: ") +
                      WithNext(finding));
  }
  text += "\n" + FormatAnswers(result);
  text += Section("Accuracy", AccuracySection(result));
  text += Section("Outliers", OutlierSection(result));
  text += Section("Rejected rows", RejectedRowSection(result));
  text += Section("Uncertainty", UncertaintySection(result));
  text +=
      Section("Errors that are not rigid geometry", ErrorTermsSection(result));
  text += Section("Parameters", FormatParameters(result) + Aliases(result));
  text +=
      Section("Identifiability", FormatIdentifiability(result.identifiability));
  text += Section("Uncertainty budget", BudgetText(result));
  if (!result.runs.empty()) {
    text += Section("Convergence",
                    FormatComparison(result) + SolverMessages(result));
  }
  text += Section("Published values", FormatPublished(result)) + further;
  text += Section("Provenance", Provenance(result));
  return text;
}

namespace {

constexpr std::size_t kMostTextRows = 30;

std::string StagesText(const CalibrationResult& result) {
  if (result.stages.empty()) return "";
  const Table rotations = StagesTable(result, Dimension::kAngle);
  const std::string note = StagesNote(result);
  return "\n" +
         Paragraph("Accuracy by stage:" + (note.empty() ? "" : " " + note)) +
         StagesTable(result, Dimension::kLength).ToText() +
         (rotations.empty() ? "" : "\n" + rotations.ToText());
}

std::string KindText(const CalibrationResult& result) {
  const Table table = KindTable(result);
  return table.empty() ? "" : "\n" + table.ToText();
}

// Says what "before" is, and what else there is to know of these errors.
std::string FitNotes(const CalibrationResult& result) {
  std::string text;
  if (!result.before_note.empty()) text += Paragraph(result.before_note + ".");
  const std::string repeats = RepeatSentence(result);
  if (!repeats.empty()) text += Paragraph(repeats);
  const std::string findings =
      FindingSentences(result, {"acceptance", "sigma", "chi_square"});
  if (!findings.empty()) text += Paragraph(findings);
  return text.empty() ? "" : "\n" + text;
}

std::string AcceptanceTable(const CalibrationResult& result) {
  if (result.acceptance.empty()) return "";
  Table table("acceptance", "",
              {"acceptance limit", "unit", ">at most", ">obtained", "verdict"});
  for (const AcceptanceCheck& check : result.acceptance) {
    table.AddRow({check.quantity, UnitForPeople(check.dimension),
                  QuantityCell(check.limit, check.dimension, 4),
                  QuantityCell(check.obtained, check.dimension, 4),
                  check.met() ? "met" : "MISSED"});
  }
  return "\n" + table.ToText();
}

std::string FirstRows(std::size_t count) {
  if (count <= kMostTextRows) return "";
  return Paragraph("The first " + std::to_string(kMostTextRows) + ":");
}

}  // namespace

Table OutlierTable(const CalibrationResult& result) {
  const std::size_t count =
      result.outliers.size() + result.validation_outliers.size();
  Table table("outliers", "Outliers (" + std::to_string(count) + ")",
              {Table::TextOnly(">observation"), Table::PageOnly(">pose"),
               "poses", "kind", "target", "read from", ">error [mm]",
               ">standardised|the error over its standard deviation",
               ">weight in the fit|what the robust loss left it"});
  const auto add = [&table](const std::string& poses, const Outlier& outlier) {
    const int pose = outlier.label.pose + 1;
    table.AddRow({CountCell(outlier.observation + 1),
                  pose > 0 ? CountCell(pose) : TableCell("-"), poses,
                  outlier.label.kind, outlier.label.target, outlier.label.where,
                  QuantityCell(outlier.error, Dimension::kLength, 4),
                  NumberCell(outlier.standardised, 3),
                  NumberCell(outlier.weight, 2)});
  };
  for (const Outlier& outlier : result.validation_outliers) {
    add("validation", outlier);
  }
  for (const Outlier& outlier : result.outliers) add("training", outlier);
  return table;
}

Table RejectedRowTable(const CalibrationResult& result) {
  Table table("rejected", "Rows that measure nothing",
              {"file", ">line", "~reason"});
  for (const RejectedRow& row : result.rejected) {
    table.AddRow({row.file, CountCell(row.line), row.reason});
  }
  return table;
}

std::string AccuracySection(const CalibrationResult& result) {
  return FormatAccuracyTable(result) + StagesText(result) + FitNotes(result) +
         AcceptanceTable(result);
}

std::string OutlierSection(const CalibrationResult& result) {
  const std::size_t count =
      result.outliers.size() + result.validation_outliers.size();
  if (count == 0) return "";
  return Paragraph(
             FindingSentences(result, {"validation_outliers", "outliers"}) +
             " The limits of other kinds than positions are equally "
             "improbable. The weight is what the loss leaves; of less "
             "than a half, the observation is rejected, and the accuracy "
             "is stated with and without it. Worst first; residuals.csv "
             "and validation.csv have all of them.") +
         FirstRows(count) + OutlierTable(result).ToText(kMostTextRows);
}

std::string RejectedRowSection(const CalibrationResult& result) {
  if (result.rejected.empty()) return "";
  return Paragraph(
             Count(static_cast<std::int64_t>(result.rejected.size()), "row") +
             " took no part. result.json lists all of them.") +
         FirstRows(result.rejected.size()) +
         RejectedRowTable(result).ToText(kMostTextRows);
}

std::string FormatAccuracyTable(const CalibrationResult& result) {
  const Table lengths = AccuracyTable(result, Dimension::kLength);
  const Table rotations = AccuracyTable(result, Dimension::kAngle);
  if (lengths.empty() && rotations.empty()) return "No pose was evaluated.\n";
  return (lengths.empty() ? "" : lengths.ToText() + KindText(result)) +
         (rotations.empty() ? "" : "\n" + rotations.ToText());
}

}  // namespace alidade::internal
