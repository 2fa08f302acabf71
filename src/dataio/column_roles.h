#ifndef ALIDADE_SRC_DATAIO_COLUMN_ROLES_H_
#define ALIDADE_SRC_DATAIO_COLUMN_ROLES_H_

#include <string>
#include <utility>
#include <vector>

namespace alidade::internal {

/// What the columns of a table seem to hold, by their names: numbers of
/// columns, from 1. Empty where there is nothing of the kind.
struct ColumnRoles {
  std::vector<int> joints;      ///< from the base
  std::vector<int> position;    ///< x, y, z
  std::vector<int> quaternion;  ///< w, x, y, z
  std::vector<int> matrix;      ///< row by row
  std::vector<int> angles;      ///< rx, ry, rz
  /// Of several targets in one row: their names, and x, y, z; in place of
  /// `position`.
  std::vector<std::pair<std::string, std::vector<int>>> targets;
};

/// Finds them in the names that instruments, controllers and people give:
///
///   - a word for a joint and its number, from 0 or 1: "J1 [deg]", "Axis 1",
///     "actual_q_0", "A1";
///   - of six joints "base", "shoulder", "elbow", "wrist 1" to "wrist 3";
///   - one of x, y, z: "X", "Pos X [mm]", "TX", "Measured Y"; what speaks of
///     nominal values, deviations and rotations is none;
///   - x, y, z with the name of one of the arm's targets, where it has
///     several: "SMR1 X";
///   - with words for a rotation, x, y, z and w; "qx", "Rx", "r11".
///
/// A table without names ("1", "2" ...) has the joints first and x, y, z then,
/// where it has just these columns, or one more in front, or the nine or four
/// numbers of an orientation behind.
///
/// @throws InputError naming `path` where the columns of joints or of the
/// position are not there, or there more than once.
ColumnRoles FindColumnRoles(const std::string& path,
                            const std::vector<std::string>& names,
                            int num_joints,
                            const std::vector<std::string>& targets);

/// "joints: [J1, J2], position: [X, Y, Z]": what a job's `columns` says of
/// them, as YAML.
std::string DescribeMapping(const ColumnRoles& roles,
                            const std::vector<std::string>& names);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATAIO_COLUMN_ROLES_H_
