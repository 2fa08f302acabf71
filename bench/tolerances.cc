// How the first trust region of Levenberg-Marquardt and the tolerance of the
// pseudo-inverse decide the number of iterations, on the RV-2AJ study's poses
// over seeds: the numbers behind docs/architecture.md. Run by
// scripts/tolerances.

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "alidade/units.h"
#include "bench/study_main.h"
#include "src/identifiability/rules.h"
#include "src/serialization/simulation_file.h"
#include "src/simulation/simulation.h"
#include "src/solve/solve.h"

namespace alidade::internal {
namespace {

constexpr int kSeeds = 20;

// Over the seeds: the largest number of iterations and the largest error left.
struct Worst {
  int iterations = 0;
  int rejected = 0;
  double error = 0.0;

  void Add(const SolverSummary& summary) {
    iterations =
        std::max(iterations, summary.accepted_steps + summary.rejected_steps);
    rejected = std::max(rejected, summary.rejected_steps);
    error = std::max(error, summary.iterations.back().max_error);
  }
};

struct Variant {
  const char* name;
  bool ceres;
  double radius_factor;  // radius = (factor / smallest counted)^2; 0 = 1e10
  double tolerance;      // of the pseudo-inverse
  Worst worst = {};
};

void RunVariant(const CalibrationProblem& problem, Variant* variant) {
  SolverOptions options;
  Eigen::VectorXd values = problem.model.NominalValues();
  if (!variant->ceres) {
    options.pseudo_inverse_tolerance = variant->tolerance;
    variant->worst.Add(SolvePseudoInverse(problem, options, &values));
    return;
  }
  const double scale =
      variant->radius_factor / problem.start_rank.SmallestCounted();
  options.initial_trust_region_radius =
      variant->radius_factor > 0.0 ? scale * scale : 1e10;
  variant->worst.Add(SolveLevenbergMarquardt(problem, options, &values));
}

void Study(const std::string& simulation, const std::vector<std::string>& fix) {
  std::vector<Variant> variants = {
      {"LM, radius 1e10", true, 0.0, 0.0},
      {"LM, radius (3 / s)^2", true, 3.0, 0.0},
      {"LM, radius (10 / s)^2", true, 10.0, 0.0},
      {"LM, radius (30 / s)^2 (default)", true, 30.0, 0.0},
      {"LM, radius (100 / s)^2", true, 100.0, 0.0},
      {"pseudo-inverse, 1e-15", false, 0.0, 1e-15},
      {"pseudo-inverse, 1e-9", false, 0.0, 1e-9},
      {"pseudo-inverse, 1e-7", false, 0.0, 1e-7},
      {"pseudo-inverse, 1e-5", false, 0.0, 1e-5},
      {"pseudo-inverse, rank of the pass (default)", false, 0.0, 0.0}};
  SimulationConfig config = LoadSimulation(simulation);
  const MeasurementModel model(config.arm);
  IdentifiabilityOptions identifiability;
  identifiability.fix = fix;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    config.seed = static_cast<std::uint64_t>(seed);
    Dataset data = Simulate(config);
    data.sigmas() = SharedMatrix::Repeated(
        Eigen::Vector3d::Constant(0.02 * kMillimetre), data.num_poses());
    const IdentifiabilityResult pass = ApplyRules(model, data, identifiability);
    const CalibrationProblem problem{model, data, FreeColumns(pass),
                                     pass.nominal_rank};
    for (Variant& variant : variants) RunVariant(problem, &variant);
  }
  std::printf("%s, %d seeds\n%-44s %10s %9s %14s\n", config.arm.name.c_str(),
              kSeeds, "", "iterations", "rejected", "max error [mm]");
  for (const Variant& variant : variants) {
    std::printf("%-44s %10d %9d %14.1e\n", variant.name,
                variant.worst.iterations, variant.worst.rejected,
                variant.worst.error / kMillimetre);
  }
  std::printf("\n");
}

bool Run(const std::vector<std::string>& arguments) {
  if (arguments.size() != 1) return false;
  const std::string simulations = arguments[0] + "/configs/simulations/";
  Study(simulations + "rv2aj_wrist_56.yaml", {});
  Study(simulations + "rv2aj_flange_56.yaml", {"alpha5", "theta4"});
  return true;
}

}  // namespace
}  // namespace alidade::internal

int main(int argc, char** argv) {
  return alidade::internal::bench::StudyMain(
      argc, argv, "tolerances SOURCE_DIRECTORY", alidade::internal::Run);
}
