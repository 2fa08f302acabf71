#ifndef ALIDADE_SRC_SERIALIZATION_FIELD_RECORDS_H_
#define ALIDADE_SRC_SERIALIZATION_FIELD_RECORDS_H_

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "src/common/names.h"
#include "src/common/option_fields.h"
#include "src/serialization/yaml_reader.h"

namespace alidade::internal {

/// JSON schemas of what is no single value.
inline constexpr char kTextSchema[] = R"({"type": "string"})";
inline constexpr char kNumberSchema[] = R"({"type": "number"})";
/// [lower, upper], either of which may be infinite.
inline constexpr char kLimitsSchema[] =
    R"({"type": "array", "items": {"type": ["number", "string"]}, "minItems": 2, "maxItems": 2})";
inline constexpr char kNamesSchema[] =
    R"({"type": "array", "items": {"type": "string"}})";
/// A text or a list of some.
inline constexpr char kTextsSchema[] =
    R"({"anyOf": [{"type": "string"}, {"type": "array", "items": {"type": "string"}}]})";
inline constexpr char kNumbersSchema[] =
    R"({"type": "array", "items": {"type": "number"}})";
inline constexpr char kVectorSchema[] =
    R"({"type": "array", "items": {"type": "number"}, "minItems": 3, "maxItems": 3})";
inline constexpr char kMapSchema[] = R"({"type": "object"})";

/// The path of a file, read by Custom.
inline Key PathKey(const char* name) {
  return Key(name).In("path").Schema(kTextSchema);
}

/// What is known of a field without any file.
struct FieldRecord {
  enum class Kind {
    kNumber,
    kInteger,
    kBoolean,
    kText,
    kWord,     ///< one of `words`
    kSection,  ///< a map of `fields`
    kItems,    ///< a list of maps of `fields`
    kCustom,   ///< key.schema
  };

  Key key;
  std::string text;
  Kind kind;
  std::string default_value;  ///< for people; empty where there is none
  std::vector<std::string> words = {};
  std::vector<FieldRecord> fields = {};
};

/// "0.02 mm", "0.005 rad", "1e-06".
std::string FormatDefault(const Key& key, double value);

/// The visitor (src/common/option_fields.h) that lists fields.
class FieldCollector {
 public:
  static constexpr bool kReads = false;
  using Kind = FieldRecord::Kind;

  template <typename T>
  void Field(const Key& key, const T& value, const char* text) {
    FieldRecord record{key, text, Kind::kNumber, ""};
    if constexpr (std::is_enum_v<T>) {
      record.kind = Kind::kWord;
      record.default_value = WordOf(value);
      record.words = WordsOf<T>();
    } else if constexpr (std::is_same_v<T, bool>) {
      record.kind = Kind::kBoolean;
      record.default_value = value ? "true" : "false";
    } else if constexpr (std::is_same_v<T, std::string>) {
      record.kind = Kind::kText;
      record.default_value = value.empty() ? "none" : value;
    } else if constexpr (std::is_integral_v<T>) {
      record.kind = Kind::kInteger;
      record.default_value = std::to_string(value);
      if constexpr (std::is_unsigned_v<T>) record.key.lower = 0.0;
    } else if constexpr (std::is_same_v<T, std::optional<int>>) {
      record.kind = Kind::kInteger;
      record.default_value = "none";
    } else if constexpr (std::is_same_v<T, std::optional<double>>) {
      record.default_value = "none";
    } else if constexpr (std::is_same_v<T, Eigen::Vector3d>) {
      SetSchema(kVectorSchema, &record);
    } else if constexpr (std::is_same_v<T, std::optional<YamlValue>>) {
      SetSchema(kTextSchema, &record);
    } else if constexpr (!std::is_same_v<T, double>) {
      SetSchema(kNamesSchema, &record);
      record.default_value = "`[]`";
    } else {
      record.default_value = FormatDefault(key, value);
    }
    records_.push_back(std::move(record));
  }
  template <typename Part>
  void Section(const Key& key, const char* text, const Part& part) {
    FieldCollector fields;
    VisitPart(fields, part);
    Add(key, text, Kind::kSection, std::move(fields));
  }
  template <typename Item, typename Visit>
  void Items(const Key& key, const char* text,
             const std::vector<Item>& /*list*/, const Visit& visit) {
    FieldCollector fields;
    Item item;
    visit(fields, item);
    Add(key, text, Kind::kItems, std::move(fields));
  }
  template <typename Read>
  void Custom(const Key& key, const char* text, const Read& /*read*/) {
    records_.push_back({key, text, Kind::kCustom, ""});
  }
  template <typename Function>
  void Check(const Function& /*check*/) {}

  std::vector<FieldRecord> Take() && { return std::move(records_); }

 private:
  static void SetSchema(const char* schema, FieldRecord* record) {
    record->kind = Kind::kCustom;
    if (record->key.schema == nullptr) record->key.schema = schema;
  }
  void Add(const Key& key, const char* text, Kind kind,
           FieldCollector&& fields) {
    records_.push_back({key, text, kind, "", {}, std::move(fields.records_)});
  }

