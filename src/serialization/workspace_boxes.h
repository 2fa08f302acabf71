#ifndef ALIDADE_SRC_SERIALIZATION_WORKSPACE_BOXES_H_
#define ALIDADE_SRC_SERIALIZATION_WORKSPACE_BOXES_H_

#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "alidade/uncertainty.h"
#include "alidade/workspace_box.h"
#include "src/serialization/config_file.h"
#include "src/serialization/yaml_reader.h"
#include "src/uncertainty/uncertainty_fields.h"

namespace alidade::internal {

/// @throws InputError where a list is there that has no items.
inline void RefuseEmptyList(const YamlMap& map, const std::string& key) {
  const std::optional<YamlValue> list = map.Optional(key);
  if (list && list->List().empty()) {
    list->Fail("the list is empty, expected " + key);
  }
}

/// The list `boxes`, in the base's frame; `text` says what of them.
template <typename Visitor>
void VisitBoxes(Visitor& v, const char* text,
                std::vector<WorkspaceBox>* boxes) {
  v.Items(LengthKey("boxes").Default("anywhere"), text, *boxes,
          [](auto& item, WorkspaceBox& box) {
            for (const auto& [axis, side] :
                 {std::pair(0, "x"), std::pair(1, "y"), std::pair(2, "z")}) {
              double* const lower = &box.lower[axis];
              double* const upper = &box.upper[axis];
              item.Custom(LengthKey(side).Required().Schema(kIntervalSchema),
                          "`[lower, upper]`",
                          [=](const YamlValue& value, const Units& units) {
                            std::tie(*lower, *upper) =
                                ReadInterval(value, Dimension::kLength, units);
                          });
            }
          });
  v.Check([](const YamlMap& map) { RefuseEmptyList(map, "boxes"); });
}

/// The section `uncertainty`.
template <typename Visitor>
void VisitUncertainty(Visitor& v, UncertaintyOptions* options) {
  VisitFields(v, *options);
  v.Section(Key("region"),
            "the task region that the uncertainty budget is stated for "
            "(uncertainty.md)",
            [&](auto& section) {
              VisitBoxes(section,
                         "boxes in the base's frame that the first target is "
                         "in",
                         &options->region);
              section.Field(Key("count").AtLeast(0).AtMost(10000),
                            options->region_configurations,
                            "configurations, drawn within the joint limits, "
                            "that the budget is evaluated at; 0 = no budget");
            });
}

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_WORKSPACE_BOXES_H_
