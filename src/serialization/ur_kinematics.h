#ifndef ALIDADE_SRC_SERIALIZATION_UR_KINEMATICS_H_
#define ALIDADE_SRC_SERIALIZATION_UR_KINEMATICS_H_

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "alidade/arm.h"
#include "src/serialization/yaml_reader.h"

namespace alidade::internal {

/// The kinematics file of Universal Robots' ROS driver
/// (`calibration_correction` writes it, `kinematics_params_file` of the
/// description reads it): for each of six links its pose in the link before, x,
/// y, z (m) and roll, pitch, yaw about fixed axes (rad), the joint turning
/// about z after it.

/// Whether a YAML file is one: it has `kinematics` and no `format`.
bool IsUrKinematics(const YamlValue& root);

/// The arm of such a file, from the frame before the first link (the base of
/// the controller) to the last link (the flange). @throws InputError.
Arm ReadUrKinematics(const YamlValue& root, const std::string& path);

/// Such a file of six origins.
std::string FormatUrKinematics(const std::vector<Eigen::Isometry3d>& origins);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_UR_KINEMATICS_H_
