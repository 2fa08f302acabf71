#include "src/serialization/result_json.h"

#include <nlohmann/json.hpp>

#include "src/calibration/batch_summary_fields.h"
#include "src/calibration/calibration_result_fields.h"
#include "src/planning/plan_fields.h"
#include "src/serialization/json_fields.h"

namespace alidade::internal {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kIndent = 2;

// Paths may hold bytes that are no UTF-8.
std::string Dump(const Json& json, int indent) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
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

}  // namespace alidade::internal
