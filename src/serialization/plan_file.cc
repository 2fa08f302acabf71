#include <algorithm>
#include <limits>
#include <string>

#include "alidade/arm_file.h"
#include "src/common/names.h"
#include "src/serialization/data_section.h"
#include "src/serialization/identifiability_section.h"
#include "src/serialization/job_file.h"
#include "src/serialization/plan_candidates.h"
#include "src/serialization/references_section.h"
#include "src/serialization/yaml_reader.h"

namespace alidade::internal {
namespace {

constexpr std::int64_t kMaxPoses = 10000;
constexpr std::int64_t kMaxStarts = 1000;
constexpr std::int64_t kMaxPasses = 100000;

std::vector<int> ReadTargets(const YamlValue& value, const Arm& arm) {
  std::vector<std::string> names;
  for (const Target& target : arm.targets) names.push_back(target.name);
  std::vector<int> targets;
  for (const YamlValue& item : value.List()) {
    const std::string name = item.Choice("target", names);
    const auto target = static_cast<int>(
        std::find(names.begin(), names.end(), name) - names.begin());
    if (std::count(targets.begin(), targets.end(), target) > 0) {
      item.Fail(Quote(name) + " is repeated, expected each target once");
    }
    targets.push_back(target);
  }
  if (targets.empty()) value.Fail("the list is empty, expected targets");
  return targets;
}

void ReadAxes(const YamlMap& map, PoseMeasurement* measurement) {
  const std::optional<YamlValue> axes = map.Optional("axes");
  if (!axes) return;
  measurement->axes = {false, false, false};
  for (const YamlValue& item : axes->List()) {
    const std::string name = item.Choice("axis", {"x", "y", "z"});
    measurement->axes[name[0] - 'x'] = true;
  }
  if (measurement->num_equations() == 0) {
    axes->Fail("the list is empty, expected some of x, y and z");
  }
}

void ReadMeasurement(const JobContext& context, PlanConfig* plan) {
  const YamlMap map =
      context.file.Required("measurement")
          .Map({"kind", "sigma", "sigma_rotation", "targets", "axes"});
  PoseMeasurement& measurement = plan->measurement;
  if (const auto kind = map.Optional("kind")) {
    measurement.orientation =
        kind->Choice("kind", {"position", "pose"}) == "pose";
  }
  measurement.sigma = PositiveLength(map.Required("sigma"), context.units);
  measurement.rotation_sigma = DefaultRotationSigma(measurement.sigma);
  if (const auto rotation = map.Optional("sigma_rotation")) {
    if (!measurement.orientation) {
      rotation->Fail("goes with `kind: pose`, found positions");
    }
    measurement.rotation_sigma = PositiveAngle(*rotation, context.units);
  }
  const Arm& arm = plan->job.arm;
  measurement.targets.clear();
  for (int target = 0; target < arm.num_targets(); ++target) {
    measurement.targets.push_back(target);
  }
  if (const auto targets = map.Optional("targets")) {
    measurement.targets = ReadTargets(*targets, arm);
  }
  ReadAxes(map, &measurement);
}

// Arm, earlier measurements and parameters come from a job, or are told here.
JobConfig ReadJob(const YamlValue& value, JobContext* context) {
  for (const char* key : {"arm", "measured", "references"}) {
    if (const auto other = context->file.Optional(key)) {
      other->Fail("found beside \"job\", which says the same");
    }
  }
  return context->files.Read(
      value, [](const std::string& path) { return LoadWholeJob(path); });
}

void ReadMeasured(JobContext* context, PlanConfig* plan) {
  JobConfig job;
  job.arm = plan->job.arm;
  job.data.references = ReadReferences(*context);
  job.data.training.joint_values = Eigen::MatrixXd(job.arm.num_joints(), 0);
  if (const auto value = context->file.Optional("measured")) {
    const MeasurementSigmas sigmas = {plan->measurement.sigma,
                                      plan->measurement.rotation_sigma};
    job.data.training = ReadData(*value, sigmas, context, &job).data;
    ReadPointDistances(*context, sigmas.length, &job);
  }
  plan->job = std::move(job);
}

void ReadMinimumMotion(const YamlValue& value, const Units& units,
                       PlanConfig* plan) {
  const YamlMap map = value.Map({"angle", "length"});
  const Arm& arm = plan->job.arm;
  plan->minimum_motion.setConstant(arm.num_joints(),
                                   std::numeric_limits<double>::infinity());
  const std::optional<YamlValue> angle = map.Optional("angle");
  const std::optional<YamlValue> length = map.Optional("length");
  for (int j = 0; j < arm.num_joints(); ++j) {
    const bool turns = arm.joints[j].type == JointType::kRevolute;
    if (turns && angle) plan->minimum_motion[j] = PositiveAngle(*angle, units);
    if (!turns && length) {
      plan->minimum_motion[j] = PositiveLength(*length, units);
    }
  }
  if (!plan->minimum_motion.array().isFinite().any()) {
    value.Fail("expected `angle` (joints that turn) or `length` (that slide)");
  }
}

void ReadPoses(const JobContext& context, PlanConfig* plan) {
  const YamlMap map = context.file.Required("poses").Map(
      {"count", "accuracy", "most", "repeats", "minimum_motion"});
  const std::optional<YamlValue> count = map.Optional("count");
  const std::optional<YamlValue> accuracy = map.Optional("accuracy");
  if (count.has_value() == accuracy.has_value()) {
    map.Fail(
        "expected one of `count` (poses) and `accuracy` (worst predicted "
        "standard deviation)");
  }
  plan->design.num_poses = 500;
  if (count) {
    plan->design.num_poses = static_cast<int>(count->Integer(1, kMaxPoses));
  } else {
    plan->wanted = PositiveLength(*accuracy, context.units);
  }
  if (const auto most = map.Optional("most")) {
    if (count) most->Fail("goes with `accuracy`, found beside `count`");
    plan->design.num_poses = static_cast<int>(most->Integer(1, kMaxPoses));
  }
  map.ReadBoolean("repeats", &plan->design.allow_repeats);
  if (const auto motion = map.Optional("minimum_motion")) {
    ReadMinimumMotion(*motion, context.units, plan);
  }
}

void ReadSearch(const JobContext& context, PlanConfig* plan) {
  if (const auto criterion = context.file.Optional("criterion")) {
    plan->design.criterion = FindDesignCriterion(
        criterion->Choice("criterion", DesignCriterionNames()));
  }
  const std::optional<YamlValue> value = context.file.Optional("search");
  if (!value) return;
  const YamlMap map = value->Map({"starts", "shortlist", "max_passes"});
  DesignOptions& options = plan->design;
  const auto read = [&](const char* key, std::int64_t most, int* field) {
    if (const auto entry = map.Optional(key)) {
      *field = static_cast<int>(entry->Integer(1, most));
    }
  };
  read("starts", kMaxStarts, &options.starts);
  read("shortlist", kMaxPoses, &options.shortlist);
  read("max_passes", kMaxPasses, &options.max_passes);
}

void ReadCurve(const JobContext& context, PlanConfig* plan) {
  const std::optional<YamlValue> value = context.file.Optional("curve");
  if (!value) return;
  for (const YamlValue& item : value->List()) {
    plan->curve.push_back(static_cast<int>(item.Integer(1, kMaxPoses)));
  }
  plan->with_curve = !plan->curve.empty();
  std::sort(plan->curve.begin(), plan->curve.end());
  plan->curve.erase(std::unique(plan->curve.begin(), plan->curve.end()),
                    plan->curve.end());
}

void ReadSpeeds(const JobContext& context, PlanConfig* plan) {
  const std::optional<YamlValue> value = context.file.Optional("speeds");
  if (!value) return;
  const Arm& arm = plan->job.arm;
  const std::vector<YamlValue> items =
      value->List(arm.joints.size(), "the speed of every joint");
  plan->speeds.resize(arm.num_joints());
  for (int j = 0; j < arm.num_joints(); ++j) {
    plan->speeds[j] = arm.joints[j].type == JointType::kRevolute
                          ? PositiveAngle(items[j], context.units)
                          : PositiveLength(items[j], context.units);
  }
}

}  // namespace

PlanConfig LoadPlan(const std::string& path, int num_threads) {
  const YamlMap file =
      ReadConfigFile(path, FileFormat::kPlan)
          .Map({"format", "title", "units", "job", "arm", "measured",
                "references", "measurement", "identifiability", "poses",
                "candidates", "criterion", "region", "search", "curve",
                "speeds", "seed"});
  JobContext context{file, Units(file), NamedFiles(path), num_threads};
  PlanConfig plan;
  plan.path = path;
  plan.title = file.Required("title").Text();
  const std::optional<YamlValue> job = file.Optional("job");
  std::vector<std::string> inputs_of_job;
  if (job) {
    JobConfig read = ReadJob(*job, &context);
    inputs_of_job = std::move(read.input_files);
    plan.job = std::move(read);
  } else {
    plan.job.arm = context.files.ReadArm(file.Required("arm"), LoadArm);
  }
  ReadMeasurement(context, &plan);
  if (!job) ReadMeasured(&context, &plan);
  ReadIdentifiability(context, LayoutOf(plan.job.arm, plan.job.data.references),
                      &plan.job.options.identifiability);
  ReadPoses(context, &plan);
  ReadPlanCandidates(&context, &plan);
  plan.constraints.targets = plan.measurement.targets;
  ReadPlanRegion(context, &plan);
  ReadSearch(context, &plan);
  ReadCurve(context, &plan);
  ReadSpeeds(context, &plan);
  plan.seed = file.Required("seed").Seed();
  plan.input_files = context.files.paths();
  plan.input_files.insert(plan.input_files.end(), inputs_of_job.begin(),
                          inputs_of_job.end());
  return plan;
}

}  // namespace alidade::internal
