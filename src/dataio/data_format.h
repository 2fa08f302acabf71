#ifndef ALIDADE_SRC_DATAIO_DATA_FORMAT_H_
#define ALIDADE_SRC_DATAIO_DATA_FORMAT_H_

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "alidade/arm.h"
#include "alidade/dataset.h"
#include "src/common/numbers.h"
#include "src/dataio/csv_dialect.h"
#include "src/dataio/rotation_convention.h"
#include "src/dataio/row_condition.h"

namespace alidade::internal {

/// Headers of a file that was not written for Alidade: which of its columns
/// hold what. Those of numbers end in their units ("q1_cmd_deg", "smr2_x_mm").
/// What is empty here goes by its usual name.
struct ColumnMapping {
  std::vector<std::string> joints;    ///< one per joint, from the base
  std::vector<std::string> position;  ///< x, y, z
  /// rx, ry, rz, a quaternion: w, x, y, z, or a matrix: its rows (both without
  /// units).
  std::vector<std::string> orientation;
  std::vector<std::string> std_position;     ///< of x, y, z
  std::vector<std::string> std_orientation;  ///< of rx, ry, rz; else about axes
  std::string distance;
  std::string std_distance;
  /// Name of the reference point; of several columns, joined by "/".
  std::vector<std::string> point;
  std::string plane;
  std::string target;
  std::string set;
  /// Columns of numbers that are kept as they are, for error terms.
  std::vector<std::string> covariates;
  std::vector<CovariateUse> uses;  ///< of some of them
  std::string station;             ///< where the instrument or the arm stood
  /// Positions of several targets in one row: names, and headers of x, y, z.
  std::vector<std::pair<std::string, std::vector<std::string>>> targets;
  /// Of headers that state none; null: those of the format.
  const Unit* length_unit = nullptr;
  const Unit* angle_unit = nullptr;
  const Unit* rotation_unit = nullptr;  ///< of orientations; null: angle_unit
};

/// DataFormat::sigma of those who want to know what a file states: rows without
/// a sigma of their own get it (orientations a negative one too), and writers
/// leave such columns out. Nothing else may be done with such data.
inline constexpr double kUnstatedSigma = -1.0;

/// What a data set's file does not say itself.
struct DataFormat {
  ColumnMapping columns;
  /// Columns with other names are passed over instead of refused.
  bool ignore_others = false;
  /// Of rx, ry, rz; they are refused where it is not stated.
  std::optional<RotationConvention> rotation;
  /// Poses are those of a fixed target in the frame of a camera on the arm.
  bool is_inverse = false;
  /// Orientations are passed over.
  bool ignore_rotation = false;
  /// All is passed over but positions, orientations, their sigmas and targets.
  bool poses_only = false;
  double sigma = 1e-3;  ///< of lengths without a sigma of their own (m)
  /// Of orientations without sigmas of their own (rad), about each axis of the
  /// instrument; 0 = DefaultRotationSigma(sigma).
  double rotation_sigma = 0.0;
  /// Reference point, plane and target of all rows; empty: the file's columns
  /// name them.
  std::string point;
  std::string plane;
  std::string target;
  /// Mass at the target while these data were measured (kg).
  std::optional<double> payload;
  /// Rows are kept whose cell in the column (first) has the text (second).
  std::vector<std::pair<std::string, std::string>> where;
  /// Rows are left out that meet one of these.
  std::vector<RowCondition> exclude;
  /// Where the instrument or the arm stood: names, and first and last lines of
  /// the file; in place of a column.
  std::vector<std::pair<std::string, std::pair<int, int>>> stations;
  /// How a text is written, and lines of it that are left out.
  StatedDialect dialect;
  /// Whether what was found and is not stated here is logged.
  bool logs_findings = true;
  /// Of columns that the mapping names by headers without units; null: headers
  /// must state them.
  const Unit* length_unit = nullptr;
  const Unit* angle_unit = nullptr;
};

/// What goes with a sigma of lengths where none of orientations is stated
/// (rad): that of points 0.2 m apart, about the size of a target that is
/// measured with its orientation.
inline double DefaultRotationSigma(double sigma) { return sigma / 0.2; }

struct LoadedData {
  Dataset data;
  std::vector<std::string> sets;  ///< one per pose; empty: no such column
  std::vector<std::string> stations = {};  ///< likewise
  std::vector<CovariateUse> uses = {};     ///< of the data's covariates
  std::vector<RejectedRow> rejected;
};

/// A data set's file and what is to be known to read it. Must not outlive them.
struct DataFile {
  const std::string& path;
  const Arm& arm;
  const DataFormat& format;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATAIO_DATA_FORMAT_H_
