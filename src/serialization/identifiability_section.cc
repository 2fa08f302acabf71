#include "src/serialization/identifiability_section.h"

#include <algorithm>
#include <optional>
#include <string>
#include <tuple>
#include <utility>

#include "src/common/names.h"

namespace alidade::internal {
namespace {

std::vector<std::string> NamesOf(const ParameterLayout& layout) {
  std::vector<std::string> names;
  for (const Parameter& parameter : layout.parameters()) {
    names.push_back(parameter.name);
  }
  return names;
}

std::vector<std::string> ReadParameterNames(const YamlValue& value,
                                            const ParameterLayout& layout) {
  const std::vector<std::string> names = NamesOf(layout);
  std::vector<std::string> chosen;
  for (const YamlValue& item : value.List()) {
    const std::string name = item.Choice("parameter", names);
    if (std::find(chosen.begin(), chosen.end(), name) != chosen.end()) {
      item.Fail(Quote(name) + " is repeated, expected each name once");
    }
    chosen.push_back(name);
  }
  return chosen;
}

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

WeakPolicy ReadPolicy(const YamlValue& value) {
  const std::string name = value.Choice("policy", {"freeze", "prior", "keep"});
  if (name == "freeze") return WeakPolicy::kFreeze;
  return name == "prior" ? WeakPolicy::kPrior : WeakPolicy::kKeep;
}

CandidateGroups ReadCandidates(const YamlValue& value) {
  CandidateGroups groups{false, false, false};
  for (const YamlValue& item : value.List()) {
    const std::string name =
        item.Choice("group of parameters", {"joints", "base", "tool"});
    bool& group = name == "joints" ? groups.joints
                  : name == "base" ? groups.base
                                   : groups.tool;
    if (group) item.Fail(Quote(name) + " is repeated, expected once");
    group = true;
  }
  if (!groups.joints && !groups.base && !groups.tool) {
    value.Fail("the list is empty, expected some of joints, base and tool");
  }
  return groups;
}

void ReadPriors(const JobContext& context, const YamlMap& identifiability,
                PriorTolerances* priors) {
  const std::optional<YamlValue> value = identifiability.Optional("priors");
  if (!value) return;
  const std::vector<std::tuple<const char*, Dimension, double*>> fields = {
      {"beta", Dimension::kAngle, &priors->beta},
      {"alpha", Dimension::kAngle, &priors->alpha},
      {"d", Dimension::kLength, &priors->d},
      {"theta", Dimension::kAngle, &priors->theta},
      {"r", Dimension::kLength, &priors->r},
      {"frame_length", Dimension::kLength, &priors->frame_length},
      {"frame_angle", Dimension::kAngle, &priors->frame_angle}};
  std::vector<std::string> keys;
  for (const auto& field : fields) keys.emplace_back(std::get<0>(field));
  const YamlMap map = value->Map(keys);
  for (const auto& [key, dimension, target] : fields) {
    if (const auto entry = map.Optional(key)) {
      *target = dimension == Dimension::kLength
                    ? PositiveLength(*entry, context.units)
                    : PositiveAngle(*entry, context.units);
    }
  }
  CheckOptions(*priors, map);
}

}  // namespace

void ReadIdentifiability(const JobContext& context,
                         const ParameterLayout& layout,
                         IdentifiabilityOptions* options) {
  const std::optional<YamlValue> value =
      context.file.Optional("identifiability");
  if (!value) return;
  const YamlMap map =
      value->Map({"method", "policy", "parameters", "fix", "prefer", "free",
                  "priors", "proceed_beyond_rank", "angle_tolerance",
                  "relative_tolerance", "perturbation", "seed"});
  if (const auto method = map.Optional("method")) {
    options->method = method->Choice("method", {"rules", "rank"}) == "rules"
                          ? IdentifiabilityMethod::kRules
                          : IdentifiabilityMethod::kRank;
  }
  if (const auto policy = map.Optional("policy")) {
    options->policy = ReadPolicy(*policy);
  }
  if (const auto groups = map.Optional("parameters")) {
    options->candidates = ReadCandidates(*groups);
  }
  for (const auto& [key, names] :
       {std::pair("fix", &options->fix), std::pair("prefer", &options->prefer),
        std::pair("free", &options->free)}) {
    if (const auto list = map.Optional(key)) {
      *names = ReadParameterNames(*list, layout);
    }
  }
  CheckDisjoint(*options, map);
  CheckMethod(*options, map);
  ReadPriors(context, map, &options->priors);
  map.ReadBoolean("proceed_beyond_rank", &options->proceed_beyond_rank);
  if (const auto tolerance = map.Optional("angle_tolerance")) {
    options->angle_tolerance =
        tolerance->Quantity(Dimension::kAngle, context.units);
  }
  map.ReadNumber("relative_tolerance", &options->relative_tolerance);
  map.ReadNumber("perturbation", &options->perturbation);
  map.ReadSeed("seed", &options->seed);
  CheckOptions(*options, map);
}

// Deviations from nominal, as the file has them, to absolute values.
std::vector<ParameterBounds> ReadBounds(const JobContext& context,
                                        const ParameterLayout& layout,
                                        const Eigen::VectorXd& nominal) {
  std::vector<ParameterBounds> bounds;
  const std::optional<YamlValue> value = context.file.Optional("bounds");
  if (!value) return bounds;
  const YamlMap map = value->Map(NamesOf(layout));
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
    bound.lower = ends[0].Limit(dimension, context.units);
    bound.upper = ends[1].Limit(dimension, context.units);
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
