#ifndef ALIDADE_SRC_SERIALIZATION_COVARIATE_COLUMNS_H_
#define ALIDADE_SRC_SERIALIZATION_COVARIATE_COLUMNS_H_

#include <string>
#include <vector>

#include "src/dataio/data_format.h"
#include "src/serialization/config_file.h"
#include "src/serialization/field_records.h"

namespace alidade::internal {

/// A list of headers, each of them once.
std::vector<std::string> ReadHeaders(const std::vector<YamlValue>& items);

/// What each covariate moves: texts or lists of "base", "target", "joint 2",
/// "joints".
std::vector<CovariateUse> ReadEffects(
    const YamlValue& value, int num_joints,
    const std::vector<std::string>& covariates);
/// Another column whose numbers are kept.
void AddCovariate(const YamlValue& value, CovariateUse use,
                  ColumnMapping* mapping);
/// One column for all joints, or one each.
void ReadApproach(const YamlValue& value, int num_joints,
                  ColumnMapping* mapping);

inline constexpr char kEffectsSchema[] =
    R"({"type": "object", "additionalProperties": {"type": ["string", "array"]}})";

/// The keys of `columns` that are of covariates.
template <typename Visitor>
void VisitCovariates(Visitor& v, const Arm& arm, ColumnMapping* mapping) {
  v.Custom(Key("covariates").Schema(kNamesSchema),
           "list of headers: numbers whose effect on the base, or on what "
           "`effects` says, error terms may have (temperature, time, tilt), in "
           "every row",
           [=](const YamlValue& value) {
             mapping->covariates = ReadHeaders(value.List());
           });
  v.Custom(Key("effects").Default("`base` for each").Schema(kEffectsSchema),
           "map from covariates to what they move: `base`, `target`, `joint "
           "2`, `joints` (all of them), or a list of some",
           [=](const YamlValue& value) {
             mapping->uses =
                 ReadEffects(value, arm.num_joints(), mapping->covariates);
           });
  v.Custom(Key("payload").Schema(kTextSchema),
           "a header: the mass at the target (kg), which error terms take the "
           "moments of. State the masses of the arm's `links` beside it: "
           "compliances then are of true moments",
           [=](const YamlValue& value) {
             CovariateUse use{value.Text(), false};
             use.is_payload = true;
             AddCovariate(value, std::move(use), mapping);
           });
  v.Custom(Key("approach").Schema(kTextsSchema),
           "a header, or a list of one for each joint: the directions, -1 or "
           "1, from which the joints came to the pose (0: unknown); error "
           "terms may have half a step of backlash by them",
           [=](const YamlValue& value) {
             ReadApproach(value, arm.num_joints(), mapping);
           });
}

/// The covariate of AddPayload.
inline constexpr char kPayloadName[] = "payload";
/// A mass at the target that is the same at all poses.
void AddPayload(double mass, LoadedData* loaded);
/// A covariate of each station but the first, whose base is the arm's, 1 there
/// and 0 elsewhere. `first`: its name, which is found where it is empty.
void AddStations(const std::vector<std::string>& stations, const Arm& arm,
                 std::string* first, LoadedData* loaded);
/// Validation data are of stations that the data to fit have too. @throws
/// InputError.
void RequireKnownStations(const YamlValue& value, const Dataset& training,
                          const LoadedData& loaded);
/// Data that are joined have the same covariates. @throws InputError.
void RequireSameCovariates(const std::vector<LoadedData>& parts);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_COVARIATE_COLUMNS_H_
