#ifndef ALIDADE_SRC_SERIALIZATION_IDENTIFIABILITY_SECTION_H_
#define ALIDADE_SRC_SERIALIZATION_IDENTIFIABILITY_SECTION_H_

#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

#include "alidade/calibration_options.h"
#include "alidade/parameter_layout.h"
#include "src/identifiability/identifiability_fields.h"
#include "src/serialization/config_file.h"
#include "src/serialization/field_records.h"

namespace alidade::internal {

/// The groups that are named. `offsets` are joints of which all else is fixed:
/// `are_offsets` says so. @throws InputError.
CandidateGroups ReadCandidates(const YamlValue& value, bool* are_offsets);

/// The names that a section's fields may have for parameters: their own, those
/// of kinds and frames ("alpha", "tool2"), "joint 3", patterns ("d*") and
/// "offsets", "geometry", "frames".
struct ParameterLists {
  const ParameterLayout& layout;
  const Arm& arm;
  /// By name, how many parameters its entry stands for: the entry that says
  /// the most of a parameter decides.
  std::map<std::string, std::size_t> fixed = {};
  std::map<std::string, std::size_t> freed = {};
  std::map<std::string, std::size_t> preferred = {};
  bool are_offsets = false;

  /// @throws InputError where a name stands for no parameter.
  std::vector<std::string> Read(const YamlValue& value,
                                std::map<std::string, std::size_t>* sizes);
};

/// What the options' fields must agree in. @throws InputError at the map.
void CheckIdentifiability(const YamlMap& map, const ParameterLists& lists,
                          IdentifiabilityOptions* options);

/// The section `identifiability`; parameters are named as in the layout.
template <typename Visitor>
void VisitIdentifiability(Visitor& v, const ParameterLayout& layout,
                          const Arm& arm, IdentifiabilityOptions* options) {
  ParameterLists lists{layout, arm};
  v.Custom(Key("parameters").Default("`[joints]`").Schema(kNamesSchema),
           "groups to identify: `joints` (or `geometry`), `base`, `tool` "
           "(`frames` are both; `rank` only), or `offsets`: of the joints "
           "theta of those that turn and r of those that slide",
           [&](const YamlValue& value) {
             options->candidates = ReadCandidates(value, &lists.are_offsets);
           });
  const auto names = [&v](const char* key, const char* text, const auto& read) {
    v.Custom(Key(key).Default("`[]`").Schema(kNamesSchema), text, read);
  };
  names("fix",
        "names of parameters to hold at their nominal values besides, also by "
        "kind: `alpha`, `d*`, `joint 3`, `base`, `offsets`, `geometry` (all of "
        "the joints), `frames`. Those of references are named as in "
        "\"References of a job\". What `free` names more narrowly stays free",
        [&](const YamlValue& value) {
          options->fix = lists.Read(value, &lists.fixed);
        });
  names("prefer",
        "likewise: kept in preference to parameters they depend on, first to "
        "last (`rank` only)",
        [&](const YamlValue& value) {
          options->prefer = lists.Read(value, &lists.preferred);
        });
  names("free",
        "likewise: must be free; refused with the reason where they cannot be "
        "(`rank` only)",
        [&](const YamlValue& value) {
          options->free = lists.Read(value, &lists.freed);
        });
  VisitFields(v, *options);
  v.Check(
      [&](const YamlMap& map) { CheckIdentifiability(map, lists, options); });
}

/// The job's `bounds`, absolute; `nominal` has one value per column of the
/// layout. @throws InputError.
std::vector<ParameterBounds> ReadBounds(const YamlValue& value,
                                        const Units& units,
                                        const ParameterLayout& layout,
                                        const Eigen::VectorXd& nominal);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_IDENTIFIABILITY_SECTION_H_
