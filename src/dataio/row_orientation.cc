#include "src/dataio/row_orientation.h"

#include <cmath>
#include <string>

#include "alidade/rotation.h"
#include "src/common/names.h"
#include "src/common/number_text.h"
#include "src/common/text.h"
#include "src/dataio/csv_columns.h"

namespace alidade::internal {
namespace {

Eigen::Matrix3d MatrixAt(const TableRow& row, int first) {
  Eigen::Matrix3d matrix;
  for (int i = 0; i < 9; ++i) {
    matrix(i / 3, i % 3) = row.Number(first + i);
  }
  const std::optional<Eigen::Matrix3d> rotation = RotationOfMatrix(matrix);
  if (!rotation) {
    row.Fail(first,
             "the nine numbers are no rotation matrix, expected rows of unit "
             "vectors at right angles, right-handed: are they its rows, first "
             "to third, and no scale is in them?");
  }
  return *rotation;
}

}  // namespace

Eigen::Vector3d VectorOf(const TableRow& row, int first) {
  return {row.Number(first), row.Number(first + 1), row.Number(first + 2)};
}

// All of a row's numbers or none of them.
bool HasOrientation(const TableRow& row, const DatasetColumns& columns,
                    const MeasuredGroups& groups) {
  const int first = groups.quaternion ? columns.quaternion
                    : groups.matrix   ? columns.matrix
                    : groups.vector   ? columns.vector
                                      : columns.angles;
  const int count = groups.quaternion ? 4 : groups.matrix ? 9 : 3;
  int missing = 0;
  int one = -1;
  for (int i = first + count - 1; i >= first; --i) {
    if (!std::isnan(row.Number(i))) continue;
    ++missing;
    one = i;
  }
  if (missing > 0 && missing < count) {
    row.Fail(one,
             "an orientation is measured as a whole: expected a "
             "number here, or none in its other cells, found " +
                 (row.Text(one).empty() ? std::string("nothing")
                                        : Quote(row.Text(one))));
  }
  return missing == 0;
}

void RefuseLargeAngles(const TableRow& row, const TableHeader& header,
                       int first) {
  constexpr double kMost = 10.0;  // rad
  for (int i = first; i < first + 3; ++i) {
    if (!(std::abs(row.Number(i)) > kMost)) continue;
    const Unit* const unit =
        header.columns()[static_cast<std::size_t>(header.ColumnOf(i))].unit;
    if (unit == nullptr || unit->InSi() != 1.0) continue;
    const std::string name(WithoutUnit(header.NameOf(i)));
    row.Fail(i, "found " + ShortestNumber(row.Number(i)) +
                    " rad, an angle of an orientation of more than 10 rad: are "
                    "these degrees? A header may say so (" +
                    name +
                    "_deg), `unit` of the job's `columns` ([mm, rad, deg]: of "
                    "lengths, joints and orientations), or "
                    "--units=mm,rad,deg of `import`");
  }
}

Eigen::Matrix3d ReadRotation(
    const TableRow& row, const DatasetColumns& columns,
    const MeasuredGroups& groups,
    const std::optional<RotationConvention>& convention) {
  if (groups.vector) {
    return RotationFromVector<double>(VectorOf(row, columns.vector));
  }
  if (groups.angles) {
    return RotationOf(*convention, VectorOf(row, columns.angles));
  }
  if (groups.matrix) return MatrixAt(row, columns.matrix);
  const int first = columns.quaternion;
  const Eigen::Vector4d quaternion(row.Number(first), row.Number(first + 1),
                                   row.Number(first + 2),
                                   row.Number(first + 3));
  const std::optional<Eigen::Matrix3d> rotation =
      RotationOfQuaternion(quaternion);
  if (!rotation) {
    row.Fail(first, "the quaternion's norm is " +
                        ShortestNumber(quaternion.norm()) +
                        ", expected 1 to within 0.001: are its columns "
                        "w, x, y, z?");
  }
  return *rotation;
}

}  // namespace alidade::internal
