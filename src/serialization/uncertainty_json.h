#ifndef ALIDADE_SRC_SERIALIZATION_UNCERTAINTY_JSON_H_
#define ALIDADE_SRC_SERIALIZATION_UNCERTAINTY_JSON_H_

#include <nlohmann/json.hpp>

#include "alidade/uncertainty.h"
#include "src/serialization/json_value.h"

namespace alidade::internal {

/// The part "uncertainty" of result.json (docs/files.md). What has one entry
/// per pose or configuration is in CSV files beside it.
nlohmann::ordered_json UncertaintyToJson(const UncertaintyResult& result);

/// @throws InputError where something is missing or of the wrong type.
UncertaintyResult ReadUncertainty(const JsonValue& json);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_UNCERTAINTY_JSON_H_
