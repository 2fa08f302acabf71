#ifndef ALIDADE_SRC_SERIALIZATION_JSON_VALUE_H_
#define ALIDADE_SRC_SERIALIZATION_JSON_VALUE_H_

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "alidade/error.h"
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

  void Get(std::string* value) const { *value = Text(); }
  void Get(bool* value) const {
    if (!json_.is_boolean()) FailType("true or false");
    *value = json_.get<bool>();
  }
  void Get(std::int64_t* value) const {
    if (!json_.is_number_integer()) FailType("an integer");
    *value = json_.get<std::int64_t>();
  }
  void Get(int* value) const {
    std::int64_t number = 0;
    Get(&number);
    if (number != static_cast<int>(number)) FailType("a smaller integer");
    *value = static_cast<int>(number);
  }
  void Get(std::uint64_t* value) const {
    if (!json_.is_number_unsigned()) FailType("an integer not below zero");
    *value = json_.get<std::uint64_t>();
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

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_JSON_VALUE_H_
