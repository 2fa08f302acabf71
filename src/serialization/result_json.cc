#include "src/serialization/result_json.h"

#include <nlohmann/json.hpp>

#include "src/serialization/accuracy_json.h"
#include "src/serialization/result_keys.h"
#include "src/serialization/uncertainty_json.h"

namespace alidade::internal {
namespace {

// Keys stay in the order in which people look for them.
using Json = nlohmann::ordered_json;

Json ToJson(const EvaluatedSet& set) {
  Json units = Json::array();
  for (const Dimension dimension : set.joint_dimensions) {
    units.push_back(KeyOf(kUnitKeys, dimension));
  }
  Json json = {{"name", set.name},
               {"joint_units", units},
               {"before", AccuracyToJson(set.before)},
               {"after", AccuracyToJson(set.after)}};
  if (set.rotation_after.n > 0) {
    json["rotation_before"] = AccuracyToJson(set.rotation_before);
    json["rotation_after"] = AccuracyToJson(set.rotation_after);
  }
  return json;
}

Json ToJson(const StageResult& stage) {
  Json json = {{"name", stage.name},
               {"free", stage.num_free},
               {"train", AccuracyToJson(stage.train)}};
  if (stage.heldout.n > 0) json["heldout"] = AccuracyToJson(stage.heldout);
  if (stage.train_rotation.n > 0) {
    json["train_rotation"] = AccuracyToJson(stage.train_rotation);
  }
  if (stage.heldout_rotation.n > 0) {
    json["heldout_rotation"] = AccuracyToJson(stage.heldout_rotation);
  }
  return json;
}

Json ToJson(const CrossValidation& validation) {
  Json json = {{"folds", validation.folds},
               {"position", AccuracyToJson(validation.position)}};
  if (validation.rotation.n > 0)
    json["rotation"] = AccuracyToJson(validation.rotation);
  return json;
}

Json ToJson(const ReferenceResult& reference) {
  const bool is_plane = std::isfinite(reference.offset);
  Json json = {
      {"block", reference.block},
      {"name", reference.name},
      {"known", reference.is_known},
      {is_plane ? "normal" : "position",
       {reference.vector.x(), reference.vector.y(), reference.vector.z()}}};
  if (is_plane) json["offset"] = reference.offset;
  return json;
}

Json ToJson(const RejectedRow& row) {
  return {{"file", row.file}, {"line", row.line}, {"reason", row.reason}};
}

Json ToJson(const Outlier& outlier) {
  return {
      {"observation", outlier.observation},   {"pose", outlier.label.pose},
      {"kind", outlier.label.kind},           {"target", outlier.label.target},
      {"where", outlier.label.where},         {"error", outlier.error},
      {"standardised", outlier.standardised}, {"weight", outlier.weight}};
}

Json ToJson(const Finding& finding) {
  return {{"key", finding.key},
          {"level", KeyOf(kLevelKeys, finding.level)},
          {"statistic", finding.statistic},
          {"threshold", finding.threshold},
          {"sentence", finding.sentence}};
}

Json ToJson(const Verdict& verdict) {
  return {{"level", KeyOf(kLevelKeys, verdict.level)},
          {"title", verdict.title},
          {"sentence", verdict.sentence},
          {"findings", ToJsonList(verdict.findings, ToJson)}};
}

Json ToJson(const InputFile& input) {
  return {{"path", input.path}, {"sha256", input.sha256}};
}

Json ToJson(const ParameterResult& parameter) {
  Json json = {{"name", parameter.name},
               {"kind", parameter.kind},
               {"unit", KeyOf(kUnitKeys, parameter.dimension)},
               {"nominal", parameter.nominal},
               {"value", parameter.value},
               {"deviation", parameter.deviation()},
               {"std", parameter.std}};
  if (parameter.truth) json["truth"] = *parameter.truth;
  if (parameter.published) json["published"] = *parameter.published;
  const ParameterDecision& decision = parameter.decision;
  json["state"] = KeyOf(kStateKeys, decision.state);
  json["assessment"] = KeyOf(kAssessmentKeys, parameter.assessment);
  json["rule"] = decision.rule;
  json["reason"] = decision.reason;
  json["stands_for"] = decision.stands_for;
  json["prior_std"] = decision.prior_std;
  json["predicted_std"] = decision.predicted_std;
  return json;
}

Json ToJson(const RankReport& report) {
  return {{"rank", report.rank},
          {"gap", report.gap},
          {"singular_values", VectorToJson(report.singular_values)}};
}

Json ToJson(const Relation& relation) {
  Json terms = Json::array();
  for (const auto& [name, coefficient] : relation.terms) {
    terms.push_back({{"parameter", name}, {"coefficient", coefficient}});
  }
  return {{"parameter", relation.parameter},
          {"level", relation.level},
          {"terms", terms},
          {"text", relation.text},
          {"verified", relation.verified}};
}

Json ToJson(const ObservabilityIndices& indices) {
  return {{"o1", indices.o1}, {"o2", indices.o2},
          {"o3", indices.o3}, {"o4", indices.o4},
          {"o5", indices.o5}, {"condition", indices.condition}};
}

Json ToJson(const IdentifiabilityResult& result) {
  return {{"method", result.method},
          {"policy", result.policy},
          {"num_candidates", result.num_candidates},
          {"generic_rank", ToJson(result.generic_rank)},
          {"structural_rank", ToJson(result.structural_rank)},
          {"relations", ToJsonList(result.relations, ToJson)},
          {"advice", result.advice},
          {"observability",
           {{"unscaled", ToJson(result.unscaled)},
            {"scaled", ToJson(result.scaled)}}},
          {"num_free", result.num_free},
          {"exceeds_rank", result.exceeds_rank},
          {"refusal", result.refusal},
          {"warnings", result.warnings},
          {"weak", result.weak},
          {"nominal_rank", ToJson(result.nominal_rank)},
          {"perturbed_rank", ToJson(result.perturbed_rank)}};
}

Json ToJson(const IterationRecord& record) {
  return {{"iteration", record.iteration}, {"cost", record.cost},
          {"max_error", record.max_error}, {"rms_error", record.rms_error},
          {"step_norm", record.step_norm}, {"accepted", record.accepted},
          {"time_s", record.time_s}};
}

Json ToJson(const SolverSummary& summary) {
  const int last =
      summary.iterations.empty() ? 0 : summary.iterations.back().iteration;
  return {
      {"name", summary.solver},
      {"evaluation", summary.evaluation},
      {"status", KeyOf(kStatusKeys, summary.status)},
      {"message", summary.message},
      {"iterations", last},
      {"accepted_steps", summary.accepted_steps},
      {"rejected_steps", summary.rejected_steps},
      {"initial_cost", summary.initial_cost},
      {"final_cost", summary.final_cost},
      {"num_poses", summary.num_poses},
      {"num_residuals", summary.num_residuals},
      {"num_parameters", summary.num_parameters},
      {"num_free", summary.num_free},
      {"threads_given", summary.threads_given},
      {"threads_used", summary.threads_used},
      {"trust_region_given", summary.trust_region_given},
      {"trust_region_used", summary.trust_region_used},
      {"pseudo_inverse_tolerance_given",
       summary.pseudo_inverse_tolerance_given},
      {"pseudo_inverse_tolerance_used", summary.pseudo_inverse_tolerance_used},
      {"first_step_rank", summary.first_step_rank},
      {"rounding_floor", summary.rounding_floor},
      {"time_s", summary.setup_time_s + summary.solve_time_s},
      {"setup_time_s", summary.setup_time_s},
      {"solve_time_s", summary.solve_time_s}};
}

Json ToJson(const SolverRun& run) {
  Json json = ToJson(run.summary);
  json["train"] = AccuracyToJson(run.train);
  json["values"] = VectorToJson(run.values);
  json["history"] = ToJsonList(run.summary.iterations, ToJson);
  return json;
}

Json ToJson(const AcceptanceCheck& check) {
  return {{"quantity", check.quantity},
          {"unit", KeyOf(kUnitKeys, check.dimension)},
          {"limit", check.limit},
          {"obtained", check.obtained},
          {"met", check.met()}};
}

}  // namespace

std::string FormatResultJson(const CalibrationResult& result) {
  Json json = {{"format", kResultFormat},
               {"version", result.version},
               {"command", result.command},
               {"title", result.title},
               {"inputs", ToJsonList(result.inputs, ToJson)},
               {"seed", result.seed},
               {"arm", result.arm_name},
               {"verdict", ToJson(result.verdict)},
               {"parameters", ToJsonList(result.parameters, ToJson)},
               {"warnings", result.warnings},
               {"plausibility", ToJsonList(result.plausibility, ToJson)},
               {"identifiability", ToJson(result.identifiability)},
               {"accuracy", {{"train", ToJson(result.train)}}}};
  if (result.heldout) json["accuracy"]["heldout"] = ToJson(*result.heldout);
  json["accuracy"]["before_note"] = result.before_note;
  json["stages"] = ToJsonList(result.stages, ToJson);
  if (result.cross_validation) {
    json["cross_validation"] = ToJson(*result.cross_validation);
  }
  json["rejected_rows"] = ToJsonList(result.rejected, ToJson);
  json["aliases"] = Json::array();
  for (const auto& [block, name] : result.aliases) {
    json["aliases"].push_back({{"block", block}, {"name", name}});
  }
  json["references"] = ToJsonList(result.references, ToJson);
  json["repeats"] = {{"length", result.repeats.length},
                     {"length_freedom", result.repeats.length_freedom},
                     {"rotation", result.repeats.rotation},
                     {"rotation_freedom", result.repeats.rotation_freedom}};
  json["fit"] = {{"sigma", result.sigma},
                 {"estimated_sigma", result.estimated_sigma},
                 {"estimated_rotation_sigma", result.estimated_rotation_sigma},
                 {"reduced_chi_square", result.reduced_chi_square},
                 {"outlier_limit", result.outlier_limit},
                 {"outliers", ToJsonList(result.outliers, ToJson)}};
  if (result.uncertainty) {
    json["uncertainty"] = UncertaintyToJson(*result.uncertainty);
  }
  json["solver"] = result.runs.empty() ? ToJson(SolverSummary())
                                       : ToJson(result.runs.front().summary);
  json["runs"] = ToJsonList(result.runs, ToJson);
  json["acceptance"] = ToJsonList(result.acceptance, ToJson);
  if (!result.published_source.empty()) {
    json["published_source"] = result.published_source;
  }
  json["times"] = {{"identify_s", result.identify_time_s},
                   {"total_s", result.total_time_s}};
  // Paths may hold bytes that are no UTF-8.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace alidade::internal
