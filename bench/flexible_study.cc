// Simulated arms whose error terms are known: whether intervals of parameters,
// joint functions and predicted positions hold, and whether the selection finds
// the terms that there are. The tables of docs/flexible_study.md.
//
// Usage: flexible_study SOURCE_DIRECTORY stated|auto|rungs TRIALS [small]
//                       [ARM...]
//          stated  the set of terms is the true one
//          auto    it is selected; the same truth
//          rungs   it is selected, for every set that the truth may have
//          small   100 poses within 1 rad: ten times as fast

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "alidade/arm_file.h"
#include "alidade/calibration.h"
#include "alidade/forward_kinematics.h"
#include "alidade/units.h"
#include "bench/study_main.h"
#include "src/calibration/flexible_fit.h"
#include "src/common/parallel.h"
#include "src/common/random.h"
#include "src/error_terms/term_rows.h"
#include "src/identifiability/analysis.h"
#include "src/identifiability/rules.h"
#include "src/solve/solve.h"
#include "src/uncertainty/covariance.h"

namespace alidade::internal {
namespace {

constexpr int kPredicted = 20;      // new poses of each trial
constexpr int kFunctionPoints = 9;  // of each joint
constexpr double kSigma = 0.05e-3;  // m
constexpr double kAngleDeviation = 1e-3;
constexpr double kLengthDeviation = 0.5e-3;
// Prior standard deviations of the true terms; each moves the target by three
// sigmas and more.
constexpr double kOwnCompliance = 3e-5;  // rad / (N m)
constexpr double kOtherCompliance = 2e-5;
constexpr double kFunction = 0.5e-3;  // rad
constexpr double kNormal95 = 1.959963984540054;
constexpr int kThreads = 2;

// What the real arm has: the rungs of the selection, in their order.
struct Truth {
  const char* name;
  bool elasticity;
  double length;  // of functions
};

constexpr std::array<Truth, 5> kTruths = {{{"geometry", false, 0.0},
                                           {"elasticity", true, 0.0},
                                           {"functions of 0.1", true, 0.1},
                                           {"functions of 0.3", true, 0.3},
                                           {"functions of 1.5", true, 1.5}}};

struct Simulated {
  std::string name;
  Arm nominal;
  Eigen::VectorXd lower;
  Eigen::VectorXd upper;
  int num_poses = 250;
  std::vector<int> free;
};

// How many intervals hold.
struct Held {
  std::int64_t in = 0;
  std::int64_t all = 0;
  double square = 0.0;

  void Add(double error, double deviation) {
    const double z = error / deviation;
    in += std::abs(z) <= kNormal95 ? 1 : 0;
    square += z * z;
    ++all;
  }
  void Add(const Held& other) {
    in += other.in;
    all += other.all;
    square += other.square;
  }
  double Percent() const {
    return 100.0 * static_cast<double>(in) / static_cast<double>(all);
  }
};

struct Trial {
  Held parameters;
  Held functions;
  Held positions;
  double share = 0.0;
  double ratio = 1.0;  // error over that of the geometry alone, RMS
  int rung = 0;        // of largest weight, in the order of kTruths
};

Eigen::MatrixXd DrawPoses(const Simulated& arm, int count, Random* random) {
  Eigen::MatrixXd poses(arm.nominal.num_joints(), count);
  for (int i = 0; i < count; ++i) {
    for (int j = 0; j < poses.rows(); ++j) {
      poses(j, i) = random->Uniform(arm.lower[j], arm.upper[j]);
    }
  }
  return poses;
}

// A function with Matern's covariance of smoothness 3/2, on a fine grid.
JointFunction DrawFunction(double lower, double upper, double length,
                           Random* random) {
  JointFunction function;
  function.spacing = 0.02;
  function.first = lower - 2.0 * function.spacing;
  const auto count = static_cast<Eigen::Index>(
      std::ceil((upper - function.first) / function.spacing) + 2.0);
  Eigen::MatrixXd covariance(count, count);
  for (Eigen::Index a = 0; a < count; ++a) {
    for (Eigen::Index b = 0; b < count; ++b) {
      const double u = std::sqrt(3.0) * function.spacing *
                       std::abs(static_cast<double>(a - b)) / length;
      covariance(a, b) = (1.0 + u) * std::exp(-u);
    }
    covariance(a, a) += 1e-9;
  }
  Eigen::VectorXd draws(count);
  for (double& draw : draws) draw = random->Normal();
  function.values =
      kFunction * (covariance.llt().matrixL().toDenseMatrix() * draws);
  return function;
}

Arm DrawArm(const Simulated& arm, const Truth& truth, Random* random) {
  const ParameterLayout layout(arm.nominal);
  Eigen::VectorXd values = layout.Values(arm.nominal);
  for (const int column : arm.free) {
    const bool is_angle =
        layout.parameter(column).dimension == Dimension::kAngle;
    values[column] +=
        (is_angle ? kAngleDeviation : kLengthDeviation) * random->Normal();
  }
  Arm real = layout.WithValues(arm.nominal, values);
  if (!truth.elasticity) return real;
  const int n = real.num_joints();
  real.errors.joints.resize(n);
  for (int j = 0; j < n; ++j) {
    JointErrors& joint = real.errors.joints[j];
    for (int axis = 0; axis < 3; ++axis) {
      joint.compliance[axis] =
          (axis == 2 ? kOwnCompliance : kOtherCompliance) * random->Normal();
    }
    if (truth.length > 0.0) {
      joint.function =
          DrawFunction(arm.lower[j], arm.upper[j], truth.length, random);
    }
  }
  return real;
}

Dataset Measure(const Arm& real, const Eigen::MatrixXd& poses, double sigma,
                Random* random) {
  Eigen::Matrix3Xd positions = TargetPositions(real, poses);
  for (double& coordinate : positions.reshaped()) {
    coordinate += sigma * random->Normal();
  }
  return MakePositions(poses, positions, kSigma);
}

// What the fit says of everything, against the truth.
class Scoring {
 public:
  Scoring(const Simulated& arm, const Arm& real, const Eigen::MatrixXd& poses,
          Trial* trial)
      : arm_(arm), real_(real), poses_(poses), trial_(*trial) {}

