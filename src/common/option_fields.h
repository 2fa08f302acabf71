#ifndef ALIDADE_SRC_COMMON_OPTION_FIELDS_H_
#define ALIDADE_SRC_COMMON_OPTION_FIELDS_H_

#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "alidade/units.h"
#include "src/common/fields.h"

namespace alidade::internal {

/// Fields of options say more than those of results (fields.h): what they may
/// be, and in a sentence what they mean.
///
///   v.Field(Key("trials").AtLeast(2), options.trials,
///           "simulated calibrations, at most");
///   v.Field(LengthKey("size").Above(0).Required(), options.size, "...");
///
/// From that come the reader of YAML with its messages, IsValid of options, the
/// tables of docs/files.md and the JSON schemas. The default is what the member
/// is initialised with. Visitors of options have these functions:
///
///   Field(key, member, text)     a number, a text, a word of an enum, a list
///   of
///                                words or names, a position (Vector3d of
///                                lengths) or a direction (of numbers, made 1
///                                long), or a value that is read later
///   Section(key, text, visit)    a map; visit(v) has its fields. Of a struct
///                                with VisitFields: Section(key, text, member)
///   Items(key, text, list, visit)    a list of maps; visit(v, item) has those
///   of
///                                one, which joins the list when it is read
///   Custom(key, text, read)      anything else: read(value) or read(value,
///                                units) reads it
///   Check(check)                 check(map), when the fields before are read:
///                                what several fields must agree in
///
/// The text is Markdown. It names each word of an enum, and leaves out unit,
/// range and default, which stand beside it.
struct Key {
  explicit Key(const char* key) : name(key), what(key) {}

  Key Above(double bound) const {
    return AtLeast(bound).Set(&Key::excludes_lower, true);
  }
  Key AtLeast(double bound) const { return Set(&Key::lower, bound); }
  Key Below(double bound) const {
    return AtMost(bound).Set(&Key::excludes_upper, true);
  }
  Key AtMost(double bound) const { return Set(&Key::upper, bound); }
  Key Required() const { return Set(&Key::is_required, true); }
  /// In place of what the member is initialised with.
  Key Default(const char* words) const {
    return Set(&Key::default_words, words);
  }
  /// The unit, where neither that of lengths nor that of angles.
  Key In(const char* words) const { return Set(&Key::unit_words, words); }
  /// What files called it before, and may still.
  Key Formerly(const char* other) const {
    return Set(&Key::former_name, other);
  }
  /// What its words name, in messages: "solver"; else the key itself.
  Key Named(const char* kind) const { return Set(&Key::what, kind); }
  /// The names that a list of texts may hold, each once.
  Key Among(const std::vector<std::string>& all, const char* kind) const {
    return Named(kind).Set(&Key::names, all);
  }
  /// Of what Custom reads, for editors: a JSON schema.
  Key Schema(const char* json) const { return Set(&Key::schema, json); }

  bool Allows(double value) const;
  /// "above 0 and below 1", "1 or more", "from 0 to 12", bounds divided by
  /// `scale` and followed by `unit`; empty where all is allowed.
  std::string Range(double scale = 1.0, const std::string& unit = "") const;

  template <typename Value>
  Key Set(Value Key::*member, const Value& value) const {
    Key key = *this;
    key.*member = value;
    return key;
  }

  const char* name;
  const char* what;
  const char* former_name = nullptr;
  std::optional<Dimension> dimension = {};
  double lower = -std::numeric_limits<double>::infinity();  ///< (SI)
  double upper = std::numeric_limits<double>::infinity();
  bool excludes_lower = false;
  bool excludes_upper = false;
  bool is_required = false;
  const char* default_words = nullptr;
  const char* unit_words = nullptr;
  const char* schema = nullptr;
  std::vector<std::string> names = {};
};

/// Keys of quantities, in the file's unit of lengths or angles.
inline Key QuantityKey(const char* name, Dimension dimension) {
  return Key(name).Set(&Key::dimension, {dimension});
}
inline Key LengthKey(const char* name) {
  return QuantityKey(name, Dimension::kLength);
}
inline Key AngleKey(const char* name) {
  return QuantityKey(name, Dimension::kAngle);
}

/// "0.005", "1e-6".
std::string FormatBrief(double value);

/// Visits what Section() takes: a function or a struct with fields.
template <typename Visitor, typename Part>
void VisitPart(Visitor& v, Part& part) {
  if constexpr (std::is_invocable_v<Part, Visitor&>) {
    part(v);
  } else {
    VisitFields(v, part);
  }
}

/// Looks whether all numbers are what their keys allow. NaN is not.
class FieldCheck {
 public:
  static constexpr bool kReads = false;

  /// `path` is what names in messages begin with.
  explicit FieldCheck(std::string path) : path_(std::move(path)) {}

  template <typename T>
  void Field(const Key& key, const T& value, const char* /*text*/) {
    if constexpr (std::is_same_v<T, double> || std::is_same_v<T, int>) {
      CheckNumber(key, value);
    } else if constexpr (std::is_same_v<T, std::optional<double>>) {
      if (value) CheckNumber(key, *value);
    }
  }
  template <typename Part>
  void Section(const Key& key, const char* /*text*/, const Part& part) {
    FieldCheck section(path_ + key.name + ".");
    VisitPart(section, part);
    if (error_.empty()) error_ = section.error_;
  }

  /// Empty, or "name = value, must be ..." of the first field that is wrong.
  const std::string& error() const { return error_; }

 private:
  void CheckNumber(const Key& key, double value);

  std::string path_;
  std::string error_;
};

/// False with a message that names the field, its value and the constraint.
template <typename Options>
bool AreFieldsValid(const Options& options, const std::string& path,
                    std::string* error) {
  FieldCheck check(path);
  VisitFields(check, options);
  if (check.error().empty()) return true;
  *error = check.error();
  return false;
}

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_COMMON_OPTION_FIELDS_H_
