// Simulated calibrations of arms whose true geometry is known: the factory
// calibrations of Universal Robots arms against their nominal kinematics. What
// a calibration leaves in the whole workspace beside what its covariance
// predicts; a table of docs/real_arms.md.
//
// Usage: ur_arms DATA_DIRECTORY   (the folder ur_factory_calibrations)

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <limits>
#include <string>
#include <vector>

#include "alidade/units.h"
#include "bench/study_main.h"
#include "bench/ur_factory_arms.h"
#include "src/identifiability/observability.h"
#include "src/identifiability/rules.h"
#include "src/job/run_job.h"
#include "src/kernel/reduction.h"
#include "src/model/joint_draw.h"

namespace alidade::internal {
namespace {

constexpr int kPoses = 60;
constexpr int kWorkspacePoses = 2000;
constexpr int kThreads = 2;

double Rms(const Eigen::Matrix3Xd& errors) {
  return std::sqrt(errors.squaredNorm() / static_cast<double>(errors.cols()));
}

// What the covariance of the fit says of the position error over `poses`.
double PredictedRms(const CalibrationResult& outcome, const Dataset& data,
                    const Eigen::MatrixXd& poses) {
  const MeasurementModel model(outcome.arm, kThreads);
  const IdentifiabilityResult& pass = outcome.identifiability;
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
  job.data.training = MeasureArm(real, kind, kPoses, seed);
  job.options.identifiability.candidates = {true, true, true};
  job.options.num_threads = kThreads;
  const CalibrationResult outcome = RunJob(job, "ur_arms");
  const Eigen::MatrixXd poses =
      DrawJointValues(nominal, kWorkspacePoses, kWorkspaceSeed);
  const MeasurementModel truth(real);
  const MeasurementModel found(outcome.arm);
  const double error = Rms(found.Predict(found.NominalValues(), poses) -
                           truth.Predict(truth.NominalValues(), poses));
  const double predicted = PredictedRms(outcome, job.data.training, poses);
  std::array<char, 16> ratio{};
  std::snprintf(ratio.data(), ratio.size(), "%.2f", error / predicted);
  std::cout << "| " << name << " | " << NameOf(kind) << " | "
            << outcome.identifiability.num_free << " | "
            << Millimetres(outcome.train.before.rms) << " | "
            << Millimetres(error) << " | " << Millimetres(predicted) << " | "
            << ratio.data() << " |" << std::endl;
  return error / predicted;
}

bool Run(const std::vector<std::string>& arguments) {
  if (arguments.size() != 1) return false;
  std::cout << "| arm | measured | free | before, rms | true error, rms | "
               "predicted | ratio |\n|---|---|---|---|---|---|---|"
            << std::endl;
  std::uint64_t seed = 101;
  double squares = 0.0;
  int count = 0;
  for (const FactoryArm& arm : LoadFactoryArms(arguments[0])) {
    if (arm.has_half_turn) continue;
    for (const MeasurementKind kind :
         {MeasurementKind::kPosition, MeasurementKind::kPose}) {
      const double ratio = Calibrate(arm.model + ", " + arm.repository,
                                     arm.nominal, arm.real, kind, seed);
      squares += ratio * ratio;
      ++count;
      seed += 2;  // one for the poses, the next for the noise
    }
  }
  std::array<char, 16> rms{};
  std::snprintf(rms.data(), rms.size(), "%.2f", std::sqrt(squares / count));
  std::cout << "| root mean square of " << count << " | | | | | | "
            << rms.data() << " |" << std::endl;
  return true;
}

}  // namespace
}  // namespace alidade::internal

int main(int argc, char** argv) {
  return alidade::internal::bench::StudyMain(
      argc, argv, "ur_arms DATA_DIRECTORY", alidade::internal::Run);
}
