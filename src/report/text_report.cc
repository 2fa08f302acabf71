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
constexpr int kNamesWidth = 28;
constexpr int kReasonWidth = 44;
constexpr int kStandsForWidth = 16;

// Decisions that read the same are one row.
struct DecisionGroup {
  std::vector<std::string> names;
  ParameterDecision decision;
};

bool ReadTheSame(const ParameterDecision& a, const ParameterDecision& b) {
  return a.state == b.state && a.reason == b.reason &&
         a.stands_for == b.stands_for;
}

std::vector<DecisionGroup> GroupDecisions(
    const std::vector<ParameterDecision>& decisions) {
  std::vector<DecisionGroup> groups;
  for (const ParameterState state :
       {ParameterState::kFree, ParameterState::kFrozen,
        ParameterState::kGiven}) {
    for (const ParameterDecision& decision : decisions) {
      if (decision.state != state) continue;
      const auto group = std::find_if(
          groups.begin(), groups.end(), [&decision](const DecisionGroup& g) {
            return ReadTheSame(g.decision, decision);
          });
      if (group == groups.end()) {
        groups.push_back({{decision.name}, decision});
      } else {
        group->names.push_back(decision.name);
      }
    }
  }
  return groups;
}

std::int64_t CountState(const IdentifiabilityResult& result,
                        ParameterState state) {
  return std::count_if(result.decisions.begin(), result.decisions.end(),
                       [state](const ParameterDecision& decision) {
                         return decision.state == state;
                       });
}

std::string DecisionTable(const IdentifiabilityResult& result) {
  TextTable table({{"parameter"}, {"state"}, {"why"}, {"stands for"}});
  for (const DecisionGroup& group : GroupDecisions(result.decisions)) {
    AddWrappedRow({Join(group.names, " "), ToString(group.decision.state),
                   group.decision.reason, group.decision.stands_for},
                  {kNamesWidth, 0, kReasonWidth, kStandsForWidth}, &table);
  }
  return table.ToString();
}

std::string FormatGap(const RankReport& report) {
  if (report.rank == report.singular_values.size()) return "nothing dropped";
  if (std::isinf(report.gap)) return "exact";
  return FormatSignificant(report.gap, 2);
}

std::string RankTable(const IdentifiabilityResult& result) {
  TextTable table(
      {{"geometry"}, {"rank", Align::kRight}, {"gap", Align::kRight}});
  const auto add = [&table](const char* geometry, const RankReport& report) {
    table.AddRow({geometry,
                  std::to_string(report.rank) + " of " +
                      std::to_string(report.singular_values.size()),
                  FormatGap(report)});
  };
  add("nominal", result.nominal_rank);
  add("perturbed", result.perturbed_rank);
  return table.ToString();
}

std::string Remarks(const IdentifiabilityResult& result) {
  std::string text;
  if (!result.weak.empty()) {
    text += Paragraph("Told apart from others by second-order effects only: " +
                      Join(result.weak, " "));
  }
  for (const std::string& warning : result.warnings) {
    text += Paragraph("Warning: " + warning);
  }
  return text;
}

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

std::string FormatIdentifiability(const IdentifiabilityResult& result) {
  const std::int64_t free = CountState(result, ParameterState::kFree);
  const std::int64_t frozen = CountState(result, ParameterState::kFrozen);
  std::string text = Paragraph(
      std::to_string(free) + " of " + Count(free + frozen, "parameter") +
      " are to be identified, " + std::to_string(frozen) +
      (frozen == 1 ? " is" : " are") + " held at the nominal value.");
  if (result.exceeds_rank) {
    text += Paragraph("More parameters are kept than can be told apart: " +
                      result.refusal);
  }
  text += "\n" + DecisionTable(result) + "\n";
  text += Paragraph(
      "Rank of the Jacobian of the kept parameters at these poses, at the "
      "nominal geometry and at small random changes of it (gap: the smallest "
      "singular value kept over the largest dropped):");
  text += RankTable(result);
  const std::string remarks = Remarks(result);
  if (!remarks.empty()) text += "\n" + remarks;
  return text;
}

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
  text += Section("Accuracy",
                  FormatAccuracyTable(result) + AcceptanceTable(result));
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
