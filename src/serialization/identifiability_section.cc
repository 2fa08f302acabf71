#include "src/serialization/identifiability_section.h"

#include <algorithm>
#include <string>
#include <string_view>

#include "src/common/names.h"

namespace alidade::internal {
namespace {

// Whether `text` is `pattern`, in which '*' stands for any characters.
bool Matches(std::string_view pattern, std::string_view text) {
  const std::size_t star = pattern.find('*');
  if (star == std::string_view::npos) return pattern == text;
  const std::string_view before = pattern.substr(0, star);
  if (text.substr(0, before.size()) != before) return false;
  for (std::size_t at = before.size(); at <= text.size(); ++at) {
    if (Matches(pattern.substr(star + 1), text.substr(at))) return true;
  }
  return false;
}

// Joint values are counted from them.
bool IsOffset(const Parameter& parameter, const Arm& arm) {
  return ParameterLayout::IsJointKind(parameter.kind) &&
         parameter.kind ==
             (arm.joints[parameter.index].type == JointType::kRevolute
                  ? ParameterKind::kTheta
                  : ParameterKind::kR);
}

bool IsFrame(ParameterKind kind) {
  return !ParameterLayout::IsJointKind(kind) &&
         !ParameterLayout::IsReferenceKind(kind);
}

// "tool2" of "tool2_rx", "alpha" of "alpha3".
std::string GroupOf(const Parameter& parameter) {
  const std::string& name = parameter.name;
  return ParameterLayout::IsJointKind(parameter.kind)
             ? name.substr(0, name.find_last_not_of("0123456789") + 1)
             : name.substr(0, name.find('_'));
}

bool IsMeant(const std::string& entry, const Parameter& parameter,
             const Arm& arm) {
  const bool is_joint = ParameterLayout::IsJointKind(parameter.kind);
  if (entry == "geometry" || entry == "joints") return is_joint;
  if (entry == "offsets") return IsOffset(parameter, arm);
  if (entry == "frames") return IsFrame(parameter.kind);
  if (entry == "joint " + std::to_string(parameter.index + 1) ||
      entry == "joint" + std::to_string(parameter.index + 1)) {
    return is_joint;
  }
  return entry == GroupOf(parameter) || Matches(entry, parameter.name);
}

std::vector<std::string> KnownNames(const ParameterLayout& layout,
                                    const Arm& arm) {
  std::vector<std::string> names = {"offsets", "geometry", "frames"};
  for (const Parameter& parameter : layout.parameters()) {
    const std::string group = GroupOf(parameter);
    if (std::find(names.begin(), names.end(), group) == names.end()) {
      names.push_back(group);
    }
  }
  for (int j = 1; j <= arm.num_joints(); ++j) {
    names.push_back("joint " + std::to_string(j));
  }
  for (const Parameter& parameter : layout.parameters()) {
    names.push_back(parameter.name);
  }
  return names;
}

void Remove(const std::string& name, std::vector<std::string>* names) {
  names->erase(std::remove(names->begin(), names->end(), name), names->end());
}

// A parameter cannot be both held and free: what names it more narrowly counts.
void SeparateLists(const YamlMap& map, const ParameterLists& lists,
                   IdentifiabilityOptions* options) {
  for (const auto& [name, fixed] : lists.fixed) {
    const auto freed = lists.freed.find(name);
    if (freed == lists.freed.end()) continue;
    if (freed->second == fixed) {
      map.Fail(Quote(name) +
               " stands in `fix` and in `free`, expected in one of them");
    }
    Remove(name, freed->second < fixed ? &options->fix : &options->free);
  }
  for (const std::string& name : options->fix) {
    const auto preferred = lists.preferred.find(name);
    if (preferred == lists.preferred.end()) continue;
    if (preferred->second == 1 && lists.fixed.at(name) == 1) {
      map.Fail(Quote(name) +
               " stands in `fix` and in `prefer`, expected in one of them");
    }
    Remove(name, &options->prefer);
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

CandidateGroups ReadCandidates(const YamlValue& value, bool* are_offsets) {
  CandidateGroups groups{false, false, false};
  for (const std::string& name :
       ReadNames(value, "group of parameters",
                 {"joints", "base", "tool", "offsets", "geometry", "frames"})) {
    if (name == "joints" || name == "geometry") groups.joints = true;
    if (name == "base" || name == "frames") groups.base = true;
    if (name == "tool" || name == "frames") groups.tool = true;
    if (name == "offsets") *are_offsets = true;
  }
  *are_offsets = *are_offsets && !groups.joints;
  groups.joints = groups.joints || *are_offsets;
  if (!groups.joints && !groups.base && !groups.tool) {
    value.Fail("the list is empty, expected some of joints, base and tool");
  }
  return groups;
}

std::vector<std::string> ParameterLists::Read(
    const YamlValue& value, std::map<std::string, std::size_t>* sizes) {
  std::vector<std::string> names;
  for (const YamlValue& item : value.List()) {
    const std::string entry = item.Text();
    std::vector<std::string> meant;
    for (const Parameter& parameter : layout.parameters()) {
      if (IsMeant(entry, parameter, arm)) meant.push_back(parameter.name);
    }
    if (meant.empty()) {
      item.Fail(UnknownName("parameter", entry, KnownNames(layout, arm)));
    }
    const bool is_repeated = meant.size() == 1 && sizes->count(meant[0]) > 0 &&
                             sizes->at(meant[0]) == 1;
    if (is_repeated) {
      item.Fail(Quote(entry) + " is repeated, expected each parameter once");
    }
    for (const std::string& name : meant) {
      const auto [at, is_new] = sizes->emplace(name, meant.size());
      if (is_new) names.push_back(name);
      at->second = std::min(at->second, meant.size());
    }
  }
  return names;
}

void CheckIdentifiability(const YamlMap& map, const ParameterLists& lists,
                          IdentifiabilityOptions* options) {
  SeparateLists(map, lists, options);
  for (const Parameter& parameter : lists.layout.parameters()) {
    if (!lists.are_offsets || lists.freed.count(parameter.name) > 0 ||
        lists.fixed.count(parameter.name) > 0 ||
        !ParameterLayout::IsJointKind(parameter.kind) ||
        IsOffset(parameter, lists.arm)) {
      continue;
    }
    options->fix.push_back(parameter.name);
  }
  CheckMethod(*options, map);
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
