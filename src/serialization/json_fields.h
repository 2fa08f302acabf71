#ifndef ALIDADE_SRC_SERIALIZATION_JSON_FIELDS_H_
#define ALIDADE_SRC_SERIALIZATION_JSON_FIELDS_H_

#include <Eigen/Core>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "alidade/accuracy.h"
#include "src/common/fields.h"
#include "src/serialization/json_value.h"

namespace alidade::internal {

/// The visitors (src/common/fields.h) that write structs as JSON and read them
/// back. Keys stay in the order in which a struct names them. NaN and
/// infinities are null.

template <typename T>
inline constexpr bool kIsVector = false;
template <typename Item>
inline constexpr bool kIsVector<std::vector<Item>> = true;
template <typename T>
inline constexpr bool kIsOptional = false;
template <typename Item>
inline constexpr bool kIsOptional<std::optional<Item>> = true;
template <typename T>
inline constexpr bool kIsMatrix = false;
template <typename T>
inline constexpr bool kIsColumn = false;
template <int kRows, int kColumns>
inline constexpr bool kIsMatrix<Eigen::Matrix<double, kRows, kColumns>> =
    kColumns != 1;
template <int kRows, int kColumns>
inline constexpr bool kIsColumn<Eigen::Matrix<double, kRows, kColumns>> =
    kColumns == 1;

/// What Optional() asks of a member.
template <typename Item>
bool HasSomething(const std::optional<Item>& value) {
  return value.has_value();
}
inline bool HasSomething(const Accuracy& accuracy) { return accuracy.n > 0; }
inline bool HasSomething(const std::string& text) { return !text.empty(); }

template <typename T>
nlohmann::ordered_json ToJson(const T& value);

class JsonWriter {
 public:
  static constexpr bool kReads = false;

  template <typename T>
  void Field(const char* key, const T& value, double /*null*/ = 0.0) {
    json_[key] = ToJson(value);
  }
  template <typename T>
  void Optional(const char* key, const T& value) {
    if (HasSomething(value)) Field(key, value);
  }
  template <typename T>
  void Later(const char* key, const T& value) {
    Field(key, value);
  }
  template <typename T>
  void Computed(const char* key, const T& value) {
    Field(key, value);
  }
  template <typename Visit>
  void Group(const char* key, const Visit& visit) {
    JsonWriter group;
    visit(group);
    json_[key] = std::move(group.json_);
  }
  template <typename Visit>
  void LaterGroup(const char* key, const Visit& visit) {
    Group(key, visit);
  }
  template <typename Visit>
  void NullableGroup(const char* key, bool is_there, const Visit& visit) {
    json_[key] = nullptr;
    if (is_there) Group(key, visit);
  }
  template <typename First, typename Second>
  void Pairs(const char* key,
             const std::vector<std::pair<First, Second>>& pairs,
             const char* first, const char* second) {
    nlohmann::ordered_json& list = json_[key] = nlohmann::ordered_json::array();
    for (const auto& pair : pairs) {
      list.push_back({{first, pair.first}, {second, pair.second}});
    }
  }
  static bool Has(const char* /*key*/, bool is_there) { return is_there; }

  nlohmann::ordered_json Take() && { return std::move(json_); }

 private:
  nlohmann::ordered_json json_ = nlohmann::ordered_json::object();
};

template <typename T>
nlohmann::ordered_json ToJson(const T& value) {
  if constexpr (kIsOptional<T>) {
    return ToJson(*value);
  } else if constexpr (std::is_enum_v<T>) {
    return WordOf(value);
  } else if constexpr (kIsVector<T> || kIsColumn<T>) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const auto& item : value) list.push_back(ToJson(item));
    return list;
  } else if constexpr (kIsMatrix<T>) {
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    for (Eigen::Index row = 0; row < value.rows(); ++row) {
      rows.push_back(ToJson(Eigen::VectorXd(value.row(row))));
    }
    return rows;
  } else if constexpr (std::is_class_v<T> &&
                       !std::is_convertible_v<T, std::string>) {
    JsonWriter writer;
    VisitFields(writer, value);
    return std::move(writer).Take();
  } else {
    return value;
  }
}

/// Fills *value. @throws InputError where something is missing or of the wrong
/// type. `null` is what a number that is null means.
template <typename T>
void ReadJson(const JsonValue& json, T* value,
              double null = std::numeric_limits<double>::quiet_NaN());

class JsonReader {
 public:
  static constexpr bool kReads = true;

  explicit JsonReader(const JsonValue& json) : json_(json) {}

  template <typename T>
  void Field(const char* key, T& value,
             double null = std::numeric_limits<double>::quiet_NaN()) {
    ReadJson(json_[key], &value, null);
  }
  template <typename T>
  void Optional(const char* key, T& value) {
    if (json_.Has(key)) Field(key, value);
  }
  template <typename T>
  void Later(const char* key, T& value) {
    Optional(key, value);
  }
  template <typename T>
  void Computed(const char* /*key*/, const T& /*value*/) {}
  template <typename Visit>
  void Group(const char* key, const Visit& visit) {
    const JsonValue value = json_[key];
    JsonReader group(value);
    visit(group);
  }
  template <typename Visit>
  void LaterGroup(const char* key, const Visit& visit) {
    if (json_.Has(key)) Group(key, visit);
  }
  template <typename Visit>
  void NullableGroup(const char* key, bool /*is_there*/, const Visit& visit) {
    if (!json_[key].IsNull()) Group(key, visit);
  }
  template <typename First, typename Second>
  void Pairs(const char* key, std::vector<std::pair<First, Second>>& pairs,
             const char* first, const char* second) {
    if (!json_.Has(key)) return;
    for (const JsonValue& item : json_[key].List()) {
      pairs.emplace_back();
      ReadJson(item[first], &pairs.back().first);
      ReadJson(item[second], &pairs.back().second);
    }
  }
  bool Has(const char* key, bool /*is_there*/) const { return json_.Has(key); }

 private:
  const JsonValue& json_;
};

template <typename T>
void ReadJson(const JsonValue& json, T* value, double null) {
  if constexpr (kIsOptional<T>) {
    ReadJson(json, &value->emplace(), null);
  } else if constexpr (std::is_enum_v<T>) {
    *value = json.Choice(kWords<T>);
  } else if constexpr (kIsVector<T>) {
    value->clear();
    for (const JsonValue& item : json.List()) {
      ReadJson(item, &value->emplace_back());
    }
  } else if constexpr (kIsColumn<T>) {
    const Eigen::VectorXd numbers = json.Vector();
    if (T::SizeAtCompileTime >= 0 && numbers.size() != T::SizeAtCompileTime) {
      json.FailType(std::to_string(T::SizeAtCompileTime) + " numbers");
    }
    *value = numbers;
  } else if constexpr (kIsMatrix<T>) {
    *value = json.SquareMatrix();
  } else if constexpr (std::is_same_v<T, double>) {
    *value = json.Number(null);
  } else if constexpr (std::is_class_v<T> && !std::is_same_v<T, std::string>) {
    JsonReader reader(json);
    VisitFields(reader, *value);
  } else {
    json.Get(value);
  }
}

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_JSON_FIELDS_H_
