#include "src/serialization/plan_json.h"

#include <nlohmann/json.hpp>

#include "src/serialization/result_keys.h"

namespace alidade::internal {
namespace {

// Keys stay in the order in which people look for them.
using Json = nlohmann::ordered_json;

const char* UnitOf(Dimension dimension) {
  return dimension == Dimension::kAngle ? "rad" : "m";
}

Json ToJson(const PredictedAccuracy& accuracy) {
  return {{"worst", accuracy.worst}, {"rms", accuracy.rms}};
}

Json ToJson(const ObservabilityIndices& indices) {
  return {{"o1", indices.o1}, {"o2", indices.o2},
          {"o3", indices.o3}, {"o4", indices.o4},
          {"o5", indices.o5}, {"condition", indices.condition}};
}

Json PosesOf(const PlanResult& result) {
  Json poses = Json::array();
  for (Eigen::Index k = 0; k < result.joint_values.cols(); ++k) {
    Json joints = Json::array();
    for (const double value : result.joint_values.col(k)) {
      joints.push_back(value);
    }
    poses.push_back({{"joints", joints}, {"std", result.pose_std[k]}});
  }
  return poses;
}

Json ParametersOf(const PlanResult& result) {
  Json parameters = Json::array();
  for (const PlannedParameter& parameter : result.parameters) {
    parameters.push_back({{"name", parameter.name},
                          {"unit", UnitOf(parameter.dimension)},
                          {"prior_std", parameter.prior_std},
                          {"planned_std", parameter.planned_std},
                          {"random_std", parameter.random_std},
                          {"stands_for", parameter.stands_for}});
  }
  return parameters;
}

Json EvaluationsOf(const PlanResult& result) {
  Json evaluations = Json::array();
  for (const PlanEvaluation& evaluation : result.evaluations) {
    evaluations.push_back(
        {{"name", evaluation.name},
         {"candidates", ToJson(evaluation.candidates)},
         {"region", ToJson(evaluation.region)},
         {"observability", ToJson(evaluation.observability)}});
  }
  return evaluations;
}

Json CurveOf(const PlanResult& result) {
  Json curve = Json::array();
  for (const PlanCurvePoint& point : result.curve) {
    curve.push_back({{"poses", point.num_poses},
                     {"planned", ToJson(point.planned)},
                     {"random", ToJson(point.random)},
                     {"bound", point.bound}});
  }
  return curve;
}

}  // namespace

std::string FormatPlanJson(const PlanResult& result) {
  Json inputs = Json::array();
  for (const InputFile& input : result.inputs) {
    inputs.push_back({{"path", input.path}, {"sha256", input.sha256}});
  }
  Json units = Json::array();
  for (const Dimension dimension : result.joint_dimensions) {
    units.push_back(UnitOf(dimension));
  }
  const Json json = {
      {"format", kPlanResultFormat},
      {"version", result.version},
      {"command", result.command},
      {"title", result.title},
      {"arm", result.arm},
      {"inputs", inputs},
      {"seed", result.seed},
      {"criterion", result.criterion},
      {"measurement",
       {{"kind", result.measured},
        {"sigma", result.sigma},
        {"sigma_rotation", result.rotation_sigma},
        {"equations", result.equations}}},
      {"candidates", result.num_candidates},
      {"looked_at", result.num_looked_at},
      {"measured_before", result.measured_before},
      {"priors", result.has_priors},
      {"repeats", result.allow_repeats},
      {"wanted", result.wanted},
      {"joint_units", units},
      {"poses", PosesOf(result)},
      {"distinct", result.num_distinct},
      {"travel",
       {{"unit", result.travel_in_seconds ? "s" : "rad or m"},
        {"before", result.travel_before},
        {"after", result.travel}}},
      {"parameters", ParametersOf(result)},
      {"evaluations", EvaluationsOf(result)},
      {"bound", result.bound},
      {"d_efficiency", result.d_efficiency},
      {"converged", result.converged},
      {"exchanges", result.exchanges},
      {"passes", result.passes},
      {"log_criterion",
       {{"greedy", result.greedy_value}, {"planned", result.value}}},
      {"curve", CurveOf(result)},
      {"warnings", result.warnings},
      {"times",
       {{"plan_s", result.plan_time_s}, {"total_s", result.total_time_s}}}};
  return json.dump(2) + "\n";
}

}  // namespace alidade::internal
