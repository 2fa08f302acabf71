#ifndef ALIDADE_SRC_SERIALIZATION_ACCURACY_JSON_H_
#define ALIDADE_SRC_SERIALIZATION_ACCURACY_JSON_H_

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <vector>

#include "alidade/accuracy.h"
#include "src/serialization/json_value.h"

namespace alidade::internal {

// What several parts of result.json are made of.

nlohmann::ordered_json AccuracyToJson(const Accuracy& accuracy);
nlohmann::ordered_json VectorToJson(const Eigen::VectorXd& values);

template <typename Item>
nlohmann::ordered_json ToJsonList(
    const std::vector<Item>& items,
    nlohmann::ordered_json (*convert)(const Item&)) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Item& item : items) list.push_back(convert(item));
  return list;
}

Accuracy ReadAccuracy(const JsonValue& json);
/// n = 0 where the key is missing.
Accuracy ReadAccuracyIfThere(const JsonValue& json, const char* key);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_ACCURACY_JSON_H_
