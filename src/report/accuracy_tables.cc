#include <cctype>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "src/calibration/improvement.h"
#include "src/common/format.h"
#include "src/common/text.h"
#include "src/report/result_tables.h"
#include "src/report/table.h"

namespace alidade::internal {
namespace {

void AddCells(const Accuracy& accuracy, Dimension dimension,
              std::vector<TableCell>* row) {
  for (const double value : {accuracy.mean, accuracy.rms, accuracy.stddev,
                             accuracy.median, accuracy.p95, accuracy.max}) {
    row->push_back(QuantityCell(value, dimension, 4));
  }
}

// The columns of AddCells.
void AddColumns(const std::string& of, const std::string& unit,
                std::vector<Table::Column>* columns) {
  columns->insert(
      columns->end(),
      {">" + of + "mean", ">rms", ">std|of the errors about their mean",
       ">median", ">p95|95 of 100 are below", ">max" + unit});
}

void AddAccuracy(const std::string& poses, const std::string& when,
                 const Accuracy& accuracy, Dimension dimension, Table* table) {
  if (accuracy.n == 0) return;
  std::vector<TableCell> row = {poses, poses, when};
  AddCells(accuracy, dimension, &row);
  row.push_back(CountCell(accuracy.n));
  table->AddRow(std::move(row));
}

// `what` heads the text's first column, `caption` the page's table, `rows` the
// column that names the rows of one set of poses.
Table MakeAccuracyTable(const std::string& id, const std::string& what,
                        const std::string& caption,
                        const std::string& rows = "calibration") {
  std::vector<Table::Column> columns = {Table::TextOnly(what),
                                        Table::PageOnly("poses"), rows};
  AddColumns("", "", &columns);
  columns.emplace_back(">n");
  return {id, caption, std::move(columns)};
}

std::string Capital(std::string text) {
  text[0] =
      static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
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

}  // namespace

// What repeats say of the instrument and the arm, whatever its geometry.
std::string RepeatSentence(const CalibrationResult& result) {
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
  return text + ": what no geometry can take away.";
}

std::string StagesNote(const CalibrationResult& result) {
  if (result.stages.empty() || JudgedSet(result).Judged().num_rejected == 0) {
    return "";
  }
  return "These are the errors of all observations, those that were rejected "
         "included.";
}

Table KindTable(const CalibrationResult& result) {
  Table table = MakeAccuracyTable("kinds", "of which, after [mm]",
                                  "Of which, after [mm]", "kind and target");
  AddKinds("training poses", result.train, &table);
  if (result.validation) {
    AddKinds("validation poses", *result.validation, &table);
  }
  return table;
}

Table AccuracyTable(const CalibrationResult& result, Dimension dimension) {
  const bool is_length = dimension == Dimension::kLength;
  const std::string what = std::string(LengthErrorName(result)) + " [mm]";
  Table table = is_length ? MakeAccuracyTable("accuracy", what, Capital(what))
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
      Capital(is_length ? LengthErrorName(result) : "orientation error") +
          " by stage",
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

}  // namespace alidade::internal
