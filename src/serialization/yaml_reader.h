#ifndef ALIDADE_SRC_SERIALIZATION_YAML_READER_H_
#define ALIDADE_SRC_SERIALIZATION_YAML_READER_H_

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "alidade/error.h"
#include "alidade/units.h"
#include "src/common/numbers.h"
#include "src/serialization/yaml_tree.h"

namespace alidade::internal {

class YamlMap;
class YamlValue;

/// Strict YAML. Every value knows its file, line, column and dotted path, and
/// every way it can be wrong is an InputError that says what was found and what
/// was expected:
///
///   const YamlMap map = ReadYaml(path).Map({"name", "units", "sigma"});
///   const Units units(map);
///   const double sigma =
///       map.Required("sigma").Quantity(Dimension::kLength, units);
///
/// Refused anywhere in a file: more than one document, repeated keys, keys that
/// are not text, aliases, tags, bytes that are no text, more than 100 levels.
/// Lists in dotted paths count from 1, as joints do: "joints[2].limits" belongs
/// to the joint of beta2.
///
/// Values are handles that share the document: cheap to copy, read-only, safe
/// to share between threads.

/// The root of a file. @throws InputError.
YamlValue ReadYaml(const std::string& path);

/// The root of a text; `file` is for messages. @throws InputError.
YamlValue ParseYaml(const std::string& text, const std::string& file);

/// The root of a tree that was put together from several files.
YamlValue RootOf(YamlDocument document);

/// The units that a file's plain numbers are in, from its required entry
/// `units: {length: mm, angle: deg}`.
class Units {
 public:
  /// @throws InputError where a unit is missing, unknown or does not fit.
  explicit Units(const YamlMap& file);

  const Unit& Of(Dimension dimension) const {
    return dimension == Dimension::kLength ? *length_ : *angle_;
  }

 private:
  const Unit* length_;
  const Unit* angle_;
};

/// One value. Every function throws InputError where the value is not of the
/// wanted type; numbers are finite and written without a unit.
class YamlValue {
 public:
  YamlValue(std::shared_ptr<const YamlDocument> document, const YamlNode* node,
            std::string path);

  /// Text that is not empty; quoted or not.
  std::string Text() const;
  /// Text that is one of `choices`; `what` is its kind, for the message.
  std::string Choice(const std::string& what,
                     const std::vector<std::string>& choices) const;
  /// true or false, spelt so.
  bool Boolean() const;
  /// A number without dimension.
  double Number() const;
  /// A number in the file's unit of `dimension`, as SI.
  double Quantity(Dimension dimension, const Units& units) const;
  /// As Quantity, but .inf and -.inf are allowed.
  double Limit(Dimension dimension, const Units& units) const;
  /// An integer in [lower, upper], without decimal point or exponent.
  std::int64_t Integer(std::int64_t lower, std::int64_t upper) const;
  /// An integer in [0, 2^64).
  std::uint64_t Seed() const;

  bool IsMap() const;
  bool IsList() const;
  /// The items of a list, which may be empty.
  std::vector<YamlValue> List() const;
  /// The items of a list of exactly `size`; `what` describes them.
  std::vector<YamlValue> List(std::size_t size, const std::string& what) const;
  /// A map that may hold `keys` and no others.
  YamlMap Map(const std::vector<std::string>& keys) const;
  /// A map with keys of the user's choice; `what` describes them.
  YamlMap AnyMap(const std::string& what) const;
  /// The value of `key` where this is a map that has it, whatever else is in
  /// the map.
  std::optional<YamlValue> Find(const std::string& key) const;

  SourceLocation location() const;
  /// What the value is part of.
  const YamlDocument& document() const { return *document_; }
  const YamlNode& node() const { return *node_; }
  /// @throws InputError here.
  [[noreturn]] void Fail(const std::string& message) const;

 private:
  friend class YamlMap;
  const std::string& Scalar(const std::string& expected) const;
  [[noreturn]] void FailType(const std::string& expected) const;

  std::shared_ptr<const YamlDocument> document_;
  const YamlNode* node_;
  std::string path_;
};

/// A map whose keys have been checked against those it may hold.
class YamlMap {
 public:
  /// @throws InputError, at the map, where `key` is missing.
  YamlValue Required(const std::string& key) const;
  /// Nothing where `key` is missing.
  std::optional<YamlValue> Optional(const std::string& key) const;
  /// All entries in the order of the file.
  const std::vector<std::pair<std::string, YamlValue>>& entries() const& {
    return entries_;
  }
  /// Not of a temporary: the loop over its entries would outlive it.
  void entries() && = delete;

  SourceLocation location() const { return map_.location(); }
  const YamlValue& value() const { return map_; }
  /// @throws InputError at the map.
  [[noreturn]] void Fail(const std::string& message) const;

 private:
  friend class YamlValue;
  YamlMap(YamlValue map,
          std::vector<std::pair<std::string, YamlValue>> entries);

  YamlValue map_;
  std::vector<std::pair<std::string, YamlValue>> entries_;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_YAML_READER_H_
