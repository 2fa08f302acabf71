#include "src/report/accuracy_report.h"

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "src/common/format.h"
#include "src/common/text.h"
#include "src/common/text_table.h"
#include "src/report/report.h"

namespace alidade::internal {
namespace {

using Align = TextTable::Align;

constexpr std::size_t kMostRows = 30;

double UnitOf(Dimension dimension) {
  return dimension == Dimension::kLength ? kMillimetre : kDegree;
}

void AddCells(const Accuracy& accuracy, Dimension dimension,
              std::vector<std::string>* row) {
  for (const double value : {accuracy.mean, accuracy.rms, accuracy.stddev,
                             accuracy.median, accuracy.p95, accuracy.max}) {
    row->push_back(FormatSignificant(value / UnitOf(dimension), 4));
  }
}

void AddAccuracy(const std::string& poses, const std::string& when,
                 const Accuracy& accuracy, Dimension dimension,
                 TextTable* table) {
  if (accuracy.n == 0) return;
  std::vector<std::string> row = {poses, when};
  AddCells(accuracy, dimension, &row);
  row.push_back(std::to_string(accuracy.n));
  table->AddRow(std::move(row));
}

TextTable MakeAccuracyTable(const std::string& title) {
  return TextTable({{title},
                    {"calibration"},
                    {"mean", Align::kRight},
                    {"rms", Align::kRight},
                    {"std", Align::kRight},
                    {"median", Align::kRight},
                    {"p95", Align::kRight},
                    {"max", Align::kRight},
                    {"n", Align::kRight}});
}

void AddCrossValidation(const CalibrationResult& result,
                        const Accuracy& accuracy, Dimension dimension,
                        TextTable* table) {
  if (!result.cross_validation) return;
  AddAccuracy("held out once",
              std::to_string(result.cross_validation->folds) + " folds",
              accuracy, dimension, table);
}

// Which kind and target the errors of a set belong to, where there are several.
void AddKinds(const std::string& poses, const EvaluatedSet& set,
              TextTable* table) {
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
  TextTable table = MakeAccuracyTable("of which, after [mm]");
  AddKinds("training poses", result.train, &table);
  if (result.heldout) AddKinds("validation poses", *result.heldout, &table);
  return table.empty() ? "" : "\n" + table.ToString();
}

std::string RotationTable(const CalibrationResult& result) {
  TextTable table = MakeAccuracyTable("orientation error [deg]");
  const auto add_set = [&](const std::string& poses, const EvaluatedSet& set) {
    AddAccuracy(poses, "before", set.rotation_before, Dimension::kAngle,
                &table);
    AddAccuracy(poses, "after", set.rotation_after, Dimension::kAngle, &table);
  };
  add_set("training poses", result.train);
  if (result.heldout) add_set("validation poses", *result.heldout);
  if (result.cross_validation) {
    AddCrossValidation(result, result.cross_validation->rotation,
                       Dimension::kAngle, &table);
  }
  return table.empty() ? "" : "\n" + table.ToString();
}

TextTable MakeStagesTable(const std::string& poses, const std::string& unit) {
  return TextTable({{"calibrated"},
                    {"free", Align::kRight},
                    {poses + " mean", Align::kRight},
                    {"rms", Align::kRight},
                    {"std", Align::kRight},
                    {"median", Align::kRight},
                    {"p95", Align::kRight},
                    {"max [" + unit + "]", Align::kRight}});
}

std::string StagesTable(const CalibrationResult& result) {
  if (result.stages.empty()) return "";
  const bool heldout = result.heldout.has_value();
  const std::string poses = heldout ? "validation" : "training";
  TextTable lengths = MakeStagesTable(poses, "mm");
  TextTable rotations = MakeStagesTable(poses + " orientation", "deg");
  for (const StageResult& stage : result.stages) {
    const std::vector<std::string> start = {stage.name,
                                            std::to_string(stage.num_free)};
    std::vector<std::string> row = start;
    AddCells(heldout ? stage.heldout : stage.train, Dimension::kLength, &row);
    lengths.AddRow(std::move(row));
    const Accuracy& rotation =
        heldout ? stage.heldout_rotation : stage.train_rotation;
    if (rotation.n == 0) continue;
    row = start;
    AddCells(rotation, Dimension::kAngle, &row);
    rotations.AddRow(std::move(row));
  }
  return "\n" + Paragraph("What each part of the calibration brings:") +
         lengths.ToString() +
         (rotations.empty() ? "" : "\n" + rotations.ToString());
}

// What repeats say of the instrument and the arm, whatever its geometry.
std::string RepeatNote(const CalibrationResult& result) {
  const RepeatSpread& repeats = result.repeats;
  if (repeats.length_freedom == 0) return "";
  std::string text =
      "Repeated configurations differ by " + FormatLength(repeats.length, 3) +
      " in a coordinate (standard deviation, " +
      std::to_string(repeats.length_freedom) + " degrees of freedom)";
  if (repeats.rotation_freedom > 0) {
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
  TextTable table({{"acceptance limit"},
                   {"unit"},
                   {"at most", Align::kRight},
                   {"obtained", Align::kRight},
                   {"verdict"}});
  for (const AcceptanceCheck& check : result.acceptance) {
    const double unit = UnitOf(check.dimension);
    table.AddRow({check.quantity, UnitForPeople(check.dimension),
                  FormatSignificant(check.limit / unit, 4),
                  FormatSignificant(check.obtained / unit, 4),
                  check.met() ? "met" : "MISSED"});
  }
  return "\n" + table.ToString();
}

std::string FirstRows(std::size_t count) {
  if (count <= kMostRows) return "";
  return Paragraph("The first " + std::to_string(kMostRows) + ":");
}

}  // namespace

std::string AccuracySection(const CalibrationResult& result) {
  return FormatAccuracyTable(result) + StagesTable(result) + FitNotes(result) +
         AcceptanceTable(result);
}

std::string OutlierTable(const CalibrationResult& result) {
  if (result.outliers.empty()) return "";
  TextTable table({{"observation", Align::kRight},
                   {"kind"},
                   {"target"},
                   {"read from"},
                   {"error [mm]", Align::kRight},
                   {"in sigmas", Align::kRight},
                   {"weight in the fit", Align::kRight}});
  std::size_t count = 0;
  for (const Outlier& outlier : result.outliers) {
    if (count++ == kMostRows) break;
    table.AddRow({std::to_string(outlier.observation + 1), outlier.label.kind,
                  outlier.label.target, outlier.label.where,
                  FormatSignificant(outlier.error / kMillimetre, 4),
                  FormatSignificant(outlier.standardised, 3),
                  FormatSignificant(outlier.weight, 2)});
  }
  return Paragraph(FindingSentences(result, {"outliers"}) +
                   " The limits of other kinds than positions are equally "
                   "improbable. No outlier was left out of the accuracy; the "
                   "weight is what the loss left it in the fit. Worst first; "
                   "residuals.csv has all of them.") +
         FirstRows(result.outliers.size()) + table.ToString();
}

std::string RejectedRowTable(const CalibrationResult& result) {
  if (result.rejected.empty()) return "";
  TextTable table({{"file"}, {"line", Align::kRight}, {"reason"}});
  std::size_t count = 0;
  for (const RejectedRow& row : result.rejected) {
    if (count++ == kMostRows) break;
    table.AddRow({row.file, std::to_string(row.line), row.reason});
  }
  return Paragraph(
             Count(static_cast<std::int64_t>(result.rejected.size()), "row") +
             " took no part. result.json lists all of them.") +
         FirstRows(result.rejected.size()) + table.ToString();
}

std::string FormatAccuracyTable(const CalibrationResult& result) {
  TextTable table = MakeAccuracyTable("position error [mm]");
  const auto add_set = [&](const std::string& poses, const EvaluatedSet& set) {
    AddAccuracy(poses, "before", set.before, Dimension::kLength, &table);
    AddAccuracy(poses, "after", set.after, Dimension::kLength, &table);
  };
  add_set("training poses", result.train);
  if (result.heldout) add_set("validation poses", *result.heldout);
  if (result.cross_validation) {
    AddCrossValidation(result, result.cross_validation->position,
                       Dimension::kLength, &table);
  }
  const std::string rotations = RotationTable(result);
  if (table.empty() && rotations.empty()) return "No pose was evaluated.\n";
  return (table.empty() ? "" : table.ToString() + KindTable(result)) +
         rotations;
}

}  // namespace alidade::internal
