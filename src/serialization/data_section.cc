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
#include "src/serialization/partitioned_data.h"
#include "src/serialization/simulation_file.h"
#include "src/simulation/simulation.h"

namespace alidade::internal {
namespace {

// A first guess of a sigma that is to be estimated: what an arm's calibration
// commonly leaves. Only the ratio to the priors hangs on it, until the
// estimate replaces it.
constexpr double kFirstSigma = 1e-4;

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

std::vector<std::string> ReadHeaders(const std::vector<YamlValue>& items) {
  std::vector<std::string> headers;
  for (const YamlValue& item : items) {
    headers.push_back(item.Text());
    if (std::count(headers.begin(), headers.end(), headers.back()) > 1) {
      item.Fail("column " + Quote(headers.back()) +
                " is repeated, expected each once");
    }
  }
  return headers;
}

void ReadList(const YamlMap& map, const std::string& key, std::size_t size,
              const std::string& what, std::vector<std::string>* headers) {
  const std::optional<YamlValue> value = map.Optional(key);
  if (value) *headers = ReadHeaders(value->List(size, what));
}

std::vector<std::string> ReadOrientation(const YamlValue& value) {
  const std::vector<YamlValue> items = value.List();
  if (items.size() != 3 && items.size() != 4) {
    value.Fail(
        "expected the headers of rx, ry, rz or of a quaternion's w, x, y, z, "
        "found " +
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

void ReadTargetHeaders(const YamlMap& map, const Arm& arm,
                       ColumnMapping* mapping) {
  const std::optional<YamlValue> value = map.Optional("targets");
  if (!value) return;
  for (const char* other : {"position", "target"}) {
    if (!map.Optional(other)) continue;
    value->Fail(std::string("found beside \"") + other +
                "\", expected one of both");
  }
  const YamlMap targets = value->AnyMap("targets and their headers");
  for (const auto& [name, headers] : targets.entries()) {
    CheckTargetName(headers, name, arm);
    mapping->targets.emplace_back(
        name, ReadHeaders(headers.List(3, "the headers of x, y and z")));
  }
  if (mapping->targets.empty()) {
    value->Fail("the map is empty, expected the headers of some target");
  }
}

ColumnMapping ReadMapping(const YamlValue& value, const Arm& arm) {
  const YamlMap map =
      value.Map({"joints", "position", "orientation", "std_position",
                 "std_orientation", "distance", "std_distance", "point",
                 "plane", "target", "set", "targets"});
  ColumnMapping mapping;
  ReadList(map, "joints", arm.joints.size(),
           "the header of each joint's column", &mapping.joints);
  ReadList(map, "position", 3, "the headers of x, y and z", &mapping.position);
  ReadList(map, "std_position", 3, "the headers of the sigmas of x, y and z",
           &mapping.std_position);
  ReadList(map, "std_orientation", 3,
           "the headers of the sigmas of the orientation",
           &mapping.std_orientation);
  if (const auto orientation = map.Optional("orientation")) {
    mapping.orientation = ReadOrientation(*orientation);
  }
  map.ReadText("distance", &mapping.distance);
  map.ReadText("std_distance", &mapping.std_distance);
  if (const auto point = map.Optional("point")) {
    mapping.point = ReadPointHeaders(*point);
  }
  map.ReadText("plane", &mapping.plane);
  map.ReadText("target", &mapping.target);
  map.ReadText("set", &mapping.set);
  ReadTargetHeaders(map, arm, &mapping);
  return mapping;
}

void ReadRotation(const YamlMap& map, DataFormat* format) {
  const std::optional<YamlValue> value = map.Optional("rotation");
  if (!value) return;
  std::vector<std::string> names = RotationConventionNames();
  names.insert(names.begin(), "ignore");
  const std::string name = value->Choice("convention of rotations", names);
  format->ignore_rotation = name == "ignore";
  if (!format->ignore_rotation) format->rotation = FindRotationConvention(name);
}

void ReadSigmasOfEntry(const YamlMap& map, const Units& units,
                       DataFormat* format) {
  if (const auto sigma = map.Optional("sigma")) {
    format->sigma = PositiveLength(*sigma, units);
  }
  if (const auto sigma = map.Optional("rotation_sigma")) {
    format->rotation_sigma = PositiveAngle(*sigma, units);
  }
}

void ReadTargetOfEntry(const YamlMap& map, const Arm& arm, DataFormat* format) {
  const std::optional<YamlValue> target = map.Optional("target");
  if (!target) return;
  format->target = target->Text();
  CheckTargetName(*target, format->target, arm);
  const ColumnMapping& mapping = format->columns;
  if (!mapping.target.empty() || !mapping.targets.empty()) {
    target->Fail("found beside targets in \"columns\", expected one of both");
  }
}

DataFormat ReadFormat(const YamlMap& map, const Units& units, const Arm& arm,
                      DataFormat format) {
  if (const auto columns = map.Optional("columns")) {
    format.columns = ReadMapping(*columns, arm);
    format.ignore_others = true;
  }
  ReadRotation(map, &format);
  map.ReadText("point", &format.point);
  map.ReadText("plane", &format.plane);
  ReadTargetOfEntry(map, arm, &format);
  ReadSigmasOfEntry(map, units, &format);
  if (const auto where = map.Optional("where")) {
    const YamlMap filter = where->AnyMap("columns and the text to be in them");
    for (const auto& [column, text] : filter.entries()) {
      format.where.emplace_back(column, text.Text());
    }
  }
  return format;
}

// All parts as one. A pose of a part without sets is in the set "".
LoadedData Merge(std::vector<LoadedData> parts, int num_joints) {
  LoadedData all;
  if (parts.empty()) {
    all.data.joint_values = Eigen::MatrixXd(num_joints, 0);
    return all;
  }
  std::vector<Dataset> data;
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
  return all;
}

// The files of all entries, each as often as it is named. What is wrong with an
// entry is told where it is read.
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
  for (const char* key : {"columns", "target", "where", "point", "plane"}) {
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
  std::optional<YamlValue> file;
  if (value.Find("simulate")) {
    const YamlValue simulate = value.Map({"simulate"}).Required("simulate");
    SimulateEntry(simulate, defaults, context, *job, assignment, parts);
    return;
  }
  if (value.IsMap()) {
    const YamlMap map =
        value.Map({"file", "columns", "rotation", "point", "plane", "target",
                   "sigma", "rotation_sigma", "where"});
    format = ReadFormat(map, context->units, job->arm, defaults);
    file = map.Required("file");
  }
  context->files.ReadEach(file.value_or(value), [&](const std::string& path) {
    const int reader = assignment->NextReader();
    context->readers.emplace(path, reader);
    if (reader != assignment->rank()) return;
    parts->push_back(LoadData(path, job->arm, format, &job->data.references,
                              context->num_threads));
  });
}

}  // namespace

MeasurementSigmas ReadSigmas(const JobContext& context, JobConfig* job) {
  const YamlMap map =
      context.file.Required("measurement").Map({"sigma", "sigma_rotation"});
  const YamlValue sigma = map.Required("sigma");
  MeasurementSigmas sigmas;
  sigmas.length = kFirstSigma;
  job->options.estimate_sigma = sigma.Text() == "estimate";
  if (!job->options.estimate_sigma) {
    sigmas.length = PositiveLength(sigma, context.units);
  }
  if (const auto rotation = map.Optional("sigma_rotation")) {
    sigmas.rotation = PositiveAngle(*rotation, context.units);
  }
  return sigmas;
}

LoadedData ReadData(const YamlValue& value, const MeasurementSigmas& sigmas,
                    JobContext* context, JobConfig* job) {
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
  LoadedData all = Merge(std::move(parts), job->arm.num_joints());
  if (is_partitioned) {
    PartitionLoaded(job->communicator, known, &all, &job->data.references);
  }
  job->rejected.insert(job->rejected.end(), all.rejected.begin(),
                       all.rejected.end());
  return all;
}

}  // namespace alidade::internal
