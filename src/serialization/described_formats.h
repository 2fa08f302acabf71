#ifndef ALIDADE_SRC_SERIALIZATION_DESCRIBED_FORMATS_H_
#define ALIDADE_SRC_SERIALIZATION_DESCRIBED_FORMATS_H_

#include <string>
#include <vector>

#include "src/serialization/field_records.h"

namespace alidade::internal {

/// A file format, or a part of files that has fields of its own.
struct DescribedFormat {
  std::string name;
  std::vector<FieldRecord> fields;
};

/// The formats: "arm", "deviations", "job", "plan", "simulation".
std::vector<DescribedFormat> DescribeFormats();

/// Parts of these that are read in several places: "data", "errors",
/// "simulate".
std::vector<DescribedFormat> DescribeParts();

/// The fields of a path, "job" or "data.columns": those of a format, of a part
/// or of a section in one. @throws InputError naming the nearest where there is
/// no such path.
std::vector<FieldRecord> FieldsAt(const std::string& path);

/// A field as tables for people show it. Texts are Markdown.
struct FieldRow {
  std::string path;  ///< "solver.threads", "targets[i].name"
  std::string unit;
  std::string default_value;
  std::string text;  ///< with its range
};

/// Those of sections behind them, but for the sections whose paths are in
/// `collapsed`.
std::vector<FieldRow> FieldRows(const std::vector<FieldRecord>& fields,
                                const std::vector<std::string>& collapsed = {});

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_DESCRIBED_FORMATS_H_
