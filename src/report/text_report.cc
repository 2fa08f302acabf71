#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "src/common/format.h"
#include "src/common/text.h"
#include "src/report/budget_report.h"
#include "src/report/error_term_tables.h"
#include "src/report/markup.h"
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
    row.emplace_back(ToString(one.decision.state));
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
  return text + Paragraph("Given, and zero: " + Join(left_out, " "));
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
  text += Section("Accuracy", AccuracySection(result));
  text += Section("Outliers", OutlierSection(result));
  text += Section("Rejected rows", RejectedRowSection(result));
  text += Section("What can be identified",
                  FormatIdentifiability(result.identifiability));
  text += Section("Parameters", FormatParameters(result) + Aliases(result));
  text +=
      Section("Errors that are not rigid geometry", ErrorTermsSection(result));
  text += Section("Uncertainty", UncertaintySection(result));
  text += Section("Uncertainty budget", BudgetText(result));
  if (!result.runs.empty()) {
    text += Section(result.runs.size() == 1 ? "Solver" : "Solvers",
                    FormatComparison(result) + SolverMessages(result));
  }
  text += Section("Published values", FormatPublished(result)) + further;
  text += Section("Provenance", Provenance(result));
  return text;
}

namespace {

constexpr std::size_t kMostRows = 30;

void AddCells(const Accuracy& accuracy, Dimension dimension,
              std::vector<TableCell>* row) {
  for (const double value : {accuracy.mean, accuracy.rms, accuracy.stddev,
                             accuracy.median, accuracy.p95, accuracy.max}) {
    row->push_back(QuantityCell(value, dimension, 4));
    // Half of a page has no room for more.
    const double shown = value / UnitOf(dimension);
    row->back().markup = Words(FormatSignificant(shown, shown < 1e-3 ? 2 : 3));
  }
}

// The columns of AddCells.
void AddColumns(const std::string& of, const std::string& unit,
                std::vector<Table::Column>* columns) {
  columns->insert(
      columns->end(),
      {">" + of + "mean", ">rms", Table::TextOnly(">std"),
       Table::TextOnly(">median"), ">p95|95 of 100 are below", ">max" + unit});
}

void AddAccuracy(const std::string& poses, const std::string& when,
                 const Accuracy& accuracy, Dimension dimension, Table* table) {
  if (accuracy.n == 0) return;
  std::vector<TableCell> row = {poses, poses, when};
  AddCells(accuracy, dimension, &row);
  row.push_back(CountCell(accuracy.n));
  table->AddRow(std::move(row));
}

// `what` heads the text's first column, `caption` the page's table.
Table MakeAccuracyTable(const std::string& id, const std::string& what,
                        const std::string& caption = "") {
  std::vector<Table::Column> columns = {
      Table::TextOnly(what), Table::PageOnly("poses"), "calibration"};
  AddColumns("", "", &columns);
  columns.emplace_back(">n");
  return {id, caption, std::move(columns)};
}

// Which kind and target the errors of a set belong to, where there are several.
void AddKinds(const std::string& poses, const EvaluatedSet& set, Table* table) {
  std::map<std::pair<std::string, std::string>, std::vector<double>> norms;
  for (std::size_t i = 0; i < set.labels.size(); ++i) {
    const ObservationLabel& label = set.labels[i];
    if (label.pose < 0 || !label.has_length) continue;
    norms[{label.kind, label.target}].push_back(
        set.residual_after.col(static_cast<Eigen::Index>(i)).norm());
  }
  if (norms.size() < 2) return;
  for (const auto& [label, values] : norms) {
    const auto& [kind, target] = label;
    AddAccuracy(poses, target.empty() ? kind : kind + " of " + target,
                SummarizeErrors(Eigen::Map<const Eigen::VectorXd>(
                    values.data(), static_cast<Eigen::Index>(values.size()))),
                Dimension::kLength, table);
  }
}

std::string KindTable(const CalibrationResult& result) {
  Table table = MakeAccuracyTable("kinds", "of which, after [mm]");
  AddKinds("training poses", result.train, &table);
  if (result.validation) {
    AddKinds("validation poses", *result.validation, &table);
  }
  return table.empty() ? "" : "\n" + table.ToText();
}

std::string StagesText(const CalibrationResult& result) {
  if (result.stages.empty()) return "";
  const Table rotations = StagesTable(result, Dimension::kAngle);
  return "\n" + Paragraph("Accuracy by stage:") +
         StagesTable(result, Dimension::kLength).ToText() +
         (rotations.empty() ? "" : "\n" + rotations.ToText());
}

// What repeats say of the instrument and the arm, whatever its geometry.
std::string RepeatNote(const CalibrationResult& result) {
  const RepeatSpread& repeats = result.repeats;
  if (repeats.length_degrees_of_freedom == 0) return "";
  std::string text = "Repeated configurations differ by " +
                     FormatLength(repeats.length, 3) +
                     " in a coordinate (standard deviation, " +
                     std::to_string(repeats.length_degrees_of_freedom) +
                     " degrees of freedom)";
  if (repeats.rotation_degrees_of_freedom > 0) {
    text += " and " + FormatSignificant(repeats.rotation / kDegree, 3) +
            " deg in orientation";
  }
  return Paragraph(text + ": what no geometry can take away.");
}

// Says what "before" is, and what else there is to know of these errors.
std::string FitNotes(const CalibrationResult& result) {
  std::string text;
  if (!result.before_note.empty()) text += Paragraph(result.before_note + ".");
  text += RepeatNote(result);
  const std::string findings = FindingSentences(
      result, {"acceptance", "sigma", "measurement_noise", "chi_square"});
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
  if (count <= kMostRows) return "";
  return Paragraph("The first " + std::to_string(kMostRows) + ":");
}

}  // namespace

