#include "src/cli/validation_data.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "alidade/error.h"
#include "alidade/forward_kinematics.h"
#include "src/calibration/calibration_task.h"
#include "src/calibration/evaluate.h"
#include "src/cli/command.h"
#include "src/common/names.h"
#include "src/dataio/dataset_csv.h"
#include "src/kernel/measurement_model.h"
#include "src/model/joint_draw.h"
#include "src/serialization/job_config.h"

namespace alidade::internal {
namespace {

// Other targets are those of a tool that was mounted for the check.
void TakeTargets(const std::string& path, const Arm& other, const Refit& refit,
                 Arm* arm) {
  std::vector<std::string> names[2];
  for (const Target& target : arm->targets) names[0].push_back(target.name);
  for (const Target& target : other.targets) names[1].push_back(target.name);
  const bool are_same = names[0] == names[1];
  if (arm->JointDimensions() == other.JointDimensions() &&
      (are_same || refit.tool)) {
    if (!are_same) arm->targets = other.targets;
    return;
  }
  throw InputError({path, 0, 0, "arm"},
                   "has other joints or targets than the arm that is "
                   "validated; --refit=tool takes other targets");
}

}  // namespace

std::vector<std::string> UnknownReferences(const References& references) {
  std::vector<std::string> names;
  for (const ReferencePoint& point : references.points) {
    if (!point.is_known) names.push_back(point.name);
  }
  for (const ReferencePlane& plane : references.planes) {
    if (!plane.is_known) names.push_back(plane.name);
  }
  return names;
}

std::string Refit::Text() const {
  std::vector<std::string> names;
  if (base) names.emplace_back("base");
  if (tool) names.emplace_back("tool");
  if (references) names.emplace_back("references");
  return JoinNames(names);
}

Refit ReadRefit(const std::string& text) {
  Refit refit;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string name = text.substr(begin, end - begin);
    bool* const member = name == "base"         ? &refit.base
                         : name == "tool"       ? &refit.tool
                         : name == "references" ? &refit.references
                                                : nullptr;
    if (member == nullptr) {
      throw InputError(
          {}, "validate: --refit: " +
                  UnknownName("part", name, {"base", "tool", "references"}));
    }
    *member = true;
    begin = end + 1;
  }
  return refit;
}

namespace {

constexpr char kStation[] = "station ";

bool HasEffect(const Arm& arm, const std::string& name) {
  const std::vector<CovariateEffect>& effects = arm.errors.covariates;
  return std::any_of(
      effects.begin(), effects.end(),
      [&name](const CovariateEffect& effect) { return effect.name == name; });
}

// Stations of the data are told apart by the arm that the job names.
void RequireKnownStations(const std::string& path, const Arm& arm,
                          const JobConfig& job) {
  bool has_stations = false;
  for (const CovariateEffect& effect : arm.errors.covariates) {
    if (effect.name.rfind(kStation, 0) != 0) continue;
    has_stations = true;
    if (HasEffect(job.arm, effect.name)) continue;
    throw InputError({path, 0, 0, ""},
                     "the arm was calibrated with stations, which the job's "
                     "`arm` does not know: name the calibrated arm.yaml there");
  }
  if (!has_stations) return;
  for (const std::string& name : job.data.training.covariate_names) {
    if (name.rfind(kStation, 0) != 0 || HasEffect(arm, name)) continue;
    throw InputError({path, 0, 0, ""},
                     "the arm was not calibrated with " + name +
                         ", so that its base there is not known");
  }
}

}  // namespace

CalibrationData LoadValidationData(const std::string& path, const Refit& refit,
                                   double default_sigma, int num_threads,
                                   Arm* arm) {
  CalibrationData data;
  if (IsDataFile(path)) {
    DataFormat format;
    format.sigma = default_sigma;
    data.training =
        LoadData(path, *arm, format, &data.references, num_threads).data;
    return data;
  }
  JobConfig job = LoadJob(path, num_threads);
  TakeTargets(path, job.arm, refit, arm);
  RequireKnownStations(path, *arm, job);
  data = std::move(job.data);
  data.validation.reset();
  return data;
}

Accuracy ValidationAccuracy(const std::string& path, const Arm& arm,
                            CalibrationData data, const Refit& refit,
                            int num_threads) {
  const bool has_unknown = !UnknownReferences(data.references).empty();
  const Execution execution{num_threads, SingleProcess()};
  if (!refit.base && !refit.tool && !has_unknown) {
    const MeasurementModel model(arm, data.references, execution);
    return EvaluateAccuracy(model, data.training, model.NominalValues());
  }
  CalibrationTask task;
  task.arm = arm;
  task.data = std::move(data);
  task.options.identifiability.candidates = {false, refit.base, refit.tool};
  task.options.num_threads = num_threads;
  const CalibrationResult result = Calibrate(std::move(task));
  if (!result.IsUsable()) {
    Refit fitted = refit;
    fitted.references = has_unknown;
    throw InputError(
        {path, 0, 0, ""},
        "the fit of " + fitted.Text() + " failed: " + result.message +
            (fitted.tool && fitted.base ? ""
                                        : ". --refit=tool finds a "
                                          "tool that sits elsewhere, "
                                          "--refit=base an instrument "
                                          "that stands elsewhere"));
  }
  return result.train.after;
}

Arm AlignedWith(const Arm& arm, const Arm& reference, std::uint64_t seed,
                int num_threads) {
  constexpr int kPoses = 500;
  constexpr double kAnySigma = 1e-4;  // m
  const Eigen::MatrixXd joints = DrawJointValues(arm, kPoses, seed);
  CalibrationTask task;
  task.arm = arm;
  task.data.training =
      MakePositions(joints, TargetPositions(reference, joints), kAnySigma);
  task.options.identifiability.candidates = {false, true, true};
  task.options.num_threads = num_threads;
  const CalibrationResult result = Calibrate(std::move(task));
  return result.IsUsable() ? result.arm : arm;
}

}  // namespace alidade::internal
