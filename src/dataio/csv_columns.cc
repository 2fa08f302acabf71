#include "src/dataio/csv_columns.h"

#include <algorithm>
#include <array>

#include "src/common/names.h"
#include "src/common/numbers.h"

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

// Behind the last underscore.
std::string_view UnitName(std::string_view header) {
  const std::size_t underscore = std::min(header.rfind('_'), header.size());
  return header.substr(std::min(header.size(), underscore + 1));
}

// "J1" of "J1 [deg]".
std::string WithoutBrackets(const std::string& header) {
  const std::size_t end = header.find_first_of(" [(");
  return end == 0 ? header : header.substr(0, end);
}

}  // namespace

std::vector<ColumnSpec> JointColumns(const Arm& arm) {
  std::vector<ColumnSpec> specs;
  for (int j = 0; j < arm.num_joints(); ++j) {
    const bool is_revolute = arm.joints[j].type == JointType::kRevolute;
    specs.push_back({"q" + std::to_string(j + 1),
                     is_revolute ? ColumnType::kAngle : ColumnType::kLength,
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

bool IsNamed(const ColumnSpec& spec, std::string_view header) {
  if (!spec.mapped.empty()) return header == spec.mapped;
  if (!HasUnit(spec.type)) return header == spec.base;
  return header.substr(0, header.rfind('_')) == spec.base;
}

const Unit* UnitOf(const ColumnSpec& spec, std::string_view header) {
  for (const Unit* unit : UnitsOf(spec.type)) {
    if (unit->name == UnitName(header)) return unit;
  }
  return nullptr;
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
           units[1]->name + ": rename it, here and in `columns`, to say " +
           Quote(WithoutBrackets(spec.mapped) + first);
  }
  return problem + ": " + spec.base + " is " + TypeName(spec.type) +
         ", expected " + Spellings(spec);
}

std::optional<int> JointNumber(std::string_view name) {
  if (name.size() < 2 || name.front() != 'q') return std::nullopt;
  const auto number = ParseWhole<int>(name.substr(1, name.find('_') - 1));
  return number < 1 ? std::nullopt : number;
}

}  // namespace alidade::internal
