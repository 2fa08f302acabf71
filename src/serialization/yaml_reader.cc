#include "src/serialization/yaml_reader.h"

#include <algorithm>

#include "src/common/constants.h"
#include "src/common/files.h"
#include "src/common/names.h"
#include "src/common/numbers.h"
#include "src/serialization/yaml_tree.h"

namespace alidade::internal {

namespace {

using Kind = YamlNode::Kind;

constexpr char kUnitHint[] = "state its unit in \"units\"";

const char* KindName(const YamlNode& node) {
  switch (node.kind) {
    case Kind::kEmpty:
      return "nothing";
    case Kind::kScalar:
      return node.quoted ? "a text" : "a single value";
    case Kind::kList:
      return "a list";
    case Kind::kMap:
      return "a map";
  }
  return "";
}

std::string ChildPath(const std::string& parent, const std::string& key) {
  return parent.empty() ? key : parent + "." + key;
}

// A quoted number is text: the quotes are as likely an error as the number.
void RefuseQuoted(const YamlValue& value, const YamlNode& node,
                  const std::string& expected) {
  if (!node.quoted) return;
  value.Fail("expected " + expected + ", found the text " + Quote(node.text) +
             ": write it without quotes");
}

const Unit* ReadUnit(const YamlMap& map, Dimension dimension) {
  const YamlValue value = map.Required(DimensionName(dimension));
  const std::string name = value.Text();
  const Unit* const unit = FindUnit(name);
  const std::string expected =
      "expected one of " + JoinNames(UnitNames(dimension));
  if (unit == nullptr) {
    value.Fail("unknown unit " + Quote(name) + ", " + expected);
  }
  if (unit->dimension != dimension) {
    value.Fail("unit " + Quote(name) + " does not fit: it is a unit of " +
               DimensionName(unit->dimension) + ", " + expected);
  }
  return unit;
}

// In braces a comma ends a value: of "{sigma: 0,03}" the key "03" is left.
std::string HintAt(const std::string& key) {
  const bool is_number =
      !key.empty() && key.find_first_not_of("0123456789") == std::string::npos;
  return is_number
             ? ". If it belongs to a number: write a decimal point, not a "
               "comma"
             : "";
}

// What people write one level too high: it is said of data.
std::string PlaceHint(const std::string& path, const std::string& key,
                      const std::vector<std::string>& keys) {
  static const std::vector<std::string> kOfData = {
      "columns",  "decimal", "exclude",   "file",    "header",   "inverse",
      "missing",  "plane",   "point",     "payload", "rotation", "separator",
      "stations", "target",  "thousands", "unit",    "where"};
  const auto has = [](const std::vector<std::string>& names,
                      const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  if (!path.empty() || !has(keys, "data") || !has(kOfData, key)) return "";
  return key == "unit"
             ? ". It belongs in `data`: `data: {file: ..., columns: {unit: "
               "...}}`"
             : ". It belongs in `data`: `data: {file: ..., " + key + ": ...}`";
}

}  // namespace

YamlValue ReadYaml(const std::string& path) {
  return ParseYaml(ReadFile(path), path);
}

YamlValue ParseYaml(const std::string& text, const std::string& file) {
  return RootOf(ParseYamlDocument(text, file));
}

YamlValue RootOf(YamlDocument tree) {
  auto document = std::make_shared<const YamlDocument>(std::move(tree));
  const YamlNode* const root = &document->root;
  return YamlValue(std::move(document), root, "");
}

Units::Units(const YamlMap& file) {
  const YamlMap units = file.Required("units").Map({"length", "angle"});
  length_ = ReadUnit(units, Dimension::kLength);
  angle_ = ReadUnit(units, Dimension::kAngle);
}

YamlValue::YamlValue(std::shared_ptr<const YamlDocument> document,
                     const YamlNode* node, std::string path)
    : document_(std::move(document)), node_(node), path_(std::move(path)) {}

SourceLocation YamlValue::location() const {
  return LocationOf(*document_, *node_, path_);
}

void YamlValue::Fail(const std::string& message) const {
  throw InputError(location(), message);
}

void YamlValue::FailType(const std::string& expected) const {
  Fail("expected " + expected + ", found " + KindName(*node_));
}

const std::string& YamlValue::Scalar(const std::string& expected) const {
  if (node_->kind != Kind::kScalar) FailType(expected);
  return node_->text;
}

std::string YamlValue::Text() const {
  const std::string& text = Scalar("text");
  if (text.empty()) Fail("expected text, found an empty one");
  return text;
}

std::string YamlValue::Choice(const std::string& what,
                              const std::vector<std::string>& choices) const {
  std::string text = Text();
  if (std::find(choices.begin(), choices.end(), text) == choices.end()) {
    Fail(UnknownName(what, text, choices));
  }
  return text;
}

bool YamlValue::Boolean() const {
  const std::string& text = Scalar("true or false");
  if (node_->quoted || (text != "true" && text != "false")) {
    Fail("expected true or false, found " + Quote(text));
  }
  return text == "true";
}

double YamlValue::Number() const {
  const std::string& text = Scalar("a number");
  RefuseQuoted(*this, *node_, "a number");
  const std::optional<double> value = ParseNumber(text);
  if (!value) {
    Fail(DescribeBadNumber(text, "leave the unit out: this has none"));
  }
  return *value;
}

double YamlValue::Quantity(Dimension dimension, const Units& units) const {
  const std::string& text = Scalar("a number");
  RefuseQuoted(*this, *node_, "a number");
  const std::optional<double> value = ParseQuantity(text, units.Of(dimension));
  if (!value) Fail(DescribeBadNumber(text, kUnitHint));
  return *value;
}

double YamlValue::Limit(Dimension dimension, const Units& units) const {
  const std::string& text = Scalar("a number");
  if (!node_->quoted && text == ".inf") return kInfinity;
  if (!node_->quoted && text == "-.inf") return -kInfinity;
  return Quantity(dimension, units);
}

std::int64_t YamlValue::Integer(std::int64_t lower, std::int64_t upper) const {
  const std::string& text = Scalar("an integer");
  RefuseQuoted(*this, *node_, "an integer");
  const std::optional<std::int64_t> value = ParseWhole<std::int64_t>(text);
  if (!value) Fail("expected an integer, found " + Quote(text));
  if (*value < lower || *value > upper) {
    Fail("expected an integer from " + std::to_string(lower) + " to " +
         std::to_string(upper) + ", found " + text);
  }
  return *value;
}

std::uint64_t YamlValue::Seed() const {
  const std::string expected = "an integer from 0 to 18446744073709551615";
  const std::string& text = Scalar(expected);
  RefuseQuoted(*this, *node_, expected);
  const std::optional<std::uint64_t> value = ParseWhole<std::uint64_t>(text);
  if (!value) Fail("expected " + expected + ", found " + Quote(text));
  return *value;
}

bool YamlValue::IsMap() const { return node_->kind == Kind::kMap; }

bool YamlValue::IsList() const { return node_->kind == Kind::kList; }

std::vector<YamlValue> YamlValue::List() const {
  if (node_->kind != Kind::kList) FailType("a list");
  std::vector<YamlValue> values;
  for (const YamlNode& item : node_->items) {
    const std::string index = "[" + std::to_string(values.size() + 1) + "]";
    values.emplace_back(document_, &item, path_ + index);
  }
  return values;
}

std::vector<YamlValue> YamlValue::List(std::size_t size,
                                       const std::string& what) const {
  const std::string expected =
      "a list of " + std::to_string(size) + " (" + what + ")";
  if (node_->kind != Kind::kList) FailType(expected);
  if (node_->items.size() != size) {
    Fail("expected " + expected + ", found " +
         std::to_string(node_->items.size()));
  }
  return List();
}

YamlMap YamlValue::Map(const std::vector<std::string>& keys) const {
  if (node_->kind != Kind::kMap) {
    FailType("a map of " + JoinNames(keys));
  }
  std::vector<std::pair<std::string, YamlValue>> entries;
  for (std::size_t i = 0; i < node_->keys.size(); ++i) {
    const std::string& key = node_->keys[i];
    const YamlNode& item = node_->items[i];
    const YamlValue value(document_, &item, ChildPath(path_, key));
    if (std::find(keys.begin(), keys.end(), key) == keys.end()) {
      SourceLocation location = value.location();
      location.line = item.key_place.line;
      location.column = item.key_place.column;
      throw InputError(location, UnknownName("key", key, keys) + HintAt(key) +
                                     PlaceHint(path_, key, keys));
    }
    entries.emplace_back(key, value);
  }
  return YamlMap(*this, std::move(entries));
}

YamlMap YamlValue::AnyMap(const std::string& what) const {
  if (node_->kind != Kind::kMap) FailType("a map of " + what);
  std::vector<std::pair<std::string, YamlValue>> entries;
  for (std::size_t i = 0; i < node_->keys.size(); ++i) {
    const std::string& key = node_->keys[i];
    entries.emplace_back(
        key, YamlValue(document_, &node_->items[i], ChildPath(path_, key)));
  }
  return YamlMap(*this, std::move(entries));
}

std::optional<YamlValue> YamlValue::Find(const std::string& key) const {
  const YamlNode* const found = node_->Find(key);
  if (found == nullptr) return std::nullopt;
  return YamlValue(document_, found, ChildPath(path_, key));
}

YamlMap::YamlMap(YamlValue map,
                 std::vector<std::pair<std::string, YamlValue>> entries)
    : map_(std::move(map)), entries_(std::move(entries)) {}

void YamlMap::Fail(const std::string& message) const { map_.Fail(message); }

std::optional<YamlValue> YamlMap::Optional(const std::string& key) const {
  return map_.Find(key);
}

YamlValue YamlMap::Required(const std::string& key) const {
  const std::optional<YamlValue> value = Optional(key);
  if (value) return *value;
  SourceLocation location = map_.location();
  location.key = ChildPath(location.key, key);
  throw InputError(location, "missing, expected this key in the map here");
}

}  // namespace alidade::internal
