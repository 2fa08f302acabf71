#include <nlohmann/json.hpp>

#include "alidade/error.h"
#include "src/calibration/batch_summary_fields.h"
#include "src/calibration/calibration_result_fields.h"
#include "src/calibration/verdict.h"
#include "src/common/files.h"
#include "src/serialization/json_fields.h"
#include "src/serialization/json_value.h"
#include "src/serialization/result_json.h"

namespace alidade::internal {
namespace {

using Json = nlohmann::json;

constexpr auto kUnitKeys = kWords<Dimension>;

Accuracy ReadAccuracy(const JsonValue& json) {
  Accuracy accuracy;
  ReadJson(json, &accuracy);
  return accuracy;
}

template <typename Read>
auto ReadList(const JsonValue& list, const Read& read) {
  std::vector<decltype(read(list))> items;
  for (const JsonValue& item : list.List()) items.push_back(read(item));
  return items;
}

StudyRow ReadStudyRow(const JsonValue& json) {
  return {json["quantity"].Text(), json["published"].Text(),
          json["obtained"].Text()};
}

StudyParameter ReadStudyParameter(const JsonValue& json) {
  StudyParameter parameter;
  parameter.name = json["name"].Text();
  parameter.dimension = json["unit"].Choice(kUnitKeys);
  parameter.identified = json["identified"].Boolean();
  parameter.nominal = json["nominal"].Number();
  parameter.assumed = json["assumed"].Number();
  parameter.published = json["published"].Number();
  parameter.obtained = json["obtained"].Number();
  return parameter;
}

Absorption ReadAbsorption(const JsonValue& json) {
  Absorption absorption;
  absorption.frozen = json["frozen"].Text();
  absorption.frozen_deviation = json["frozen_deviation"].Number();
  absorption.taken_up_by = json["taken_up_by"].Text();
  absorption.dimension = json["unit"].Choice(kUnitKeys);
  absorption.coefficient = json["coefficient"].Number();
  absorption.amount = json["amount"].Number();
  return absorption;
}

StudyResult ReadStudy(const JsonValue& json) {
  StudyResult study;
  study.source = json["source"].Text();
  study.rows = ReadList(json["rows"], ReadStudyRow);
  study.parameters = ReadList(json["parameters"], ReadStudyParameter);
  study.absorptions = ReadList(json["absorptions"], ReadAbsorption);
  study.angle_decimals = json["angle_decimals"].Integer();
  study.length_decimals = json["length_decimals"].Integer();
  study.as_printed = ReadAccuracy(json["as_printed"]);
  study.three_more_decimals = ReadAccuracy(json["three_more_decimals"]);
  study.timed_iterations = json["timed_iterations"].Integer();
  study.timed_s = json["timed_s"].Number();
  study.published_s = json["published_s"].Number();
  return study;
}

// The parser gives the number of bytes read.
SourceLocation LocationOfByte(const std::string& path, const std::string& text,
                              std::size_t byte) {
  SourceLocation location;
  location.file = path;
  location.line = 1;
  location.column = 1;
  for (std::size_t i = 0; i + 1 < byte && i < text.size(); ++i) {
    ++location.column;
    if (text[i] == '\n') {
      ++location.line;
      location.column = 1;
    }
  }
  return location;
}

Json ParseJson(const std::string& path, const std::string& text) {
  try {
    return Json::parse(text);
  } catch (const Json::parse_error& error) {
    throw InputError(LocationOfByte(path, text, error.byte),
                     "not valid JSON, expected a file that Alidade wrote; the "
                     "file may be cut off");
  } catch (const Json::out_of_range&) {
    SourceLocation location;
    location.file = path;
    throw InputError(location, "a number in it does not fit a double");
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
  if (json.Has("study")) result.study = ReadStudy(json["study"]);
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
