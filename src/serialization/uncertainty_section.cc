#include "src/serialization/uncertainty_section.h"

#include <optional>
#include <string>

#include "src/common/names.h"
#include "src/serialization/config_file.h"

namespace alidade::internal {
namespace {

constexpr int kMostConfigurations = 1000000;
constexpr int kMostTrials = 100000000;

IntervalMethod ReadIntervals(const YamlValue& value) {
  const std::string name =
      value.Choice("intervals", {"auto", "linear", "profile"});
  if (name == "linear") return IntervalMethod::kLinear;
  return name == "profile" ? IntervalMethod::kProfile
                           : IntervalMethod::kAutomatic;
}

// A number above 0 and below 1.
double ReadFraction(const YamlValue& value) {
  const double fraction = value.Number();
  if (fraction > 0.0 && fraction < 1.0) return fraction;
  value.Fail("expected a number between 0 and 1, found " + value.Text());
}

SimulatedTruth ReadTruth(const YamlValue& value, const JobConfig& job) {
  const std::string name =
      value.Choice("truth", {"given", "identified", "priors"});
  if (name == "identified") return SimulatedTruth::kIdentified;
  if (name == "priors") return SimulatedTruth::kPriors;
  if (!job.options.true_values) {
    value.Fail(
        "no `truth` is given in this job, expected `identified` or "
        "`priors`, or the real arm as the job's `truth`");
  }
  return SimulatedTruth::kGiven;
}

void ReadOutliers(const YamlValue& value, const JobContext& context,
                  MonteCarloOptions* config) {
  const YamlMap map = value.Map({"fraction", "size"});
  config->outlier_fraction = ReadFraction(map.Required("fraction"));
  config->outlier_size = PositiveLength(map.Required("size"), context.units);
}

void ReadRepeatability(const YamlValue& value, const JobContext& context,
                       MonteCarloOptions* config) {
  const YamlMap map = value.Map({"angle", "length"});
  if (const auto angle = map.Optional("angle")) {
    config->joint_angle_sigma = PositiveAngle(*angle, context.units);
  }
  if (const auto length = map.Optional("length")) {
    config->joint_length_sigma = PositiveLength(*length, context.units);
  }
}

int ReadCount(const YamlValue& value, int least, int most) {
  return static_cast<int>(value.Integer(least, most));
}

}  // namespace

void ReadUncertaintyOptions(const JobContext& context, JobConfig* job) {
  const std::optional<YamlValue> value = context.file.Optional("uncertainty");
  if (!value) return;
  const YamlMap map = value->Map(
      {"confidence", "intervals", "nonlinearity_limit", "map", "seed"});
  UncertaintyOptions& options = job->options.uncertainty;
  if (const auto confidence = map.Optional("confidence")) {
    options.confidence = ReadFraction(*confidence);
  }
  if (const auto intervals = map.Optional("intervals")) {
    options.intervals = ReadIntervals(*intervals);
  }
  if (const auto limit = map.Optional("nonlinearity_limit")) {
    options.nonlinearity_limit = limit->Number();
    if (!(options.nonlinearity_limit > 0.0)) {
      limit->Fail("expected a number above 0, found " + limit->Text());
    }
  }
  if (const auto count = map.Optional("map")) {
    options.map_configurations = ReadCount(*count, 0, kMostConfigurations);
  }
  map.ReadSeed("seed", &options.seed);
}

void ReadMonteCarlo(const JobContext& context, JobConfig* job) {
  MonteCarloOptions& config = job->montecarlo;
  config.truth = job->options.true_values ? SimulatedTruth::kGiven
                                          : SimulatedTruth::kIdentified;
  const std::optional<YamlValue> value = context.file.Optional("montecarlo");
  if (!value) return;
  const YamlMap map =
      value->Map({"trials", "seed", "truth", "outliers", "joint_repeatability",
                  "workspace_poses", "precision"});
  if (const auto trials = map.Optional("trials")) {
    config.trials = ReadCount(*trials, 2, kMostTrials);
  }
  map.ReadSeed("seed", &config.seed);
  if (const auto truth = map.Optional("truth")) {
    config.truth = ReadTruth(*truth, *job);
  }
  if (const auto outliers = map.Optional("outliers")) {
    ReadOutliers(*outliers, context, &config);
  }
  if (const auto repeatability = map.Optional("joint_repeatability")) {
    ReadRepeatability(*repeatability, context, &config);
  }
  if (const auto poses = map.Optional("workspace_poses")) {
    config.workspace_poses = ReadCount(*poses, 1, kMostConfigurations);
  }
  if (const auto precision = map.Optional("precision")) {
    config.precision = ReadFraction(*precision);
  }
}

}  // namespace alidade::internal
