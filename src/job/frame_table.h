#ifndef ALIDADE_SRC_JOB_FRAME_TABLE_H_
#define ALIDADE_SRC_JOB_FRAME_TABLE_H_

#include <string>

#include "alidade/arm.h"
#include "src/dataio/target_table.h"
#include "src/uncertainty/covariance.h"

namespace alidade::internal {

/// Base and targets as a CSV, which `correct --frames` reads: a row for each
/// target ("tool" where it has no name), one for `base`, the arm's base in the
/// instrument's frame, and one for `instrument`, the inverse: the instrument's
/// frame, or that of the object whose points were touched, in the base.
/// Targets are those in the flange, as controllers have tools; it stands at
/// `last_from_flange` in the last joint's frame.
///
/// Where `covariance` is not null, also standard deviations of the origin and
/// of the rotation vector on the left, in the axes that the row is stated in:
/// infinite where nothing determines them, empty where nothing was identified.
std::string FormatFrames(const Arm& arm,
                         const Eigen::Isometry3d& last_from_flange,
                         const ParameterCovariance* covariance,
                         const PoseFormat& format);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_JOB_FRAME_TABLE_H_
