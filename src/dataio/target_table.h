#ifndef ALIDADE_SRC_DATAIO_TARGET_TABLE_H_
#define ALIDADE_SRC_DATAIO_TARGET_TABLE_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "alidade/arm.h"
#include "src/dataio/rotation_convention.h"

namespace alidade::internal {

enum class OrientationForm { kNone, kAngles, kQuaternion, kVector };

/// How poses stand in a table.
struct PoseFormat {
  OrientationForm form = OrientationForm::kVector;
  RotationConvention rotation;  ///< of kAngles
  std::string length = "mm";    ///< units of the columns
  std::string angle = "deg";
};

/// Targets of a CSV in the columns that data sets have: joint values q1_deg
/// ..., positions x_mm ..., orientations rx_deg ... (in a stated convention),
/// qw, qx, qy, qz or wx_deg ...; other columns are passed over.
struct TargetTable {
  std::string path;
  std::string text;  ///< of the whole file
  bool has_joints = false;
  bool has_positions = false;
  Eigen::MatrixXd motors;  ///< n x N; 0 x 0 without joint columns
  /// Empty without position columns; without orientation columns not turned.
  std::vector<Eigen::Isometry3d> poses;
  PoseFormat format;  ///< kNone without orientation columns
  /// 3 x N: orientation numbers as written, which angles are kept near to.
  Eigen::Matrix3Xd numbers;
  std::vector<std::string> names;  ///< of a column "name"; empty without
  Eigen::Index num_rows = 0;
};

/// Columns of a pose that are empty in all rows count as absent, where there
/// are joint values: data sets to be filled in have them.
/// @throws InputError with line and column: no rows, neither joint values nor
/// positions, some columns of a group without the others, rx ry rz without
/// `rotation`, a cell that is no number.
TargetTable ReadTargets(const std::string& path, const Arm& arm,
                        const std::optional<RotationConvention>& rotation);

/// The same of tools and bases, which may state their orientation as KUKA's
/// pendant does: a_deg, b_deg, c_deg about z, y, x, whatever `rotation` is.
TargetTable ReadFrameTable(const std::string& path, const Arm& arm,
                           const std::optional<RotationConvention>& rotation);

/// A column to add: its name, and a cell for each row.
struct AddedColumn {
  std::string name;
  std::vector<std::string> cells;
};

/// The text of the table with columns added to the right. All else stays byte
/// for byte: comments, blank lines, line ends.
/// @throws InputError where the table has a column of that name.
std::string WithColumns(const TargetTable& table,
                        const std::vector<AddedColumn>& columns);

/// Positions and orientations as columns, each name after `prefix`. Numbers are
/// kept to 1e-9 mm and 1e-10 deg. `near`: TargetTable::numbers, or empty.
std::vector<AddedColumn> PoseColumns(
    const std::string& prefix, const std::vector<Eigen::Isometry3d>& poses,
    const PoseFormat& format, const Eigen::Matrix3Xd& near = {});

/// Joint values (n x N) in deg and mm.
std::vector<AddedColumn> MotorColumns(const std::string& prefix, const Arm& arm,
                                      const Eigen::MatrixXd& motors);

/// One number for each row, `scale` = the unit's size in SI.
AddedColumn NumberColumn(const std::string& name, const Eigen::VectorXd& values,
                         double scale, int decimals);

/// Tools and bases of a table with the columns name, x_mm, y_mm, z_mm and an
/// orientation. @throws InputError.
std::map<std::string, Eigen::Isometry3d> LoadFrames(
    const std::string& path, const Arm& arm,
    const std::optional<RotationConvention>& rotation);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATAIO_TARGET_TABLE_H_
