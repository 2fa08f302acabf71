// Calibrations from nominal arms that are hard, and mistakes of input: the
// numbers behind docs/hard_starts.md. Run by scripts/hard_starts.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "alidade/arm_file.h"
#include "alidade/calibration.h"
#include "alidade/error.h"
#include "alidade/forward_kinematics.h"
#include "alidade/units.h"
#include "bench/study_main.h"
#include "src/common/random.h"
#include "src/model/joint_draw.h"

namespace alidade::internal {
namespace {

constexpr double kSigma = 5e-5;  // m
constexpr int kPoses = 60;

// An arm, and what of it is identified.
struct Bench {
  Arm nominal;
  bool with_frames = true;
};

std::vector<Bench> Arms(const std::string& root,
                        const std::vector<std::string>& names) {
  std::vector<Bench> arms;
  for (const std::string& name : names) {
    Bench bench{LoadArm(root + "/configs/robots/" + name + ".yaml")};
    bench.with_frames = name != "rv2aj_flange";
    if (bench.with_frames) {
      bench.nominal.last_from_target().translation() << 0.05, 0.03, 0.1;
    }
    arms.push_back(std::move(bench));
  }
  return arms;
}

// Revolute joints of alpha (deg), d and r (m), modified Denavit-Hartenberg.
Bench MakeBench(const std::string& name,
                const std::vector<Eigen::Vector3d>& table) {
  Bench bench;
  bench.nominal.name = name;
  for (const Eigen::Vector3d& row : table) {
    Joint joint;
    joint.alpha = row[0] * kDegree;
    joint.d = row[1];
    joint.r = row[2];
    joint.lower = -2.6;
    joint.upper = 2.6;
    bench.nominal.joints.push_back(joint);
  }
  bench.nominal.targets.resize(1);
  bench.nominal.last_from_target().translation() << 0.05, 0.03, 0.1;
  return bench;
}

// Dimensions as their makers publish them.
std::vector<Bench> FurtherArms() {
  return {MakeBench("UR5", {{0, 0, 0.0892},
                            {90, 0, 0},
                            {0, -0.425, 0},
                            {0, -0.3922, 0.1092},
                            {90, 0, 0.0947},
                            {-90, 0, 0.0823}}),
          MakeBench("UR3", {{0, 0, 0.1519},
                            {90, 0, 0},
                            {0, -0.2437, 0},
                            {0, -0.2133, 0.1124},
                            {90, 0, 0.0854},
                            {-90, 0, 0.0819}}),
          MakeBench("PUMA 560", {{0, 0, 0},
                                 {-90, 0, 0.2435},
                                 {0, 0.4318, -0.0934},
                                 {90, -0.0203, 0.4331},
                                 {-90, 0, 0},
                                 {90, 0, 0.0565}}),
          MakeBench("LBR iiwa 7", {{0, 0, 0.34},
                                   {-90, 0, 0},
                                   {90, 0, 0.4},
                                   {90, 0, 0},
                                   {-90, 0, 0.4},
                                   {-90, 0, 0},
                                   {90, 0, 0.126}})};
}

// Moves every parameter of the joints by normal draws, half of the priors for
// manufacture.
Arm Moved(Arm arm, double angle, double length, Random* random) {
  for (Joint& joint : arm.joints) {
    for (double* value : {&joint.alpha, &joint.beta, &joint.theta}) {
      *value += angle * random->Normal();
    }
    for (double* value : {&joint.d, &joint.r}) {
      *value += length * random->Normal();
    }
  }
  return arm;
}

Dataset Measure(const Arm& real, int poses, double sigma, std::uint64_t seed) {
  const Eigen::MatrixXd joints = DrawJointValues(real, poses, seed);
  Eigen::Matrix3Xd points = TargetPositions(real, joints);
  Random random(seed, 1u << 20);
  for (double& value : points.reshaped()) value += sigma * random.Normal();
  return MakePositions(joints, points, kSigma);
}

CalibrationResult Solve(const Bench& bench, const Arm& nominal,
                        const Dataset& data, bool estimate_sigma = false) {
  CalibrationOptions options;
  options.identifiability.candidates = {true, bench.with_frames,
                                        bench.with_frames};
  options.estimate_sigma = estimate_sigma;
  options.uncertainty.map_configurations = 0;
  return Calibrate(nominal, data, options);
}

double TrueRms(const Arm& found, const Arm& real, std::uint64_t seed) {
  const Eigen::MatrixXd joints = DrawJointValues(real, 200, seed);
  return std::sqrt(
      (TargetPositions(found, joints) - TargetPositions(real, joints))
          .colwise()
          .squaredNorm()
          .mean());
}

double Median(std::vector<double> values) {
  if (values.empty()) return std::nan("");
  const auto middle = values.begin() + values.size() / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// How often intervals hold what exact measurements would give.
struct Coverage {
  int held = 0;
  int count = 0;

  void Add(const CalibrationResult& noisy, const CalibrationResult& exact) {
    for (std::size_t c = 0; c < noisy.parameters.size(); ++c) {
      const ParameterResult& parameter = noisy.parameters[c];
      if (parameter.decision.state != ParameterState::kFree) continue;
      if (!(parameter.std > 0.0)) continue;
      const double off = parameter.value - exact.parameters[c].value;
      held += std::abs(off) <= 1.959964 * parameter.std ? 1 : 0;
      ++count;
    }
  }
  double percent() const { return 100.0 * held / std::max(1, count); }
};

// Every year the arm has drifted, and is calibrated from last year's result
// and, for comparison, from the nominal arm.
void Recalibrate(const Bench& bench, int trials) {
  constexpr int kYears = 5;
  std::vector<std::vector<double>> ratios(kYears);
  std::vector<Coverage> coverage(kYears);
  int failures = 0;
  int iterations = 0;
  double longest = 0.0;
  for (int trial = 0; trial < trials; ++trial) {
    Random random(7, static_cast<std::uint64_t>(trial));
    Arm real = Moved(bench.nominal, 1e-3, 3e-4, &random);
    Arm own = bench.nominal;
    for (int year = 0; year < kYears; ++year) {
      const auto seed = static_cast<std::uint64_t>(1000 * trial + year + 1);
      const Dataset data = Measure(real, kPoses, kSigma, seed);
      const CalibrationResult from_own = Solve(bench, own, data);
      const CalibrationResult from_nominal = Solve(bench, bench.nominal, data);
      if (!from_own.IsUsable() || !from_nominal.IsUsable()) {
        ++failures;
        break;
      }
      ratios[year].push_back(TrueRms(from_own.arm, real, seed) /
                             TrueRms(from_nominal.arm, real, seed));
      coverage[year].Add(from_own,
                         Solve(bench, own, Measure(real, kPoses, 0.0, seed)));
      iterations = std::max(
          iterations, from_own.runs[0].summary.iterations.back().iteration);
      for (const ParameterResult& parameter : from_own.parameters) {
        const bool is_frame =
            parameter.kind == "base" || parameter.kind == "tool";
        if (parameter.dimension != Dimension::kLength || is_frame) continue;
        longest = std::max(longest, std::abs(parameter.deviation()));
      }
      own = from_own.arm;
      real = Moved(real, 2e-4, 5e-5, &random);
    }
  }
  std::printf("%-28s %3d failed, %2d iterations, %5.2f mm |",
              bench.nominal.name.c_str(), failures, iterations,
              longest / kMillimetre);
  for (int year = 0; year < kYears; ++year) {
    std::printf(" %.3f (%.1f %%)", Median(ratios[year]),
                coverage[year].percent());
  }
  std::printf("\n");
}

// Axes of neighbouring joints that the nominal arm has off parallel.
void OffParallel(const Bench& bench, int trials) {
  std::printf("%s\n", bench.nominal.name.c_str());
  for (int half = -13; half <= -2; ++half) {
    const double size = half == -13 ? 0.0 : std::pow(10.0, 0.5 * half);
    Coverage coverage;
    std::vector<double> errors;
    int iterations = 0;
    int failures = 0;
    double coefficient = 0.0;
    for (int trial = 0; trial < trials; ++trial) {
      Random random(8, static_cast<std::uint64_t>(trial));
      Arm nominal = bench.nominal;
      for (Joint& joint : nominal.joints) {
        if (std::abs(std::sin(joint.alpha)) < 1e-6) {
          joint.alpha += size * random.Normal();
        }
      }
      const Arm real = Moved(nominal, 1e-3, 3e-4, &random);
      const auto seed = static_cast<std::uint64_t>(trial + 1);
      const CalibrationResult result =
          Solve(bench, nominal, Measure(real, kPoses, kSigma, seed));
      if (!result.IsUsable()) {
        ++failures;
        continue;
      }
      coverage.Add(result,
                   Solve(bench, nominal, Measure(real, kPoses, 0.0, seed)));
      errors.push_back(TrueRms(result.arm, real, seed));
      iterations = std::max(iterations,
                            result.runs[0].summary.iterations.back().iteration);
      const double reach = ArmReach(nominal);
      const auto scale = [&](const std::string& name) {
        return result.Parameter(name).dimension == Dimension::kAngle ? reach
                                                                     : 1.0;
      };
      for (const Relation& relation : result.identifiability.relations) {
        for (const auto& [name, value] : relation.terms) {
          coefficient = std::max(coefficient, std::abs(value) * scale(name) /
                                                  scale(relation.parameter));
        }
      }
    }
    std::printf(
        "  %7.0e rad: %d failed, coverage %.1f %%, at most %d iterations, "
        "largest coefficient %.1f, error %.4f mm\n",
        size, failures, coverage.percent(), iterations, coefficient,
        Median(errors) / kMillimetre);
  }
}

// One joint's zero is degrees off, and sigma is estimated.
void ZerosOff(const Bench& bench) {
  int right = 0;
  int count = 0;
  for (int joint = 1; joint < bench.nominal.num_joints() - 1; ++joint) {
    for (const double degrees :
         {5.0, -5.0, 8.0, -8.0, 12.0, -12.0, 20.0, -20.0}) {
      Random random(9, static_cast<std::uint64_t>(count));
      Arm real = Moved(bench.nominal, 1e-3, 3e-4, &random);
      real.joints[joint].theta += degrees * kDegree;
      const auto seed = static_cast<std::uint64_t>(++count);
      const CalibrationResult result = Solve(
          bench, bench.nominal, Measure(real, kPoses, kSigma, seed), true);
      // Three times what the parameters' own noise leaves.
      const double expected = kSigma * std::sqrt(30.0 / kPoses);
      if (result.IsUsable() &&
          TrueRms(result.arm, real, seed) < 3.0 * expected) {
        ++right;
      }
    }
  }
  std::printf("%-28s %d of %d\n", bench.nominal.name.c_str(), right, count);
}

// A mistake in the data, and what must be said of it.
struct Mistake {
  std::string says;
  std::function<void(Eigen::MatrixXd*, Eigen::Matrix3Xd*)> make;
  bool undoes_itself = false;  // made twice, it is not there
};

void ScaleAngles(const Arm& arm, double factor, Eigen::MatrixXd* q) {
  for (int j = 0; j < arm.num_joints(); ++j) {
    if (arm.joints[j].type == JointType::kRevolute) q->row(j) *= factor;
  }
}

std::vector<Mistake> MistakesOf(const Arm& arm) {
  std::vector<Mistake> mistakes = {
      {"in degrees but read as radians",
       [&arm](Eigen::MatrixXd* q, Eigen::Matrix3Xd*) {
         ScaleAngles(arm, 1.0 / kDegree, q);
       }},
      {"in radians but read as degrees",
       [&arm](Eigen::MatrixXd* q, Eigen::Matrix3Xd*) {
         ScaleAngles(arm, kDegree, q);
       }},
      {"in grad",
       [&arm](Eigen::MatrixXd* q, Eigen::Matrix3Xd*) {
         ScaleAngles(arm, 1.0 / 0.9, q);
       }},
      {"in mm but read as m",
       [](Eigen::MatrixXd*, Eigen::Matrix3Xd* p) { *p *= 1e3; }},
      {"in m but read as mm",
       [](Eigen::MatrixXd*, Eigen::Matrix3Xd* p) { *p /= 1e3; }},
      {"in inches", [](Eigen::MatrixXd*, Eigen::Matrix3Xd* p) { *p /= 25.4; }},
      {"in feet", [](Eigen::MatrixXd*, Eigen::Matrix3Xd* p) { *p /= 0.3048; }},
      {"mirror image", [](Eigen::MatrixXd*,
                          Eigen::Matrix3Xd* p) { p->row(0).swap(p->row(2)); }},
      {"one row late",
       [](Eigen::MatrixXd*, Eigen::Matrix3Xd* p) {
         const Eigen::Index n = p->cols() - 1;
         p->rightCols(n) = p->leftCols(n).eval();
       }},
  };
  for (int j = 1; j + 1 < arm.num_joints(); ++j) {
    const std::string joint = "joint " + std::to_string(j + 1);
    mistakes.push_back(
        {joint + " counts the other way",
         [j](Eigen::MatrixXd* q, Eigen::Matrix3Xd*) { q->row(j) *= -1.0; },
         true});
    mistakes.push_back({"the zero of " + joint + " is elsewhere: add 90 deg",
                        [j](Eigen::MatrixXd* q, Eigen::Matrix3Xd*) {
                          q->row(j).array() -= 90.0 * kDegree;
                        }});
    mistakes.push_back({"columns q" + std::to_string(j) + " and q" +
                            std::to_string(j + 1) + " are swapped",
                        [j](Eigen::MatrixXd* q, Eigen::Matrix3Xd*) {
                          q->row(j).swap(q->row(j - 1));
                        },
                        true});
  }
  // The last: alone only.
  mistakes.push_back(
      {"fit in two parts", [](Eigen::MatrixXd*, Eigen::Matrix3Xd* p) {
         const Eigen::Index n = p->cols() * 2 / 5;
         const Eigen::AngleAxisd turn(0.7, Eigen::Vector3d::UnitZ());
         p->rightCols(n) = (turn.toRotationMatrix() * p->rightCols(n)).eval();
         p->rightCols(n).colwise() += Eigen::Vector3d(0.3, -0.8, 0.1);
       }});
  return mistakes;
}

// Whether a calibration explains the data to within the noise.
bool Fits(const CalibrationResult& result) {
  return result.IsUsable() && result.train.after.rms < 4.0 * kSigma;
}

// Whether data are explained by the cure that was named, of several mistakes
// that were made: base and tool take the others up.
bool IsWholeCure(const Bench& bench, const Mistake& named,
                 Eigen::MatrixXd joints, Eigen::Matrix3Xd points,
                 const std::string& text) {
  if (!named.undoes_itself || text.find(named.says) == std::string::npos) {
    return false;
  }
  named.make(&joints, &points);
  try {
    return Fits(
        Solve(bench, bench.nominal, MakePositions(joints, points, kSigma)));
  } catch (const InputError&) {
    return false;
  }
}

// Single and double mistakes: what was said of them.
void InputMistakes(const Bench& bench, int count) {
  const std::vector<Mistake> all = MistakesOf(bench.nominal);
  int named = 0;
  int alike = 0;
  int wrong = 0;
  int unnamed = 0;
  for (int k = 0; k < count; ++k) {
    std::fprintf(stderr, "\r%s: %d of %d", bench.nominal.name.c_str(), k,
                 count);
    Random random(10, static_cast<std::uint64_t>(k));
    const Arm real = Moved(bench.nominal, 1e-3, 3e-4, &random);
    Eigen::MatrixXd joints =
        DrawJointValues(real, kPoses, static_cast<std::uint64_t>(k + 1));
    Eigen::Matrix3Xd points = TargetPositions(real, joints);
    for (double& value : points.reshaped()) value += kSigma * random.Normal();
    const auto pick = [&](std::size_t among) {
      return static_cast<std::size_t>(
          random.Uniform(0.0, static_cast<double>(among)));
    };
    const bool is_single = k % 2 == 0;
    const std::size_t first = pick(all.size() - (is_single ? 0 : 1));
    const std::size_t second = is_single ? first : pick(all.size() - 1);
    // Units come last: a zero is off in the units of the arm.
    all[std::max(first, second)].make(&joints, &points);
    if (second != first) all[std::min(first, second)].make(&joints, &points);
    std::string text;
    try {
      CalibrationResult result =
          Solve(bench, bench.nominal, MakePositions(joints, points, kSigma));
      if (Fits(result)) {
        ++alike;  // base and tool take it up: there is nothing to say
        continue;
      }
    } catch (const InputError& error) {
      text = error.what();
    }
    const bool is_right = text.find(all[first].says) != std::string::npos &&
                          text.find(all[second].says) != std::string::npos;
    if (text.find("Several mistakes") != std::string::npos ||
        text.find("this is not all") != std::string::npos) {
      ++(is_right ? named : alike);
    } else if (is_right ||
               IsWholeCure(bench, all[first], joints, points, text) ||
               IsWholeCure(bench, all[second], joints, points, text)) {
      ++named;
    } else {
      ++(text.empty() ? unnamed : wrong);
    }
    if (!is_right) {
      std::printf("  %s; %s: %s\n", all[first].says.c_str(),
                  all[second].says.c_str(), text.c_str());
    }
  }
  std::fprintf(stderr, "\n");
  std::printf(
      "%-28s %d named, %d several or none to name, %d unnamed, %d "
      "wrong\n",
      bench.nominal.name.c_str(), named, alike, unnamed, wrong);
}

bool Run(const std::vector<std::string>& arguments) {
  if (arguments.size() != 2) return false;
  const std::string& what = arguments[1];
  std::vector<Bench> arms =
      Arms(arguments[0], {"rv2aj_flange", "ur10", "irb120", "panda"});
  if (what == "mistakes") {
    for (const Bench& bench : Arms(arguments[0], {"rokae", "lifting_column"})) {
      arms.push_back(bench);
    }
    for (const Bench& bench : FurtherArms()) arms.push_back(bench);
  }
  for (const Bench& bench : arms) {
    std::fflush(stdout);
    if (what == "recalibration") {
      Recalibrate(bench, 50);
    } else if (what == "parallel") {
      OffParallel(bench, 50);
    } else if (what == "zeros") {
      ZerosOff(bench);
    } else if (what == "mistakes") {
      InputMistakes(bench, 50);
    } else {
      return false;
    }
  }
  return true;
}

}  // namespace
}  // namespace alidade::internal

int main(int argc, char** argv) {
  return alidade::internal::bench::StudyMain(
      argc, argv,
      "hard_starts SOURCE_DIRECTORY recalibration|parallel|zeros|mistakes",
      alidade::internal::Run);
}
