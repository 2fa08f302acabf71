#include "src/serialization/plan_file.h"

#include <algorithm>
#include <string>
#include <tuple>
#include <utility>

#include "alidade/arm_file.h"
#include "src/common/constants.h"
#include "src/planning/plan_fields.h"
#include "src/serialization/data_section.h"
#include "src/serialization/errors_section.h"
#include "src/serialization/field_records.h"
#include "src/serialization/identifiability_section.h"
#include "src/serialization/job_config.h"
#include "src/serialization/references_section.h"
#include "src/serialization/workspace_boxes.h"
#include "src/serialization/yaml_reader.h"

namespace alidade::internal {

namespace {

constexpr int kMaxPoses = 10000;
constexpr char kEachTargetInBoxes[] =
    "boxes in the base's frame: each target that is measured is in one of them";

// What is planned where only an accuracy is asked for.
constexpr int kMostPoses = 500;

// What goes with candidates that are drawn. @throws InputError.
void RefuseDrawing(const YamlMap& map) {
  if (!map.Optional("file")) return;
  for (const char* key : {"count", "limit_faces", "joint_decimals"}) {
    if (const auto other = map.Optional(key)) {
      other->Fail("found beside \"file\", expected candidates drawn or read");
    }
  }
}

// @throws InputError where the list has not one interval for every joint.
std::vector<std::pair<double, double>> ReadJointLimits(const YamlValue& value,
                                                       const Units& units,
                                                       const Arm& arm) {
  const std::vector<YamlValue> items =
      value.List(arm.joints.size(), "[lower, upper] of every joint");
  std::vector<std::pair<double, double>> limits;
  for (int j = 0; j < arm.num_joints(); ++j) {
    limits.push_back(ReadInterval(items[j], arm.joints[j].dimension(), units));
  }
  return limits;
}

template <typename Visitor>
void VisitConstraints(Visitor& v, PoseConstraints* constraints) {
  VisitBoxes(v, kEachTargetInBoxes, &constraints->boxes);
  const Key margin = LengthKey("margin").AtLeast(0);
  const char* thickness = "for the thickness of the links";
  v.Section(Key("floor"),
            "origins of all frames but the first, and all targets, stay above "
            "it. A height that the arm's own stand is nearer to leaves no pose",
            [&](auto& section) {
              HalfSpace floor;
              section.Field(LengthKey("height").Required(), floor.offset,
                            "in the base's frame");
              section.Field(margin, floor.margin, thickness);
              section.Check([&](const YamlMap& /*map*/) {
                constraints->half_spaces.push_back(floor);
              });
            });
  v.Items(Key("walls"),
          "likewise on the side of a plane that `normal` points to",
          constraints->half_spaces, [&](auto& item, HalfSpace& wall) {
            Eigen::Vector3d point = Eigen::Vector3d::Zero();
            item.Field(Key("normal").Required(), wall.normal,
                       "direction into the free space");
            item.Field(LengthKey("point").Required(), point, "on the plane");
            item.Field(margin, wall.margin, thickness);
            item.Check([&](const YamlMap& /*map*/) {
              wall.offset = wall.normal.dot(point);
            });
          });
  v.Section(
      Key("visibility"), "the instrument sees a target that looks at it",
      [&](auto& section) {
        Visibility visibility;
        section.Field(LengthKey("instrument").Required(), visibility.instrument,
                      "where it stands, in the base's frame");
        section.Field(Key("axis").Default("`[0, 0, 1]`"), visibility.axis,
                      "direction in the frame of each target that is measured");
        section.Field(AngleKey("angle").Above(0).AtMost(kPi).Required(),
                      visibility.angle,
                      "the most between `axis` and the way from the "
                      "target to the instrument");
        section.Check([&](const YamlMap& /*map*/) {
          constraints->visibility = visibility;
        });
      });
}

// The section `candidates`: how they are drawn or read, and their constraints.
template <typename Visitor>
void VisitCandidates(Visitor& v, JobContext* context, PlanConfig* plan) {
  VisitFields(v, plan->candidates);
  v.Custom(PathKey("file"),
           "instead of drawing: the joint values of a data set; its other "
           "columns are ignored",
           [plan, context](const YamlValue& value) {
             plan->given_candidates =
                 context->files.ReadJointValues(value, plan->job.arm);
           });
  v.Check(RefuseDrawing);
  VisitConstraints(v, &plan->constraints);
}

// The section `region`.
template <typename Visitor>
void VisitRegion(Visitor& v, PlanConfig* plan) {
  v.Custom(Key("joints")
               .In("angle or length")
               .Default("the arm's limits")
               .Schema(R"({"type": "array"})"),
           "`[lower, upper]` of every joint",
           [plan](const YamlValue& value, const Units& units) {
             plan->region.joint_limits =
                 ReadJointLimits(value, units, plan->job.arm);
           });
  VisitBoxes(v, kEachTargetInBoxes, &plan->region.boxes);
  v.Field(Key("count").AtLeast(1).AtMost(10000), plan->region.count,
          "poses of the region that `G` and `I` are evaluated at");
}

// A plan that is being read.
struct PlanReading {
  JobContext* context;
  PlanConfig* plan;
  /// Arm and measurements are there: the rest is read.
  bool is_without_files = false;
  StatedReferences references = {};
  std::vector<std::string> inputs_of_job = {};
};

std::vector<int> ReadTargets(const YamlValue& value, const Arm& arm) {
  std::vector<std::string> names;
  for (const Target& target : arm.targets) names.push_back(target.name);
  std::vector<int> targets;
  for (const std::string& name : ReadNames(value, "target", names)) {
    targets.push_back(static_cast<int>(
        std::find(names.begin(), names.end(), name) - names.begin()));
  }
  if (targets.empty()) value.Fail("the list is empty, expected targets");
  return targets;
}

void ReadAxes(const YamlValue& value, PoseMeasurement* measurement) {
  measurement->axes = {false, false, false};
  for (const std::string& name : ReadNames(value, "axis", {"x", "y", "z"})) {
    measurement->axes[name[0] - 'x'] = true;
  }
  if (measurement->num_equations() == 0) {
    value.Fail("the list is empty, expected some of x, y and z");
  }
}

bool ReadKind(const YamlValue& value) {
  return value.Choice("kind", {"position", "pose"}) == "pose";
}

void CompleteMeasurement(const YamlMap& map, PoseMeasurement* measurement) {
  const std::optional<YamlValue> rotation = map.Optional("sigma_rotation");
  if (!rotation) {
    measurement->rotation_sigma = DefaultRotationSigma(measurement->sigma);
  } else if (!measurement->orientation) {
    rotation->Fail("goes with `kind: pose`, found positions");
  }
}

template <typename Visitor>
void VisitPlanMeasurement(Visitor& v, PlanConfig* plan) {
  PoseMeasurement* const measurement = &plan->measurement;
  v.Custom(Key("kind")
               .Default("`position`")
               .Schema(R"({"enum": ["position", "pose"]})"),
           "what will be measured at each pose: `position` or `pose` (its "
           "orientation too)",
           [measurement](const YamlValue& value) {
             measurement->orientation = ReadKind(value);
           });
  v.Field(LengthKey("sigma").Above(0).Required(), measurement->sigma,
          "standard deviation of each coordinate; of `measured` too, where its "
          "files state none");
  v.Field(AngleKey("sigma_rotation").Above(0).Default("sigma / 0.2 m, in rad"),
          measurement->rotation_sigma, "likewise of orientations");
  v.Custom(
      Key("axes").Default("`[x, y, z]`").Schema(kNamesSchema),
      "coordinates of the instrument's frame that are measured",
      [measurement](const YamlValue& value) { ReadAxes(value, measurement); });
  v.Check([measurement, plan](const YamlMap& map) {
    CompleteMeasurement(map, measurement);
    measurement->targets.clear();
    for (int i = 0; i < plan->job.arm.num_targets(); ++i) {
      measurement->targets.push_back(i);
    }
  });
  v.Custom(Key("targets").Default("all").Schema(kNamesSchema),
           "names of the arm's targets that are measured at every pose",
           [measurement, plan](const YamlValue& value) {
             measurement->targets = ReadTargets(value, plan->job.arm);
           });
}

// Arm, earlier measurements and parameters come from a job, or are stated here.
void CheckJob(const YamlMap& map) {
  if (!map.Optional("job")) {
    map.Required("arm");
    return;
  }
  for (const char* key : {"arm", "measured", "references"}) {
    if (const auto other = map.Optional(key)) {
      other->Fail("found beside \"job\", which says the same");
    }
  }
}

void ReadJob(const YamlValue& value, PlanReading* reading) {
  JobConfig job = reading->context->files.Read(
      value, [](const std::string& path) { return LoadWholeJob(path); });
  reading->inputs_of_job = std::move(job.input_files);
  reading->plan->job = std::move(job);
}

void ReadMeasured(const YamlValue& value, PlanReading* reading) {
  PlanConfig* const plan = reading->plan;
  JobConfig job;
  job.arm = plan->job.arm;
  job.data.references = reading->references.references;
  const PoseMeasurement& stated = plan->measurement;
  const MeasurementSigmas sigmas = {stated.sigma, stated.rotation_sigma};
  std::string first_station;
  job.data.training =
      ReadData(value, sigmas, &first_station, reading->context, &job).data;
  AppendDistances(reading->references.distances, sigmas.length, &job);
  plan->job = std::move(job);
}

template <typename Visitor>
void VisitSources(Visitor& v, PlanReading* reading) {
  CalibrationTask* const job = &reading->plan->job;
  v.Check(CheckJob);
  v.Custom(PathKey("job"),
           "instead of `arm`, `measured` and `references`: a job whose arm, "
           "references, data and `identifiability` are taken. Poses that it "
           "holds out count as measured too",
           [=](const YamlValue& value) { ReadJob(value, reading); });
  v.Custom(PathKey("arm").Default("required without `job`"),
           "the arm to plan with: nominal, or as last calibrated; a file, or "
           "`robots/NAME` as in a job",
           [=](const YamlValue& value) {
             job->arm = reading->context->files.ReadArm(value, LoadArm);
             job->data.training.joint_values =
                 Eigen::MatrixXd(job->arm.num_joints(), 0);
           });
}

template <typename Visitor>
void VisitMeasured(Visitor& v, PlanReading* reading) {
  CalibrationTask* const job = &reading->plan->job;
  v.Section(
      Key("measurement").Required(), "how well will be measured",
      [&](auto& section) { VisitPlanMeasurement(section, reading->plan); });
  if (reading->is_without_files) return;
  v.Section(Key("references"), "of `measured`, as in a job",
            [&](auto& section) {
              VisitReferences(section, &reading->references);
              section.Check([&](const YamlMap& /*map*/) {
                job->data.references = reading->references.references;
              });
            });
  v.Custom(Key("measured").Schema(kDataSchema),
           "what was measured already, as a job's `data`: it counts as known, "
           "and base and targets are found from it where they are identified",
           [=](const YamlValue& value) { ReadMeasured(value, reading); });
}

template <typename Visitor>
void VisitIdentified(Visitor& v, PlanReading* reading) {
  CalibrationTask* const job = &reading->plan->job;
  v.Section(Key("identifiability"),
            "what is to be identified, as in a job; with `job`, its keys "
            "replace those of the job. Ranks are taken over all candidates and "
            "`measured`",
            [&](auto& section) {
              VisitIdentifiability(section,
                                   LayoutOf(job->arm, job->data.references),
                                   job->arm, &job->options.identifiability);
            });
  v.Custom(Key("errors").Default("none").Schema(kErrorsSchema),
           "error terms that the poses are to determine, as in a job "
           "(\"Error terms of a job\"); `auto` is elasticity and functions of "
           "all joints. With `job`, those of the job where this is left out",
           [=](const YamlValue& value, const Units& units) {
             job->options.errors =
                 ReadErrorTerms(value, units, job->arm.num_joints());
           });
}

struct MinimumMotion {
  std::optional<double> angle;
  std::optional<double> length;
};

void TakeMinimumMotion(const YamlMap& map, const MinimumMotion& motion,
                       PlanConfig* plan) {
  const Arm& arm = plan->job.arm;
  plan->minimum_motion.resize(arm.num_joints());
  for (int j = 0; j < arm.num_joints(); ++j) {
    const bool turns = arm.joints[j].type == JointType::kRevolute;
    plan->minimum_motion[j] =
        (turns ? motion.angle : motion.length).value_or(kInfinity);
  }
  if (!plan->minimum_motion.array().isFinite().any()) {
    map.Fail("expected `angle` (joints that turn) or `length` (that slide)");
  }
}

void CheckNumber(const YamlMap& map, const PlanConfig& plan) {
  const bool has_count = map.Optional("count").has_value();
  if (has_count == plan.wanted.has_value()) {
    map.Fail(
        "expected one of `count` (poses) and `accuracy` (worst predicted "
        "standard deviation)");
  }
  const std::optional<YamlValue> most = map.Optional("most");
  if (has_count && most) {
    most->Fail("goes with `accuracy`, found beside `count`");
  }
}

template <typename Visitor>
void VisitPoses(Visitor& v, PlanConfig* plan) {
  v.Field(Key("count").AtLeast(1).AtMost(kMaxPoses).Default(""),
          plan->design.num_poses, "how many");
  v.Field(LengthKey("accuracy").Above(0).Default(""), plan->wanted,
          "instead of `count`: so many that the worst predicted standard "
          "deviation of a position over the region is no larger");
  v.Check([plan](const YamlMap& map) { CheckNumber(map, *plan); });
  v.Field(Key("most").AtLeast(1).AtMost(kMaxPoses), plan->design.num_poses,
          "with `accuracy`: no more than this");
  v.Field(Key("repeats"), plan->design.allow_repeats,
          "whether a candidate may be chosen several times");
  v.Section(Key("minimum_motion"), "how far any two poses differ at least",
            [&](auto& section) {
              MinimumMotion motion;
              section.Field(AngleKey("angle").Above(0), motion.angle,
                            "in a joint that turns");
              section.Field(LengthKey("length").Above(0), motion.length,
                            "or in one that slides");
              section.Check([&](const YamlMap& map) {
                TakeMinimumMotion(map, motion, plan);
              });
            });
}

void ReadCurve(const YamlValue& value, PlanConfig* plan) {
  const Key count = Key("curve").AtLeast(1).AtMost(kMaxPoses);
  for (const YamlValue& item : value.List()) {
    plan->curve.push_back(ReadInteger(item, count));
  }
  plan->with_curve = !plan->curve.empty();
  std::sort(plan->curve.begin(), plan->curve.end());
  plan->curve.erase(std::unique(plan->curve.begin(), plan->curve.end()),
                    plan->curve.end());
}

void ReadSpeeds(const YamlValue& value, const Units& units, PlanConfig* plan) {
  const Arm& arm = plan->job.arm;
  const std::vector<YamlValue> items =
      value.List(arm.joints.size(), "the speed of every joint");
  plan->speeds.resize(arm.num_joints());
  for (int j = 0; j < arm.num_joints(); ++j) {
    const Key key = QuantityKey("", arm.joints[j].dimension());
    plan->speeds[j] = ReadNumber(items[j], key.Above(0), units);
  }
}

template <typename Visitor>
void VisitSearch(Visitor& v, PlanConfig* plan) {
  v.Field(Key("criterion"), plan->design.criterion,
          "`D` (or `O1`), `A`, `E`, `G`, `I`, `O2`, `O3`, `O4`, `O5`");
  v.Section(Key("search"), "how the exchange searches", plan->design);
  v.Custom(Key("curve").Default("about the plan's").Schema(kNumbersSchema),
           "list of numbers of poses that accuracy is shown for; `[]` for none",
           [plan](const YamlValue& value) { ReadCurve(value, plan); });
  v.Custom(Key("speeds")
               .In("per second")
               .Default("all alike")
               .Schema(kNumbersSchema),
           "of every joint, for the order of the poses",
           [plan](const YamlValue& value, const Units& units) {
             ReadSpeeds(value, units, plan);
           });
  VisitLinkRadius(v, &plan->link_radius);
  v.Field(Key("seed").Required(), plan->seed,
          "all that is drawn follows from it");
}

template <typename Visitor>
void VisitDesign(Visitor& v, PlanReading* reading) {
  PlanConfig* const plan = reading->plan;
  VisitMeasured(v, reading);
  VisitIdentified(v, reading);
  v.Section(Key("poses").Required(), "how many poses",
            [&](auto& section) { VisitPoses(section, plan); });
  v.Section(
      Key("candidates"), "what poses are chosen from",
      [&](auto& section) { VisitCandidates(section, reading->context, plan); });
  v.Section(Key("region").Default("all joint values"),
            "where predictions are to be good: what `G` (worst) and `I` (mean) "
            "look at, and the tables",
            [&](auto& section) { VisitRegion(section, plan); });
  VisitSearch(v, plan);
}

template <typename Visitor>
void VisitPlan(Visitor& v, PlanReading* reading) {
  PlanConfig* const plan = reading->plan;
  VisitHead(v, FileFormat::kPlan);
  v.Field(Key("title").Required(), plan->title, "heads the report");
  VisitSources(v, reading);
  VisitDesign(v, reading);
}

}  // namespace

std::vector<FieldRecord> PlanFields() {
  PlanConfig plan;
  plan.design.num_poses = kMostPoses;
  PlanReading reading{nullptr, &plan};
  return CollectFields([&](auto& v) { VisitPlan(v, &reading); });
}

std::vector<FieldRecord> PlanOptionFields() {
  PlanConfig plan;
  plan.design.num_poses = kMostPoses;
  PlanReading reading{nullptr, &plan, true};
  return CollectFields([&](auto& v) { VisitDesign(v, &reading); });
}

void ReadPlanOptions(const YamlValue& value, const Units& units,
                     PlanConfig* plan) {
  JobContext context{units, NamedFiles(value.document())};
  plan->design.num_poses = kMostPoses;
  PlanReading reading{&context, plan, true};
  ReadFields(value, units, [&](auto& v) { VisitDesign(v, &reading); });
  plan->constraints.targets = plan->measurement.targets;
}

PlanConfig LoadPlan(const std::string& path, int num_threads) {
  return ReadPlan(ReadConfigFile(path, FileFormat::kPlan), num_threads);
}

PlanConfig ReadPlan(const YamlValue& root, int num_threads) {
  JobContext context{Units(root.Map(KeysOf(PlanFields()))),
                     NamedFiles(root.document()), num_threads};
  PlanConfig plan;
  plan.path = root.location().file;
  plan.design.num_poses = kMostPoses;
  PlanReading reading{&context, &plan};
  ReadFields(root, context.units, [&](auto& v) { VisitPlan(v, &reading); });
  plan.constraints.targets = plan.measurement.targets;
  plan.input_files = context.files.paths();
  plan.input_files.insert(plan.input_files.end(), reading.inputs_of_job.begin(),
                          reading.inputs_of_job.end());
  return plan;
}

}  // namespace alidade::internal
