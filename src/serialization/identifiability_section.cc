#include "src/serialization/identifiability_section.h"

#include <algorithm>
#include <string>

#include "src/common/names.h"

namespace alidade::internal {
namespace {

// A parameter cannot be both held and free.
void CheckDisjoint(const IdentifiabilityOptions& options, const YamlMap& map) {
  for (const std::string& name : options.fix) {
    for (const auto* list : {&options.free, &options.prefer}) {
      if (std::find(list->begin(), list->end(), name) == list->end()) continue;
      map.Fail(Quote(name) + " stands in `fix` and in `" +
               (list == &options.free ? "free" : "prefer") +
               "`, expected in one of them");
    }
  }
}

// What the published rules do not know is not read over in silence.
void CheckMethod(const IdentifiabilityOptions& options, const YamlMap& map) {
  if (options.method == IdentifiabilityMethod::kRank) return;
  if (!options.prefer.empty() || !options.free.empty()) {
    map.Fail("`prefer` and `free` go with `method: rank`");
  }
  if (options.candidates.base || options.candidates.tool ||
      !options.candidates.joints) {
    map.Fail("`parameters` other than [joints] go with `method: rank`");
  }
  if (options.policy == WeakPolicy::kFreeze) {
    map.Fail("`policy: freeze` goes with `method: rank`");
  }
}

}  // namespace

CandidateGroups ReadCandidates(const YamlValue& value) {
  CandidateGroups groups{false, false, false};
  for (const std::string& name :
       ReadNames(value, "group of parameters", {"joints", "base", "tool"})) {
    if (name == "joints") groups.joints = true;
    if (name == "base") groups.base = true;
    if (name == "tool") groups.tool = true;
  }
  if (!groups.joints && !groups.base && !groups.tool) {
    value.Fail("the list is empty, expected some of joints, base and tool");
  }
  return groups;
}

void CheckIdentifiability(const YamlMap& map,
                          const IdentifiabilityOptions& options) {
  CheckDisjoint(options, map);
  CheckMethod(options, map);
}

// Deviations from nominal, as the file has them, to absolute values.
std::vector<ParameterBounds> ReadBounds(const YamlValue& value,
                                        const Units& units,
                                        const ParameterLayout& layout,
                                        const Eigen::VectorXd& nominal) {
  std::vector<ParameterBounds> bounds;
  const YamlMap map = value.Map(NamesOf(layout));
  for (const auto& [name, entry] : map.entries()) {
    const std::vector<YamlValue> ends = entry.List(2, "lower, upper");
    ParameterBounds bound;
    bound.parameter = name;
    const int column = layout.Find(name).value();
    // Base, targets and references have no nominal values that bounds could be
    // about: a job that identifies them finds where they are.
    if (!ParameterLayout::IsJointKind(layout.parameter(column).kind)) {
      entry.Fail(
          "bounds hold for joint parameters (beta1, alpha1, d1, theta1, "
          "r1 ...), found " +
          Quote(name));
    }
    const Dimension dimension = layout.parameter(column).dimension;
    bound.lower = ends[0].Limit(dimension, units);
    bound.upper = ends[1].Limit(dimension, units);
    if (!(bound.lower < bound.upper && bound.lower <= 0.0 &&
          bound.upper >= 0.0)) {
      entry.Fail(
          "expected deviations from nominal, [lower, upper] with lower < "
          "upper and the nominal value, 0, between them, found [" +
          ends[0].Text() + ", " + ends[1].Text() + "]");
    }
    bound.lower += nominal[column];
    bound.upper += nominal[column];
    bounds.push_back(bound);
  }
  return bounds;
}

}  // namespace alidade::internal
