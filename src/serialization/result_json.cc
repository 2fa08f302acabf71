#include "src/serialization/result_json.h"

#include <nlohmann/json.hpp>

#include "src/calibration/batch_summary_fields.h"
#include "src/calibration/calibration_result_fields.h"
#include "src/planning/plan_result_fields.h"
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

constexpr auto kUnitKeys = kWords<Dimension>;

template <typename Table>
const char* KeyOf(const Table& /*table*/, Dimension dimension) {
  return WordOf(dimension);
}

Json AccuracyToJson(const Accuracy& accuracy) {
  return alidade::internal::ToJson<Accuracy>(accuracy);
}

template <typename Item>
Json ToJsonList(const std::vector<Item>& items, Json (*convert)(const Item&)) {
  Json list = Json::array();
  for (const Item& item : items) list.push_back(convert(item));
  return list;
}

Json ToJson(const StudyRow& row) {
  return {{"quantity", row.quantity},
          {"published", row.published},
          {"obtained", row.obtained}};
}

Json ToJson(const StudyParameter& parameter) {
  return {{"name", parameter.name},
          {"unit", KeyOf(kUnitKeys, parameter.dimension)},
          {"identified", parameter.identified},
          {"nominal", parameter.nominal},
          {"assumed", parameter.assumed},
          {"published", parameter.published},
          {"obtained", parameter.obtained}};
}

Json ToJson(const Absorption& absorption) {
  return {{"frozen", absorption.frozen},
          {"frozen_deviation", absorption.frozen_deviation},
          {"taken_up_by", absorption.taken_up_by},
          {"unit", KeyOf(kUnitKeys, absorption.dimension)},
          {"coefficient", absorption.coefficient},
          {"amount", absorption.amount}};
}

Json ToJson(const StudyResult& study) {
  return {{"source", study.source},
          {"rows", ToJsonList(study.rows, ToJson)},
          {"parameters", ToJsonList(study.parameters, ToJson)},
          {"absorptions", ToJsonList(study.absorptions, ToJson)},
          {"angle_decimals", study.angle_decimals},
          {"length_decimals", study.length_decimals},
          {"as_printed", AccuracyToJson(study.as_printed)},
          {"three_more_decimals", AccuracyToJson(study.three_more_decimals)},
          {"timed_iterations", study.timed_iterations},
          {"timed_s", study.timed_s},
          {"published_s", study.published_s}};
}

}  // namespace

std::string FormatResultJson(const CalibrationResult& result) {
  JsonWriter writer;
  writer.Field("format", std::string(kResultFormat));
  VisitFields(writer, result);
  Json json = std::move(writer).Take();
  if (result.study) {
    Json times = json["times"];
    json.erase("times");
    json["study"] = ToJson(*result.study);
    json["times"] = std::move(times);
  }
  return Dump(json, kIndent) + "\n";
}

std::string FormatPlanJson(const PlanResult& result) {
  return FormatFile(kPlanResultFormat, result);
}

std::string FormatBatchSummary(const BatchSummary& summary) {
  return FormatFile(kBatchFormat, summary);
}

std::string FormatBatchRecord(const BatchRecord& record) {
  return Dump(alidade::internal::ToJson(record), -1);
}

}  // namespace alidade::internal
