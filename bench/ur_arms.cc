// Simulated calibrations of arms whose true geometry is known: the factory
// calibrations of Universal Robots arms against their nominal kinematics. What
// a calibration leaves in the whole workspace beside what its covariance
// predicts; a table of docs/real_arms.md.
//
// Usage: ur_arms DATA_DIRECTORY   (the folder ur_factory_calibrations)

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/base/random.h"
#include "alidade/base/units.h"
#include "alidade/batch/job.h"
#include "alidade/identifiability/observability.h"
#include "alidade/identifiability/rules.h"
#include "alidade/io/files.h"
#include "alidade/measurement/compression.h"
#include "alidade/model/dh_conversion.h"
#include "alidade/model/forward_kinematics.h"
#include "alidade/model/joint_draw.h"

namespace alidade {
namespace {

using Json = nlohmann::json;

constexpr int kPoses = 60;
constexpr int kWorkspacePoses = 2000;
constexpr double kSigma = 0.05e-3;                 // m
constexpr double kRotationSigma = 0.02 * kDegree;  // rad
constexpr double kLimit = kPi;
constexpr int kThreads = 2;

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

Dataset Measure(const Arm& arm, MeasurementKind kind, std::uint64_t seed) {
  const MeasurementModel model(arm);
  const Eigen::VectorXd values = model.NominalValues();
  Dataset data;
  data.joint_values = DrawJointValues(arm, kPoses, seed);
  ObservationBlock block;
  block.kind = kind;
  block.measured.resize(RowsOf(kind), kPoses);
  block.sigmas.resize(RowsOf(kind), kPoses);
  for (int i = 0; i < kPoses; ++i) {
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
    block.measured.col(i).head<3>() = position + noise(kSigma);
    block.sigmas.col(i).head<3>().setConstant(kSigma);
    if (kind != MeasurementKind::kPose) continue;
    block.measured.col(i).tail<3>() = VectorFromRotation<double>(
        RotationFromVector<double>(noise(kRotationSigma)) * rotation);
    block.sigmas.col(i).tail<3>().setConstant(kRotationSigma);
  }
  data.blocks.push_back(block);
  return data;
}

double Rms(const Eigen::Matrix3Xd& errors) {
  return std::sqrt(errors.squaredNorm() / static_cast<double>(errors.cols()));
}

// What the covariance of the fit says of the position error over `poses`.
double PredictedRms(const JobOutcome& outcome, const Dataset& data,
                    const Eigen::MatrixXd& poses) {
  const MeasurementModel model(outcome.calibrated, kThreads);
  const IdentifiabilityResult& pass = outcome.result.identifiability;
  const std::vector<int> free = FreeColumns(pass);
  Eigen::VectorXd priors(static_cast<Eigen::Index>(free.size()));
  for (std::size_t k = 0; k < free.size(); ++k) {
    const double prior = pass.decisions[free[k]].prior_std;
    priors[static_cast<Eigen::Index>(k)] =
        std::isfinite(prior) ? prior : std::numeric_limits<double>::infinity();
  }
  const Eigen::VectorXd values = model.NominalValues();
  const Dataset workspace =
      MakePositions(poses, Eigen::Matrix3Xd::Zero(3, poses.cols()),
                    Eigen::Matrix3Xd::Ones(3, poses.cols()));
  return PredictTotal(JacobianFactor(model, values, data, free), priors,
                      JacobianFactor(model, values, workspace, free)) /
         std::sqrt(static_cast<double>(poses.cols()));
}

std::string Millimetres(double metres) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.4f", metres / kMillimetre);
  return text.data();
}

// The true error over the predicted one.
double Calibrate(const std::string& name, const Arm& nominal, const Arm& real,
                 MeasurementKind kind, std::uint64_t seed) {
  constexpr std::uint64_t kWorkspaceSeed = 12;
  JobConfig job;
  job.arm = nominal;
  job.data = Measure(real, kind, seed);
  job.identifiability.candidates = {true, true, true};
  const JobOutcome outcome = RunJob(job, "ur_arms", kThreads);
  const Eigen::MatrixXd poses =
      DrawJointValues(nominal, kWorkspacePoses, kWorkspaceSeed);
  const MeasurementModel truth(real);
  const MeasurementModel found(outcome.calibrated);
  const double error = Rms(found.Predict(found.NominalValues(), poses) -
                           truth.Predict(truth.NominalValues(), poses));
  const double predicted = PredictedRms(outcome, job.data, poses);
  std::array<char, 16> ratio{};
  std::snprintf(ratio.data(), ratio.size(), "%.2f", error / predicted);
  std::cout << "| " << name << " | " << NameOf(kind) << " | "
            << outcome.result.identifiability.num_free << " | "
            << Millimetres(outcome.result.train.before.rms) << " | "
            << Millimetres(error) << " | " << Millimetres(predicted) << " | "
            << ratio.data() << " |" << std::endl;
  return error / predicted;
}

int Run(const std::string& directory) {
  const Json nominal =
      Json::parse(ReadFile(directory + "/nominal_kinematics.json"));
  const Json factory =
      Json::parse(ReadFile(directory + "/factory_calibrations.json"));
  std::cout << "| arm | measured | free | before, rms | true error, rms | "
               "predicted | ratio |\n|---|---|---|---|---|---|---|"
            << std::endl;
  std::uint64_t seed = 101;
  double squares = 0.0;
  int count = 0;
  for (const Json& robot : factory.at("robots")) {
    // Some carry a note behind a comma.
    std::string repository = robot.at("repository");
    if (const std::size_t comma = repository.find(',');
        comma < repository.size()) {
      repository = repository.substr(0, comma) + ")";
    }
    if (repository == kHalfTurn) continue;
    const std::string model = robot.at("model");
    const Arm real = Installed(ArmOf(robot.at("kinematics")));
    for (const MeasurementKind kind :
         {MeasurementKind::kPosition, MeasurementKind::kPose}) {
      const double ratio =
          Calibrate(model + ", " + repository, ArmOf(nominal.at(model)), real,
                    kind, seed);
      squares += ratio * ratio;
      ++count;
      seed += 2;  // one for the poses, the next for the noise
    }
  }
  std::array<char, 16> rms{};
  std::snprintf(rms.data(), rms.size(), "%.2f", std::sqrt(squares / count));
  std::cout << "| root mean square of " << count << " | | | | | | "
            << rms.data() << " |" << std::endl;
  return EXIT_SUCCESS;
}

}  // namespace
}  // namespace alidade

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: ur_arms DATA_DIRECTORY\n";
    return 2;
  }
  try {
    return alidade::Run(argv[1]);
  } catch (const std::exception& error) {
    std::cerr << "ur_arms: " << error.what() << "\n";
    return 2;
  }
}
