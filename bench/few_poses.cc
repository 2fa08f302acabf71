// Simulated arms whose poses determine little: what priors cost and bring where
// they are right, too narrow or too wide. A table of docs/real_arms.md.
//
// Usage: few_poses SOURCE_DIRECTORY TRIALS

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "alidade/arm_file.h"
#include "alidade/calibration.h"
#include "alidade/forward_kinematics.h"
#include "alidade/units.h"
#include "bench/study_main.h"
#include "src/common/random.h"
#include "src/model/joint_draw.h"

namespace alidade::internal {
namespace {

constexpr double kSigma = 1e-4;  // m
constexpr int kOthers = 200;     // poses

// Of the real arm, in units of the priors (5 mrad, 1 mm).
constexpr std::array<double, 3> kSizes = {0.3, 1.0, 3.0};

Arm Moved(Arm arm, double size, Random* random) {
  for (Joint& joint : arm.joints) {
    for (double* value : {&joint.alpha, &joint.beta, &joint.theta}) {
      *value += 5e-3 * size * random->Normal();
    }
    for (double* value : {&joint.d, &joint.r}) {
      *value += 1e-3 * size * random->Normal();
    }
  }
  return arm;
}

Dataset Measure(const Arm& real, int poses, std::uint64_t seed) {
  const Eigen::MatrixXd joints = DrawJointValues(real, poses, seed);
  Eigen::Matrix3Xd points = TargetPositions(real, joints);
  Random random(seed, 1u << 20);
  for (double& value : points.reshaped()) value += kSigma * random.Normal();
  return MakePositions(joints, points, kSigma);
}

// How one way of calibrating did.
struct Way {
  WeakPolicy policy = WeakPolicy::kPrior;
  PriorScale scale = PriorScale::kGiven;
  std::vector<double> errors = {};  // mm
  int worse = 0;                    // than before
  int warned = 0;                   // that the priors cost accuracy

  // `truth`: of the validation poses, without noise.
  void Add(const CalibrationResult& result, const Eigen::Matrix3Xd& truth) {
    if (!result.IsUsable()) return;
    const double before = result.validation->before.mean;
    errors.push_back(
        (TargetPositions(result.arm, result.validation->joint_values.map()) -
         truth)
            .colwise()
            .norm()
            .mean() /
        kMillimetre);
    if (errors.back() * kMillimetre > before) ++worse;
    for (const std::string& warning : result.warnings) {
      if (warning.find(" mrad pull") != std::string::npos) ++warned;
    }
  }

  double Mean() const {
    double sum = 0.0;
    for (const double error : errors) sum += error;
    return sum / static_cast<double>(errors.size());
  }
};

std::string Cell(const Way& way, int trials) {
  if (way.errors.empty()) return "refused";
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.3f", way.Mean());
  std::string cell = text.data();
  if (static_cast<int>(way.errors.size()) < trials) {
    cell += " (" + std::to_string(way.errors.size()) + ")";
  }
  return cell;
}

void Compare(const Arm& nominal, double size, int poses, int trials) {
  std::array<Way, 3> ways = {Way{},
                             Way{WeakPolicy::kPrior, PriorScale::kEstimated},
                             Way{WeakPolicy::kKeep, PriorScale::kGiven}};
  for (int trial = 0; trial < trials; ++trial) {
    Random random(31, static_cast<std::uint64_t>(trial));
    const Arm real = Moved(nominal, size, &random);
    const auto seed = static_cast<std::uint64_t>(2 * trial + 1);
    CalibrationData data(Measure(real, poses, seed));
    const Dataset others = Measure(real, kOthers, seed + 1);
    data.validation = others;
    for (Way& way : ways) {
      CalibrationOptions options;
      options.identifiability.candidates = {true, true, true};
      options.identifiability.policy = way.policy;
      options.prior_scale = way.scale;
      options.estimate_sigma = true;
      options.uncertainty.map_configurations = 0;
      way.Add(Calibrate(nominal, data, options),
              TargetPositions(real, others.joint_values.map()));
    }
  }
  std::printf("| %s | %.1f | %d | %s | %d | %d | %s | %s | %d |\n",
              nominal.name.c_str(), size, poses, Cell(ways[0], trials).c_str(),
              ways[0].worse, ways[0].warned, Cell(ways[1], trials).c_str(),
              Cell(ways[2], trials).c_str(), ways[2].worse);
  std::fflush(stdout);
}

bool Run(const std::vector<std::string>& arguments) {
  if (arguments.size() != 2) return false;
  const int trials = std::stoi(arguments[1]);
  std::printf(
      "| arm | size | poses | with priors | worse than before | warned | "
      "estimated priors | without | worse than before |\n"
      "|---|---|---|---|---|---|---|---|---|\n");
  for (const char* name : {"panda", "lifting_column"}) {
    Arm nominal = LoadArm(arguments[0] + "/configs/robots/" + name + ".yaml");
    nominal.last_from_target().translation() << 0.05, 0.03, 0.1;
    for (const double size : kSizes) {
      for (const int poses : {10, 15, 20, 30}) {
        Compare(nominal, size, poses, trials);
      }
    }
  }
  return true;
}

}  // namespace
}  // namespace alidade::internal

int main(int argc, char** argv) {
  return alidade::internal::bench::StudyMain(
      argc, argv, "few_poses SOURCE_DIRECTORY TRIALS", alidade::internal::Run);
}
