#include "src/serialization/result_json.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "alidade/error.h"
#include "src/calibration/batch_summary_fields.h"
#include "src/calibration/calibration_result_fields.h"
#include "src/calibration/verdict.h"
#include "src/common/files.h"
#include "src/planning/plan_fields.h"
#include "src/serialization/json_fields.h"

namespace alidade::internal {

namespace {

constexpr int kIndent = 2;

// Paths may hold bytes that are no UTF-8.
std::string Dump(const nlohmann::ordered_json& json, int indent) {
  return json.dump(indent, ' ', false,
                   nlohmann::json::error_handler_t::replace);
}

template <typename Result>
std::string FormatFile(const char* format, const Result& result) {
  JsonWriter writer;
  writer.Field("format", std::string(format));
  VisitFields(writer, result);
  return Dump(std::move(writer).Take(), kIndent) + "\n";
}

}  // namespace

std::string FormatResultJson(const CalibrationResult& result) {
  return FormatFile(kResultFormat, result);
}

std::string FormatIdentifiabilityJson(const IdentifiabilityResult& result) {
  return Dump(ToJson(result), kIndent) + "\n";
}

std::string FormatPlanJson(const PlanResult& result) {
  return FormatFile(kPlanResultFormat, result);
}

std::string FormatBatchSummary(const BatchSummary& summary) {
  return FormatFile(kBatchFormat, summary);
}

std::string FormatBatchRecord(const BatchRecord& record) {
  return Dump(ToJson(record), -1);
}

namespace {

using Json = nlohmann::json;

// Far more than any result needs, and little for what recurses.
constexpr int kMaxJsonDepth = 100;

Json ParseJson(const std::string& path, const std::string& text) {
  const auto refuse_deep = [&](int depth, Json::parse_event_t, const Json&) {
    if (depth <= kMaxJsonDepth) return true;
    throw InputError({path, 0, 0, ""},
                     "nested deeper than " + std::to_string(kMaxJsonDepth) +
                         " levels, expected a file that Alidade wrote");
  };
  try {
    return Json::parse(text, refuse_deep);
  } catch (const Json::parse_error& error) {
    // The parser gives the number of bytes read.
    const std::size_t byte = std::max<std::size_t>(error.byte, 1) - 1;
    throw InputError(LocationOfByte(path, text, byte),
                     "not valid JSON, expected a file that Alidade wrote; the "
                     "file may be cut off");
  } catch (const Json::out_of_range&) {
    throw InputError({path, 0, 0, ""}, "a number in it does not fit a double");
  }
}

// Keys and words that files of format 1 have in place of today's.
const std::map<std::string, std::string>& FormerNames() {
  static const auto* const names = new std::map<std::string, std::string>{
      {"heldout", "validation"},
      {"heldout_rotation", "validation_rotation"},
      {"heldout_rms", "validation_rms"},
      {"heldout_max", "validation_max"},
      {"heldout_rotation_rms", "validation_rotation_rms"},
      {"heldout_rotation_max", "validation_rotation_max"},
      {"length_freedom", "length_degrees_of_freedom"},
      {"rotation_freedom", "rotation_degrees_of_freedom"},
      {"rounding_floor", "precision_limit"},
      {"stands_for", "identified_combination"}};
  return *names;
}

std::string NameToday(const std::string& name) {
  const auto found = FormerNames().find(name);
  return found == FormerNames().end() ? name : found->second;
}

// What a file of format 1 is in today's words.
Json UpdateNames(const Json& json) {
  if (json.is_array()) {
    Json list = Json::array();
    for (const Json& item : json) list.push_back(UpdateNames(item));
    return list;
  }
  if (!json.is_object()) return json;
  Json object = Json::object();
  for (const auto& [key, value] : json.items()) {
    Json& updated = object[NameToday(key)] = UpdateNames(value);
    if (key == "state" && value == "frozen") updated = "fixed";
    const bool is_name = key == "status" || key == "quantity";
    if (is_name && value.is_string()) updated = NameToday(value);
  }
  return object;
}

// A file's text of `format`, or of format 1, in today's names.
Json ReadJsonText(const std::string& path, const std::string& text,
                  const std::string& format) {
  Json json = ParseJson(path, text);
  const std::string first = format.substr(0, format.size() - 1) + "1";
  if (json.is_object() && json.value("format", Json()) == first) {
    json = UpdateNames(json);
    json["format"] = format;
  }
  return json;
}

void CheckFormat(const JsonValue& json, const char* expected) {
  const JsonValue format = json["format"];
  if (format.Text().rfind("alidade-plan-result-", 0) == 0) {
    format.FailHere(kPlanResultIsForMachines);
  }
  format.Choice(std::array{std::pair{0, expected}});
}

}  // namespace

CalibrationResult LoadResultJson(const std::string& path) {
  return ParseResultJson(ReadFile(path), path);
}

CalibrationResult ParseResultJson(const std::string& text,
                                  const std::string& path) {
  const Json root = ReadJsonText(path, text, kResultFormat);
  const JsonValue json(path, "", root);
  CheckFormat(json, kResultFormat);
  CalibrationResult result;
  ReadJson(json, &result);
  // Results written before these keys were there stay readable.
  if (!json.Has("verdict")) JudgeResult(&result);
  return result;
}

BatchSummary LoadBatchSummary(const std::string& path) {
  return ParseBatchSummary(ReadFile(path), path);
}

BatchSummary ParseBatchSummary(const std::string& text,
                               const std::string& path) {
  const Json root = ReadJsonText(path, text, kBatchFormat);
  const JsonValue json(path, "", root);
  CheckFormat(json, kBatchFormat);
  BatchSummary summary;
  ReadJson(json, &summary);
  return summary;
}

std::optional<BatchRecord> ParseBatchRecord(const std::string& line) {
  try {
    const Json root = ParseJson("", line);
    BatchRecord record;
    ReadJson(JsonValue("", "", root), &record);
    return record;
  } catch (const InputError&) {
    return std::nullopt;
  }
}

}  // namespace alidade::internal
