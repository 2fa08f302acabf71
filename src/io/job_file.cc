#include "alidade/io/job_file.h"

#include <algorithm>
#include <utility>

#include "alidade/io/arm_file.h"
#include "alidade/io/dataset_csv.h"
#include "alidade/measurement/holdout.h"
#include "alidade/model/parameter_layout.h"
#include "src/io/config_file.h"
#include "src/io/names.h"
#include "src/io/yaml_reader.h"

namespace alidade {
namespace {

constexpr int kMaxDecimals = 15;

// What every part of a job file needs to be read.
struct Context {
  YamlMap file;
  Units units;
  NamedFiles files;
};

template <typename Options>
void CheckOptions(const Options& options, const YamlMap& map) {
  std::string error;
  if (!options.IsValid(&error)) map.Fail(error);
}

SolverName ReadSolverName(const YamlValue& value) {
  const std::string name = value.Choice("solver", {"ceres", "pseudo_inverse"});
  return name == "ceres" ? SolverName::kCeres : SolverName::kPseudoInverse;
}

std::vector<std::string> ReadParameterNames(const YamlValue& value,
                                            const Arm& arm) {
  const ParameterLayout layout(arm.num_joints());
  std::vector<std::string> names;
  for (const Parameter& parameter : layout.parameters()) {
    names.push_back(parameter.name);
  }
  std::vector<std::string> chosen;
  for (const YamlValue& item : value.List()) {
    const std::string name = item.Choice("parameter", names);
    if (std::find(chosen.begin(), chosen.end(), name) != chosen.end()) {
      item.Fail(Quote(name) + " is repeated, expected each name once");
    }
    chosen.push_back(name);
  }
  return chosen;
}

// A parameter cannot be both held and free.
void CheckDisjoint(const IdentifiabilityOptions& options, const YamlMap& map) {
  for (const std::string& name : options.fix) {
    for (const auto* list : {&options.free, &options.prefer}) {
      if (std::find(list->begin(), list->end(), name) == list->end()) continue;
      map.Fail(Quote(name) + " stands in `fix` and in `" +
               (list == &options.free ? "free" : "prefer") +
               "`, expected in one of them");
    }
  }
}

// What the published rules do not know is not read over in silence.
void CheckMethod(const IdentifiabilityOptions& options, const YamlMap& map) {
  if (options.method == IdentifiabilityMethod::kRank) return;
  if (!options.prefer.empty() || !options.free.empty()) {
    map.Fail("`prefer` and `free` go with `method: rank`");
  }
  if (options.candidates.base || options.candidates.tool ||
      !options.candidates.joints) {
    map.Fail("`parameters` other than [joints] go with `method: rank`");
  }
  if (options.policy == WeakPolicy::kFreeze) {
    map.Fail("`policy: freeze` goes with `method: rank`");
  }
}

WeakPolicy ReadPolicy(const YamlValue& value) {
  const std::string name = value.Choice("policy", {"freeze", "prior", "keep"});
  if (name == "freeze") return WeakPolicy::kFreeze;
  return name == "prior" ? WeakPolicy::kPrior : WeakPolicy::kKeep;
}

CandidateGroups ReadCandidates(const YamlValue& value) {
  CandidateGroups groups{false, false, false};
  for (const YamlValue& item : value.List()) {
    const std::string name =
        item.Choice("group of parameters", {"joints", "base", "tool"});
    bool& group = name == "joints" ? groups.joints
                  : name == "base" ? groups.base
                                   : groups.tool;
    if (group) item.Fail(Quote(name) + " is repeated, expected once");
    group = true;
  }
  if (!groups.joints && !groups.base && !groups.tool) {
    value.Fail("the list is empty, expected some of joints, base and tool");
  }
  return groups;
}

void ReadPriors(const Context& context, const YamlMap& identifiability,
                PriorTolerances* priors) {
  const std::optional<YamlValue> value = identifiability.Optional("priors");
  if (!value) return;
  const std::vector<std::tuple<const char*, Dimension, double*>> fields = {
      {"beta", Dimension::kAngle, &priors->beta},
      {"alpha", Dimension::kAngle, &priors->alpha},
      {"d", Dimension::kLength, &priors->d},
      {"theta", Dimension::kAngle, &priors->theta},
      {"r", Dimension::kLength, &priors->r},
      {"frame_length", Dimension::kLength, &priors->frame_length},
      {"frame_angle", Dimension::kAngle, &priors->frame_angle}};
  std::vector<std::string> keys;
  for (const auto& field : fields) keys.emplace_back(std::get<0>(field));
  const YamlMap map = value->Map(keys);
  for (const auto& [key, dimension, target] : fields) {
    if (const auto entry = map.Optional(key)) {
      *target = entry->Quantity(dimension, context.units);
    }
  }
  CheckOptions(*priors, map);
}

void ReadIdentifiability(const Context& context, const Arm& arm,
                         IdentifiabilityOptions* options) {
  const std::optional<YamlValue> value =
      context.file.Optional("identifiability");
  if (!value) return;
  const YamlMap map =
      value->Map({"method", "policy", "parameters", "fix", "prefer", "free",
                  "priors", "proceed_beyond_rank", "angle_tolerance",
                  "relative_tolerance", "perturbation", "seed"});
  if (const auto method = map.Optional("method")) {
    options->method = method->Choice("method", {"rules", "rank"}) == "rules"
                          ? IdentifiabilityMethod::kRules
                          : IdentifiabilityMethod::kRank;
  }
  if (const auto policy = map.Optional("policy")) {
    options->policy = ReadPolicy(*policy);
  }
  if (const auto groups = map.Optional("parameters")) {
    options->candidates = ReadCandidates(*groups);
  }
  for (const auto& [key, names] :
       {std::pair("fix", &options->fix), std::pair("prefer", &options->prefer),
        std::pair("free", &options->free)}) {
    if (const auto list = map.Optional(key)) {
      *names = ReadParameterNames(*list, arm);
    }
  }
  CheckDisjoint(*options, map);
  CheckMethod(*options, map);
  ReadPriors(context, map, &options->priors);
  map.ReadBoolean("proceed_beyond_rank", &options->proceed_beyond_rank);
  if (const auto tolerance = map.Optional("angle_tolerance")) {
    options->angle_tolerance =
        tolerance->Quantity(Dimension::kAngle, context.units);
  }
  map.ReadNumber("relative_tolerance", &options->relative_tolerance);
  map.ReadNumber("perturbation", &options->perturbation);
  map.ReadSeed("seed", &options->seed);
  CheckOptions(*options, map);
}

void ReadSolver(const Context& context, JobConfig* job) {
  const std::optional<YamlValue> value = context.file.Optional("solver");
  if (!value) return;
  const YamlMap map =
      value->Map({"name", "max_iterations", "function_tolerance",
                  "rounding_floor_factor", "wanted_precision",
                  "initial_trust_region_radius", "pseudo_inverse_tolerance"});
  SolverOptions& options = job->solver_options;
  if (const auto name = map.Optional("name")) {
    job->solver = ReadSolverName(*name);
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
  CheckOptions(options, map);
}

void ReadRobust(const Context& context, JobConfig* job) {
  const std::optional<YamlValue> value = context.file.Optional("robust");
  if (!value) return;
  const YamlValue loss = value->Map({"loss"}).Required("loss");
  const std::string name =
      loss.Choice("loss", {"none", "huber", "cauchy", "tukey"});
  if (name == "huber") job->loss = LossKind::kHuber;
  if (name == "cauchy") job->loss = LossKind::kCauchy;
  if (name == "tukey") job->loss = LossKind::kTukey;
  if (job->loss != LossKind::kNone && job->solver != SolverName::kCeres) {
    loss.Fail(
        "the pseudo-inverse is least squares: a robust loss goes with "
        "`solver: {name: ceres}`");
  }
}

void ReadCompareWith(const Context& context, JobConfig* job) {
  const std::optional<YamlValue> value = context.file.Optional("compare_with");
  if (!value) return;
  for (const YamlValue& item : value->List()) {
    const SolverName name = ReadSolverName(item);
    const std::vector<SolverName>& known = job->compare_with;
    if (name == job->solver ||
        std::find(known.begin(), known.end(), name) != known.end()) {
      item.Fail("solver " + Quote(item.Text()) +
                " runs already, expected each solver once");
    }
    job->compare_with.push_back(name);
  }
}

void ReadAcceptance(const Context& context, JobConfig* job) {
  const std::optional<YamlValue> value = context.file.Optional("acceptance");
  if (!value) return;
  const YamlMap map =
      value->Map({"train_rms", "train_max", "heldout_rms", "heldout_max"});
  const auto read = [&](const std::string& key, std::optional<double>* limit) {
    const std::optional<YamlValue> found = map.Optional(key);
    if (!found) return;
    if (key.rfind("heldout", 0) == 0 && !job->validation) {
      found->Fail("needs poses that the fit does not use: add \"validation\"");
    }
    *limit = PositiveLength(*found, context.units);
  };
  read("train_rms", &job->acceptance.train_rms);
  read("train_max", &job->acceptance.train_max);
  read("heldout_rms", &job->acceptance.heldout_rms);
  read("heldout_max", &job->acceptance.heldout_max);
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

void ReadPublished(const Context& context, JobConfig* job) {
  const std::optional<YamlValue> value = context.file.Optional("published");
  if (!value) return;
  const YamlMap map = value->Map({"source", "deviations", "angle_decimals",
                                  "length_decimals", "baseline", "figures"});
  PublishedStudy study;
  study.source = map.Required("source").Text();
  study.deviations =
      ReadDeviations(map.Required("deviations"), context.units, job->arm);
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

// A first guess of a sigma that is to be estimated: what an arm's calibration
// commonly leaves. Only the ratio to the priors hangs on it, until the
// estimate replaces it.
constexpr double kFirstSigma = 1e-4;

double ReadSigma(const Context& context, JobConfig* job) {
  const YamlValue sigma =
      context.file.Required("measurement").Map({"sigma"}).Required("sigma");
  if (sigma.Text() == "estimate") {
    job->estimate_sigma = true;
    return kFirstSigma;
  }
  return PositiveLength(sigma, context.units);
}

std::vector<std::string> ReadHeaders(const YamlValue& value, std::size_t size,
                                     const std::string& what) {
  std::vector<std::string> headers;
  for (const YamlValue& item : value.List(size, what)) {
    headers.push_back(item.Text());
    if (std::count(headers.begin(), headers.end(), headers.back()) > 1) {
      item.Fail("column " + Quote(headers.back()) +
                " is repeated, expected each once");
    }
  }
  return headers;
}

ColumnMapping ReadMapping(const YamlValue& value, const Arm& arm) {
  const YamlMap map = value.Map({"joints", "position"});
  ColumnMapping mapping;
  if (const auto joints = map.Optional("joints")) {
    mapping.joints = ReadHeaders(*joints, arm.joints.size(),
                                 "the header of each joint's column");
  }
  if (const auto position = map.Optional("position")) {
    mapping.position = ReadHeaders(*position, 3, "the headers of x, y and z");
  }
  return mapping;
}

// A path, or `{file, columns}` where the headers are another program's.
Dataset ReadDataEntry(Context* context, const YamlValue& value, const Arm& arm,
                      double sigma) {
  if (!value.IsMap()) {
    return context->files.Read(value, [&](const std::string& path) {
      return LoadDataset(path, arm, sigma);
    });
  }
  const YamlMap map = value.Map({"file", "columns"});
  const ColumnMapping mapping = ReadMapping(map.Required("columns"), arm);
  return context->files.Read(
      map.Required("file"), [&](const std::string& path) {
        return LoadMappedDataset(path, arm, sigma, mapping);
      });
}

void HoldOutPoses(const YamlMap& validation, JobConfig* job) {
  HoldOutConfig config;
  const YamlValue fraction = validation.Required("fraction");
  config.fraction = fraction.Number();
  if (!(config.fraction > 0.0 && config.fraction < 1.0)) {
    fraction.Fail("expected a fraction between 0 and 1, found " +
                  fraction.Text());
  }
  validation.ReadSeed("seed", &config.seed);
  HoldOut split = HoldOutFraction(job->data, config.fraction, config.seed);
  if (split.train.num_poses() == 0 || split.heldout.num_poses() == 0) {
    fraction.Fail(
        "leaves no configuration on one side: the data set has too few "
        "different ones for it");
  }
  job->data = std::move(split.train);
  job->validation = std::move(split.heldout);
  job->holdout = config;
}

void ReadValidation(Context* context, double sigma, JobConfig* job) {
  const std::optional<YamlValue> value = context->file.Optional("validation");
  if (!value) return;
  const YamlMap map = value->Map({"data", "fraction", "seed"});
  const std::optional<YamlValue> data = map.Optional("data");
  const bool draws = map.Optional("fraction") || map.Optional("seed");
  if (data && draws) {
    map.Fail("expected `data`, or `fraction` and `seed`, not both");
  }
  if (data) {
    job->validation = ReadDataEntry(context, *data, job->arm, sigma);
  } else {
    HoldOutPoses(map, job);
  }
}

void ReadData(Context* context, JobConfig* job) {
  const double sigma = ReadSigma(*context, job);
  job->data =
      ReadDataEntry(context, context->file.Required("data"), job->arm, sigma);
  ReadValidation(context, sigma, job);
}

void ReadTruth(Context* context, JobConfig* job) {
  const std::optional<YamlValue> value = context->file.Optional("truth");
  if (!value) return;
  const Eigen::VectorXd deviations = context->files.Read(
      *value,
      [&](const std::string& path) { return LoadDeviations(path, job->arm); });
  const ParameterLayout layout(job->arm.num_joints());
  job->truth = layout.Values(job->arm) + deviations;
}

void ReadNoiseStudy(const Context& context, JobConfig* job) {
  const std::optional<YamlValue> value = context.file.Optional("noise_study");
  if (!value) return;
  const YamlMap map = value->Map({"trials", "workspace_poses", "seed"});
  if (!job->truth) {
    map.Fail("a noise study compares with the real arm, expected `truth` too");
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

}  // namespace

const std::vector<std::string>& PublishedQuantityNames() {
  static const auto* const names = new std::vector<std::string>{
      "before_range",           "after_max",           "error_at_iteration_4",
      "error_at_iteration_100", "time_100_iterations", "identified",
      "not_identified",         "validation_after",    "as_printed"};
  return *names;
}

JobConfig LoadJob(const std::string& path) {
  const YamlMap file =
      ReadConfigFile(path, FileFormat::kJob)
          .Map({"format", "title", "units", "arm", "data", "measurement",
                "truth", "validation", "identifiability", "solver", "robust",
                "compare_with", "acceptance", "published", "noise_study"});
  Context context{file, Units(file), NamedFiles(path)};
  JobConfig job;
  job.path = path;
  job.title = file.Required("title").Text();
  job.arm = context.files.ReadArm(file.Required("arm"));
  ReadIdentifiability(context, job.arm, &job.identifiability);
  ReadSolver(context, &job);
  ReadRobust(context, &job);
  ReadCompareWith(context, &job);
  ReadData(&context, &job);
  ReadTruth(&context, &job);
  ReadAcceptance(context, &job);
  ReadPublished(context, &job);
  ReadNoiseStudy(context, &job);
  job.input_files = context.files.paths();
  return job;
}

}  // namespace alidade