  std::vector<FieldRecord> records_;
};

/// The fields that visit(v) names.
template <typename Visit>
std::vector<FieldRecord> CollectFields(const Visit& visit) {
  FieldCollector collector;
  visit(collector);
  return std::move(collector).Take();
}

/// Their keys.
std::vector<std::string> KeysOf(const std::vector<FieldRecord>& fields);

/// What Custom() takes where others read the value.
inline void ReadElsewhere(const YamlValue& /*value*/) {}

/// A number that `key` allows, a position or a direction, names that it has.
/// @throws InputError.
double ReadNumber(const YamlValue& value, const Key& key, const Units& units);
int ReadInteger(const YamlValue& value, const Key& key);
Eigen::Vector3d ReadVector(const YamlValue& value, const Key& key,
                           const Units& units);
std::vector<std::string> ReadNames(const YamlValue& value,
                                   const std::string& what,
                                   const std::vector<std::string>& names);

/// The visitor (src/common/option_fields.h) that reads a map. Keys that are not
/// there leave their members alone. @throws InputError.
class YamlFields {
 public:
  static constexpr bool kReads = true;

  YamlFields(const YamlMap& map, const Units& units)
      : map_(map), units_(units) {}

  template <typename T>
  void Field(const Key& key, T& member, const char* /*text*/) {
    const std::optional<YamlValue> value = Find(key);
    if (!value) return;
    if constexpr (std::is_enum_v<T>) {
      member = ValueOf<T>(value->Choice(key.what, WordsOf<T>()));
    } else if constexpr (std::is_same_v<T, bool>) {
      member = value->Boolean();
    } else if constexpr (std::is_same_v<T, std::string>) {
      member = value->Text();
    } else if constexpr (std::is_same_v<T, std::uint64_t>) {
      member = value->Seed();
    } else if constexpr (std::is_same_v<T, int> ||
                         std::is_same_v<T, std::optional<int>>) {
      member = ReadInteger(*value, key);
    } else if constexpr (std::is_same_v<T, Eigen::Vector3d>) {
      member = ReadVector(*value, key, units_);
    } else if constexpr (std::is_same_v<T, std::optional<YamlValue>>) {
      member = value;
    } else if constexpr (std::is_same_v<T, std::vector<std::string>>) {
      member = ReadNames(*value, key.what, key.names);
    } else if constexpr (std::is_same_v<T, double> ||
                         std::is_same_v<T, std::optional<double>>) {
      member = ReadNumber(*value, key, units_);
    } else {
      using Enum = typename T::value_type;
      for (const std::string& word :
           ReadNames(*value, key.what, WordsOf<Enum>())) {
        member.push_back(ValueOf<Enum>(word));
      }
    }
  }
  template <typename Part>
  void Section(const Key& key, const char* text, Part&& part);
  template <typename Item, typename Visit>
  void Items(const Key& key, const char* text, std::vector<Item>& list,
             const Visit& visit);
  template <typename Read>
  void Custom(const Key& key, const char* /*text*/, const Read& read) {
    const std::optional<YamlValue> value = Find(key);
    if (!value) return;
    if constexpr (std::is_invocable_v<Read, YamlValue, Units>) {
      read(*value, units_);
    } else {
      read(*value);
    }
  }
  template <typename Function>
  void Check(const Function& check) {
    check(map_);
  }

 private:
  std::optional<YamlValue> Find(const Key& key) const {
    std::optional<YamlValue> value = map_.Optional(key.name);
    if (key.former_name != nullptr) {
      std::optional<YamlValue> former = map_.Optional(key.former_name);
      if (value && former) {
        former->Fail(std::string("is the former name of ") + key.name +
                     ", which is there too: remove one");
      }
      if (former) return former;
    }
    if (!value && key.is_required) return map_.Required(key.name);
    return value;
  }

  const YamlMap& map_;
  const Units& units_;
};

/// A map that may hold the keys that visit(v) names, and no others.
template <typename Visit>
YamlMap MapOf(const YamlValue& value, const Visit& visit) {
  return value.Map(KeysOf(CollectFields(visit)));
}

/// Reads the fields that visit(v) names from a map. @throws InputError.
template <typename Visit>
void ReadFields(const YamlValue& value, const Units& units,
                const Visit& visit) {
  const YamlMap map = MapOf(value, visit);
  YamlFields fields(map, units);
  visit(fields);
}

/// Of an item of a list of maps, before it joins the others. @throws
/// InputError.
template <typename Item>
void RefuseRepeatedName(const YamlMap& map, const Item& item,
                        const std::vector<Item>& others) {
  for (const Item& other : others) {
    if (other.name != item.name) continue;
    map.Required("name").Fail(Quote(item.name) +
                              " is repeated, expected each name once");
  }
}

template <typename Part>
void YamlFields::Section(const Key& key, const char* /*text*/, Part&& part) {
  const std::optional<YamlValue> value = Find(key);
  if (!value) return;
  ReadFields(*value, units_, [&](auto& v) { VisitPart(v, part); });
}

template <typename Item, typename Visit>
void YamlFields::Items(const Key& key, const char* /*text*/,
                       std::vector<Item>& list, const Visit& visit) {
  const std::optional<YamlValue> items = Find(key);
  if (!items) return;
  for (const YamlValue& value : items->List()) {
    Item item;
    ReadFields(value, units_, [&](auto& v) { visit(v, item); });
    list.push_back(std::move(item));
  }
}

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_FIELD_RECORDS_H_