Table AccuracyTable(const CalibrationResult& result, Dimension dimension) {
  const bool is_length = dimension == Dimension::kLength;
  Table table = is_length ? MakeAccuracyTable("accuracy", "position error [mm]",
                                              "Position error [mm]")
                          : MakeAccuracyTable("rotation-accuracy",
                                              "orientation error [deg]",
                                              "Orientation error [deg]");
  const auto add_set = [&](const std::string& poses, const EvaluatedSet& set) {
    AddAccuracy(poses, "before", is_length ? set.before : set.rotation_before,
                dimension, &table);
    AddAccuracy(poses, "after", is_length ? set.after : set.rotation_after,
                dimension, &table);
    if (!set.kept) return;
    const KeptErrors& kept = *set.kept;
    const std::string without =
        ", without " + std::to_string(kept.num_rejected) + " rejected";
    AddAccuracy(poses, "before" + without,
                is_length ? kept.before : kept.rotation_before, dimension,
                &table);
    AddAccuracy(poses, "after" + without,
                is_length ? kept.after : kept.rotation_after, dimension,
                &table);
  };
  add_set("training poses", result.train);
  if (result.validation) add_set("validation poses", *result.validation);
  if (result.cross_validation) {
    const CrossValidation& folds = *result.cross_validation;
    AddAccuracy("cross-validated", std::to_string(folds.folds) + " folds",
                is_length ? folds.position : folds.rotation, dimension, &table);
    if (folds.kept) {
      AddAccuracy(
          "cross-validated",
          "without " + std::to_string(folds.kept->num_rejected) + " rejected",
          is_length ? folds.kept->position : folds.kept->rotation, dimension,
          &table);
    }
  }
  return table;
}

Table StagesTable(const CalibrationResult& result, Dimension dimension) {
  const bool is_length = dimension == Dimension::kLength;
  const bool validation = result.validation.has_value();
  const std::string poses = validation ? "validation" : "training";
  std::vector<Table::Column> columns = {{"calibrated"}, ">free"};
  AddColumns(poses + (is_length ? " " : " orientation "),
             is_length ? " [mm]" : " [deg]", &columns);
  Table table(
      is_length ? "stages-table" : "rotation-stages",
      std::string(is_length ? "Position" : "Orientation") + " error by stage",
      std::move(columns));
  for (const StageResult& stage : result.stages) {
    const Accuracy& position = validation ? stage.validation : stage.train;
    const Accuracy& rotation =
        validation ? stage.validation_rotation : stage.train_rotation;
    if (!is_length && rotation.n == 0) continue;
    std::vector<TableCell> row = {stage.name, CountCell(stage.num_free)};
    AddCells(is_length ? position : rotation, dimension, &row);
    table.AddRow(std::move(row));
  }
  return table;
}

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
         FirstRows(count) + OutlierTable(result).ToText(kMostRows);
}

std::string RejectedRowSection(const CalibrationResult& result) {
  if (result.rejected.empty()) return "";
  return Paragraph(
             Count(static_cast<std::int64_t>(result.rejected.size()), "row") +
             " took no part. result.json lists all of them.") +
         FirstRows(result.rejected.size()) +
         RejectedRowTable(result).ToText(kMostRows);
}

std::string FormatAccuracyTable(const CalibrationResult& result) {
  const Table lengths = AccuracyTable(result, Dimension::kLength);
  const Table rotations = AccuracyTable(result, Dimension::kAngle);
  if (lengths.empty() && rotations.empty()) return "No pose was evaluated.\n";
  return (lengths.empty() ? "" : lengths.ToText() + KindTable(result)) +
         (rotations.empty() ? "" : "\n" + rotations.ToText());
}

}  // namespace alidade::internal
