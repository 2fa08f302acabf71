#include "src/dataio/csv_columns.h"

#include <algorithm>
#include <array>

#include "src/common/characters.h"
#include "src/common/names.h"
#include "src/common/numbers.h"
#include "src/dataio/csv_dialect.h"
#include "src/model/motors.h"

namespace alidade::internal {
namespace {

// Of squares only a factor of ten to a power is needed.
constexpr std::array<Unit, 2> kSquareUnits = {{
    {"mm2", Dimension::kLength, -6, 1.0},
    {"m2", Dimension::kLength, 0, 1.0},
}};

bool HasUnit(ColumnType type) {
  return type != ColumnType::kPlain && type != ColumnType::kText;
}

// The units that a data set may be written in.
std::vector<const Unit*> UnitsOf(ColumnType type) {
  switch (type) {
    case ColumnType::kAngle:
      return {FindUnit("deg"), FindUnit("rad")};
    case ColumnType::kLength:
      return {FindUnit("mm"), FindUnit("m")};
    case ColumnType::kSquareLength:
      return {&kSquareUnits[0], &kSquareUnits[1]};
    default:
      return {};
  }
}

const char* TypeName(ColumnType type) {
  if (type == ColumnType::kAngle) return "an angle";
  return type == ColumnType::kLength ? "a length" : "a squared length";
}

struct UnitWord {
  const char* word;
  Unit unit;
};

constexpr Unit kDegrees = {"deg", Dimension::kAngle, 0, kDegree};
constexpr Unit kRadians = {"rad", Dimension::kAngle, 0, 1.0};
constexpr Unit kMilliradians = {"mrad", Dimension::kAngle, -3, 1.0};
constexpr Unit kMillimetres = {"mm", Dimension::kLength, -3, 1.0};
constexpr Unit kMetres = {"m", Dimension::kLength, 0, 1.0};
constexpr Unit kMicrometres = {"um", Dimension::kLength, -6, 1.0};
constexpr Unit kCentimetres = {"cm", Dimension::kLength, -2, 1.0};
constexpr Unit kInches = {"in", Dimension::kLength, -4, 254.0};
constexpr Unit kFeet = {"ft", Dimension::kLength, -4, 3048.0};

// Not "grad", which is a degree in German.
constexpr std::array<UnitWord, 35> kUnitWords = {{
    {"deg", kDegrees},
    {"degs", kDegrees},
    {"degree", kDegrees},
    {"degrees", kDegrees},
    {"\xc2\xb0", kDegrees},
    {"\xc2\xba", kDegrees},
    {"rad", kRadians},
    {"rads", kRadians},
    {"radian", kRadians},
    {"radians", kRadians},
    {"mrad", kMilliradians},
    {"mm", kMillimetres},
    {"millimeter", kMillimetres},
    {"millimeters", kMillimetres},
    {"millimetre", kMillimetres},
    {"millimetres", kMillimetres},
    {"m", kMetres},
    {"meter", kMetres},
    {"meters", kMetres},
    {"metre", kMetres},
    {"metres", kMetres},
    {"um", kMicrometres},
    {"\xc2\xb5m", kMicrometres},
    {"\xce\xbcm", kMicrometres},
    {"micron", kMicrometres},
    {"microns", kMicrometres},
    {"cm", kCentimetres},
    {"centimeters", kCentimetres},
    {"centimetres", kCentimetres},
    {"in", kInches},
    {"inch", kInches},
    {"inches", kInches},
    {"ft", kFeet},
    {"foot", kFeet},
    {"feet", kFeet},
}};

bool IsOpening(char c) { return c == '[' || c == '('; }
bool IsClosing(char c) { return c == ']' || c == ')'; }

// "deg" of "[deg]".
std::string_view WithoutFrame(std::string_view text) {
  if (text.size() < 2 || !IsOpening(text.front()) || !IsClosing(text.back())) {
    return text;
  }
  return text.substr(1, text.size() - 2);
}

// Where the unit of a header begins: at a bracket, or behind the last
// underscore, blank or slash; its size where there is none.
std::size_t UnitBegin(std::string_view header) {
  if (!header.empty() && IsClosing(header.back())) {
    const std::size_t open = header.find_last_of("[(");
    return open == 0 ? header.size() : std::min(open, header.size());
  }
  const std::size_t mark = header.find_last_of("_ /");
  return mark == std::string_view::npos ? header.size() : mark + 1;
}

std::string_view UnitName(std::string_view header) {
  return WithoutFrame(header.substr(UnitBegin(header)));
}

Dimension DimensionOf(ColumnType type) {
  return type == ColumnType::kAngle ? Dimension::kAngle : Dimension::kLength;
}

// "hh:mm:ss.f", "yyyy-mm-dd", "tt.mm.jjjj".
bool IsTimeFormat(std::string_view word) {
  return word.find_first_of(":.-/") != std::string_view::npos &&
         word.find_first_of("hmsydt") == 0 &&
         word.find_first_not_of("hmsfyjdtz:.-/ ") == std::string_view::npos;
}

// Some other unit: "s", "[C]".
bool IsOtherUnit(std::string_view text) {
  static constexpr std::array<std::string_view, 18> kWords = {"s",
                                                              "sec",
                                                              "seconds",
                                                              "ms",
                                                              "c",
                                                              "\xc2\xb0"
                                                              "c",
                                                              "k",
                                                              "n",
                                                              "nm",
                                                              "kg",
                                                              "%",
                                                              "1",
                                                              "hz",
                                                              "v",
                                                              "a",
                                                              "unit",
                                                              "units",
                                                              "count"};
  const std::string word = LowerCase(std::string(WithoutFrame(text)));
  return std::find(kWords.begin(), kWords.end(), word) != kWords.end() ||
         IsTimeFormat(word);
}

// "J1" of "J1 [deg]".
std::string WithoutBrackets(std::string_view header) {
  const std::size_t end = header.find_first_of("[(");
  if (end == 0 || end == std::string_view::npos) return std::string(header);
  header = header.substr(0, end);
  while (!header.empty() && header.back() == ' ') header.remove_suffix(1);
  return std::string(header);
}

}  // namespace

std::vector<ColumnSpec> JointColumns(const Arm& arm) {
  std::vector<ColumnSpec> specs;
  for (const Dimension dimension : MotorDimensions(arm)) {
    const bool turns = dimension == Dimension::kAngle;
    specs.push_back({"q" + std::to_string(specs.size() + 1),
                     turns ? ColumnType::kAngle : ColumnType::kLength,
                     CellRule::kRequired});
  }
  return specs;
}

std::vector<std::string> ColumnNames(const std::vector<ColumnSpec>& specs) {
  std::vector<std::string> names;
  for (const ColumnSpec& spec : specs) {
    if (!spec.mapped.empty()) {
      names.push_back(spec.mapped);
      continue;
    }
    for (const Unit* unit : UnitsOf(spec.type)) {
      names.push_back(spec.base + "_" + unit->name);
    }
    if (!HasUnit(spec.type)) names.push_back(spec.base);
  }
  return names;
}

std::string FirstName(const ColumnSpec& spec) {
  return ColumnNames({spec}).front();
}

std::string Spellings(const ColumnSpec& spec) {
  const std::vector<std::string> names = ColumnNames({spec});
  return names.size() == 1 ? names[0] : names[0] + " or " + names[1];
}

bool IsNamed(const ColumnSpec& spec, std::string_view header, int number) {
  if (!spec.mapped.empty()) {
    return header == spec.mapped || WithoutBrackets(header) == spec.mapped ||
           spec.mapped == std::to_string(number);
  }
  if (!HasUnit(spec.type)) return header == spec.base;
  // What looks like a unit may be none.
  return WithoutUnit(header) == spec.base ||
         header.substr(0, header.rfind('_')) == spec.base;
}

const Unit* UnitOf(const ColumnSpec& spec, std::string_view header) {
  const std::string_view name = UnitName(header);
  if (spec.type == ColumnType::kSquareLength) {
    for (const Unit& unit : kSquareUnits) {
      if (unit.name == name) return &unit;
    }
    return nullptr;
  }
  if (!HasUnit(spec.type)) return nullptr;
  const Unit* const unit = FindHeaderUnit(name);
  if (unit == nullptr) return spec.default_unit;
  return unit->dimension == DimensionOf(spec.type) ? unit : nullptr;
}

bool StatesUnit(std::string_view header) {
  return FindHeaderUnit(UnitName(header)) != nullptr;
}

std::string_view WithoutUnit(std::string_view header) {
  if (!StatesUnit(header)) return header;
  header = header.substr(0, UnitBegin(header));
  while (!header.empty() && (header.back() == ' ' || header.back() == '_' ||
                             header.back() == '/')) {
    header.remove_suffix(1);
  }
  return header;
}

const Unit* FindHeaderUnit(std::string_view text) {
  const std::string word = LowerCase(std::string(WithoutFrame(text)));
  for (const UnitWord& entry : kUnitWords) {
    if (word == entry.word) return &entry.unit;
  }
  return nullptr;
}

bool AreUnits(const std::vector<std::string_view>& cells) {
  constexpr int kMost = 4;  // lengths and angles for one that is unknown
  int known = 0;
  int unknown = 0;
  for (const std::string_view cell : cells) {
    if (FindHeaderUnit(cell) != nullptr) {
      ++known;
    } else if (!IsNotMeasured(cell) && !IsOtherUnit(cell)) {
      ++unknown;
    }
  }
  return known > 0 && kMost * unknown <= known;
}

std::string DescribeBadUnit(const ColumnSpec& spec, std::string_view header) {
  const std::string name(UnitName(header));
  const std::string problem =
      name.empty() ? "no unit" : "unit " + Quote(name) + " does not fit";
  if (!spec.mapped.empty()) {
    const std::vector<const Unit*> units = UnitsOf(spec.type);
    const std::string first = std::string("_") + units[0]->name;
    return problem + ": " + spec.base + " is " + TypeName(spec.type) +
           ", expected a header that ends in " + first + " or _" +
           units[1]->name + ", or `unit` in the job's `columns`";
  }
  return problem + ": " + spec.base + " is " + TypeName(spec.type) +
         ", expected " + Spellings(spec);
}

std::optional<int> JointNumber(std::string_view name) {
  if (name.size() < 2 || name.front() != 'q') return std::nullopt;
  const auto number =
      ParseWhole<int>(name.substr(1, name.find_first_of("_ [(") - 1));
  return number < 1 ? std::nullopt : number;
}

}  // namespace alidade::internal
