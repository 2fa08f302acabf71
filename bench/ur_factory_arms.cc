#include "bench/ur_factory_arms.h"

#include <Eigen/Geometry>
#include <array>
#include <nlohmann/json.hpp>

#include "alidade/forward_kinematics.h"
#include "alidade/units.h"
#include "src/common/files.h"
#include "src/common/random.h"
#include "src/compensation/dh_conversion.h"
#include "src/kernel/measurement_model.h"
#include "src/model/joint_draw.h"

namespace alidade::internal {
namespace {

using Json = nlohmann::json;

constexpr double kSigma = 0.05e-3;                 // m
constexpr double kRotationSigma = 0.02 * kDegree;  // rad
constexpr double kLimit = kPi;

// One file has a half turn in its elbow.
constexpr const char* kHalfTurn = "brenhertel/pearl_ur5e";

const std::array<const char*, 6> kLinks = {"shoulder", "upper_arm", "forearm",
                                           "wrist_1",  "wrist_2",   "wrist_3"};

double NumberOf(const Json& value) {
  return value.is_string() ? std::stod(value.get<std::string>())
                           : value.get<double>();
}

Arm ArmOf(const Json& kinematics) {
  std::vector<ChainJoint> chain;
  for (const char* link : kLinks) {
    const Json& origin = kinematics.at(link);
    ChainJoint joint;
    joint.type = ChainJoint::Type::kRevolute;
    joint.parent_from_joint =
        Eigen::Translation3d(NumberOf(origin["x"]), NumberOf(origin["y"]),
                             NumberOf(origin["z"])) *
        Eigen::AngleAxisd(NumberOf(origin["yaw"]), Eigen::Vector3d::UnitZ()) *
        Eigen::AngleAxisd(NumberOf(origin["pitch"]), Eigen::Vector3d::UnitY()) *
        Eigen::AngleAxisd(NumberOf(origin["roll"]), Eigen::Vector3d::UnitX());
    joint.axis = Eigen::Vector3d::UnitZ();
    joint.lower = -kLimit;
    joint.upper = kLimit;
    chain.push_back(joint);
  }
  return ArmFromChain(chain);
}

// The arm in the instrument's frame, with a target on its flange.
Arm Installed(Arm arm) {
  Eigen::Isometry3d place = Eigen::Isometry3d::Identity();
  place.translate(Eigen::Vector3d(2.1, -1.3, 0.4));
  place.rotate(Eigen::AngleAxisd(2.5, Eigen::Vector3d(1, 2, -2).normalized()));
  arm.instrument_from_base = place * arm.instrument_from_base;
  Eigen::Isometry3d target = Eigen::Isometry3d::Identity();
  target.translate(Eigen::Vector3d(0.06, -0.04, 0.11));
  target.rotate(Eigen::AngleAxisd(1.1, Eigen::Vector3d(2, -1, 1).normalized()));
  arm.last_from_target() = arm.last_from_target() * target;
  return arm;
}

}  // namespace

std::vector<FactoryArm> LoadFactoryArms(const std::string& directory) {
  const Json nominal =
      Json::parse(ReadFile(directory + "/nominal_kinematics.json"));
  const Json factory =
      Json::parse(ReadFile(directory + "/factory_calibrations.json"));
  std::vector<FactoryArm> arms;
  for (const Json& robot : factory.at("robots")) {
    FactoryArm arm;
    // Some carry a note after a comma.
    arm.repository = robot.at("repository");
    if (const std::size_t comma = arm.repository.find(',');
        comma < arm.repository.size()) {
      arm.repository = arm.repository.substr(0, comma) + ")";
    }
    arm.has_half_turn = arm.repository == kHalfTurn;
    arm.model = robot.at("model");
    arm.nominal = ArmOf(nominal.at(arm.model));
    arm.real = Installed(ArmOf(robot.at("kinematics")));
    arms.push_back(arm);
  }
  return arms;
}

Dataset MeasureArm(const Arm& arm, MeasurementKind kind, int num_poses,
                   std::uint64_t seed) {
  const MeasurementModel model(arm);
  const Eigen::VectorXd values = model.NominalValues();
  Dataset data;
  data.joint_values = DrawJointValues(arm, num_poses, seed);
  ObservationBlock block;
  block.kind = kind;
  MatrixBuilder measured(RowsOf(kind), num_poses);
  MatrixBuilder sigmas(RowsOf(kind), num_poses);
  for (int i = 0; i < num_poses; ++i) {
    Random random(seed + 1, static_cast<std::uint64_t>(i));
    const auto noise = [&](double sigma) {
      const double x = sigma * random.Normal();
      const double y = sigma * random.Normal();
      return Eigen::Vector3d(x, y, sigma * random.Normal());
    };
    Eigen::Matrix3d rotation;
    const Eigen::Vector3d position =
        TargetPose<double>(arm, ViewOf(model.layout(), values.data()),
                           data.joint_values.col(i).data(), &rotation);
    measured.map().col(i).head<3>() = position + noise(kSigma);
    sigmas.map().col(i).head<3>().setConstant(kSigma);
    if (kind != MeasurementKind::kPose) continue;
    measured.map().col(i).tail<3>() = VectorFromRotation<double>(
        RotationFromVector<double>(noise(kRotationSigma)) * rotation);
    sigmas.map().col(i).tail<3>().setConstant(kRotationSigma);
  }
  block.measured = measured.Freeze();
  block.sigmas = sigmas.Freeze();
  data.blocks.push_back(block);
  return data;
}

}  // namespace alidade::internal
