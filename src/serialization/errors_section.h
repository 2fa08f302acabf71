#ifndef ALIDADE_SRC_SERIALIZATION_ERRORS_SECTION_H_
#define ALIDADE_SRC_SERIALIZATION_ERRORS_SECTION_H_

#include <vector>

#include "alidade/calibration_options.h"
#include "src/serialization/field_records.h"

namespace alidade::internal {

inline constexpr char kErrorsSchema[] =
    R"({"anyOf": [{"enum": ["none", "auto"]}, {"$ref": "#/$defs/errors"}]})";

/// The keys of a job's `errors` that states its terms.
std::vector<FieldRecord> ErrorTermFields();

/// `none`, `auto` or a map of terms, for an arm of so many joints. @throws
/// InputError.
ErrorTermOptions ReadErrorTerms(const YamlValue& value, const Units& units,
                                int num_joints);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_ERRORS_SECTION_H_
