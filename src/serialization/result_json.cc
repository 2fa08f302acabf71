#include "src/serialization/result_json.h"

#include <algorithm>
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

Json ParseJson(const std::string& path, const std::string& text) {
  try {
    return Json::parse(text);
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

void CheckFormat(const JsonValue& json, const char* expected) {
  const JsonValue format = json["format"];
  if (format.Text() == kPlanResultFormat) {
    format.FailHere(kPlanResultIsForMachines);
  }
  format.Choice(std::array{std::pair{0, expected}});
}

}  // namespace

CalibrationResult LoadResultJson(const std::string& path) {
  const Json root = ParseJson(path, ReadFile(path));
  const JsonValue json(path, "", root);
  CheckFormat(json, kResultFormat);
  CalibrationResult result;
  ReadJson(json, &result);
  // Results written before these keys were there stay readable.
  if (!json.Has("verdict")) JudgeResult(&result);
  return result;
}

BatchSummary LoadBatchSummary(const std::string& path) {
  const Json root = ParseJson(path, ReadFile(path));
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
