#include "src/serialization/job_file.h"

#include <algorithm>
#include <utility>

#include "alidade/arm_file.h"
#include "alidade/parameter_layout.h"
#include "src/common/names.h"
#include "src/serialization/config_file.h"
#include "src/serialization/data_section.h"
#include "src/serialization/identifiability_section.h"
#include "src/serialization/job_context.h"
#include "src/serialization/job_tree.h"
#include "src/serialization/references_section.h"
#include "src/serialization/uncertainty_section.h"
#include "src/serialization/validation_section.h"
#include "src/serialization/yaml_reader.h"

namespace alidade::internal {
namespace {

constexpr int kMaxDecimals = 15;

SolverName ReadSolverName(const YamlValue& value) {
  const std::string name = value.Choice("solver", {"ceres", "pseudo_inverse"});
  return name == "ceres" ? SolverName::kCeres : SolverName::kPseudoInverse;
}

Evaluation ReadEvaluation(const YamlValue& value) {
  const std::string name =
      value.Choice("evaluation", {"auto", "autodiff", "compressed"});
  if (name == "autodiff") return Evaluation::kAutodiff;
  return name == "compressed" ? Evaluation::kCompressed
                              : Evaluation::kAutomatic;
}

void ReadSolver(const JobContext& context, JobConfig* job) {
  const std::optional<YamlValue> value = context.file.Optional("solver");
  if (!value) return;
  const YamlMap map = value->Map(
      {"name", "max_iterations", "function_tolerance", "rounding_floor_factor",
       "wanted_precision", "initial_trust_region_radius",
       "pseudo_inverse_tolerance", "evaluation"});
  SolverOptions& options = job->options.solver_options;
  if (const auto name = map.Optional("name")) {
    job->options.solver = ReadSolverName(*name);
  }
  map.ReadInteger("max_iterations", &options.max_iterations);
  map.ReadNumber("function_tolerance", &options.function_tolerance);
  map.ReadNumber("rounding_floor_factor", &options.rounding_floor_factor);
  if (const auto precision = map.Optional("wanted_precision")) {
    options.wanted_precision =
        precision->Quantity(Dimension::kLength, context.units);
  }
  map.ReadNumber("initial_trust_region_radius",
                 &options.initial_trust_region_radius);
  map.ReadNumber("pseudo_inverse_tolerance", &options.pseudo_inverse_tolerance);
  if (const auto evaluation = map.Optional("evaluation")) {
    options.evaluation = ReadEvaluation(*evaluation);
  }
  CheckOptions(options, map);
}

void ReadRobust(const JobContext& context, JobConfig* job) {
  const std::optional<YamlValue> value = context.file.Optional("robust");
  if (!value) return;
  const YamlValue loss = value->Map({"loss"}).Required("loss");
  const std::string name =
      loss.Choice("loss", {"none", "huber", "cauchy", "tukey"});
  if (name == "huber") job->options.loss = LossKind::kHuber;
  if (name == "cauchy") job->options.loss = LossKind::kCauchy;
  if (name == "tukey") job->options.loss = LossKind::kTukey;
  if (job->options.loss != LossKind::kNone &&
      job->options.solver != SolverName::kCeres) {
    loss.Fail(
        "the pseudo-inverse is least squares: a robust loss goes with "
        "`solver: {name: ceres}`");
  }
}

void ReadCompareWith(const JobContext& context, JobConfig* job) {
  const std::optional<YamlValue> value = context.file.Optional("compare_with");
  if (!value) return;
  for (const YamlValue& item : value->List()) {
    const SolverName name = ReadSolverName(item);
    const std::vector<SolverName>& known = job->options.compare_with;
    if (name == job->options.solver ||
        std::find(known.begin(), known.end(), name) != known.end()) {
      item.Fail("solver " + Quote(item.Text()) +
                " runs already, expected each solver once");
    }
    job->options.compare_with.push_back(name);
  }
}

bool IsOfHeldout(const std::string& key) {
  return key.rfind("heldout", 0) == 0;
}

// A limit of poses that the fit does not use needs some.
void CheckHeldout(const YamlValue& limit, const std::string& key,
                  const JobConfig& job) {
  if (!IsOfHeldout(key) || job.data.validation || job.options.folds) return;
  limit.Fail("needs poses that the fit does not use: add \"validation\"");
}

void CheckRotation(const YamlValue& limit, const std::string& key,
                   const JobConfig& job) {
  const bool is_heldout = IsOfHeldout(key) && job.data.validation;
  const Dataset& data = is_heldout ? *job.data.validation : job.data.training;
  if (data.Has(MeasurementKind::kPose)) return;
  limit.Fail("no orientation is measured, expected limits of positions alone");
}

// Without the validation that goes with them, limits of held-out poses are
// passed over.
void ReadAcceptance(const JobContext& context, bool with_validation,
                    JobConfig* job) {
  const std::optional<YamlValue> value = context.file.Optional("acceptance");
  if (!value) return;
  AcceptanceLimits& limits = job->options.acceptance;
  const std::vector<std::pair<std::string, std::optional<double>*>> lengths = {
      {"train_rms", &limits.train_rms},
      {"train_max", &limits.train_max},
      {"heldout_rms", &limits.heldout_rms},
      {"heldout_max", &limits.heldout_max}};
  const std::vector<std::pair<std::string, std::optional<double>*>> angles = {
      {"train_rotation_rms", &limits.train_rotation_rms},
      {"train_rotation_max", &limits.train_rotation_max},
      {"heldout_rotation_rms", &limits.heldout_rotation_rms},
      {"heldout_rotation_max", &limits.heldout_rotation_max}};
  std::vector<std::string> keys;
  for (const auto& entry : lengths) keys.push_back(entry.first);
  for (const auto& entry : angles) keys.push_back(entry.first);
  const YamlMap map = value->Map(keys);
  for (const auto& [key, limit] : lengths) {
    const std::optional<YamlValue> found = map.Optional(key);
    if (!found || (IsOfHeldout(key) && !with_validation)) continue;
    CheckHeldout(*found, key, *job);
    *limit = PositiveLength(*found, context.units);
  }
  for (const auto& [key, limit] : angles) {
    const std::optional<YamlValue> found = map.Optional(key);
    if (!found || (IsOfHeldout(key) && !with_validation)) continue;
    CheckHeldout(*found, key, *job);
    CheckRotation(*found, key, *job);
    *limit = PositiveAngle(*found, context.units);
  }
}

void ReadBaseline(const YamlValue& value, PublishedStudy* study) {
  const YamlMap map = value.Map({"iterations", "time_s"});
  constexpr int kMaxIterations = 1000000;
  study->baseline_iterations =
      static_cast<int>(map.Required("iterations").Integer(1, kMaxIterations));
  const YamlValue time = map.Required("time_s");
  study->baseline_time_s = time.Number();
  if (!(study->baseline_time_s > 0.0)) {
    time.Fail("expected a time above zero, found " + time.Text());
  }
}

std::vector<PublishedFigure> ReadFigures(const YamlValue& value) {
  std::vector<PublishedFigure> figures;
  for (const YamlValue& item : value.List()) {
    const YamlMap map = item.Map({"quantity", "published"});
    const YamlValue quantity = map.Required("quantity");
    PublishedFigure figure;
    figure.quantity = quantity.Choice("quantity", PublishedQuantityNames());
    figure.published = map.Required("published").Text();
    for (const PublishedFigure& other : figures) {
      if (other.quantity != figure.quantity) continue;
      quantity.Fail(Quote(figure.quantity) + " is repeated, expected it once");
    }
    figures.push_back(std::move(figure));
  }
  return figures;
}

// Deviations of the arm, with zeros for the references.
Eigen::VectorXd WithReferences(const Eigen::VectorXd& deviations,
                               const JobConfig& job) {
  Eigen::VectorXd all =
      Eigen::VectorXd::Zero(LayoutOf(job.arm, job.data.references).size());
  all.head(deviations.size()) = deviations;
  return all;
}

void ReadPublished(const JobContext& context, JobConfig* job) {
  const std::optional<YamlValue> value = context.file.Optional("published");
  if (!value) return;
  const YamlMap map = value->Map({"source", "deviations", "angle_decimals",
                                  "length_decimals", "baseline", "figures"});
  PublishedStudy study;
  study.source = map.Required("source").Text();
  study.deviations = WithReferences(
      ReadDeviations(map.Required("deviations"), context.units, job->arm),
      *job);
  if (const auto decimals = map.Optional("angle_decimals")) {
    study.angle_decimals = static_cast<int>(decimals->Integer(0, kMaxDecimals));
  }
  if (const auto decimals = map.Optional("length_decimals")) {
    study.length_decimals =
        static_cast<int>(decimals->Integer(0, kMaxDecimals));
  }
  if (const auto baseline = map.Optional("baseline")) {
    ReadBaseline(*baseline, &study);
  }
  if (const auto figures = map.Optional("figures")) {
    study.figures = ReadFigures(*figures);
  }
  job->published = std::move(study);
}

// Identifiability is read last: its parameters are those of the arm and of
// what the data are measured against.
bool HasUnknownReferences(const References& references) {
  const auto is_unknown = [](const auto& reference) {
    return !reference.is_known;
  };
  return std::any_of(references.points.begin(), references.points.end(),
                     is_unknown) ||
         std::any_of(references.planes.begin(), references.planes.end(),
                     is_unknown);
}

// The published rules know joint parameters alone.
void CheckMethod(const JobContext& context, const JobConfig& job) {
  if (job.options.identifiability.method != IdentifiabilityMethod::kRules)
    return;
  if (!HasUnknownReferences(job.data.references)) return;
  context.file.Required("identifiability")
      .Fail(
          "method: rules identifies no points and planes, and some of these "
          "are not known: expected `method: rank`");
}

void ReadMeasurements(bool with_validation, JobContext* context,
                      JobConfig* job) {
  const MeasurementSigmas sigmas = ReadSigmas(*context, job);
  job->data.references = ReadReferences(*context);
  LoadedData loaded =
      ReadData(context->file.Required("data"), sigmas, context, job);
  job->data.training = std::move(loaded.data);
  if (with_validation) ReadValidation(sigmas, loaded.sets, context, job);
  constexpr double kMustBeStated = 0.0;
  ReadPointDistances(
      *context, job->options.estimate_sigma ? kMustBeStated : sigmas.length,
      job);
  const ParameterLayout layout = LayoutOf(job->arm, job->data.references);
  ReadIdentifiability(*context, layout, &job->options.identifiability);
  CheckMethod(*context, *job);
  job->options.bounds = ReadBounds(
      *context, layout, NominalValues(job->arm, job->data.references));
}

void ReadTruth(JobContext* context, JobConfig* job) {
  const std::optional<YamlValue> value = context->file.Optional("truth");
  if (!value) return;
  if (HasUnknownReferences(job->data.references)) {
    value->Fail(
        "the true arm is given, but not the true points and planes that "
        "the data are measured against: expected `known: true` of each");
  }
  const Eigen::VectorXd deviations = context->files.Read(
      *value,
      [&](const std::string& path) { return LoadDeviations(path, job->arm); });
  job->options.true_values = NominalValues(job->arm, job->data.references) +
                             WithReferences(deviations, *job);
}

bool IsOnePositionPerPose(const Dataset& data) {
  return data.blocks.size() == 1 && data.blocks[0].poses.empty() &&
         data.blocks[0].kind == MeasurementKind::kPosition &&
         data.num_equations() == data.num_rows();
}

void ReadNoiseStudy(const JobContext& context, JobConfig* job) {
  const std::optional<YamlValue> value = context.file.Optional("noise_study");
  if (!value) return;
  const YamlMap map = value->Map({"trials", "workspace_poses", "seed"});
  if (!job->options.true_values) {
    map.Fail("a noise study compares with the real arm, expected `truth` too");
  }
  if (!IsOnePositionPerPose(job->data.training)) {
    map.Fail("a noise study takes data sets of one position per pose");
  }
  NoiseStudyConfig study;
  map.ReadInteger("trials", &study.trials);
  map.ReadInteger("workspace_poses", &study.workspace_poses);
  map.ReadSeed("seed", &study.seed);
  if (study.trials < 1 || study.workspace_poses < 1) {
    map.Fail("trials and workspace_poses must be 1 or more");
  }
  job->noise_study = study;
}

// What asks for all data in one place.
void RefuseForMany(const JobContext& context, const JobConfig& job) {
  const int num_ranks = job.communicator->size();
  if (num_ranks == 1) return;
  const auto refuse = [&](const YamlValue& value, const std::string& what) {
    value.Fail(what + " needs all data in one process, and this job runs in " +
               std::to_string(num_ranks) +
               ": leave it out, or run without mpirun");
  };
  if (const auto compared = context.file.Optional("compare_with")) {
    refuse(*compared, "compare_with");
  }
  if (job.options.solver == SolverName::kPseudoInverse) {
    refuse(context.file.Required("solver"), "the pseudo-inverse");
  }
  if (job.options.solver_options.evaluation == Evaluation::kAutodiff) {
    refuse(context.file.Required("solver"), "evaluation: autodiff");
  }
  if (const auto validation = context.file.Optional("validation")) {
    if (validation->Find("folds")) refuse(*validation, "cross-validation");
  }
}

std::vector<int> ReadersOf(const JobContext& context, const JobConfig& job) {
  std::vector<int> readers;
  if (job.communicator->size() == 1) return readers;
  for (const std::string& path : context.files.paths()) {
    const auto found = context.readers.find(path);
    readers.push_back(found == context.readers.end() ? 0 : found->second);
  }
  return readers;
}

void ReadOutputs(const JobContext& context, JobConfig* job) {
  const std::optional<YamlValue> value = context.file.Optional("outputs");
  if (!value) return;
  const std::string name = value->Choice("outputs", {"full", "minimal"});
  job->outputs = name == "full" ? JobOutputs::kFull : JobOutputs::kMinimal;
}

JobConfig Load(const YamlValue& root, bool with_validation,
               const Execution& execution) {
  const YamlMap file = root.Map(JobKeys());
  JobContext context{file, Units(file), NamedFiles(root.document()),
                     execution.num_threads};
  JobConfig job;
  job.path = root.document().files.front();
  job.options.num_threads = execution.num_threads;
  job.communicator = execution.communicator;
  job.title = file.Required("title").Text();
  job.arm = context.files.ReadArm(file.Required("arm"), LoadArm);
  ReadSolver(context, &job);
  ReadRobust(context, &job);
  ReadCompareWith(context, &job);
  RefuseForMany(context, job);
  ReadMeasurements(with_validation, &context, &job);
  ReadTruth(&context, &job);
  ReadAcceptance(context, with_validation, &job);
  ReadPublished(context, &job);
  ReadNoiseStudy(context, &job);
  ReadUncertaintyOptions(context, &job);
  ReadMonteCarlo(context, &job);
  ReadOutputs(context, &job);
  job.input_files = context.files.paths();
  job.readers = ReadersOf(context, job);
  return job;
}

// One job, not the many of a matrix.
YamlValue ReadOneJob(const std::string& path) {
  YamlValue root = RootOf(ReadJobTree(path));
  if (const auto matrix = root.Find("matrix")) {
    matrix->Fail("a matrix is many jobs, expected one: `alidade batch " + path +
                 "` runs them all");
  }
  return root;
}

}  // namespace

const std::vector<std::string>& PublishedQuantityNames() {
  static const auto* const names = new std::vector<std::string>{
      "before_range",           "after_max",           "error_at_iteration_4",
      "error_at_iteration_100", "time_100_iterations", "identified",
      "not_identified",         "validation_after",    "as_printed"};
  return *names;
}

JobConfig LoadJobTree(YamlDocument tree, const Execution& execution) {
  return Load(RootOf(std::move(tree)), true, execution);
}

JobConfig LoadJob(const std::string& path, const Execution& execution) {
  return Load(ReadOneJob(path), true, execution);
}

JobConfig LoadWholeJob(const std::string& path) {
  return Load(ReadOneJob(path), false, {});
}

}  // namespace alidade::internal