  void Score(const MeasurementModel& model, const Eigen::VectorXd& values,
             const TermCovariance& covariance, const Eigen::MatrixXd& fresh) {
    ScoreParameters(model.layout(), values, covariance);
    ScoreFunctions(model.nominal().errors, covariance);
    ScorePositions(model, values, covariance, fresh);
  }

 private:
  void ScoreParameters(const ParameterLayout& layout,
                       const Eigen::VectorXd& values,
                       const TermCovariance& covariance) {
    const Eigen::VectorXd truth = layout.Values(real_);
    const Eigen::Index p = covariance.geometry.size();
    for (Eigen::Index k = 0; k < p; ++k) {
      const int column = covariance.geometry[k];
      // Rotations of frames are about the nominal ones.
      const double error =
          layout.parameter(column).kind == ParameterKind::kBaseRotation ||
                  layout.parameter(column).kind == ParameterKind::kToolRotation
              ? values[column] - TrueRotation(layout, column)
              : values[column] - truth[column];
      trial_.parameters.Add(error, kTermUnit * covariance.root.row(k).norm());
    }
  }

  double TrueRotation(const ParameterLayout& layout, int column) const {
    const Parameter& parameter = layout.parameter(column);
    const bool is_base = parameter.kind == ParameterKind::kBaseRotation;
    const Eigen::Matrix3d turn =
        is_base ? Eigen::Matrix3d(
                      real_.instrument_from_base.linear() *
                      arm_.nominal.instrument_from_base.linear().transpose())
                : Eigen::Matrix3d(
                      real_.last_from_target().linear() *
                      arm_.nominal.last_from_target().linear().transpose());
    const Eigen::AngleAxisd rotation(turn);
    return rotation.angle() * rotation.axis()[parameter.index];
  }

