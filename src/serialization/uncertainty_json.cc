#include "src/serialization/uncertainty_json.h"

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "src/serialization/accuracy_json.h"

namespace alidade::internal {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Json ToJson(const ParameterUncertainty& one) {
  return {{"name", one.name},
          {"std", one.std},
          {"interval",
           {{"lower", one.interval.lower},
            {"upper", one.interval.upper},
            {"profile", one.interval.is_profile}}},
          {"nonlinearity", one.nonlinearity},
          {"prior_share", one.prior_share}};
}

Json ToJson(const CorrelatedPair& pair) {
  return {{"first", pair.first},
          {"second", pair.second},
          {"correlation", pair.correlation}};
}

Json ToJson(const TestResult& test) {
  return {{"statistic", test.statistic}, {"p_value", test.p_value}};
}

Json ToJson(const Histogram& histogram) {
  return {{"lower", histogram.lower},
          {"width", histogram.width},
          {"counts", histogram.counts}};
}

Json ToJson(const Coverage& coverage) {
  return {{"held", coverage.held},
          {"n", coverage.n},
          {"rate", coverage.rate()},
          {"lower", coverage.lower},
          {"upper", coverage.upper}};
}

Json ToJson(const ResidualDiagnostics& residuals) {
  return {{"chi_square", residuals.chi_square},
          {"degrees_of_freedom", residuals.degrees_of_freedom},
          {"reduced_chi_square", residuals.reduced_chi_square},
          {"chi_square_p_value", residuals.chi_square_p_value},
          {"normality", ToJson(residuals.normality)},
          {"whiteness", ToJson(residuals.whiteness)},
          {"lags", residuals.lags},
          {"studentised_histogram", ToJson(residuals.histogram)}};
}

Json ToJson(const PredictionCheck& check) {
  return {{"confidence", check.confidence},
          {"axes", ToJson(check.axes)},
          {"ellipsoids", ToJson(check.ellipsoids)},
          {"rms_z", check.rms_z},
          {"verdict", check.verdict},
          {"z_histogram", ToJson(check.histogram)}};
}

Json MapToJson(const PredictedMap& map) {
  Json json = {{"position_std", AccuracyToJson(map.summary)},
               {"rotation_std", AccuracyToJson(map.rotation_summary)}};
  if (map.true_summary.n > 0) {
    json["true_error"] = AccuracyToJson(map.true_summary);
  }
  return json;
}

ParameterUncertainty ReadParameter(const JsonValue& json) {
  ParameterUncertainty one;
  one.name = json["name"].Text();
  one.std = json["std"].Number(kInfinity);
  const JsonValue interval = json["interval"];
  one.interval = {interval["lower"].Number(-kInfinity),
                  interval["upper"].Number(kInfinity),
                  interval["profile"].Boolean()};
  one.nonlinearity = json["nonlinearity"].Number(kInfinity);
  one.prior_share = json["prior_share"].Number();
  return one;
}

TestResult ReadTest(const JsonValue& json) {
  return {json["statistic"].Number(), json["p_value"].Number()};
}

Histogram ReadHistogram(const JsonValue& json) {
  Histogram histogram;
  histogram.lower = json["lower"].Number();
  histogram.width = json["width"].Number();
  for (const JsonValue& count : json["counts"].List()) {
    histogram.counts.push_back(count.LongInteger());
  }
  return histogram;
}

Coverage ReadCoverage(const JsonValue& json) {
  return {json["held"].LongInteger(), json["n"].LongInteger(),
          json["lower"].Number(), json["upper"].Number()};
}

ResidualDiagnostics ReadResiduals(const JsonValue& json) {
  ResidualDiagnostics residuals;
  residuals.chi_square = json["chi_square"].Number();
  residuals.degrees_of_freedom = json["degrees_of_freedom"].Number();
  residuals.reduced_chi_square = json["reduced_chi_square"].Number();
  residuals.chi_square_p_value = json["chi_square_p_value"].Number();
  residuals.normality = ReadTest(json["normality"]);
  residuals.whiteness = ReadTest(json["whiteness"]);
  residuals.lags = json["lags"].Integer();
  residuals.histogram = ReadHistogram(json["studentised_histogram"]);
  return residuals;
}

PredictionCheck ReadCheck(const JsonValue& json) {
  PredictionCheck check;
  check.confidence = json["confidence"].Number();
  check.axes = ReadCoverage(json["axes"]);
  check.ellipsoids = ReadCoverage(json["ellipsoids"]);
  check.rms_z = json["rms_z"].Number();
  check.verdict = json["verdict"].Text();
  check.histogram = ReadHistogram(json["z_histogram"]);
  return check;
}

PredictedMap ReadMap(const JsonValue& json) {
  PredictedMap map;
  map.summary = ReadAccuracy(json["position_std"]);
  map.rotation_summary = ReadAccuracy(json["rotation_std"]);
  map.true_summary = ReadAccuracyIfThere(json, "true_error");
  return map;
}

Eigen::MatrixXd ReadMatrix(const JsonValue& json) {
  const std::vector<JsonValue> rows = json.List();
  const auto size = static_cast<Eigen::Index>(rows.size());
  Eigen::MatrixXd matrix(size, size);
  Eigen::Index row = 0;
  for (const JsonValue& values : rows) {
    const Eigen::VectorXd entries = values.Vector();
    if (entries.size() != size) values.FailType("as many entries as rows");
    matrix.row(row++) = entries.transpose();
  }
  return matrix;
}

}  // namespace

nlohmann::ordered_json UncertaintyToJson(const UncertaintyResult& result) {
  Json covariance = Json::array();
  for (Eigen::Index row = 0; row < result.covariance.rows(); ++row) {
    covariance.push_back(
        VectorToJson(Eigen::VectorXd(result.covariance.row(row))));
  }
  Json json = {{"confidence", result.confidence},
               {"degrees_of_freedom", result.degrees_of_freedom},
               {"estimator", result.estimator},
               {"parameters", ToJsonList(result.parameters, ToJson)},
               {"covariance", covariance},
               {"correlated", ToJsonList(result.correlated, ToJson)},
               {"residuals", ToJson(result.residuals)}};
  if (result.workspace) json["workspace"] = MapToJson(*result.workspace);
  if (result.heldout) json["heldout"] = ToJson(*result.heldout);
  json["warnings"] = result.warnings;
  return json;
}

UncertaintyResult ReadUncertainty(const JsonValue& json) {
  UncertaintyResult result;
  result.confidence = json["confidence"].Number();
  result.degrees_of_freedom = json["degrees_of_freedom"].Number(kInfinity);
  result.estimator = json["estimator"].Text();
  result.parameters = ReadList(json["parameters"], ReadParameter);
  result.covariance = ReadMatrix(json["covariance"]);
  result.correlated = ReadList(json["correlated"], [](const JsonValue& pair) {
    return CorrelatedPair{pair["first"].Text(), pair["second"].Text(),
                          pair["correlation"].Number()};
  });
  result.residuals = ReadResiduals(json["residuals"]);
  if (json.Has("workspace")) result.workspace = ReadMap(json["workspace"]);
  if (json.Has("heldout")) result.heldout = ReadCheck(json["heldout"]);
  result.warnings = json["warnings"].Texts();
  return result;
}

}  // namespace alidade::internal
