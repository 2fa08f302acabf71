#ifndef ALIDADE_SRC_DATAIO_PLAIN_LAYOUT_H_
#define ALIDADE_SRC_DATAIO_PLAIN_LAYOUT_H_

#include <optional>
#include <string>
#include <vector>

#include "alidade/arm.h"
#include "alidade/dataset.h"
#include "src/dataio/data_format.h"
#include "src/dataio/dataset_columns.h"
#include "src/dataio/row_reader.h"

namespace alidade::internal {

/// How a plain data set states orientations.
enum class PlainOrientation { kNone, kQuaternion, kVector, kAngles };

/// Where the numbers of one row of a plain data set stand in a buffer, in SI.
struct RowSlots {
  explicit RowSlots(int num_joints)
      : position(num_joints),
        position_sigma(num_joints + 3),
        orientation(num_joints + 6),
        turn_sigma(num_joints + 10),
        size(num_joints + 13) {}

  int position;        ///< x y z; joints stand before
  int position_sigma;  ///< of each
  int orientation;     ///< quaternion w x y z; vector or angles: three
  int turn_sigma;      ///< of small turns about x y z
  int size;
};

/// A column of the file and what becomes of its cells.
struct PlainColumn {
  enum class Use { kPassedOver, kNumber, kTarget, kSet };

  Use use = Use::kPassedOver;
  // Of numbers:
  int slot = 0;
  Unit unit = {"", Dimension::kLength, 0, 1.0};
  CellRule rule = CellRule::kMeasured;
};

/// The layout of a plain data set: every row is one position or one pose of one
/// target. Nearly all large files are like that, and can be read without an
/// object for each row.
struct PlainLayout {
  explicit PlainLayout(int num_joints)
      : slots(num_joints), defaults(slots.size, 0.0) {}

  RowSlots slots;
  std::vector<PlainColumn> columns;  ///< in the file's order
  /// What a row holds before its cells are read: NaN where there is no column,
  /// the sigmas of rows that state none.
  std::vector<double> defaults;
  PlainOrientation orientation = PlainOrientation::kNone;
  std::optional<RotationConvention> convention;  ///< of kAngles
  std::vector<std::string> target_names;         ///< the arm's
  int target = 0;                                ///< of rows that name none
  bool has_target = false;                       ///< a column names it
  bool has_set = false;
  bool states_sigmas = false;  ///< a column is one of sigmas

  int num_joints() const { return slots.position; }
  /// Those of all rows where no column states them: RowsOf(kind()).
  Eigen::VectorXd DefaultSigmas() const;
  MeasurementKind kind() const {
    return orientation == PlainOrientation::kNone ? MeasurementKind::kPosition
                                                  : MeasurementKind::kPose;
  }
};

/// The header's columns, as DatasetReader has read them.
struct ReadHeader {
  const DatasetColumns& columns;
  const MeasuredGroups& groups;
  const RowReader& rows;
};

/// The layout of the file, or nothing where it is not plain: other kinds,
/// covariances, sigmas of angles, several targets in a row, rows chosen by
/// `where`, an unknown target.
std::optional<PlainLayout> MakePlainLayout(const ReadHeader& header,
                                           const Arm& arm,
                                           const DataFormat& format,
                                           double rotation_sigma);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATAIO_PLAIN_LAYOUT_H_
