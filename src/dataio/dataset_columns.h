#ifndef ALIDADE_SRC_DATAIO_DATASET_COLUMNS_H_
#define ALIDADE_SRC_DATAIO_DATASET_COLUMNS_H_

#include <vector>

#include "alidade/arm.h"
#include "src/dataio/csv_columns.h"
#include "src/dataio/data_format.h"
#include "src/dataio/table_header.h"

namespace alidade::internal {

/// The columns that a data set may have, and where each stands in `specs`:
/// the index of the first one of a group (three axes, say).
struct DatasetColumns {
  std::vector<ColumnSpec> specs;  ///< joints first
  int position = 0;               ///< x y z
  int position_sigma = 0;
  int covariance = 0;   ///< xx xy xz yy yz zz
  int angles = 0;       ///< rx ry rz
  int angle_sigma = 0;  ///< of these numbers
  int vector = 0;       ///< wx wy wz
  int turn_sigma = 0;   ///< of small turns about x y z
  int quaternion = 0;   ///< qw qx qy qz
  int matrix = 0;       ///< r11 r12 r13 r21 ... r33
  int distance = 0;
  int distance_sigma = 0;
  int difference = 0;  ///< dx dy dz
  int difference_sigma = 0;
  int from = 0;
  int plane = 0;
  int target = 0;
  int set = 0;
  int station = 0;
  int covariates = 0;
  int num_covariates = 0;
  std::vector<int> point;             ///< the parts of its name
  std::vector<int> target_positions;  ///< x of each mapped target
};

/// The usual columns of an arm's data sets, with the format's mapping.
DatasetColumns MakeDatasetColumns(const Arm& arm, const DataFormat& format);

/// What a file measures, as its header says.
struct MeasuredGroups {
  bool position = false;
  bool covariance = false;
  bool angles = false;
  bool vector = false;
  bool quaternion = false;
  bool matrix = false;
  bool distance = false;
  bool fixed_point = false;
  bool plane = false;
  bool difference = false;

  bool orientation() const { return angles || vector || quaternion || matrix; }
  bool positions_alone() const {
    return position && !(covariance || orientation() || distance ||
                         fixed_point || plane || difference);
  }
};

/// Checks that the columns of a table go together. @throws InputError.
MeasuredGroups CheckColumns(const DatasetColumns& columns,
                            const DataFormat& format, const Arm& arm,
                            const TableHeader& header);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATAIO_DATASET_COLUMNS_H_
