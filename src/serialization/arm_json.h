#ifndef ALIDADE_SRC_SERIALIZATION_ARM_JSON_H_
#define ALIDADE_SRC_SERIALIZATION_ARM_JSON_H_

#include <string>

#include "alidade/arm.h"

namespace alidade::internal {

/// The arm file as JSON: the same keys and values (m, rad). It is YAML too, and
/// read wherever an arm file is.
std::string FormatArmJson(const Arm& arm);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_ARM_JSON_H_
