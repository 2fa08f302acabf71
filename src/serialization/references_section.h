#ifndef ALIDADE_SRC_SERIALIZATION_REFERENCES_SECTION_H_
#define ALIDADE_SRC_SERIALIZATION_REFERENCES_SECTION_H_

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "alidade/arm.h"
#include "alidade/parameter_layout.h"
#include "alidade/references.h"
#include "src/serialization/field_records.h"
#include "src/serialization/job_config.h"

namespace alidade::internal {

/// A distance between points as a file states it. Its points may be named in
/// data sets alone, which are read later.
struct StatedDistance {
  std::optional<YamlValue> map;
  std::optional<YamlValue> between;
  double distance = 0.0;
  std::optional<double> sigma;
};

/// The section `references`.
struct StatedReferences {
  References references;
  std::vector<StatedDistance> distances;
};

inline constexpr char kPairSchema[] =
    R"({"type": "array", "items": {"type": "string"}, "minItems": 2, "maxItems": 2})";

/// @throws InputError where the reference has the name of another, or is known
/// but not stated in full.
template <typename Reference>
void CheckReference(const YamlMap& map, const Reference& reference,
                    const std::vector<std::string>& needed,
                    const std::vector<Reference>& others) {
  RefuseRepeatedName(map, reference, others);
  for (const std::string& key : needed) {
    if (reference.is_known) map.Required(key);
  }
}

template <typename Visitor>
void VisitReferences(Visitor& v, StatedReferences* stated) {
  References& references = stated->references;
  const char* is_known = "`true`: it is not identified, and stated in full";
  v.Items(
      Key("points"), "reference points", references.points,
      [&](auto& item, ReferencePoint& point) {
        item.Field(Key("name").Required(), point.name, "as data sets call it");
        item.Field(LengthKey("position"), point.position,
                   "`[x, y, z]`; without it the point is found from the data");
        item.Field(Key("known"), point.is_known, is_known);
        item.Check([&](const YamlMap& map) {
          CheckReference(map, point, {"position"}, references.points);
        });
      });
  v.Items(
      Key("planes"), "reference planes", references.planes,
      [&](auto& item, ReferencePlane& plane) {
        item.Field(Key("name").Required(), plane.name, "as data sets call it");
        item.Field(Key("normal"), plane.normal,
                   "`[x, y, z]` of any length but zero");
        item.Field(LengthKey("offset").Default("none"), plane.offset,
                   "of the plane from the origin along the normal");
        item.Field(Key("known"), plane.is_known, is_known);
        item.Check([&](const YamlMap& map) {
          CheckReference(map, plane, {"normal", "offset"}, references.planes);
        });
      });
  v.Items(Key("distances"), "known distances between points", stated->distances,
          [&](auto& item, StatedDistance& distance) {
            item.Field(
                Key("between").Required().Schema(kPairSchema), distance.between,
                "two names of points, also of those that only data sets name");
            item.Field(LengthKey("distance").Above(0).Required(),
                       distance.distance, "measured between them");
            item.Field(
                LengthKey("sigma").Above(0).Default("`measurement.sigma`"),
                distance.sigma,
                "required with `measurement: {sigma: estimate}`");
            item.Check([&](const YamlMap& map) {
              distance.map = map.value();
              distance.between->List(2, "names of points");
            });
          });
}

/// Appends the distances to the job's data. @pre the job's references are
/// those of all its data; default_sigma is 0 where none can be assumed.
/// @throws InputError.
void AppendDistances(const std::vector<StatedDistance>& distances,
                     double default_sigma, JobConfig* job);

/// The layout of an arm measured against references.
ParameterLayout LayoutOf(const Arm& arm, const References& references);

/// Values of the nominal arm and of the references, one per column of their
/// layout.
Eigen::VectorXd NominalValues(const Arm& arm, const References& references);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_REFERENCES_SECTION_H_
