#include "src/report/accuracy_report.h"

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "src/common/format.h"
#include "src/common/text.h"
#include "src/report/markup.h"
#include "src/report/quantities.h"
#include "src/report/report.h"

namespace alidade::internal {
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
  if (result.validation)
    AddKinds("validation poses", *result.validation, &table);
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
    AddAccuracy("held out once", std::to_string(folds.folds) + " folds",
                is_length ? folds.position : folds.rotation, dimension, &table);
    if (folds.kept) {
      AddAccuracy(
          "held out once",
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
