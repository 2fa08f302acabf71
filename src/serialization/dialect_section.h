#ifndef ALIDADE_SRC_SERIALIZATION_DIALECT_SECTION_H_
#define ALIDADE_SRC_SERIALIZATION_DIALECT_SECTION_H_

#include "src/dataio/data_format.h"
#include "src/serialization/field_records.h"

namespace alidade::internal {

inline constexpr char kUnitsSchema[] =
    R"({"anyOf": [{"type": "string"}, {"type": "array", "items": {"type": "string"}}]})";
inline constexpr char kHeaderSchema[] =
    R"({"anyOf": [{"type": "integer", "minimum": 1}, {"const": "none"}]})";
inline constexpr char kExcludeSchema[] =
    R"({"type": "array", "items": {"type": ["string", "integer"]}})";
inline constexpr char kStationsSchema[] =
    R"({"type": "object", "additionalProperties": {"type": ["string", "integer", "array"]}})";
inline constexpr char kWordsSchema[] =
    R"({"type": "array", "items": {"type": ["string", "number"]}})";

/// @throws InputError.
void ReadSeparator(const YamlValue& value, StatedDialect* dialect);
void ReadDecimal(const YamlValue& value, StatedDialect* dialect);
void ReadThousands(const YamlValue& value, StatedDialect* dialect);
void ReadHeaderLine(const YamlValue& value, StatedDialect* dialect);
void ReadMissingWords(const YamlValue& value, StatedDialect* dialect);
void ReadExclude(const YamlValue& value, DataFormat* format);
void ReadStations(const YamlValue& value, DataFormat* format);
void ReadHeaderUnits(const YamlValue& value, ColumnMapping* mapping);

/// What a map of `data` says of how its text is written, and of rows that are
/// left out.
template <typename Visitor>
void VisitDialect(Visitor& v, DataFormat* format) {
  StatedDialect* const dialect = &format->dialect;
  v.Field(Key("inverse"), format->is_inverse,
          "poses are those of a fixed target in the frame of a camera on the "
          "arm, `tool`; `base` is then the arm's frame in that of the target");
  v.Custom(Key("separator").Default("found").Schema(kTextSchema),
           "between cells, where it is not found: `\",\"`, `\";\"`, `bar`, "
           "`tab` or `space`",
           [=](const YamlValue& value) { ReadSeparator(value, dialect); });
  v.Custom(Key("decimal").Default("found").Schema(kTextSchema),
           "the decimal mark, where it is not found: `\".\"` or `\",\"`",
           [=](const YamlValue& value) { ReadDecimal(value, dialect); });
  v.Custom(Key("thousands").Default("found").Schema(kTextSchema),
           "the mark between groups of three digits, where it is not found: "
           "`\".\"`, `\",\"`, `\"'\"`, `space` or `none`",
           [=](const YamlValue& value) { ReadThousands(value, dialect); });
  v.Custom(Key("header").Default("found").Schema(kHeaderSchema),
           "line of the header, where it is not found, or `none`: columns go "
           "by their numbers, from 1",
           [=](const YamlValue& value) { ReadHeaderLine(value, dialect); });
  v.Custom(Key("missing").Default("`[]`").Schema(kWordsSchema),
           "list: what stands in cells that were not measured, besides the "
           "usual words: `[lost, -9999]`",
           [=](const YamlValue& value) { ReadMissingWords(value, dialect); });
  v.Custom(Key("exclude").Default("`[]`").Schema(kExcludeSchema),
           "list: rows that are left out, by lines of the file (`12`, `40-45`) "
           "or by conditions (`status = lost`, `rms_mm > 0.05`, with `=`, "
           "`!=`, `<`, `<=`, `>`, `>=`)",
           [=](const YamlValue& value) { ReadExclude(value, format); });
  v.Custom(Key("stations").Schema(kStationsSchema),
           "map from names to lines of the file (`2-41`, `42-` to its end, or "
           "a list of some): where the instrument or the arm stood, in place "
           "of a column `station`",
           [=](const YamlValue& value) { ReadStations(value, format); });
}

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_DIALECT_SECTION_H_
