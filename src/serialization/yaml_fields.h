#ifndef ALIDADE_SRC_SERIALIZATION_YAML_FIELDS_H_
#define ALIDADE_SRC_SERIALIZATION_YAML_FIELDS_H_

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "src/common/names.h"
#include "src/common/option_fields.h"
#include "src/serialization/field_records.h"
#include "src/serialization/yaml_reader.h"

namespace alidade::internal {

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
      const auto former = map_.Optional(key.former_name);
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

#endif  // ALIDADE_SRC_SERIALIZATION_YAML_FIELDS_H_
