#include "src/serialization/validation_section.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <utility>

#include "src/calibration/data_split.h"
#include "src/common/bytes.h"
#include "src/common/names.h"
#include "src/common/numbers.h"
#include "src/kernel/partition.h"
#include "src/serialization/partitioned_data.h"

namespace alidade::internal {
namespace {

void Take(HoldOut split, JobConfig* job) {
  job->data.training = std::move(split.train);
  job->data.validation = std::move(split.validation);
}

void TakeFraction(const YamlValue& fraction, const HoldOutOptions& options,
                  JobConfig* job) {
  try {
    Take(SplitData(job->data.training, options, job->communicator), job);
  } catch (const InputError& error) {
    // Here it is the key that the message begins with.
    const std::string key = "holdout.fraction ";
    const std::string& message = error.message();
    fraction.Fail(message.rfind(key, 0) == 0 ? message.substr(key.size())
                                             : message);
  }
  job->options.holdout = options;
}

void TakeFolds(const YamlValue& folds, const FoldsOptions& options,
               JobConfig* job) {
  const std::vector<int> groups = GroupByConfiguration(job->data.training);
  const int count = 1 + *std::max_element(groups.begin(), groups.end());
  if (options.folds > count) {
    folds.Fail("the data set has " + std::to_string(count) +
               " different configurations, expected as many folds at most");
  }
  job->options.folds = options;
}

// A difference of a pose that is held out and one that is not belongs to
// neither side.
void RejectStraddling(const std::vector<bool>& is_validation, JobConfig* job) {
  const Dataset& data = job->data.training;
  std::vector<RejectedRow> rejected;
  for (const ObservationBlock& block : data.blocks) {
    if (block.kind != MeasurementKind::kDifference) continue;
    for (Eigen::Index i = 0; i < block.size(); ++i) {
      const int pose = block.pose(i);
      if (is_validation[pose] == is_validation[block.seconds[i]]) continue;
      const PoseSource source = data.sources[pose];
      rejected.push_back(
          {data.files[source.file], source.line,
           "a difference between a pose that is held out and one that is not"});
    }
  }
  rejected = OfAllRanks(job->communicator, rejected);
  job->rejected.insert(job->rejected.end(), rejected.begin(), rejected.end());
}

// Holds out the poses, unless that leaves nothing to fit.
void HoldOutChosen(const std::vector<bool>& is_validation, const YamlValue& key,
                   JobConfig* job) {
  const bool are_all = std::all_of(is_validation.begin(), is_validation.end(),
                                   [](bool held) { return held; });
  if (OnAllRanks(job->communicator, job->data.training, are_all)) {
    key.Fail("holds out all poses, expected some to be left for the fit");
  }
  RejectStraddling(is_validation, job);
  Take(HoldOutPoses(job->data.training, is_validation, job->communicator), job);
}

// In the order that they first come in.
std::vector<std::string> NamesOfSets(const std::vector<std::string>& sets,
                                     Communicator* communicator) {
  std::vector<std::string> names;
  for (const std::string& set : sets) {
    const bool is_new =
        std::find(names.begin(), names.end(), set) == names.end();
    if (is_new && !set.empty()) names.push_back(set);
  }
  return DistinctTexts(communicator, names);
}

void ReadSets(const YamlValue& value, const std::vector<std::string>& sets,
              JobConfig* job) {
  if (OnAllRanks(job->communicator, job->data.training, sets.empty())) {
    value.Fail("no data set has a column \"set\", expected one");
  }
  const std::vector<std::string> names = NamesOfSets(sets, job->communicator);
  std::vector<bool> is_validation(sets.size(), false);
  std::vector<YamlValue> items = {value};
  if (value.IsList()) items = value.List();
  if (items.empty()) value.Fail("the list is empty, expected names of sets");
  for (const YamlValue& item : items) {
    const std::string name = item.Choice("set", names);
    for (std::size_t i = 0; i < sets.size(); ++i) {
      if (sets[i] == name) is_validation[i] = true;
    }
  }
  HoldOutChosen(is_validation, value, job);
}

// Whether the text names the job's data file number i (from 0): by its place in
// the list, its path, or its name without folders.
bool NamesFile(const std::string& text, const std::string& resolved,
               const Dataset& data, int i) {
  const std::optional<int> index = ParseWhole<int>(text);
  if (index) return *index == i + 1;
  const std::string& path = data.files[i];
  return path == resolved ||
         std::filesystem::path(path).filename().string() == text;
}

void ReadFile(const YamlValue& value, const JobContext& context,
              JobConfig* job) {
  const Dataset& data = job->data.training;
  const std::string text = value.Text();
  const std::string resolved = context.files.Resolve(value);
  std::vector<bool> is_validation;
  is_validation.reserve(data.sources.size());
  for (std::size_t pose = 0; pose < data.sources.size(); ++pose) {
    is_validation.push_back(
        NamesFile(text, resolved, data, data.sources[pose].file));
  }
  const bool is_none = std::none_of(is_validation.begin(), is_validation.end(),
                                    [](bool held) { return held; });
  if (OnAllRanks(job->communicator, data, is_none)) {
    value.Fail(
        "found " + Quote(text) + ", expected one of the files of " +
        "`data` or its place in that list, from 1: " + JoinNames(data.files));
  }
  HoldOutChosen(is_validation, value, job);
}

}  // namespace

void CheckOneWay(const YamlMap& map) {
  int ways = 0;
  for (const auto& [key, value] : map.entries()) {
    if (key != "seed" && key != "by") ++ways;
  }
  const bool has_seed = map.Optional("seed").has_value();
  const bool draws = map.Optional("fraction") || map.Optional("folds");
  if (const std::optional<YamlValue> by = map.Optional("by");
      by && !map.Optional("fraction")) {
    by->Fail("says what `fraction` holds out, which is not there");
  }
  if (ways == 1 && (draws || !has_seed)) return;
  map.Fail(
      "expected `data`, or `fraction` and `seed`, or `folds` and `seed`, or "
      "`set`, or `file`, not both");
}

void TakeValidation(const YamlMap& map, const StatedValidation& stated,
                    const MeasurementSigmas& sigmas,
                    const std::vector<std::string>& sets, JobContext* context,
                    JobConfig* job) {
  if (stated.data) {
    std::string first_station = stated.first_station;
    job->data.validation =
        ReadData(*stated.data, sigmas, &first_station, context, job).data;
  } else if (const auto value = map.Optional("folds")) {
    TakeFolds(*value, {stated.folds.folds, stated.holdout.seed}, job);
  } else if (stated.set) {
    ReadSets(*stated.set, sets, job);
  } else if (stated.file) {
    ReadFile(*stated.file, *context, job);
  } else {
    TakeFraction(map.Required("fraction"), stated.holdout, job);
  }
}

}  // namespace alidade::internal
