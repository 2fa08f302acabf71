#ifndef ALIDADE_SRC_DATAIO_URDF_FILE_H_
#define ALIDADE_SRC_DATAIO_URDF_FILE_H_

#include <string>
#include <vector>

#include "src/compensation/dh_conversion.h"

namespace alidade::internal {

/// The joints from `base_link` to `tip_link` of a URDF file, fixed ones
/// included, for ArmFromChain: origins (xyz, rpy), axes and limits as written,
/// in m and rad. Continuous joints have no limits.
/// Orientations of origins are `rpy` or, of URDF 1.1, `quat_xyzw`.
/// @throws InputError with the file (and the line) where it is no XML or not
/// expanded from xacro, a link is unknown, the links are not joined upwards
/// from the tip, a joint between them floats or is planar, its axis is zero,
/// its lower limit is above the upper one, an origin, an axis or a mimic has an
/// attribute that is not known, or none of them moves.
std::vector<ChainJoint> LoadUrdfChain(const std::string& path,
                                      const std::string& base_link,
                                      const std::string& tip_link);

/// The arm of those joints (ArmFromChain). Joints that mimic others are coupled
/// to their motors: the arm has as many motors as joints that mimic none, in
/// the order in which the chain first needs them. Limits of at most 64 joints
/// and all that an arm file must satisfy hold here too. @throws InputError.
Arm LoadUrdfArm(const std::string& path, const std::string& base_link,
                const std::string& tip_link);
/// The same of a file's text; `path` is for messages.
Arm ParseUrdfArm(const std::string& text, const std::string& path,
                 const std::string& base_link, const std::string& tip_link);

/// The names of those joints.
std::vector<std::string> LoadUrdfJointNames(const std::string& path,
                                            const std::string& base_link,
                                            const std::string& tip_link);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATAIO_URDF_FILE_H_
