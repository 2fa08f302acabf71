#ifndef ALIDADE_SRC_SERIALIZATION_ARM_FIELDS_H_
#define ALIDADE_SRC_SERIALIZATION_ARM_FIELDS_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <utility>
#include <vector>

#include "alidade/arm.h"
#include "alidade/rotation.h"
#include "src/common/option_fields.h"
#include "src/serialization/field_records.h"

namespace alidade::internal {

/// What arm files and files of deviations say (alidade/arm_file.h reads them).
std::vector<FieldRecord> ArmFields();
std::vector<FieldRecord> DeviationsFields();

template <>
inline constexpr std::array kWords<JointType> = {
    std::pair{JointType::kRevolute, "revolute"},
    std::pair{JointType::kPrismatic, "prismatic"},
};

/// A frame as files state it.
struct FrameNumbers {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Vector3d rotation = Eigen::Vector3d::Zero();

  Eigen::Isometry3d Frame() const {
    Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
    frame.translation() = position;
    frame.linear() = RotationFromVector<double>(rotation);
    return frame;
  }
};

/// The fields that FormatArm writes, too.
template <typename Visitor>
void VisitFrame(Visitor& v, Subject<Visitor, FrameNumbers>& frame) {
  constexpr std::array kAxes = {"x", "y", "z"};
  constexpr std::array kTurns = {"rx", "ry", "rz"};
  for (int k = 0; k < 3; ++k) {
    v.Field(LengthKey(kAxes[k]), frame.position[k], "of the origin");
  }
  for (int k = 0; k < 3; ++k) {
    v.Field(AngleKey(kTurns[k]), frame.rotation[k],
            "of the rotation vector, axis times angle");
  }
}

template <typename Visitor>
void VisitKhalil(Visitor& v, Subject<Visitor, Joint>& joint) {
  v.Field(AngleKey("beta"), joint.beta, "about y; `khalil` alone");
  v.Field(AngleKey("alpha"), joint.alpha, "about x");
  v.Field(LengthKey("d"), joint.d,
          "along x; in `craig` and `standard` along z, Khalil's r");
  v.Field(AngleKey("theta"), joint.theta, "about z");
  v.Field(LengthKey("r"), joint.r, "along z; `khalil` alone");
}

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_ARM_FIELDS_H_
