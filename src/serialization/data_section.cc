#include "src/serialization/data_section.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "src/common/names.h"
#include "src/data/merge.h"
#include "src/dataio/read_options.h"
#include "src/serialization/covariate_columns.h"
#include "src/serialization/dialect_section.h"
#include "src/serialization/partitioned_data.h"
#include "src/serialization/simulation_file.h"
#include "src/simulation/simulation.h"

namespace alidade::internal {
namespace {

std::vector<std::string> TargetNames(const Arm& arm) {
  std::vector<std::string> names;
  for (const Target& target : arm.targets) {
    if (!target.name.empty()) names.push_back(target.name);
  }
  return names;
}

void CheckTargetName(const YamlValue& value, const std::string& name,
                     const Arm& arm) {
  const std::vector<std::string> names = TargetNames(arm);
  if (names.empty()) {
    value.Fail("arm " + Quote(arm.name) +
               " names no targets, expected `targets` in its file");
  }
  if (std::find(names.begin(), names.end(), name) == names.end()) {
    value.Fail(UnknownName("target", name, names));
  }
}

std::vector<std::string> ReadOrientation(const YamlValue& value) {
  const std::vector<YamlValue> items = value.List();
  if (items.size() != 3 && items.size() != 4 && items.size() != 9) {
    value.Fail(
        "expected the headers of rx, ry, rz, of a quaternion's w, x, y, z or "
        "of a rotation matrix, row by row, found " +
        std::to_string(items.size()));
  }
  return ReadHeaders(items);
}

std::vector<std::string> ReadPointHeaders(const YamlValue& value) {
  if (!value.IsList()) return {value.Text()};
  const std::vector<YamlValue> items = value.List();
  if (items.empty()) value.Fail("expected a header or a list of some");
  return ReadHeaders(items);
}

std::vector<std::pair<std::string, std::vector<std::string>>> ReadTargetHeaders(
    const YamlValue& value, const Arm& arm) {
  std::vector<std::pair<std::string, std::vector<std::string>>> all;
  const YamlMap targets = value.AnyMap("targets and their headers");
  for (const auto& [name, headers] : targets.entries()) {
    CheckTargetName(headers, name, arm);
    all.emplace_back(name,
                     ReadHeaders(headers.List(3, "the headers of x, y and z")));
  }
  if (all.empty()) {
    value.Fail("the map is empty, expected the headers of some target");
  }
  return all;
}

// Several targets in one row have positions of their own.
void CheckTargets(const YamlMap& map) {
  const std::optional<YamlValue> targets = map.Optional("targets");
  for (const char* other : {"position", "target"}) {
    if (!targets || !map.Optional(other)) continue;
    targets->Fail(std::string("found beside \"") + other +
                  "\", expected one of both");
  }
}

constexpr char kMapOfTextsSchema[] =
    R"({"type": "object", "additionalProperties": {"type": ["string", "number", "boolean"]}})";

template <typename Visitor>
void VisitColumns(Visitor& v, const Arm& arm, ColumnMapping* mapping) {
  const auto list = [&v](const char* key, const char* text, std::size_t size,
                         const char* what, std::vector<std::string>* headers) {
    v.Custom(Key(key).Schema(kNamesSchema), text, [=](const YamlValue& value) {
      *headers = ReadHeaders(value.List(size, what));
    });
  };
  const auto header = [&v](const char* key, const char* text,
                           std::string* member) {
    v.Field(Key(key).Default(""), *member, text);
  };
  list("joints", "list: the header of each joint's column, from the base",
       arm.joints.size(), "the header of each joint's column",
       &mapping->joints);
  list("position", "list: x, y, z", 3, "the headers of x, y and z",
       &mapping->position);
  v.Custom(Key("orientation").Schema(kNamesSchema),
           "list: rx, ry, rz, a quaternion's w, x, y, z, or the nine numbers "
           "of a rotation matrix, row by row",
           [&](const YamlValue& value) {
             mapping->orientation = ReadOrientation(value);
           });
  list("std_position", "list of three", 3,
       "the headers of the sigmas of x, y and z", &mapping->std_position);
  list("std_orientation",
       "list of three; beside a quaternion, they are about the instrument's "
       "axes",
       3, "the headers of the sigmas of the orientation",
       &mapping->std_orientation);
  header("distance", "a header", &mapping->distance);
  header("std_distance", "a header", &mapping->std_distance);
  v.Custom(Key("point").Schema(kTextsSchema),
           "a header, or a list of several whose texts are joined by `/` into "
           "the name",
           [&](const YamlValue& value) {
             mapping->point = ReadPointHeaders(value);
           });
  header("plane", "a header", &mapping->plane);
  header("target", "a header", &mapping->target);
  header("set", "a header", &mapping->set);
  VisitCovariates(v, arm, mapping);
  header("station",
         "a header: texts that say where, or on which day, the row was "
         "measured; each has a base of its own",
         &mapping->station);
  v.Custom(
      Key("targets").Schema(
          R"({"type": "object", "additionalProperties": {"type": "array", "items": {"type": "string"}}})"),
      "map from names of the arm's targets to lists x, y, z: several targets "
      "measured in one row; in place of `position` and `target`",
      [&](const YamlValue& value) {
        mapping->targets = ReadTargetHeaders(value, arm);
      });
  v.Custom(Key("unit").Default("those of the job").Schema(kUnitsSchema),
           "of headers that state none: `mm`, `deg`, or a list of both; a "
           "second unit of angles is that of orientations: `[mm, rad, deg]`",
           [=](const YamlValue& value) { ReadHeaderUnits(value, mapping); });
  v.Check(CheckTargets);
}

void ReadRotation(const YamlValue& value, DataFormat* format) {
  std::vector<std::string> names = RotationConventionNames();
  names.insert(names.begin(), "ignore");
  const std::string name = value.Choice("convention of rotations", names);
  format->ignore_rotation = name == "ignore";
  if (!format->ignore_rotation) format->rotation = FindRotationConvention(name);
}

void CheckTarget(const YamlMap& map, const Arm& arm, const DataFormat& format) {
  const std::optional<YamlValue> target = map.Optional("target");
  if (!target) return;
  CheckTargetName(*target, format.target, arm);
  const ColumnMapping& mapping = format.columns;
  if (!mapping.target.empty() || !mapping.targets.empty()) {
    target->Fail("found beside targets in \"columns\", expected one of both");
  }
}

void CheckPayload(const YamlMap& map, const DataFormat& format) {
  if (!format.payload) return;
  const std::vector<CovariateUse>& uses = format.columns.uses;
  const std::vector<std::string>& names = format.columns.covariates;
  if (std::any_of(uses.begin(), uses.end(),
                  [](const CovariateUse& use) { return use.is_payload; }) ||
      std::count(names.begin(), names.end(), kPayloadName) > 0) {
    map.Required("payload").Fail(
        "found beside such a column in \"columns\", expected one of both");
  }
}

void ReadWhere(const YamlValue& value, DataFormat* format) {
  const YamlMap filter = value.AnyMap("columns and the text to be in them");
  for (const auto& [column, text] : filter.entries()) {
    format->where.emplace_back(column, text.Text());
  }
}

// A map of `data`: a file, and what it does not say itself.
template <typename Visitor>
void VisitData(Visitor& v, const Arm& arm, DataFormat* format,
               std::optional<YamlValue>* file) {
  v.Field(Key("file").In("path").Required(), *file,
          "the CSV or NPY, or a pattern");
  v.Section(Key("columns"),
            "the headers, where another program wrote the file. Columns that "
            "are neither named here nor among the usual ones are passed over "
            "then; `{}` does just that",
            [&](auto& columns) {
              VisitColumns(columns, arm, &format->columns);
              columns.Check([&](const YamlMap& /*map*/) {
                format->ignore_others = true;
              });
            });
  v.Custom(Key("rotation").Schema(kTextSchema),
           "how `rx`, `ry`, `rz` state an orientation (\"Orientations\", "
           "below), or `ignore`: orientations are passed over",
           [format](const YamlValue& value) { ReadRotation(value, format); });
  v.Field(Key("point"), format->point,
          "name of the reference point that all rows are measured against");
  v.Field(Key("plane"), format->plane, "name of the plane that all rows touch");
  v.Field(Key("target"), format->target,
          "name of the arm's target that all rows measure");
  v.Field(LengthKey("sigma").Above(0).Default("`measurement.sigma`"),
          format->sigma, "of this file, where it states none");
  v.Field(AngleKey("rotation_sigma")
              .Above(0)
              .Default("`measurement.sigma_rotation`, else `sigma` / 0.2 m in "
                       "rad"),
          format->rotation_sigma, "likewise of orientations");
  v.Custom(Key("payload").In("kg").Schema(kNumberSchema),
           "the mass at the target in this file, where no column says it "
           "(`columns`)",
           [format](const YamlValue& value, const Units& units) {
             format->payload =
                 ReadNumber(value, Key("payload").AtLeast(0), units);
           });
  v.Custom(Key("where").Schema(kMapOfTextsSchema),
           "map from columns to texts: only rows with these cells are read. A "
           "column that serves nothing else may stand here",
           [format](const YamlValue& value) { ReadWhere(value, format); });
  VisitDialect(v, format);
  v.Check([&](const YamlMap& map) {
    CheckTarget(map, arm, *format);
    CheckPayload(map, *format);
    if (!format->stations.empty() && !format->columns.station.empty()) {
      map.Required("stations")
          .Fail("found beside a station in \"columns\", expected one of both");
    }
  });
}

// All parts as one. A pose of a part without sets is in the set "".
LoadedData Merge(std::vector<LoadedData> parts, const Arm& arm,
                 std::string* first_station) {
  LoadedData all;
  if (parts.empty()) {
    all.data.joint_values = Eigen::MatrixXd(arm.num_joints(), 0);
    return all;
  }
  RequireSameCovariates(parts);
  all.uses = parts.front().uses;
  std::vector<Dataset> data;
  const bool has_stations = std::any_of(
      parts.begin(), parts.end(),
      [](const LoadedData& part) { return !part.stations.empty(); });
  for (LoadedData& part : parts) {
    if (!has_stations) break;
    // A file without such a column is one station.
    if (part.stations.empty()) {
      part.stations.assign(static_cast<std::size_t>(part.data.num_poses()),
                           part.data.name);
    }
    std::move(part.stations.begin(), part.stations.end(),
              std::back_inserter(all.stations));
  }
  const bool has_sets =
      std::any_of(parts.begin(), parts.end(),
                  [](const LoadedData& part) { return !part.sets.empty(); });
  for (LoadedData& part : parts) {
    if (has_sets) {
      part.sets.resize(static_cast<std::size_t>(part.data.num_poses()));
      std::move(part.sets.begin(), part.sets.end(),
                std::back_inserter(all.sets));
    }
    all.rejected.insert(all.rejected.end(), part.rejected.begin(),
                        part.rejected.end());
    data.push_back(std::move(part.data));
  }
  std::int64_t num_poses = 0;
  for (const Dataset& part : data) num_poses += part.num_poses();
  RequireFewRows(data.back().name, num_poses);
  all.data = MergeDatasets(std::move(data));
  if (has_stations) AddStations(all.stations, arm, first_station, &all);
  return all;
}

// The files of all entries, each as often as it is named. What is wrong with an
// entry is reported where it is read.
std::vector<std::string> PathsOf(const std::vector<YamlValue>& entries,
                                 const NamedFiles& files) {
  std::vector<std::string> paths;
  for (const YamlValue& entry : entries) {
    std::optional<YamlValue> file = entry;
    if (entry.IsMap()) file = entry.Find("file");
    // Simulated data are made by one rank, as a file is read by one.
    if (entry.Find("simulate")) paths.emplace_back();
    if (!file) continue;
    for (std::string& path : files.PathsOf(*file)) {
      paths.push_back(std::move(path));
    }
  }
  return paths;
}

// Whether an entry says no more than which file: nothing then makes other data
// of it.
std::optional<YamlValue> PlainFileOf(const YamlValue& entry) {
  if (!entry.IsMap()) return entry;
  std::optional<YamlValue> file = entry.Find("file");
  for (const char* key :
       {"columns", "target", "where", "point", "plane", "exclude", "inverse"}) {
    if (entry.Find(key)) return std::nullopt;
  }
  return file;
}

void RefuseTwice(const std::vector<YamlValue>& entries,
                 const NamedFiles& files) {
  std::set<std::string> known;
  for (const YamlValue& entry : entries) {
    const std::optional<YamlValue> file = PlainFileOf(entry);
    if (!file) continue;
    for (const std::string& path : files.PathsOf(*file)) {
      if (known.insert(path).second) continue;
      file->Fail(path +
                 " is named twice, and its measurements would count twice: "
                 "expected each file once");
    }
  }
}

// Measurements that are made up as a simulation file makes them. As of a data
// set's file, sigmas are those of the noise, where there is some.
LoadedData SimulatedData(const SimulationConfig& config,
                         const DataFormat& defaults) {
  LoadedData loaded;
  loaded.data = Simulate(config);
  if (!(config.noise_sigma > 0.0)) {
    loaded.data.sigmas() = SharedMatrix::Repeated(
        Eigen::Vector3d::Constant(defaults.sigma), loaded.data.num_poses());
  }
  // Poses count as lines, so that these may stand in a list with files.
  loaded.data.files = {config.output};
  loaded.data.sources.Append({0, 1},
                             static_cast<std::size_t>(loaded.data.num_poses()));
  return loaded;
}

void SimulateEntry(const YamlValue& value, const DataFormat& defaults,
                   JobContext* context, const JobConfig& job,
                   FileAssignment* assignment, std::vector<LoadedData>* parts) {
  // Read by all, so that all know the same input files.
  const SimulationConfig config =
      ReadSimulatedData(value, job.arm, context->units, &context->files);
  if (assignment->NextReader() != assignment->rank()) return;
  parts->push_back(SimulatedData(config, defaults));
}

// A path, or a map where more is to be said of the file; or of the files, where
// the path is a pattern; or how to simulate.
void ReadEntry(const YamlValue& value, const DataFormat& defaults,
               JobContext* context, JobConfig* job, FileAssignment* assignment,
               std::vector<LoadedData>* parts) {
  DataFormat format = defaults;
  format.length_unit = &context->units.Of(Dimension::kLength);
  format.angle_unit = &context->units.Of(Dimension::kAngle);
  std::optional<YamlValue> file;
  if (value.Find("simulate")) {
    const YamlValue simulate = value.Map({"simulate"}).Required("simulate");
    SimulateEntry(simulate, defaults, context, *job, assignment, parts);
    return;
  }
  if (value.IsMap()) {
    ReadFields(value, context->units,
               [&](auto& v) { VisitData(v, job->arm, &format, &file); });
  }
  context->files.ReadEach(file.value_or(value), [&](const std::string& path) {
    const int reader = assignment->NextReader();
    context->readers.emplace(path, reader);
    if (reader != assignment->rank()) return;
    parts->push_back(LoadData(path, job->arm, format, &job->data.references,
                              context->num_threads));
    parts->back().uses = format.columns.uses;
    if (format.payload) AddPayload(*format.payload, &parts->back());
  });
}

}  // namespace

std::vector<FieldRecord> DataFields() {
  const Arm arm;
  DataFormat format;
  std::optional<YamlValue> file;
  return CollectFields([&](auto& v) { VisitData(v, arm, &format, &file); });
}

bool AreStated(const MeasurementSigmas& sigmas, const Dataset& data) {
  if (sigmas.instrument) return true;
  return std::any_of(data.blocks.begin(), data.blocks.end(),
                     [](const ObservationBlock& block) {
                       if (block.kind == MeasurementKind::kPointDistance) {
                         return false;
                       }
                       const auto sigma = block.sigmas.map().row(0).array();
                       return (sigma.isFinite() && sigma != kFirstSigma).any();
                     });
}

LoadedData ReadData(const YamlValue& value, const MeasurementSigmas& sigmas,
                    std::string* first_station, JobContext* context,
                    JobConfig* job) {
  DataFormat defaults;
  defaults.sigma = sigmas.length;
  defaults.rotation_sigma = sigmas.rotation;
  std::vector<YamlValue> entries = {value};
  if (value.IsList()) entries = value.List();
  if (entries.empty()) value.Fail("the list is empty, expected data sets");
  const bool is_partitioned = job->communicator->size() > 1;
  FileAssignment assignment;
  if (is_partitioned) {
    assignment = FileAssignment(job->communicator, value,
                                PathsOf(entries, context->files));
  }
  RefuseTwice(entries, context->files);
  const References known = job->data.references;
  std::vector<LoadedData> parts;
  for (const YamlValue& entry : entries) {
    ReadEntry(entry, defaults, context, job, &assignment, &parts);
  }
  LoadedData all = Merge(std::move(parts), job->arm, first_station);
  RequireKnownStations(value, job->data.training, all);
  if (job->communicator->Sum(all.data.covariate_names.empty() ? 0 : 1) > 0 &&
      is_partitioned) {
    value.Fail(
        "covariates and stations need all data in one process: run without "
        "mpirun");
  }
  if (is_partitioned) {
    PartitionLoaded(job->communicator, known, &all, &job->data.references);
  }
  job->rejected.insert(job->rejected.end(), all.rejected.begin(),
                       all.rejected.end());
  return all;
}

}  // namespace alidade::internal
