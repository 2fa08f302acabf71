#include "src/serialization/references_section.h"

#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "src/common/names.h"
#include "src/dataio/dataset_builder.h"
#include "src/kernel/partition.h"

namespace alidade::internal {
namespace {

Eigen::Vector3d ReadPosition(const YamlValue& value, const Units& units) {
  const std::vector<YamlValue> items = value.List(3, "x, y, z");
  Eigen::Vector3d position;
  for (int axis = 0; axis < 3; ++axis) {
    position[axis] = items[axis].Quantity(Dimension::kLength, units);
  }
  return position;
}

// `known: true` needs what is known.
bool ReadKnown(const YamlMap& map, const std::vector<std::string>& needed) {
  bool is_known = false;
  map.ReadBoolean("known", &is_known);
  for (const std::string& key : needed) {
    if (is_known) map.Required(key);
  }
  return is_known;
}

ReferencePoint ReadPoint(const YamlValue& value, const Units& units) {
  const YamlMap map = value.Map({"name", "position", "known"});
  ReferencePoint point;
  point.name = map.Required("name").Text();
  if (const auto position = map.Optional("position")) {
    point.position = ReadPosition(*position, units);
  }
  point.is_known = ReadKnown(map, {"position"});
  return point;
}

ReferencePlane ReadPlane(const YamlValue& value, const Units& units) {
  const YamlMap map = value.Map({"name", "normal", "offset", "known"});
  ReferencePlane plane;
  plane.name = map.Required("name").Text();
  if (const auto normal = map.Optional("normal")) {
    const std::vector<YamlValue> items = normal->List(3, "x, y, z");
    for (int i = 0; i < 3; ++i) plane.normal[i] = items[i].Number();
    plane.normal.stableNormalize();
    if (!(std::abs(plane.normal.norm() - 1.0) < 1e-12)) {
      normal->Fail("the normal is zero or out of range, expected a direction");
    }
  }
  if (const auto offset = map.Optional("offset")) {
    plane.offset = offset->Quantity(Dimension::kLength, units);
  }
  plane.is_known = ReadKnown(map, {"normal", "offset"});
  return plane;
}

template <typename Reference, typename Read>
std::vector<Reference> ReadNamed(const YamlMap& map, const std::string& key,
                                 const Units& units, const Read& read) {
  std::vector<Reference> all;
  const std::optional<YamlValue> list = map.Optional(key);
  if (!list) return all;
  for (const YamlValue& item : list->List()) {
    Reference reference = read(item, units);
    for (const Reference& other : all) {
      if (other.name != reference.name) continue;
      item.Find("name")->Fail(Quote(reference.name) +
                              " is repeated, expected each name once");
    }
    all.push_back(std::move(reference));
  }
  return all;
}

std::optional<YamlMap> ReferencesMap(const JobContext& context) {
  const std::optional<YamlValue> value = context.file.Optional("references");
  if (!value) return std::nullopt;
  return value->Map({"points", "planes", "distances"});
}

Observation ReadPointDistance(const YamlValue& value, const Units& units,
                              double default_sigma,
                              const References& references) {
  const YamlMap map = value.Map({"between", "distance", "sigma"});
  std::vector<std::string> names;
  for (const ReferencePoint& point : references.points) {
    names.push_back(point.name);
  }
  const YamlValue between = map.Required("between");
  const std::vector<YamlValue> ends = between.List(2, "names of points");
  Observation observation;
  observation.kind = MeasurementKind::kPointDistance;
  observation.reference =
      references.FindPoint(ends[0].Choice("reference point", names));
  observation.second =
      references.FindPoint(ends[1].Choice("reference point", names));
  if (observation.reference == observation.second) {
    between.Fail("found " + Quote(ends[0].Text()) +
                 " twice, expected two different points");
  }
  double sigma = default_sigma;
  if (const auto own = map.Optional("sigma")) {
    sigma = PositiveLength(*own, units);
  } else if (!(default_sigma > 0.0)) {
    map.Fail(
        "the sigma of measurements is estimated, that of a known distance "
        "cannot be: expected `sigma`");
  }
  const double distance = PositiveLength(map.Required("distance"), units);
  observation.measured = Observation::Rows::Constant(1, distance);
  observation.sigmas = Observation::Rows::Constant(1, sigma);
  return observation;
}

}  // namespace

References ReadReferences(const JobContext& context) {
  References references;
  const std::optional<YamlMap> map = ReferencesMap(context);
  if (!map) return references;
  references.points =
      ReadNamed<ReferencePoint>(*map, "points", context.units, ReadPoint);
  references.planes =
      ReadNamed<ReferencePlane>(*map, "planes", context.units, ReadPlane);
  return references;
}

void ReadPointDistances(const JobContext& context, double default_sigma,
                        JobConfig* job) {
  const std::optional<YamlMap> map = ReferencesMap(context);
  if (!map) return;
  const std::optional<YamlValue> list = map->Optional("distances");
  if (!list) return;
  std::vector<Observation> observations;
  for (const YamlValue& item : list->List()) {
    observations.push_back(ReadPointDistance(item, context.units, default_sigma,
                                             job->data.references));
  }
  for (const ObservationBlock& block :
       MakeBlocks(observations, job->data.training.num_poses())) {
    AppendGlobal(job->communicator, block, &job->data.training);
  }
}

ParameterLayout LayoutOf(const Arm& arm, const References& references) {
  return ParameterLayout(LayoutShape{arm.num_joints(), arm.num_targets(),
                                     references.num_points(),
                                     references.num_planes()});
}

Eigen::VectorXd NominalValues(const Arm& arm, const References& references) {
  const ParameterLayout layout = LayoutOf(arm, references);
  Eigen::VectorXd values = layout.Values(arm);
  for (int i = 0; i < references.num_points(); ++i) {
    values.segment<3>(layout.Column(ParameterKind::kPoint, 0, i)) =
        references.points[i].position;
  }
  for (int i = 0; i < references.num_planes(); ++i) {
    values[layout.Column(ParameterKind::kPlaneOffset, 0, i)] =
        references.planes[i].offset;
  }
  return values;
}

}  // namespace alidade::internal
