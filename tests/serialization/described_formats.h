#ifndef ALIDADE_TESTS_SERIALIZATION_DESCRIBED_FORMATS_H_
#define ALIDADE_TESTS_SERIALIZATION_DESCRIBED_FORMATS_H_

#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "src/serialization/data_section.h"
#include "src/serialization/described_formats.h"
#include "src/serialization/errors_section.h"
#include "src/serialization/simulation_file.h"

namespace alidade::internal::testing {

using Kind = FieldRecord::Kind;

/// Rows of a table of docs/files.md, without the fields of the sections in
/// `collapsed`.
inline std::string FormatRows(const std::vector<FieldRecord>& fields,
                              const std::vector<std::string>& collapsed) {
  const auto cell = [](const std::string& content) {
    return content.empty() ? " |" : " " + content + " |";
  };
  std::string rows;
  for (const FieldRow& row : FieldRows(fields, collapsed)) {
    rows += "| `" + row.path + "` |" + cell(row.unit) +
            cell(row.default_value) + cell(row.text) + "\n";
  }
  return rows;
}

/// The schema of a key `format`: one word, or those in backticks.
inline nlohmann::ordered_json FormatWords(const std::string& text) {
  if (text[0] != '`') return {{"const", text}};
  std::vector<std::string> words;
  for (std::size_t begin = text.find("`alidade-"); begin != std::string::npos;
       begin = text.find("`alidade-", begin + 1)) {
    words.push_back(
        text.substr(begin + 1, text.find('`', begin + 1) - begin - 1));
  }
  return {{"enum", words}};
}

inline nlohmann::ordered_json SchemaOf(const std::vector<FieldRecord>& fields,
                                       bool may_inherit);

inline nlohmann::ordered_json SchemaOf(const FieldRecord& field,
                                       bool may_inherit) {
  using Json = nlohmann::ordered_json;
  const Key& key = field.key;
  Json schema;
  switch (field.kind) {
    case Kind::kNumber:
      schema["type"] = "number";
      break;
    case Kind::kInteger:
      schema["type"] = "integer";
      break;
    case Kind::kBoolean:
      schema["type"] = "boolean";
      break;
    case Kind::kText:
      schema["type"] = "string";
      break;
    case Kind::kWord:
      schema["enum"] = field.words;
      break;
    case Kind::kSection:
      schema = SchemaOf(field.fields, may_inherit);
      break;
    case Kind::kItems:
      schema = {{"type", "array"}, {"items", SchemaOf(field.fields, false)}};
      break;
    case Kind::kCustom:
      schema = Json::parse(key.schema);
      break;
  }
  if (std::string(key.name) == "format") schema = FormatWords(field.text);
  // Bounds other than zero depend on the file's units.
  const auto add = [&](const char* what, double bound) {
    if (!std::isfinite(bound) || (key.dimension && bound != 0.0)) return;
    if (bound == std::floor(bound)) {
      schema[what] = static_cast<std::int64_t>(bound);
    } else {
      schema[what] = bound;
    }
  };
  if (field.kind == Kind::kNumber || field.kind == Kind::kInteger) {
    add(key.excludes_lower ? "exclusiveMinimum" : "minimum", key.lower);
    add(key.excludes_upper ? "exclusiveMaximum" : "maximum", key.upper);
  }
  schema["description"] = field.text;
  return schema;
}

inline nlohmann::ordered_json SchemaOf(const std::vector<FieldRecord>& fields,
                                       bool may_inherit) {
  nlohmann::ordered_json schema = {{"type", "object"}};
  std::vector<std::string> required;
  for (const FieldRecord& field : fields) {
    schema["properties"][field.key.name] = SchemaOf(field, may_inherit);
    if (field.key.former_name != nullptr) {
      auto& former = schema["properties"][field.key.former_name];
      former = SchemaOf(field, may_inherit);
      former["deprecated"] = true;
    }
    if (field.key.is_required) required.emplace_back(field.key.name);
  }
  schema["additionalProperties"] = false;
  // A file may get what it lacks from the one that it extends.
  if (!required.empty() && !may_inherit) schema["required"] = required;
  return schema;
}

/// The JSON schema of a format, for editors.
inline std::string FormatSchema(const DescribedFormat& format) {
  using Json = nlohmann::ordered_json;
  const bool may_inherit = format.name == "job";
  Json schema = {{"$schema", "https://json-schema.org/draft/2020-12/schema"},
                 {"title", "Alidade " + format.name}};
  schema.update(SchemaOf(format.fields, may_inherit));
  if (may_inherit) {
    schema["if"] = {{"required", {"extends"}}};
    schema["else"]["required"] = SchemaOf(format.fields, false)["required"];
  }
  const Json one = {
      {"anyOf",
       {{{"type", "string"}},
        SchemaOf(DataFields(), false),
        {{"type", "object"},
         {"properties", {{"simulate", SchemaOf(SimulatedDataFields(), false)}}},
         {"additionalProperties", false},
         {"required", {"simulate"}}}}}};
  if (format.name == "job" || format.name == "plan") {
    schema["$defs"] = {
        {"entry", one},
        {"errors", SchemaOf(ErrorTermFields(), false)},
        {"data",
         {{"anyOf",
           {{{"$ref", "#/$defs/entry"}},
            {{"type", "array"}, {"items", {{"$ref", "#/$defs/entry"}}}}}}}}};
  }
  return schema.dump(1) + "\n";
}

}  // namespace alidade::internal::testing

#endif  // ALIDADE_TESTS_SERIALIZATION_DESCRIBED_FORMATS_H_
