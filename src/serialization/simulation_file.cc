#include "src/serialization/simulation_file.h"

#include <algorithm>
#include <cmath>

#include "alidade/arm_file.h"
#include "alidade/parameter_layout.h"
#include "src/dataio/dataset_csv.h"
#include "src/serialization/config_file.h"
#include "src/serialization/field_records.h"
#include "src/serialization/yaml_reader.h"

namespace alidade::internal {
namespace {

constexpr int kMaxSimulatedPoses = 10000000;

// A simulation that is being read.
struct SimulationReading {
  NamedFiles* files;
  SimulationConfig* config;
};

template <typename Visitor>
void VisitRange(Visitor& v, const char* name, const char* text,
                Dimension dimension, Range* range) {
  v.Section(Key(name).Required(), text, [&](auto& section) {
    section.Field(QuantityKey("from", dimension).Required(), range->from,
                  "the first value");
    section.Field(QuantityKey("to", dimension).Required(), range->to,
                  "the last one");
    section.Field(Key("count").AtLeast(1).AtMost(kMaxSimulatedPoses).Required(),
                  range->count, "values, both ends included");
    section.Check([range](const YamlMap& map) {
      if (range->count > 1 || range->from == range->to) return;
      map.Required("count").Fail(
          "expected 2 or more, or the same \"from\" and \"to\", found 1");
    });
  });
}

void ReadElevation(const YamlValue& value, const Units& units,
                   CylinderGrid* grid) {
  std::tie(grid->elevation_from, grid->elevation_to) =
      ReadInterval(value, Dimension::kAngle, units);
}

void CheckCylinder(const YamlMap& map, const CylinderGrid& grid) {
  if (grid.radius.from < 0.0 || grid.radius.to < 0.0) {
    map.Required("radius").Fail("expected \"from\" and \"to\" not below zero");
  }
  const std::int64_t count =
      std::int64_t{grid.azimuth.count} * grid.radius.count;
  if (count > kMaxSimulatedPoses) {
    map.Fail("expected at most " + std::to_string(kMaxSimulatedPoses) +
             " poses, found " + std::to_string(count));
  }
}

template <typename Visitor>
void VisitCylinder(Visitor& v, const Arm& arm, CylinderGrid* grid) {
  VisitRange(v, "azimuth", "angles about the base's z axis", Dimension::kAngle,
             &grid->azimuth);
  VisitRange(v, "radius", "distances from it", Dimension::kLength,
             &grid->radius);
  v.Field(LengthKey("height").Required(), grid->height,
          "z of all targets, in the base's frame");
  v.Custom(AngleKey("elevation").Required().Schema(kIntervalSchema),
           "`[from, to]`: of the last joint's z axis above the horizontal; "
           "drawn for each pose, and drawn again where no joint values within "
           "the limits reach it. -90 degrees points down",
           [grid](const YamlValue& value, const Units& units) {
             ReadElevation(value, units, grid);
           });
  v.Custom(
      Key("start").In("angle or length").Required().Schema(kNumbersSchema),
      "joint values that the search begins from, one per joint: they choose "
      "the posture",
      [grid, &arm](const YamlValue& value, const Units& units) {
        grid->start = ReadJointQuantities(value, units, arm,
                                          "a value for every joint of the arm");
      });
  v.Check([grid](const YamlMap& map) { CheckCylinder(map, *grid); });
}

// A revolute joint without limits draws from a full turn.
void CheckLimits(const YamlMap& map, const Arm& arm) {
  for (int j = 0; j < arm.num_joints(); ++j) {
    const Joint& joint = arm.joints[j];
    if (joint.type == JointType::kRevolute) continue;
    if (std::isfinite(joint.lower) && std::isfinite(joint.upper)) continue;
    map.Fail("expected limits for every prismatic joint, joint " +
             std::to_string(j + 1) + " of arm \"" + arm.name +
             "\" has none: add them to the arm file");
  }
}

void CheckOneKind(const YamlMap& map) {
  if (map.entries().size() == 1) return;
  map.Fail("expected exactly one of cylinder, random, file, found " +
           std::to_string(map.entries().size()));
}

template <typename Visitor>
void VisitPoses(Visitor& v, const SimulationReading& reading) {
  SimulationConfig* const config = reading.config;
  v.Check(CheckOneKind);
  v.Section(
      Key("cylinder"),
      "targets on cylinders about the vertical axis of the base: every azimuth "
      "with every radius, found by inverse kinematics of the nominal arm",
      [&](auto& section) {
        CylinderGrid grid;
        VisitCylinder(section, config->arm, &grid);
        section.Check([&](const YamlMap& /*map*/) { config->poses = grid; });
      });
  v.Section(Key("random"),
            "joint values drawn uniformly within the limits, which prismatic "
            "joints must have; a revolute joint without limits draws from a "
            "full turn",
            [&](auto& section) {
              RandomPoses poses;
              section.Field(
                  Key("count").AtLeast(1).AtMost(kMaxSimulatedPoses).Required(),
                  poses.count, "number of poses");
              section.Check([&](const YamlMap& map) {
                CheckLimits(map, config->arm);
                config->poses = poses;
              });
            });
  v.Custom(PathKey("file"),
           "the joint values of a data set; its other columns are ignored",
           [reading, config](const YamlValue& value) {
             config->poses = PosesFromFile{
                 NamedFiles::Resolve(value),
                 reading.files->ReadJointValues(value, config->arm)};
           });
}

Eigen::VectorXd ReadTrueValues(const YamlValue& value,
                               const SimulationReading& reading) {
  const Arm& arm = reading.config->arm;
  return ParameterLayout(arm).Values(arm) +
         reading.files->Read(value, [&](const std::string& path) {
           return LoadDeviations(path, arm);
         });
}

// What a simulation file and a job's `simulate` have in common.
template <typename Visitor>
void VisitSimulated(Visitor& v, const SimulationReading& reading) {
  SimulationConfig* const config = reading.config;
  v.Check([config](const YamlMap& /*map*/) {
    config->true_values = ParameterLayout(config->arm).Values(config->arm);
  });
  v.Custom(PathKey("deviations"),
           "of the real arm; without it, the real arm is the nominal one",
           [reading, config](const YamlValue& value) {
             config->true_values = ReadTrueValues(value, reading);
           });
  v.Section(Key("poses").Required(), "exactly one of the three below",
            [&](auto& section) { VisitPoses(section, reading); });
  v.Section(Key("noise"), "of the instrument", [&](auto& section) {
    section.Field(LengthKey("sigma").AtLeast(0).Required(), config->noise_sigma,
                  "standard deviation of each coordinate");
  });
  v.Field(Key("seed").Required(), config->seed,
          "integer from 0 to 2^64 - 1; all that is drawn follows from it");
  v.Field(Key("joint_decimals").AtLeast(0).AtMost(12), config->joint_decimals,
          "joint values are rounded to so many decimals of a degree or a mm, "
          "so that the data set states them exactly");
}

void ReadOutput(const YamlValue& output, const NamedFiles& files,
                SimulationConfig* config) {
  config->output = files.Resolve(output);
  const std::vector<std::string>& inputs = files.paths();
  if (std::find(inputs.begin(), inputs.end(), config->output) != inputs.end()) {
    output.Fail("expected a file that the simulation does not read, found " +
                config->output);
  }
}

template <typename Visitor>
void VisitSimulation(Visitor& v, const SimulationReading& reading) {
  SimulationConfig* const config = reading.config;
  VisitHead(v, FileFormat::kSimulation);
  v.Field(Key("title"), config->title, "for people");
  v.Custom(PathKey("arm").Required(),
           "the nominal arm: a file, or `robots/NAME` of those that `alidade "
           "robots` lists",
           [reading, config](const YamlValue& value) {
             config->arm = reading.files->ReadArm(value, LoadArm);
           });
  VisitSimulated(v, reading);
  v.Custom(PathKey("output").Required(),
           "the data set: a NumPy array where the name ends in `.npy`, else a "
           "CSV",
           [reading, config](const YamlValue& value) {
             ReadOutput(value, *reading.files, config);
           });
}

}  // namespace

std::vector<FieldRecord> SimulationFields() {
  SimulationConfig config;
  return CollectFields([&](auto& v) {
    VisitSimulation(v, {nullptr, &config});
  });
}

std::vector<FieldRecord> SimulatedDataFields() {
  SimulationConfig config;
  return CollectFields([&](auto& v) { VisitSimulated(v, {nullptr, &config}); });
}

SimulationConfig ReadSimulatedData(const YamlValue& value, const Arm& arm,
                                   const Units& units, NamedFiles* files) {
  SimulationConfig config;
  config.path = value.location().file;
  config.arm = arm;
  ReadFields(value, units, [&](auto& v) {
    VisitSimulated(v, {files, &config});
  });
  config.output = "simulated, seed " + std::to_string(config.seed);
  return config;
}

SimulationConfig LoadSimulation(const std::string& path) {
  return ReadSimulation(ReadConfigFile(path, FileFormat::kSimulation));
}

SimulationConfig ReadSimulation(const YamlValue& root) {
  const Units units(root.Map(KeysOf(SimulationFields())));
  NamedFiles files(root.document());
  SimulationConfig config;
  config.path = root.location().file;
  ReadFields(root, units, [&](auto& v) {
    VisitSimulation(v, {&files, &config});
  });
  config.input_files = files.paths();
  return config;
}

}  // namespace alidade::internal
