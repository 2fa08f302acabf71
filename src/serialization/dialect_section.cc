#include "src/serialization/dialect_section.h"

#include <string>

#include "src/common/names.h"
#include "src/common/numbers.h"
#include "src/dataio/csv_columns.h"

namespace alidade::internal {
namespace {

char MarkOf(const YamlValue& value, const std::string& what,
            const std::vector<std::pair<std::string, char>>& marks) {
  std::vector<std::string> names;
  for (const auto& [name, mark] : marks) {
    if (value.Text() == name) return mark;
    names.push_back(name);
  }
  value.Fail("expected " + what + ", one of " + JoinNames(names) + ", found " +
             Quote(value.Text()));
}

}  // namespace

void ReadSeparator(const YamlValue& value, StatedDialect* dialect) {
  dialect->separator = MarkOf(value, "what separates cells",
                              {{",", ','},
                               {";", ';'},
                               {"bar", '|'},
                               {"|", '|'},
                               {"tab", '\t'},
                               {"space", ' '},
                               {"\t", '\t'},
                               {" ", ' '}});
}

void ReadDecimal(const YamlValue& value, StatedDialect* dialect) {
  dialect->decimal =
      MarkOf(value, "the decimal mark", {{".", '.'}, {",", ','}});
}

void ReadThousands(const YamlValue& value, StatedDialect* dialect) {
  dialect->thousands = MarkOf(value, "the mark of thousands",
                              {{".", '.'},
                               {",", ','},
                               {"'", '\''},
                               {"space", ' '},
                               {"none", '\0'},
                               {" ", ' '}});
}

void ReadHeaderLine(const YamlValue& value, StatedDialect* dialect) {
  if (value.Text() == "none") {
    dialect->header = 0;
    return;
  }
  const std::optional<int> line = ParseWhole<int>(value.Text());
  if (line < 1) {
    value.Fail("expected the number of a line, from 1, or none, found " +
               Quote(value.Text()));
  }
  dialect->header = line;
}

void ReadMissingWords(const YamlValue& value, StatedDialect* dialect) {
  for (const YamlValue& word : value.List()) {
    dialect->missing.push_back(word.Text());
  }
}

void ReadExclude(const YamlValue& value, DataFormat* format) {
  for (const YamlValue& entry : value.List()) {
    const std::string text = entry.Text();
    const std::optional<std::pair<int, int>> lines = ParseLines(text);
    if (lines) {
      format->dialect.excluded_lines.Add(*lines);
      continue;
    }
    std::optional<RowCondition> condition = ParseRowCondition(text);
    if (!condition) {
      entry.Fail(
          "expected lines of the file (12, 40-45) or a condition (status = "
          "lost, rms_mm > 0.05), found " +
          Quote(text));
    }
    format->exclude.push_back(*std::move(condition));
  }
}

void ReadStations(const YamlValue& value, DataFormat* format) {
  const YamlMap map = value.AnyMap("stations and their lines");
  for (const auto& [name, entry] : map.entries()) {
    std::vector<YamlValue> ranges = {entry};
    if (entry.IsList()) ranges = entry.List();
    for (const YamlValue& range : ranges) {
      const auto lines = ParseLines(range.Text());
      if (!lines) {
        range.Fail(
            "expected lines of the file (2-41, or 42- to its end), "
            "found " +
            Quote(range.Text()));
      }
      for (const auto& [other, taken] : format->stations) {
        if (lines->first > taken.second || taken.first > lines->second) {
          continue;
        }
        range.Fail("lines " + range.Text() + " are, in part, those of " +
                   Quote(other) + ", expected each line in one station");
      }
      format->stations.emplace_back(name, *lines);
    }
  }
}

void ReadHeaderUnits(const YamlValue& value, ColumnMapping* mapping) {
  std::vector<YamlValue> entries = {value};
  if (value.IsList()) entries = value.List();
  for (const YamlValue& entry : entries) {
    const Unit* const unit = FindHeaderUnit(entry.Text());
    if (unit == nullptr) {
      entry.Fail(
          "expected a unit of lengths (mm, m, um, cm, in) or of angles "
          "(deg, rad, mrad), found " +
          Quote(entry.Text()));
    }
    const bool is_length = unit->dimension == Dimension::kLength;
    const bool is_second = !is_length && mapping->angle_unit != nullptr;
    const Unit*& member = is_length   ? mapping->length_unit
                          : is_second ? mapping->rotation_unit
                                      : mapping->angle_unit;
    if (member != nullptr) {
      entry.Fail(
          "a unit too many of its kind, expected one of lengths and one of "
          "angles, or two of these: of joints and of orientations");
    }
    member = unit;
  }
}

}  // namespace alidade::internal
