
#include <algorithm>
#include <utility>

#include "alidade/arm_file.h"
#include "alidade/parameter_layout.h"
#include "src/calibration/calibration_options_fields.h"
#include "src/common/names.h"
#include "src/serialization/config_file.h"
#include "src/serialization/data_section.h"
#include "src/serialization/field_records.h"
#include "src/serialization/job_config.h"
#include "src/serialization/job_options.h"
#include "src/serialization/job_tree.h"
#include "src/serialization/references_section.h"
#include "src/serialization/validation_section.h"
#include "src/serialization/workspace_boxes.h"
#include "src/serialization/yaml_reader.h"
#include "src/simulation/monte_carlo_fields.h"

namespace alidade::internal {

namespace {

// A job that is being read.
struct JobReading {
  JobContext* context;
  JobConfig* job;
  bool with_validation = true;
  MeasurementSigmas sigmas = {};
  StatedReferences references = {};
  std::vector<std::string> sets = {};
  StatedValidation validation = {};
};

// A limit of poses that the fit does not use needs some, one of orientations
// needs these. Without the validation that goes with them, limits of validation
// poses are passed over.
void CheckAcceptance(const YamlMap& map, bool with_validation, JobConfig* job) {
  AcceptanceLimits& limits = job->options.acceptance;
  if (!with_validation) {
    for (auto* limit :
         {&limits.validation_rms, &limits.validation_max,
          &limits.validation_rotation_rms, &limits.validation_rotation_max}) {
      limit->reset();
    }
  }
  const std::optional<Dataset>& validation = job->data.validation;
  for (const auto& [key, limit] : map.entries()) {
    const bool is_validation = key.rfind("train", 0) != 0;
    if (is_validation && !with_validation) continue;
    if (is_validation && !validation && !job->options.folds) {
      limit.Fail("needs poses that the fit does not use: add \"validation\"");
    }
    const Dataset& data =
        is_validation && validation ? *validation : job->data.training;
    if (key.find("rotation") == std::string::npos ||
        data.Has(MeasurementKind::kPose)) {
      continue;
    }
    limit.Fail(
        "no orientation is measured, expected limits of positions alone");
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

void ReadTrainingData(const YamlValue& value, JobReading* reading) {
  JobConfig* const job = reading->job;
  job->data.references = reading->references.references;
  LoadedData loaded =
      ReadData(value, reading->sigmas, &reading->validation.first_station,
               reading->context, job);
  job->data.training = std::move(loaded.data);
  job->options.sigmas_are_stated =
      AreStated(reading->sigmas, job->data.training);
  job->options.errors.uses = std::move(loaded.uses);
  reading->sets = std::move(loaded.sets);
}

void ReadTruth(const YamlValue& value, JobReading* reading) {
  JobConfig* const job = reading->job;
  if (HasUnknownReferences(job->data.references)) {
    value.Fail(
        "the true arm is given, but not the true points and planes that "
        "the data are measured against: expected `known: true` of each");
  }
  const Eigen::VectorXd deviations = reading->context->files.Read(
      value,
      [&](const std::string& path) { return LoadDeviations(path, job->arm); });
  job->options.true_values = NominalValues(job->arm, job->data.references) +
                             WithReferences(deviations, *job);
}

bool IsOnePositionPerPose(const Dataset& data) {
  return data.blocks.size() == 1 && data.blocks[0].poses.empty() &&
         data.blocks[0].kind == MeasurementKind::kPosition &&
         data.num_equations() == data.num_rows();
}

void CheckNoiseStudy(const YamlMap& map, const JobConfig& job) {
  if (!job.options.true_values) {
    map.Fail("a noise study compares with the real arm, expected `truth` too");
  }
  if (!IsOnePositionPerPose(job.data.training)) {
    map.Fail("a noise study takes data sets of one position per pose");
  }
}

void CheckMonteCarlo(const YamlMap& map, const JobConfig& job) {
  if (job.montecarlo.truth != SimulatedTruth::kGiven ||
      job.options.true_values) {
    return;
  }
  map.Required("truth").Fail(
      "no `truth` is given in this job, expected `identified` or "
      "`priors`, or the real arm as the job's `truth`");
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

template <typename Visitor>
void VisitMeasurements(Visitor& v, JobReading* reading) {
  JobConfig* const job = reading->job;
  v.Section(Key("measurement").Required(), "how well was measured",
            [&](auto& section) {
              VisitMeasurement(section, &reading->sigmas,
                               &job->options.estimate_sigma);
            });
  v.Section(
      Key("references"),
      "points and planes that the data are measured against "
      "(\"References of a job\", below)",
      [&](auto& section) { VisitReferences(section, &reading->references); });
  v.Custom(Key("data").Required().Schema(kDataSchema),
           "what to fit: a path, or a map where more is to be said of the "
           "file, or a list of both (\"Data of a job\", below)",
           [&](const YamlValue& value) { ReadTrainingData(value, reading); });
  v.Section(Key("validation"),
            "poses that the fit does not use; one of the five below",
            [&](auto& section) {
              VisitValidation(section, &reading->validation);
              section.Check([&](const YamlMap& map) {
                if (!reading->with_validation) return;
                TakeValidation(map, reading->validation, reading->sigmas,
                               reading->sets, reading->context, job);
              });
            });
  v.Check([&](const YamlMap& /*map*/) {
    constexpr double kMustBeStated = 0.0;
    AppendDistances(
        reading->references.distances,
        job->options.estimate_sigma ? kMustBeStated : reading->sigmas.length,
        job);
  });
  VisitIdentification(v, job);
}

template <typename Visitor>
void VisitPublished(Visitor& v, JobReading* reading, PublishedStudy* study) {
  JobConfig* const job = reading->job;
  v.Field(Key("source").Required(), study->source, "title of the study");
  v.Custom(
      Key("deviations").In("the job's units").Required().Schema(kMapSchema),
      "as its table prints them: map from parameter names, 0 where left out",
      [&](const YamlValue& value, const Units& units) {
        study->deviations =
            WithReferences(ReadDeviations(value, units, job->arm), *job);
      });
  v.Field(Key("angle_decimals").AtLeast(0).AtMost(15), study->angle_decimals,
          "decimals of that table, of rad");
  v.Field(Key("length_decimals").AtLeast(0).AtMost(15), study->length_decimals,
          "decimals of that table, of mm");
  v.Section(Key("baseline"), "its algorithm", [&](auto& section) {
    section.Field(Key("iterations").AtLeast(1).AtMost(1000000).Required(),
                  study->baseline_iterations, "fixed number of iterations");
    section.Field(Key("time_s").In("s").Above(0).Required(),
                  study->baseline_time_s, "and the time that they took");
  });
  v.Custom(
      Key("figures").Default("`[]`").Schema(R"({"type": "array"})"),
      "list of `{quantity, published}`: a quantity below, and what the "
      "study says of it, in its words",
      [&](const YamlValue& value) { study->figures = ReadFigures(value); });
  v.Check([&](const YamlMap& /*map*/) { job->published = *study; });
}

template <typename Visitor>
void VisitStudies(Visitor& v, JobReading* reading) {
  JobConfig* const job = reading->job;
  v.Section(Key("published"), "what a publication says of the same calibration",
            [&](auto& section) {
              PublishedStudy study;
              VisitPublished(section, reading, &study);
            });
  v.Section(Key("noise_study"),
            "`compare` calibrates the poses of `data` again and again with "
            "fresh noise of their sigmas; needs `truth`",
            [&](auto& section) {
              NoiseStudyConfig study;
              VisitFields(section, study);
              section.Check([&](const YamlMap& map) {
                CheckNoiseStudy(map, *job);
                job->noise_study = study;
              });
            });
  v.Section(Key("uncertainty"), "how far the result is to be trusted",
            [&](auto& section) {
              VisitUncertainty(section, &job->options.uncertainty);
            });
  v.Check([&](const YamlMap& /*map*/) {
    if (job->options.true_values) {
      job->montecarlo.truth = SimulatedTruth::kGiven;
    }
  });
  v.Section(
      Key("montecarlo"), "what `alidade montecarlo` simulates",
      [&](auto& section) {
        VisitFields(section, job->montecarlo);
        section.Check([&](const YamlMap& map) { CheckMonteCarlo(map, *job); });
      });
}

// In the order of reading: data are read as the arm and the sigmas ask, and
// parameters are those of the arm and of what the data are measured against.
template <typename Visitor>
void VisitJob(Visitor& v, JobReading* reading) {
  JobConfig* const job = reading->job;
  VisitHead(v, FileFormat::kJob);
  v.Field(Key("title").Required(), job->title, "heads the report");
  v.Custom(PathKey("arm").Required(),
           "the nominal arm: a file, or `robots/NAME` of those that `alidade "
           "robots` lists",
           [&](const YamlValue& value) {
             job->arm = reading->context->files.ReadArm(value, LoadArm);
           });
  VisitSolvers(v, job);
  VisitMeasurements(v, reading);
  v.Custom(PathKey("truth"),
           "deviations of the real arm, where it is known (a simulated one); "
           "the report compares, and base, tool and references start where the "
           "files state them, without a fit of these alone before",
           [&](const YamlValue& value) { ReadTruth(value, reading); });
  v.Section(Key("acceptance"),
            "limits; where one is missed, the exit status is 1",
            [&](auto& section) {
              VisitFields(section, job->options.acceptance);
              section.Check([&](const YamlMap& map) {
                CheckAcceptance(map, reading->with_validation, job);
              });
            });
  VisitStudies(v, reading);
  v.Field(Key("outputs"), job->outputs,
          "what the result directory holds: `full`, or `minimal`, `arm.yaml` "
          "and `result.json` alone");
}

std::vector<FieldRecord> FieldsOfJob() {
  JobConfig job;
  JobReading reading{nullptr, &job};
  return CollectFields([&](auto& v) { VisitJob(v, &reading); });
}

JobConfig Load(const YamlValue& root, bool with_validation,
               const Execution& execution) {
  JobContext context{Units(root.Map(JobKeys())), NamedFiles(root.document()),
                     execution.num_threads};
  JobConfig job;
  job.path = root.document().files.front();
  job.options.num_threads = execution.num_threads;
  job.communicator = execution.communicator;
  if (root.Find("format") &&
      root.Find("format")->Text() == WordOf(FileFormat::kJob)) {
    job.options.errors.selection = ErrorTermSelection::kAuto;
  }
  JobReading reading{&context, &job, with_validation};
  ReadFields(root, context.units, [&](auto& v) { VisitJob(v, &reading); });
  job.input_files = context.files.paths();
  job.readers = ReadersOf(context, job);
  return job;
}

// One job, not the many of a matrix.
YamlValue ReadOneJob(const YamlValue& file) {
  YamlValue root = RootOf(ReadJobTree(file));
  if (const auto matrix = root.Find("matrix")) {
    matrix->Fail("a matrix is many jobs, expected one: `alidade batch " +
                 file.location().file + "` runs them all");
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

const std::vector<std::string>& JobKeys() {
  static const auto* const keys =
      new std::vector<std::string>(KeysOf(FieldsOfJob()));
  return *keys;
}

std::vector<FieldRecord> JobFields() {
  std::vector<FieldRecord> fields = CollectFields([](auto& v) {
    v.Custom(PathKey("extends"),
             "a job that this one is laid on; what it says need not be said "
             "again ([batch.md](batch.md))",
             ReadElsewhere);
    v.Custom(Key("matrix").Schema(kMapSchema),
             "values to combine, each combination a job; `alidade batch` alone "
             "reads it ([batch.md](batch.md))",
             ReadElsewhere);
  });
  const std::vector<FieldRecord> of_job = FieldsOfJob();
  fields.insert(fields.end(), of_job.begin(), of_job.end());
  return fields;
}

JobConfig LoadJobTree(YamlDocument tree, const Execution& execution) {
  return Load(RootOf(std::move(tree)), true, execution);
}

JobConfig ReadJob(const YamlValue& root, const Execution& execution) {
  return Load(ReadOneJob(root), true, execution);
}

JobConfig LoadJob(const std::string& path, const Execution& execution) {
  return ReadJob(ReadConfigFile(path, FileFormat::kJob), execution);
}

JobConfig LoadWholeJob(const std::string& path) {
  return Load(ReadOneJob(ReadConfigFile(path, FileFormat::kJob)), false, {});
}

}  // namespace alidade::internal
