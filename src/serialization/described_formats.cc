#include "src/serialization/described_formats.h"

#include <algorithm>
#include <utility>

#include "alidade/error.h"
#include "src/common/names.h"
#include "src/serialization/arm_fields.h"
#include "src/serialization/data_section.h"
#include "src/serialization/errors_section.h"
#include "src/serialization/job_config.h"
#include "src/serialization/plan_file.h"
#include "src/serialization/simulation_file.h"

namespace alidade::internal {
namespace {

// "above 0 and at most 180 deg".
std::string RangeOf(const Key& key) {
  if (!key.dimension) return key.Range();
  if (*key.dimension == Dimension::kLength) return key.Range(kMillimetre, "mm");
  const std::string degrees = key.Range(kDegree, "deg");
  const bool is_round = degrees.find('.') == std::string::npos;
  return is_round ? degrees : key.Range(1.0, "rad");
}

std::string UnitOf(const Key& key) {
  if (!key.dimension) return key.unit_words != nullptr ? key.unit_words : "";
  return *key.dimension == Dimension::kLength ? "length" : "angle";
}

std::string DefaultOf(const FieldRecord& field) {
  if (field.key.is_required) return "required";
  if (field.key.default_words != nullptr) return field.key.default_words;
  const bool is_word = field.kind == FieldRecord::Kind::kBoolean ||
                       field.kind == FieldRecord::Kind::kWord;
  return is_word ? "`" + field.default_value + "`" : field.default_value;
}

std::string TextOf(const FieldRecord& field) {
  const Key& key = field.key;
  std::string text = field.text;
  // Where there are several, they are named so already.
  if (std::string(key.name) == "format" && text[0] != '`') {
    text = "`" + text + "`";
  }
  if (field.kind == FieldRecord::Kind::kItems) text = "list: " + text;
  if (key.former_name != nullptr) {
    text += std::string("; formerly `") + key.former_name + "`";
  }
  const std::string range = RangeOf(key);
  return range.empty() ? text : text + " (" + range + ")";
}

void AddRows(const std::vector<FieldRecord>& fields, const std::string& prefix,
             const std::vector<std::string>& collapsed,
             std::vector<FieldRow>* rows) {
  for (const FieldRecord& field : fields) {
    const std::string path = prefix + field.key.name;
    rows->push_back({path, UnitOf(field.key), DefaultOf(field), TextOf(field)});
    const bool is_collapsed =
        std::find(collapsed.begin(), collapsed.end(), path) != collapsed.end();
    if (is_collapsed) continue;
    const bool is_list = field.kind == FieldRecord::Kind::kItems;
    AddRows(field.fields, path + (is_list ? "[i]." : "."), collapsed, rows);
  }
}

}  // namespace

std::vector<DescribedFormat> DescribeFormats() {
  return {{"arm", ArmFields()},
          {"deviations", DeviationsFields()},
          {"job", JobFields()},
          {"plan", PlanFields()},
          {"simulation", SimulationFields()}};
}

std::vector<DescribedFormat> DescribeParts() {
  return {{"data", DataFields()},
          {"errors", ErrorTermFields()},
          {"simulate", SimulatedDataFields()}};
}

std::vector<FieldRecord> FieldsAt(const std::string& path) {
  std::vector<DescribedFormat> level = DescribeFormats();
  for (DescribedFormat& part : DescribeParts()) {
    level.push_back(std::move(part));
  }
  std::size_t begin = 0;
  while (true) {
    const std::size_t dot = path.find('.', begin);
    const std::string name = path.substr(begin, dot - begin);
    const auto found = std::find_if(
        level.begin(), level.end(),
        [&name](const DescribedFormat& one) { return one.name == name; });
    if (found == level.end()) {
      std::vector<std::string> names;
      for (const DescribedFormat& one : level) names.push_back(one.name);
      std::string message =
          UnknownName(begin == 0 ? "format" : "section", name, names);
      for (const DescribedFormat& part : DescribeParts()) {
        if (part.name == name) {
          message += "; 'alidade keys " + name + "' lists that part of files";
        }
      }
      throw InputError({}, message);
    }
    std::vector<FieldRecord> fields = std::move(found->fields);
    if (dot == std::string::npos) return fields;
    level.clear();
    for (const FieldRecord& field : fields) {
      if (!field.fields.empty()) {
        level.push_back({field.key.name, field.fields});
      }
    }
    begin = dot + 1;
  }
}

std::vector<FieldRow> FieldRows(const std::vector<FieldRecord>& fields,
                                const std::vector<std::string>& collapsed) {
  std::vector<FieldRow> rows;
  AddRows(fields, "", collapsed, &rows);
  return rows;
}

}  // namespace alidade::internal