  void ScoreFunctions(const ErrorTerms& fitted,
                      const TermCovariance& covariance) {
    for (const FunctionKnots& knots : covariance.columns.functions()) {
      const JointFunction& truth =
          real_.errors.joints.empty()
              ? JointFunction()
              : real_.errors.joints[knots.joint].function;
      const JointFunction& function = fitted.joints[knots.joint].function;
      const auto row = [&](double q) -> Eigen::RowVectorXd {
        const double place = (q - knots.first) / knots.spacing;
        const double below = std::floor(place);
        const Eigen::Index first =
            static_cast<Eigen::Index>(covariance.geometry.size()) +
            covariance.columns.num_dense() + knots.offset +
            static_cast<Eigen::Index>(below);
        return kTermUnit *
               ((1.0 - (place - below)) * covariance.root.row(first) +
                (place - below) * covariance.root.row(first + 1));
      };
      const auto error = [&](double q) { return function.At(q) - truth.At(q); };
      Eigen::RowVectorXd mean_row =
          Eigen::RowVectorXd::Zero(covariance.root.cols());
      double mean = 0.0;
      for (const double q : poses_.row(knots.joint)) {
        mean_row += row(q) / static_cast<double>(poses_.cols());
        mean += error(q) / static_cast<double>(poses_.cols());
      }
      const double from = arm_.lower[knots.joint];
      const double range = arm_.upper[knots.joint] - from;
      for (int k = 0; k < kFunctionPoints; ++k) {
        const double q = from + range * (k + 0.5) / kFunctionPoints;
        double beside = 0.0;
        for (const FunctionGaps& gap : covariance.gaps) {
          if (gap.knots.joint != knots.joint) continue;
          beside += kTermUnit * kTermUnit * gap.VarianceAt(q);
        }
        trial_.functions.Add(
            error(q) - mean,
            std::sqrt((row(q) - mean_row).squaredNorm() + beside));
      }
    }
  }

  void ScorePositions(const MeasurementModel& model,
                      const Eigen::VectorXd& values,
                      const TermCovariance& covariance,
                      const Eigen::MatrixXd& fresh) {
    const Eigen::Matrix3Xd truth = TargetPositions(real_, fresh);
    const Eigen::Matrix3Xd error = model.Predict(values, fresh) - truth;
    const Dataset at = MakePositions(fresh, truth, 1.0);
    const TermRows rows = MakeTermRows(model, values, at, covariance.geometry);
    for (Eigen::Index i = 0; i < fresh.cols(); ++i) {
      const Eigen::MatrixXd spread =
          covariance.Spread(rows, rows.observations[i]);
      for (int axis = 0; axis < 3; ++axis) {
        trial_.positions.Add(error(axis, i), spread.row(axis).norm());
      }
    }
  }

  const Simulated& arm_;
  const Arm& real_;
  const Eigen::MatrixXd& poses_;
  Trial& trial_;
};

ErrorTermOptions OptionsFor(const Truth& truth, bool selects) {
  ErrorTermOptions options;
  options.selection =
      selects ? ErrorTermSelection::kAuto : ErrorTermSelection::kStated;
  options.elasticity = truth.elasticity;
  options.function_length = truth.length;
  return options;
}

int LargestRung(const ErrorTermsResult& result) {
  if (!(result.share > 0.0)) return 0;
  const auto largest = std::max_element(
      result.rungs.begin(), result.rungs.end(),
      [](const auto& a, const auto& b) { return a.weight < b.weight; });
  return static_cast<int>(largest - result.rungs.begin());
}

Trial RunTrial(const Simulated& arm, const Truth& truth, bool selects,
               std::uint64_t stream) {
  Random random(19, stream);
  const Arm real = DrawArm(arm, truth, &random);
  const Eigen::MatrixXd poses = DrawPoses(arm, arm.num_poses, &random);
  const Eigen::MatrixXd fresh = DrawPoses(arm, kPredicted, &random);
  CalibrationTask task;
  task.arm = arm.nominal;
  task.data.training = Measure(real, poses, kSigma, &random);
  task.data.validation = Measure(real, fresh, 0.0, &random);
  task.options.errors = OptionsFor(truth, selects);
  const MeasurementModel model(task.arm);
  const CalibrationProblem problem{model, task.data.training, arm.free,
                                   RankReport()};
  Eigen::VectorXd values = model.NominalValues();
  SolveLevenbergMarquardt(problem, SolverOptions(), &values);
  Trial trial;
  ErrorTermsResult result;
  std::vector<Finding> findings;
  const std::optional<FlexibleFit> fit =
      FitFlexible({task, problem, values}, &result, &findings);
  trial.share = result.share;
  trial.rung = LargestRung(result);
  if (!fit) return trial;
  Scoring(arm, real, poses, &trial)
      .Score(*fit->model, fit->values, *fit->covariance, fresh);
  const Eigen::Matrix3Xd exact = TargetPositions(real, fresh);
  trial.ratio = (fit->model->Predict(fit->values, fresh) - exact).norm() /
                (model.Predict(values, fresh) - exact).norm();
  return trial;
}

std::vector<Trial> RunTrials(const Simulated& arm, const Truth& truth,
                             bool selects, int count) {
  std::vector<Trial> trials(count);
  ParallelFor(kThreads, count, 1, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t k = begin; k < end; ++k) {
      trials[k] = RunTrial(arm, truth, selects, static_cast<std::uint64_t>(k));
    }
  });
  return trials;
}

