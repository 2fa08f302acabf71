#ifndef ALIDADE_SRC_DATAIO_ROW_ORIENTATION_H_
#define ALIDADE_SRC_DATAIO_ROW_ORIENTATION_H_

#include <Eigen/Core>
#include <optional>

#include "src/dataio/data_table.h"
#include "src/dataio/dataset_columns.h"
#include "src/dataio/rotation_convention.h"

namespace alidade::internal {

/// Three numbers of a row.
Eigen::Vector3d VectorOf(const TableRow& row, int first);

/// Whether a row states an orientation. @throws InputError where some of its
/// numbers are missing.
bool HasOrientation(const TableRow& row, const DatasetColumns& columns,
                    const MeasuredGroups& groups);

/// Refuses three angles, from `first` on, of more than 10 rad: degrees that are
/// read as radians. @throws InputError.
void RefuseLargeAngles(const TableRow& row, const TableHeader& header,
                       int first);

/// The orientation of a row that has one, by whichever group of columns it is
/// stated; `convention` is that of angles. @throws InputError where a
/// quaternion or a matrix is none.
Eigen::Matrix3d ReadRotation(
    const TableRow& row, const DatasetColumns& columns,
    const MeasuredGroups& groups,
    const std::optional<RotationConvention>& convention);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATAIO_ROW_ORIENTATION_H_
