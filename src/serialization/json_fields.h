#ifndef ALIDADE_SRC_SERIALIZATION_JSON_FIELDS_H_
#define ALIDADE_SRC_SERIALIZATION_JSON_FIELDS_H_

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "alidade/accuracy.h"
#include "alidade/error.h"
#include "src/common/fields.h"
#include "src/common/names.h"

namespace alidade::internal {

/// A value that knows its dotted path, so that a damaged file is an error with
/// its place. Lists count from 1.
class JsonValue {
 public:
  JsonValue(const std::string& file, std::string path,
            const nlohmann::json& json)
      : file_(file), path_(std::move(path)), json_(json) {}

  bool Has(const std::string& key) const { return Object().contains(key); }

  JsonValue operator[](const std::string& key) const {
    const std::string path = path_.empty() ? key : path_ + "." + key;
    const auto found = Object().find(key);
    if (found == json_.end()) Fail(path, "missing, expected this key");
    return JsonValue(file_, path, *found);
  }

  std::vector<JsonValue> List() const {
    if (!json_.is_array()) FailType("a list");
    std::vector<JsonValue> values;
    for (const nlohmann::json& item : json_) {
      const std::string index = "[" + std::to_string(values.size() + 1) + "]";
      values.emplace_back(file_, path_ + index, item);
    }
    return values;
  }

  std::string Text() const {
    if (!json_.is_string()) FailType("text");
    return json_.get<std::string>();
  }

  bool IsNull() const { return json_.is_null(); }

  /// null is what NaN and infinities are written as.
  double Number(double null = std::numeric_limits<double>::quiet_NaN()) const {
    if (json_.is_null()) return null;
    if (!json_.is_number()) FailType("a number");
    return json_.get<double>();
  }

  /// A text, a truth value or an integer that its type can hold.
  template <typename T>
  void Get(T* value) const {
    if constexpr (std::is_same_v<T, std::string>) {
      *value = Text();
      return;
    } else if constexpr (std::is_same_v<T, bool>) {
      if (!json_.is_boolean()) FailType("true or false");
    } else if constexpr (std::is_unsigned_v<T>) {
      if (!json_.is_number_unsigned()) FailType("an integer not below zero");
    } else if (!json_.is_number_integer()) {
      FailType("an integer");
    } else if (json_.get<std::int64_t>() != json_.get<T>()) {
      FailType("a smaller integer");
    }
    *value = json_.get<T>();
  }

  Eigen::VectorXd Vector() const {
    const std::vector<JsonValue> items = List();
    Eigen::VectorXd values(static_cast<Eigen::Index>(items.size()));
    Eigen::Index i = 0;
    for (const JsonValue& item : items) {
      values[i++] = item.Number();
    }
    return values;
  }

  Eigen::MatrixXd SquareMatrix() const {
    const std::vector<JsonValue> rows = List();
    const auto size = static_cast<Eigen::Index>(rows.size());
    Eigen::MatrixXd matrix(size, size);
    Eigen::Index row = 0;
    for (const JsonValue& values : rows) {
      const Eigen::VectorXd entries = values.Vector();
      if (entries.size() != size) values.FailType("as many entries as rows");
      matrix.row(row++) = entries.transpose();
    }
    return matrix;
  }

  /// The value whose word in `table` this is.
  template <typename Table>
  auto Choice(const Table& table) const {
    const std::string text = Text();
    std::vector<std::string> keys;
    for (const auto& [value, key] : table) {
      if (text == key) return value;
      keys.emplace_back(key);
    }
    Fail(path_, UnknownName("word", text, keys));
  }

  /// @throws InputError here.
  [[noreturn]] void FailHere(const std::string& message) const {
    Fail(path_, message);
  }
  [[noreturn]] void FailType(const std::string& expected) const {
    Fail(path_, "expected " + expected + ", found " + json_.type_name());
  }

 private:
  const nlohmann::json& Object() const {
    if (!json_.is_object()) FailType("an object");
    return json_;
  }

  [[noreturn]] void Fail(const std::string& path,
                         const std::string& message) const {
    throw InputError({file_, 0, 0, path}, message);
  }

  const std::string& file_;
  const std::string path_;
  const nlohmann::json& json_;
};

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
