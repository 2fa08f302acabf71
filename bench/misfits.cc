// Arms with errors that rigid geometry does not describe: whether predictions
// contain them and warnings name them. The numbers behind docs/misfit.md. Run
// by scripts/misfits.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "alidade/arm_file.h"
#include "alidade/calibration.h"
#include "alidade/forward_kinematics.h"
#include "alidade/units.h"
#include "bench/study_main.h"
#include "src/common/random.h"
#include "src/model/joint_draw.h"
#include "src/uncertainty/lack_of_fit.h"

namespace alidade::internal {
namespace {

constexpr double kSigma = 2e-5;  // m
constexpr int kPoses = 60;

// What a real arm does at joint values that it is sent to, at a time from 0 to
// 1, coming from other joint values.
struct Command {
  Eigen::VectorXd joints;
  Eigen::VectorXd before;
  double time = 0.0;
};

// Rigid arms, and errors of a size: 1 is some 10 arcsec or 0.03 mm.
using Misfit =
    std::function<Eigen::Vector3d(const Arm&, const Command&, double)>;

Eigen::Vector3d Position(const Arm& arm, const Eigen::VectorXd& joints) {
  return TargetPosition<double>(
      arm,
      ViewOf(ParameterLayout(arm), ParameterLayout(arm).Values(arm).data()),
      joints.data());
}

// By its definition, with forward kinematics alone: the moment of weights at
// the target and halfway to it about the axis of joint j, by which a small
// rotation of that joint lifts them.
double Moment(const Arm& arm, const Eigen::VectorXd& joints, int j) {
  constexpr double kStep = 1e-6;
  Eigen::VectorXd moved = joints;
  moved[j] += kStep;
  const Eigen::Vector3d up = arm.instrument_from_base.linear().col(2);
  Arm wrist = arm;
  wrist.last_from_target().translation().setZero();
  return (2.0 * (Position(arm, moved) - Position(arm, joints)) +
          (Position(wrist, moved) - Position(wrist, joints)))
             .dot(up) /
         (kStep * Reach(arm));
}

Eigen::Vector3d Elastic(const Arm& arm, const Command& at, double size) {
  Eigen::VectorXd joints = at.joints;
  for (int j = 1; j < arm.num_joints(); ++j) {
    joints[j] -= 5e-5 * size / j * Moment(arm, at.joints, j);
  }
  return Position(arm, joints);
}

Eigen::Vector3d Harmonic(const Arm& arm, const Command& at, double size) {
  Eigen::VectorXd joints = at.joints;
  joints[1] += 5e-5 * size * std::sin(2.0 * at.joints[1] + 0.7);
  return Position(arm, joints);
}

Eigen::Vector3d Backlash(const Arm& arm, const Command& at, double size) {
  Eigen::VectorXd joints = at.joints;
  for (int j = 1; j <= 2; ++j) {
    joints[j] += 3e-5 * size * (at.joints[j] > at.before[j] ? 1.0 : -1.0);
  }
  return Position(arm, joints);
}

Eigen::Vector3d Thermal(const Arm& arm, const Command& at, double size) {
  Arm warm = arm;
  const double growth = 1e-4 * size * (1.0 - std::exp(-2.0 * at.time));
  for (Joint& joint : warm.joints) {
    joint.d *= 1.0 + growth;
    joint.r *= 1.0 + growth;
  }
  return Position(warm, at.joints);
}

Eigen::Vector3d Rigid(const Arm& arm, const Command& at, double /*size*/) {
  return Position(arm, at.joints);
}

struct Study {
  const char* name;
  Misfit misfit;
  std::vector<StructureKind> kinds;  // that name it
};

const std::vector<Study>& Studies() {
  static const std::vector<Study> studies = {
      {"none", Rigid, {}},
      {"elasticity", Elastic, {StructureKind::kGravityMoment}},
      {"harmonic", Harmonic, {StructureKind::kJointValue}},
      {"backlash", Backlash, {StructureKind::kApproach}},
      {"thermal growth", Thermal, {StructureKind::kRowOrder}}};
  return studies;
}

// Poses and what the arm did there.
struct Visits {
  Eigen::MatrixXd joints;
  Eigen::Matrix3Xd points;
};

Visits Visit(const Arm& real, const Study& study, double size,
             std::uint64_t seed) {
  Visits visits{DrawJointValues(real, kPoses, seed), {}};
  visits.points.resize(3, kPoses);
  Command at{visits.joints.col(0), visits.joints.col(0), 0.0};
  for (int i = 0; i < kPoses; ++i) {
    at.before = at.joints;
    at.joints = visits.joints.col(i);
    at.time = static_cast<double>(i) / (kPoses - 1);
    visits.points.col(i) = study.misfit(real, at, size);
  }
  return visits;
}

struct Bench {
  Arm nominal;
  bool with_frames = true;
  std::uint64_t seed = 0;  // of everything that is drawn

