#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "alidade/report/format.h"
#include "alidade/report/report.h"
#include "alidade/report/text_table.h"
#include "src/report/solver_names.h"
#include "src/report/text.h"

namespace alidade {
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
  const double unit = dimension == Dimension::kLength ? kMillimetre : kDegree;
  return FormatSignificant(value / unit, 2);
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

void AddAccuracy(const std::string& poses, const std::string& when,
                 const Accuracy& accuracy, TextTable* table) {
  if (accuracy.n == 0) return;
  std::vector<std::string> row = {poses, when};
  for (const double value : {accuracy.mean, accuracy.rms, accuracy.median,
                             accuracy.p95, accuracy.max}) {
    row.push_back(FormatSignificant(value / kMillimetre, 4));
  }
  row.push_back(std::to_string(accuracy.n));
  table->AddRow(std::move(row));
}

std::string Change(const std::string& poses, const EvaluatedSet& set) {
  return "from " + FormatLength(set.before.max, 3) + " to " +
         FormatLength(set.after.max, 3) + " at the " +
         Count(set.after.n, poses);
}

// "The largest position error falls from ... to ... at ...; ", or nothing.
std::string Changes(const JobResult& result) {
  std::vector<std::string> changes;
  bool falls = true;
  const auto add = [&](const std::string& poses, const EvaluatedSet& set) {
    if (set.after.n == 0) return;
    changes.push_back(Change(poses, set));
    falls = falls && set.after.max < set.before.max;
  };
  add("training pose", result.train);
  if (result.heldout) add("validation pose", *result.heldout);
  if (changes.empty()) return "";
  return std::string("The largest position error ") +
         (falls ? "falls " : "goes ") + Join(changes, " and ") + "; ";
}

std::string AcceptanceVerdict(const JobResult& result) {
  if (result.acceptance.empty()) return "no acceptance limits were set";
  const auto missed =
      std::count_if(result.acceptance.begin(), result.acceptance.end(),
                    [](const AcceptanceCheck& check) { return !check.met(); });
  if (missed == 0) return "all acceptance limits are met";
  return std::to_string(missed) + " of " +
         Count(static_cast<std::int64_t>(result.acceptance.size()),
               "acceptance limit") +
         " MISSED";
}

// One sentence: what the calibration did, and whether to use it.
std::string Verdict(const JobResult& result) {
  if (result.runs.empty()) {
    const std::string& refusal = result.identifiability.refusal;
    return "Nothing was calibrated: " +
           (refusal.empty() ? "no solver has run." : refusal);
  }
  const SolverSummary& summary = result.runs.front().summary;
  std::string text =
      SolverTitle(summary.solver) + " " + ToString(summary.status) + " after " +
      Count(summary.accepted_steps + summary.rejected_steps, "iteration");
  if (!summary.IsSolutionUsable()) {
    return "NOT USABLE: " + text + ": " + summary.message;
  }
  return Changes(result) + text + "; " + AcceptanceVerdict(result) + ".";
}

std::string AcceptanceTable(const JobResult& result) {
  if (result.acceptance.empty()) return "";
  TextTable table({{"acceptance limit"},
                   {"at most [mm]", Align::kRight},
                   {"obtained [mm]", Align::kRight},
                   {"verdict"}});
  for (const AcceptanceCheck& check : result.acceptance) {
    table.AddRow({check.quantity,
                  FormatSignificant(check.limit / kMillimetre, 4),
                  FormatSignificant(check.obtained / kMillimetre, 4),
                  check.met() ? "met" : "MISSED"});
  }
  return "\n" + table.ToString();
}

std::string StagesTable(const JobResult& result) {
  if (result.stages.empty()) return "";
  const bool heldout = result.heldout.has_value();
  TextTable table(
      {{"calibrated"},
       {"free", Align::kRight},
       {heldout ? "validation mean" : "training mean", Align::kRight},
       {"rms", Align::kRight},
       {"median", Align::kRight},
       {"p95", Align::kRight},
       {"max [mm]", Align::kRight}});
  for (const StageResult& stage : result.stages) {
    const Accuracy& accuracy = heldout ? stage.heldout : stage.train;
    std::vector<std::string> row = {stage.name, std::to_string(stage.num_free)};
    for (const double value : {accuracy.mean, accuracy.rms, accuracy.median,
                               accuracy.p95, accuracy.max}) {
      row.push_back(FormatSignificant(value / kMillimetre, 4));
    }
    table.AddRow(std::move(row));
  }
  return "\n" + Paragraph("What each part of the calibration brings:") +
         table.ToString();
}

// Says what "before" is, and how the residuals compare with the sigmas.
std::string FitNotes(const JobResult& result) {
  std::string text;
  if (!result.before_note.empty()) text += Paragraph(result.before_note + ".");
  if (result.estimated_sigma > 0.0) {
    text += Paragraph("Sigma of a coordinate, estimated from the residuals: " +
                      FormatLength(result.estimated_sigma, 3) + ".");
  }
  if (result.reduced_chi_square > 0.0) {
    text += Paragraph("Chi-square by degree of freedom: " +
                      FormatSignificant(result.reduced_chi_square, 3) +
                      " (1 where the residuals are as the sigmas say).");
  }
  return text.empty() ? "" : "\n" + text;
}

std::string OutlierTable(const JobResult& result) {
  if (result.outliers.empty()) return "";
  constexpr std::size_t kMostRows = 30;
  TextTable table({{"training pose", Align::kRight},
                   {"error [mm]", Align::kRight},
                   {"in sigmas", Align::kRight},
                   {"weight in the fit", Align::kRight}});
  for (const Outlier& outlier : result.outliers) {
    if (static_cast<std::size_t>(&outlier - result.outliers.data()) ==
        kMostRows) {
      break;
    }
    table.AddRow({std::to_string(outlier.pose + 1),
                  FormatSignificant(outlier.error / kMillimetre, 4),
                  FormatSignificant(outlier.standardised, 3),
                  FormatSignificant(outlier.weight, 2)});
  }
  std::string text = Paragraph(
      Count(static_cast<std::int64_t>(result.outliers.size()), "pose") +
      " of " + std::to_string(result.train.after.n) + " beyond " +
      FormatSignificant(result.outlier_limit, 3) +
      " sigmas, where one in twenty calibrations would have one by chance. "
      "None was left out of the accuracy; the weight is what the loss left "
      "them in the fit. residuals.csv has all of them.");
  if (result.outliers.size() > kMostRows) {
    text += Paragraph("The worst " + std::to_string(kMostRows) + ":");
  }
  return text + table.ToString();
}

std::string SolverMessages(const JobResult& result) {
  std::string text = "\n";
  for (const SolverRun& run : result.runs) {
    text +=
        Paragraph(SolverTitle(run.summary.solver) + ": " +
                  ToString(run.summary.status) + ". " + run.summary.message);
  }
  return text;
}

std::string Provenance(const JobResult& result) {
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

std::string Section(const std::string& title, const std::string& body) {
  if (body.empty()) return "";
  return "\n" + Heading(title) + body;
}

}  // namespace

std::string FormatParameters(const JobResult& result) {
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

std::string FormatAccuracyTable(const JobResult& result) {
  TextTable table({{"position error [mm]"},
                   {"calibration"},
                   {"mean", Align::kRight},
                   {"rms", Align::kRight},
                   {"median", Align::kRight},
                   {"p95", Align::kRight},
                   {"max", Align::kRight},
                   {"n", Align::kRight}});
  AddAccuracy("training poses", "before", result.train.before, &table);
  AddAccuracy("training poses", "after", result.train.after, &table);
  if (result.heldout) {
    AddAccuracy("validation poses", "before", result.heldout->before, &table);
    AddAccuracy("validation poses", "after", result.heldout->after, &table);
  }
  if (table.empty()) return "No pose was evaluated.\n";
  return table.ToString();
}

std::string FormatReport(const JobResult& result) {
  const std::string title =
      result.title.empty() ? "Calibration of " + result.arm : result.title;
  std::string text = Heading(title, '=') + "\n";
  if (!result.arm.empty()) text += Paragraph("Arm: " + result.arm) + "\n";
  text += Paragraph(Verdict(result));
  for (const std::string& warning : result.warnings) {
    text += Paragraph("Warning: " + warning + ".");
  }
  text +=
      Section("Accuracy", FormatAccuracyTable(result) + StagesTable(result) +
                              FitNotes(result) + AcceptanceTable(result));
  text += Section("Outliers", OutlierTable(result));
  text += Section("What can be identified",
                  FormatIdentifiability(result.identifiability));
  text += Section("Parameters", FormatParameters(result));
  if (!result.runs.empty()) {
    text += Section(result.runs.size() == 1 ? "Solver" : "Solvers",
                    FormatComparison(result) + SolverMessages(result));
  }
  text += Section("Published study", FormatStudyTable(result));
  text += Section("Provenance", Provenance(result));
  return text;
}

}  // namespace alidade
