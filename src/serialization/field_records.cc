#include "src/serialization/field_records.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "src/common/names.h"

namespace alidade::internal {

namespace {

[[noreturn]] void FailRange(const YamlValue& value, const std::string& what,
                            const std::string& range) {
  const bool is_amount = range.find("or more") != std::string::npos;
  value.Fail("expected " + what + (is_amount ? " of " : " ") + range +
             ", found " + value.Text());
}

}  // namespace

double ReadNumber(const YamlValue& value, const Key& key, const Units& units) {
  if (!key.dimension) {
    const double number = value.Number();
    if (!key.Allows(number)) FailRange(value, "a number", key.Range());
    return number;
  }
  const double quantity = value.Quantity(*key.dimension, units);
  if (key.Allows(quantity)) return quantity;
  const bool is_length = *key.dimension == Dimension::kLength;
  const Unit& unit = units.Of(*key.dimension);
  FailRange(value, is_length ? "a length" : "an angle",
            key.Range(unit.InSi(), unit.name));
}

int ReadInteger(const YamlValue& value, const Key& key) {
  using Limits = std::numeric_limits<int>;
  const auto number =
      static_cast<int>(value.Integer(Limits::min(), Limits::max()));
  if (!key.Allows(number)) FailRange(value, "an integer", key.Range());
  return number;
}

Eigen::Vector3d ReadVector(const YamlValue& value, const Key& key,
                           const Units& units) {
  const std::vector<YamlValue> items = value.List(3, "x, y, z");
  Eigen::Vector3d vector;
  for (int axis = 0; axis < 3; ++axis) {
    vector[axis] = ReadNumber(items[axis], key, units);
  }
  if (key.dimension) return vector;
  // One that was written is read to the same bits.
  constexpr double kRounding = 1e-15;
  if (std::abs(vector.norm() - 1.0) > kRounding) vector.stableNormalize();
  if (!(std::abs(vector.norm() - 1.0) < 1e-12)) {
    value.Fail("is zero or out of range, expected a direction");
  }
  return vector;
}

std::vector<std::string> ReadNames(const YamlValue& value,
                                   const std::string& what,
                                   const std::vector<std::string>& names) {
  std::vector<std::string> chosen;
  for (const YamlValue& item : value.List()) {
    const std::string name = item.Choice(what, names);
    if (std::find(chosen.begin(), chosen.end(), name) != chosen.end()) {
      item.Fail(Quote(name) + " is repeated, expected each " + what + " once");
    }
    chosen.push_back(name);
  }
  return chosen;
}

std::string FormatDefault(const Key& key, double value) {
  double shown = value;
  std::string unit;
  if (key.dimension && value != 0.0) {
    const bool is_small =
        *key.dimension == Dimension::kLength && std::abs(value) < 1.0;
    shown = is_small ? value / kMillimetre : value;
    unit = is_small ? " mm" : std::string(" ") + WordOf(*key.dimension);
  }
  return FormatBrief(shown) + unit;
}

std::vector<std::string> KeysOf(const std::vector<FieldRecord>& fields) {
  std::vector<std::string> keys;
  for (const FieldRecord& field : fields) {
    keys.emplace_back(field.key.name);
    if (field.key.former_name != nullptr) {
      keys.emplace_back(field.key.former_name);
    }
  }
  return keys;
}

}  // namespace alidade::internal