void Print(const Simulated& arm, const Truth& truth,
           const std::vector<Trial>& trials) {
  Trial sum;
  int right = 0;
  int none = 0;
  int harmless = 0;
  double log_ratio = 0.0;
  double share = 0.0;
  for (const Trial& trial : trials) {
    sum.parameters.Add(trial.parameters);
    sum.functions.Add(trial.functions);
    sum.positions.Add(trial.positions);
    right += trial.rung == &truth - kTruths.data() ? 1 : 0;
    none += trial.share == 0.0 ? 1 : 0;
    harmless += trial.ratio <= 1.02 ? 1 : 0;
    log_ratio += std::log(trial.ratio);
    share += trial.share;
  }
  const auto count = static_cast<double>(trials.size());
  const auto interval = [](const Held& held) {
    if (held.all == 0) return std::string("-");
    char text[64];
    std::snprintf(text, sizeof text, "%.1f (%.2f)", held.Percent(),
                  std::sqrt(held.square / static_cast<double>(held.all)));
    return std::string(text);
  };
  std::printf(
      "| %s | %s | %zu | %s | %s | %s | %.0f | %.0f | %.0f | %.3f | %.2f |\n",
      arm.name.c_str(), truth.name, trials.size(),
      interval(sum.parameters).c_str(), interval(sum.functions).c_str(),
      interval(sum.positions).c_str(), 100.0 * right / count,
      100.0 * none / count, 100.0 * harmless / count,
      std::exp(log_ratio / count), share / count);
  std::fflush(stdout);
}

Simulated Load(const std::string& root, const std::string& name,
               bool is_small) {
  Simulated arm;
  arm.name = name;
  if (is_small) arm.num_poses = 100;
  arm.nominal = LoadArm(root + "/configs/robots/" + name + ".yaml");
  arm.nominal.instrument_from_base.linear() =
      Eigen::AngleAxisd(0.4, Eigen::Vector3d(0.2, -0.3, 1.0).normalized())
          .toRotationMatrix();
  arm.nominal.instrument_from_base.translation() =
      Eigen::Vector3d(1.8, -0.6, 0.4);
  arm.nominal.last_from_target().translation() =
      Eigen::Vector3d(0.05, 0.03, 0.12);
  const int n = arm.nominal.num_joints();
  const double range = is_small ? 1.0 : 2.0;
  arm.lower.setConstant(n, -range);
  arm.upper.setConstant(n, range);
  for (int j = 0; j < n; ++j) {
    const Joint& joint = arm.nominal.joints[j];
    if (!HasLimits(joint)) continue;
    arm.lower[j] = std::max(arm.lower[j], joint.lower);
    arm.upper[j] = std::min(arm.upper[j], joint.upper);
  }
  Random random(20);
  const MeasurementModel model(arm.nominal);
  const Dataset data = Measure(
      arm.nominal, DrawPoses(arm, arm.num_poses, &random), kSigma, &random);
  IdentifiabilityOptions options;
  options.policy = WeakPolicy::kFreeze;
  options.candidates.base = true;
  options.candidates.tool = true;
  const IdentifiabilityResult identified =
      AnalyzeIdentifiability(model, data, options);
  arm.free = FreeColumns(identified);
  return arm;
}

bool Run(const std::vector<std::string>& arguments) {
  if (arguments.size() < 3) return false;
  const std::string& kind = arguments[1];
  const int trials = std::stoi(arguments[2]);
  std::vector<std::string> names(arguments.begin() + 3, arguments.end());
  const bool is_small = !names.empty() && names.front() == "small";
  if (is_small) names.erase(names.begin());
  if (names.empty()) names = {"ur10", "panda", "rv2aj_wrist"};
  std::printf(
      "| arm | truth | trials | parameters | functions | positions | right "
      "rung | none | harmless | error / geometry | share |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const std::string& name : names) {
    const Simulated arm = Load(arguments[0], name, is_small);
    if (kind == "stated" || kind == "auto") {
      Print(arm, kTruths[3],
            RunTrials(arm, kTruths[3], kind == "auto", trials));
    } else if (kind == "rungs") {
      for (const Truth& truth : kTruths) {
        Print(arm, truth, RunTrials(arm, truth, true, trials));
      }
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
      "flexible_study SOURCE_DIRECTORY stated|auto|rungs TRIALS [small] "
      "[ARM...]",
      alidade::internal::Run);
}
