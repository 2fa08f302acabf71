#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "src/common/format.h"
#include "src/common/text.h"
#include "src/common/text_table.h"
#include "src/report/accuracy_report.h"
#include "src/report/quantities.h"
#include "src/report/report.h"
#include "src/report/uncertainty_report.h"
#include "src/solve/solver_names.h"

namespace alidade::internal {
namespace {

using Align = TextTable::Align;

constexpr int kParameterDecimals = 6;
bool IsUnremarkable(const ParameterResult& parameter) {
  return parameter.decision.state == ParameterState::kGiven &&
         parameter.nominal == 0.0 && parameter.value == 0.0 &&
         parameter.truth.value_or(0.0) == 0.0;
}

// Which of the columns that not every job has are there.
struct ParameterColumns {
  bool std = false;
  bool truth = false;
};

std::string SignificantParameter(double value, Dimension dimension) {
  if (std::isnan(value)) return "-";
  return InUnit(value, dimension, 2);
}

std::vector<std::string> ParameterRow(const ParameterResult& parameter,
                                      const ParameterColumns& columns) {
  const Dimension dimension = parameter.dimension;
  const auto fixed = [dimension](double value) {
    return FormatParameter(value, dimension, kParameterDecimals);
  };
  std::vector<std::string> row = {
      parameter.name, UnitForPeople(dimension), fixed(parameter.nominal),
      fixed(parameter.value), fixed(parameter.deviation())};
  if (columns.std) {
    row.push_back(SignificantParameter(parameter.std, dimension));
  }
  if (columns.truth) {
    const bool known = parameter.truth.has_value();
    row.push_back(known ? fixed(*parameter.truth) : "-");
    row.push_back(known ? SignificantParameter(
                              parameter.value - *parameter.truth, dimension)
                        : "-");
  }
  row.emplace_back(ToString(parameter.decision.state));
  return row;
}

TextTable ParameterTable(const ParameterColumns& columns) {
  std::vector<TextTable::Column> titles = {{"name"},
                                           {"unit"},
                                           {"nominal", Align::kRight},
                                           {"identified", Align::kRight},
                                           {"deviation", Align::kRight}};
  if (columns.std) titles.push_back({"std", Align::kRight});
  if (columns.truth) {
    titles.push_back({"true value", Align::kRight});
    titles.push_back({"difference", Align::kRight});
  }
  titles.push_back({"state"});
  return TextTable(std::move(titles));
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
  ParameterColumns columns;
  for (const ParameterResult& parameter : result.parameters) {
    columns.std |= std::isfinite(parameter.std);
    columns.truth |= parameter.truth.has_value();
  }
  TextTable table = ParameterTable(columns);
  std::vector<std::string> left_out;
  for (const ParameterResult& parameter : result.parameters) {
    if (IsUnremarkable(parameter)) {
      left_out.push_back(parameter.name);
    } else {
      table.AddRow(ParameterRow(parameter, columns));
    }
  }
  std::string text = table.ToString();
  if (!left_out.empty()) {
    text += Paragraph("Given, and zero: " + Join(left_out, " "));
  }
  return text;
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
  TextTable table({{"name"},
                   {"unit"},
                   {"published", Align::kRight},
                   {"obtained", Align::kRight},
                   {"difference", Align::kRight}});
  for (const ParameterResult& parameter : result.parameters) {
    if (!parameter.published) continue;
    const Dimension dimension = parameter.dimension;
    table.AddRow(
        {parameter.name, UnitForPeople(dimension),
         FormatParameter(*parameter.published, dimension, kParameterDecimals),
         FormatParameter(parameter.value, dimension, kParameterDecimals),
         SignificantParameter(parameter.value - *parameter.published,
                              dimension)});
  }
  if (table.empty()) return "";
  return Paragraph("Published: " + result.published_source) + "\n" +
         table.ToString();
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
  text += Section("Accuracy", AccuracySection(result));
  text += Section("Outliers", OutlierSection(result));
  text += Section("Rejected rows", RejectedRowSection(result));
  text += Section("What can be identified",
                  FormatIdentifiability(result.identifiability));
  text += Section("Parameters", FormatParameters(result) + Aliases(result));
  text += Section("Uncertainty", UncertaintySection(result));
  if (!result.runs.empty()) {
    text += Section(result.runs.size() == 1 ? "Solver" : "Solvers",
                    FormatComparison(result) + SolverMessages(result));
  }
  text += Section("Published values", FormatPublished(result)) + further;
  text += Section("Provenance", Provenance(result));
  return text;
}

}  // namespace alidade::internal
