#include "src/serialization/ur_kinematics.h"

#include <array>
#include <cmath>
#include <filesystem>

#include "src/common/files.h"
#include "src/common/number_text.h"
#include "src/compensation/dh_conversion.h"
#include "src/dataio/rotation_convention.h"

namespace alidade::internal {
namespace {

constexpr std::array kLinks = {"shoulder", "upper_arm", "forearm",
                               "wrist_1",  "wrist_2",   "wrist_3"};
constexpr std::array kNumbers = {"x", "y", "z", "roll", "pitch", "yaw"};
// Digits of the hash that the driver compares with the robot's.
constexpr std::size_t kHashDigits = 16;

const RotationConvention kRollPitchYaw = {false, false, {0, 1, 2}};

Eigen::Isometry3d ReadOrigin(const YamlMap& link) {
  Eigen::Matrix<double, 6, 1> numbers;
  for (int k = 0; k < 6; ++k) {
    numbers[k] = link.Required(kNumbers[k]).Number();
  }
  Eigen::Isometry3d origin = Eigen::Isometry3d::Identity();
  origin.translation() = numbers.head<3>();
  origin.linear() = RotationOf(kRollPitchYaw, numbers.tail<3>());
  return origin;
}

}  // namespace

bool IsUrKinematics(const YamlValue& root) {
  return root.Find("kinematics").has_value() &&
         !root.Find("format").has_value();
}

Arm ReadUrKinematics(const YamlValue& root, const std::string& path) {
  std::vector<std::string> keys(kLinks.begin(), kLinks.end());
  keys.emplace_back("hash");
  const YamlMap links =
      root.Map({"kinematics"}).Required("kinematics").Map(keys);
  std::vector<ChainJoint> chain;
  for (const char* name : kLinks) {
    const YamlMap link =
        links.Required(name).Map({kNumbers.begin(), kNumbers.end()});
    ChainJoint joint;
    joint.parent_from_joint = ReadOrigin(link);
    joint.axis = Eigen::Vector3d::UnitZ();
    chain.push_back(joint);
  }
  ChainJoint flange;
  flange.type = ChainJoint::Type::kFixed;
  chain.push_back(flange);
  Arm arm = ArmFromChain(chain);
  // The last link is its joint's: what it is along and about the axis commutes
  // with the joint's own rotation, and nothing else is left.
  Eigen::Isometry3d& last_from_flange = arm.last_from_target();
  const Eigen::Matrix3d turn = last_from_flange.linear();
  arm.joints.back().r += last_from_flange.translation().z();
  arm.joints.back().theta += std::atan2(turn(1, 0), turn(0, 0));
  last_from_flange.setIdentity();
  arm.name = std::filesystem::path(path).stem().string();
  return arm;
}

std::string FormatUrKinematics(const std::vector<Eigen::Isometry3d>& origins) {
  std::string text = "kinematics:\n";
  for (std::size_t j = 0; j < kLinks.size(); ++j) {
    Eigen::Matrix<double, 6, 1> numbers;
    numbers << origins[j].translation(),
        NumbersOf(kRollPitchYaw, origins[j].linear(), Eigen::Vector3d::Zero());
    text += std::string("  ") + kLinks[j] + ":\n";
    for (int k = 0; k < 6; ++k) {
      text += std::string("    ") + kNumbers[k] + ": " +
              ShortestNumber(numbers[k]) + "\n";
    }
  }
  return text + "  hash: calib_" + Sha256(text).substr(0, kHashDigits) + "\n";
}

}  // namespace alidade::internal
