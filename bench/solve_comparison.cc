// How long a solve takes: every way of Alidade, an analytic Ceres problem as
// one writes it, and what scipy is given to do the same (bench/scipy_speed.py).
// RV-2AJ measured at its wrist centre and at its flange, 17 free parameters,
// positions with noise of 0.02 mm, one start and one stopping rule for all.
// Run by scripts/bench.
//
//   solve_comparison write DIR N     writes the problem for scipy
//   solve_comparison run N           prints lines: arm,N,method,threads,
//                                    seconds,iterations,cost

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "alidade/arm_file.h"
#include "alidade/units.h"
#include "bench/analytic_ceres.h"
#include "bench/study_columns.h"
#include "bench/study_main.h"
#include "src/common/random.h"
#include "src/model/joint_draw.h"
#include "src/solve/solve.h"

namespace alidade::internal {
namespace {

constexpr double kSigma = 0.02 * kMillimetre;
constexpr std::uint64_t kPosesSeed = 1;
constexpr std::uint64_t kNoiseSeed = 2;

// A radius for all of them alike: the rank is full, steps are those of
// Gauss-Newton.
constexpr double kRadius = 1e10;

struct Measured {
  Measured(const std::string& arm_file, Eigen::Index poses) {
    const Arm nominal = LoadArm(arm_file);
    const MeasurementModel model(nominal, 2);
    Eigen::VectorXd truth = model.NominalValues();
    // The deviations of docs/study.md are of this size.
    Random deviations(3);
    columns = bench::StudyColumns(model.layout());
    for (const int column : columns) {
      truth[column] += 1e-3 * deviations.Normal();
    }
    data.joint_values =
        DrawJointValues(nominal, static_cast<int>(poses), kPosesSeed);
    data.positions() = model.Predict(truth, data.joint_values);
    data.sigmas() = Eigen::Matrix3Xd::Constant(3, poses, kSigma);
    Random noise(kNoiseSeed);
    Eigen::MatrixXd noisy = data.positions().map();
    for (double& value : noisy.reshaped()) value += kSigma * noise.Normal();
    data.positions() = std::move(noisy);
    arm = nominal;
  }

  Arm arm;
  Dataset data;
  std::vector<int> columns;
};

struct Outcome {
  int iterations = 0;
  double cost = 0.0;
};

using Solve = std::function<Outcome()>;

struct Timed {
  Outcome outcome;
  std::vector<double> seconds;

  double Median() {
    const auto middle =
        seconds.begin() + static_cast<std::ptrdiff_t>(seconds.size() / 2);
    std::nth_element(seconds.begin(), middle, seconds.end());
    return *middle;
  }
};

// Each of the solves at least three times, more often where they are short, in
// turn: what else the machine does then slows all of them alike.
std::vector<Timed> TimeInTurn(const std::vector<Solve>& solves) {
  const double enough = 1.5 * static_cast<double>(solves.size());  // s
  std::vector<Timed> timed(solves.size());
  double total = 0.0;
  for (int run = 0; run < 3 || (total < enough && run < 301); ++run) {
    for (std::size_t k = 0; k < solves.size(); ++k) {
      const auto start = std::chrono::steady_clock::now();
      timed[k].outcome = solves[k]();
      const std::chrono::duration<double> took =
          std::chrono::steady_clock::now() - start;
      timed[k].seconds.push_back(took.count());
      total += took.count();
    }
  }
  return timed;
}

class Comparison {
 public:
  Comparison(const std::string& name, const std::string& arm_file,
             Eigen::Index poses)
      : name_(name), measured_(arm_file, poses) {
    options_.initial_trust_region_radius = kRadius;
  }

  void Run() const {
    const Eigen::Index poses = measured_.data.num_poses();
    if (poses <= 100000) {
      Time({{"autodiff", 1, [&] { return Ceres(Evaluation::kAutodiff, 1); }}});
      Time({{"analytic", 1, [&] { return Analytic(); }}});
      Time({{"pseudo-inverse", 1, [&] { return PseudoInverse(); }}});
    }
    Time({{"reduced", 1, [&] { return Ceres(Evaluation::kReduced, 1); }},
          {"reduced", 2, [&] { return Ceres(Evaluation::kReduced, 2); }}});
  }

