#ifndef ALIDADE_SRC_SERIALIZATION_IDENTIFIABILITY_SECTION_H_
#define ALIDADE_SRC_SERIALIZATION_IDENTIFIABILITY_SECTION_H_

#include <Eigen/Core>
#include <vector>

#include "alidade/calibration_options.h"
#include "alidade/parameter_layout.h"
#include "src/identifiability/identifiability_fields.h"
#include "src/serialization/config_file.h"
#include "src/serialization/field_records.h"

namespace alidade::internal {

/// The groups that are named. @throws InputError.
CandidateGroups ReadCandidates(const YamlValue& value);

/// What the options' fields must agree in. @throws InputError at the map.
void CheckIdentifiability(const YamlMap& map,
                          const IdentifiabilityOptions& options);

/// The section `identifiability`; parameters are named as in the layout.
template <typename Visitor>
void VisitIdentifiability(Visitor& v, const ParameterLayout& layout,
                          IdentifiabilityOptions* options) {
  v.Custom(Key("parameters").Default("`[joints]`").Schema(kNamesSchema),
           "groups to identify: `joints`, `base`, `tool` (`rank` only)",
           [&](const YamlValue& value) {
             options->candidates = ReadCandidates(value);
           });
  const std::vector<std::string> names = NamesOf(layout);
  v.Field(Key("fix").Among(names, "parameter"), options->fix,
          "names of parameters to hold at their nominal values besides. Those "
          "of references are named as in \"References of a job\"");
  v.Field(Key("prefer").Among(names, "parameter"), options->prefer,
          "kept in preference to parameters they depend on, first to last "
          "(`rank` only)");
  v.Field(Key("free").Among(names, "parameter"), options->free,
          "must be free; refused with the reason where they cannot be (`rank` "
          "only)");
  VisitFields(v, *options);
  v.Check([&](const YamlMap& map) { CheckIdentifiability(map, *options); });
}

/// The job's `bounds`, absolute; `nominal` has one value per column of the
/// layout. @throws InputError.
std::vector<ParameterBounds> ReadBounds(const YamlValue& value,
                                        const Units& units,
                                        const ParameterLayout& layout,
                                        const Eigen::VectorXd& nominal);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_IDENTIFIABILITY_SECTION_H_
