#ifndef ALIDADE_SRC_JOB_IMPORT_DATA_H_
#define ALIDADE_SRC_JOB_IMPORT_DATA_H_

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "alidade/arm.h"
#include "src/dataio/data_format.h"

namespace alidade::internal {

/// What is known of a file of measurements that another program wrote.
struct ImportRequest {
  std::string path;
  const Arm& arm;
  /// Of columns whose names state none: "mm", "deg"; empty: found.
  const Unit* length_unit = nullptr;
  const Unit* angle_unit = nullptr;
  std::optional<RotationConvention> rotation = {};  ///< of three angles
  /// What is left out: lines, and rows by what is in them.
  std::vector<std::pair<int, int>> excluded_lines = {};
  std::vector<RowCondition> exclude = {};
};

/// A file of measurements as it was understood.
struct ImportedData {
  struct Column {
    std::string name;
    std::string use;  ///< "joint 1", "x"; empty: passed over
    std::string unit;
    std::string first;  ///< its first cell
  };
  std::vector<Column> columns;
  std::vector<std::string> notes;  ///< how it is written, what was left out
  LoadedData loaded;
  /// Where each pose stands in the file: "Point 17 (line 21)" by the first
  /// column, where that is passed over, or "line 21".
  std::vector<std::string> places;
};

/// Reads positions or poses from a text file of any form that is certain
/// (csv_layout.h, column_roles.h). Units that neither names nor the request
/// state are those under which the positions fit the nominal arm, where only
/// one does so. Positions that are exactly 0, 0, 0 or another number three
/// times, farther away than an arm of this size can be, or that have a number
/// out of reach which stands there again and again or consists of nines, are
/// those of a lost target and left out.
/// @throws InputError where something is not certain; the message says what to
/// state.
ImportedData ImportData(const ImportRequest& request);

/// The data set as a file, with the places as a column `note`. `title`: a
/// comment on top.
std::string DataText(const ImportedData& imported, const Arm& arm,
                     const std::string& title);

/// A job that calibrates with the data set, ready to run; paths are as seen
/// from the job's folder.
std::string JobText(const std::string& title, const std::string& arm,
                    const std::string& data, Eigen::Index num_poses);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_JOB_IMPORT_DATA_H_
