#include "alidade/option_text.h"

#include <utility>

#include "src/serialization/data_section.h"
#include "src/serialization/job_options.h"
#include "src/serialization/plan_file.h"
#include "src/serialization/references_section.h"
#include "src/serialization/workspace_boxes.h"
#include "src/serialization/yaml_reader.h"
#include "src/simulation/monte_carlo_fields.h"

namespace alidade {
namespace {

// The file that messages name.
constexpr char kTextName[] = "options";

}  // namespace

namespace internal {
namespace {

// Poses to hold out, as far as they are drawn.
template <typename Visitor>
void VisitDrawnValidation(Visitor& v, HoldOutOptions* holdout,
                          FoldsOptions* folds, CalibrationOptions* options) {
  VisitFields(v, *holdout);
  VisitFields(v, *folds);
  v.Field(Key("seed"), holdout->seed,
          "of the configurations that `fraction` or `folds` draw");
  v.Check([=](const YamlMap& map) {
    if (map.Optional("fraction").has_value() ==
        map.Optional("folds").has_value()) {
      map.Fail("expected `fraction` or `folds`, one of them");
    }
    options->holdout.reset();
    options->folds.reset();
    if (map.Optional("fraction")) {
      options->holdout = *holdout;
    } else {
      options->folds = FoldsOptions{folds->folds, holdout->seed};
    }
  });
}

template <typename Visitor>
void VisitOptions(Visitor& v, JobConfig* job) {
  CalibrationOptions& options = job->options;
  v.Field(Key("estimate_sigma"), options.estimate_sigma,
          "the sigmas of lengths and of orientations are estimated from the "
          "residuals of the fit; those of the data are a first guess");
  VisitSolvers(v, job);
  VisitIdentification(v, job);
  v.Section(Key("validation"), "poses of the data that the fit does not use",
            [&options](auto& section) {
              HoldOutOptions holdout;
              FoldsOptions folds;
              VisitDrawnValidation(section, &holdout, &folds, &options);
            });
  v.Section(Key("acceptance"), "limits that the result is to keep",
            options.acceptance);
  v.Section(
      Key("uncertainty"), "how far the result is to be trusted",
      [&](auto& section) { VisitUncertainty(section, &options.uncertainty); });
}

OptionDescription Describe(const FieldRecord& field) {
  OptionDescription option;
  option.name = field.key.name;
  option.text = field.text;
  constexpr std::array kTypes = {"number", "integer", "boolean", "text",
                                 "word",   "section", "items",   "value"};
  option.type = kTypes[static_cast<std::size_t>(field.kind)];
  option.default_value = field.key.default_words != nullptr
                             ? field.key.default_words
                             : field.default_value;
  option.range = field.key.Range();
  if (field.key.unit_words != nullptr) {
    option.unit = field.key.unit_words;
  } else if (field.key.dimension) {
    const bool is_length = *field.key.dimension == Dimension::kLength;
    option.unit = is_length ? "length" : "angle";
  }
  option.is_required = field.key.is_required;
  option.words = field.words;
  for (const FieldRecord& part : field.fields) {
    option.fields.push_back(Describe(part));
  }
  return option;
}

std::vector<OptionDescription> DescribeAll(
    const std::vector<FieldRecord>& fields) {
  std::vector<OptionDescription> options;
  for (const FieldRecord& field : fields) options.push_back(Describe(field));
  return options;
}

// read(value, units) of the options of a text.
template <typename Read>
void ReadText(const std::string& text, const Read& read) {
  const YamlMap root = ParseYaml(text, kTextName).Map({"units", "options"});
  read(root.Required("options"), Units(root));
}

}  // namespace
}  // namespace internal

std::vector<OptionDescription> OptionsOfCalibration() {
  internal::JobConfig job;
  return internal::DescribeAll(internal::CollectFields(
      [&job](auto& v) { internal::VisitOptions(v, &job); }));
}

void ReadOptions(const std::string& text, const Arm& arm,
                 const References& references, CalibrationOptions* options) {
  internal::JobConfig job;
  job.arm = arm;
  job.data.references = references;
  job.options = *options;
  internal::ReadText(text, [&job](const auto& value, const auto& units) {
    internal::ReadFields(value, units,
                         [&job](auto& v) { internal::VisitOptions(v, &job); });
  });
  *options = std::move(job.options);
}

std::vector<OptionDescription> OptionsOfMonteCarlo() {
  MonteCarloOptions options;
  return internal::DescribeAll(internal::CollectFields(
      [&options](auto& v) { VisitFields(v, options); }));
}

void ReadOptions(const std::string& text, MonteCarloOptions* options) {
  internal::ReadText(text, [options](const auto& value, const auto& units) {
    internal::ReadFields(value, units,
                         [options](auto& v) { VisitFields(v, *options); });
  });
}

std::vector<OptionDescription> OptionsOfPlan() {
  return internal::DescribeAll(internal::PlanOptionFields());
}

void ReadOptions(const std::string& text, const Arm& arm,
                 const References& references, PlanOptions* options,
                 CalibrationOptions* calibration) {
  internal::PlanConfig plan;
  static_cast<PlanOptions&>(plan) = *options;
  plan.job.arm = arm;
  plan.job.data.references = references;
  plan.job.options = *calibration;
  internal::ReadText(text, [&plan](const auto& value, const auto& units) {
    internal::ReadPlanOptions(value, units, &plan);
  });
  *options = static_cast<PlanOptions&&>(plan);
  *calibration = std::move(plan.job.options);
}

std::vector<OptionDescription> OptionsOfData() {
  return internal::DescribeAll(internal::DataFields());
}

LoadedMeasurements LoadMeasurements(const std::string& text, const Arm& arm,
                                    int num_threads) {
  using internal::Key;
  internal::JobConfig job;
  job.arm = arm;
  const internal::YamlValue root = internal::ParseYaml(text, kTextName);
  internal::JobContext context{
      internal::Units(root.Map({"units", "measurement", "references", "data"})),
      internal::NamedFiles(kTextName), num_threads};
  internal::MeasurementSigmas sigmas;
  internal::StatedReferences references;
  LoadedMeasurements loaded;
  internal::ReadFields(root, context.units, [&](auto& v) {
    std::optional<internal::YamlValue> units;
    v.Field(Key("units").Required(), units, "");
    v.Section(Key("measurement").Required(), "", [&](auto& section) {
      VisitMeasurement(section, &sigmas, &job.options.estimate_sigma);
    });
    v.Section(Key("references"), "",
              [&](auto& section) { VisitReferences(section, &references); });
    v.Custom(Key("data").Required(), "", [&](const auto& value) {
      job.data.references = references.references;
      internal::LoadedData data =
          ReadData(value, sigmas, &loaded.first_station, &context, &job);
      job.data.training = std::move(data.data);
      loaded.uses = std::move(data.uses);
      loaded.sets = std::move(data.sets);
    });
  });
  loaded.are_sigmas_stated =
      !job.options.estimate_sigma || AreStated(sigmas, job.data.training);
  AppendDistances(references.distances,
                  job.options.estimate_sigma ? 0.0 : sigmas.length, &job);
  loaded.data = std::move(job.data.training);
  loaded.references = std::move(job.data.references);
  loaded.rejected = std::move(job.rejected);
  return loaded;
}

}  // namespace alidade
