#ifndef ALIDADE_SRC_REPORT_PARAMETER_NAMES_H_
#define ALIDADE_SRC_REPORT_PARAMETER_NAMES_H_

#include <string>

namespace alidade::internal {

/// The kind of a parameter is in its name: "beta1" and "base_rx" are angles,
/// "d2" and "tool_x" are lengths.
inline bool IsAngleName(const std::string& name) {
  return name.rfind("beta", 0) == 0 || name.rfind("alpha", 0) == 0 ||
         name.rfind("theta", 0) == 0 || name.find("_r") != std::string::npos;
}

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_REPORT_PARAMETER_NAMES_H_
