#ifndef ALIDADE_SRC_COMMON_YAML_TEXT_H_
#define ALIDADE_SRC_COMMON_YAML_TEXT_H_

#include <string>

namespace alidade::internal {

/// A text in single quotes, on one line, as YAML reads it anywhere.
std::string QuotedYaml(const std::string& text);

/// Without quotes where YAML reads it so in a list: "Pos X (mm)".
std::string YamlText(const std::string& text);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_COMMON_YAML_TEXT_H_