  void Write(const std::string& directory) const {
    const MeasurementModel model(measured_.arm);
    const Eigen::VectorXd start = model.NominalValues();
    const auto write = [&](const char* file, const Eigen::MatrixXd& numbers) {
      std::ofstream out(directory + "/" + name_ + "_" + file, std::ios::binary);
      out.write(reinterpret_cast<const char*>(numbers.data()),
                static_cast<std::streamsize>(numbers.size() * sizeof(double)));
    };
    write("joints", measured_.data.joint_values.map().eval());
    write("points", measured_.data.positions().map().eval());
    write("nominal", start.head(5 * model.layout().num_joints()));
    Eigen::VectorXd columns(measured_.columns.size());
    for (Eigen::Index k = 0; k < columns.size(); ++k) {
      columns[k] = measured_.columns[k];
    }
    write("columns", columns);
  }

 private:
  struct Way {
    const char* method;
    int threads;
    Solve solve;
  };

  // A line for each of them: the median of its times.
  void Time(const std::vector<Way>& ways) const {
    std::vector<Solve> solves;
    for (const Way& way : ways) solves.push_back(way.solve);
    std::vector<Timed> timed = TimeInTurn(solves);
    for (std::size_t k = 0; k < ways.size(); ++k) {
      const Outcome& outcome = timed[k].outcome;
      std::printf("%s,%ld,%s,%d,%.6g,%d,%.12g\n", name_.c_str(),
                  static_cast<long>(measured_.data.num_poses()), ways[k].method,
                  ways[k].threads, timed[k].Median(), outcome.iterations,
                  outcome.cost);
    }
    std::fflush(stdout);
  }

  static Outcome OutcomeOf(const SolverSummary& summary) {
    if (!summary.IsSolutionUsable()) {
      std::fprintf(stderr, "%s\n", summary.BriefReport().c_str());
    }
    return {summary.accepted_steps + summary.rejected_steps,
            summary.final_cost};
  }

  Outcome Ceres(Evaluation evaluation, int threads) const {
    const MeasurementModel model(measured_.arm, threads);
    SolverOptions options = options_;
    options.evaluation = evaluation;
    Eigen::VectorXd values = model.NominalValues();
    return OutcomeOf(SolveLevenbergMarquardt(
        {model, measured_.data, measured_.columns}, options, &values));
  }

  Outcome PseudoInverse() const {
    const MeasurementModel model(measured_.arm);
    Eigen::VectorXd values = model.NominalValues();
    return OutcomeOf(SolvePseudoInverse(
        {model, measured_.data, measured_.columns}, options_, &values));
  }

  Outcome Analytic() const {
    const MeasurementModel model(measured_.arm);
    Eigen::VectorXd values = model.NominalValues();
    Outcome outcome;
    outcome.cost =
        bench::SolveAnalytic({model, measured_.data, measured_.columns},
                             options_, &values, &outcome.iterations);
    return outcome;
  }

  const std::string name_;
  const Measured measured_;
  SolverOptions options_;
};

bool Run(const std::vector<std::string>& arguments) {
  const std::string mode = arguments.empty() ? "" : arguments[0];
  const bool writes = mode == "write" && arguments.size() == 3;
  if (!writes && !(mode == "run" && arguments.size() == 2)) return false;
  const Eigen::Index poses = std::stol(arguments.back());
  for (const char* measured : {"wrist", "flange"}) {
    const Comparison comparison(
        measured, std::string("configs/robots/rv2aj_") + measured + ".yaml",
        poses);
    if (writes) {
      comparison.Write(arguments[1]);
    } else {
      comparison.Run();
    }
  }
  return true;
}

}  // namespace
}  // namespace alidade::internal

int main(int argc, char** argv) {
  return alidade::internal::bench::StudyMain(
      argc, argv,
      "solve_comparison run N\n"
      "       solve_comparison write DIR N",
      alidade::internal::Run);
}
