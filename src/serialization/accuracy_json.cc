#include "src/serialization/accuracy_json.h"

namespace alidade::internal {

nlohmann::ordered_json AccuracyToJson(const Accuracy& accuracy) {
  return {{"mean", accuracy.mean},     {"rms", accuracy.rms},
          {"stddev", accuracy.stddev}, {"median", accuracy.median},
          {"p95", accuracy.p95},       {"min", accuracy.min},
          {"max", accuracy.max},       {"n", accuracy.n}};
}

nlohmann::ordered_json VectorToJson(const Eigen::VectorXd& values) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const double value : values) list.push_back(value);
  return list;
}

Accuracy ReadAccuracy(const JsonValue& json) {
  Accuracy accuracy;
  accuracy.mean = json["mean"].Number();
  accuracy.rms = json["rms"].Number();
  accuracy.stddev = json["stddev"].Number();
  accuracy.median = json["median"].Number();
  accuracy.p95 = json["p95"].Number();
  accuracy.min = json["min"].Number();
  accuracy.max = json["max"].Number();
  accuracy.n = json["n"].LongInteger();
  return accuracy;
}

Accuracy ReadAccuracyIfThere(const JsonValue& json, const char* key) {
  return json.Has(key) ? ReadAccuracy(json[key]) : Accuracy();
}

}  // namespace alidade::internal
