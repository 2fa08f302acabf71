#include "src/serialization/batch_json.h"

#include <array>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "alidade/error.h"
#include "src/common/files.h"
#include "src/serialization/result_keys.h"

namespace alidade::internal {
namespace {

using Json = nlohmann::ordered_json;

constexpr char kFormat[] = "alidade-batch-1";

constexpr std::array<std::pair<BatchStatus, const char*>, 5> kBatchStatusKeys =
    {{
        {BatchStatus::kNotRun, "not_run"},
        {BatchStatus::kDone, "done"},
        {BatchStatus::kMissedLimits, "missed_limits"},
        {BatchStatus::kBadInput, "bad_input"},
        {BatchStatus::kFailed, "failed"},
    }};

Json ToJson(const Accuracy& accuracy) {
  return {{"mean", accuracy.mean},     {"rms", accuracy.rms},
          {"stddev", accuracy.stddev}, {"median", accuracy.median},
          {"p95", accuracy.p95},       {"min", accuracy.min},
          {"max", accuracy.max},       {"n", accuracy.n}};
}

Json ToJson(const Accuracy& before, const Accuracy& after) {
  if (after.n == 0) return nullptr;
  return {{"before", ToJson(before)}, {"after", ToJson(after)}};
}

Json ToJson(const BatchEntry& entry) {
  return {{"name", entry.name},
          {"job", entry.job_file},
          {"status", KeyOf(kBatchStatusKeys, entry.status)},
          {"message", entry.message},
          {"directory", entry.directory},
          {"title", entry.title},
          {"arm", entry.arm},
          {"data", entry.data},
          {"train", ToJson(entry.train_before, entry.train_after)},
          {"heldout", ToJson(entry.heldout_before, entry.heldout_after)},
          {"num_free", entry.num_free},
          {"iterations", entry.iterations},
          {"solver_status", entry.solver_status},
          {"sigma", entry.sigma},
          {"reduced_chi_square", entry.reduced_chi_square},
          {"num_outliers", entry.num_outliers},
          {"warnings", entry.warnings}};
}

// The readers below throw nlohmann's exceptions.

double ReadNumber(const Json& json) {
  if (json.is_null()) return std::numeric_limits<double>::quiet_NaN();
  return json.get<double>();
}

Accuracy ReadAccuracy(const Json& json) {
  Accuracy accuracy;
  accuracy.mean = ReadNumber(json.at("mean"));
  accuracy.rms = ReadNumber(json.at("rms"));
  accuracy.stddev = ReadNumber(json.at("stddev"));
  accuracy.median = ReadNumber(json.at("median"));
  accuracy.p95 = ReadNumber(json.at("p95"));
  accuracy.min = ReadNumber(json.at("min"));
  accuracy.max = ReadNumber(json.at("max"));
  accuracy.n = json.at("n").get<std::int64_t>();
  return accuracy;
}

void ReadAccuracies(const Json& json, Accuracy* before, Accuracy* after) {
  if (json.is_null()) return;
  *before = ReadAccuracy(json.at("before"));
  *after = ReadAccuracy(json.at("after"));
}

BatchStatus ReadStatus(const Json& json) {
  const auto text = json.get<std::string>();
  for (const auto& [status, key] : kBatchStatusKeys) {
    if (text == key) return status;
  }
  return BatchStatus::kNotRun;
}

BatchEntry ReadEntry(const Json& json) {
  BatchEntry entry;
  json.at("name").get_to(entry.name);
  json.at("job").get_to(entry.job_file);
  entry.status = ReadStatus(json.at("status"));
  json.at("message").get_to(entry.message);
  json.at("directory").get_to(entry.directory);
  json.at("title").get_to(entry.title);
  json.at("arm").get_to(entry.arm);
  json.at("data").get_to(entry.data);
  ReadAccuracies(json.at("train"), &entry.train_before, &entry.train_after);
  ReadAccuracies(json.at("heldout"), &entry.heldout_before,
                 &entry.heldout_after);
  json.at("num_free").get_to(entry.num_free);
  json.at("iterations").get_to(entry.iterations);
  json.at("solver_status").get_to(entry.solver_status);
  entry.sigma = ReadNumber(json.at("sigma"));
  entry.reduced_chi_square = ReadNumber(json.at("reduced_chi_square"));
  json.at("num_outliers").get_to(entry.num_outliers);
  json.at("warnings").get_to(entry.warnings);
  return entry;
}

BatchSummary ReadSummary(const Json& json) {
  BatchSummary summary;
  json.at("version").get_to(summary.version);
  summary.comparison = json.value("comparison", "");
  for (const Json& entry : json.at("jobs")) {
    summary.entries.push_back(ReadEntry(entry));
  }
  return summary;
}

std::string Dump(const Json& json, int indent) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

std::string FormatBatchSummary(const BatchSummary& summary) {
  Json counts;
  for (const auto& [status, key] : kBatchStatusKeys) {
    counts[key] = summary.Count(status);
  }
  Json jobs = Json::array();
  for (const BatchEntry& entry : summary.entries) jobs.push_back(ToJson(entry));
  const Json json = {{"format", kFormat},
                     {"version", summary.version},
                     {"counts", counts},
                     {"comparison", summary.comparison},
                     {"jobs", jobs}};
  return Dump(json, 2) + "\n";
}

BatchSummary LoadBatchSummary(const std::string& path) {
  try {
    const Json json = Json::parse(ReadFile(path));
    if (json.at("format") == kFormat) return ReadSummary(json);
  } catch (const Json::exception& error) {
    throw InputError({path, 0, 0, ""},
                     std::string("is no summary of a batch: ") + error.what());
  }
  throw InputError({path, 0, 0, "format"},
                   std::string("expected \"") + kFormat + "\"");
}

std::string FormatBatchRecord(const BatchRecord& record) {
  Json inputs = Json::array();
  for (const InputFile& input : record.inputs) {
    inputs.push_back({{"path", input.path}, {"sha256", input.sha256}});
  }
  Json files = Json::array();
  for (const ResultFile& file : record.files) {
    files.push_back({{"name", file.name}, {"bytes", file.bytes}});
  }
  const Json json = {{"version", record.version},
                     {"fingerprint", record.fingerprint},
                     {"inputs", inputs},
                     {"result_sha256", record.result_sha256},
                     {"files", files},
                     {"entry", ToJson(record.entry)}};
  return Dump(json, -1);
}

std::optional<BatchRecord> ParseBatchRecord(const std::string& line) {
  try {
    const Json json = Json::parse(line);
    BatchRecord record;
    json.at("version").get_to(record.version);
    json.at("fingerprint").get_to(record.fingerprint);
    for (const Json& input : json.at("inputs")) {
      record.inputs.push_back({input.at("path").get<std::string>(),
                               input.at("sha256").get<std::string>()});
    }
    json.at("result_sha256").get_to(record.result_sha256);
    for (const Json& file : json.at("files")) {
      record.files.push_back({file.at("name").get<std::string>(),
                              file.at("bytes").get<std::uint64_t>()});
    }
    record.entry = ReadEntry(json.at("entry"));
    return record;
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

}  // namespace alidade::internal