  // Of arms and noise, and of poses.
  Random Engine(std::uint64_t stream, std::uint64_t trial) const {
    return Random(1000 * seed + stream, trial);
  }
  std::uint64_t Poses(std::uint64_t number) const {
    return 1000000 * seed + number;
  }
};

std::vector<Bench> Arms(const std::string& root, std::uint64_t seed) {
  std::vector<Bench> arms;
  for (const char* name : {"ur10", "rv2aj_flange"}) {
    Bench bench{LoadArm(root + "/configs/robots/" + name + ".yaml")};
    bench.seed = seed;
    bench.with_frames = std::string(name) == "ur10";
    if (bench.with_frames) {
      bench.nominal.last_from_target().translation() << 0.05, 0.03, 0.1;
    }
    arms.push_back(std::move(bench));
  }
  return arms;
}

Arm Moved(Arm arm, Random* random) {
  for (Joint& joint : arm.joints) {
    for (double* value : {&joint.alpha, &joint.beta, &joint.theta}) {
      *value += 1e-3 * random->Normal();
    }
    for (double* value : {&joint.d, &joint.r}) {
      *value += 3e-4 * random->Normal();
    }
  }
  return arm;
}

enum class Sigma { kGiven, kInstrument, kUnknown };

// With validation poses, that predictions are asked for.
CalibrationResult Solve(const Bench& bench, const Visits& fitted,
                        const Visits& others, Sigma sigma, Random* noise) {
  const double stated = sigma == Sigma::kUnknown ? 1e-4 : kSigma;
  const auto measure = [&](const Visits& visits) {
    Eigen::Matrix3Xd points = visits.points;
    for (double& value : points.reshaped()) {
      if (noise != nullptr) value += kSigma * noise->Normal();
    }
    return MakePositions(visits.joints, points, stated);
  };
  CalibrationOptions options;
  options.identifiability.candidates = {true, bench.with_frames,
                                        bench.with_frames};
  options.estimate_sigma = sigma != Sigma::kGiven;
  options.sigmas_are_stated = sigma == Sigma::kInstrument;
  options.uncertainty.map_configurations = 0;
  CalibrationData data(measure(fitted));
  data.validation = measure(others);
  return Calibrate(bench.nominal, data, options);
}

double RmsTo(const Arm& arm, const Visits& visits) {
  return std::sqrt((TargetPositions(arm, visits.joints) - visits.points)
                       .colwise()
                       .squaredNorm()
                       .mean());
}

// The size at which exact measurements leave an error of `times` the noise at
// other poses.
double SizeOf(const Bench& bench, const Study& study, double times) {
  if (study.kinds.empty()) return 0.0;
  constexpr double kTried = 3.0;
  std::vector<double> errors;
  for (std::uint64_t trial = 0; trial < 9; ++trial) {
    Random random = bench.Engine(20, trial);
    const Arm real = Moved(bench.nominal, &random);
    const std::uint64_t poses = bench.Poses(1001 + 2 * trial);
    const Visits fitted = Visit(real, study, kTried, poses);
    const Visits others = Visit(real, study, kTried, poses + 1);
    errors.push_back(RmsTo(
        Solve(bench, fitted, others, Sigma::kGiven, nullptr).arm, others));
  }
  std::sort(errors.begin(), errors.end());
  return kTried * times * kSigma * std::sqrt(3.0) / errors[errors.size() / 2];
}

double Quantile(std::vector<double> values, double at) {
  if (values.empty()) return std::nan("");
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(
      at * static_cast<double>(values.size() - 1))];
}

void Run(const Bench& bench, const Study& study, Sigma sigma, int trials,
         double times) {
  const double size = SizeOf(bench, study, times);
  std::vector<double> ratios;
  int named = 0;
  int found = 0;
  int lacking = 0;
  std::int64_t covered = 0;
  int agree = 0;
  int alarms = 0;
  for (int trial = 0; trial < trials; ++trial) {
    const auto number = static_cast<std::uint64_t>(trial);
    Random random = bench.Engine(22, number);
    const Arm real = Moved(bench.nominal, &random);
    const std::uint64_t poses = bench.Poses(2 * number + 1);
    const Visits fitted = Visit(real, study, size, poses);
    const Visits others = Visit(real, study, size, poses + 1);
    const CalibrationResult result =
        Solve(bench, fitted, others, sigma, &random);
    if (!result.IsUsable()) continue;
    const UncertaintyResult& uncertainty = *result.uncertainty;
    const PredictionParts& parts = uncertainty.validation->parts;
    ratios.push_back(std::hypot(parts.from_parameters, parts.from_model) /
                     RmsTo(result.arm, others));
    const LackOfFit& lack = uncertainty.lack_of_fit;
    const bool is_found =
        !lack.structure.empty() && lack.structure.front().is_found;
    found += is_found ? 1 : 0;
    if (is_found) {
      const StructureKind kind = lack.structure.front().kind;
      named += std::count(study.kinds.begin(), study.kinds.end(), kind) > 0;
    }
    lacking += lack.p_value < 0.01 && lack.source != NoiseSource::kStructure;
    agree += uncertainty.validation->verdict == "agree";
    covered += uncertainty.validation->axes.held;
    alarms += result.warnings.empty() ? 0 : 1;
  }
  static const char* const kSigmas[] = {"given", "estimated, instrument stated",
                                        "estimated"};
  std::printf(
      "| %s | %s | %s | %.2f (%.2f to %.2f) | %d %% | %d %% | %s | %.1f %% | "
      "%d %% | %d %% |\n",
      bench.nominal.name.c_str(), study.name, kSigmas[static_cast<int>(sigma)],
      Quantile(ratios, 0.5), Quantile(ratios, 0.05), Quantile(ratios, 0.95),
      100 * found / trials, 100 * named / trials,
      sigma == Sigma::kUnknown
          ? "-"
          : (std::to_string(100 * lacking / trials) + " %").c_str(),
      100.0 * static_cast<double>(covered) / (3.0 * kPoses * trials),
      100 * agree / trials, 100 * alarms / trials);
  std::fflush(stdout);
}

bool RunAll(const std::vector<std::string>& arguments) {
  if (arguments.size() < 4 || arguments.size() > 5) return false;
  const int trials = std::stoi(arguments[1]);
  const double times = std::stod(arguments[2]);
  const std::uint64_t seed = std::stoull(arguments[3]);
  std::printf(
      "| arm | error | sigma | predicted / true | structure found | named "
      "right | lack of fit | within intervals | \"agree\" | any warning |\n"
      "|---|---|---|---|---|---|---|---|---|---|\n");
  for (const Bench& bench : Arms(arguments[0], seed)) {
    for (const Study& study : Studies()) {
      if (arguments.size() > 4 && arguments[4] != study.name) continue;
      for (const Sigma sigma :
           {Sigma::kGiven, Sigma::kInstrument, Sigma::kUnknown}) {
        Run(bench, study, sigma, trials, times);
      }
    }
  }
  return true;
}

}  // namespace
}  // namespace alidade::internal

int main(int argc, char** argv) {
  return alidade::internal::bench::StudyMain(
      argc, argv,
      "misfits SOURCE_DIRECTORY TRIALS TIMES_THE_NOISE SEED [ERROR]",
      alidade::internal::RunAll);
}
