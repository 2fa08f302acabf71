#include "src/serialization/simulation_file.h"

#include <algorithm>
#include <cmath>

#include "alidade/arm_file.h"
#include "alidade/parameter_layout.h"
#include "src/dataio/dataset_csv.h"
#include "src/serialization/config_file.h"
#include "src/serialization/yaml_reader.h"

namespace alidade::internal {
namespace {

constexpr std::int64_t kMaxPoses = 10000000;
constexpr int kMaxJointDecimals = 12;

Range ReadRange(const YamlValue& value, Dimension dimension,
                const Units& units) {
  const YamlMap map = value.Map({"from", "to", "count"});
  Range range;
  range.from = map.Required("from").Quantity(dimension, units);
  range.to = map.Required("to").Quantity(dimension, units);
  range.count = static_cast<int>(map.Required("count").Integer(1, kMaxPoses));
  if (range.count == 1 && range.from != range.to) {
    map.Required("count").Fail(
        "expected 2 or more, or the same \"from\" and \"to\", found 1");
  }
  return range;
}

Eigen::VectorXd ReadStart(const YamlValue& value, const Arm& arm,
                          const Units& units) {
  const std::vector<YamlValue> items =
      value.List(arm.joints.size(), "a value for every joint of the arm");
  Eigen::VectorXd start(arm.num_joints());
  for (int j = 0; j < arm.num_joints(); ++j) {
    const bool is_revolute = arm.joints[j].type == JointType::kRevolute;
    start[j] = items[j].Quantity(
        is_revolute ? Dimension::kAngle : Dimension::kLength, units);
  }
  return start;
}

void ReadElevation(const YamlValue& value, const Units& units,
                   CylinderGrid* grid) {
  const std::vector<YamlValue> items = value.List(2, "from, to");
  grid->elevation_from = items[0].Quantity(Dimension::kAngle, units);
  grid->elevation_to = items[1].Quantity(Dimension::kAngle, units);
  if (grid->elevation_to < grid->elevation_from) {
    value.Fail("expected [from, to] with \"to\" not below \"from\", found [" +
               items[0].Text() + ", " + items[1].Text() + "]");
  }
}

CylinderGrid ReadCylinder(const YamlValue& value, const Arm& arm,
                          const Units& units) {
  const YamlMap map =
      value.Map({"azimuth", "radius", "height", "elevation", "start"});
  CylinderGrid grid;
  grid.azimuth = ReadRange(map.Required("azimuth"), Dimension::kAngle, units);
  const YamlValue radius = map.Required("radius");
  grid.radius = ReadRange(radius, Dimension::kLength, units);
  if (grid.radius.from < 0.0 || grid.radius.to < 0.0) {
    radius.Fail("expected \"from\" and \"to\" not below zero");
  }
  const std::int64_t count =
      std::int64_t{grid.azimuth.count} * grid.radius.count;
  if (count > kMaxPoses) {
    map.Fail("expected at most " + std::to_string(kMaxPoses) +
             " poses, found " + std::to_string(count));
  }
  grid.height = map.Required("height").Quantity(Dimension::kLength, units);
  ReadElevation(map.Required("elevation"), units, &grid);
  grid.start = ReadStart(map.Required("start"), arm, units);
  return grid;
}

RandomPoses ReadRandom(const YamlValue& value, const Arm& arm) {
  const YamlMap map = value.Map({"count"});
  for (int j = 0; j < arm.num_joints(); ++j) {
    const Joint& joint = arm.joints[j];
    // A revolute joint without limits draws from a full turn.
    if (joint.type == JointType::kRevolute) continue;
    if (std::isfinite(joint.lower) && std::isfinite(joint.upper)) continue;
    value.Fail("expected limits for every prismatic joint, joint " +
               std::to_string(j + 1) + " of arm \"" + arm.name +
               "\" has none: add them to the arm file");
  }
  RandomPoses poses;
  poses.count = static_cast<int>(map.Required("count").Integer(1, kMaxPoses));
  return poses;
}

void ReadPoses(const YamlValue& value, const Units& units, NamedFiles* files,
               SimulationConfig* config) {
  const YamlMap map = value.Map({"cylinder", "random", "file"});
  if (map.entries().size() != 1) {
    map.Fail("expected exactly one of cylinder, random, file, found " +
             std::to_string(map.entries().size()));
  }
  const auto& [kind, entry] = map.entries().front();
  if (kind == "cylinder") {
    config->poses = ReadCylinder(entry, config->arm, units);
  } else if (kind == "random") {
    config->poses = ReadRandom(entry, config->arm);
  } else {
    const auto load = [&](const std::string& path) {
      return PosesFromFile{path, LoadJointValues(path, config->arm)};
    };
    config->poses = files->Read(entry, load);
  }
}

void ReadNoise(const YamlMap& file, const Units& units,
               SimulationConfig* config) {
  const std::optional<YamlValue> noise = file.Optional("noise");
  if (!noise) return;
  const YamlValue sigma = noise->Map({"sigma"}).Required("sigma");
  config->noise_sigma = sigma.Quantity(Dimension::kLength, units);
  if (config->noise_sigma < 0.0) {
    sigma.Fail("expected a length not below zero, found " + sigma.Text());
  }
}

void ReadTrueValues(const YamlMap& file, NamedFiles* files,
                    SimulationConfig* config) {
  const ParameterLayout layout(config->arm);
  config->true_values = layout.Values(config->arm);
  const std::optional<YamlValue> deviations = file.Optional("deviations");
  if (!deviations) return;
  config->true_values += files->Read(*deviations, [&](const std::string& path) {
    return LoadDeviations(path, config->arm);
  });
}

void ReadOutput(const YamlMap& file, const NamedFiles& files,
                SimulationConfig* config) {
  const YamlValue output = file.Required("output");
  config->output = files.Resolve(output);
  const std::vector<std::string>& inputs = files.paths();
  if (std::find(inputs.begin(), inputs.end(), config->output) != inputs.end()) {
    output.Fail("expected a file that the simulation does not read, found " +
                config->output);
  }
}

}  // namespace

void ReadSimulationSection(const YamlMap& map, const Units& units,
                           NamedFiles* files, SimulationConfig* config) {
  ReadTrueValues(map, files, config);
  ReadPoses(map.Required("poses"), units, files, config);
  ReadNoise(map, units, config);
  config->seed = map.Required("seed").Seed();
  if (const auto decimals = map.Optional("joint_decimals")) {
    config->joint_decimals =
        static_cast<int>(decimals->Integer(0, kMaxJointDecimals));
  }
}

SimulationConfig ReadSimulatedData(const YamlValue& value, const Arm& arm,
                                   const Units& units, NamedFiles* files) {
  const YamlMap map =
      value.Map({"deviations", "poses", "noise", "seed", "joint_decimals"});
  SimulationConfig config;
  config.path = value.location().file;
  config.arm = arm;
  ReadSimulationSection(map, units, files, &config);
  config.output = "simulated, seed " + std::to_string(config.seed);
  return config;
}

SimulationConfig LoadSimulation(const std::string& path) {
  const YamlMap file =
      ReadConfigFile(path, FileFormat::kSimulation)
          .Map({"format", "title", "units", "arm", "deviations", "poses",
                "noise", "seed", "joint_decimals", "output"});
  const Units units(file);
  NamedFiles files(path);
  SimulationConfig config;
  config.path = path;
  file.ReadText("title", &config.title);
  config.arm = files.ReadArm(file.Required("arm"), LoadArm);
  ReadSimulationSection(file, units, &files, &config);
  ReadOutput(file, files, &config);
  config.input_files = files.paths();
  return config;
}

}  // namespace alidade::internal
