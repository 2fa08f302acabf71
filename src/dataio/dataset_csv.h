#ifndef ALIDADE_SRC_DATAIO_DATASET_CSV_H_
#define ALIDADE_SRC_DATAIO_DATASET_CSV_H_

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "alidade/arm.h"
#include "alidade/dataset.h"
#include "alidade/references.h"
#include "src/dataio/rotation_convention.h"

namespace alidade::internal {

/// Headers of a file that was not written for Alidade: which of its columns
/// hold what. Those of numbers end in their units ("q1_cmd_deg", "smr2_x_mm").
/// What is empty here goes by its usual name.
struct ColumnMapping {
  std::vector<std::string> joints;    ///< one per joint, from the base
  std::vector<std::string> position;  ///< x, y, z
  /// rx, ry, rz, or a quaternion: w, x, y, z (without units).
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
  /// Positions of several targets in one row: names, and headers of x, y, z.
  std::vector<std::pair<std::string, std::vector<std::string>>> targets;
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
  /// Orientations are passed over.
  bool ignore_rotation = false;
  double sigma = 1e-3;  ///< of lengths without a sigma of their own (m)
  /// Of orientations without sigmas of their own (rad), about each axis of the
  /// instrument; 0 = DefaultRotationSigma(sigma).
  double rotation_sigma = 0.0;
  /// Reference point, plane and target of all rows; empty: the file's columns
  /// name them.
  std::string point;
  std::string plane;
  std::string target;
  /// Rows are kept whose cell in the column (first) has the text (second).
  std::vector<std::pair<std::string, std::string>> where;
};

/// What goes with a sigma of lengths where none of orientations is stated
/// (rad): that of points 0.2 m apart, about the size of a target that is
/// measured with its orientation.
double DefaultRotationSigma(double sigma);

struct LoadedData {
  Dataset data;
  std::vector<std::string> sets;  ///< one per pose; empty: no such column
  std::vector<RejectedRow> rejected;
};

/// Reads measurements of any kind (docs/files.md, "Data set"). Points and
/// planes are looked up by their names in `references`; those that are not
/// there are appended as unknown.
/// @pre the mapping's lists are empty or as long as they should be.
///
/// Files whose names end in ".npy" are NumPy arrays, all others CSV. Large
/// files of positions or poses are mapped into memory and read by
/// `num_threads`; the result does not depend on it.
/// @throws InputError with file, line (of a NumPy array, row) and column name.
LoadedData LoadData(const std::string& path, const Arm& arm,
                    const DataFormat& format, References* references,
                    int num_threads = 1);

/// The same of a file in our own format that needs nothing besides: positions,
/// orientations as quaternions or rotation vectors, differences.
/// `default_sigma` (m) is that of lengths without one.
/// @throws InputError, also where the file needs more than that.
Dataset LoadDataset(const std::string& path, const Arm& arm,
                    double default_sigma, int num_threads = 1);

/// Reads only the joint columns; others are allowed and ignored.
Eigen::MatrixXd LoadJointValues(const std::string& path, const Arm& arm);

/// The text of a data set of positions or poses that LoadDataset reads back:
/// joint values in deg and mm with `joint_decimals` decimals, or with
/// kFewestDigits so that they read back to the same bits (a column of angles
/// that no number of degrees reads back to is in rad); positions in mm
/// with the fewest digits that read back to the same bits; orientations as
/// rotation vectors in deg that read back to rounding; sigmas likewise when
/// `with_sigmas` (not the correlations of whiteners, and not kUnstatedSigma).
/// What was not measured is an empty cell. Rows are in the order of poses. Each
/// of `comments` is a line behind "# " on top.
/// @pre blocks are of kPosition and kPose.
std::string FormatDataset(const Dataset& dataset, const Arm& arm,
                          int joint_decimals, bool with_sigmas,
                          const std::vector<std::string>& comments);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATAIO_DATASET_CSV_H_
