#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>

#include "alidade/error.h"
#include "src/calibration/verdict.h"
#include "src/common/files.h"
#include "src/serialization/accuracy_json.h"
#include "src/serialization/json_value.h"
#include "src/serialization/result_json.h"
#include "src/serialization/result_keys.h"
#include "src/serialization/uncertainty_json.h"

namespace alidade::internal {
namespace {

using Json = nlohmann::json;

EvaluatedSet ReadEvaluatedSet(const JsonValue& json) {
  EvaluatedSet set;
  set.name = json["name"].Text();
  set.joint_dimensions =
      ReadList(json["joint_units"],
               [](const JsonValue& unit) { return unit.Choice(kUnitKeys); });
  set.before = ReadAccuracy(json["before"]);
  set.after = ReadAccuracy(json["after"]);
  set.rotation_before = ReadAccuracyIfThere(json, "rotation_before");
  set.rotation_after = ReadAccuracyIfThere(json, "rotation_after");
  return set;
}

StageResult ReadStage(const JsonValue& json) {
  StageResult stage;
  stage.name = json["name"].Text();
  stage.num_free = json["free"].Integer();
  stage.train = ReadAccuracy(json["train"]);
  stage.heldout = ReadAccuracyIfThere(json, "heldout");
  stage.train_rotation = ReadAccuracyIfThere(json, "train_rotation");
  stage.heldout_rotation = ReadAccuracyIfThere(json, "heldout_rotation");
  return stage;
}

CrossValidation ReadCrossValidation(const JsonValue& json) {
  return {json["folds"].Integer(), ReadAccuracy(json["position"]),
          ReadAccuracyIfThere(json, "rotation")};
}

ReferenceResult ReadReference(const JsonValue& json) {
  ReferenceResult reference;
  reference.block = json["block"].Text();
  reference.name = json["name"].Text();
  reference.is_known = json["known"].Boolean();
  const bool is_plane = json.Has("normal");
  reference.vector = json[is_plane ? "normal" : "position"].Vector();
  if (is_plane) reference.offset = json["offset"].Number();
  return reference;
}

RejectedRow ReadRejectedRow(const JsonValue& json) {
  return {json["file"].Text(), json["line"].Integer(), json["reason"].Text()};
}

RepeatSpread ReadRepeats(const JsonValue& json) {
  return {json["length"].Number(), json["length_freedom"].LongInteger(),
          json["rotation"].Number(), json["rotation_freedom"].LongInteger()};
}

Outlier ReadOutlier(const JsonValue& json) {
  Outlier outlier;
  outlier.observation = json["pose"].LongInteger();
  outlier.label.pose = json["pose"].Integer();
  if (json.Has("observation")) {
    outlier.observation = json["observation"].LongInteger();
    outlier.label.kind = json["kind"].Text();
    outlier.label.target = json["target"].Text();
    outlier.label.where = json["where"].Text();
  }
  outlier.error = json["error"].Number();
  outlier.standardised = json["standardised"].Number();
  outlier.weight = json["weight"].Number();
  return outlier;
}

Finding ReadFinding(const JsonValue& json) {
  return {json["key"].Text(), json["statistic"].Number(),
          json["threshold"].Number(), json["sentence"].Text(),
          json["level"].Choice(kLevelKeys)};
}

Verdict ReadVerdict(const JsonValue& json) {
  return {json["level"].Choice(kLevelKeys), json["title"].Text(),
          json["sentence"].Text(), ReadList(json["findings"], ReadFinding)};
}

InputFile ReadInput(const JsonValue& json) {
  return {json["path"].Text(), json["sha256"].Text()};
}

ParameterResult ReadParameter(const JsonValue& json) {
  ParameterResult parameter;
  parameter.name = json["name"].Text();
  parameter.kind = json["kind"].Text();
  parameter.dimension = json["unit"].Choice(kUnitKeys);
  parameter.nominal = json["nominal"].Number();
  parameter.value = json["value"].Number();
  parameter.std = json["std"].Number();
  if (json.Has("truth")) parameter.truth = json["truth"].Number();
  if (json.Has("published")) parameter.published = json["published"].Number();
  if (json.Has("assessment")) {
    parameter.assessment = json["assessment"].Choice(kAssessmentKeys);
  }
  ParameterDecision& decision = parameter.decision;
  decision.name = parameter.name;
  decision.state = json["state"].Choice(kStateKeys);
  decision.rule = json["rule"].Text();
  decision.reason = json["reason"].Text();
  decision.stands_for = json["stands_for"].Text();
  decision.prior_std = json["prior_std"].Number();
  decision.predicted_std = json["predicted_std"].Number();
  return parameter;
}

RankReport ReadRankReport(const JsonValue& json) {
  RankReport report;
  report.rank = json["rank"].Integer();
  report.gap = json["gap"].Number(std::numeric_limits<double>::infinity());
  report.singular_values = json["singular_values"].Vector();
  return report;
}

Relation ReadRelation(const JsonValue& json) {
  Relation relation;
  relation.parameter = json["parameter"].Text();
  relation.level = json["level"].Text();
  relation.terms = ReadList(json["terms"], [](const JsonValue& term) {
    return std::pair(term["parameter"].Text(), term["coefficient"].Number());
  });
  relation.text = json["text"].Text();
  relation.verified = json["verified"].Boolean();
  return relation;
}

ObservabilityIndices ReadObservability(const JsonValue& json) {
  ObservabilityIndices indices;
  indices.o1 = json["o1"].Number();
  indices.o2 = json["o2"].Number();
  indices.o3 = json["o3"].Number();
  indices.o4 = json["o4"].Number();
  indices.o5 = json["o5"].Number();
  indices.condition =
      json["condition"].Number(std::numeric_limits<double>::infinity());
  return indices;
}

IdentifiabilityResult ReadIdentifiability(
    const JsonValue& json, const std::vector<ParameterResult>& parameters) {
  IdentifiabilityResult result;
  result.method = json["method"].Text();
  result.policy = json["policy"].Text();
  result.num_candidates = json["num_candidates"].Integer();
  result.generic_rank = ReadRankReport(json["generic_rank"]);
  result.structural_rank = ReadRankReport(json["structural_rank"]);
  result.relations = ReadList(json["relations"], ReadRelation);
  result.advice = json["advice"].Texts();
  result.unscaled = ReadObservability(json["observability"]["unscaled"]);
  result.scaled = ReadObservability(json["observability"]["scaled"]);
  result.num_free = json["num_free"].Integer();
  result.exceeds_rank = json["exceeds_rank"].Boolean();
  result.refusal = json["refusal"].Text();
  result.warnings = json["warnings"].Texts();
  result.weak = json["weak"].Texts();
  result.nominal_rank = ReadRankReport(json["nominal_rank"]);
  result.perturbed_rank = ReadRankReport(json["perturbed_rank"]);
  for (const ParameterResult& parameter : parameters) {
    result.decisions.push_back(parameter.decision);
  }
  return result;
}

IterationRecord ReadIteration(const JsonValue& json) {
  IterationRecord record;
  record.iteration = json["iteration"].Integer();
  record.cost = json["cost"].Number();
  record.max_error = json["max_error"].Number();
  record.rms_error = json["rms_error"].Number();
  record.step_norm = json["step_norm"].Number();
  record.accepted = json["accepted"].Boolean();
  record.time_s = json["time_s"].Number();
  return record;
}

SolverSummary ReadSummary(const JsonValue& json) {
  SolverSummary summary;
  summary.solver = json["name"].Text();
  summary.status = json["status"].Choice(kStatusKeys);
  summary.message = json["message"].Text();
  if (json.Has("evaluation")) summary.evaluation = json["evaluation"].Text();
  summary.accepted_steps = json["accepted_steps"].Integer();
  summary.rejected_steps = json["rejected_steps"].Integer();
  summary.initial_cost = json["initial_cost"].Number();
  summary.final_cost = json["final_cost"].Number();
  summary.num_poses = json["num_poses"].Integer();
  summary.num_residuals = json["num_residuals"].Integer();
  summary.num_parameters = json["num_parameters"].Integer();
  summary.num_free = json["num_free"].Integer();
  summary.threads_given = json["threads_given"].Integer();
  summary.threads_used = json["threads_used"].Integer();
  summary.trust_region_given = json["trust_region_given"].Number();
  summary.trust_region_used = json["trust_region_used"].Number();
  summary.pseudo_inverse_tolerance_given =
      json["pseudo_inverse_tolerance_given"].Number();
  summary.pseudo_inverse_tolerance_used =
      json["pseudo_inverse_tolerance_used"].Number();
  summary.first_step_rank = json["first_step_rank"].Integer();
  summary.rounding_floor = json["rounding_floor"].Number();
  summary.setup_time_s = json["setup_time_s"].Number();
  summary.solve_time_s = json["solve_time_s"].Number();
  return summary;
}

SolverRun ReadRun(const JsonValue& json) {
  SolverRun run;
  run.summary = ReadSummary(json);
  run.summary.iterations = ReadList(json["history"], ReadIteration);
  run.train = ReadAccuracy(json["train"]);
  run.values = json["values"].Vector();
  return run;
}

AcceptanceCheck ReadAcceptance(const JsonValue& json) {
  const bool has_unit = json.Has("unit");
  return {json["quantity"].Text(), json["limit"].Number(),
          json["obtained"].Number(),
          has_unit ? json["unit"].Choice(kUnitKeys) : Dimension::kLength};
}

// The parser gives the number of bytes read.
SourceLocation LocationOfByte(const std::string& path, const std::string& text,
                              std::size_t byte) {
  SourceLocation location;
  location.file = path;
  location.line = 1;
  location.column = 1;
  for (std::size_t i = 0; i + 1 < byte && i < text.size(); ++i) {
    ++location.column;
    if (text[i] == '\n') {
      ++location.line;
      location.column = 1;
    }
  }
  return location;
}

Json ParseJson(const std::string& path) {
  const std::string text = ReadFile(path);
  try {
    return Json::parse(text);
  } catch (const Json::parse_error& error) {
    throw InputError(LocationOfByte(path, text, error.byte),
                     "not valid JSON, expected a result.json that Alidade "
                     "wrote; the file may be cut off");
  } catch (const Json::out_of_range&) {
    SourceLocation location;
    location.file = path;
    throw InputError(location, "a number in it does not fit a double");
  }
}

void CheckFormat(const JsonValue& json) {
  using Formats = std::array<std::pair<int, const char*>, 1>;
  const JsonValue format = json["format"];
  if (format.Text() == kPlanResultFormat) {
    format.FailHere(kPlanResultIsForMachines);
  }
  format.Choice(Formats{{{1, kResultFormat}}});
}

// What is known of the measurements besides their fit.
void ReadMeasurements(const JsonValue& json, CalibrationResult* result) {
  if (json.Has("cross_validation")) {
    result->cross_validation = ReadCrossValidation(json["cross_validation"]);
  }
  if (!json.Has("rejected_rows")) return;
  result->rejected = ReadList(json["rejected_rows"], ReadRejectedRow);
  result->repeats = ReadRepeats(json["repeats"]);
  if (json.Has("references")) {
    result->references = ReadList(json["references"], ReadReference);
  }
  result->aliases = ReadList(json["aliases"], [](const JsonValue& alias) {
    return std::pair(alias["block"].Text(), alias["name"].Text());
  });
}

}  // namespace

CalibrationResult LoadResultJson(const std::string& path) {
  const Json root = ParseJson(path);
  const JsonValue json(path, "", root);
  CheckFormat(json);
  CalibrationResult result;
  result.version = json["version"].Text();
  result.command = json["command"].Text();
  result.title = json["title"].Text();
  result.inputs = ReadList(json["inputs"], ReadInput);
  result.seed = json["seed"].Seed();
  result.arm_name = json["arm"].Text();
  result.parameters = ReadList(json["parameters"], ReadParameter);
  result.warnings = json["warnings"].Texts();
  result.identifiability =
      ReadIdentifiability(json["identifiability"], result.parameters);
  const JsonValue accuracy = json["accuracy"];
  result.train = ReadEvaluatedSet(accuracy["train"]);
  if (accuracy.Has("heldout")) {
    result.heldout = ReadEvaluatedSet(accuracy["heldout"]);
  }
  if (accuracy.Has("before_note")) {
    result.before_note = accuracy["before_note"].Text();
  }
  // Results written before these keys were there stay readable.
  if (json.Has("stages")) result.stages = ReadList(json["stages"], ReadStage);
  if (json.Has("fit")) {
    const JsonValue fit = json["fit"];
    if (fit.Has("sigma")) result.sigma = fit["sigma"].Number();
    result.estimated_sigma = fit["estimated_sigma"].Number();
    if (fit.Has("estimated_rotation_sigma")) {
      result.estimated_rotation_sigma =
          fit["estimated_rotation_sigma"].Number();
    }
    result.reduced_chi_square = fit["reduced_chi_square"].Number();
    result.outlier_limit = fit["outlier_limit"].Number();
    result.outliers = ReadList(fit["outliers"], ReadOutlier);
  }
  if (json.Has("uncertainty")) {
    result.uncertainty = ReadUncertainty(json["uncertainty"]);
  }
  ReadMeasurements(json, &result);
  result.runs = ReadList(json["runs"], ReadRun);
  result.acceptance = ReadList(json["acceptance"], ReadAcceptance);
  if (json.Has("published_source")) {
    result.published_source = json["published_source"].Text();
  }
  result.identify_time_s = json["times"]["identify_s"].Number();
  result.total_time_s = json["times"]["total_s"].Number();
  if (json.Has("verdict")) {
    result.plausibility = ReadList(json["plausibility"], ReadFinding);
    result.verdict = ReadVerdict(json["verdict"]);
  } else {
    JudgeResult(&result);
  }
  return result;
}

}  // namespace alidade::internal
