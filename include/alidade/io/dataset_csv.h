#ifndef ALIDADE_IO_DATASET_CSV_H_
#define ALIDADE_IO_DATASET_CSV_H_

#include <string>
#include <vector>

#include "alidade/measurement/dataset.h"
#include "alidade/model/arm.h"

namespace alidade {

/// Headers of a file that was not written for Alidade: which of its columns
/// hold what. Each ends in its unit ("q1_cmd_deg", "smr2_x_mm"); all others are
/// passed over. Empty lists leave the usual names.
struct ColumnMapping {
  std::vector<std::string> joints;    ///< one per joint, from the base
  std::vector<std::string> position;  ///< x, y, z
};

/// Reads measured positions. Lines that begin with '#' are comments; the first
/// other line is the header. Columns, in any order: q1_deg or q1_rad
/// (revolute), q1_mm or q1_m (prismatic) ... for every joint; x_mm y_mm z_mm
/// (or _m); optionally std_x_mm std_y_mm std_z_mm (or _m), else `default_sigma`
/// (m) is used. @throws InputError with file, line and column name.
Dataset LoadDataset(const std::string& path, const Arm& arm,
                    double default_sigma);

/// The same of a file with other headers: a mapping of nothing passes over the
/// columns that are none of the usual ones.
/// @pre the mapping's lists are empty or as long as they should be.
Dataset LoadMappedDataset(const std::string& path, const Arm& arm,
                          double default_sigma, const ColumnMapping& mapping);

/// Reads only the joint columns; others are allowed and ignored.
Eigen::MatrixXd LoadJointValues(const std::string& path, const Arm& arm);

/// The text of a data set that LoadDataset reads back: joint values in deg and
/// mm with `joint_decimals` decimals, positions in mm with the fewest digits
/// that read back to the same bits, sigmas likewise when `with_sigmas`. Each of
/// `comments` is a line behind "# " on top.
std::string FormatDataset(const Dataset& dataset, const Arm& arm,
                          int joint_decimals, bool with_sigmas,
                          const std::vector<std::string>& comments);

}  // namespace alidade

#endif  // ALIDADE_IO_DATASET_CSV_H_
